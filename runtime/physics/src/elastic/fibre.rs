//! One muscle: a fibre and a tendon in series, advanced over one step.

use super::{
    curves::{Anchor, Sloped, Tendon, passive},
    table::Tables,
};
use crate::actuation::Curve;
use crate::scalar::Real;
use std::sync::Arc;

/// Shortest fibre, in optimal lengths. Where a path is still shorter, its tendon hangs slack.
const SHORTEST: f64 = 0.05;
/// Imbalance of fibre and tendon, in units of peak force, from which one more step of Newton's leaves less than 1e-7.
const TOLERANCE: f64 = 1e-4;
/// Steps of the search at most; bisection alone needs about 50.
const STEPS: usize = 100;
/// Smallest cosine of pennation that is computed with.
const SMALLEST_COSINE: f64 = 0.1;

/// Which curves a fibre has.
#[derive(Debug, Clone)]
pub(crate) enum Curves {
    Published(Arc<Tables>),
    /// With the factor and offset that turn a length scaled for the active curve into one scaled for the passive curve: the
    /// two parts of a model's muscle may have different figures.
    Model {
        active: Box<Curve>,
        passive: Box<Curve>,
        scale: [f64; 2],
    },
}

impl Curves {
    /// Active and passive force over length.
    fn over_length(&self, length: f64) -> [Sloped; 2] {
        match self {
            Self::Published(tables) => [tables.active.at(length), passive(length)],
            Self::Model { active, passive, scale: [factor, offset] } => {
                // Parabolas, of which a central difference is the slope.
                const STEP: f64 = 1e-4;
                let sloped = |curve: &dyn Fn(f64) -> f64| {
                    let slope = (curve(length + STEP) - curve(length - STEP)) / (2.0 * STEP);
                    [curve(length), slope]
                };
                [
                    sloped(&|length| active.active_by_length(length)),
                    sloped(&|length| passive.passive_by_length(factor * length + offset)),
                ]
            }
        }
    }

    fn over_velocity(&self, value: f64) -> Sloped {
        match self {
            Self::Published(tables) => tables.velocity.at(value),
            Self::Model { active, .. } => [active.active_by_velocity(value), active.slope_by_velocity(value)],
        }
    }
}

/// What does not change about one muscle. Lengths in m, forces in N.
#[derive(Debug, Clone)]
pub(crate) struct Unit {
    /// Index of the actuator, and of its activation.
    pub place: [usize; 2],
    /// Optimal fibre length.
    pub optimal: f64,
    /// Path length at which an undisturbed fibre of length zero would leave the tendon just slack.
    pub slack: f64,
    /// Length of tendon that stretches.
    pub compliant: f64,
    /// Peak isometric force of the intact muscle, by which its tendon and its passive force scale.
    pub peak: f64,
    /// Share of it that the fibre can still bring up.
    pub strength: f64,
    /// Maximal shortening velocity, optimal lengths per second.
    pub fastest: f64,
    /// Damping of the fibre, peak forces per maximal velocity.
    pub damping: f64,
    /// Thickness of the muscle, which stays constant: sine of the pennation angle at optimal length.
    pub thickness: f64,
    pub tendon: Tendon,
    pub curves: Curves,
}

/// A fibre with its tendon at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fibre {
    /// m.
    pub length: f64,
    /// m/s.
    pub velocity: f64,
    /// Along the tendon, N; never negative.
    pub force: f64,
    /// Of that the active part at full activation, N.
    pub gain: f64,
}

/// The length-dependent half of the balance, linear about one fibre length.
struct Local {
    length: f64,
    active: Sloped,
    passive: Sloped,
    cosine: f64,
    /// Strain of the tendon there, and how it changes with the fibre's length.
    strain: Sloped,
}

/// How far a fibre at one velocity is from balance with its tendon, along the tendon and in peak forces.
struct Balance {
    /// Force of the fibre less that of the tendon.
    excess: f64,
    /// Its slope over velocity.
    slope: f64,
    /// Force of the tendon and its slope over velocity.
    pull: Sloped,
    /// Factor of the active force by velocity; `None` where a silent muscle has no use for it.
    factor: Option<f64>,
}

impl Unit {
    /// The fibre `step` seconds after it was `before` (length in m, velocity in m/s), on a path of length `path`.
    ///
    /// Implicit in the fibre's velocity v: with l = before + step v, activation times active(l) velocity(v) + passive(l) +
    /// damping v balances the tendon's force at path - l. The curves over length are taken linear about the length that the
    /// last velocity leads to; over velocity and strain they are exact. Newton's method between brackets always ends: the
    /// fibre's damping and the tendon leave no more than one balance.
    pub fn advance(&self, path: f64, before: [f64; 2], activation: f64, step: f64) -> Fibre {
        let speed = self.optimal * self.fastest;
        let start = before[0] / self.optimal;
        let reach = step * self.fastest;
        let guess = before[1] / speed;
        let local = self.local(path, (start + reach * guess).at_least(SHORTEST));
        let mut anchor = Anchor::default();
        let mut bracket = [f64::NEG_INFINITY, f64::INFINITY];
        let mut value = guess;
        for _ in 0..STEPS {
            let balance = self.balance(&local, &mut anchor, start, reach, value, activation);
            let newton = value - balance.excess / balance.slope;
            let shortest = start + reach * newton < SHORTEST;
            if balance.excess.abs() <= TOLERANCE {
                if shortest {
                    value = newton;
                    break;
                }
                return self.last_step(&local, &balance, start + reach * newton, [value, newton]);
            }
            bracket[usize::from(balance.excess > 0.0)] = value;
            value = if bracket[0] < newton && newton < bracket[1] {
                newton
            } else if bracket[0].is_finite() && bracket[1].is_finite() {
                0.5 * (bracket[0] + bracket[1])
            } else {
                // A slope that leads astray: stride towards the open side.
                value - (1.0 + value.abs()) * balance.excess.signum()
            };
            if bracket[1] - bracket[0] <= 1e-14 * (1.0 + value.abs()) {
                break;
            }
        }
        let length = (start + reach * value).at_least(SHORTEST);
        let value = if reach > 0.0 { (length - start) / reach } else { value };
        self.fibre(&local, length, value)
    }

