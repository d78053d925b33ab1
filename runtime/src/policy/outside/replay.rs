//! Recorded actions, played again: the rows of a NumPy array.

use super::source_file;
use crate::inspect::Excitations;
use crate::policy::{ActsOn, Policy, PolicyContext, PolicyError};
use std::sync::Arc;

/// Row i of an array is the action of step i, in every episode.
pub(crate) struct Replay {
    name: String,
    path: String,
    bytes: Arc<[u8]>,
    rows: Option<Excitations>,
    acts_on: ActsOn,
}

impl Replay {
    /// Reads a file: its bytes, and what tells them from those of other files of its name.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(path: &str) -> Result<(Arc<[u8]>, String), PolicyError> {
        source_file(path).map(|(bytes, digest)| (bytes.into(), digest))
    }

    pub fn new(name: &str, path: &str, bytes: Arc<[u8]>) -> Self {
        Self { name: name.to_owned(), path: path.to_owned(), bytes, rows: None, acts_on: ActsOn::Task }
    }

    fn unable(&self, reason: impl Into<String>) -> PolicyError {
        PolicyError::Unable { policy: self.name.clone(), reason: format!("`{}` {}", self.path, reason.into()) }
    }
}

impl Policy for Replay {
    fn name(&self) -> &str {
        &self.name
    }

    fn acts_on(&self) -> ActsOn {
        self.acts_on
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        // Actions of a controller are kept muscle by muscle, whatever the action space of the task.
        let read = |acts_on: ActsOn| Excitations::from_npy(&self.bytes, acts_on.size(context.task, context.body));
        let rows = match read(ActsOn::Task) {
            Ok(rows) => Ok((ActsOn::Task, rows)),
            Err(error) => read(ActsOn::Muscles).map(|rows| (ActsOn::Muscles, rows)).map_err(|_| error),
        };
        let (acts_on, rows) = rows.map_err(|error| self.unable(error.to_string()))?;
        (self.acts_on, self.rows) = (acts_on, Some(rows));
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let rows = self.rows.as_ref().ok_or_else(|| self.unable("has not been reset"))?;
        let row = usize::try_from(context.step).unwrap_or(usize::MAX);
        if row >= rows.rows() {
            return Err(self.unable(format!("contains only {} actions, but the episode continues", rows.rows())));
        }
        action.copy_from_slice(rows.row(row));
        Ok(())
    }
}
