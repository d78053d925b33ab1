//! The weights that reward episodes: those of the end of a training, and what schedules make of them before it.

use super::EpisodeError;
use msk_program::task::CompiledTask;

/// One weight per term.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    /// Share of the training that has passed, 0 to 1.
    progress: f64,
    /// At the end of the training.
    last: Vec<f64>,
    in_force: Vec<f64>,
}

impl Weights {
    /// Those of the end of a training, by which `run`, `eval` and `test` judge.
    pub fn of(task: &CompiledTask) -> Self {
        Self { progress: 1.0, last: task.weights(), in_force: task.weights() }
    }

    pub fn in_force(&self) -> &[f64] {
        &self.in_force
    }

    pub fn last(&self) -> &[f64] {
        &self.last
    }

    pub fn progress(&self) -> f64 {
        self.progress
    }

    /// Sets the last weight of a term; one that does not exist is left out.
    pub fn set(&mut self, task: &CompiledTask, term: usize, weight: f64) {
        if let Some(last) = self.last.get_mut(term) {
            *last = weight;
            self.in_force = task.scheduled_weights(self.progress, &self.last);
        }
    }

    /// Goes to another share of the training.
    ///
    /// # Errors
    /// What is no number from 0 to 1.
    pub fn set_progress(&mut self, task: &CompiledTask, progress: f64) -> Result<(), EpisodeError> {
        if !(0.0..=1.0).contains(&progress) {
            return Err(EpisodeError::Progress { found: progress });
        }
        self.progress = progress;
        self.in_force = task.scheduled_weights(progress, &self.last);
        Ok(())
    }
}
