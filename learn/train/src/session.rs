//! A training in a folder: its curve, its checkpoint, its agents; and how it goes on after it was interrupted or killed.
//!
//! | file | is |
//! |:--|:--|
//! | `training.toml` | what decides every number: task, hashes, seed, steps, settings |
//! | `curve.jsonl` | a line of JSON per round: returns, success, terms, losses; a line per evaluation |
//! | `checkpoint.bin` | the whole state: networks, optimisers, replay, random streams, episodes |
//! | `last/`, `best-by-success/`, `best-by-return/` | agents |

use crate::agent::Agent;
use crate::curve::{self, Curve, Line};
use crate::error::TrainError;
use crate::evaluate::Evaluation;
use crate::tensorboard::Events;
use crate::training::{Identity, Round, Training};
use msk_storage::{Folder, Lock, Log};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Folder of the agent that succeeded most, and of these that with the highest return.
pub const BEST_BY_SUCCESS: &str = "best-by-success";
/// Folder of the agent with the highest return.
pub const BEST_BY_RETURN: &str = "best-by-return";
/// Folder of the agent of the last evaluation.
pub const LAST: &str = "last";

const IDENTITY: &str = "training.toml";
const CHECKPOINT: &str = "checkpoint.bin";
/// Largest files that are read, bytes.
const LARGEST_TEXT: u64 = 1 << 30;
const LARGEST_CHECKPOINT: u64 = 1 << 36;

/// What is shown while a training runs.
pub trait Observer {
    /// A round has ended.
    fn round(&mut self, round: &Round, progress: &Progress);
    /// An evaluation has ended.
    fn evaluated(&mut self, step: u64, evaluation: &Evaluation);
}

/// How far a training is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Control steps so far.
    pub step: u64,
    /// Control steps of the whole training.
    pub steps: u64,
    /// Control steps per second of this process.
    pub rate: f64,
    /// Mean return of the episodes that ended lately, if any has.
    pub total: Option<f64>,
    /// Share of them that ended in success.
    pub success: Option<f64>,
}

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// All steps that were asked for were taken.
    Whole,
    /// It was asked to stop; it can be continued.
    Interrupted,
}

/// What a session knows beside its training: part of its checkpoint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Record {
    /// Bytes of the curve.
    curve: u64,
    best_by_success: Option<Evaluation>,
    best_by_return: Option<Evaluation>,
    /// Evaluations and checkpoints that have been.
    evaluations: u64,
    checkpoints: u64,
}

impl Record {
    /// Takes back the evaluation and the checkpoint of the end, where there was one, and the training goes on beyond it.
    fn forget_end(&mut self, training: &Training) {
        let [evaluations, checkpoints] = due(training);
        self.evaluations = self.evaluations.min(evaluations);
        self.checkpoints = self.checkpoints.min(checkpoints);
    }
}

/// Numbers of the evaluation and of the checkpoint that are due: there is one more of each at the end.
fn due(training: &Training) -> [u64; 2] {
    let settings = &training.identity().settings;
    let last = u64::from(training.is_over());
    [settings.evaluate_every, settings.checkpoint_every].map(|every| training.step() / every.max(1) + last)
}

/// A training in a folder.
pub struct Session {
    folder: Folder,
    _lock: Lock,
    training: Training,
    record: Record,
    curve: Vec<u8>,
    log: Log,
    events: Option<Events>,
    /// Control steps at the checkpoint that is there.
    kept: Option<u64>,
}

