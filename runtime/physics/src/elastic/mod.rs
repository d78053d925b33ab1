//! Elastic tendons: every muscle is a fibre in series with a tendon that stretches.
//!
//! The tendon is a spring without mass, so at any moment it pulls as the fibre does:
//! activation · active(l) · velocity(v) + passive(l) + damping · v = tendon(path - l), with pennation of constant thickness
//! where it is given (the damped equilibrium model of Millard et al. 2013). The fibre's length l is a state. A forward pass
//! takes it implicitly over the step that has just passed, from the length kept in the state to the present path, so that
//! the pull is in balance at the present path, whatever the tendon's stiffness: no stretch of a stiff tendon can ring against
//! the bones, and with ever stiffer tendons the fibre does at every step what that of a rigid muscle does.
//!
//! A fibre of length zero in the state is one that has not been laid yet: it begins in balance at the present path.

pub mod curves;
mod fibre;
mod table;
#[cfg(test)]
mod tests;

use super::{actuation::Curve, rotation::MINIMUM, state::State};
use crate::{
    batch::one_lane,
    model::{ElasticTendons, FibreCurves, Model},
    scalar::Real,
};
use curves::Tendon;
use fibre::{Curves, Fibre};
use std::sync::Arc;
use table::Tables;

pub(crate) use fibre::Unit;

/// Fibres of all muscles. One entry per actuator; those of what is no muscle mean nothing.
#[derive(Debug, Clone)]
pub struct Fibres<T: Real> {
    /// Length, m.
    pub length: Vec<T>,
    /// Rate of lengthening, m/s.
    pub velocity: Vec<T>,
    /// Length along the path, m: less than the length where the fibre is pennate.
    pub along_path: Vec<T>,
    units: Arc<[Unit]>,
}

one_lane!(Fibres { length, velocity, along_path; but units });

/// What the forward pass of the muscles knows when the fibres come in.
pub(super) struct Paths<'a, T: Real> {
    pub length: &'a [T],
    pub velocity: &'a [T],
    pub gain: &'a mut [T],
    pub bias: &'a mut [T],
    pub force: &'a mut [T],
}

impl<T: Real> Fibres<T> {
    /// Memory for as many actuators, with these muscles.
    pub(super) fn of(actuators: usize, units: &Arc<[Unit]>) -> Self {
        let zeros = vec![T::splat(0.0); actuators];
        Self { length: zeros.clone(), velocity: zeros.clone(), along_path: zeros, units: Arc::clone(units) }
    }

    /// Takes all fibres over the step that has just passed and sets the muscles' forces from their tendons.
    pub(super) fn update(&mut self, state: &State<T>, paths: Paths<'_, T>) {
        for unit in self.units.iter() {
            let [muscle, activation] = unit.place;
            for lane in 0..T::LANES {
                let at = |values: &[T]| values[muscle].lane(lane);
                let (path, strength) = (at(paths.length), at(&state.strength));
                // A weaker fibre pulls as one that is less active.
                let drive = state.activation[activation].lane(lane).clip(0.0, 1.0) * strength;
                let before = [at(&state.fibre_length), at(&state.fibre_velocity)];
                let Fibre { length, velocity, force, gain } = if before[0] > 0.0 {
                    unit.advance(path, before, drive, state.fibre_step.lane(lane))
                } else {
                    unit.equilibrium(path, at(paths.velocity), drive)
                };
                self.length[muscle].set_lane(lane, length);
                self.velocity[muscle].set_lane(lane, velocity);
                self.along_path[muscle].set_lane(lane, unit.along_path(length));
                // The force is the tendon's; what is not active is passive, damping included.
                paths.gain[muscle].set_lane(lane, -gain * strength);
                paths.bias[muscle].set_lane(lane, gain * drive - force);
                paths.force[muscle].set_lane(lane, -force);
            }
        }
    }
}

/// The muscles with elastic tendons, each given by the indices of its actuator and its activation, and its curves.
pub(super) fn units<'a>(
    model: &Model,
    settings: &ElasticTendons,
    muscles: impl Iterator<Item = ([usize; 2], [&'a Curve; 2])>,
) -> Arc<[Unit]> {
    let tables = Arc::new(Tables::new());
    muscles.map(|(place, curves)| unit(model, settings, place, curves, &tables)).collect()
}

fn unit(
    model: &Model,
    settings: &ElasticTendons,
    place: [usize; 2],
    [active, passive]: [&Curve; 2],
    tables: &Arc<Tables>,
) -> Unit {
    let [muscle, _] = place;
    let (optimal, slack) = active.lengths();
    let name = &model.actuators.name[muscle];
    let pennation = settings.pennation.iter().find(|(named, _)| named == name).map_or(0.0, |(_, angle)| *angle);
    Unit {
        place,
        optimal,
        slack,
        compliant: settings.stretching_length(slack, model.actuators.length_range[muscle]).at_least(MINIMUM),
        peak: passive.peak(),
        strength: active.peak() / passive.peak().at_least(MINIMUM),
        fastest: active.fastest(),
        damping: settings.damping,
        thickness: libm::sin(pennation),
        tendon: Tendon::new(settings.strain),
        curves: match settings.curves {
            FibreCurves::Published => Curves::Published(Arc::clone(tables)),
            FibreCurves::Model => {
                let (own, begin) = passive.lengths();
                let scale = [optimal / own, (slack - begin) / own];
                Curves::Model { active: Box::new(active.clone()), passive: Box::new(passive.clone()), scale }
            }
        },
    }
}
