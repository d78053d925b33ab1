//! The curves of a fibre and of a tendon, in units of optimal fibre length, maximal shortening velocity, peak isometric force
//! and tendon slack length.
//!
//! Closed forms of De Groote, Kinney, Rao and Fregly, "Evaluation of direct collocation optimal control problem formulations
//! for solving the muscle redundancy problem", Ann. Biomed. Eng. 44 (2016), supplementary equations S1 to S4. They are smooth
//! and follow the Bézier curves of Millard, Uchida, Seth and Delp, "Flexing computational muscle", J. Biomech. Eng. 135 (2013).

use crate::scalar::Real;

/// A curve's value and its slope.
pub type Sloped = [f64; 2];

/// Amplitude, centre, width and change of width over length of the three bells of the active force-length curve.
const BELLS: [[f64; 4]; 3] = [
    [0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465],
    [0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188],
    [0.1, 1.0, 0.353553390593274, 0.0],
];
/// Below this length the second bell is zero to the last bit, and its width on the way to zero.
const SECOND_BELL: f64 = 0.3;

/// Active force over fibre length: three bells b1 exp(-(l - b2)² / (2 (b3 + b4 l)²)).
pub fn active(length: f64) -> Sloped {
    let mut sum = [0.0; 2];
    for (index, [height, centre, width, growth]) in BELLS.into_iter().enumerate() {
        if index == 1 && length < SECOND_BELL {
            continue;
        }
        let inverse = 1.0 / (width + growth * length);
        let offset = (length - centre) * inverse;
        let value = height * libm::exp(-0.5 * offset * offset);
        sum[0] += value;
        sum[1] -= value * offset * inverse * (1.0 - growth * offset);
    }
    sum
}

/// Exponent and strain at peak force of the passive force-length curve.
const PASSIVE: [f64; 2] = [4.0, 0.6];

/// Passive force over fibre length: (exp(4 (l - 1) / 0.6) - 1) / (exp(4) - 1), zero below the optimal length, where the closed
/// form falls below zero by up to 0.02.
pub fn passive(length: f64) -> Sloped {
    if length <= 1.0 {
        return [0.0; 2];
    }
    let (rate, scale) = passive_constants();
    let power = libm::exp(rate * (length - 1.0));
    [(power - 1.0) * scale, power * rate * scale]
}

/// Energy stored in passive stretch up to `length`, in units of peak force times optimal length.
pub fn passive_energy(length: f64) -> f64 {
    if length <= 1.0 {
        return 0.0;
    }
    let (rate, scale) = passive_constants();
    let stretch = length - 1.0;
    (libm::expm1(rate * stretch) / rate - stretch) * scale
}

fn passive_constants() -> (f64, f64) {
    let [shape, strain] = PASSIVE;
    /// 1 / (exp(4) - 1).
    const SCALE: f64 = 0.018_657_360_363_774_05;
    (shape / strain, SCALE)
}

/// d1 to d4 of the force-velocity curve.
#[allow(clippy::approx_constant, reason = "a fitted figure that happens to lie near 1 / pi")]
const VELOCITY: [f64; 4] = [-0.318, -8.149, -0.374, 0.886];

/// Factor of the active force over fibre velocity (lengthening positive): d1 ln(x + sqrt(x² + 1)) + d4, x = d2 v + d3.
pub fn velocity(velocity: f64) -> Sloped {
    let [scale, rate, shift, offset] = VELOCITY;
    let x = rate * velocity + shift;
    let root = (x * x + 1.0).sqrt();
    // The inverse hyperbolic sine is odd; for negative x the sum in the logarithm would cancel.
    let inverse_sinh = libm::copysign(libm::log(x.abs() + root), x);
    [scale * inverse_sinh + offset, scale * rate / root]
}

/// c1 to c3 of the tendon's force-strain curve.
const TENDON: [f64; 3] = [0.2, 0.995, 0.25];
/// The exponent is cut where the force is millions of times the peak, so that no stretch overflows.
const LARGEST_EXPONENT: f64 = 20.0;

/// Distance in the exponent up to which the exponential's series to the fifth order is off by less than 2e-13 of its value.
const NEAR: f64 = 0.02;

/// Where the exponential of a tendon was computed last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Anchor {
    exponent: f64,
    power: f64,
}

impl Default for Anchor {
    fn default() -> Self {
        Self { exponent: f64::NAN, power: f64::NAN }
    }
}

/// Force of a tendon over its strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tendon {
    rate: f64,
    /// Strain up to which the tendon is slack.
    slack: f64,
}

impl Tendon {
    /// A tendon that carries peak isometric force at `strain`.
    pub fn new(strain: f64) -> Self {
        let [c1, c2, c3] = TENDON;
        // The published curve is taut from a strain of 0.0014 on; a stiffer tendon has the same curve at another scale.
        let (foot, top) = (libm::log(c3 / c1), libm::log((1.0 + c3) / c1));
        const PUBLISHED: f64 = 0.049;
        let published = top / (1.0 + PUBLISHED - c2);
        let rate = published * (PUBLISHED / strain);
        Self { rate, slack: (foot / published + c2 - 1.0) * (strain / PUBLISHED) }
    }

    /// Force and its slope over strain: c1 exp(k (1 + strain - c2)) - c3, never negative, since a tendon does not push.
    pub fn force(&self, strain: f64) -> Sloped {
        self.force_near(strain, &mut Anchor::default())
    }

