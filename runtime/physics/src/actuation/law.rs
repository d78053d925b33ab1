//! The force law of an actuator that is no plain muscle.

use super::muscle::{Curve, activation_rate};
use crate::{
    model::{Bias, Dynamics, Gain, Model},
    rotation::MINIMUM,
    scalar::Real,
};

/// What is needed of an actuator's law, ready for use.
#[derive(Debug, Clone)]
pub(super) struct Law {
    dynamics: Dynamics,
    gain: GainLaw,
    bias: BiasLaw,
    /// The length around the circle, for a servo that takes the short way.
    circle: Option<f64>,
    range: Option<[f64; 2]>,
}

#[derive(Debug, Clone)]
enum GainLaw {
    Affine([f64; 3]),
    Muscle(Curve),
}

#[derive(Debug, Clone)]
enum BiasLaw {
    Affine([f64; 3]),
    Muscle(Curve),
}

impl Law {
    pub fn new(model: &Model, actuator: usize) -> Self {
        let actuators = &model.actuators;
        let curve =
            |figures: &[f64; 9]| Curve::new(figures, actuators.length_range[actuator], actuators.acceleration_scale[actuator]);
        let (gain, bias) = (actuators.gain[actuator], actuators.bias[actuator]);
        let servo = matches!((gain, bias), (Gain::Fixed(pull), Bias::Affine([_, back, _])) if pull == -back);
        Self {
            dynamics: actuators.dynamics[actuator],
            gain: match &gain {
                Gain::Fixed(gain) => GainLaw::Affine([*gain, 0.0, 0.0]),
                Gain::Affine(figures) => GainLaw::Affine(*figures),
                Gain::Muscle(figures) => GainLaw::Muscle(curve(figures)),
            },
            bias: match &bias {
                Bias::None => BiasLaw::Affine([0.0; 3]),
                Bias::Affine(figures) => BiasLaw::Affine(*figures),
                Bias::Muscle(figures) => BiasLaw::Muscle(curve(figures)),
            },
            circle: super::transmission::circle(model, actuator).filter(|_| servo),
            range: actuators.activation_range[actuator],
        }
    }

    /// Rate of the activation under a control.
    pub fn rate<T: Real>(&self, control: T, activation: T) -> T {
        match &self.dynamics {
            Dynamics::None => T::splat(0.0),
            Dynamics::Integrator => control,
            Dynamics::Filter(time) | Dynamics::ExactFilter(time) => {
                self.short_way(control - activation) / T::splat(time.at_least(MINIMUM))
            }
            Dynamics::Muscle(constants) => activation_rate(control, activation, constants),
        }
    }

    /// The activation after `step` seconds at a rate, clamped to its range; a servo's set point on a circle comes back to the
    /// turn that is nearest to `length`.
    pub fn next<T: Real>(&self, activation: T, rate: T, length: T, step: f64) -> T {
        let change = match &self.dynamics {
            Dynamics::ExactFilter(time) => {
                let time = time.at_least(MINIMUM);
                rate * T::splat(time * (1.0 - libm::exp(-step / time)))
            }
            _ => rate * T::splat(step),
        };
        let mut next = activation + change;
        if let Some([low, high]) = self.range {
            next = next.at_least(T::splat(low)).at_most(T::splat(high));
        }
        match self.circle {
            Some(_) => length + self.short_way(next - length),
            None => next,
        }
    }

    /// What the drive is multiplied with, and what is added; `drive` on a circle is brought next to `length` first. `strength` scales
    /// the gain of a muscle.
    pub fn force<T: Real>(&self, drive: T, strength: T, length: T, velocity: T) -> [T; 3] {
        let affine = |[constant, by_length, by_velocity]: [f64; 3]| {
            T::splat(constant) + T::splat(by_length) * length + T::splat(by_velocity) * velocity
        };
        let gain = match &self.gain {
            GainLaw::Affine(figures) => affine(*figures),
            GainLaw::Muscle(curve) => -curve.gain(length, velocity) * strength,
        };
        let bias = match &self.bias {
            BiasLaw::Affine(figures) => affine(*figures),
            BiasLaw::Muscle(curve) => -curve.passive(length),
        };
        let drive = if self.circle.is_some() { length + self.short_way(drive - length) } else { drive };
        [gain, bias, gain * drive + bias]
    }

    /// How the force changes with velocity, N s/m.
    pub fn damping<T: Real>(&self, drive: T, strength: T, length: T, velocity: T) -> T {
        let by_gain = match &self.gain {
            GainLaw::Affine([_, _, by_velocity]) => T::splat(*by_velocity) * drive,
            GainLaw::Muscle(curve) => -curve.damping(length, velocity) * drive * strength,
        };
        match &self.bias {
            BiasLaw::Affine([_, _, by_velocity]) => by_gain + T::splat(*by_velocity),
            BiasLaw::Muscle(_) => by_gain,
        }
    }

    /// A difference of set points, less whole turns.
    fn short_way<T: Real>(&self, difference: T) -> T {
        let Some(circle) = self.circle else { return difference };
        let mut short = difference;
        for lane in 0..T::LANES {
            let value = difference.lane(lane);
            short.set_lane(lane, value - circle * libm::round(value / circle));
        }
        short
    }
}
