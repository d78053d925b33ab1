//! What a task changes on a body: `body human with core.peak_force *= 3`.

use super::Body;
use msk_physics::model::{Bias, Gain, JointKind, Model};
use msk_program::body::{Change, Property};

/// Why a body cannot be changed as a task wants it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChangeError {
    /// There is no such muscle or joint.
    #[error("the body `{body}` has no muscle or joint `{part}` with this parameter")]
    Part {
        /// The body.
        body: String,
        /// What is missing.
        part: String,
    },
    /// A factor on a parameter that is zero.
    #[error("`{part}` is zero, so multiplying has no effect; assign a value instead")]
    Nothing {
        /// The muscle or joint.
        part: String,
    },
}

impl Body {
    /// Changes parameters of the body and of its model.
    ///
    /// # Errors
    /// A part that does not exist, or a factor that changes nothing.
    pub fn change(&mut self, model: &mut Model, changes: &[Change]) -> Result<(), ChangeError> {
        for change in changes {
            self.apply(model, change)?;
        }
        Ok(())
    }

    fn apply(&mut self, model: &mut Model, change: &Change) -> Result<(), ChangeError> {
        let part = || change.part.clone();
        let missing = || ChangeError::Part { body: self.name.clone(), part: part() };
        if change.property == Property::PeakForce {
            let muscle = self.muscles.iter().position(|muscle| muscle.name == change.part).ok_or_else(missing)?;
            let known = &mut self.muscles[muscle].peak_force;
            let force = if change.scales { *known * change.value } else { change.value };
            if change.scales && *known == 0.0 {
                return Err(ChangeError::Nothing { part: part() });
            }
            *known = force;
            // The curves of the active and of the passive force are given in parts of the same peak.
            if let Gain::Muscle(active) = &mut model.actuators.gain[muscle] {
                active[2] = force;
            }
            if let Bias::Muscle(passive) = &mut model.actuators.bias[muscle] {
                passive[2] = force;
            }
            return Ok(());
        }
        let joint = self.joints.iter().find(|joint| joint.name == change.part).ok_or_else(missing)?;
        let single = matches!(joint.kind, JointKind::Hinge | JointKind::Slide);
        let slot = match change.property {
            Property::Damping if single => &mut model.dofs.damping[joint.dof],
            Property::Stiffness if single => &mut model.joints.stiffness[joint.index],
            _ => return Err(missing()),
        };
        if change.scales && *slot == 0.0 {
            return Err(ChangeError::Nothing { part: part() });
        }
        *slot = if change.scales { *slot * change.value } else { change.value };
        Ok(())
    }
}
