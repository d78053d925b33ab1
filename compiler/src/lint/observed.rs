//! What reward or ends depend on and no channel determines: the heading, the place, the time, latches, velocities of objects.

use super::sight;
use super::surrogate::{Shift, Surrogate};
use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Code, Diagnostic, FileId, Span, codes};
use crate::frame::{Sensor, Subject};
use crate::graph::NodeId;
use crate::graph::events::is_event;
use crate::graph::operation::{Binary, Memory, Operation};
use crate::scene::Shape;
use crate::task::Setting;
use std::collections::BTreeSet;

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
    let rewarded = task.terms.iter().map(|term| Root {
        what: format!("the term `{}`", term.name),
        node: term.node,
        file: term.file,
        span: term.formula.span,
    });
    let ended = task.terminations.iter().chain(&task.finishes);
    let ended =
        ended.map(|end| Root { what: format!("the termination `{}`", end.name), node: end.node, file: end.file, span: end.span });
    let roots: Vec<Root> = rewarded.chain(ended).collect();
    let channels: Vec<NodeId> = task.observed().map(|channel| channel.node).collect();
    places(checker, task, &roots, terms, &channels, diagnostics);
    let seen = task.graph.reachable(channels);
    time(task, &roots[..terms], &seen, diagnostics);
    latches(task, &roots[..terms], &seen, diagnostics);
    velocities(checker, task, &roots, &seen, diagnostics);
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
    let turning = turning(task);
    let mut by_axis = false;
    for (index, root) in roots[..terms].iter().enumerate() {
        let placed = depends[1][index] || depends[2][index];
        let Some(turning) = turning.filter(|_| depends[0][index] && !placed) else { continue };
        let (why, help) = match turning {
            Turning::Start => (
                "the initial heading is random".to_owned(),
                "use a component along the body's own heading: `(com.velocity in heading(pelvis)).forward`".to_owned(),
            ),
            Turning::Object(object) if !reads(checker, task, root.node, object) => {
                let name = &task.scene.objects[object].name;
                let help = format!(
                    "use a component along the direction to it: `dot(com.velocity, normalize({name}.position - pelvis.position))`"
                );
                (format!("the initial orientation of `{name}` is random"), help)
            }
            Turning::Object(_) => continue,
        };
        let message = format!("{} reads an axis of the world, and {why}", root.what);
        diagnostics.push(root.warning(codes::incentive::WORLD_AXIS, message).help(help));
        by_axis = true;
    }
    // A policy that observes the place can infer the heading from it.
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
            "the heading of the body",
            "observe it, `sin(pelvis.yaw)` and `cos(pelvis.yaw)`, or use vectors in `heading(pelvis)`",
        ),
        (
            x.or(y),
            match (x, y) {
                (Some(_), Some(_)) => "the place of the body in the world",
                (Some(_), None) => "the body's position along the world's x",
                _ => "the body's position along the world's y",
            },
            "observe the place, `pelvis.position`, or a relative position: `(target - pelvis.position) in heading(pelvis)`",
        ),
    ];
    for (root, what, help) in hidden {
        if let Some(root) = root.and_then(|index| roots.get(index)) {
            let message = format!("{} depends on {what}, which no channel contains", root.what);
            diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
        }
    }
}

/// What turns from episode to episode.
#[derive(Clone, Copy)]
enum Turning {
    /// The body.
    Start,
    /// A thing of the scene that is not round.
    Object(usize),
}

fn turning(task: &CheckedTask<'_>) -> Option<Turning> {
    let drawn = || task.init.drawn.iter().map(|(setting, _)| *setting);
    if drawn().any(|setting| matches!(setting, Setting::RootHeading)) {
        return Some(Turning::Start);
    }
    let round = |object: usize| matches!(task.scene.objects[object].shape, Some(Shape::Sphere { .. }));
    let object = drawn().find_map(|setting| match setting {
        Setting::ObjectOrientation(place, _) => Some(task.init.objects.get(place)?.object).filter(|object| !round(*object)),
        _ => None,
    });
    object.map(Turning::Object)
}

/// Whether a formula measures an object or what it carries.
fn reads(checker: &Checker<'_>, task: &CheckedTask<'_>, node: NodeId, object: usize) -> bool {
    let landmarks = &checker.vocabulary.landmarks;
    let Some(first) = landmarks.iter().position(|landmark| landmark.of_scene) else { return false };
    let measures = |sensor: &Sensor| match sensor.subject() {
        Subject::Landmark(index) => {
            index.checked_sub(first).and_then(|index| sight::carrier(&task.scene.objects, index)) == Some(object)
        }
        _ => false,
    };
    task.graph.reachable([node]).iter().any(|id| match &task.graph.node(*id).operation {
        Operation::Sensors(sensors) => sensors.iter().any(measures),
        _ => false,
    })
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
        let message = format!("{} depends on the time, which no channel contains", root.what);
        let help =
            "observe `t`, or of a clock `sin(phase)` and `cos(phase)`: otherwise the same observation can have different rewards";
        diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
    }
}

/// What a node needs; ends, and what is rewarded in single steps, are not looked into.
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
            let message = format!("{} depends on the history of the episode, which no channel contains", root.what);
            let help = "name it and observe it: `let opened = ever(...)`, and `opened` in `observe`";
            diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
            return;
        }
    }
}

/// Velocities of things that move, where no channel tells any velocity of theirs.
fn velocities(checker: &Checker<'_>, task: &CheckedTask<'_>, roots: &[Root], seen: &[NodeId], diagnostics: &mut Vec<Diagnostic>) {
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
    for root in roots {
        for moving in carriers(&task.graph.reachable([root.node]), &is_motion) {
            // Of a thing that is not seen at all `unobserved_object` warns.
            let unseen = !placed.contains(&moving);
            if !known.contains(&moving) && !unseen && warned.insert(moving) {
                let name = &task.scene.objects[moving].name;
                let message = format!("{} depends on the motion of `{name}`, which no channel contains", root.what);
                let help = format!("observe it: `{name}.velocity in heading(pelvis)`, or `qd` of its joint");
                diagnostics.push(root.warning(codes::incentive::UNDETERMINED, message).help(help));
            }
        }
    }
}
