//! What networks promise: bits that neither threads nor registers change, derivatives that agree with finite differences and with
//! PyTorch, and memory that stays.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod allocations;
mod derivatives;
mod golden;
mod products;
mod residual;

use msk_network::{Activation, Mlp, Parameters, Processor, Shape, Tape};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// From -0.5 to 0.5, the same as in `oracle/torch_golden.py`.
fn number(index: usize, salt: usize) -> f64 {
    ((index * 7919 + salt * 104_729) % 10_007) as f64 / 10_007.0 - 0.5
}

fn numbers(count: usize, salt: usize, scale: f64) -> Vec<f32> {
    (0..count).map(|index| (scale * number(index, salt)) as f32).collect()
}

fn tape(threads: usize) -> Tape {
    Tape::new(Arc::new(Processor::new(NonZeroUsize::new(threads).unwrap()).unwrap()))
}

/// A perceptron with the numbers of `oracle/torch_golden.py`.
fn perceptron(
    name: &str,
    (inputs, hidden, outputs): (usize, &[usize], usize),
    (activation, layer_norm): (Activation, bool),
    salt: usize,
    parameters: &mut Parameters,
) -> Mlp {
    let shape = Shape { inputs, hidden: hidden.to_vec(), outputs, activation, layer_norm, residual: false };
    filled(name, &shape, salt, parameters)
}

/// A perceptron of any shape with such numbers.
fn filled(name: &str, shape: &Shape, salt: usize, parameters: &mut Parameters) -> Mlp {
    let begin = parameters.tensors().len();
    let network = Mlp::new(name, shape, parameters);
    let tensors: Vec<_> = parameters.tensors()[begin..].to_vec();
    for (place, tensor) in tensors.iter().enumerate() {
        let shift = if tensor.name.ends_with("scale") { 1.0 } else { 0.0 };
        let values = &mut parameters.values_mut()[tensor.range.clone()];
        for (index, value) in values.iter_mut().enumerate() {
            *value = (number(index, salt + place) + shift) as f32;
        }
    }
    network
}
