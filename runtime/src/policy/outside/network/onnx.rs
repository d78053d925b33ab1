//! Networks as ONNX files, which every training library writes, evaluated by `rten`. Its products use the widest instructions of the
//! processor, so the last bits of an action differ between kinds of processors.

use rten::{Dimension, Model, ModelOptions, NodeId, OpRegistry, RunOptions, ThreadPool, op_registry};
use rten_tensor::prelude::*;
use rten_tensor::{NdTensor, Tensor};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Names of outputs that are the action, where a network gives more than one.
const ACTIONS: [&str; 4] = ["action", "actions", "mean_actions", "output"];

/// A graph that takes one observation and gives one action.
#[derive(Clone)]
pub(crate) struct Graph {
    model: Arc<Model>,
    input: Port,
    output: Port,
}

/// An end of the graph.
#[derive(Debug, Clone, PartialEq)]
struct Port {
    node: NodeId,
    name: String,
    /// Length of a row; unknown where the file leaves it open.
    width: Option<usize>,
    /// Whether rows are stacked: [batch, width].
    stacked: bool,
}

impl core::fmt::Debug for Graph {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Graph").field("input", &self.input).field("output", &self.output).finish_non_exhaustive()
    }
}

impl Graph {
    /// From the bytes of a file.
    ///
    /// # Errors
    /// What is wrong with it, in words that continue the name of the file.
    pub fn read(bytes: Vec<u8>) -> Result<Self, String> {
        let load = || ModelOptions::with_ops(operators()).load(bytes);
        let model = guarded(load)?.map_err(|error| format!("is no ONNX file that can be evaluated: {error}"))?;
        let input = only_input(&model)?;
        let output = action_output(&model)?;
        Ok(Self { model: Arc::new(model), input, output })
    }
}

/// One worker's evaluation of a graph.
#[derive(Clone)]
pub(crate) struct Evaluation {
    graph: Graph,
    options: RunOptions,
}

impl core::fmt::Debug for Evaluation {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Evaluation").field("graph", &self.graph).finish_non_exhaustive()
    }
}

impl Evaluation {
    pub fn new(graph: &Graph) -> Self {
        // Episodes are played in parallel already.
        let options = RunOptions::default().with_thread_pool(Some(Arc::new(ThreadPool::with_num_threads(1))));
        Self { graph: graph.clone(), options }
    }

    /// Numbers that it takes and gives, as far as the file says.
    pub fn sizes(&self) -> [Option<usize>; 2] {
        [self.graph.input.width, self.graph.output.width]
    }

    /// Replaces an observation by the action that answers to it.
    ///
    /// # Errors
    /// An evaluation that fails, or gives something else than one row of numbers.
    pub fn forward(&self, values: &mut Vec<f32>) -> Result<(), String> {
        let Graph { model, input, output } = &self.graph;
        let (length, seen) = (values.len(), std::mem::take(values));
        let seen: Tensor<f32> = match input.stacked {
            true => NdTensor::from_data([1, length], seen).into_dyn(),
            false => NdTensor::from_data([length], seen).into_dyn(),
        };
        let run = || model.run(vec![(input.node, seen.into())], &[output.node], Some(self.options.clone()));
        let mut given = guarded(run)?.map_err(|error| format!("cannot be evaluated: {error}"))?;
        let given = given.pop().and_then(|value| value.into_tensor::<f32>());
        let given = given.ok_or_else(|| format!("gives no numbers in single precision at its output `{}`", output.name))?;
        *values = given.to_vec();
        Ok(())
    }
}

/// What networks of policies are made of. Loops, and what makes large tensors of small ones, are left out: an evaluation ends, and takes
/// no more memory than its file leads one to expect.
fn operators() -> OpRegistry {
    op_registry!(
        Add,
        BatchNormalization,
        Cast,
        Clip,
        Concat,
        Div,
        Elu,
        Erf,
        Exp,
        Flatten,
        Gather,
        Gelu,
        Gemm,
        HardSigmoid,
        HardSwish,
        Identity,
        LayerNormalization,
        LeakyRelu,
        Log,
        MatMul,
        Max,
        Min,
        Mul,
        Neg,
        PRelu,
        Pow,
        ReduceMean,
        Relu,
        Reshape,
        Shape,
        Sigmoid,
        Slice,
        Softmax,
        Softplus,
        Split,
        Sqrt,
        Squeeze,
        Sub,
        Tanh,
        Transpose,
        Unsqueeze
    )
}

/// What `work` returns; a panic in it becomes an error.
fn guarded<R>(work: impl FnOnce() -> R) -> Result<R, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| "is an ONNX file that the evaluation gives up on".to_owned())
}

