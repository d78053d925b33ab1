//! Activation cost: E = 1/(T M) Σ_t Σ_m a_m(t)², over the T samples before a step and all M muscles; dimensionless, 0..1.
//!
//! It compares how much policies recruit that both succeed; of one that falls it says little. Squared activation is the criterion of
//! Crowninshield and Brand (J. Biomech. 14, 1981) with exponent two; work and heat are in [`energy`](super::energy).

use crate::trace::{Quantity, Row};

/// Sums up squares of activations.
#[derive(Debug, Clone, Default)]
pub(super) struct ActivationCost {
    sum: f64,
    samples: u32,
    /// Mean square of the last row, which counts once a step follows.
    last: Option<f64>,
}

impl ActivationCost {
    pub fn look(&mut self, row: &Row<'_>) {
        if let Some(last) = self.last.take() {
            self.sum += last;
            self.samples += 1;
        }
        let activations = row.of(Quantity::Activations);
        if !activations.is_empty() {
            let squares: f64 = activations.iter().map(|activation| activation * activation).sum();
            self.last = Some(squares / activations.len() as f64);
        }
    }

    /// The cost; `None` without a step.
    pub fn finish(&self) -> Option<f64> {
        (self.samples > 0).then(|| self.sum / f64::from(self.samples))
    }
}
