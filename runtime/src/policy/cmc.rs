//! Computed muscle control as a policy.

use super::{ActsOn, Policy, PolicyContext, PolicyError};
use crate::cmc::{Along, Offsets, Tracker};

/// Follows the reference motion of the task, or the script of its demonstration; without one it holds the posture that an episode begins
/// with. It acts on the muscles, whatever the action space of the task.
#[derive(Debug, Clone, Default)]
pub struct ComputedMuscleControl {
    tracker: Tracker,
}

impl ComputedMuscleControl {
    /// Follows the schedule of poses with which the task's own tests show that it can succeed.
    pub fn demonstration() -> Self {
        Self { tracker: Tracker::new(Along::Demonstration) }
    }

    fn unable(&self, reason: &impl ToString) -> PolicyError {
        PolicyError::Unable { policy: self.name().to_owned(), reason: reason.to_string() }
    }
}

impl Policy for ComputedMuscleControl {
    fn name(&self) -> &str {
        match self.tracker.along() {
            Along::Reference => "cmc",
            Along::Demonstration => "demonstration",
        }
    }

    fn acts_on(&self) -> ActsOn {
        ActsOn::Muscles
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        self.tracker.reset(&context.moment()).map_err(|error| self.unable(&error))
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        self.tracker.act(&context.moment(), &Offsets::default(), action).map_err(|error| self.unable(&error))
    }
}
