//! Signals: what type checking finds that one reads, and the nodes of it.

use super::time;
use super::vectors::unit_vector;
use crate::frame::Sensor;
use crate::graph::operation::{Binary, Unary};
use crate::graph::{Graph, NodeId};

/// What a signal, or a property of each of several entities, is read from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Reading {
    /// Sensors side by side.
    Sensors(Vec<Sensor>),
    /// These with the opposite sign.
    Negated(Vec<Sensor>),
    /// The product of two, lane by lane.
    Product(Vec<Sensor>, Vec<Sensor>),
    /// The unit vector from one place to another.
    Direction {
        /// A position.
        from: Sensor,
        /// A position.
        to: Sensor,
    },
    /// What is known of the task and its body.
    Constants(Vec<f64>),
    /// Control steps since reset.
    Step,
    /// The same in seconds.
    Time {
        /// Length of a control step, s.
        interval: f64,
    },
}

impl Reading {
    /// One number that is known.
    pub(crate) fn constant(value: f64) -> Self {
        Self::Constants(vec![value])
    }

    /// The node of it.
    pub(crate) fn emit(self, graph: &mut Graph) -> NodeId {
        match self {
            Self::Sensors(sensors) => graph.sensors(sensors),
            Self::Negated(sensors) => {
                let value = graph.sensors(sensors);
                graph.unary(Unary::Negate, value)
            }
            Self::Product(left, right) => {
                let (left, right) = (graph.sensors(left), graph.sensors(right));
                graph.binary(Binary::Multiply, left, right)
            }
            Self::Direction { from, to } => {
                let (from, to) = (graph.sensors(vec![from]), graph.sensors(vec![to]));
                let along = graph.binary(Binary::Subtract, to, from);
                unit_vector(graph, along, 3)
            }
            Self::Constants(values) => graph.constants(&values),
            Self::Step => time::step(graph),
            Self::Time { interval } => time::time(graph, interval),
        }
    }
}
