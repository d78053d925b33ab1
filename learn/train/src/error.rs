//! Why a training cannot begin or go on.

use crate::curve::CurveError;
use msk_runtime::episode::EpisodeError;
use msk_runtime::policy::PolicyError;
use msk_settings::SettingsError;
use msk_storage::StorageError;

/// Why a training cannot begin or go on.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// Settings that make no sense.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Numbers that are infinite or none.
    #[error("after {step} steps {what} is not finite{place}: lower the learning rate, or bound the rewards of the task", place = layer.as_ref().map(|layer| format!(", first in `{layer}`")).unwrap_or_default())]
    NotFinite {
        /// Control steps so far.
        step: u64,
        /// The part of the loss, or the gradient of one.
        what: &'static str,
        /// The tensor of the first such number.
        layer: Option<String>,
    },
    /// The environments refuse a step.
    #[error(transparent)]
    Episode(#[from] EpisodeError),
    /// The operating system gives no threads.
    #[error("the operating system gives no threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A file or folder cannot be used.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// A damaged learning curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// A folder in which another process trains.
    #[error("another process trains in `{folder}`: wait for its end, or choose another folder with --out")]
    InUse {
        /// The folder.
        folder: String,
    },
    /// A folder that holds another training.
    #[error("`{folder}` holds another training: its {what} is {found}, not {expected}; choose another folder with --out")]
    Other {
        /// The folder.
        folder: String,
        /// In what they differ.
        what: &'static str,
        /// There.
        found: String,
        /// Here.
        expected: String,
    },
    /// More steps for a training whose steps were decided by how many there would be.
    #[error(
        "`{folder}` holds a training of {found} steps, which {what} has fitted to their number: it cannot have {expected}; choose another folder with --out, and begin as its agent with --start"
    )]
    Longer {
        /// The folder.
        folder: String,
        /// What looks at the share of the steps that has passed.
        what: &'static str,
        /// Its steps.
        found: u64,
        /// Those that were asked for.
        expected: u64,
    },
    /// A file that says of which training a folder is, and is damaged.
    #[error("`{folder}/training.toml` is damaged; remove the folder to begin anew: {reason}")]
    Identity {
        /// The folder.
        folder: String,
        /// Why.
        reason: String,
    },
    /// A checkpoint that cannot be used.
    #[error("`{folder}/checkpoint.bin` cannot be used: {reason}; remove the folder to begin anew")]
    Checkpoint {
        /// The folder.
        folder: String,
        /// Why.
        reason: String,
    },
    /// Imitation without anything to imitate.
    #[error("there is nothing to imitate: name data sets of `msk collect` with --data, or a policy with --teacher")]
    NoTeacher,
    /// A teacher for an algorithm that learns from rewards.
    #[error("the algorithm `{0}` learns from rewards: --teacher is for `--algorithm clone`, whose agent it can --start as")]
    NoTeaching(&'static str),
    /// Recorded episodes for an algorithm that learns from those that it plays.
    #[error(
        "the algorithm `{0}` learns from what it plays itself: --data is for sac, simba, dynsyn, and clone, as whose agent it can --start"
    )]
    NoData(&'static str),
    /// A data set that cannot be learned from.
    #[error("the data set `{name}` {reason}")]
    Data {
        /// Which one.
        name: String,
        /// Why not, in words that continue its name.
        reason: String,
    },
    /// A teacher that cannot be imitated.
    #[error("the teacher `{teacher}` {reason}")]
    Teacher {
        /// Which one.
        teacher: String,
        /// Why not, in words that continue its name.
        reason: String,
    },
    /// An agent that a training cannot begin as.
    #[error("a training of `{algorithm}` cannot start as this agent: {reason}")]
    Start {
        /// The algorithm.
        algorithm: &'static str,
        /// Why not.
        reason: String,
    },
    /// An action space in which nothing explores.
    #[error("{reason}; set `explores = false` in `[dep]`")]
    Exploration {
        /// Why not.
        reason: String,
    },
    /// A task whose entries cannot be grouped.
    #[error("the algorithm `dynsyn` cannot group the entries of an action of this task: {reason}")]
    Groups {
        /// Why not.
        reason: String,
    },
    /// A teacher that cannot act.
    #[error(transparent)]
    Policy(#[from] PolicyError),
    /// A task without anything to decide or to see.
    #[error("task `{task}` has {what}, so there is nothing to learn")]
    Nothing {
        /// Its name.
        task: String,
        /// What it lacks.
        what: &'static str,
    },
}
