//! Formulas that are linear in what is measured, and how far they reach.
//!
//! The interval analysis bounds a formula from outside: what it leaves open may never be met. Here is the other side: a sum of
//! measured numbers with constant factors takes, in some state of a body that stands or falls, the values that are stated of it.

use crate::extremes::{maximum, minimum};
use crate::frame::Sensor;
use crate::graph::interval::Bounds;
use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::vocabulary::Vocabulary;

/// Summands of a formula that are distinguished.
const MOST: usize = 16;

/// How deep a formula is followed, and how many of its nodes are looked at: one that is read twice is looked at twice.
const DEEPEST: usize = 64;
const LONGEST: usize = 1024;

/// A measured number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Measured {
    /// A lane of a sensor.
    Lane(Sensor, usize),
    /// The size of measured numbers, raised to a power.
    Size {
        /// Where it is computed.
        node: NodeId,
        /// One of the measured numbers.
        sensor: Sensor,
        /// Its lane, if it is measured alone and not as a vector.
        lane: Option<usize>,
        /// 1 for the size itself, 2 for its square.
        power: f64,
    },
}

/// Measured numbers, each with its factor, and what is added to them.
#[derive(Debug, Clone, Default)]
pub(super) struct Linear {
    pub parts: Vec<(Measured, f64)>,
    pub offset: f64,
    /// Nodes looked at.
    looked_at: usize,
}

/// Between which values a measured number is met in episodes of a body that stands, moves and falls.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    pub bounds: Bounds,
    /// Whether it goes on beyond the bounds, which then are what a fall reaches.
    pub open: bool,
}

impl Linear {
    /// A lane of a node as a sum of measured numbers, if it is one.
    pub(super) fn of(graph: &Graph, node: NodeId, lane: usize) -> Option<Self> {
        let mut found = Self::default();
        found.add(graph, node, lane, 1.0, 0)?;
        found.parts.retain(|(_, factor)| *factor != 0.0);
        Some(found)
    }

    fn add(&mut self, graph: &Graph, node: NodeId, lane: usize, factor: f64, depth: usize) -> Option<()> {
        self.looked_at += 1;
        if depth > DEEPEST || self.looked_at > LONGEST {
            return None;
        }
        let known = graph.node(node);
        let lane_of = |input: NodeId| if graph.width(input) == 1 { 0 } else { lane };
        let constant = |input: NodeId| graph.constant_lanes(input).and_then(|lanes| lanes.get(lane_of(input)).copied());
        let mut on = |input: NodeId, lane: usize, factor: f64| self.add(graph, input, lane, factor, depth + 1);
        match &known.operation {
            Operation::Constant(lanes) => self.offset += factor * lanes.get(lane)?.value(),
            Operation::Sensors(sensors) => {
                let mut left = lane;
                let sensor = sensors.iter().find(|sensor| {
                    let here = left < sensor.size();
                    left -= if here { 0 } else { sensor.size() };
                    here
                });
                self.measured(Measured::Lane(*sensor?, left), factor)?;
            }
            Operation::Select(lanes) => on(known.inputs[0], *lanes.get(lane)? as usize, factor)?,
            Operation::Join => {
                let mut left = lane;
                let part = known.inputs.iter().find(|&&part| {
                    let here = left < graph.width(part);
                    left -= if here { 0 } else { graph.width(part) };
                    here
                });
                on(*part?, left, factor)?;
            }
            Operation::Unary(Unary::Negate) => on(known.inputs[0], lane, -factor)?,
            Operation::Binary(function) => {
                let (a, b) = (known.inputs[0], known.inputs[1]);
                match (function, constant(a), constant(b)) {
                    (Binary::Add, ..) => on(a, lane_of(a), factor).and_then(|()| on(b, lane_of(b), factor))?,
                    (Binary::Subtract, ..) => on(a, lane_of(a), factor).and_then(|()| on(b, lane_of(b), -factor))?,
                    (Binary::Multiply, Some(by), _) => on(b, lane_of(b), factor * by)?,
                    (Binary::Multiply, _, Some(by)) => on(a, lane_of(a), factor * by)?,
                    (Binary::Divide, _, Some(by)) => on(a, lane_of(a), factor / by)?,
                    (Binary::Multiply, ..) if a == b => self.size(graph, node, (a, lane_of(a)), 2.0, factor)?,
                    (Binary::Power, _, Some(power)) if power > 0.0 && power % 2.0 == 0.0 => {
                        self.size(graph, node, (a, lane_of(a)), power, factor)?;
                    }
                    _ => return None,
                }
            }
            Operation::Unary(Unary::Absolute) => self.size(graph, node, (known.inputs[0], lane), 1.0, factor)?,
            Operation::Reduce(Reduction::Norm, group) => {
                self.size(graph, node, (known.inputs[0], lane * *group as usize), 1.0, factor)?;
            }
            Operation::Reduce(Reduction::Sum, group) => {
                let group = *group as usize;
                if group > MOST {
                    return self.long_sum(graph, node, known.inputs[0], factor);
                }
                for part in lane * group..(lane + 1) * group {
                    self.add(graph, known.inputs[0], part, factor, depth + 1)?;
                }
            }
            _ => return None,
        }
        Some(())
    }