impl Session {
    /// Begins a training in a folder, or goes on with the one that is there, which may have had fewer steps; returns whether there was one.
    ///
    /// # Errors
    /// A folder that cannot be used, that another process uses, or that holds another training, or one that more steps would have changed.
    pub fn open(path: &Path, training: Training) -> Result<(Self, bool), TrainError> {
        let folder = Folder::create(path)?;
        let lock = folder.try_lock(Path::new("training.lock"))?;
        let lock = lock.ok_or_else(|| TrainError::InUse { folder: path.display().to_string() })?;
        let mut training = training;
        let there = folder.read_text(Path::new(IDENTITY), LARGEST_TEXT)?;
        let (record, curve) = match &there {
            Some(text) => resume(&folder, text, &mut training)?,
            None => (Record::default(), Vec::new()),
        };
        let unusable = |reason: String| TrainError::Checkpoint { folder: path.display().to_string(), reason };
        let text = toml::to_string(training.identity()).map_err(|error| unusable(error.to_string()))?;
        if there.as_ref() != Some(&text) {
            folder.replace(Path::new(IDENTITY), text.as_bytes())?;
        }
        // Lines after the checkpoint will be written again.
        folder.replace(Path::new(curve::FILE), &curve)?;
        let log = folder.log(curve::FILE)?;
        let kept = (training.step() > 0).then(|| training.step());
        Ok((Self { folder, _lock: lock, training, record, curve, log, events: None, kept }, there.is_some()))
    }

    /// What decides the training in a folder; `None` where there is none.
    ///
    /// # Errors
    /// A folder or file that cannot be read, or a damaged one.
    pub fn identity_in(path: &Path) -> Result<Option<Identity>, TrainError> {
        if !path.exists() {
            return Ok(None);
        }
        let Some(text) = Folder::open(path)?.read_text(Path::new(IDENTITY), LARGEST_TEXT)? else { return Ok(None) };
        identity(path, &text).map(Some)
    }

