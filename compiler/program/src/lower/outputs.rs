//! What a task wants computed, and the sensors that it takes.

use crate::frame::{FrameLayout, Query, Sensor};
use crate::graph::operation::Operation;
use crate::graph::{Graph, NodeId};
use std::collections::BTreeSet;

/// What a task wants computed.
#[derive(Debug, Clone, Default)]
pub struct Outputs {
    /// Value of each reward term.
    pub terms: Vec<NodeId>,
    /// Conditions that end an episode as a failure.
    pub terminations: Vec<NodeId>,
    /// Conditions that end an episode without being failures.
    pub finishes: Vec<NodeId>,
    /// What is logged.
    pub metrics: Vec<NodeId>,
    /// When the task has succeeded.
    pub success: Option<NodeId>,
    /// What is observed.
    pub channels: Vec<NodeId>,
    /// New value of each declared state.
    pub updates: Vec<NodeId>,
    /// In the order of their numbers.
    pub draws: Vec<DrawOutput>,
    /// Numbers that the initial state takes from what is drawn.
    pub initial_values: Vec<NodeId>,
    /// When connections let go.
    pub releases: Vec<NodeId>,
    /// Places that are shown.
    pub markers: Vec<NodeId>,
    /// What driven objects do in a control step: movement along x, y, z, m, and turn about the vertical, rad.
    pub drives: Vec<NodeId>,
    /// When the next phase begins.
    pub until: Option<NodeId>,
    /// Whether this phase has succeeded, for those after it.
    pub succeeded: Option<NodeId>,
}

/// A random.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DrawOutput {
    /// The random before its redraw: its inputs define how it is drawn.
    pub value: NodeId,
    /// When it is drawn anew.
    pub redraw: Option<NodeId>,
}

impl Outputs {
    /// Every node that is wanted, in the task's order.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        let ends = [&self.terms, &self.terminations, &self.finishes, &self.metrics, &self.channels, &self.updates];
        let scene = [&self.initial_values, &self.releases, &self.markers, &self.drives];
        let lists = ends.into_iter().chain(scene);
        let draws = self.draws.iter().flat_map(|draw| std::iter::once(draw.value).chain(draw.redraw));
        let single = [self.success, self.until, self.succeeded];
        lists.flatten().copied().chain(draws).chain(single.into_iter().flatten())
    }
}

/// The sensors on which reward, terminations and success depend: what only channels, metrics and markers read is left out.
pub(crate) fn deciding_sensors(graph: &Graph, outputs: &Outputs) -> BTreeSet<Sensor> {
    let shown = Outputs { channels: Vec::new(), metrics: Vec::new(), markers: Vec::new(), ..outputs.clone() };
    let sensors = graph.reachable(shown.roots()).into_iter().filter_map(|id| match &graph.node(id).operation {
        Operation::Sensors(sensors) => Some(sensors.clone()),
        _ => None,
    });
    sensors.flatten().collect()
}

/// The sensors that `outputs` read, and the queries of the terrain.
pub fn layout<'a>(graphs: impl Iterator<Item = (&'a Graph, &'a Outputs)>, queries: &[Query]) -> FrameLayout {
    let mut wanted = Vec::new();
    for (graph, outputs) in graphs {
        for id in graph.reachable(outputs.roots()) {
            if let Operation::Sensors(sensors) = &graph.node(id).operation {
                wanted.extend(sensors.iter().copied());
            }
        }
    }
    // Lists of sensors are in order for the most part, which sorting makes use of.
    wanted.sort();
    wanted.dedup();
    let mut layout = FrameLayout::with_queries(queries.to_vec());
    for sensor in wanted {
        layout.append(sensor);
    }
    layout
}

/// The places of all numbers of sensors in the frame, whose entries are in order.
pub(super) fn places(layout: &FrameLayout, sensors: &[Sensor]) -> Vec<usize> {
    let entries = layout.entries();
    let mut next = 0;
    let place = |sensor: &Sensor| {
        // Lists mostly go on with the next entry.
        if entries.get(next).is_none_or(|(known, _)| known != sensor) {
            next = entries.partition_point(|(known, _)| known < sensor);
        }
        next += 1;
        let offset = entries[next - 1].1;
        offset..offset + sensor.size()
    };
    sensors.iter().flat_map(place).collect()
}