    /// A long sum of sizes is a size.
    fn long_sum(&mut self, graph: &Graph, node: NodeId, summed: NodeId, factor: f64) -> Option<()> {
        let known = graph.node(summed);
        let power = match known.operation {
            Operation::Unary(Unary::Absolute) | Operation::Reduce(Reduction::Norm, _) => 1.0,
            Operation::Binary(Binary::Multiply) if known.inputs[0] == known.inputs[1] => 2.0,
            _ => return None,
        };
        self.size(graph, node, (known.inputs[0], 0), power, factor)
    }

    /// A power of the size of measured numbers, of which the first stands for all.
    fn size(&mut self, graph: &Graph, node: NodeId, (of, lane): (NodeId, usize), power: f64, factor: f64) -> Option<()> {
        let mut inner = Self { looked_at: self.looked_at, ..Self::default() };
        inner.add(graph, of, lane, 1.0, 0)?;
        self.looked_at = inner.looked_at;
        let alone = !matches!(graph.node(node).operation, Operation::Reduce(..));
        let found = match inner.parts.first()?.0 {
            Measured::Lane(sensor, lane) => Measured::Size { node, sensor, lane: Some(lane).filter(|_| alone), power },
            Measured::Size { sensor, lane, power: inner, .. } => Measured::Size { node, sensor, lane, power: power * inner },
        };
        self.measured(found, factor)
    }

    fn measured(&mut self, found: Measured, factor: f64) -> Option<()> {
        if let Some((_, known)) = self.parts.iter_mut().find(|(known, _)| *known == found) {
            *known += factor;
            return Some(());
        }
        self.parts.push((found, factor));
        (self.parts.len() <= MOST).then_some(())
    }

    /// Between which values the sum is met, and whether it goes on beyond the lowest and the highest.
    pub(super) fn reach(&self, vocabulary: &Vocabulary) -> Option<(Bounds, [bool; 2])> {
        let (mut low, mut high, mut open) = (self.offset, self.offset, [false, false]);
        for (measured, factor) in &self.parts {
            let reach = measured.reach(vocabulary)?;
            let (a, b) = (factor * reach.bounds.low, factor * reach.bounds.high);
            low += minimum(a, b);
            high += maximum(a, b);
            // A size is open above only.
            let below = reach.open && !matches!(measured, Measured::Size { .. });
            let [down, up] = if *factor > 0.0 { [below, reach.open] } else { [reach.open, below] };
            open = [open[0] || down, open[1] || up];
        }
        Some((Bounds::new(low, high), open))
    }
}

/// What a fall reaches: m/s, rad/s, and how far from the start a body comes, m.
const SPEED: f64 = 4.0;
const TURNING: f64 = 10.0;
const AWAY: f64 = 3.0;
/// The height of parts of a body that lies, m.
const LYING: f64 = 0.1;

