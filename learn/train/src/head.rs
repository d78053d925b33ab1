//! What the outputs of an actor of soft actor-critic mean: a distribution of actions.

use crate::agent::{Actor, Output};
use crate::dynsyn::Synergies;
use crate::learner::draw_squashed;
use crate::play::Play;
use crate::settings::DynsynSettings;
use msk_network::{Mlp, Parameters, Tape, Variable};

/// How an actor acts.
#[derive(Debug, Clone)]
pub(crate) enum Head {
    /// Each entry by itself: a squashed Gaussian, of whose means come first and then the logarithms of their deviations.
    Entries(usize),
    /// Groups of entries together.
    Synergies { synergies: Synergies, settings: DynsynSettings },
}

impl Head {
    /// Outputs of the actor.
    pub fn outputs(&self) -> usize {
        match self {
            Self::Entries(entries) => 2 * entries,
            Self::Synergies { synergies, .. } => synergies.outputs() + synergies.count(),
        }
    }

    /// Numbers that have a density.
    pub fn degrees(&self) -> usize {
        match self {
            Self::Entries(entries) => *entries,
            Self::Synergies { synergies, .. } => synergies.count(),
        }
    }

    /// Standard normal numbers that a draw takes: one for each output that is not itself a deviation.
    pub fn draws(&self) -> usize {
        self.outputs() - self.degrees()
    }

    /// Becomes that of a share of a training.
    pub fn set_progress(&mut self, progress: f64) {
        if let Self::Synergies { synergies, settings } = self {
            *synergies = synergies.clone().at(settings, progress);
        }
    }

    /// An action for each row of outputs, drawn by standard normal numbers, and the logarithm of its density.
    pub fn sample(&self, tape: &mut Tape, output: Variable, noise: &mut dyn Iterator<Item = f32>) -> [Variable; 2] {
        match self {
            Self::Entries(entries) => {
                let (mean, log_std) = (tape.columns(output, 0..*entries), tape.columns(output, *entries..2 * entries));
                draw_squashed(tape, mean, log_std, noise)
            }
            Self::Synergies { synergies, .. } => synergies.sample(tape, output, noise),
        }
    }

    /// What acts without chance.
    pub fn actor(&self, network: &Mlp, parameters: &Parameters, play: &Play) -> Actor {
        let output = match self {
            Self::Entries(_) => Output::Squashed,
            Self::Synergies { synergies, .. } => Output::Synergies(synergies.clone()),
        };
        Actor::new(network, parameters, play, output)
    }
}
