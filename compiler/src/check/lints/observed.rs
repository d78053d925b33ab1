//! What reward or ends depend on and no channel determines: the heading, the place, the time, latches, velocities of objects.
//!
//! Dependence on heading and place cannot be read off the graph: a speed reads a world vector and does not depend on its
//! direction. So the formulas are computed twice, in a made-up state and in the same state with the body turned or moved, and compared.
//! Sums, products, quotients and norms are computed as they are, so that what cancels cancels; whatever saturates or decides is
//! replaced by a smooth function, so that no dependence hides behind a threshold.

use super::events::is_event;
use super::sight;
use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Code, Diagnostic, FileId, Span, codes};
use crate::frame::{Sensor, Subject};
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::task::Setting;
use std::collections::BTreeSet;

/// A change of the body's place in the world that leaves everything within the body as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shift {
    Turned,
    AlongX,
    AlongY,
}

/// A term or an end: what it is called, its node, and where it stands.
struct Root {
    what: String,
    node: NodeId,
    file: FileId,
    span: Span,
}

impl Root {
    fn warning(&self, code: &'static Code, message: String) -> Diagnostic {
        Diagnostic::new(code, self.file, self.span, message)
    }
}

/// Lints on what the policy cannot know.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let terms = task.terms.len();
    let paid = task.terms.iter().map(|term| Root {
        what: format!("the term `{}`", term.name),
        node: term.node,
        file: term.file,
        span: term.formula.span,
    });
    let ended = task.terminations.iter().chain(&task.finishes);
    let ended = ended.map(|end| Root { what: format!("the end `{}`", end.name), node: end.node, file: end.file, span: end.span });
    let roots: Vec<Root> = paid.chain(ended).collect();
    let channels: Vec<NodeId> = task.channels.iter().map(|channel| channel.node).collect();
    places(checker, task, &roots, terms, &channels, diagnostics);
    let seen = task.graph.reachable(channels);
    time(task, &roots[..terms], &seen, diagnostics);
    latches(task, &roots[..terms], &seen, diagnostics);
    velocities(checker, task, (&roots, terms), &seen, diagnostics);
}

/// Heading and place, and world axes where the start turns.
fn places(
    checker: &Checker<'_>,
    task: &CheckedTask<'_>,
    roots: &[Root],
    terms: usize,
    channels: &[NodeId],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let surrogate = Surrogate::new(checker, task);
    let nodes: Vec<NodeId> = roots.iter().map(|root| root.node).collect();
    let shifts = [Shift::Turned, Shift::AlongX, Shift::AlongY];
    let depends = shifts.map(|shift| surrogate.answers(&nodes, shift));
    let drawn = task.init.drawn.iter().any(|(setting, _)| matches!(setting, Setting::RootHeading));
    let mut by_axis = false;
    for (index, root) in roots[..terms].iter().enumerate() {
        let placed = depends[1][index] || depends[2][index];
        if drawn && depends[0][index] && !placed {
            let message = format!("{} reads an axis of the world, and every episode starts with another heading", root.what);
            let help = "read what is meant along the body's own heading: `(com.velocity in heading(pelvis)).forward`";
            diagnostics.push(root.warning(codes::incentive::WORLD_AXIS, message).help(help));
            by_axis = true;
        }
    }
    // Who knows the place has what the heading is to be told from.
    let placed = |index: usize| depends[1][index] || depends[2][index];
    let first = |shift: usize, counts: &dyn Fn(usize) -> bool| {
        let found = (0..roots.len()).find(|&index| depends[shift][index] && counts(index));
        found.filter(|_| !surrogate.answers(channels, shifts[shift]).contains(&true))
    };
    let heading = first(0, &|index| !placed(index)).filter(|_| !by_axis);
    let [x, y] = [1, 2].map(|shift| first(shift, &|_| true));
    let hidden = [
        (
            heading,
            "which way the body faces",
            "observe it, `sin(pelvis.yaw)` and `cos(pelvis.yaw)`, or read what is meant in `heading(pelvis)`",
        ),
        (
            x.or(y),
            match (x, y) {
                (Some(_), Some(_)) => "where in the world the body is",
                (Some(_), None) => "where the body is along the world's x",
                _ => "where the body is along the world's y",
            },
            "observe its place, `pelvis.position`, or the way to what matters: `(target - pelvis.position) in heading(pelvis)`",
        ),
    ];
    for (root, what, help) in hidden {
        if let Some(root) = root.and_then(|index| roots.get(index)) {
            let message = format!("{} depends on {what}, and no channel tells it", root.what);
            diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
        }
    }
}

