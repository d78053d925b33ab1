//! Computed muscle control as a policy.

use super::{ActsOn, Pace, Policy, PolicyContext, PolicyError};
use crate::action::{ControlMemory, Controls};
use crate::cmc::{ControlError, Lead};
use msk_program::action::{ActionSpace, ActionTarget, Along, BaseController, TrackingOffsets};

/// Follows the reference motion of the task, or the script of its demonstration, or walks; without any of them it holds the posture that an
/// episode begins with. It acts on the muscles, whatever the action space of the task.
#[derive(Debug, Clone)]
pub struct ComputedMuscleControl {
    name: String,
    along: Along,
    lead: Lead,
    pace: Option<Pace>,
    /// Of the present episode.
    controls: Option<Controls>,
    /// For its body.
    memory: ControlMemory,
}

impl Default for ComputedMuscleControl {
    fn default() -> Self {
        Self::along(BaseController::MuscleControl.name(), Along::Reference)
    }
}

impl ComputedMuscleControl {
    /// Follows the schedule of poses with which the task's own tests show that it can succeed.
    pub fn demonstration() -> Self {
        Self::along(BaseController::Demonstration.name(), Along::Demonstration)
    }

    /// The same with actions that are a smooth function of the state, which are easier to imitate: each muscle reaches its activation
    /// somewhat later, and relaxes about as fast as it contracts.
    #[must_use]
    pub fn smooth(self) -> Self {
        Self { lead: Lead::Smooth, name: self.name + " smooth", ..self }
    }

    /// Walks at a pace, whatever the task.
    pub fn gait(pace: Pace) -> Self {
        let name = pace.name().to_owned();
        let along = Along::Gait { speed: 0.0, pace: Along::MOST_PACE, then: None };
        Self { pace: Some(pace), ..Self::along(&name, along) }
    }

    fn along(name: &str, along: Along) -> Self {
        Self { name: name.to_owned(), along, lead: Lead::Exact, pace: None, controls: None, memory: ControlMemory::default() }
    }

    fn unable(&self, error: &ControlError) -> PolicyError {
        PolicyError::Unable { policy: self.name().to_owned(), reason: error.to_string() }
    }
}

impl Policy for ComputedMuscleControl {
    fn name(&self) -> &str {
        &self.name
    }

    fn acts_on(&self) -> ActsOn {
        ActsOn::Muscles
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        // Nothing but a pace is asked for.
        let target = ActionTarget::MuscleControl(TrackingOffsets { along: self.along, ..TrackingOffsets::default() });
        let space = ActionSpace { target, ..ActionSpace::default() };
        let controls = self.controls.insert(Controls::new(context, space));
        let ready = controls.reset(context);
        if let Some(pace) = &self.pace {
            controls.keep(&pace.entries());
        }
        controls.set_lead(self.lead);
        self.memory = ControlMemory::default();
        ready.map_err(|error| self.unable(&error))
    }

    fn controls(&mut self) -> Option<&mut Controls> {
        self.controls.as_mut()
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let Self { controls, memory, .. } = self;
        let acted = match controls {
            Some(controls) => controls.act(context, &[], memory, action),
            None => Err(ControlError::NotReset),
        };
        acted.map_err(|error| self.unable(&error))
    }
}