    /// The fibre after a last, small step of Newton's from one velocity to another: the tendon's exponential is continued by
    /// its series instead of being taken anew.
    fn last_step(&self, local: &Local, balance: &Balance, length: f64, [from, to]: [f64; 2]) -> Fibre {
        let [pull, slope] = balance.pull;
        let change = self.tendon.small_change(pull, slope * (to - from));
        let active = (local.active[0] + local.active[1] * (length - local.length)).at_least(0.0)
            * balance.factor.unwrap_or_else(|| self.curves.over_velocity(to)[0]);
        Fibre {
            length: length * self.optimal,
            velocity: to * self.optimal * self.fastest,
            force: (pull + change).at_least(0.0) * self.peak,
            gain: active * local.cosine * self.strength * self.peak,
        }
    }

    /// The fibre that is in balance with its tendon while the tendon keeps its length: it moves with its path, at most at its
    /// maximal velocity. By bisection between the shortest fibre and the one that leaves the tendon slack.
    pub fn equilibrium(&self, path: f64, path_velocity: f64, activation: f64) -> Fibre {
        let value = (path_velocity / (self.optimal * self.fastest)).clip(-1.0, 1.0);
        let excess =
            |length: f64| self.balance(&self.local(path, length), &mut Anchor::default(), length, 0.0, value, activation).excess;
        let along = (path - self.slack) / self.optimal;
        let longest = (along.at_least(0.0) * along.at_least(0.0) + self.thickness * self.thickness).sqrt();
        let mut bracket = [SHORTEST, longest.at_least(SHORTEST)];
        if excess(bracket[1]) <= 0.0 {
            // Shortening faster than it can pull: the tendon is slack.
            bracket[0] = bracket[1];
        }
        for _ in 0..60 {
            let middle = 0.5 * (bracket[0] + bracket[1]);
            bracket[usize::from(excess(middle) > 0.0)] = middle;
        }
        let length = 0.5 * (bracket[0] + bracket[1]);
        self.fibre(&self.local(path, length), length, value)
    }

    /// Length along the path of a fibre of that length, both in m.
    pub fn along_path(&self, length: f64) -> f64 {
        if self.thickness == 0.0 {
            return length;
        }
        let thickness = self.thickness * self.optimal;
        (length * length - thickness * thickness).at_least(0.0).sqrt()
    }

    fn local(&self, path: f64, length: f64) -> Local {
        let [active, passive] = self.curves.over_length(length);
        let cosine = if self.thickness == 0.0 {
            1.0
        } else {
            let sine = self.thickness / length;
            (1.0 - sine * sine).at_least(0.0).sqrt().at_least(SMALLEST_COSINE)
        };
        let strain = (path - self.slack - self.optimal * length * cosine) / self.compliant;
        Local { length, active, passive, cosine, strain: [strain, -self.optimal / (cosine * self.compliant)] }
    }

    fn balance(&self, local: &Local, anchor: &mut Anchor, start: f64, reach: f64, value: f64, activation: f64) -> Balance {
        let offset = start + reach * value - local.length;
        let active = activation * self.strength * (local.active[0] + local.active[1] * offset).at_least(0.0);
        let mut force = (local.passive[0] + local.passive[1] * offset).at_least(0.0) + self.damping * value;
        let mut slope = local.passive[1] * reach + self.damping;
        let mut factor = None;
        if active > 0.0 {
            let [share, steepness] = self.curves.over_velocity(value);
            factor = Some(share);
            force += active * share;
            slope += active * steepness + activation * self.strength * local.active[1] * reach * share;
        }
        let [pull, stiffness] = self.tendon.force_near(local.strain[0] + local.strain[1] * offset, anchor);
        let yielding = stiffness * local.strain[1] * reach;
        Balance { excess: force * local.cosine - pull, slope: slope * local.cosine - yielding, pull: [pull, yielding], factor }
    }

    fn fibre(&self, local: &Local, length: f64, value: f64) -> Fibre {
        let offset = length - local.length;
        let [pull, _] = self.tendon.force(local.strain[0] + local.strain[1] * offset);
        let active = (local.active[0] + local.active[1] * offset).at_least(0.0) * self.curves.over_velocity(value)[0];
        Fibre {
            length: length * self.optimal,
            velocity: value * self.optimal * self.fastest,
            force: pull * self.peak,
            gain: active * local.cosine * self.strength * self.peak,
        }
    }
}
