//! A policy that learns between the rounds of a session, by the weights of each.

use msk_runtime::policy::PolicySource;
use std::sync::atomic::AtomicBool;

/// Why a learner cannot go on.
pub type LearnerError = Box<dyn std::error::Error + Send + Sync>;

/// What plays the rounds of a session and learns before each of them.
pub trait Learner {
    /// Learns by `weights`, one for each term, to the end of a round, counted from 1, and gives the policy as it is then; `None` if `stop`
    /// became true before. A session that is continued asks anew for a round that may have been learned from already: it gets the same.
    ///
    /// # Errors
    /// It cannot go on.
    fn learn(&mut self, round: u64, weights: &[f64], stop: &AtomicBool) -> Result<Option<PolicySource>, LearnerError>;

    /// Keeps the policy that it is now: it has played the best round so far.
    ///
    /// # Errors
    /// It cannot be written.
    fn keep(&mut self) -> Result<(), LearnerError>;
}

/// What a session that nothing learns in has: the same policy in each round.
pub(super) struct Fixed(pub PolicySource);

impl Learner for Fixed {
    fn learn(&mut self, _: u64, _: &[f64], _: &AtomicBool) -> Result<Option<PolicySource>, LearnerError> {
        Ok(Some(self.0.clone()))
    }

    fn keep(&mut self) -> Result<(), LearnerError> {
        Ok(())
    }
}