    /// Writes the curve as event files of TensorBoard, too: what there is of it, and from now on each line.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn with_events(self) -> Result<Self, TrainError> {
        let events = Events::begin(self.folder.path(), &Curve::of(&self.curve)?.lines)?;
        Ok(Self { events: Some(events), ..self })
    }

    /// The training.
    pub fn training(&self) -> &Training {
        &self.training
    }

    /// The agents by success and by return, with what they were evaluated at.
    pub fn best(&self) -> [Option<Evaluation>; 2] {
        [self.record.best_by_success, self.record.best_by_return]
    }

    /// Trains to the end, or until `stop` becomes true.
    ///
    /// # Errors
    /// Numbers that are not finite, or a folder that can no longer be written, such as a full disk: what was kept before stays, and the
    /// same command goes on from it.
    pub fn run(&mut self, stop: &AtomicBool, observer: &mut dyn Observer) -> Result<Ended, TrainError> {
        self.run_to(u64::MAX, stop, observer)
    }

    /// Trains to the first round that ends at this step or after it, and keeps what there is then.
    ///
    /// # Errors
    /// As [`Session::run`].
    pub fn run_to(&mut self, step: u64, stop: &AtomicBool, observer: &mut dyn Observer) -> Result<Ended, TrainError> {
        let (begin, first) = (Instant::now(), self.training.step());
        let mut lately = Lately::default();
        loop {
            // What is due at a step comes before the next round: a training that was interrupted meanwhile goes on with it.
            let [evaluations, checkpoints] = due(&self.training);
            if evaluations > self.record.evaluations {
                let Some(evaluation) = self.evaluate(stop)? else { return self.interrupted() };
                self.record.evaluations = evaluations;
                observer.evaluated(self.training.step(), &evaluation);
            }
            if checkpoints > self.record.checkpoints {
                self.record.checkpoints = checkpoints;
                self.write_checkpoint()?;
            }
            if self.training.is_over() {
                return Ok(Ended::Whole);
            }
            if self.training.step() >= step {
                if self.kept != Some(self.training.step()) {
                    self.write_checkpoint()?;
                }
                return Ok(Ended::Whole);
            }
            if stop.load(Ordering::Relaxed) {
                return self.interrupted();
            }
            let round = self.training.round()?;
            let seconds = begin.elapsed().as_secs_f64();
            lately.add(&round);
            self.add_line(&Line::of(&round, self.training.engine().task(), seconds))?;
            let rate = (round.step - first) as f64 / if seconds > 1e-6 { seconds } else { 1e-6 };
            let [total, success] = lately.means();
            let progress = Progress { step: round.step, steps: self.training.identity().steps, rate, total, success };
            observer.round(&round, &progress);
        }
    }

    /// Keeps what there is, if the training can go on from here. Where episodes begin anew at a checkpoint, it goes on from the one that
    /// an undisturbed training had, too.
    fn interrupted(&mut self) -> Result<Ended, TrainError> {
        if self.training.continues_anywhere() {
            self.write_checkpoint()?;
        }
        Ok(Ended::Interrupted)
    }

    /// Evaluates the present agent and keeps it where it is better than those before; `None` if it was asked to stop meanwhile: then the
    /// evaluation is repeated when the training goes on, because it has not been counted.
    fn evaluate(&mut self, stop: &AtomicBool) -> Result<Option<Evaluation>, TrainError> {
        let mut agent = self.training.agent();
        let Some(evaluation) = self.training.evaluate(&agent, stop)? else { return Ok(None) };
        agent.description.evaluation = Some(evaluation);
        self.add_line(&Line::Evaluation { step: self.training.step(), evaluation })?;
        agent.write(&self.folder, LAST, &self.curve)?;
        let by_success = |evaluation: &Evaluation| (evaluation.success, evaluation.total);
        if self.record.best_by_success.is_none_or(|best| by_success(&evaluation) > by_success(&best)) {
            agent.write(&self.folder, BEST_BY_SUCCESS, &self.curve)?;
            self.record.best_by_success = Some(evaluation);
        }
        if self.record.best_by_return.is_none_or(|best| evaluation.total > best.total) {
            agent.write(&self.folder, BEST_BY_RETURN, &self.curve)?;
            self.record.best_by_return = Some(evaluation);
        }
        Ok(Some(evaluation))
    }

    /// Adds a line to the curve.
    fn add_line(&mut self, line: &Line) -> Result<(), TrainError> {
        let bytes = line.bytes();
        self.log.append(&bytes)?;
        self.curve.extend(bytes);
        self.curve.push(b'\n');
        if let Some(events) = &mut self.events {
            events.add(line)?;
        }
        Ok(())
    }

    /// Writes the checkpoint in one move: a training that is killed meanwhile goes on from the one before.
    fn write_checkpoint(&mut self) -> Result<(), TrainError> {
        self.record.curve = self.curve.len() as u64;
        // Plain data of numbers always has a MessagePack form.
        let record = rmp_serde::to_vec(&self.record).unwrap_or_default();
        let mut bytes = (record.len() as u64).to_le_bytes().to_vec();
        bytes.extend(record);
        self.training.checkpoint(&mut bytes);
        self.folder.replace(Path::new(CHECKPOINT), &bytes)?;
        self.kept = Some(self.training.step());
        Ok(())
    }

    /// Writes the present agent into a folder of this name, beside those that evaluations keep.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn keep_agent(&self, name: &str) -> Result<(), TrainError> {
        Ok(self.training.agent().write(&self.folder, name, &self.curve)?)
    }

    /// Rewards by these last weights, one for each term, from the next step on. They are no part of a checkpoint: a session that is continued
    /// has those of its task until it is given others.
    pub fn set_weights(&mut self, weights: &[f64]) {
        self.training.set_weights(weights);
    }

    /// The present agent.
    pub fn agent(&self) -> Agent {
        self.training.agent()
    }
}

/// What the file of a training in a folder says.
fn identity(folder: &Path, text: &str) -> Result<Identity, TrainError> {
    toml::from_str(text).map_err(|error| TrainError::Identity {
        folder: folder.display().to_string(),
        reason: error.to_string().trim_end().to_owned(),
    })
}

