//! Multilayer perceptrons.

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
    /// Whether each hidden layer is normalised before its activation (Ba et al. 2016).
    pub layer_norm: bool,
}

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

/// A perceptron: where its numbers stand among the parameters of a learner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mlp {
    shape: Shape,
    layers: Vec<Layer>,
    /// One per hidden layer, or none.
    norms: Vec<LayerNorm>,
    range: Range<usize>,
}

impl Mlp {
    /// Adds its tensors to `parameters`, as `NAME.0.weight`, `NAME.0.bias`, and `NAME.norm0.scale` and so on: all 0 but the scales,
    /// which are 1.
    pub fn new(name: &str, shape: &Shape, parameters: &mut Parameters) -> Self {
        let begin = parameters.len();
        let outputs: Vec<usize> = shape.hidden.iter().copied().chain([shape.outputs]).collect();
        let inputs = [shape.inputs].into_iter().chain(shape.hidden.iter().copied());
        let (mut layers, mut norms) = (Vec::new(), Vec::new());
        for (index, (inputs, &outputs)) in inputs.zip(&outputs).enumerate() {
            let weight = parameters.add(format!("{name}.{index}.weight"), &[outputs, inputs]);
            let bias = parameters.add(format!("{name}.{index}.bias"), &[outputs]);
            layers.push(Layer { weight, bias, inputs, outputs });
            if shape.layer_norm && index < shape.hidden.len() {
                let scale = parameters.add(format!("{name}.norm{index}.scale"), &[outputs]);
                let shift = parameters.add(format!("{name}.norm{index}.shift"), &[outputs]);
                parameters.values_mut()[scale.clone()].fill(1.0);
                norms.push(LayerNorm { scale, shift });
            }
        }
        Self { shape: shape.clone(), layers, norms, range: begin..parameters.len() }
    }

    /// Its sizes.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Its layers, in order.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Where all its numbers stand.
    pub fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    /// What it makes of each row of `x`.
    pub fn forward(&self, tape: &mut Tape, parameters: &Parameters, x: Variable) -> Variable {
        let mut x = x;
        for (index, layer) in self.layers.iter().enumerate() {
            x = tape.linear(x, layer, parameters);
            if index + 1 < self.layers.len() {
                if let Some(norm) = self.norms.get(index) {
                    x = tape.layer_norm(x, norm, parameters);
                }
                x = tape.activate(x, self.shape.activation);
            }
        }
        x
    }
}
