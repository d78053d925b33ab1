//! Computed muscle control as a policy.

use super::{ActsOn, Policy, PolicyContext, PolicyError};
use crate::action::{ControlMemory, Controls};
use crate::cmc::{ControlError, Lead};
use msk_program::action::{ActionSpace, ActionTarget, BaseController, TrackingOffsets};

/// Follows the reference motion of the task, or the script of its demonstration; without one it holds the posture that an episode begins
/// with. It acts on the muscles, whatever the action space of the task.
#[derive(Debug, Clone)]
pub struct ComputedMuscleControl {
    along: BaseController,
    lead: Lead,
    /// Of the present episode.
    controls: Option<Controls>,
    /// For its body.
    memory: ControlMemory,
}

impl Default for ComputedMuscleControl {
    fn default() -> Self {
        Self::along(BaseController::MuscleControl)
    }
}

impl ComputedMuscleControl {
    /// Follows the schedule of poses with which the task's own tests show that it can succeed.
    pub fn demonstration() -> Self {
        Self::along(BaseController::Demonstration)
    }

    /// The same with actions that are a smooth function of the state, which are easier to imitate: each muscle reaches its activation
    /// somewhat later, and relaxes about as fast as it contracts.
    #[must_use]
    pub fn smooth(self) -> Self {
        Self { lead: Lead::Smooth, ..self }
    }

    fn along(along: BaseController) -> Self {
        Self { along, lead: Lead::Exact, controls: None, memory: ControlMemory::default() }
    }

    fn unable(&self, error: &ControlError) -> PolicyError {
        PolicyError::Unable { policy: self.name().to_owned(), reason: error.to_string() }
    }
}

impl Policy for ComputedMuscleControl {
    fn name(&self) -> &str {
        match (&self.along, self.lead) {
            (along, Lead::Exact) => along.name(),
            (BaseController::Demonstration, Lead::Smooth) => "demonstration smooth",
            (_, Lead::Smooth) => "cmc smooth",
        }
    }

    fn acts_on(&self) -> ActsOn {
        ActsOn::Muscles
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        // No target is moved.
        let target = ActionTarget::MuscleControl(TrackingOffsets::default());
        let space = ActionSpace { target, residual: Some(self.along.clone()), ..ActionSpace::default() };
        let controls = self.controls.insert(Controls::new(context, space));
        let ready = controls.reset(context);
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
