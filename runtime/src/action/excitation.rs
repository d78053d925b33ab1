//! From a policy's action to muscle excitation.

use msk_physics::scalar::Real;
use msk_program::body::ExcitationMap;

/// The action that asks least of a muscle, and the one in force before the first step.
pub const REST: f64 = -1.0;

/// Excitation in 0..1 for an action, which is clipped to [-1, 1] first.
///
/// `Linear` is u = (a + 1) / 2. `Sigmoid` is u = 1 / (1 + exp(-5 (a - 0.5))): it gives 0.0006 at -1, 0.076 at 0 and 0.924
/// at 1, so that full excitation is out of reach.
pub fn excitation(map: ExcitationMap, action: f64) -> f64 {
    let action = action.clip(-1.0, 1.0);
    match map {
        ExcitationMap::Linear => 0.5 * (action + 1.0),
        ExcitationMap::Sigmoid => 1.0 / (1.0 + libm::exp(-5.0 * (action - 0.5))),
    }
}

/// The action that asks for an excitation, or the nearest in [-1, 1]: the inverse of [`excitation`].
pub fn action(map: ExcitationMap, excitation: f64) -> f64 {
    let action = match map {
        ExcitationMap::Linear => 2.0 * excitation - 1.0,
        ExcitationMap::Sigmoid => 0.5 + 0.2 * libm::log(excitation / (1.0 - excitation)),
    };
    action.clip(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn linear_reaches_from_rest_to_full_excitation() {
        let map = |action| excitation(ExcitationMap::Linear, action);
        assert_eq!([map(REST), map(0.0), map(1.0)], [0.0, 0.5, 1.0]);
    }

    #[test]
    fn sigmoid_is_that_of_the_published_code() {
        let map = |action| excitation(ExcitationMap::Sigmoid, action);
        assert_eq!(map(0.5), 0.5);
        assert!((map(-1.0) - 0.00055).abs() < 1e-5 && (map(0.0) - 0.0759).abs() < 1e-4 && (map(1.0) - 0.924).abs() < 1e-3);
    }

    #[test]
    fn actions_are_found_for_excitations() {
        for map in [ExcitationMap::Linear, ExcitationMap::Sigmoid] {
            for wanted in [0.1, 0.5, 0.9] {
                assert!((excitation(map, action(map, wanted)) - wanted).abs() < 1e-12);
            }
            assert_eq!([action(map, 0.0), action(map, 1.0)], [-1.0, 1.0]);
        }
    }

    proptest! {
        #[test]
        fn actions_undo_the_excitation_map(given in -1.0..1.0f64) {
            for map in [ExcitationMap::Linear, ExcitationMap::Sigmoid] {
                prop_assert!((action(map, excitation(map, given)) - given).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn actions_outside_the_range_are_clipped() {
        for map in [ExcitationMap::Linear, ExcitationMap::Sigmoid] {
            assert_eq!(excitation(map, -7.0), excitation(map, -1.0));
            assert_eq!(excitation(map, 7.0), excitation(map, 1.0));
        }
    }
}