impl Measured {
    /// Between which values it is met; nothing where that is not known.
    pub(super) fn reach(&self, vocabulary: &Vocabulary) -> Option<Reach> {
        let reach = |low, high, open| Some(Reach { bounds: Bounds::new(low, high), open });
        match *self {
            Self::Size { sensor, lane, power, .. } => {
                let of = Self::Lane(sensor, lane.unwrap_or(0)).reach(vocabulary)?;
                let size = maximum(of.bounds.low.abs(), of.bounds.high.abs());
                reach(0.0, libm::pow(size, power), of.open)
            }
            Self::Lane(sensor, lane) => match sensor {
                Sensor::JointPosition(joint) => {
                    let [low, high] = vocabulary.joints.get(joint)?.range?;
                    reach(low, high, false)
                }
                Sensor::LandmarkAxes(_) | Sensor::RootAxes | Sensor::Action(_) | Sensor::ActionEntry(_) => {
                    reach(-1.0, 1.0, false)
                }
                Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) => reach(0.0, 1.0, false),
                Sensor::LandmarkPosition(index) => {
                    let landmark = vocabulary.landmarks.get(index)?;
                    match lane {
                        2 if landmark.of_scene => None,
                        2 => reach(LYING, maximum(landmark.neutral_position[2], LYING), false),
                        _ => reach(-AWAY, AWAY, true),
                    }
                }
                Sensor::ComPosition if lane == 2 => reach(LYING, maximum(vocabulary.neutral_com[2], LYING), false),
                Sensor::ComPosition => reach(-AWAY, AWAY, true),
                Sensor::LandmarkVelocity(_) | Sensor::ComVelocity | Sensor::RootVelocity => reach(-SPEED, SPEED, true),
                Sensor::LandmarkAngularVelocity(_) | Sensor::RootAngularVelocity => reach(-TURNING, TURNING, true),
                Sensor::JointVelocity(joint) if vocabulary.joints.get(joint).is_some_and(|joint| !joint.of_scene) => {
                    reach(-TURNING, TURNING, true)
                }
                _ => None,
            },
        }
    }

    /// Of which number `value` is the power.
    pub(super) fn root(&self, value: f64) -> f64 {
        match self {
            Self::Size { power, .. } => libm::pow(value, 1.0 / power),
            Self::Lane(..) => value,
        }
    }

    /// What it is, as tasks write it, and the unit in which people read it with how many of the unit are one in SI.
    pub(super) fn described(&self, vocabulary: &Vocabulary) -> (String, &'static str, f64) {
        let landmark = |index: usize| vocabulary.landmarks.get(index).map_or("", |landmark| landmark.name.as_str());
        let joint = |index: usize| vocabulary.joints.get(index).map_or("", |joint| joint.name.as_str());
        let (sensor, lane) = match *self {
            Self::Lane(sensor, lane) => (sensor, Some(lane)),
            Self::Size { sensor, lane: None, .. } => (sensor, None),
            Self::Size { sensor, lane, .. } => {
                let (name, unit, scale) = Self::Lane(sensor, lane.unwrap_or(0)).described(vocabulary);
                return (format!("abs({name})"), unit, scale);
            }
        };
        let component = |name: String| match lane {
            Some(lane) => format!("{name}.{}", ["x", "y", "z"][lane % 3]),
            None => format!("the size of {name}"),
        };
        let velocity = |name: &str| match lane {
            Some(_) => component(format!("{name}.velocity")),
            None => format!("{name}.speed"),
        };
        let place = |name: &str| match lane {
            Some(2) => format!("{name}.height"),
            Some(_) => component(format!("{name}.position")),
            None => format!("a distance of {name}"),
        };
        let plain = |name: String| if lane.is_some() { name } else { format!("the size of {name}") };
        let degrees = 180.0 / std::f64::consts::PI;
        match sensor {
            Sensor::JointPosition(index) => (plain(format!("{}.q", joint(index))), "deg", degrees),
            Sensor::JointVelocity(index) => (plain(format!("{}.qd", joint(index))), "rad/s", 1.0),
            Sensor::LandmarkAxes(index) => {
                let axis = ["forward", "left", "up"][lane.unwrap_or(0) / 3 % 3];
                (component(format!("{}.{axis}", landmark(index))), "", 1.0)
            }
            Sensor::LandmarkPosition(index) => (place(landmark(index)), "m", 1.0),
            Sensor::ComPosition => (place("com"), "m", 1.0),
            Sensor::LandmarkVelocity(index) => (velocity(landmark(index)), "m/s", 1.0),
            Sensor::ComVelocity => (velocity("com"), "m/s", 1.0),
            Sensor::RootVelocity => (component("the root's velocity".to_owned()), "m/s", 1.0),
            Sensor::LandmarkAngularVelocity(index) => (component(format!("{}.angular_velocity", landmark(index))), "rad/s", 1.0),
            Sensor::MuscleActivation(_) => (plain("an activation".to_owned()), "", 1.0),
            Sensor::MuscleExcitation(_) => (plain("an excitation".to_owned()), "", 1.0),
            Sensor::Action(_) | Sensor::ActionEntry(_) => (plain("an action".to_owned()), "", 1.0),
            _ => (plain("a signal that it reads".to_owned()), "", 1.0),
        }
    }
}