/// Time in terms, where no channel knows it.
fn time(task: &CheckedTask<'_>, terms: &[Root], seen: &[NodeId], diagnostics: &mut Vec<Diagnostic>) {
    let graph = &task.graph;
    let of_time = |id: &NodeId| match &graph.node(*id).operation {
        Operation::Step => true,
        Operation::Sensors(sensors) => sensors.contains(&Sensor::Time),
        _ => false,
    };
    if seen.iter().any(of_time) {
        return;
    }
    let ends: BTreeSet<NodeId> = task.terminations.iter().chain(&task.finishes).map(|end| end.node).collect();
    if let Some(root) = terms.iter().find(|root| behind(task, root.node, &ends).iter().any(of_time)) {
        let message = format!("{} depends on the time, and no channel tells it", root.what);
        let help = "observe `t`, or of a clock `sin(phase)` and `cos(phase)`: else the same observation is paid differently";
        diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
    }
}

/// What a node needs; ends, and what is paid in single steps, are not looked into.
fn behind(task: &CheckedTask<'_>, root: NodeId, ends: &BTreeSet<NodeId>) -> Vec<NodeId> {
    let graph = &task.graph;
    let (mut pending, mut found) = (vec![(root, false)], BTreeSet::new());
    // The horizon ends an episode as well.
    let horizon = |id: NodeId| {
        let node = graph.node(id);
        node.operation == Operation::Binary(Binary::LessEqual)
            && graph.constant_value(node.inputs[0]) == Some(f64::from(task.timing.horizon))
    };
    // Where in a motion a random start has come is for `unobserved` to tell.
    let started = |id: NodeId| {
        let drawn = |id: &NodeId| matches!(graph.node(*id).operation, Operation::Drawn(_) | Operation::DrawnAfter(_));
        matches!(graph.node(id).operation, Operation::Follow(_)) && graph.reachable([id]).iter().any(drawn)
    };
    while let Some((id, no_event)) = pending.pop() {
        let left_out = ends.contains(&id) || horizon(id) || !no_event && is_event(graph, id) || started(id);
        if !left_out && found.insert(id) {
            // What stands together in no event is none.
            let together = graph.node(id).operation == Operation::Binary(Binary::And);
            pending.extend(graph.node(id).inputs.iter().map(|input| (*input, together)));
        }
    }
    found.into_iter().collect()
}

/// Terms that ask whether something has ever happened, where no channel tells.
fn latches(task: &CheckedTask<'_>, terms: &[Root], seen: &[NodeId], diagnostics: &mut Vec<Diagnostic>) {
    let graph = &task.graph;
    let ends: BTreeSet<NodeId> = task.terminations.iter().chain(&task.finishes).map(|end| end.node).collect();
    let latch = |id: &NodeId| match graph.node(*id).operation {
        Operation::Memory(Memory::Hysteresis | Memory::Accumulate) => true,
        Operation::Memory(Memory::Highest | Memory::Lowest) => {
            graph.node(*id).inputs.first().is_some_and(|&input| sight::is_condition(graph, input))
        }
        _ => false,
    };
    for root in terms {
        let hidden = behind(task, root.node, &ends).into_iter().any(|id| latch(&id) && seen.binary_search(&id).is_err());
        if hidden {
            let message = format!("{} depends on what has happened before, and no channel tells it", root.what);
            let help = "name it and observe it: `let opened = ever(...)`, and `opened` in `observe`";
            diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
            return;
        }
    }
}

