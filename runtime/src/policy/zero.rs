//! Rest: every muscle is asked for as little as the excitation map allows, and every target or torque stays at zero.

use super::{Policy, PolicyContext, PolicyError};

/// Zero *excitation*, which is an action of -1 in every entry; in an action space of offsets or torques it is 0.
///
/// An action of 0 is something else: half excitation of every muscle under the `linear` map, 0.076 under `sigmoid`. What
/// "doing nothing" means to a muscle is rest, so this is what the name stands for: the body collapses as if asleep.
#[derive(Debug, Clone, Copy, Default)]
pub struct Zero;

impl Policy for Zero {
    fn name(&self) -> &str {
        "zero"
    }

    fn reset(&mut self, _context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        action.fill(context.task.action.rest());
        Ok(())
    }
}
