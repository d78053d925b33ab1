//! What a report is made of: folders of results and trainings.

use crate::error::{Context, Error};
use msk::evaluate::Summary;
use msk::evaluate::session::{Comparison, Errors, SessionFolder, Tracking};
use msk::evaluate::sweep::Sweep;
use msk::train::curve::Curve;
use msk_storage::{Folder, StorageError, read_text_file};
use std::fs;
use std::path::{Path, PathBuf};

/// Largest file that is read, bytes.
const LARGEST: u64 = 256 << 20;
/// Film strips of a folder that are shown.
const STRIPS: usize = 66;
/// Episodes of traces in a report.
const TRACES: usize = 6;

/// A folder of results, or of a training.
#[derive(Default)]
pub struct Source {
    /// What it is called in tables.
    pub label: String,
    /// Of an evaluation, or of the unperturbed episodes of a sweep.
    pub summary: Option<Summary>,
    /// Of a sweep.
    pub sweep: Option<Sweep>,
    /// Of a training: steps, mean return and success of its evaluations, or of its rounds if it has none.
    pub curve: Vec<[f64; 3]>,
    /// Of a session of direct control.
    pub session: Option<Played>,
    /// Traces, the first of every task.
    pub traces: Vec<PathBuf>,
    /// Film strips of episodes.
    pub strips: Vec<PathBuf>,
}

/// A session of direct control.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// Name of the task.
    pub task: String,
    /// Decisions taken.
    pub decisions: usize,
    /// Simulated time, s.
    pub duration: f64,
    /// Why it stopped.
    pub outcome: String,
    /// How closely it followed the reference motion of the task, if that has one.
    pub tracking: Option<Tracking>,
    /// The comparison with a policy, as `msk session tracking` has kept it.
    pub comparison: Option<Comparison>,
}

/// Reads a folder.
///
/// # Errors
/// A file that cannot be read, or nothing that a report is made of.
pub fn read(folder: &Path) -> Result<Source, Error> {
    if folder.join("session.json").is_file() {
        return session(folder);
    }
    let text = |name: &str| text(&folder.join(name));
    let damaged = |error: serde_json::Error| {
        let error = Error::new(format!("the results in `{}` are damaged: {error}", folder.display()));
        error.hint("evaluate again: they may be of another version of the program")
    };
    let sweep: Option<Sweep> = text("sweep.json")?.map(|text| serde_json::from_str(&text)).transpose().map_err(damaged)?;
    // What is reported is summed up from the journals: the sums beside them may be of another run, or edited.
    let sweep = sweep.map(|kept| self::sweep(folder, &kept)).transpose()?.flatten();
    let summary = summary(folder)?.map_or_else(|| summary(&folder.join("unperturbed")), |found| Ok(Some(found)))?;
    let curve = text(msk::train::curve::FILE)?.map(|lines| Curve::of(lines.as_bytes())).transpose();
    let curve = curve.context(|| format!("cannot read `{}`", folder.display()))?.as_ref().map(points).unwrap_or_default();
    let name = name(folder);
    let policy = summary.as_ref().map(|summary| summary.policy.clone());
    let label = policy.map_or_else(|| name.clone(), |policy| format!("{policy} ({name})"));
    let source = Source { label, summary, sweep, curve, session: None, traces: traces(folder), strips: strips(folder) };
    if source.summary.is_none() && source.sweep.is_none() && source.curve.is_empty() {
        let files = "no summary.json, sweep.json, curve.jsonl or session.json";
        let error = Error::new(format!("`{}` has no results: {files}", folder.display()));
        return Err(error.hint("name a folder that `msk eval`, `msk train` or `msk session` has written"));
    }
    Ok(source)
}

/// The sums over the episodes of a folder; `None` if it is none or has none.
fn summary(folder: &Path) -> Result<Option<Summary>, Error> {
    match Folder::open(folder) {
        Err(error) if missing(&error) => Ok(None),
        opened => Summary::of_folder(&opened?).map_err(crate::eval::explain),
    }
}

/// A sweep along the axes of `kept`, summed up from the episodes at each scale.
fn sweep(folder: &Path, kept: &Sweep) -> Result<Option<Sweep>, Error> {
    let mut points = Vec::new();
    for (axis, scales) in &kept.axes {
        let point = |scale: &f64| -> Result<(f64, Summary), Error> {
            let folder = if *scale == 0.0 { folder.join("unperturbed") } else { folder.join(format!("{}-{scale}", axis.name())) };
            let gone = || Error::new(format!("the sweep has no results in `{}`", folder.display()));
            let found = summary(&folder)?.ok_or_else(|| gone().hint("the same `msk eval --sweep` with `--out` completes it"))?;
            Ok((*scale, found))
        };
        points.push((*axis, scales.iter().map(point).collect::<Result<Vec<_>, _>>()?));
    }
    Ok(Sweep::of(&points))
}

fn name(folder: &Path) -> String {
    folder.file_name().map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Reads a folder of a session.
fn session(folder: &Path) -> Result<Source, Error> {
    let cannot = || format!("cannot read the session in `{}`", folder.display());
    let (kept, session) = SessionFolder::open(Folder::open(folder).context(cannot)?).context(cannot)?;
    let trace = kept.trace().context(cannot)?;
    let outcome = match &session.stopped {
        Some(_) if session.success => "success".to_owned(),
        Some(reason) => reason.clone(),
        None => "waits".to_owned(),
    };
    let played = Played {
        task: trace.origin.task.clone(),
        decisions: session.decisions.len(),
        duration: trace.times().last().copied().unwrap_or(0.0),
        outcome,
        tracking: Errors::of(&trace).and_then(|errors| errors.summary()),
        comparison: kept.comparison(&session).context(cannot)?,
    };
    Ok(Source { label: name(folder), session: Some(played), ..Source::default() })
}

/// The text of a file; `None` if there is none.
fn text(path: &Path) -> Result<Option<String>, Error> {
    match read_text_file(path, LARGEST) {
        Ok(text) => Ok(Some(text)),
        Err(error) if missing(&error) => Ok(None),
        Err(error) => Err(error).context(|| format!("cannot read `{}`", path.display())),
    }
}

fn missing(error: &StorageError) -> bool {
    matches!(error.kind(), Some(std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory))
}

/// The points of a learning curve.
fn points(curve: &Curve) -> Vec<[f64; 3]> {
    let evaluations: Vec<[f64; 3]> = curve.evaluations().map(|(step, found)| [step as f64, found.total, found.success]).collect();
    let ended = || curve.ended().map(|(step, found)| [step as f64, found.total, found.success]).collect();
    if evaluations.is_empty() { ended() } else { evaluations }
}

/// The first trace of every task, in the order of their names.
fn traces(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder.join(msk::evaluate::TRACES)).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "npz")).collect();
    paths.sort();
    let task = |path: &PathBuf| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        stem.rsplit_once('-').map(|(task, _)| task.to_owned())
    };
    paths.dedup_by_key(|path| task(path));
    paths.truncate(TRACES);
    paths
}

/// The film strips that `msk eval --strip` has written, in the order of their names.
fn strips(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_strip = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        ["-worst.png", "-median.png", "-best.png"].iter().any(|end| name.ends_with(end))
    };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_strip).collect();
    paths.sort();
    paths.truncate(STRIPS);
    paths
}
