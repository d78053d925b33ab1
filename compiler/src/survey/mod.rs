//! The evaluation of a task in a pose: between which values its terms are, and how far its conditions are from holding and from
//! failing.
//!
//! A pose settles where everything is, nothing else: speeds, forces, activations, time, chance and all that remembers may be
//! anything within their ranges. So a condition that reads them is left open, and what is decided is decided by the pose
//! alone (`seen`). A caller that shows many poses ([`Survey::look`]) learns which conditions none of them decides otherwise;
//! [`Survey::lack`] gives how much is missing, so that one may search for more (`lack`).

mod lack;
mod seen;

use crate::check::{OperatingRange, Timing};
use crate::diagnostics::{FileId, Span};
use crate::extremes::minimum;
use crate::frame::Sensor;
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::Operation;
use crate::graph::{Graph, NodeId};
use crate::spoken::SpokenUnit;
use crate::task::{CompiledTask, Phase};
use lack::Lack;
use seen::Seen;
use std::collections::{BTreeMap, BTreeSet};

/// What a subject is, with its place among those of the whole task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// A reward term.
    Term(usize),
    /// The condition of a reason that ends an episode as a failure.
    Termination(usize),
    /// The condition of a reason that ends an episode without being a failure.
    Finish(usize),
    /// The condition of success.
    Success,
    /// A comparison within any formula.
    Comparison,
}

/// Something whose value in poses is looked at.
#[derive(Debug, Clone)]
pub struct Subject {
    /// What it is.
    pub about: About,
    /// Where its formula stands.
    pub at: (FileId, Span),
    /// Unit of both sides of a comparison.
    pub unit: SpokenUnit,
    /// Whether it reads what ends an episode.
    pub reads_ends: bool,
    /// Whether chance, a motion or the time has a part in it, beside the state of body and scene.
    pub reads_more: bool,
    /// Whether the formula of a term shows by itself that it does not always contribute: it is gated or a condition.
    pub gated: bool,
    /// Whether it reads poses alone: no speed, force or activation.
    pub of_pose: bool,
    /// Between which values it stays whatever happens.
    pub range: Bounds,
    node: NodeId,
    sides: Option<[NodeId; 2]>,
    /// Nodes that depend on the pose, inputs before their readers.
    needs: Vec<NodeId>,
    /// Nodes of conditions that it is made of, in the same order.
    logic: Vec<NodeId>,
}

/// The subjects of one phase of a task, and what they are in the pose looked at last.
pub struct Survey<'a> {
    graph: &'a Graph,
    subjects: Vec<Subject>,
    ranges: OperatingRange<'a>,
    offsets: BTreeMap<Sensor, usize>,
    bounds: Vec<Vec<Bounds>>,
    lacks: BTreeMap<NodeId, Vec<Lack>>,
}

impl<'a> Survey<'a> {
    /// For a phase of a task: 0 for a task by itself.
    pub fn new(task: &'a CompiledTask, index: usize) -> Option<Self> {
        let phase = task.phases.get(index)?;
        let before = task.phases[..index].iter().fold(0_u32, |sum, phase| sum.saturating_add(phase.horizon));
        let (graph, outputs) = (&phase.graph, &phase.outputs);
        let ranges = OperatingRange {
            vocabulary: &task.vocabulary,
            timing: Timing { interval: 1.0 / task.control_frequency, horizon: phase.horizon, before },
            queries: task.frame.queries(),
        };
        let mut bounds: Vec<Vec<Bounds>> = vec![Vec::new(); graph.nodes().len()];
        let deciding = [&outputs.terms, &outputs.terminations, &outputs.finishes, &outputs.updates, &outputs.releases];
        let single = outputs.success.into_iter().chain(outputs.until);
        let roots: Vec<NodeId> = deciding.into_iter().flatten().copied().chain(single).collect();
        let live = graph.reachable(roots);
        for &id in &live {
            bounds[id.index()] = interval::of_node(graph, id, &bounds, &ranges);
        }
        let mut survey = Self {
            graph,
            subjects: Vec::new(),
            ranges,
            offsets: task.frame.entries().iter().copied().collect(),
            bounds,
            lacks: BTreeMap::new(),
        };
        survey.gather(task, phase, &live);
        Some(survey)
    }

    /// How many phases a task has: one if it is no sequence.
    pub fn phases(task: &CompiledTask) -> usize {
        task.phases.len()
    }

