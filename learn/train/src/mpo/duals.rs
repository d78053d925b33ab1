//! The dual variables of MPO: temperatures of the weights of samples, and prices of how far mean and deviation go.

use msk_network::Parameters;
use std::ops::Range;

/// Least value of a dual before it is made positive.
const LEAST_DUAL: f32 = -18.0;
/// First values of the duals before they are made positive: of both temperatures, and of the bounds of mean and deviation.
const FIRST_DUALS: [f32; 3] = [1.0, 1.0, 10.0];

/// Where the duals stand among the parameters: of the temperature, that of the penalty, and one per entry for mean and deviation.
#[derive(Debug, Clone)]
pub(super) struct Duals {
    pub temperatures: [Range<usize>; 2],
    pub bounds: [Range<usize>; 2],
}

/// The duals after they were made positive.
pub(super) struct DualValues {
    pub temperatures: [f32; 2],
    pub bounds: [Vec<f32>; 2],
}

impl Duals {
    pub fn new(entries: usize, parameters: &mut Parameters) -> Self {
        let temperatures = ["temperature", "penalty"].map(|name| parameters.add(name, &[1]));
        let bounds = ["bound_mean", "bound_std"].map(|name| parameters.add(name, &[entries]));
        let firsts = [FIRST_DUALS[0], FIRST_DUALS[0], FIRST_DUALS[1], FIRST_DUALS[2]];
        for (range, first) in temperatures.iter().chain(&bounds).zip(firsts) {
            parameters.values_mut()[range.clone()].fill(first);
        }
        Self { temperatures, bounds }
    }

    pub fn range(&self) -> Range<usize> {
        self.temperatures[0].start..self.bounds[1].end
    }

    /// Keeps them from becoming so small that nothing would raise them again.
    pub fn bound(&self, parameters: &mut Parameters) {
        for value in &mut parameters.values_mut()[self.range()] {
            *value = if *value < LEAST_DUAL { LEAST_DUAL } else { *value };
        }
    }

    pub fn values(&self, parameters: &Parameters) -> DualValues {
        let of = |range: &Range<usize>| -> Vec<f32> {
            let positive = |raw: &f32| libm::log1pf(libm::expf(-raw.abs())) + if *raw > 0.0 { *raw } else { 0.0 };
            parameters.values()[range.clone()].iter().map(|raw| positive(raw) + 1e-8).collect()
        };
        DualValues {
            temperatures: [0, 1].map(|place: usize| of(&self.temperatures[place])[0]),
            bounds: [0, 1].map(|place: usize| of(&self.bounds[place])),
        }
    }
}
