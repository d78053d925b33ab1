//! Activation lags behind excitation; this inverts the lag over one control step.
//!
//! MuJoCo integrates da/dt = (u - a) / τ(u, a) by Euler steps while the excitation u is held. The activation at the end of
//! the hold, A(u), rises with u, so that what a muscle can reach is [A(u_low), A(u_high)], and the excitation that brings it
//! to a wanted activation is the root of A(u) = wanted.

use crate::episode::excitation;
use msk_physics::actuation::activation_rate;
use msk_physics::scalar::Real;
use msk_program::body::ExcitationMap;

/// How an excitation is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hold {
    /// Physics steps.
    pub steps: u32,
    /// Length of one, s.
    pub timestep: f64,
}

/// The root is bracketed until the activation is known this well.
const TOLERANCE: f64 = 1e-7;
/// False position with halving (Illinois) gains about one and a half digits a time.
const ITERATIONS: usize = 40;

impl Hold {
    /// Length, s.
    pub fn duration(self) -> f64 {
        f64::from(self.steps) * self.timestep
    }

    /// The activation at the end, from `activation` under `excitation`. `constants` are the muscle's activation and
    /// deactivation times (s) and smoothing width.
    pub fn activation(self, activation: f64, excitation: f64, constants: &[f64; 3]) -> f64 {
        let step = |a: f64| a + self.timestep * activation_rate(excitation, a, constants);
        (0..self.steps).fold(activation, |a, _| step(a))
    }

    /// The excitation within `range` that ends at `wanted`, or comes nearest to it.
    pub fn excitation(self, activation: f64, wanted: f64, range: [f64; 2], constants: &[f64; 3]) -> f64 {
        let miss = |excitation: f64| self.activation(activation, excitation, constants) - wanted;
        let [mut low, mut high] = range;
        // Holding the present activation changes nothing, and parts rising from falling, where the time constant jumps.
        let still = activation.clip(low, high);
        if wanted >= activation {
            low = still;
        } else {
            high = still;
        }
        let (mut below, mut above) = (miss(low), miss(high));
        if below >= 0.0 {
            return low;
        }
        if above <= 0.0 {
            return high;
        }
        for _ in 0..ITERATIONS {
            let middle = (low * above - high * below) / (above - below);
            let found = miss(middle);
            if found.abs() <= TOLERANCE {
                return middle;
            }
            if found < 0.0 {
                (low, below, above) = (middle, found, 0.5 * above);
            } else {
                (high, above, below) = (middle, found, 0.5 * below);
            }
        }
        0.5 * (low + high)
    }
}

/// The excitations that actions in [-1, 1] reach.
pub(super) fn excitation_range(map: ExcitationMap) -> [f64; 2] {
    [excitation(map, -1.0), excitation(map, 1.0)]
}

/// The action in [-1, 1] that asks for `wanted` excitation, or comes nearest to it.
pub(super) fn action(map: ExcitationMap, wanted: f64) -> f64 {
    let [low, high] = excitation_range(map);
    let wanted = wanted.clip(low, high);
    let action = match map {
        ExcitationMap::Linear => 2.0 * wanted - 1.0,
        ExcitationMap::Sigmoid => 0.5 + 0.2 * libm::log(wanted / (1.0 - wanted)),
    };
    action.clip(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HOLD: Hold = Hold { steps: 10, timestep: 1e-3 };

    fn muscle() -> impl Strategy<Value = [f64; 3]> {
        (prop::sample::select(vec![0.010, 0.015]), prop::sample::select(vec![0.040, 0.050]), prop::sample::select(vec![0.0, 0.1]))
            .prop_map(|(rise, fall, width)| [rise, fall, width])
    }

    proptest! {
        #[test]
        fn a_wanted_activation_within_reach_is_met(
            start in 0.0..1.0, share in 0.0..1.0, constants in muscle(),
        ) {
            let [low, high] = [0.0, 1.0].map(|u| HOLD.activation(start, u, &constants));
            let wanted = low + share * (high - low);
            let excitation = HOLD.excitation(start, wanted, [0.0, 1.0], &constants);
            prop_assert!((HOLD.activation(start, excitation, &constants) - wanted).abs() < 1e-6);
        }

        #[test]
        fn a_wanted_activation_out_of_reach_gives_the_nearest_bound(start in 0.0..1.0, constants in muscle()) {
            let [low, high] = [0.1, 0.9].map(|u| HOLD.activation(start, u, &constants));
            prop_assert_eq!(HOLD.excitation(start, low - 0.01, [0.1, 0.9], &constants), 0.1);
            prop_assert_eq!(HOLD.excitation(start, high + 0.01, [0.1, 0.9], &constants), 0.9);
        }

        #[test]
        fn actions_undo_the_excitation_map(given in -1.0..1.0f64) {
            for map in [ExcitationMap::Linear, ExcitationMap::Sigmoid] {
                prop_assert!((action(map, excitation(map, given)) - given).abs() < 1e-12);
            }
        }
    }
}
