//! An environment under a policy, from the reset of the policy on.

use msk_runtime::action::ActionBuffer;
use msk_runtime::episode::{Environment, EpisodeError, EpisodeKey};
use msk_runtime::policy::{Policy, PolicyError};

/// The episode of an environment, with the policy that acts in it.
pub(crate) struct Rollout<'a> {
    /// The episode.
    pub episode: &'a mut Environment,
    policy: &'a mut dyn Policy,
    action: ActionBuffer,
}

impl<'a> Rollout<'a> {
    /// Resets the environment to the episode `key`, then the policy.
    ///
    /// # Errors
    /// The policy cannot act.
    pub fn reset(episode: &'a mut Environment, key: EpisodeKey, policy: &'a mut dyn Policy) -> Result<Self, PolicyError> {
        episode.reset(key);
        Self::resume(episode, policy)
    }

    /// Resets the policy to the present state of the episode.
    ///
    /// # Errors
    /// The policy cannot act.
    pub fn resume(episode: &'a mut Environment, policy: &'a mut dyn Policy) -> Result<Self, PolicyError> {
        // An episode that met a fault at its reset has nothing that a policy could observe.
        if episode.ending().is_none() {
            policy.reset(&episode.context())?;
        }
        let action = episode.engine().action(policy.acts_on());
        Ok(Self { episode, policy, action })
    }

    /// Takes one control step.
    ///
    /// # Errors
    /// The policy cannot act, or the episode has ended.
    pub fn step<E: From<PolicyError> + From<EpisodeError>>(&mut self) -> Result<(), E> {
        self.policy.act(&self.episode.context(), &mut self.action.entries)?;
        self.episode.step(&self.action)?;
        Ok(())
    }
}