    /// The same where a strain nearby may have been asked for before: the exponential's series leads from there to here.
    #[inline(always)]
    pub(super) fn force_near(&self, strain: f64, anchor: &mut Anchor) -> Sloped {
        let [_, _, c3] = TENDON;
        let exponent = self.rate * (strain - self.slack);
        if exponent <= 0.0 {
            return [0.0; 2];
        }
        if exponent >= LARGEST_EXPONENT {
            let power = c3 * libm::exp(LARGEST_EXPONENT);
            return [power * (1.0 + exponent - LARGEST_EXPONENT) - c3, power * self.rate];
        }
        let x = exponent - anchor.exponent;
        // Before the first time the distance is not a number.
        let power = if x.abs() < NEAR {
            let series = x * (1.0 + x * (1.0 / 2.0 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0)))));
            anchor.power + anchor.power * series
        } else {
            c3 * libm::exp(exponent)
        };
        *anchor = Anchor { exponent, power };
        [power - c3, power * self.rate]
    }

    /// Change of the force `force` of a taut tendon where the tangent changes it by the small `linear`: the exponential's
    /// series to the third order.
    pub fn small_change(&self, force: f64, linear: f64) -> f64 {
        let [_, _, c3] = TENDON;
        let x = linear / (force + c3);
        linear * (1.0 + x * (0.5 + x / 6.0))
    }

    /// Energy stored at `strain`, in units of peak force times slack length.
    pub fn energy(&self, strain: f64) -> f64 {
        let [_, _, c3] = TENDON;
        let exponent = (self.rate * (strain - self.slack)).at_least(0.0);
        c3 * (libm::expm1(exponent) - exponent) / self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the same closed forms: the bells by Python with the paper's figures, which have three digits (worth 0.0025); the others by
    /// sympy 1.14 (`sympy.physics.biomechanics`).
    #[test]
    fn the_curves_are_the_published_ones() {
        let near = |name: &str, at: f64, found: f64, expected: f64, tolerance: f64| {
            assert!((found - expected).abs() < tolerance, "{name}({at}) is {found}, not {expected}");
        };
        let bells = [(0.4, 0.0256), (0.6, 0.2998), (0.8, 0.8348), (0.9, 0.9358), (1.0, 0.9993), (1.1, 0.9526), (1.4, 0.3782)];
        for (length, expected) in bells {
            near("active", length, active(length)[0], expected, 3e-3);
        }
        for (length, expected) in [(1.1, 0.017682215532972924), (1.3, 0.11920292202211769), (1.6, 1.0)] {
            near("passive", length, passive(length)[0], expected, 1e-12);
        }
        let hill = [
            (-1.0, 0.012081678112282557),
            (-0.5, 0.2438336294197121),
            (-0.1, 0.7499796018964964),
            (0.0, 1.002320622548512),
            (0.25, 1.3991744765057754),
            (1.0, 1.7889099602998804),
        ];
        for (speed, expected) in hill {
            near("velocity", speed, velocity(speed)[0], expected, 1e-12);
        }
        let tendon = Tendon::new(0.049);
        for (strain, expected) in [(0.0, 0.0), (0.005, 0.030811690544764445), (0.03, 0.40596120508613764), (0.049, 1.0)] {
            near("tendon", strain, tendon.force(strain)[0], expected, 1e-12);
        }
    }

    /// The landmarks of the curves of Millard et al. 2013: optimum at 1, no active force at 0.44 and 1.81, peak passive force
    /// at 0.6 to 0.7 strain, no force at maximal shortening, 1.4 and more while lengthening.
    #[test]
    fn the_curves_have_the_landmarks_of_their_model() {
        let best = (40..180).map(|percent| f64::from(percent) / 100.0).max_by(|a, b| active(*a)[0].total_cmp(&active(*b)[0]));
        assert!((best.unwrap() - 1.0).abs() < 0.03, "the optimum is at {best:?}");
        assert!(active(0.44)[0] < 0.06 && active(1.8123)[0] < 0.03);
        assert!(passive(1.55)[0] < 1.0 && passive(1.7)[0] > 1.0);
        assert!(velocity(-1.0)[0].abs() < 0.02 && velocity(0.5)[0] > 1.4);
    }

    #[test]
    fn slopes_and_energies_belong_to_their_curves() {
        let step = 1e-6;
        let central = |curve: &dyn Fn(f64) -> f64, at: f64| (curve(at + step) - curve(at - step)) / (2.0 * step);
        for hundredth in 5..200 {
            let length = f64::from(hundredth) / 100.0 + 0.003;
            assert!((active(length)[1] - central(&|l| active(l)[0], length)).abs() < 1e-7);
            assert!((passive(length)[1] - central(&|l| passive(l)[0], length)).abs() < 1e-6 * passive(length)[1].at_least(1.0));
            assert!((passive(length)[0] - central(&passive_energy, length)).abs() < 1e-7 * passive(length)[0].at_least(1.0));
            let speed = 3.0 * (length - 1.0);
            assert!((velocity(speed)[1] - central(&|v| velocity(v)[0], speed)).abs() < 1e-7);
        }
        for strain in [0.049, 0.01, 1e-4] {
            let tendon = Tendon::new(strain);
            assert!((tendon.force(strain)[0] - 1.0).abs() < 1e-12);
            for share in [-1.0, 0.02, 0.1, 0.5, 1.0, 2.0] {
                let (at, small) = (share * strain, 1e-5 * strain);
                let central = |curve: &dyn Fn(f64) -> f64| (curve(at + small) - curve(at - small)) / (2.0 * small);
                let [force, slope] = tendon.force(at);
                assert!((slope - central(&|e| tendon.force(e)[0])).abs() <= 1e-6 * slope.at_least(1.0 / strain));
                assert!((force - central(&|e| tendon.energy(e))).abs() <= 1e-6 * force.at_least(1.0));
            }
        }
    }
}
