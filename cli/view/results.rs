//! What the folder of a run holds at present, as numbers for the page.

use crate::error::{Context, Error};
use msk::evaluate::{EpisodeRecord, Journal, Moments, RunSettings, TaskSettings};
use msk::train::curve::{Curve, Ended};
use msk::train::session::Session;
use msk::train::{Evaluation, Identity};
use msk_storage::Folder;
use serde_json::{Value, json};
use std::collections::VecDeque;
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
    let mut tasks: Vec<TaskMeans> = settings.tasks.iter().map(TaskMeans::of).collect();
    // The last ones, with their places in the journal.
    let (mut shown, mut count) = (VecDeque::new(), 0_usize);
    let visited = Journal::each(path, |record| {
        let own = settings.place(&record).and_then(|place| tasks.get_mut(place));
        own.into_iter().for_each(|task| task.add(&record));
        if shown.len() == MOST {
            shown.pop_front();
        }
        shown.push_back(row(count, &record));
        count += 1;
    });
    visited.map_err(crate::eval::explain)?;
    let over = count as u64 >= settings.protocol.episodes.saturating_mul(settings.tasks.len() as u64) || summed_up(path);
    let tasks: Vec<Value> =
        settings.tasks.iter().zip(&tasks).map(|(task, means)| means.json(task, settings.protocol.episodes)).collect();
    let state = json!({
        "kind": "evaluation", "title": settings.policy, "over": over, "tasks": tasks, "episodes": shown,
    });
    Ok((over, state))
}

/// An episode in the list of the page.
fn row(place: usize, record: &EpisodeRecord) -> Value {
    json!({
        "place": place, "task": record.task, "episode": record.episode, "return": record.total, "success": record.success,
        "steps": record.steps, "ended": record.ended_by(),
    })
}

/// Means over the episodes of a task.
struct TaskMeans {
    success: Moments,
    total: Moments,
    steps: Moments,
    /// Reward per step of each term.
    terms: Vec<Moments>,
}

impl TaskMeans {
    fn of(task: &TaskSettings) -> Self {
        let zero = Moments::default();
        Self { success: zero, total: zero, steps: zero, terms: vec![zero; task.weights.len()] }
    }

    fn add(&mut self, record: &EpisodeRecord) {
        self.success.add(f64::from(u8::from(record.success)));
        self.total.add(record.total);
        self.steps.add(f64::from(record.steps));
        for (index, moments) in self.terms.iter_mut().enumerate() {
            let sum = record.terms.0.get(index).map_or(0.0, |(_, sum)| *sum);
            moments.add(sum / f64::from(record.steps.max(1)));
        }
    }

    fn json(&self, task: &TaskSettings, episodes: u64) -> Value {
        // Without an episode there is no mean.
        let mean = |moments: &Moments| moments.spread().map(|spread| spread.mean);
        let terms = task.weights.iter().zip(&self.terms);
        let terms: Vec<Value> = terms.map(|((name, _), moments)| json!({ "name": name, "value": mean(moments) })).collect();
        json!({
            "name": task.name, "condition": task.condition.to_string(), "episodes": self.total.count(), "of": episodes,
            "success": mean(&self.success), "return": mean(&self.total), "steps": mean(&self.steps), "horizon": task.horizon,
            "terms": terms,
        })
    }
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
