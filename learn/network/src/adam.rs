//! Adam (Kingma and Ba, ICLR 2015), with the decoupled weight decay of `AdamW` (Loshchilov and Hutter, ICLR 2019).

use serde::{Deserialize, Serialize};

/// The optimiser's state: moments of the gradient, one of each per parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    /// Decay of the first and of the second moment, and what keeps the step finite.
    pub constants: Constants,
    first: Vec<f32>,
    second: Vec<f32>,
    /// The decays to the power of the number of steps.
    powers: [f64; 2],
}

/// What of Adam does not change.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Constants {
    /// Decay of the mean of the gradient: beta 1.
    pub first: f32,
    /// Decay of the mean of its square: beta 2.
    pub second: f32,
    /// Added to the root of the second moment: epsilon.
    pub epsilon: f32,
    /// Share by which values shrink in a step, times its rate: lambda; 0 in Adam.
    #[serde(default)]
    pub decay: f32,
}

impl Default for Constants {
    fn default() -> Self {
        Self { first: 0.9, second: 0.999, epsilon: 1e-8, decay: 0.0 }
    }
}

impl Adam {
    /// For so many parameters, with the usual constants.
    pub fn new(parameters: usize) -> Self {
        Self { constants: Constants::default(), first: vec![0.0; parameters], second: vec![0.0; parameters], powers: [1.0, 1.0] }
    }

    /// The same with another epsilon.
    #[must_use]
    pub fn with_epsilon(mut self, epsilon: f32) -> Self {
        self.constants.epsilon = epsilon;
        self
    }

    /// The same with a weight decay.
    #[must_use]
    pub fn with_decay(mut self, decay: f32) -> Self {
        self.constants.decay = decay;
        self
    }

    /// How many parameters it is for.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// Whether it is for none.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// One step against the gradient (algorithm 1 of the first paper; with a decay algorithm 2 of the second).
    ///
    /// # Panics
    /// If there are not as many values and derivatives as parameters.
    pub fn step(&mut self, rate: f32, values: &mut [f32], gradient: &[f32]) {
        assert!(values.len() == self.first.len() && gradient.len() == self.first.len(), "one derivative per parameter");
        let Constants { first, second, epsilon, decay } = self.constants;
        if decay > 0.0 {
            values.iter_mut().for_each(|value| *value -= rate * decay * *value);
        }
        self.powers = [self.powers[0] * f64::from(first), self.powers[1] * f64::from(second)];
        let [unbiased_first, unbiased_second] = self.powers.map(|power| 1.0 / (1.0 - power));
        let (rate, root) = ((f64::from(rate) * unbiased_first) as f32, unbiased_second.sqrt() as f32);
        let moments = self.first.iter_mut().zip(&mut self.second);
        pulp::Arch::new().dispatch(|| {
            for ((value, slope), (mean, square)) in values.iter_mut().zip(gradient).zip(moments) {
                *mean = first * *mean + (1.0 - first) * slope;
                *square = second * *square + (1.0 - second) * slope * slope;
                *value -= rate * *mean / (square.sqrt() * root + epsilon);
            }
        });
    }
}

/// Scales a gradient so that its norm is at most `most`; returns the norm that it had.
pub fn clip_norm(gradient: &mut [f32], most: f32) -> f32 {
    let norm = sum_of_squares(gradient).sqrt() as f32;
    if norm > most {
        let share = most / norm;
        gradient.iter_mut().for_each(|slope| *slope *= share);
    }
    norm
}

/// In double precision and in sixteen parts, which are the same on every processor: each addition of one sum would wait for the last.
fn sum_of_squares(numbers: &[f32]) -> f64 {
    let (parts, rest) = numbers.as_chunks::<16>();
    let square = |number: f32| f64::from(number) * f64::from(number);
    let sums = pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            let mut sums = [0.0; 16];
            for part in parts {
                for (sum, number) in sums.iter_mut().zip(part) {
                    *sum += square(*number);
                }
            }
            sums
        },
    );
    sums.into_iter().chain(rest.iter().copied().map(square)).sum()
}
