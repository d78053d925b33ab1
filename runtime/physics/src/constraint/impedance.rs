//! How soft a constraint is: MuJoCo's impedance d(r), stiffness k, damping b ("Solver parameters" in its manual).

use crate::model::SolverParameters;
use crate::scalar::Real;

/// Impedances stay in this range, MuJoCo's `mjMINIMP` and `mjMAXIMP`.
const IMPEDANCE_RANGE: [f64; 2] = [1e-4, 0.9999];
/// MuJoCo's `mjMINVAL`.
const TINY: f64 = 1e-15;

/// The virtual spring and damper of one constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpringDamper {
    /// Stiffness before scaling by the impedance, 1/s².
    pub stiffness: f64,
    /// Damping, 1/s.
    pub damping: f64,
    /// Impedance, in (0, 1).
    pub impedance: f64,
}

/// A softness in which all is worked out that does not depend on the violation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spring {
    /// Stiffness before scaling by the impedance, 1/s².
    pub stiffness: f64,
    /// Damping, 1/s.
    pub damping: f64,
    /// Impedance without violation.
    start: f64,
    /// How it changes with the violation; `None` where it is constant.
    curve: Option<Curve>,
}

impl Spring {
    /// Of a softness; time constants are at least `shortest` seconds, two steps where the model asks for safety (MuJoCo's `refsafe`): a
    /// shorter one would be unstable.
    pub fn new(softness: &SolverParameters, shortest: f64) -> Self {
        let [low, high] = IMPEDANCE_RANGE;
        let [start, end, width, midpoint, power] = softness.impedance;
        let (start, end, midpoint) = (start.clip(low, high), end.clip(low, high), midpoint.clip(low, high));
        let constant = start == end || width <= TINY;
        let curve = Curve { growth: end - start, width, midpoint, power: power.at_least(1.0) };
        let (start, curve) = if constant { (0.5 * (start + end), None) } else { (start, Some(curve)) };
        let [first, second] = reference(softness);
        let (stiffness, damping) = if first > 0.0 {
            let time_constant = first.at_least(shortest);
            let stiffness = 1.0 / (end * end * time_constant * time_constant * second * second).at_least(TINY);
            (stiffness, 2.0 / (end * time_constant).at_least(TINY))
        } else {
            (-first / (end * end).at_least(TINY), -second / end.at_least(TINY))
        };
        Self { stiffness, damping, start, curve }
    }

    /// The same without stiffness: it only damps.
    pub fn slack(self) -> Self {
        Self { stiffness: 0.0, ..self }
    }

    /// Impedance at a violation (position minus margin).
    #[inline(always)]
    pub fn impedance<T: Real>(&self, violation: T) -> T {
        let Some(curve) = &self.curve else { return T::splat(self.start) };
        T::splat(self.start) + curve.sigmoid(violation.abs() / T::splat(curve.width)) * T::splat(curve.growth)
    }

    /// All three numbers at a violation.
    pub fn at(&self, violation: f64) -> SpringDamper {
        SpringDamper { stiffness: self.stiffness, damping: self.damping, impedance: self.impedance(violation) }
    }
}

/// Both numbers positive, or both not; anything else means nothing and counts as not given, as in MuJoCo.
fn reference(softness: &SolverParameters) -> [f64; 2] {
    let [first, second] = softness.reference;
    if (first > 0.0) == (second > 0.0) { softness.reference } else { SolverParameters::default().reference }
}

/// The change of an impedance over the width of the violation.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Curve {
    growth: f64,
    width: f64,
    midpoint: f64,
    power: f64,
}

impl Curve {
    /// The polynomial sigmoid from 0 at x = 0 to 1 at x = 1 with its inflection at the midpoint.
    #[inline(always)]
    fn sigmoid<T: Real>(&self, x: T) -> T {
        let (zero, one, midpoint) = (T::splat(0.0), T::splat(1.0), T::splat(self.midpoint));
        // Not the same as x >= 1 without the second part: a number that is none stays what it is.
        let past = T::and(T::not(x.less(one)), zero.less(x));
        let mut value = x;
        if self.power != 1.0 {
            let high = midpoint.less(x);
            // Powers are dear: only on sides where a lane is.
            if !T::all(high) {
                value = self.raised(x) / self.lowered(midpoint);
            }
            if T::any(high) {
                let falling = one - self.raised(one - x) / self.lowered(one - midpoint);
                value = T::select(high, falling, value);
            }
        }
        T::select(past, one, value)
    }

    /// A power; squares, MuJoCo's default, without the general function.
    #[inline(always)]
    fn raised<T: Real>(&self, base: T) -> T {
        if self.power == 2.0 { base * base } else { base.powf(T::splat(self.power)) }
    }

    /// The power that is one less.
    #[inline(always)]
    fn lowered<T: Real>(&self, base: T) -> T {
        if self.power == 2.0 { base } else { base.powf(T::splat(self.power - 1.0)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impedance_grows_from_its_start_to_its_end_across_the_width() {
        let softness = SolverParameters::default();
        let at = |residual: f64| Spring::new(&softness, 0.002).at(residual).impedance;
        assert_eq!(at(0.0), 0.9);
        assert!((at(-0.0005) - 0.925).abs() < 1e-15);
        assert_eq!(at(-0.001), 0.95);
        assert_eq!(at(0.5), 0.95);
    }

    #[test]
    fn a_time_constant_below_the_shortest_is_raised_to_it() {
        let softness = SolverParameters { reference: [0.001, 1.0], ..SolverParameters::default() };
        let stiff = Spring::new(&softness, 0.02).at(0.0);
        assert!((stiff.damping - 2.0 / (0.95 * 0.02)).abs() < 1e-12);
    }

    #[test]
    fn negative_references_are_stiffness_and_damping() {
        let softness = SolverParameters { reference: [-1000.0, -20.0], ..SolverParameters::default() };
        let direct = Spring::new(&softness, 0.001).at(0.0);
        assert!((direct.stiffness - 1000.0 / (0.95 * 0.95)).abs() < 1e-9 && (direct.damping - 20.0 / 0.95).abs() < 1e-12);
    }
}
