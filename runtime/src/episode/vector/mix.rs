//! Mixes of tasks in one vector.

use super::super::Engine;
use rayon::ThreadPoolBuildError;

/// Why tasks cannot be played in one vector.
#[derive(Debug, thiserror::Error)]
pub enum MixError {
    /// None is given.
    #[error("a mix has at least one task")]
    Empty,
    /// Their arrays would have rows of different lengths.
    #[error("the tasks of a mix have equally many {what}: `{first}` has {expected}, `{task}` has {found}")]
    Sizes {
        /// Of what.
        what: &'static str,
        /// The first task.
        first: String,
        /// How many it has.
        expected: usize,
        /// The other task.
        task: String,
        /// How many that has.
        found: usize,
    },
    /// The operating system gives no threads.
    #[error(transparent)]
    Threads(#[from] ThreadPoolBuildError),
}

/// The lengths of the rows of a task, with their names.
fn sizes(engine: &Engine) -> [(&'static str, usize); 3] {
    [
        ("entries of an action", engine.action_size()),
        ("values of the observation", engine.task().observation_size()),
        ("values of the critic", engine.task().critic_size()),
    ]
}

/// Whether all engines have rows of the same lengths.
///
/// # Errors
/// The first that differs.
pub(super) fn check_sizes(engines: &[Engine]) -> Result<(), MixError> {
    let first = engines.first().ok_or(MixError::Empty)?;
    for engine in engines {
        for ((what, expected), (_, found)) in sizes(first).into_iter().zip(sizes(engine)) {
            if expected != found {
                let [first, task] = [first, engine].map(|engine| engine.task().name.clone());
                return Err(MixError::Sizes { what, first, expected, task, found });
            }
        }
    }
    Ok(())
}
