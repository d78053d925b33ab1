//! Muscles: activation dynamics and force.
//!
//! Force = -(active(L) active(V) activation + passive(L)) F0, with L and V the fibre's length and velocity scaled by its
//! optimal length, which follows from the operating range of the path (MuJoCo's manual, "Muscles"; the activation dynamics
//! are those of Millard et al., J. Biomech. Eng. 135, 2013). Positive path force lengthens; muscles pull, so theirs is negative.

use crate::{rotation::MINIMUM, scalar::Real};

/// Rate of activation (1/s) under `excitation`; `constants` are the activation and deactivation times (s) and the width of
/// the smooth transition between them.
#[inline(always)]
pub fn activation_rate<T: Real>(excitation: T, activation: T, constants: &[f64; 3]) -> T {
    let (zero, one, half) = (T::splat(0.0), T::splat(1.0), T::splat(0.5));
    let unit = |value: T| value.at_least(zero).at_most(one);
    let pace = half + T::splat(1.5) * unit(activation);
    let (rise, fall) = (T::splat(constants[0]) * pace, T::splat(constants[1]) / pace);
    let change = unit(excitation) - activation;
    let width = constants[2];
    let time = if width < MINIMUM {
        T::select(zero.less(change), rise, fall)
    } else {
        // Smootherstep: 6 x^5 - 15 x^4 + 10 x^3.
        let x = unit(change / T::splat(width) + half);
        let share = x * x * x * (T::splat(3.0) * x * (T::splat(2.0) * x - T::splat(5.0)) + T::splat(10.0));
        fall + (rise - fall) * share
    };
    change / time.at_least(T::splat(MINIMUM))
}

/// The constants of a force-length-velocity curve: peaks and scales ready for use.
#[derive(Debug, Clone)]
pub struct Curve {
    /// F0, N.
    peak: f64,
    /// Scaled length = scale * path length + offset.
    scale: f64,
    offset: f64,
    /// Optimal fibre length and tendon slack length, m.
    optimal: f64,
    slack: f64,
    /// One over the maximal shortening velocity of the path, s/m.
    velocity_scale: f64,
    /// Scaled lengths between which the muscle is active, and half-way from either to the optimum.
    shortest: f64,
    ascending: f64,
    descending: f64,
    longest: f64,
    /// Active force at the fastest lengthening, passive force half-way to the longest, in units of F0.
    lengthening_peak: f64,
    passive_peak: f64,
    /// One over the distance from the shortest to the ascending length, from there to the optimum, from that to the descending one, from
    /// there to the longest; and over the velocity, beyond zero, at which that peak is reached.
    inverse: [f64; 4],
    inverse_knee: f64,
}

impl Curve {
    /// From MuJoCo's nine figures: range (2), force, scale, lmin, lmax, vmax, fpmax, fvmax.
    pub fn new(figures: &[f64; 9], length_range: [f64; 2], acceleration_scale: f64) -> Self {
        let [low, high, force, force_scale, shortest, longest, fastest, passive_peak, lengthening_peak] = *figures;
        let optimal = (length_range[1] - length_range[0]) / (high - low).at_least(MINIMUM);
        let scale = 1.0 / optimal.at_least(MINIMUM);
        let offset = low - length_range[0] * scale;
        let (ascending, descending) = (0.5 * (shortest + 1.0), 0.5 * (1.0 + longest));
        let inverse = |distance: f64| 1.0 / distance.at_least(MINIMUM);
        Self {
            peak: if force < 0.0 { force_scale / acceleration_scale.at_least(MINIMUM) } else { force },
            scale,
            offset,
            optimal: 1.0 / scale,
            slack: -offset * (1.0 / scale),
            velocity_scale: 1.0 / (optimal * fastest).at_least(MINIMUM),
            shortest,
            ascending,
            descending,
            longest,
            lengthening_peak,
            passive_peak,
            inverse: [ascending - shortest, 1.0 - ascending, descending - 1.0, longest - descending].map(inverse),
            inverse_knee: inverse(lengthening_peak - 1.0),
        }
    }

    /// Optimal fibre length and tendon slack length, m.
    pub fn lengths(&self) -> (f64, f64) {
        (self.optimal, self.slack)
    }

    /// Peak isometric force, N.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// Maximal shortening velocity, optimal lengths per second.
    pub fn fastest(&self) -> f64 {
        self.scale / self.velocity_scale
    }

    /// Active force at full activation, N.
    #[inline(always)]
    pub fn gain<T: Real>(&self, length: T, velocity: T) -> T {
        let length = length * T::splat(self.scale) + T::splat(self.offset);
        let velocity = velocity * T::splat(self.velocity_scale);
        T::splat(self.peak) * self.active_by_length(length) * self.active_by_velocity(velocity)
    }

