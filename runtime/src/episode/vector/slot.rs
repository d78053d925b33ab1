//! A place for one episode after the other.

use super::super::{Engine, Episode, EpisodeKey, GroupScratch, Weights};
use super::EpisodeEnd;
use msk_physics::Rates;

/// A place for one episode after the other.
#[derive(Clone)]
pub(super) struct Slot {
    /// Which of the engines plays it.
    pub engine: usize,
    pub episode: Episode,
    /// Of the forward pass of the episode's state, if that is known.
    pub rates: Option<Rates>,
    pub weights: Weights,
    /// Those of the next episodes, one per parameter; none if they are those of the task.
    pub parameters: Vec<f64>,
    /// The key of the next episode.
    pub next: EpisodeKey,
    /// Of the last step.
    pub outcome: Outcome,
}

/// What a step did in a slot.
#[derive(Default, Clone)]
pub(super) struct Outcome {
    pub reward: f64,
    /// The episode that ended, with its last observation, and what only a critic saw of it.
    pub end: Option<(EpisodeEnd, [Vec<f64>; 2])>,
}

impl Slot {
    /// For episodes of one of the engines.
    pub fn of(place: usize, engine: &Engine) -> Self {
        Self {
            engine: place,
            episode: engine.episode(),
            rates: None,
            weights: Weights::of(engine.task()),
            parameters: Vec::new(),
            next: EpisodeKey::default(),
            outcome: Outcome::default(),
        }
    }

    /// Begins the next episode in a lane; the index of the one after it is `stride` greater.
    pub fn begin(&mut self, stride: u64, engines: &[Engine], scratch: &mut GroupScratch, lane: usize) {
        self.rates = scratch.begin(lane, &engines[self.engine], (self.next, &self.parameters), &mut self.episode);
        self.next.episode = self.next.episode.wrapping_add(stride);
    }
}
