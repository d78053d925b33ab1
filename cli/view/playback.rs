//! Episodes of a run as pages: they are played again from what the run keeps.

use super::results::Results;
use crate::error::Error;
use crate::html::{Film, caption};
use crate::policies::{self, Limits};
use crate::project::Project;
use msk::evaluate::{EpisodeRecord, Journal, Trial, play_watched};
use msk::runtime::episode::EpisodeKey;
use msk::runtime::policy::PolicySource;
use msk::view::page;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError, TryLockError};

/// Plays episodes again, one at a time, and keeps the page of the last.
pub struct Playback<'a> {
    /// File of the tasks.
    pub tasks: PathBuf,
    pub limits: &'a Limits,
    pub stop: &'a AtomicBool,
    pub last: Mutex<Option<(String, Vec<u8>)>>,
}

/// Why there is no page.
pub enum NoPage {
    /// Another one is just being made.
    Busy,
    /// There is no such episode.
    Unknown,
    /// In words.
    Failed(String),
}

impl Playback<'_> {
    /// The page of an episode: a place in the journal, or the number of evaluations of a training, whose last agent then plays.
    pub fn page(&self, results: &Results, which: &str) -> Result<Vec<u8>, NoPage> {
        let mut last = match self.last.try_lock() {
            Ok(last) => last,
            Err(TryLockError::Poisoned(last)) => PoisonError::into_inner(last),
            Err(TryLockError::WouldBlock) => return Err(NoPage::Busy),
        };
        if let Some((_, page)) = last.as_ref().filter(|(name, _)| name == which) {
            return Ok(page.clone());
        }
        let place: usize = which.parse().map_err(|_| NoPage::Unknown)?;
        let made = match results {
            Results::Evaluation(path) => self.recorded(path, place),
            Results::Training(path) => self.trained(path, place),
        };
        let page = made.map_err(|error| NoPage::Failed(error.to_string()))?.ok_or(NoPage::Unknown)?;
        *last = Some((which.to_owned(), page.clone()));
        Ok(page)
    }

    fn recorded(&self, path: &Path, place: usize) -> Result<Option<Vec<u8>>, Error> {
        let (mut found, mut number) = (None, 0);
        Journal::each(path, |record| {
            found = found.take().or_else(|| (number == place).then_some(record));
            number += 1;
        })
        .map_err(crate::eval::explain)?;
        let Some(record) = &found else { return Ok(None) };
        let mut trial = self.trial(&record.task, &record.task_hash)?;
        trial.body = trial.body.under(&record.condition)?;
        let settings = Results::settings(path)?;
        let weights = match record.weights.0.is_empty() {
            true => settings.tasks.iter().find(|task| task.owns(record)).map_or(&[][..], |task| &task.weights),
            false => &record.weights.0,
        };
        let policy = policies::recorded(&record.policy)?;
        self.play(&trial, &policy, [record.seed, record.episode], weights, Some(record))
    }

    fn trained(&self, path: &Path, place: usize) -> Result<Option<Vec<u8>>, Error> {
        let training = Results::training(path)?;
        let agent = path.join("last");
        if !agent.is_dir() {
            return Ok(None);
        }
        let trial = self.trial(&training.task, &training.task_hash)?;
        let policy = self.limits.source(&format!("agent {}", agent.display()))?;
        self.play(&trial, &policy, [training.seed, place as u64], &[], None)
    }

    /// The task of that name with that meaning.
    fn trial(&self, name: &str, hash: &str) -> Result<Trial, Error> {
        let trials = Project::open(&self.tasks, &[])?.trials(None)?;
        let file = self.tasks.display();
        let trial = trials.into_iter().find(|trial| trial.task.name == name);
        let trial =
            trial.ok_or_else(|| Error::new(format!("`{file}` has no task `{name}`")).hint("give its file with --tasks"))?;
        match trial.task.hash == hash {
            true => Ok(trial),
            false => {
                Err(Error::new(format!("the task `{name}` of `{file}` is not the one of this run: it has been changed since")))
            }
        }
    }

    /// Plays an episode and makes a page of it; `None` if the server is to stop.
    fn play(
        &self,
        trial: &Trial,
        policy: &PolicySource,
        [seed, episode]: [u64; 2],
        weights: &[(String, f64)],
        record: Option<&EpisodeRecord>,
    ) -> Result<Option<Vec<u8>>, Error> {
        let mut environment = trial.episode()?;
        for (name, weight) in weights {
            if let Some(term) = trial.task.terms.iter().position(|term| term.name == *name) {
                environment.set_weight(term, *weight);
            }
        }
        for (name, value) in record.map_or(&[][..], |record| &record.parameters.0) {
            environment.set_parameter(name, *value)?;
        }
        let mut policy = policy.open(self.stop)?;
        let mut film = Film::of(&environment, trial, true)?;
        let key = EpisodeKey { seed, episode };
        let played =
            play_watched(trial, &mut environment, key, policy.as_mut(), self.stop, &mut |environment| film.look(environment))?;
        let Some(played) = played else { return Ok(None) };
        let mut caption = caption(&played);
        if record.is_some_and(|record| record.total.to_bits() != played.total.to_bits()) {
            caption.label = "played again, and otherwise".into();
        }
        let title = format!("{}, {}", caption.task, caption.policy);
        let recording = film.so_far(caption)?;
        Ok(recording.map(|recording| page(&title, &[recording])).transpose()?.map(String::into_bytes))
    }
}
