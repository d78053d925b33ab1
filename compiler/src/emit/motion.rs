//! Motions that an episode follows: all that is read of one is read at one and the same time.

use super::time::time;
use crate::frame::Sensor;
use crate::graph::operation::{Binary, Memory, Operation};
use crate::graph::track::Track;
use crate::graph::{Graph, NodeId};

/// When an episode reads a motion: at the phase `start + t / duration`, counted in turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotionClock {
    /// The phase at which the episode starts.
    pub start: NodeId,
    /// How long the motion takes, s.
    pub duration: f64,
    /// Length of a control step, s.
    pub interval: f64,
}

impl MotionClock {
    /// Turns since phase 0, with the start in them.
    fn turns(self, graph: &mut Graph) -> NodeId {
        let (time, duration) = (time(graph, self.interval), graph.constant(self.duration));
        let turns = graph.binary(Binary::Divide, time, duration);
        graph.binary(Binary::Add, self.start, turns)
    }

    /// The phase, 0 to 1: a cycle begins again, any other motion stays at its end.
    pub(crate) fn phase(self, graph: &mut Graph, cycle: bool) -> NodeId {
        let (turns, one) = (self.turns(graph), graph.constant(1.0));
        graph.binary(if cycle { Binary::Modulo } else { Binary::Minimum }, turns, one)
    }

    /// The time of the motion now, s.
    pub(crate) fn now(self, graph: &mut Graph) -> NodeId {
        let turns = self.turns(graph);
        self.in_seconds(graph, turns)
    }

    fn in_seconds(self, graph: &mut Graph, turns: NodeId) -> NodeId {
        let duration = graph.constant(self.duration);
        graph.binary(Binary::Multiply, turns, duration)
    }
}

/// What columns of a motion show at a time of it.
pub(crate) fn columns(graph: &mut Graph, track: Track, time: NodeId) -> NodeId {
    graph.add(Operation::Follow(track), &[time])
}

/// Where something of a motion is, in columns x, y and z, when the motion starts under the root; `level` are the columns x and y of
/// the motion's root.
pub(crate) fn carried(graph: &mut Graph, clock: MotionClock, place: Track, level: Track) -> NodeId {
    let now = clock.now(graph);
    let start = clock.in_seconds(graph, clock.start);
    let place = columns(graph, place, now);
    let begun = graph.sensors(vec![Sensor::RootPosition]);
    let begun = graph.memory(Memory::Initial, &[begun]);
    let begun = graph.select([0, 1], begun);
    let origin = columns(graph, level, start);
    let shift = graph.binary(Binary::Subtract, begun, origin);
    let zero = graph.constant(0.0);
    let shift = graph.join(&[shift, zero]);
    graph.binary(Binary::Add, place, shift)
}