fn only_input(model: &Model) -> Result<Port, String> {
    match model.input_ids() {
        [node] => port(model, *node),
        nodes => Err(format!("has {} inputs ({}): expected one, the observation", nodes.len(), names(model, nodes))),
    }
}

fn action_output(model: &Model) -> Result<Port, String> {
    let nodes = model.output_ids();
    let named = |name: &&str| nodes.iter().copied().find(|node| name_of(model, *node) == **name);
    match (nodes, ACTIONS.iter().find_map(named)) {
        ([node], _) => port(model, *node),
        (_, Some(node)) => port(model, node),
        _ => Err(format!("has {} outputs ({}): expected one, or one named `action`", nodes.len(), names(model, nodes))),
    }
}

fn port(model: &Model, node: NodeId) -> Result<Port, String> {
    let name = name_of(model, node);
    let shape = model.node_info(node).and_then(|info| info.shape());
    let width = |dimension: &Dimension| match dimension {
        Dimension::Fixed(width) => Some(*width),
        Dimension::Symbolic(_) => None,
    };
    match shape.as_deref() {
        Some([entries]) => Ok(Port { node, name, width: width(entries), stacked: false }),
        Some([batch, entries]) if width(batch).is_none_or(|batch| batch == 1) => {
            Ok(Port { node, name, width: width(entries), stacked: true })
        }
        None => Ok(Port { node, name, width: None, stacked: true }),
        Some(shape) => {
            let shape: Vec<String> = shape.iter().map(|one| width(one).map_or("?".into(), |one| one.to_string())).collect();
            Err(format!("has `{name}` of shape [{}]: expected [n] or [batch, n]", shape.join(", ")))
        }
    }
}

fn name_of(model: &Model, node: NodeId) -> String {
    model.node_info(node).and_then(|info| info.name().map(str::to_owned)).unwrap_or_default()
}

fn names(model: &Model, nodes: &[NodeId]) -> String {
    nodes.iter().map(|node| format!("`{}`", name_of(model, *node))).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use std::path::PathBuf;

    fn bytes(name: &str) -> Vec<u8> {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/golden/networks");
        std::fs::read(folder.join(name)).unwrap()
    }

    fn error(name: &str) -> String {
        Graph::read(bytes(name)).err().unwrap_or_else(|| panic!("{name} is accepted"))
    }

    /// What `tests/oracle/networks.py` wrote.
    #[derive(Deserialize)]
    struct Golden {
        observations: Vec<Vec<f32>>,
        actions: Vec<Vec<f32>>,
    }

    #[test]
    fn actions_are_those_of_onnx_runtime() {
        let golden: Golden = serde_json::from_slice(&bytes("actor.json")).unwrap();
        let evaluation = Evaluation::new(&Graph::read(bytes("actor.onnx")).unwrap());
        assert_eq!(evaluation.sizes(), [Some(3), Some(2)]);
        assert_eq!(golden.observations.len(), 6);
        for (observation, expected) in golden.observations.into_iter().zip(golden.actions) {
            let mut values = observation;
            evaluation.forward(&mut values).unwrap();
            let near = values.iter().zip(&expected).all(|(found, expected)| (found - expected).abs() < 1e-6);
            assert!(near && values.len() == 2, "{values:?} {expected:?}");
        }
    }

    #[test]
    fn what_is_no_policy_is_refused_with_its_reason() {
        assert_eq!(error("two_inputs.onnx"), "has 2 inputs (`observation`, `memory`): expected one, the observation");
        assert_eq!(error("two_outputs.onnx"), "has 2 outputs (`left`, `right`): expected one, or one named `action`");
        assert_eq!(error("image.onnx"), "has `pixels` of shape [1, 3, 8, 8]: expected [n] or [batch, n]");
        assert!(error("endless.onnx").contains("Expand"), "{}", error("endless.onnx"));
    }

    #[test]
    fn a_file_that_is_cut_or_changed_is_refused_or_evaluated() {
        let whole = bytes("actor.onnx");
        for length in (0..whole.len()).step_by(7) {
            let _ = Graph::read(whole[..length].to_vec());
        }
        for place in (0..whole.len()).step_by(3) {
            let mut changed = whole.clone();
            changed[place] ^= 0x55;
            if let Ok(graph) = Graph::read(changed) {
                let _ = Evaluation::new(&graph).forward(&mut vec![0.5; 3]);
            }
        }
    }

    #[test]
    fn an_observation_of_another_length_is_an_error() {
        let evaluation = Evaluation::new(&Graph::read(bytes("actor.onnx")).unwrap());
        let error = evaluation.forward(&mut vec![0.0; 5]).err().unwrap();
        assert!(error.starts_with("cannot be evaluated"), "{error}");
    }
}