/// Velocities of things that move, where no channel tells any velocity of theirs.
fn velocities(
    checker: &Checker<'_>,
    task: &CheckedTask<'_>,
    (roots, terms): (&[Root], usize),
    seen: &[NodeId],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let landmarks = &checker.vocabulary.landmarks;
    let Some(first) = landmarks.iter().position(|landmark| landmark.of_scene) else { return };
    // What moves as one has the same carrier.
    let carrier = |sensor: Sensor| match sensor.subject() {
        Subject::Landmark(index) => sight::carrier(&task.scene.objects, index.checked_sub(first)?),
        Subject::Joint(index) => {
            let (object, _) = checker.vocabulary.joints.get(index)?.name.rsplit_once('.')?;
            let object = task.scene.objects.iter().position(|known| known.name == object)?;
            sight::carrier(&task.scene.objects, object)
        }
        _ => None,
    };
    let is_motion = |sensor: Sensor| {
        matches!(sensor, Sensor::LandmarkVelocity(_) | Sensor::LandmarkAngularVelocity(_) | Sensor::JointVelocity(_))
    };
    let carriers = |ids: &[NodeId], counts: &dyn Fn(Sensor) -> bool| -> BTreeSet<usize> {
        let sensors = ids.iter().filter_map(|id| match &task.graph.node(*id).operation {
            Operation::Sensors(sensors) => Some(sensors),
            _ => None,
        });
        sensors.flatten().filter(|sensor| counts(**sensor)).filter_map(|sensor| carrier(*sensor)).collect()
    };
    let (known, placed) = (carriers(seen, &is_motion), carriers(seen, &|sensor| !is_motion(sensor)));
    let mut warned = BTreeSet::new();
    for (index, root) in roots.iter().enumerate() {
        for moving in carriers(&task.graph.reachable([root.node]), &is_motion) {
            // Of a thing in a term that is not seen at all `unseen` warns.
            let unseen = index < terms && !placed.contains(&moving);
            if !known.contains(&moving) && !unseen && warned.insert(moving) {
                let name = &task.scene.objects[moving].name;
                let message = format!("{} depends on how `{name}` moves, and no channel tells it", root.what);
                let help = format!("observe it: `{name}.velocity in heading(pelvis)`, or `qd` of its joint");
                diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
            }
        }
    }
}

/// The graph with made-up values.
struct Surrogate<'t> {
    graph: &'t Graph,
    /// Nodes that a place or a direction in the world has a part in.
    placed: Vec<bool>,
    /// By landmark: whether it goes where the body goes.
    carried: Vec<bool>,
    /// The point about which the body is turned, and its sensor: the pelvis, whose place channels tell.
    centre: (Sensor, Vec<f64>),
}

/// By how much the body is turned, rad, and moved, m.
const TURN: f64 = 0.4;
const MOVE: f64 = 0.3;
/// The part of a value by which it changes at least where it depends on something.
const CHANGE: f64 = 1e-6;

impl<'t> Surrogate<'t> {
    fn new(checker: &Checker<'_>, task: &'t CheckedTask<'_>) -> Self {
        let graph = &task.graph;
        let mut placed = vec![false; graph.nodes().len()];
        for (index, node) in graph.nodes().iter().enumerate() {
            placed[index] = match &node.operation {
                Operation::Sensors(sensors) => sensors.iter().any(|sensor| role(*sensor) != Role::Within),
                _ => node.inputs.iter().any(|input| placed[input.index()]),
            };
        }
        let landmarks = &checker.vocabulary.landmarks;
        let first = landmarks.iter().position(|landmark| landmark.of_scene).unwrap_or(landmarks.len());
        let carried = |index: usize| match index.checked_sub(first) {
            Some(object) => sight::moves(&task.scene.objects, object),
            None => true,
        };
        let pelvis = landmarks.iter().position(|landmark| landmark.name == "pelvis");
        let centre = pelvis.map_or(Sensor::RootPosition, Sensor::LandmarkPosition);
        let carried = (0..landmarks.len()).map(carried).collect();
        Self { graph, placed, carried, centre: (centre, invented(centre)) }
    }

