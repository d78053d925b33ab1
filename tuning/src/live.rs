//! Weights that are read anew at the beginning of every episode.

use crate::overlay::Overlay;
use crate::store::{Store, StoreError, Version};
use msk_compiler::diagnostics::{Report, SourceMap};
use msk_compiler::task::{CompiledTask, Origin};
use msk_evaluate::{Fed, Feed};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A weights file in use.
///
/// A reader gets one whole version of the file: the newest that could be read and that the tasks allow. A version that is
/// refused is reported once, and the weights before it stay.
pub struct Live {
    store: Store,
    name: String,
    tasks: Vec<Arc<CompiledTask>>,
    notify: Box<dyn Fn(&str) + Send + Sync>,
    present: Mutex<Present>,
}

struct Present {
    /// The newest version that was looked at, whether it was taken or refused.
    seen: Option<String>,
    taken: Arc<InForce>,
}

/// One version of the weights of all tasks.
#[derive(Debug, Clone, PartialEq)]
pub struct InForce {
    /// Its hash.
    pub version: String,
    /// The weights of each task, by its name, in the order of its terms.
    pub tasks: Vec<(String, Vec<f64>)>,
}

/// Why a weights file cannot be begun with.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// It cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// There is none.
    #[error("there is no weights file `{0}`")]
    Missing(String),
    /// It does not fit the tasks.
    #[error("{0}")]
    Refused(Box<Report>),
}

impl Live {
    /// Begins with the file as it is. `notify` gets a message for every later version that is refused.
    ///
    /// # Errors
    /// A file that is not there, cannot be read, or that the tasks do not allow.
    pub fn open(
        path: &Path,
        tasks: Vec<Arc<CompiledTask>>,
        notify: impl Fn(&str) + Send + Sync + 'static,
    ) -> Result<Self, LiveError> {
        let name = path.display().to_string();
        // A folder that is not there has no weights file either.
        let store = Store::open(path).map_err(|error| match error {
            StoreError::Storage(error) if error.kind() == Some(ErrorKind::NotFound) => LiveError::Missing(name.clone()),
            error => error.into(),
        })?;
        Self::begin(store, name, tasks, notify)
    }

    /// Begins with the file of a store as it is, like [`Live::open`].
    ///
    /// # Errors
    /// As there.
    pub fn over(
        store: Store,
        tasks: Vec<Arc<CompiledTask>>,
        notify: impl Fn(&str) + Send + Sync + 'static,
    ) -> Result<Self, LiveError> {
        let name = store.path().display().to_string();
        Self::begin(store, name, tasks, notify)
    }

    fn begin(
        store: Store,
        name: String,
        tasks: Vec<Arc<CompiledTask>>,
        notify: impl Fn(&str) + Send + Sync + 'static,
    ) -> Result<Self, LiveError> {
        let version = store.read()?.ok_or_else(|| LiveError::Missing(name.clone()))?;
        let taken = Arc::new(InForce::of(&name, &version, &tasks).map_err(|report| LiveError::Refused(Box::new(report)))?);
        let present = Mutex::new(Present { seen: Some(version.hash), taken });
        Ok(Self { store, name, tasks, notify: Box::new(notify), present })
    }

    /// The weights in force now.
    pub fn current(&self) -> Arc<InForce> {
        // A thread that panicked here left one version or the next. The file is read under the same lock, so that no thread
        // goes back to an older version than another has taken.
        let mut present = self.present.lock().unwrap_or_else(PoisonError::into_inner);
        let found = self.store.read();
        let (seen, refused) = match found {
            Ok(Some(version)) if present.seen.as_ref() == Some(&version.hash) => return present.taken.clone(),
            Ok(Some(version)) => match InForce::of(&self.name, &version, &self.tasks) {
                Ok(fresh) => {
                    *present = Present { seen: Some(version.hash), taken: Arc::new(fresh) };
                    return present.taken.clone();
                }
                Err(report) => (Some(version.hash), report.to_string()),
            },
            Ok(None) => (None, format!("the weights file `{}` does not exist any more\n", self.name)),
            Err(error) => (None, format!("{error}\n")),
        };
        // A file that cannot be read is reported once, not before every episode.
        if seen.is_some() || present.seen.is_some() {
            (self.notify)(&format!("{refused}the weights stay at version {}", present.taken.version));
        }
        present.seen = seen;
        present.taken.clone()
    }
}

impl InForce {
    /// The weights of a version of a file, laid over the source.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn of(name: &str, version: &Version, tasks: &[Arc<CompiledTask>]) -> Result<Self, Report> {
        let mut sources = SourceMap::default();
        let laid = Overlay::read(name, &version.text, &mut sources)
            .and_then(|overlay| overlay.apply(tasks, &Origin::Overlay(name.to_owned())));
        match laid {
            Ok(laid) => Ok(Self {
                version: version.hash.clone(),
                tasks: laid.iter().map(|task| (task.name.clone(), task.weights())).collect(),
            }),
            Err(diagnostics) => Err(Report::new(sources, diagnostics)),
        }
    }
}

impl Feed for Live {
    fn weights(&self, task: &CompiledTask) -> Fed {
        let current = self.current();
        let weights = current.tasks.iter().find(|(name, _)| *name == task.name).map(|(_, weights)| weights.clone());
        Fed { version: current.version.clone(), weights: weights.unwrap_or_else(|| task.weights()) }
    }
}
