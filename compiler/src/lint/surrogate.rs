//! The formulas of a task in a made-up state, and whether they answer when the body is turned or moved.
//!
//! Dependence on heading and place cannot be read off the graph: a speed reads a world vector and does not depend on its
//! direction. So the formulas are computed twice, in a made-up state and in the same state with the body turned or moved, and compared.
//! Sums, products, quotients and norms are computed as they are, so that what cancels cancels; whatever saturates or decides is
//! replaced by a smooth function, so that no dependence hides behind a threshold.

use super::sight;
use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::frame::{Sensor, Subject};
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};

/// A change of the body's place in the world that leaves everything within the body as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shift {
    Turned,
    AlongX,
    AlongY,
}

/// The graph with made-up values.
pub(super) struct Surrogate<'t> {
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
    pub(super) fn new(checker: &Checker<'_>, task: &'t CheckedTask<'_>) -> Self {
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
    pub(super) fn answers(&self, nodes: &[NodeId], shift: Shift) -> Vec<bool> {
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
                // Where it was initially, it stays.
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
