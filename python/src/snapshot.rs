//! Episodes, kept.

use crate::task::Task;
use msk_runtime::episode::{Episode, EpisodeKey};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};

/// Episodes as they were, one per slot, from which they go on bit for bit.
#[pyclass(frozen, module = "msk._native")]
#[derive(PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Of this package: another one may mean something else by the same bytes.
    version: String,
    /// Hashes of the task and of its body.
    of: [String; 2],
    /// With the key of the episode that follows each.
    pub slots: Vec<(Episode, EpisodeKey)>,
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

impl Snapshot {
    /// The episodes of a task.
    pub fn new(task: &Task, slots: Vec<(Episode, EpisodeKey)>) -> Self {
        Self { version: VERSION.to_owned(), of: hashes(task), slots }
    }

    /// Whether it can be restored where so many episodes of a task are played.
    ///
    /// # Errors
    /// `ValueError`: a snapshot of another task, body or number of slots, or one that was damaged.
    pub fn check(&self, task: &Task, slots: usize) -> PyResult<()> {
        if self.of != hashes(task) {
            let name = &task.engine().task().name;
            return Err(PyValueError::new_err(format!("the snapshot is of another task or body than `{name}` here")));
        }
        if self.slots.len() != slots {
            let found = self.slots.len();
            return Err(PyValueError::new_err(format!("the snapshot has {found} episodes, the environment {slots}")));
        }
        if !self.slots.iter().all(|(episode, _)| task.engine().accepts(episode)) {
            return Err(PyValueError::new_err("the snapshot is damaged: an episode in it does not have the shape of its task"));
        }
        Ok(())
    }
}

fn hashes(task: &Task) -> [String; 2] {
    [task.engine().task().hash.clone(), task.body_hash().to_owned()]
}

#[pymethods]
impl Snapshot {
    /// Reads what `to_bytes` wrote.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let damaged = |error| PyValueError::new_err(format!("these bytes are no snapshot: {error}"));
        // The version stands first, so that of another version is found before the rest is read.
        let (version, _): (String, _) = postcard::take_from_bytes(bytes).map_err(damaged)?;
        if version != VERSION {
            return Err(PyValueError::new_err(format!("the snapshot is of version {version}, this is {VERSION}")));
        }
        postcard::from_bytes(bytes).map_err(damaged)
    }

    /// All of it: the same bytes for the same snapshot.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        if self.slots.iter().any(|(episode, _)| episode.has_controller()) {
            return Err(PyValueError::new_err(
                "the action space of the task contains computed muscle control, which cannot be written as bytes: keep the snapshot in memory",
            ));
        }
        let bytes = postcard::to_stdvec(self).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        Ok((slf.get_type().getattr("from_bytes")?, (slf.call_method0("to_bytes")?,)))
    }

    fn __len__(&self) -> usize {
        self.slots.len()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self == other
    }

    fn __repr__(&self) -> String {
        format!("<Snapshot of {} episodes>", self.slots.len())
    }
}
