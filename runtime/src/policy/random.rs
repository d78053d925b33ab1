//! Chance: the baseline that every learned policy must beat.

use super::{Policy, PolicyContext, PolicyError};
use crate::episode::Stream;

/// Every action uniform on [-1, 1), drawn anew at every step.
///
/// The draw is a function of (seed, episode, step, entry) alone, so a restored episode meets the same actions again.
#[derive(Debug, Clone, Copy, Default)]
pub struct Random;

impl Policy for Random {
    fn name(&self) -> &str {
        "random"
    }

    fn reset(&mut self, _context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let mut stream = Stream::new(context.key, "policy/random");
        stream.skip(u128::from(context.step) * action.len() as u128);
        action.fill_with(|| 2.0 * stream.uniform() - 1.0);
        Ok(())
    }
}
