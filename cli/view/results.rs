//! What the folder of a run holds at present, as numbers for the page.

use crate::error::{Context, Error};
use msk::evaluate::{EpisodeRecord, Journal, RunSettings, TaskSettings};
use msk_storage::{Folder, Log};
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

/// What decides a training, as far as a page needs it.
pub struct Training {
    /// Name of the task.
    pub task: String,
    /// Hash of its meaning.
    pub hash: String,
    /// Control steps of the whole training.
    pub steps: u64,
    /// Random seed.
    pub seed: u64,
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
    pub fn training(path: &Path) -> Result<Training, Error> {
        let damaged = || Error::new(format!("`{}` is damaged", path.join("training.toml").display()));
        let table: toml::Table = text(path, "training.toml")?.parse().map_err(|_| damaged())?;
        let word = |name: &str| table.get(name).and_then(toml::Value::as_str).map(str::to_owned).ok_or_else(damaged);
        let number = |name: &str| {
            let value = table.get(name).and_then(toml::Value::as_integer);
            value.and_then(|value| u64::try_from(value).ok()).ok_or_else(damaged)
        };
        Ok(Training { task: word("task")?, hash: word("task_hash")?, steps: number("steps")?, seed: number("seed")? })
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
    let bytes = Folder::open(path)?.read(Path::new("curve.jsonl"), LARGEST)?.unwrap_or_default();
    // A line that is just being written is left out.
    let lines = Log::whole_lines(&bytes).split(|byte| *byte == b'\n');
    let lines: Vec<Value> = lines.filter_map(|line| serde_json::from_slice(line).ok()).collect();
    let (evaluations, rounds): (Vec<&Value>, Vec<&Value>) = lines.iter().partition(|line| line.get("evaluation").is_some());
    let step = rounds.last().and_then(|round| round["step"].as_u64()).unwrap_or(0);
    let over = step >= training.steps && evaluations.last().is_some_and(|last| last["step"].as_u64() == Some(step));
    let ended: Vec<&&Value> = rounds.iter().filter(|round| round.get("return").is_some()).collect();
    let stride = ended.len().div_ceil(MOST).max(1);
    let round = |round: &&&Value| json!({ "step": round["step"], "return": round["return"], "success": round["success"], "length": round["length"] });
    let terms = ended.last().map_or(Value::Null, |round| round["terms"].clone());
    let state = json!({
        "kind": "training", "title": training.task, "over": over, "step": step, "steps": training.steps, "terms": terms,
        "curve": ended.iter().step_by(stride).chain(ended.last()).map(round).collect::<Vec<_>>(),
        "evaluations": evaluations.iter().map(|line| json!({ "step": line["step"], "return": line["evaluation"]["return"], "success": line["evaluation"]["success"] })).collect::<Vec<_>>(),
    });
    Ok((over, state))
}
