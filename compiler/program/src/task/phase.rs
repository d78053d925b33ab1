//! Phases: the tasks of a sequence; a task that is no sequence has one.

use super::Channel;
use crate::debug::DebugInfo;
use crate::frame::FrameLayout;
use crate::graph::Graph;
use crate::lower::{Outputs, Plan, Program, assemble};
use std::ops::{Deref, Range};

/// What a phase is made of, as data.
#[derive(Debug)]
pub struct PhaseParts {
    /// The task's name.
    pub name: String,
    /// Its length, control steps.
    pub horizon: u32,
    /// What it computes.
    pub graph: Graph,
    /// What of the graph is asked for.
    pub outputs: Outputs,
    /// Which of the whole's terms are its own.
    pub terms: Range<usize>,
    /// Which of the whole's reasons that end an episode as a failure are its own.
    pub terminations: Range<usize>,
    /// Which of the whole's reasons that end an episode without being failures are its own.
    pub finishes: Range<usize>,
    /// Which of the whole's metrics are its own.
    pub metrics: Range<usize>,
    /// For each channel of the whole, those of the critic last: its place among the phase's own; the last may be missing where they
    /// are not its own.
    pub channels: Vec<Option<usize>>,
    /// For each of its draws: which random of the whole.
    pub streams: Vec<usize>,
    /// What explanations need of it.
    pub debug: DebugInfo,
}

/// A phase with the program that computes it.
pub struct Phase {
    parts: PhaseParts,
    pub(crate) program: Program,
    /// How many values all metrics of the whole have, and which are its own.
    pub(crate) measured: (usize, Range<usize>),
    /// What is observed while it lasts: all channels of the whole, zero where it has none.
    pub(crate) observation: Plan,
    /// What only a critic sees.
    pub(crate) critic: Plan,
}

impl Phase {
    /// Lowers a phase of a task that reads `frame`, observes these groups of channels (the policy's, the critic's) and measures `metrics`
    /// as a whole.
    pub fn new(mut parts: PhaseParts, frame: &FrameLayout, groups: [&[Channel]; 2], metrics: &[Channel]) -> Self {
        let mut program = assemble(&parts.graph, &parts.outputs, frame);
        parts.channels.resize(groups.iter().map(|group| group.len()).sum(), None);
        let mut own = parts.channels.iter();
        let [observation, critic] = groups.map(|channels| {
            let mut group = Plan::default();
            for (channel, own) in channels.iter().zip(own.by_ref()) {
                match own.and_then(|own| program.channels.get_mut(own)) {
                    Some(plan) => group.append(std::mem::take(plan)),
                    None => group.zeros(channel.size),
                }
            }
            group
        });
        let end = |count: usize| metrics[..count].last().map_or(0, |metric| metric.offset + metric.size);
        let measured = (end(metrics.len()), end(parts.metrics.start)..end(parts.metrics.end));
        Self { parts, program, measured, observation, critic }
    }
}

impl Deref for Phase {
    type Target = PhaseParts;

    fn deref(&self) -> &PhaseParts {
        &self.parts
    }
}