    /// Slope of [`gain`](Self::gain) over velocity, N s/m.
    #[inline(always)]
    pub fn damping<T: Real>(&self, length: T, velocity: T) -> T {
        let length = length * T::splat(self.scale) + T::splat(self.offset);
        let slope = self.slope_by_velocity(velocity * T::splat(self.velocity_scale));
        T::splat(self.peak * self.velocity_scale) * self.active_by_length(length) * slope
    }

    /// Slope of [`active_by_velocity`](Self::active_by_velocity).
    #[inline(always)]
    pub fn slope_by_velocity<T: Real>(&self, velocity: T) -> T {
        let (zero, one, two) = (T::splat(0.0), T::splat(1.0), T::splat(2.0));
        let knee = self.lengthening_peak - 1.0;
        let lengthening = two * (T::splat(knee) - velocity).at_least(zero) * T::splat(self.inverse_knee);
        let shortening = two * (velocity + one).at_least(zero);
        T::select(zero.less(velocity), lengthening, shortening)
    }

    /// Four parabolas: zero outside [lmin, lmax], one at 1.
    #[inline(always)]
    pub fn active_by_length<T: Real>(&self, length: T) -> T {
        let (one, half) = (T::splat(1.0), T::splat(0.5));
        let [from_shortest, to_optimum, from_optimum, to_longest] = self.inverse.map(T::splat);
        let rising = (length - T::splat(self.shortest)) * from_shortest;
        let falling = (T::splat(self.longest) - length) * to_longest;
        let below = (one - length) * to_optimum;
        let above = (length - one) * from_optimum;
        let top = |x: T| one - half * x * x;
        let foot = |x: T| half * x * x;
        let mut value = foot(falling);
        value = T::select(T::splat(self.descending).less(length), value, top(above));
        value = T::select(one.less(length), value, top(below));
        value = T::select(T::splat(self.ascending).less(length), value, foot(rising));
        let outside = T::or(length.less(T::splat(self.shortest)), T::splat(self.longest).less(length));
        T::select(outside, T::splat(0.0), value)
    }

    /// A parabola while shortening, another while lengthening, constant beyond.
    #[inline(always)]
    pub fn active_by_velocity<T: Real>(&self, velocity: T) -> T {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let peak = T::splat(self.lengthening_peak);
        let knee = self.lengthening_peak - 1.0;
        let slower = T::splat(knee) - velocity;
        let lengthening = peak - slower * slower * T::splat(self.inverse_knee);
        let shortening = (velocity + one) * (velocity + one);
        let mut value = T::select(T::splat(knee).less(velocity), peak, lengthening);
        value = T::select(zero.less(velocity), value, shortening);
        T::select(T::less(-one, velocity), value, zero)
    }

    /// Passive force, N: zero up to the optimal length, then a parabola, then a straight line.
    #[inline(always)]
    pub fn passive<T: Real>(&self, length: T) -> T {
        let length = length * T::splat(self.scale) + T::splat(self.offset);
        T::splat(self.peak * self.passive_peak) * self.stretch(length)
    }

    /// The same over scaled length, in units of F0.
    #[inline(always)]
    pub fn passive_by_length<T: Real>(&self, length: T) -> T {
        T::splat(self.passive_peak) * self.stretch(length)
    }

    #[inline(always)]
    fn stretch<T: Real>(&self, length: T) -> T {
        let (zero, one, half) = (T::splat(0.0), T::splat(1.0), T::splat(0.5));
        let inverse = T::splat(self.inverse[2]);
        let curve = (length - one) * inverse;
        let line = (length - T::splat(self.descending)) * inverse;
        let value = T::select(T::splat(self.descending).less(length), half + line, half * curve * curve);
        T::select(one.less(length), value, zero)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damping_is_the_slope_of_the_force_velocity_curve() {
        let figures = [0.75, 1.05, 1000.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2];
        let curve = Curve::new(&figures, [0.2, 0.3], 1.0);
        let step = 1e-6;
        // Too fast to pull, shortening, slowly lengthening, lengthening so fast that the force no longer rises.
        for velocity in [-0.7, -0.3, -0.01, 0.02, 0.09, 0.4] {
            let [slower, faster] = [-step, step].map(|change| curve.gain(0.27, velocity + change));
            let expected = (faster - slower) / (2.0 * step);
            let found = curve.damping(0.27, velocity);
            assert!((found - expected).abs() < 1e-5 * (1.0 + expected), "at {velocity} m/s: {found} is not {expected}");
        }
    }
}
