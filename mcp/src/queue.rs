//! Work that waits for its turn.

use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// At most so many calls run and so many wait, in the order in which they came; further ones are refused.
#[derive(Debug, Clone)]
pub struct Queue {
    running: usize,
    waiting: usize,
    places: Arc<Semaphore>,
    turns: Arc<Semaphore>,
}

/// The right to run, given back when it is dropped.
#[derive(Debug)]
pub struct Turn {
    _place: OwnedSemaphorePermit,
    _turn: OwnedSemaphorePermit,
}

/// The queue is full.
#[derive(Debug, thiserror::Error)]
#[error("the server is busy: {running} calls run and {waiting} wait, which is the limit; call again when one has been answered")]
pub struct Busy {
    running: usize,
    waiting: usize,
}

impl Queue {
    /// A queue for `running` calls at once and `waiting` more.
    pub fn new(running: usize, waiting: usize) -> Self {
        let (places, turns) = (Arc::new(Semaphore::new(running + waiting)), Arc::new(Semaphore::new(running)));
        Self { running, waiting, places, turns }
    }

    /// Waits for a turn.
    ///
    /// # Errors
    /// All places are taken.
    pub async fn turn(&self) -> Result<Turn, Busy> {
        let busy = || Busy { running: self.running, waiting: self.waiting };
        let place = self.places.clone().try_acquire_owned().map_err(|_| busy())?;
        // The semaphore is never closed.
        let turn = self.turns.clone().acquire_owned().await.map_err(|_| busy())?;
        Ok(Turn { _place: place, _turn: turn })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use tokio::task::yield_now;

    #[tokio::test]
    async fn a_queue_runs_some_lets_some_wait_and_refuses_the_rest() {
        let queue = Queue::new(1, 1);
        let first = queue.turn().await.unwrap();
        let wait = || {
            let queue = queue.clone();
            tokio::spawn(async move { queue.turn().await })
        };
        let waiting = wait();
        yield_now().await;
        assert!(!waiting.is_finished());
        assert!(queue.turn().await.unwrap_err().to_string().contains("1 calls run and 1 wait"));
        drop(first);
        let second = waiting.await.unwrap().unwrap();
        // A call that stops waiting leaves its place to another.
        let cancelled = wait();
        yield_now().await;
        cancelled.abort();
        assert!(cancelled.await.unwrap_err().is_cancelled());
        let third = wait();
        yield_now().await;
        assert!(!third.is_finished());
        drop(second);
        third.await.unwrap().unwrap();
    }
}
