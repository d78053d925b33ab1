//! What all learners have: networks with an optimiser, and a loss that must stay finite.

use crate::error::TrainError;
use crate::numbers::Numbers;
use msk_network::heads::squashed_gaussian;
use msk_network::{Adam, Kernel, Mlp, Parameters, Shape, Tape, Variable, orthogonal, uniform_fan_in};
use msk_runtime::episode::Stream;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

/// Actions of each slot in a round of a learner that remembers: what a report is about, and no part of an algorithm.
pub(crate) const ROUND: u64 = 128;

/// Parts of a loss, by name, with their means over the last round.
pub type Losses = Vec<(&'static str, f64)>;

/// Parameters, the tape on which losses are computed, and the gradient.
pub(crate) struct Networks {
    pub parameters: Parameters,
    pub tape: Tape,
    /// Of the last loss, in the range of its optimiser.
    gradient: Vec<f32>,
}

/// An optimiser of a range of parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Optimizer {
    range: Range<usize>,
    adam: Adam,
    /// Largest norm of a gradient; infinite for any.
    largest: f32,
}

impl Optimizer {
    pub fn new(range: Range<usize>, largest: f32, epsilon: f32) -> Self {
        Self { adam: Adam::new(range.len()).with_epsilon(epsilon), range, largest }
    }

    pub fn with_decay(self, decay: f32) -> Self {
        Self { adam: self.adam.with_decay(decay), ..self }
    }
}

impl Networks {
    pub fn new(kernel: Arc<dyn Kernel>) -> Self {
        Self { parameters: Parameters::default(), tape: Tape::new(kernel), gradient: Vec::new() }
    }

    /// Adds a perceptron whose layers are orthogonal: hidden ones with gain sqrt(2), the last with its own.
    pub fn orthogonal(&mut self, name: &str, shape: &Shape, last: f64, draw: &mut Stream) -> Mlp {
        let network = Mlp::new(name, shape, &mut self.parameters);
        let count = network.layers().len();
        for (index, layer) in network.layers().iter().enumerate() {
            let gain = if index + 1 == count { last } else { core::f64::consts::SQRT_2 };
            let weight = &mut self.parameters.values_mut()[layer.weight.clone()];
            orthogonal(weight, [layer.outputs, layer.inputs], gain, &mut || draw.normal());
        }
        network
    }

    /// Adds a perceptron whose numbers are uniform within 1 / sqrt(inputs) of their layer.
    pub fn uniform(&mut self, name: &str, shape: &Shape, draw: &mut Stream) -> Mlp {
        let network = Mlp::new(name, shape, &mut self.parameters);
        for layer in network.layers() {
            for range in [&layer.weight, &layer.bias] {
                uniform_fan_in(&mut self.parameters.values_mut()[range.clone()], layer.inputs, &mut || draw.uniform());
            }
        }
        network
    }

    /// One step of the optimiser against the gradient of a loss, which is part `what` of the algorithm's.
    ///
    /// # Errors
    /// A loss or a gradient that is not finite, with the layer that is so first; nothing has been changed then.
    pub fn descend(
        &mut self,
        loss: Variable,
        (what, step): (&'static str, u64),
        rate: f64,
        optimizer: &mut Optimizer,
    ) -> Result<f64, TrainError> {
        let value = self.tape.values(loss)[0];
        if !value.is_finite() {
            let layer = self.parameters.first_invalid(self.parameters.values()).map(|tensor| tensor.name.clone());
            return Err(TrainError::NotFinite { step, what, layer });
        }
        let own = optimizer.range.clone();
        self.gradient.resize(self.parameters.len(), 0.0);
        self.gradient[own.clone()].fill(0.0);
        self.tape.backward(loss, &self.parameters, &mut self.gradient);
        let norm = msk_network::clip_norm(&mut self.gradient[own.clone()], optimizer.largest);
        if !norm.is_finite() {
            let layer = self.parameters.first_invalid(&self.gradient).map(|tensor| tensor.name.clone());
            return Err(TrainError::NotFinite { step, what, layer });
        }
        optimizer.adam.step(rate as f32, &mut self.parameters.values_mut()[own.clone()], &self.gradient[own]);
        Ok(f64::from(value))
    }

    pub fn state(&self) -> Numbers {
        Numbers(self.parameters.values().to_vec())
    }

    /// # Errors
    /// Other sizes.
    pub fn restore(&mut self, state: &Numbers) -> Result<(), String> {
        if state.0.len() != self.parameters.len() {
            return Err(format!("it has {} parameters, expected {}", state.0.len(), self.parameters.len()));
        }
        self.parameters.values_mut().copy_from_slice(&state.0);
        Ok(())
    }
}

/// Bounds of the logarithm of a standard deviation.
const LOG_STD: [f32; 2] = [-20.0, 2.0];

/// A draw of squashed Gaussians with these means and logarithms of deviations by standard normal numbers, and the logarithm of its density.
pub(crate) fn draw_squashed(
    tape: &mut Tape,
    mean: Variable,
    log_std: Variable,
    noise: &mut dyn Iterator<Item = f32>,
) -> [Variable; 2] {
    let [rows, columns] = tape.size(mean);
    let log_std = tape.clip(log_std, LOG_STD[0], LOG_STD[1]);
    let noise = tape.constant(rows, columns, noise.take(rows * columns));
    squashed_gaussian(tape, mean, log_std, noise)
}

/// The means of parts of a loss over the steps of a round.
#[derive(Debug, Default)]
pub(crate) struct Means {
    sums: Vec<(&'static str, f64, u32)>,
}

impl Means {
    pub fn add(&mut self, name: &'static str, value: f64) {
        match self.sums.iter_mut().find(|(known, ..)| *known == name) {
            Some((_, sum, count)) => (*sum, *count) = (*sum + value, *count + 1),
            None => self.sums.push((name, value, 1)),
        }
    }

    pub fn take(&mut self) -> Losses {
        self.sums.drain(..).map(|(name, sum, count)| (name, sum / f64::from(count))).collect()
    }
}
