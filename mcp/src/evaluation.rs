//! A few episodes, within a budget, and results that lie in the project.

use crate::confine::Outside;
use crate::project::{Failure, Project};
use msk_evaluate::{Plan, Protocol, Shard, Summary, play};
use msk_physics::scalar::Real;
use msk_runtime::episode::EpisodeKey;
use msk_runtime::policy::{self, PolicySource};
use msk_storage::Kind;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Most episodes of one call.
const EPISODES: u64 = 100;
/// Most control steps of one call.
const STEPS: u64 = 200_000;
/// Most seconds of one call.
const SECONDS: f64 = 600.0;
/// Largest results that are read, bytes.
const LARGEST: u64 = 4 << 20;
/// Largest journal that is read, bytes.
const LARGEST_JOURNAL: u64 = 64 << 20;
/// Most lines of a journal, and most names, in one answer.
const LINES: usize = 200;

/// What `evaluate` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Evaluate {
    /// Name of the task.
    pub task: String,
    /// File with the task, relative to the project; tasks.msk if it is left out.
    pub file: Option<String>,
    /// Weights file to lay over it.
    pub overlay: Option<String>,
    /// What acts: cmc, demonstration, zero or random; cmc if it is left out.
    pub policy: Option<String>,
    /// Episodes, at most 100; 5 if it is left out.
    pub episodes: Option<u64>,
    /// Seed of all chance; 0 if it is left out.
    pub seed: Option<u64>,
    /// Most control steps, at most 200000; 20000 if it is left out.
    pub max_steps: Option<u64>,
    /// Most seconds, at most 600; 60 if it is left out.
    pub max_seconds: Option<f64>,
}

/// What `read_results` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct ReadResults {
    /// A folder of results, relative to the project; without one, the folders below `results` are listed.
    pub folder: Option<String>,
    /// Which file of it: summary.json, run.json, report.md, episodes.jsonl, rounds.jsonl, tune.json, best.toml or weights.toml;
    /// summary.json if it is left out.
    pub file: Option<String>,
    /// Of a file of lines, how many of the last ones; 20 if it is left out.
    pub last: Option<usize>,
}