    /// Of each node, whether it answers to a change of the body's place.
    fn answers(&self, nodes: &[NodeId], shift: Shift) -> Vec<bool> {
        if !nodes.iter().any(|node| self.placed[node.index()]) {
            return vec![false; nodes.len()];
        }
        let needed: Vec<NodeId> = self.graph.reachable(nodes.iter().copied().filter(|node| self.placed[node.index()]));
        let [before, after] = [None, Some(shift)].map(|shift| {
            let mut values: Vec<Vec<f64>> = vec![Vec::new(); self.graph.nodes().len()];
            for &id in &needed {
                values[id.index()] = self.value(id, &values, shift);
            }
            values
        });
        let answers = |node: &NodeId| {
            let lanes = before[node.index()].iter().zip(&after[node.index()]);
            lanes.into_iter().any(|(a, b)| (a - b).abs() > CHANGE * (1.0 + a.abs()))
        };
        nodes.iter().map(answers).collect()
    }

    fn value(&self, id: NodeId, values: &[Vec<f64>], shift: Option<Shift>) -> Vec<f64> {
        let node = self.graph.node(id);
        if let Operation::Constant(lanes) = &node.operation {
            return lanes.iter().map(|lane| lane.value()).collect();
        }
        if let Operation::Sensors(sensors) = &node.operation {
            return sensors.iter().flat_map(|sensor| self.measured(*sensor, shift)).collect();
        }
        if !self.placed[id.index()] {
            // The same number whatever is changed.
            return (0..node.width).map(|lane| made_up(id.index(), lane)).collect();
        }
        let inputs: Vec<&[f64]> = node.inputs.iter().map(|input| values[input.index()].as_slice()).collect();
        let lane = |input: usize, index: usize| match inputs[input] {
            [only] => *only,
            lanes => lanes.get(index).copied().unwrap_or(0.0),
        };
        let each = |f: &dyn Fn(usize) -> f64| (0..node.width).map(f).collect::<Vec<f64>>();
        match &node.operation {
            Operation::Unary(Unary::Negate) => each(&|index| -lane(0, index)),
            Operation::Unary(Unary::Wrap) => each(&|index| lane(0, index)),
            Operation::Unary(_) => each(&|index| smooth(lane(0, index))),
            Operation::Binary(function) => each(&|index| {
                let (a, b) = (lane(0, index), lane(1, index));
                match function {
                    Binary::Add
                    | Binary::Subtract
                    | Binary::Multiply
                    | Binary::Divide
                    | Binary::Hypotenuse
                    | Binary::ArcTangent2 => function.apply(a, b),
                    Binary::Power => smooth(a) + 0.7 * b,
                    _ => smooth(a) + 0.7 * b + 0.1 * a * b,
                }
            }),
            Operation::Choose => each(&|index| {
                let condition = lane(0, index);
                lane(1, index) * (0.3 + condition) + lane(2, index) * (0.9 - condition)
            }),
            Operation::Select(lanes) => lanes.iter().map(|&from| lane(0, from as usize)).collect(),
            Operation::Join => inputs.concat(),
            Operation::Reduce(reduction, group) => {
                let parts = inputs[0].chunks_exact((*group as usize).max(1));
                match reduction {
                    Reduction::Sum | Reduction::Norm | Reduction::Product => parts.map(|lanes| reduction.apply(lanes)).collect(),
                    _ => parts.map(mixed).collect(),
                }
            }
            Operation::Memory(memory) => match memory {
                Memory::Highest | Memory::Lowest | Memory::Smooth | Memory::SmoothAngle | Memory::Sampled | Memory::Delay(_) => {
                    each(&|index| lane(0, index))
                }
                // Where it was at the beginning, it stays.
                Memory::Initial => (0..node.width).map(|lane| made_up(id.index(), lane)).collect(),
                Memory::Accumulate | Memory::Streak | Memory::StepsSince | Memory::Hysteresis => {
                    each(&|index| smooth(lane(0, index)))
                }
            },
            // Whatever else is computed answers to all that it reads.
            _ => {
                let all = mixed(&inputs.concat());
                (0..node.width).map(|lane| all + lane as f64).collect()
            }
        }
    }

