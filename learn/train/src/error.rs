//! Why a training cannot begin or go on.

use crate::settings::SettingsError;
use msk_runtime::episode::EpisodeError;
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
    /// A checkpoint that cannot be used.
    #[error("`{folder}/checkpoint.bin` cannot be used: {reason}; remove the folder to begin anew")]
    Checkpoint {
        /// The folder.
        folder: String,
        /// Why.
        reason: String,
    },
    /// A task without anything to decide or to see.
    #[error("task `{task}` has {what}, so there is nothing to learn")]
    Nothing {
        /// Its name.
        task: String,
        /// What it lacks.
        what: &'static str,
    },
}
