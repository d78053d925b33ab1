//! The network to whose actions those of a policy are added: one worker's evaluation of it.

use crate::cmc::{ControlError, Moment};
#[cfg(feature = "system")]
use msk_physics::scalar::Real;
use msk_program::action::BaseNetwork;
use msk_program::task::Channel;
use std::sync::Arc;

#[cfg(feature = "system")]
use crate::policy::{Evaluation, NetworkContent};

/// A network that has been opened.
#[derive(Debug, Clone)]
pub(super) struct Base {
    network: Arc<BaseNetwork>,
    /// What its task observes: one worker may serve several tasks that share a network.
    channels: Vec<Channel>,
    #[cfg(feature = "system")]
    evaluation: Evaluation,
}

impl Base {
    /// Opens a network for the task of a moment.
    ///
    /// # Errors
    /// A file that holds no network, or one that sees or moves something else.
    #[cfg(feature = "system")]
    pub fn new(network: &Arc<BaseNetwork>, moment: &Moment<'_>) -> Result<Self, ControlError> {
        let unable = |reason: String| ControlError::Network { path: network.path.clone(), reason };
        let content = NetworkContent::read(&network.path, &network.bytes).map_err(unable)?;
        let evaluation = Evaluation::of_channels(&content, &moment.task.channels).map_err(unable)?;
        evaluation.must_fit(moment.observation.len(), moment.present.body.muscles.len(), "muscle").map_err(unable)?;
        Ok(Self { network: network.clone(), channels: moment.task.channels.clone(), evaluation })
    }

    /// Where no file can be read, no network is evaluated.
    #[cfg(not(feature = "system"))]
    pub fn new(network: &Arc<BaseNetwork>, _moment: &Moment<'_>) -> Result<Self, ControlError> {
        Err(ControlError::Network { path: network.path.clone(), reason: "cannot be evaluated here".to_owned() })
    }

    /// Whether it is that network, for the task of a moment.
    pub fn is_of(&self, network: &Arc<BaseNetwork>, moment: &Moment<'_>) -> bool {
        Arc::ptr_eq(&self.network, network) && self.channels == moment.task.channels
    }

    /// Writes its action for each muscle, clipped.
    ///
    /// # Errors
    /// An evaluation that fails, or gives something else than a number for each muscle.
    #[cfg(feature = "system")]
    pub fn act(&mut self, moment: &Moment<'_>, muscles: &mut [f64]) -> Result<(), ControlError> {
        let acted = self.evaluation.act(moment.observation, muscles);
        let unable = |reason: String| ControlError::Network { path: self.network.path.clone(), reason };
        acted.map_err(unable)?;
        match muscles.iter().find(|entry| !entry.is_finite()) {
            Some(entry) => Err(unable(format!("gives {entry} at step {}", moment.progress.step + 1))),
            None => {
                muscles.iter_mut().for_each(|entry| *entry = entry.clip(-1.0, 1.0));
                Ok(())
            }
        }
    }

    /// Where no file can be read, no network is evaluated.
    #[cfg(not(feature = "system"))]
    pub fn act(&mut self, _moment: &Moment<'_>, _muscles: &mut [f64]) -> Result<(), ControlError> {
        Err(ControlError::NotReset)
    }
}
