//! Which nodes of a graph get a method of their own, and its name.

use crate::expression::is_condition;
use crate::text::identifier;
use msk_program::graph::operation::{Memory, Operation};
use msk_program::graph::{Graph, NodeId};
use msk_program::task::{CompiledTask, Phase};
use std::collections::{BTreeMap, BTreeSet};

/// A value with a method of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Method {
    /// Name of the method.
    pub name: String,
    /// Unit of a value that the task names.
    pub unit: Option<String>,
    /// Whether it is the method of a term or of an end of the episode.
    pub output: bool,
}

/// The methods for values of a phase, by node.
pub(crate) fn methods(task: &CompiledTask, phase: &Phase) -> BTreeMap<NodeId, Method> {
    let graph = &phase.graph;
    let reachable = graph.reachable(phase.outputs.roots());
    let (mut taken, mut methods) = (BTreeSet::new(), BTreeMap::new());
    for named in &phase.debug.lets {
        if reachable.binary_search(&named.node).is_err() || methods.contains_key(&named.node) {
            continue;
        }
        if !matches!(graph.node(named.node).operation, Operation::Constant(_)) {
            let name = free(&format!("let_{}", identifier(&named.name)), &mut taken);
            methods.insert(named.node, Method { name, unit: Some(named.unit.clone()), output: false });
        }
    }
    for (prefix, name, node, condition) in outputs(task, phase) {
        let plain = matches!(graph.node(node).operation, Operation::Constant(_));
        if is_condition(graph, node) == condition && !plain && !methods.contains_key(&node) {
            let name = free(&format!("{prefix}_{}", identifier(name)), &mut taken);
            methods.insert(node, Method { name, unit: None, output: true });
        }
    }
    let (counts, tried) = (counts(graph, &reachable, phase.outputs.roots()), tried(graph));
    for &id in &reachable {
        let node = graph.node(id);
        if tried[id.index()] {
            methods.remove(&id);
            continue;
        }
        let remembers = matches!(node.operation, Operation::Memory(_));
        let cheap = is_cheap(graph, id, &methods);
        if !methods.contains_key(&id) && (remembers || counts[id.index()] > 1 && !cheap) {
            let word = match node.operation {
                Operation::Memory(memory) => operator(memory),
                _ => "shared",
            };
            methods.insert(id, Method { name: free(word, &mut taken), unit: None, output: false });
        }
    }
    methods
}

/// Terms and ends of the episode: prefix and name of their methods, what computes them, and whether that is a condition.
fn outputs<'a>(task: &'a CompiledTask, phase: &'a Phase) -> impl Iterator<Item = (&'static str, &'a str, NodeId, bool)> {
    let outputs = &phase.outputs;
    let terms =
        task.terms.iter().map(|term| term.name.as_str()).zip(&outputs.terms).map(|(name, &node)| ("term", name, node, false));
    let ends = [("termination", &task.terminations, &outputs.terminations), ("finish", &task.finishes, &outputs.finishes)];
    let ends = ends
        .into_iter()
        .flat_map(|(prefix, names, nodes)| names.iter().zip(nodes).map(move |(name, &node)| (prefix, name.as_str(), node, true)));
    terms.chain(ends)
}

/// The word of the language for a cell that remembers.
pub(crate) fn operator(memory: Memory) -> &'static str {
    match memory {
        Memory::Initial => "initial",
        Memory::Highest => "running_max",
        Memory::Lowest => "running_min",
        Memory::Accumulate => "accumulate",
        Memory::Streak => "streak",
        Memory::StepsSince => "steps_since",
        Memory::Hysteresis => "hysteresis",
        Memory::Smooth => "smooth",
        Memory::SmoothAngle => "smooth_angle",
        Memory::Sampled => "sample_hold",
        Memory::Delay(_) => "delay",
    }
}

/// Which nodes depend on what chance gives at a try: they are computed where a random is drawn.
pub(crate) fn tried(graph: &Graph) -> Vec<bool> {
    let mut tried = vec![false; graph.nodes().len()];
    for (index, node) in graph.nodes().iter().enumerate() {
        tried[index] = match node.operation {
            Operation::Noise(..) => true,
            _ => !node.operation.is_held() && node.inputs.iter().any(|input| tried[input.index()]),
        };
    }
    tried
}

/// A name that no other method has.
fn free(wanted: &str, taken: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|number| format!("{wanted}_{number}"));
    let candidates = std::iter::once(wanted.to_owned()).chain(numbered);
    // There are always more numbers than names.
    let name = candidates.into_iter().find(|name| !taken.contains(name)).unwrap_or_default();
    taken.insert(name.clone());
    name
}

/// How often each node is read: by others, and as a result.
fn counts(graph: &Graph, reachable: &[NodeId], roots: impl Iterator<Item = NodeId>) -> Vec<usize> {
    let mut counts = vec![0; graph.nodes().len()];
    for input in reachable.iter().flat_map(|&id| &graph.node(id).inputs) {
        counts[input.index()] += 1;
    }
    roots.for_each(|root| counts[root.index()] += 1);
    counts
}

/// Whether a node may be written again wherever it is read.
fn is_cheap(graph: &Graph, id: NodeId, methods: &BTreeMap<NodeId, Method>) -> bool {
    let node = graph.node(id);
    match &node.operation {
        Operation::Constant(_) | Operation::Step | Operation::Sensors(_) => true,
        Operation::Select(_) => node.inputs.iter().all(|input| methods.contains_key(input) || is_cheap(graph, *input, methods)),
        operation => operation.is_held(),
    }
}
