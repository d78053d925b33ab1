//! A policy whose actions are kept.

use msk_runtime::policy::{ActsOn, Policy, PolicyContext, PolicyError};

/// A policy whose actions are kept, those of the present episode.
pub struct ActionRecorder<'p> {
    policy: Box<dyn Policy + 'p>,
    actions: Vec<f64>,
    width: usize,
}

impl<'p> ActionRecorder<'p> {
    /// Keeps what `policy` does.
    pub fn new(policy: Box<dyn Policy + 'p>) -> Self {
        Self { policy, actions: Vec::new(), width: 0 }
    }

    /// What acts, to play without keeping anything.
    pub fn inner_mut(&mut self) -> &mut (dyn Policy + 'p) {
        self.policy.as_mut()
    }

    /// The actions since the reset, one after the other, and the number of entries of each.
    pub fn actions(&self) -> (&[f64], usize) {
        (&self.actions, self.width)
    }
}

impl Policy for ActionRecorder<'_> {
    fn name(&self) -> &str {
        self.policy.name()
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        self.actions.clear();
        self.policy.reset(context)?;
        self.width = self.policy.acts_on().size(context.task, context.body);
        Ok(())
    }

    fn acts_on(&self) -> ActsOn {
        self.policy.acts_on()
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        self.policy.act(context, action)?;
        self.actions.extend_from_slice(action);
        Ok(())
    }
}