    fn gather(&mut self, task: &CompiledTask, phase: &Phase, live: &[NodeId]) {
        let outputs = &phase.outputs;
        let mut varies = vec![false; self.graph.nodes().len()];
        for &id in live {
            let node = self.graph.node(id);
            varies[id.index()] = match &node.operation {
                Operation::Sensors(sensors) => sensors.iter().any(|sensor| seen::of_pose(*sensor)),
                operation => !lasts(operation) && node.inputs.iter().any(|input| varies[input.index()]),
            };
        }
        let ends: BTreeSet<NodeId> = outputs.terminations.iter().chain(&outputs.finishes).copied().collect();
        let gates: BTreeMap<usize, bool> = phase.terms.clone().zip(phase.debug.terms.iter().map(|term| term.gated)).collect();
        let mut add = |about, at, node: NodeId, sides: Option<[NodeId; 2]>, unit: SpokenUnit| {
            let reached = self.graph.reachable([node]);
            let range = interval::of_scalar(&self.bounds, node);
            let varying = |id: NodeId| varies[id.index()];
            let roots = std::iter::once(node).chain(sides.into_iter().flatten());
            self.subjects.push(Subject {
                about,
                at,
                unit,
                reads_ends: reached.iter().any(|id| ends.contains(id)),
                reads_more: reached.iter().any(|id| is_more(&self.graph.node(*id).operation)),
                gated: matches!(about, About::Term(index) if gates.get(&index) == Some(&true)),
                of_pose: reached.iter().all(|id| match &self.graph.node(*id).operation {
                    Operation::Sensors(sensors) => sensors.iter().all(|sensor| seen::of_pose(*sensor)),
                    _ => true,
                }),
                range,
                node,
                sides,
                needs: within(self.graph, roots, varying),
                logic: lack::logic(self.graph, node),
            });
        };
        let places = &task.places;
        let own = |range: &std::ops::Range<usize>, nodes: &[NodeId]| range.clone().zip(nodes.to_vec()).collect::<Vec<_>>();
        for (index, node) in own(&phase.terms, &outputs.terms) {
            if let Some(at) = places.terms.get(index) {
                add(About::Term(index), *at, node, None, SpokenUnit::si(""));
            }
        }
        for (index, node) in own(&phase.terminations, &outputs.terminations) {
            if let Some(at) = places.terminations.get(index) {
                add(About::Termination(index), *at, node, None, SpokenUnit::si(""));
            }
        }
        for (index, node) in own(&phase.finishes, &outputs.finishes) {
            if let Some(at) = places.finishes.get(index) {
                add(About::Finish(index), *at, node, None, SpokenUnit::si(""));
            }
        }
        let last = task.phases.last().is_some_and(|last| std::ptr::eq(last, phase));
        if let Some(node) = outputs.success.filter(|_| last) {
            add(About::Success, places.success, node, None, SpokenUnit::si(""));
        }
        let live: BTreeSet<NodeId> = live.iter().copied().collect();
        for compared in phase.debug.comparisons.iter().filter(|compared| live.contains(&compared.node)) {
            let at = (compared.file, compared.span);
            add(About::Comparison, at, compared.node, Some(compared.sides), compared.unit.clone());
        }
    }

    /// What is looked at: terms, terminations, finishes, success, comparisons, each in the order of the text.
    pub fn subjects(&self) -> &[Subject] {
        &self.subjects
    }

    /// Looks at all subjects in a pose: `frame` is the sensor record of [`CompiledTask::frame`]. Contacts count only where
    /// `trusted` has them.
    pub fn look(&mut self, frame: &[f64], trusted: &BTreeSet<Sensor>) {
        for subject in 0..self.subjects.len() {
            self.look_at(subject, frame, trusted);
        }
    }

    /// The same for one subject.
    pub fn look_at(&mut self, subject: usize, frame: &[f64], trusted: &BTreeSet<Sensor>) {
        let Self { graph, subjects, ranges, offsets, bounds, lacks } = self;
        let Some(subject) = subjects.get(subject) else { return };
        let seen = Seen { ranges, offsets, frame, trusted };
        for &id in &subject.needs {
            bounds[id.index()] = interval::of_node(graph, id, bounds, &seen);
        }
        for &id in &subject.logic {
            let lack = lack::of(graph, id, bounds, lacks);
            lacks.insert(id, lack);
        }
    }

    /// Between which values a subject is in the pose looked at; the widest of its lanes.
    pub fn bounds(&self, subject: usize) -> Bounds {
        self.subjects.get(subject).map_or(Bounds::ANY, |subject| interval::of_scalar(&self.bounds, subject.node))
    }

    /// How much is missing in the pose looked at until a condition holds (`wanted`) or fails; 0 if it does or may.
    pub fn lack(&self, subject: usize, wanted: bool) -> f64 {
        let known = self.subjects.get(subject).and_then(|subject| self.lacks.get(&subject.node));
        let lanes = known.map_or(&[][..], Vec::as_slice).iter();
        let missing = lanes.map(|lack| if wanted { lack.to_hold } else { lack.to_fail });
        missing.reduce(minimum).unwrap_or(0.0)
    }

    /// Whether a subject reads another one.
    pub fn reads(&self, subject: usize, other: usize) -> bool {
        let node = |subject: usize| self.subjects.get(subject).map(|subject| subject.node);
        node(subject).zip(node(other)).is_some_and(|(node, other)| self.graph.reachable([node]).contains(&other))
    }

    /// The two sides of a comparison in the pose looked at, in the order of the text.
    pub fn sides(&self, subject: usize) -> Option<[Bounds; 2]> {
        let sides = self.subjects.get(subject)?.sides?;
        Some(sides.map(|side| interval::of_scalar(&self.bounds, side)))
    }
}

/// Whether a value is not that of the present snapshot alone: a pose does not decide it.
fn lasts(operation: &Operation) -> bool {
    operation.remembers() || matches!(operation, Operation::PhaseSuccess(_))
}

fn is_more(operation: &Operation) -> bool {
    matches!(
        operation,
        Operation::Step
            | Operation::Noise(..)
            | Operation::Drawn(_)
            | Operation::DrawnAfter(_)
            | Operation::Follow(_)
            | Operation::PhaseSuccess(_)
    )
}

/// The nodes that `roots` need and `wanted` takes, ascending; nothing is looked for behind the others.
fn within(graph: &Graph, roots: impl Iterator<Item = NodeId>, wanted: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
    let mut found = BTreeSet::new();
    let mut pending: Vec<NodeId> = roots.collect();
    while let Some(id) = pending.pop() {
        if wanted(id) && found.insert(id) {
            pending.extend(&graph.node(id).inputs);
        }
    }
    found.into_iter().collect()
}
