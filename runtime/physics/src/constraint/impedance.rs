//! How soft a constraint is: MuJoCo's impedance d(r), stiffness k, damping b ("Solver parameters" in its manual).

use crate::model::SolverParameters;
use crate::scalar::Real;

/// Impedances stay in this range, MuJoCo's `mjMINIMP` and `mjMAXIMP`.
const IMPEDANCE_RANGE: [f64; 2] = [1e-4, 0.9999];
/// MuJoCo's `mjMINVAL`.
const TINY: f64 = 1e-15;

/// The virtual spring and damper of one constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SpringDamper {
    /// Stiffness before scaling by the impedance, 1/s².
    pub stiffness: f64,
    /// Damping, 1/s.
    pub damping: f64,
    /// Impedance, in (0, 1).
    pub impedance: f64,
}

/// Evaluates `softness` at the violation `residual` (position minus margin); time constants are at least `shortest` seconds,
/// two steps where the model asks for safety (MuJoCo's `refsafe`): a shorter one would be unstable.
pub(super) fn spring_damper(softness: &SolverParameters, residual: f64, shortest: f64) -> SpringDamper {
    let [low, high] = IMPEDANCE_RANGE;
    let [start, end, width, midpoint, power] = softness.impedance;
    let (start, end, midpoint) = (start.clip(low, high), end.clip(low, high), midpoint.clip(low, high));
    let impedance = if start == end || width <= TINY {
        0.5 * (start + end)
    } else {
        start + sigmoid(residual.abs() / width, midpoint, power.at_least(1.0)) * (end - start)
    };
    let [first, second] = reference(softness);
    if first > 0.0 {
        let time_constant = first.at_least(shortest);
        let stiffness = 1.0 / (end * end * time_constant * time_constant * second * second).at_least(TINY);
        SpringDamper { stiffness, damping: 2.0 / (end * time_constant).at_least(TINY), impedance }
    } else {
        SpringDamper { stiffness: -first / (end * end).at_least(TINY), damping: -second / end.at_least(TINY), impedance }
    }
}

/// Both numbers positive, or both not; anything else means nothing and counts as not given, as in MuJoCo.
fn reference(softness: &SolverParameters) -> [f64; 2] {
    let [first, second] = softness.reference;
    if (first > 0.0) == (second > 0.0) { softness.reference } else { SolverParameters::default().reference }
}

/// The polynomial sigmoid from 0 at x = 0 to 1 at x = 1 with its inflection at `midpoint`.
fn sigmoid(x: f64, midpoint: f64, power: f64) -> f64 {
    // MuJoCo's default power: squares instead of general powers.
    let raised = |base: f64| if power == 2.0 { base * base } else { libm::pow(base, power) };
    let lowered = |base: f64| if power == 2.0 { base } else { libm::pow(base, power - 1.0) };
    if x >= 1.0 {
        1.0
    } else if power == 1.0 {
        x
    } else if x <= midpoint {
        raised(x) / lowered(midpoint)
    } else {
        1.0 - raised(1.0 - x) / lowered(1.0 - midpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impedance_grows_from_its_start_to_its_end_across_the_width() {
        let softness = SolverParameters::default();
        let at = |residual: f64| spring_damper(&softness, residual, 0.002).impedance;
        assert_eq!(at(0.0), 0.9);
        assert!((at(-0.0005) - 0.925).abs() < 1e-15);
        assert_eq!(at(-0.001), 0.95);
        assert_eq!(at(0.5), 0.95);
    }

    #[test]
    fn a_time_constant_below_the_shortest_is_raised_to_it() {
        let softness = SolverParameters { reference: [0.001, 1.0], ..SolverParameters::default() };
        let stiff = spring_damper(&softness, 0.0, 0.02);
        assert!((stiff.damping - 2.0 / (0.95 * 0.02)).abs() < 1e-12);
    }

    #[test]
    fn negative_references_are_stiffness_and_damping() {
        let softness = SolverParameters { reference: [-1000.0, -20.0], ..SolverParameters::default() };
        let direct = spring_damper(&softness, 0.0, 0.001);
        assert!((direct.stiffness - 1000.0 / (0.95 * 0.95)).abs() < 1e-9 && (direct.damping - 20.0 / 0.95).abs() < 1e-12);
    }
}
