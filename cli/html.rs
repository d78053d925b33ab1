//! `--html`: episodes as pages for a browser.

use crate::error::Error;
use crate::output;
use crate::run::ending;
use msk::evaluate::{EpisodeRecord, Trial, ensure_room};
use msk::runtime::episode::Environment;
use msk::view::{Caption, Recorder, Recording, page};
use std::path::Path;

/// An episode that is recorded, or one that is not.
pub struct Film {
    recorder: Option<Recorder>,
}

impl Film {
    /// For the next episode of an environment, if it is `wanted`.
    ///
    /// # Errors
    /// A condition of the muscles that the body cannot have, or an episode that does not fit into memory.
    pub fn of(episode: &Environment, trial: &Trial, wanted: bool) -> Result<Self, Error> {
        if !wanted {
            return Ok(Self { recorder: None });
        }
        let strengths = trial.body.condition.strengths(&trial.body.body)?;
        let recorder = Recorder::new(episode, &strengths);
        ensure_room(&trial.task, trial.task.horizon, recorder.bytes_per_step())?;
        Ok(Self { recorder: Some(recorder) })
    }

    /// Keeps what the environment shows.
    pub fn look(&mut self, episode: &Environment) {
        if let Some(recorder) = &mut self.recorder {
            recorder.look(episode);
        }
    }

    /// What has been recorded so far; `None` if nothing was to be.
    ///
    /// # Errors
    /// There is nothing to show.
    pub fn so_far(&self, caption: Caption) -> Result<Option<Recording>, Error> {
        Ok(self.recorder.as_ref().map(|recorder| recorder.recording(caption)).transpose()?)
    }

    /// Writes what was recorded to `path`.
    ///
    /// # Errors
    /// There is nothing to show, or the file cannot be written.
    pub fn write(&self, path: Option<&Path>, caption: Caption) -> Result<(), Error> {
        let Some(path) = path else { return Ok(()) };
        let title = format!("{}, {}", caption.task, caption.policy);
        self.so_far(caption)?.map_or(Ok(()), |recording| write(path, &title, &[recording]))
    }
}

/// Writes a page.
///
/// # Errors
/// A file that cannot be written.
pub fn write(path: &Path, title: &str, recordings: &[Recording]) -> Result<(), Error> {
    output::write(path, page(title, recordings)?)
}

/// What stands above the recording of an episode.
pub fn caption(record: &EpisodeRecord) -> Caption {
    Caption {
        label: String::new(),
        task: record.task.clone(),
        policy: record.policy.clone(),
        episode: Some([record.seed, record.episode]),
        outcome: ending(record),
        success: Some(record.success),
        total: Some(record.total),
        condition: if record.condition.is_none() { String::new() } else { record.condition.to_string() },
    }
}

/// The condition of a trial's muscles in words; empty if there is nothing to declare.
pub fn condition(trial: &Trial) -> String {
    let condition = &trial.body.condition;
    if condition.is_none() { String::new() } else { condition.to_string() }
}
