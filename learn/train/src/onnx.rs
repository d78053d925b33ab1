//! Agents as ONNX files: the normaliser of observations, the perceptron and how its output acts, as one graph that takes
//! `observation` [batch, numbers] and gives `action` [batch, entries], both in single precision.

use crate::agent::Output;
use crate::dynsyn::Synergies;
use crate::protobuf::Message;
use msk_network::{Activation, Layer, Mlp, Parameters, Step};

/// The version of the format, and that of its operators: the first with LayerNormalization.
const VERSIONS: [u64; 2] = [8, 17];
/// Numbers of single precision, as ONNX counts types.
const FLOAT: u64 = 1;
/// What layer norms add to a variance, as the tape does.
const NORM_EPSILON: f32 = 1e-5;

/// What a graph consists of.
pub(crate) struct Source<'a> {
    pub network: &'a Mlp,
    pub parameters: &'a Parameters,
    /// Mean, deviation and bound of normalised observations.
    pub mean: &'a [f32],
    pub std: &'a [f32],
    pub clip: f32,
    pub output: &'a Output,
    /// What the file says of itself, by name.
    pub remarks: &'a [(String, String)],
}

/// A graph that is being written: nodes in the order of their computation, and the tensors that they use.
#[derive(Default)]
struct Graph {
    nodes: Vec<Message>,
    tensors: Vec<Message>,
    /// What was computed last.
    last: String,
}

impl Graph {
    /// Adds an operation on what was computed last and on tensors.
    fn node(&mut self, operation: &str, tensors: &[&str], attributes: Vec<Message>) {
        let inputs = [self.last.as_str()].into_iter().chain(tensors.iter().copied());
        self.join(operation, &inputs.map(str::to_owned).collect::<Vec<_>>(), attributes);
    }

    /// Adds an operation on values of these names.
    fn join(&mut self, operation: &str, inputs: &[String], attributes: Vec<Message>) {
        let name = format!("{}{}", operation.to_lowercase(), self.nodes.len());
        self.named(name, operation, inputs, attributes);
    }

    /// The same with a name for what it gives.
    fn named(&mut self, name: String, operation: &str, inputs: &[String], attributes: Vec<Message>) {
        let node = inputs.iter().fold(Message::default(), |node, input| node.data(1, input));
        let node = node.data(2, &name).data(3, &name).data(4, operation);
        self.nodes.push(attributes.into_iter().fold(node, |node, attribute| node.message(5, attribute)));
        self.last = name;
    }

    fn tensor(&mut self, name: &str, shape: &[usize], values: &[f32]) {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let tensor = shape.iter().fold(Message::default(), |tensor, length| tensor.integer(1, *length as u64));
        self.tensors.push(tensor.integer(2, FLOAT).data(8, name).data(9, bytes));
    }
}

impl Graph {
    /// The steps of the network; with synergies, without its last layer.
    fn network(&mut self, source: &Source<'_>) {
        let mut kept = String::new();
        let last = source.network.layers().len() - 1;
        for step in source.network.steps() {
            match *step {
                Step::Linear(layer) if layer == last && source.output.synergies().is_some() => {}
                Step::Linear(layer) => {
                    let [weight, bias] = ["weight", "bias"].map(|what| format!("policy.{layer}.{what}"));
                    self.node("Gemm", &[&weight, &bias], vec![integer("transB", 1)]);
                }
                Step::Norm(norm) => {
                    let [scale, shift] = ["scale", "shift"].map(|what| format!("policy.norm{norm}.{what}"));
                    let attributes = vec![integer("axis", -1), float("epsilon", NORM_EPSILON)];
                    self.node("LayerNormalization", &[&scale, &shift], attributes);
                }
                Step::Activate => self.activate(source.network.shape().activation),
                Step::Keep => kept.clone_from(&self.last),
                Step::AddKept => self.node("Add", &[&kept], vec![]),
            }
        }
    }

    fn activate(&mut self, activation: Activation) {
        match activation {
            Activation::Tanh => self.node("Tanh", &[], vec![]),
            Activation::Relu => self.node("Relu", &[], vec![]),
            Activation::Elu => self.node("Elu", &[], vec![]),
            Activation::Silu => {
                let x = self.last.clone();
                self.node("Sigmoid", &[], vec![]);
                let gate = self.last.clone();
                self.join("Mul", &[x, gate], vec![]);
            }
        }
    }

    /// The last operation; gives how many entries an action has.
    fn act(&mut self, operation: &str, entries: usize) -> usize {
        let last = [self.last.clone()];
        self.named("action".into(), operation, &last, vec![]);
        entries
    }