/// Goes on from the checkpoint in a folder; gives what a session knows and the curve up to it.
fn resume(folder: &Folder, text: &str, training: &mut Training) -> Result<(Record, Vec<u8>), TrainError> {
    let shown = folder.path().display().to_string();
    let unusable = |reason: String| TrainError::Checkpoint { folder: shown.clone(), reason };
    let found = identity(folder.path(), text)?;
    let own = training.identity();
    let settings = |identity: &Identity| identity.settings.text().replace('\n', "; ");
    let recorded = |text: &String| if text.is_empty() { "not recorded".to_owned() } else { text.clone() };
    let [there, here] = [&found.provenance, &own.provenance];
    let same: [(&'static str, String, String); 10] = [
        ("task", found.task.clone(), own.task.clone()),
        ("hash of the task", found.task_hash.clone(), own.task_hash.clone()),
        ("hash of the body", found.body_hash.clone(), own.body_hash.clone()),
        ("hash of the body's model", recorded(&there.model_hash), recorded(&here.model_hash)),
        ("condition of the muscles", recorded(&there.condition), recorded(&here.condition)),
        ("build of the program", recorded(&there.build), recorded(&here.build)),
        ("seed", found.seed.to_string(), own.seed.to_string()),
        ("number of steps", found.steps.max(own.steps).to_string(), own.steps.to_string()),
        ("list of lessons", found.lessons.join("; "), own.lessons.join("; ")),
        ("set of settings", settings(&found), settings(own)),
    ];
    if let Some((what, found, expected)) = same.into_iter().find(|(_, found, own)| found != own) {
        return Err(TrainError::Other { folder: shown, what, found, expected });
    }
    // More steps continue the training, unless an earlier step would have been another one with them.
    if let Some(what) = training.depends_on_steps().filter(|_| own.steps > found.steps) {
        return Err(TrainError::Longer { folder: shown, what, found: found.steps, expected: own.steps });
    }
    // A training that was killed before its first checkpoint begins anew.
    let Some(bytes) = folder.read(Path::new(CHECKPOINT), LARGEST_CHECKPOINT)? else { return Ok((Record::default(), Vec::new())) };
    let short = || unusable("it is too short".into());
    let (length, rest) = bytes.split_at_checked(8).ok_or_else(short)?;
    let length = length.iter().rev().fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte));
    let (record, state) = rest.split_at_checked(usize::try_from(length).unwrap_or(usize::MAX)).ok_or_else(short)?;
    training.restore(&bytes[..bytes.len() - state.len()], state).map_err(unusable)?;
    let mut record: Record = rmp_serde::from_slice(record).map_err(|error| unusable(error.to_string()))?;
    record.forget_end(training);
    let curve = folder.read(Path::new(curve::FILE), LARGEST_TEXT)?.unwrap_or_default();
    let known = usize::try_from(record.curve).unwrap_or(usize::MAX);
    let lacks = || TrainError::Checkpoint {
        folder: folder.path().display().to_string(),
        reason: format!("`{}` is shorter than it was", curve::FILE),
    };
    Ok((record, curve.get(..known).ok_or_else(lacks)?.to_vec()))
}

/// The episodes that ended last.
#[derive(Debug, Default)]
struct Lately {
    ends: std::collections::VecDeque<(f64, bool)>,
}

impl Lately {
    /// How many count.
    const MOST: usize = 100;

    fn add(&mut self, round: &Round) {
        self.ends.extend(round.ends.iter().map(|end| (end.total, end.success)));
        let over = self.ends.len().saturating_sub(Self::MOST);
        self.ends.drain(..over);
    }

    fn means(&self) -> [Option<f64>; 2] {
        let count = self.ends.len() as f64;
        let mean = |value: &dyn Fn(&(f64, bool)) -> f64| {
            (!self.ends.is_empty()).then(|| self.ends.iter().map(value).sum::<f64>() / count)
        };
        [mean(&|(total, _)| *total), mean(&|(_, success)| f64::from(u8::from(*success)))]
    }
}