/// Plays episodes until they are done, the budget is spent, or the request is cancelled. Nothing is written.
pub fn evaluate(project: &Project, asked: &Evaluate, cancelled: &dyn Fn() -> bool) -> Result<Value, Failure> {
    let task = project.task(asked.file.as_deref(), &asked.task, asked.overlay.as_deref())?;
    let trial = project.trial(task)?;
    let seed = asked.seed.unwrap_or(0);
    let episodes = asked.episodes.unwrap_or(5).clamp(1, EPISODES);
    let most = asked.max_steps.unwrap_or(20_000).clamp(1, STEPS);
    let seconds = asked.max_seconds.filter(|seconds| seconds.is_finite()).unwrap_or(60.0).clip(0.1, SECONDS);
    let mut policy = policy::create(asked.policy.as_deref().unwrap_or("cmc"))?;
    let mut episode = trial.episode()?;
    let (start, stop, steps) = (Instant::now(), AtomicBool::new(false), std::sync::atomic::AtomicU64::new(0));
    let limit = Duration::from_secs_f64(seconds);
    let stepped = || {
        let taken = steps.fetch_add(1, Ordering::Relaxed) + 1;
        if taken >= most || start.elapsed() > limit || cancelled() {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let mut records = Vec::new();
    for index in 0..episodes {
        if cancelled() {
            break;
        }
        let key = EpisodeKey { seed, episode: index };
        match play(&trial, &mut episode, key, policy.as_mut(), &stop, stepped)? {
            Some(record) => records.push(record),
            None => break,
        }
        if stop.load(Ordering::Relaxed) {
            break;
        }
    }
    if cancelled() {
        return Err("cancelled".into());
    }
    let plan = Plan {
        policy: PolicySource::built_in(policy.name())?,
        trials: vec![trial],
        protocol: Protocol { episodes, seed },
        shard: Shard::WHOLE,
    };
    let summary = Summary::of(&plan, &records);
    Ok(json!({
        "summary": serde_json::to_value(&summary)?,
        "episodes_asked": episodes,
        "episodes_done": records.len(),
        "steps": steps.load(Ordering::Relaxed),
        "seconds": start.elapsed().as_secs_f64(),
        "budget_spent": (records.len() as u64) < episodes,
    }))
}

/// The files of a run or a session that may be read.
const FILES: [&str; 8] =
    ["summary.json", "run.json", "report.md", "episodes.jsonl", "rounds.jsonl", "tune.json", "best.toml", "weights.toml"];

/// Reads what a run has left.
pub fn read_results(project: &Project, asked: &ReadResults) -> Result<Value, Failure> {
    let Some(folder) = &asked.folder else {
        return list(project);
    };
    let file = asked.file.as_deref().unwrap_or("summary.json");
    if !FILES.contains(&file) {
        return Err(Failure(json!({ "error": format!("`{file}` is not a file of results"), "files": FILES })));
    }
    let path = Path::new(folder).join(file);
    let limit = if file.ends_with(".jsonl") { LARGEST_JOURNAL } else { LARGEST };
    let text_of = |folder: &str, file: &str| project.confined.text(&Path::new(folder).join(file), LARGEST);
    let Some(text) = project.confined.text(&path, limit)? else { return Err(found(project, Path::new(folder), file)) };
    Ok(match file {
        _ if file.ends_with(".jsonl") => {
            // A last line without its end is still being written.
            let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
            let lines: Vec<&str> = whole.lines().collect();
            let last = asked.last.unwrap_or(20).min(LINES);
            let shown = &lines[lines.len().saturating_sub(last)..];
            let values: Vec<Value> = shown.iter().map(|line| serde_json::from_str(line)).collect::<Result<_, _>>()?;
            json!({ "file": file, "lines": lines.len(), "last": values })
        }
        // The sums are of the episodes: the file may be of another run, or edited.
        "summary.json" if text_of(folder, "run.json")?.is_some() => {
            let opened =
                project.confined.folder().subfolder(Path::new(folder)).map_err(|error| Outside::of(Path::new(folder), &error))?;
            json!({ "file": file, "content": serde_json::to_value(Summary::of_folder(&opened)?)? })
        }
        "summary.json" => {
            let note = "not verified: without the run.json of its run the folder holds no episodes that could be summed up";
            json!({ "file": file, "content": serde_json::from_str::<Value>(&text)?, "note": note })
        }
        _ if file.ends_with(".json") => json!({ "file": file, "content": serde_json::from_str::<Value>(&text)? }),
        _ => json!({ "file": file, "text": text }),
    })
}

/// The error of a folder that lacks a file, with what it has: results may lie in its folders, one for each policy or scale.
fn found(project: &Project, folder: &Path, file: &str) -> Failure {
    let entries = match project.confined.folder().entries(&project.confined.spelled(folder)) {
        Err(error) if error.kind() == Some(ErrorKind::NotFound) => {
            return Failure(json!({ "error": format!("there is no folder `{}`", folder.display()) }));
        }
        Err(error) => return Outside::of(folder, &error).into(),
        Ok(entries) => entries,
    };
    let names = |kind: Kind| -> Vec<String> {
        let named = entries.iter().filter(|entry| entry.kind == kind).map(|entry| entry.name.display().to_string());
        named.filter(|name| kind == Kind::Folder || FILES.contains(&name.as_str())).take(LINES).collect()
    };
    let (files, folders) = (names(Kind::File), names(Kind::Folder));
    let has = if files.is_empty() { "no file of results".to_owned() } else { files.join(", ") };
    let error = format!("there is no `{file}` in `{}`: it has {has}", folder.display());
    Failure(json!({ "error": error, "files": files, "folders": folders }))
}

/// The folders of results.
fn list(project: &Project) -> Result<Value, Failure> {
    let results = Path::new("results");
    let entries = match project.confined.folder().entries(results) {
        Err(error) if error.kind() == Some(ErrorKind::NotFound) => Vec::new(),
        entries => entries.map_err(|error| Outside::of(results, &error))?,
    };
    let folders = entries.iter().filter(|entry| entry.kind == Kind::Folder);
    let names: Vec<String> = folders.map(|entry| format!("results/{}", entry.name.display())).collect();
    Ok(json!({ "results": names }))
}
