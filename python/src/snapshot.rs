//! Episodes, kept.

use crate::task::Task;
use msk_runtime::episode::{Episode, EpisodeKey};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Episodes as they were, one per slot, from which they go on bit for bit.
#[pyclass(frozen, module = "msk._native")]
pub struct Snapshot {
    /// Hashes of the task and of its body.
    of: [String; 2],
    /// With the key of the episode that follows each.
    pub slots: Vec<(Episode, EpisodeKey)>,
}

impl Snapshot {
    pub fn new(task: &Task, slots: Vec<(Episode, EpisodeKey)>) -> Self {
        Self { of: hashes(task), slots }
    }

    /// # Errors
    /// `ValueError`: a snapshot of another task, body or number of slots.
    pub fn check(&self, task: &Task, slots: usize) -> PyResult<()> {
        if self.of != hashes(task) {
            let name = &task.engine().task().name;
            return Err(PyValueError::new_err(format!("the snapshot is of another task or body than `{name}` here")));
        }
        if self.slots.len() != slots {
            let found = self.slots.len();
            return Err(PyValueError::new_err(format!("the snapshot has {found} episodes, the environment {slots}")));
        }
        Ok(())
    }
}

fn hashes(task: &Task) -> [String; 2] {
    [task.engine().task().hash.clone(), task.body_hash().to_owned()]
}

#[pymethods]
impl Snapshot {
    fn __len__(&self) -> usize {
        self.slots.len()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.of == other.of && self.slots == other.slots
    }

    fn __repr__(&self) -> String {
        format!("<Snapshot of {} episodes>", self.slots.len())
    }
}