    /// The last layer as two: one that gives each entry the action of its group, whose rows stand there once for every member, and one that
    /// gives its weight.
    fn synergies(&mut self, source: &Source<'_>, synergies: &Synergies) -> usize {
        let Some(Layer { weight, bias, inputs, .. }) = source.network.layers().last() else { return 0 };
        let (weight, bias) = (&source.parameters.values()[weight.clone()], &source.parameters.values()[bias.clone()]);
        let count = synergies.count();
        let (free, scale, bound) = synergies.weights();
        let hidden = self.last.clone();
        let layer = |graph: &mut Self, name: &str, rows: &[usize]| {
            let row = |row: &usize| weight[row * inputs..(row + 1) * inputs].to_vec();
            let [weights, biases] = ["weight", "bias"].map(|what| format!("{name}.{what}"));
            graph.tensor(&weights, &[rows.len(), *inputs], &rows.iter().flat_map(row).collect::<Vec<f32>>());
            graph.tensor(&biases, &[rows.len()], &rows.iter().map(|row| bias[*row]).collect::<Vec<f32>>());
            graph.join("Gemm", &[hidden.clone(), weights, biases], vec![integer("transB", 1)]);
            graph.node("Tanh", &[], vec![]);
            graph.last.clone()
        };
        let shared = layer(self, "group", synergies.group());
        let entries = synergies.entries();
        layer(self, "member", &(count..count + entries).collect::<Vec<_>>());
        let numbers = [("scale", scale), ("lowest", -bound), ("highest", bound), ("one", 1.0), ("minus_one", -1.0)];
        numbers.iter().for_each(|(name, value)| self.tensor(name, &[], &[*value]));
        self.tensor("free", &[entries], free);
        self.node("Mul", &["scale"], vec![]);
        self.node("Clip", &["lowest", "highest"], vec![]);
        self.node("Mul", &["free"], vec![]);
        self.node("Add", &["one"], vec![]);
        self.node("Mul", &[&shared], vec![]);
        let clipped = [self.last.as_str(), "minus_one", "one"].map(str::to_owned);
        self.named("action".into(), "Clip", &clipped, vec![]);
        entries
    }
}

/// A whole number as an attribute of a node; the format has negative ones in two's complement.
fn integer(name: &str, value: i64) -> Message {
    Message::default().data(1, name).integer(3, value.cast_unsigned()).integer(20, 2)
}

/// A number of single precision as an attribute of a node.
fn float(name: &str, value: f32) -> Message {
    Message::default().data(1, name).float(2, value).integer(20, 1)
}

/// An end of the graph: a row of so many numbers for each of a batch.
fn port(name: &str, width: usize) -> Message {
    let batch = Message::default().data(2, "batch");
    let row = Message::default().integer(1, width as u64);
    let shape = Message::default().message(1, batch).message(1, row);
    let tensor = Message::default().integer(1, FLOAT).message(2, shape);
    Message::default().data(1, name).message(2, Message::default().message(1, tensor))
}

/// The bytes of the file: a function of what it holds.
pub(crate) fn file(source: &Source<'_>) -> Vec<u8> {
    let shape = source.network.shape();
    let mut graph = Graph { last: "observation".into(), ..Graph::default() };
    graph.tensor("observation.mean", &[shape.inputs], source.mean);
    graph.tensor("observation.std", &[shape.inputs], source.std);
    graph.tensor("observation.low", &[], &[-source.clip]);
    graph.tensor("observation.high", &[], &[source.clip]);
    for tensor in source.parameters.tensors() {
        graph.tensor(&tensor.name, &tensor.shape, &source.parameters.values()[tensor.range.clone()]);
    }
    graph.node("Sub", &["observation.mean"], vec![]);
    graph.node("Div", &["observation.std"], vec![]);
    graph.node("Clip", &["observation.low", "observation.high"], vec![]);
    graph.network(source);
    let entries = match source.output {
        Output::Clipped => graph.act("Identity", shape.outputs),
        Output::Squashed => graph.act("Tanh", shape.outputs),
        Output::Synergies(synergies) => graph.synergies(source, synergies),
    };

    let Graph { nodes, tensors, .. } = graph;
    let message = nodes.into_iter().fold(Message::default(), |graph, node| graph.message(1, node)).data(2, "policy");
    let message = tensors.into_iter().fold(message, |graph, tensor| graph.message(5, tensor));
    let message = message.message(11, port("observation", shape.inputs)).message(12, port("action", entries));
    let model = Message::default().integer(1, VERSIONS[0]).data(2, "msk").message(7, message);
    let model = model.message(8, Message::default().data(1, "").integer(2, VERSIONS[1]));
    let remark = |(key, value): &(String, String)| Message::default().data(1, key).data(2, value);
    source.remarks.iter().fold(model, |model, known| model.message(14, remark(known))).bytes()
}