    /// A sensor in the made-up state, with the body turned or moved.
    fn measured(&self, sensor: Sensor, shift: Option<Shift>) -> Vec<f64> {
        let mut lanes = invented(sensor);
        let carried = match sensor.subject() {
            Subject::Landmark(index) => self.carried.get(index).copied().unwrap_or(true),
            _ => true,
        };
        let Some(shift) = shift.filter(|_| carried) else { return lanes };
        match (role(sensor), shift) {
            (Role::Within, _) => {}
            (Role::Direction, Shift::Turned) => lanes.chunks_exact_mut(3).for_each(turn),
            (Role::Place, Shift::Turned) if sensor == self.centre.0 => {}
            (Role::Place, Shift::Turned) => {
                let centre = &self.centre.1;
                lanes.iter_mut().zip(centre).for_each(|(lane, centre)| *lane -= centre);
                turn(&mut lanes);
                lanes.iter_mut().zip(centre).for_each(|(lane, centre)| *lane += centre);
            }
            (Role::Place, Shift::AlongX) => lanes[0] += MOVE,
            (Role::Place, Shift::AlongY) => lanes[1] += MOVE,
            (Role::Direction, _) => {}
        }
        lanes
    }
}

/// The lanes of a sensor in the made-up state.
fn invented(sensor: Sensor) -> Vec<f64> {
    let place = match sensor.subject() {
        Subject::Landmark(index) | Subject::Joint(index) | Subject::Muscle(index) | Subject::Query(index) => index,
        _ => 0,
    };
    let kind = sensor.word().bytes().fold(0_usize, |sum, byte| sum.wrapping_mul(31).wrapping_add(usize::from(byte)));
    (0..sensor.size()).map(|lane| made_up(kind.wrapping_add(place.wrapping_mul(977)), lane)).collect()
}

/// What a sensor has to do with the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    /// Nothing: it is measured within the body, or is a number without direction.
    Within,
    /// A vector, or several, in world axes.
    Direction,
    /// A point of the world.
    Place,
}

fn role(sensor: Sensor) -> Role {
    use Sensor as S;
    match sensor {
        S::LandmarkPosition(_) | S::ComPosition | S::RootPosition | S::CentreOfPressure => Role::Place,
        S::LandmarkVelocity(_)
        | S::LandmarkAcceleration(_)
        | S::LandmarkAxes(_)
        | S::LandmarkAngularVelocity(_)
        | S::ComVelocity
        | S::ComAcceleration
        | S::AngularMomentum
        | S::RootAxes
        | S::RootVelocity
        | S::RootAngularVelocity
        | S::GroundForce(_)
        | S::ContactForce(..) => Role::Direction,
        _ => Role::Within,
    }
}

/// A vector turned about the vertical.
fn turn(vector: &mut [f64]) {
    let (sine, cosine) = (libm::sin(TURN), libm::cos(TURN));
    if let [x, y, ..] = vector {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

/// A smooth function without symmetry.
fn smooth(x: f64) -> f64 {
    x + 0.3 * x * x
}

/// All numbers together, each with a part of its own.
fn mixed(lanes: &[f64]) -> f64 {
    lanes.iter().enumerate().map(|(index, lane)| smooth(*lane) / (1.0 + index as f64)).sum()
}

/// A number between 0.2 and 1 that is always the same for a place.
fn made_up(place: usize, lane: usize) -> f64 {
    let (place, lane) = (place as u64, lane as u64);
    let mixed = (place.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ lane.wrapping_mul(0xC2B2_AE3D_27D4_EB4F))
        .wrapping_mul(0x1656_67B1_9E37_79F9)
        >> 20;
    0.2 + 0.8 * ((mixed % 10_007) as f64 / 10_007.0)
}
