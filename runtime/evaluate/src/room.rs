//! How much may be kept of one episode.

use msk_program::task::CompiledTask;

/// Largest arrays that are kept of one episode, bytes: they are in memory until it ends, and no reader takes larger ones.
pub const MOST_BYTES: u64 = 4 << 30;

/// An episode whose steps take more memory than there is for them.
#[derive(Debug, thiserror::Error)]
#[error(
    "an episode of `{task}` may have {steps} control steps, and to keep {bytes} bytes of each takes {:.1} GiB of memory, at most 4 GiB: \
     keep fewer columns, or give the task a shorter horizon",
    *.steps as f64 * *.bytes as f64 / (1u64 << 30) as f64
)]
pub struct NoRoom {
    /// The task.
    pub task: String,
    /// Most control steps that would be kept.
    pub steps: u32,
    /// Bytes of each.
    pub bytes: usize,
}

/// Checks, before an episode begins, that there is room for `steps` control steps of so many bytes.
///
/// # Errors
/// More than [`MOST_BYTES`].
pub fn ensure_room(task: &CompiledTask, steps: u32, bytes: usize) -> Result<(), NoRoom> {
    match u64::from(steps).checked_mul(bytes as u64).is_some_and(|all| all <= MOST_BYTES) {
        true => Ok(()),
        false => Err(NoRoom { task: task.name.clone(), steps, bytes }),
    }
}
