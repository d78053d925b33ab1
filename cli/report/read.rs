//! What a report is made of: folders of results and trainings.

use crate::error::{Context, Error};
use crate::trace;
use msk::evaluate::session::{Comparison, Errors, SessionFolder, Tracking};
use msk::evaluate::sweep::{Axis, Sweep, perturbation};
use msk::evaluate::trace::Trace;
use msk::evaluate::{RunSettings, Summary};
use msk::train::curve::Curve;
use msk_storage::{Folder, StorageError};
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
    pub traces: Vec<Trace>,
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
    let opened = match Folder::open(folder) {
        Err(error) if missing(&error) => return Err(nothing(folder)),
        opened => opened.context(|| format!("cannot read `{}`", folder.display()))?,
    };
    let text = |name: &str| text(&opened, name);
    let damaged = |error: serde_json::Error| {
        let error = Error::new(format!("the results in `{}` are damaged: {error}", folder.display()));
        error.hint("evaluate again: they may be of another version of the program")
    };
    let sweep: Option<Sweep> = text("sweep.json")?.map(|text| serde_json::from_str(&text)).transpose().map_err(damaged)?;
    // What is reported is summed up from the journals: the sums beside them may be of another run, or edited.
    let sweep = sweep.map(|kept| self::sweep(&opened, &kept)).transpose()?.flatten();
    let own = Summary::of_folder(&opened).map_err(crate::eval::explain)?;
    let summary = own.map_or_else(|| summary(&opened, "unperturbed"), |found| Ok(Some(found)))?;
    let curve = text(msk::train::curve::FILE)?.map(|lines| Curve::of(lines.as_bytes())).transpose();
    let curve = curve.context(|| format!("cannot read `{}`", folder.display()))?.as_ref().map(points).unwrap_or_default();
    let name = name(folder);
    let policy = summary.as_ref().map(|summary| summary.policy.clone());
    let label = policy.map_or_else(|| name.clone(), |policy| format!("{policy} ({name})"));
    let source = Source { label, summary, sweep, curve, session: None, traces: traces(&opened)?, strips: strips(folder) };
    if source.summary.is_none() && source.sweep.is_none() && source.curve.is_empty() {
        return Err(nothing(folder));
    }
    Ok(source)
}

fn nothing(folder: &Path) -> Error {
    let files = "no summary.json, sweep.json, curve.jsonl or session.json";
    let error = Error::new(format!("`{}` has no results: {files}", folder.display()));
    error.hint("name a folder that `msk eval`, `msk train` or `msk session` has written")
}

/// The sums over the episodes of a folder within the results; `None` if it is none or has none.
fn summary(results: &Folder, name: &str) -> Result<Option<Summary>, Error> {
    match results.subfolder(Path::new(name)) {
        Err(error) if missing(&error) => Ok(None),
        opened => Summary::of_folder(&opened?).map_err(crate::eval::explain),
    }
}

/// A sweep along the axes of `kept`, summed up from the episodes at each scale.
fn sweep(results: &Folder, kept: &Sweep) -> Result<Option<Sweep>, Error> {
    let mut points = Vec::new();
    let mut first: Option<Summary> = None;
    for (axis, scales) in &kept.axes {
        let point = |scale: &f64| -> Result<(f64, Summary), Error> {
            let name = if *scale == 0.0 { "unperturbed".to_owned() } else { format!("{}-{scale}", axis.name()) };
            let wrong = |what: &str| Error::new(format!("the sweep {what} `{}`", results.path().join(&name).display()));
            let again = "the same `msk eval --sweep` with `--out` completes it";
            let found = summary(results, &name)?.ok_or_else(|| wrong("has no results in").hint(again))?;
            // What is compared with each other is of one policy, in the same episodes of the same tasks.
            if !of_one_run(first.get_or_insert_with(|| found.clone()), &found) {
                return Err(wrong("contains results of another run in").hint("evaluate again into a new folder"));
            }
            if !perturbed(results, &name, *axis, *scale)? {
                return Err(
                    wrong("contains episodes that are perturbed in another way in").hint("evaluate again into a new folder")
                );
            }
            Ok((*scale, found))
        };
        points.push((*axis, scales.iter().map(point).collect::<Result<Vec<_>, _>>()?));
    }
    Ok(Sweep::of(&points))
}

/// Whether the episodes of a folder of a sweep are perturbed as their place says, and by nothing else.
fn perturbed(results: &Folder, name: &str, axis: Axis, scale: f64) -> Result<bool, Error> {
    let file = format!("{name}/run.json");
    let damaged = || format!("`{}` is damaged", results.path().join(&file).display());
    let settings: RunSettings = serde_json::from_str(&text(results, &file)?.unwrap_or_default()).context(damaged)?;
    let expected = perturbation(axis, scale, None);
    let expected = if expected.is_none() { String::new() } else { expected.to_string() };
    // What observations are normalised by follows in the words.
    let is_so =
        |words: &str| words.strip_prefix(&*expected).is_some_and(|rest| rest.is_empty() || rest.starts_with(", normalized by "));
    Ok(settings.tasks.iter().all(|task| is_so(&task.perturbation)))
}

fn of_one_run(one: &Summary, other: &Summary) -> bool {
    let names = |summary: &Summary| summary.tasks.iter().map(|task| (task.name(), task.family.clone())).collect::<Vec<_>>();
    one.policy == other.policy && one.protocol == other.protocol && names(one) == names(other)
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

/// The text of a file of results; `None` if there is none.
fn text(results: &Folder, name: &str) -> Result<Option<String>, Error> {
    results.read_text(Path::new(name), LARGEST).context(|| format!("cannot read `{}`", results.path().join(name).display()))
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

/// The first trace of every task, in the order of their names. A report is passed on: no link brings another file into it.
fn traces(results: &Folder) -> Result<Vec<Trace>, Error> {
    let kept = match results.existing_private_subfolder(msk::evaluate::TRACES) {
        Ok(None) => return Ok(Vec::new()),
        kept => kept?.ok_or_else(|| Error::new("the folder of traces is gone"))?,
    };
    let entries = kept.entries(Path::new(""))?;
    let mut paths: Vec<PathBuf> =
        entries.into_iter().map(|entry| entry.name).filter(|path| path.extension().is_some_and(|e| e == "npz")).collect();
    let task = |path: &PathBuf| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        stem.rsplit_once('-').map(|(task, _)| task.to_owned())
    };
    paths.dedup_by_key(|path| task(path));
    paths.truncate(TRACES);
    paths.iter().map(|name| trace::read_in(&kept, name)).collect()
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
