//! What the folder of a run holds at present, as numbers for the page.

use crate::error::{Context, Error};
use msk::evaluate::{EpisodeRecord, Journal, RunSettings, TaskSettings};
use msk::train::curve::{Curve, Ended};
use msk::train::session::Session;
use msk::train::{Evaluation, Identity};
use msk_storage::Folder;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// Points of a curve and rows of a list at most: what a page can show.
const MOST: usize = 600;
/// Largest files that are read, bytes.
const LARGEST: u64 = 1 << 30;

/// Which kind of run a folder holds.
pub enum Results {
    /// Of `msk eval` or `msk collect`.
    Evaluation(PathBuf),
    /// Of `msk train`.
    Training(PathBuf),
}

impl Results {
    /// Of a folder.
    ///
    /// # Errors
    /// A folder that holds no run.
    pub fn find(path: &Path) -> Result<Self, Error> {
        let has = |name: &str| path.join(name).is_file();
        if has("run.json") {
            return Ok(Self::Evaluation(path.into()));
        }
        if has("training.toml") {
            return Ok(Self::Training(path.into()));
        }
        fs::read_dir(path).context(|| format!("cannot read the folder `{}`", path.display()))?;
        let error = Error::new(format!("`{}` holds no run: it has neither run.json nor training.toml", path.display()));
        Err(error.hint("give the folder that `msk eval`, `msk collect` or `msk train` writes, or one of its subfolders"))
    }

    /// The settings of an evaluation.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn settings(path: &Path) -> Result<RunSettings, Error> {
        let text = text(path, "run.json")?;
        serde_json::from_str(&text).context(|| format!("`{}` is damaged", path.join("run.json").display()))
    }

    /// The settings of a training.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn training(path: &Path) -> Result<Identity, Error> {
        let gone = || Error::new(format!("`{}` is gone", path.join("training.toml").display()));
        Session::identity_in(path)?.ok_or_else(gone)
    }

    /// Whether all of the run is there, and what the page shows of it.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn state(&self) -> Result<(bool, Value), Error> {
        match self {
            Self::Evaluation(path) => evaluation(path),
            Self::Training(path) => curve(path),
        }
    }
}

fn text(path: &Path, name: &str) -> Result<String, Error> {
    let file = path.join(name);
    let found = Folder::open(path).and_then(|folder| folder.read_text(Path::new(name), LARGEST));
    found?.ok_or_else(|| Error::new(format!("`{}` is gone", file.display())))
}

fn evaluation(path: &Path) -> Result<(bool, Value), Error> {
    let settings = Results::settings(path)?;
    let records = Journal::records(path).map_err(crate::eval::explain)?;
    let over = records.len() as u64 >= settings.protocol.episodes * settings.tasks.len() as u64 || summed_up(path);
    let task = |task: &TaskSettings| {
        let own: Vec<&EpisodeRecord> = records.iter().filter(|record| task.owns(record)).collect();
        let count = own.len() as f64;
        let mean = |value: &dyn Fn(&EpisodeRecord) -> f64| own.iter().map(|record| value(record)).sum::<f64>() / count;
        let term = |(index, (name, _)): (usize, &(String, f64))| {
            let share = mean(&|record| record.terms.0.get(index).map_or(0.0, |(_, sum)| *sum) / f64::from(record.steps.max(1)));
            json!({ "name": name, "value": share })
        };
        json!({
            "name": task.name, "condition": task.condition.to_string(), "episodes": own.len(), "of": settings.protocol.episodes,
            "success": mean(&|record| f64::from(u8::from(record.success))), "return": mean(&|record| record.total),
            "steps": mean(&|record| f64::from(record.steps)), "horizon": task.horizon,
            "terms": task.weights.iter().enumerate().map(term).collect::<Vec<_>>(),
        })
    };
    let tasks: Vec<Value> = settings.tasks.iter().map(task).collect();
    let shown = records.len().saturating_sub(MOST);
    let episode = |(place, record): (usize, &EpisodeRecord)| {
        json!({
            "place": place, "task": record.task, "episode": record.episode, "return": record.total, "success": record.success,
            "steps": record.steps, "ended": record.ended_by(),
        })
    };
    let state = json!({
        "kind": "evaluation", "title": settings.policy, "over": over, "tasks": tasks,
        "episodes": records.iter().enumerate().skip(shown).map(episode).collect::<Vec<_>>(),
    });
    Ok((over, state))
}

/// Whether a run has been summed up since its last episode: it was interrupted, or some of its tasks were skipped.
fn summed_up(path: &Path) -> bool {
    let written = |name: &str| fs::metadata(path.join(name)).and_then(|file| file.modified()).ok();
    written("summary.json").zip(written("episodes.jsonl")).is_some_and(|(summary, episodes)| summary >= episodes)
}

fn curve(path: &Path) -> Result<(bool, Value), Error> {
    let training = Results::training(path)?;
    let curve = Curve::in_folder(path)?.unwrap_or_default();
    let step = curve.rounds().next_back().map_or(0, |round| round.step);
    let over = step >= training.steps && curve.evaluations().next_back().is_some_and(|(last, _)| last == step);
    let ended: Vec<(u64, &Ended)> = curve.ended().collect();
    let stride = ended.len().div_ceil(MOST).max(1);
    let round = |(step, ended): &(u64, &Ended)| json!({ "step": step, "return": ended.total, "success": ended.success, "length": ended.length });
    let evaluation = |(step, found): (u64, &Evaluation)| json!({ "step": step, "return": found.total, "success": found.success });
    let state = json!({
        "kind": "training", "title": training.task, "over": over, "step": step, "steps": training.steps,
        "terms": ended.last().map(|(_, last)| &last.terms),
        "curve": ended.iter().step_by(stride).chain(ended.last()).map(round).collect::<Vec<_>>(),
        "evaluations": curve.evaluations().map(evaluation).collect::<Vec<_>>(),
    });
    Ok((over, state))
}
