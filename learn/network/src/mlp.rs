//! Multilayer perceptrons, plain ones and residual ones.
//!
//! A residual one is that of SimBa (Lee et al. 2025, arXiv 2410.09754, section 4): a linear embedding, blocks that add to their input x what
//! two layers make of its norm, x + W2 f(W1 norm(x)), with four times as many numbers in between, and a norm before the last layer.

use crate::functions::Activation;
use crate::parameters::Parameters;
use crate::tape::{Tape, Variable};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The sizes of a perceptron and what follows its hidden layers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shape {
    /// Numbers that it takes.
    pub inputs: usize,
    /// Numbers of each hidden layer.
    pub hidden: Vec<usize>,
    /// Numbers that it gives.
    pub outputs: usize,
    /// What follows each hidden layer.
    pub activation: Activation,
    /// Whether each hidden layer is normalised before its activation (Ba et al. 2016). Residual ones always have norms.
    pub layer_norm: bool,
    /// Whether each hidden layer is a residual block; all of them then have the size of the first.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub residual: bool,
}

impl Shape {
    /// How many numbers such a perceptron has, without making any; saturating.
    pub fn numbers(&self) -> usize {
        let layer = |[inputs, outputs]: [usize; 2]| inputs.saturating_add(1).saturating_mul(outputs);
        let width = self.hidden.first().copied().unwrap_or(self.inputs);
        let (layers, norms): (Vec<[usize; 2]>, Vec<usize>) = match (self.residual, self.layer_norm) {
            (true, _) => {
                let within = EXPANSION.saturating_mul(width);
                let blocks = self.hidden.iter().flat_map(|_| [[width, within], [within, width]]);
                let layers = [[self.inputs, width]].into_iter().chain(blocks).chain([[width, self.outputs]]);
                (layers.collect(), vec![width; self.hidden.len() + 1])
            }
            (false, normed) => {
                let inputs = [self.inputs].into_iter().chain(self.hidden.iter().copied());
                let outputs = self.hidden.iter().copied().chain([self.outputs]);
                let layers = inputs.zip(outputs).map(|(inputs, outputs)| [inputs, outputs]);
                (layers.collect(), if normed { self.hidden.clone() } else { Vec::new() })
            }
        };
        let parts = layers.into_iter().map(layer).chain(norms.into_iter().map(|width| width.saturating_mul(2)));
        parts.fold(0, usize::saturating_add)
    }
}

/// How much wider a residual block is within.
const EXPANSION: usize = 4;

/// Where the numbers of a linear layer stand: a weight `[outputs, inputs]` and a bias `[outputs]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layer {
    /// Row by row.
    pub weight: Range<usize>,
    /// One per output.
    pub bias: Range<usize>,
    /// Columns of the weight.
    pub inputs: usize,
    /// Rows of the weight.
    pub outputs: usize,
}

/// Where scale and shift of a layer norm stand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LayerNorm {
    /// One per column.
    pub scale: Range<usize>,
    /// One per column.
    pub shift: Range<usize>,
}

/// A step of the computation of a perceptron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// This one of its layers.
    Linear(usize),
    /// This one of its norms.
    Norm(usize),
    /// The activation.
    Activate,
    /// A block begins: what comes in is kept.
    Keep,
    /// A block ends: what was kept is added.
    AddKept,
}

/// A perceptron: where its numbers stand among the parameters of a learner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mlp {
    shape: Shape,
    layers: Vec<Layer>,
    norms: Vec<LayerNorm>,
    steps: Vec<Step>,
    range: Range<usize>,
}

/// Adds the tensors of a perceptron.
struct Builder<'a> {
    name: &'a str,
    parameters: &'a mut Parameters,
    layers: Vec<Layer>,
    norms: Vec<LayerNorm>,
    steps: Vec<Step>,
}

impl Builder<'_> {
    fn linear(&mut self, inputs: usize, outputs: usize) {
        let (name, index) = (self.name, self.layers.len());
        let weight = self.parameters.add(format!("{name}.{index}.weight"), &[outputs, inputs]);
        let bias = self.parameters.add(format!("{name}.{index}.bias"), &[outputs]);
        self.layers.push(Layer { weight, bias, inputs, outputs });
        self.steps.push(Step::Linear(index));
    }

    fn norm(&mut self, width: usize) {
        let (name, index) = (self.name, self.norms.len());
        let scale = self.parameters.add(format!("{name}.norm{index}.scale"), &[width]);
        let shift = self.parameters.add(format!("{name}.norm{index}.shift"), &[width]);
        self.parameters.values_mut()[scale.clone()].fill(1.0);
        self.norms.push(LayerNorm { scale, shift });
        self.steps.push(Step::Norm(index));
    }

    fn plain(&mut self, shape: &Shape) {
        let mut inputs = shape.inputs;
        for &size in &shape.hidden {
            self.linear(inputs, size);
            if shape.layer_norm {
                self.norm(size);
            }
            self.steps.push(Step::Activate);
            inputs = size;
        }
        self.linear(inputs, shape.outputs);
    }

    fn residual(&mut self, shape: &Shape) {
        let width = shape.hidden.first().copied().unwrap_or(shape.inputs);
        self.linear(shape.inputs, width);
        for _ in &shape.hidden {
            self.steps.push(Step::Keep);
            self.norm(width);
            self.linear(width, EXPANSION * width);
            self.steps.push(Step::Activate);
            self.linear(EXPANSION * width, width);
            self.steps.push(Step::AddKept);
        }
        self.norm(width);
        self.linear(width, shape.outputs);
    }
}

impl Mlp {
    /// Adds its tensors to `parameters`, as `NAME.0.weight`, `NAME.0.bias`, and `NAME.norm0.scale` and so on: all 0 but the scales,
    /// which are 1.
    pub fn new(name: &str, shape: &Shape, parameters: &mut Parameters) -> Self {
        let begin = parameters.len();
        let mut builder = Builder { name, parameters, layers: Vec::new(), norms: Vec::new(), steps: Vec::new() };
        if shape.residual {
            builder.residual(shape)
        } else {
            builder.plain(shape)
        }
        let Builder { parameters, layers, norms, steps, .. } = builder;
        Self { shape: shape.clone(), layers, norms, steps, range: begin..parameters.len() }
    }

    /// Its sizes.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Its layers, in order.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// What it does, step by step: what other formats write.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Where all its numbers stand.
    pub fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    /// Makes some of its outputs a constant, whatever comes in: their weights are 0.
    pub fn fill_outputs(&self, outputs: Range<usize>, constant: f32, parameters: &mut Parameters) {
        if let Some(last) = self.layers.last() {
            let values = parameters.values_mut();
            let weights = outputs.start * last.inputs..outputs.end * last.inputs;
            values[last.weight.clone()][weights].fill(0.0);
            values[last.bias.clone()][outputs].fill(constant);
        }
    }

    /// What it makes of each row of `x`.
    pub fn forward(&self, tape: &mut Tape, parameters: &Parameters, x: Variable) -> Variable {
        let (mut x, mut kept) = (x, x);
        for step in &self.steps {
            x = match *step {
                Step::Linear(layer) => tape.linear(x, &self.layers[layer], parameters),
                Step::Norm(norm) => tape.layer_norm(x, &self.norms[norm], parameters),
                Step::Activate => tape.activate(x, self.shape.activation),
                Step::Keep => {
                    kept = x;
                    x
                }
                Step::AddKept => tape.add(kept, x),
            };
        }
        x
    }
}
