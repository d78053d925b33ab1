//! Traces: what an episode is at every control step, in named columns with units.
//!
//! 1. A [`Quantity`] is a block of columns: activations, joint positions, ground reactions and the like.
//! 2. A [`Layout`] names the columns of the quantities that are wanted of a task on a body.
//! 3. A [`StepReader`] reads one step of an episode after the other as a [`Row`]; standard metrics are computed from rows as they come.
//! 4. A [`Trace`] keeps the rows of one episode; it is written and read as a NumPy archive, and written as files of OpenSim.
//!
//! Memory is bounded by the horizon of a task, not by the number of episodes; [`Layout::ensure_room`] bounds it before the first step.

mod archive;
mod layout;
mod opensim;
mod quantity;
mod reader;

pub use archive::ArchiveError;
pub use layout::{Block, Column, Layout, Muscle};
pub use opensim::{OpenSimFile, opensim};
pub use quantity::{Quantity, QuantityError, quantities};
pub use reader::{Row, StepReader};

use crate::EpisodeRecord;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Which episode a trace is of, and how it ended.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// Name of the task.
    pub task: String,
    /// Hash of its meaning.
    pub task_hash: String,
    /// Hash of the body.
    pub model_hash: String,
    /// What acted.
    pub policy: String,
    /// Seed of the evaluation.
    pub seed: u64,
    /// Index of the episode.
    pub episode: u64,
    /// Whether it succeeded.
    pub success: bool,
    /// How it ended, in words.
    pub ended_by: String,
}

impl Origin {
    /// Of the episode of a record.
    pub fn of(record: &EpisodeRecord) -> Self {
        Self {
            task: record.task.clone(),
            task_hash: record.task_hash.clone(),
            model_hash: record.model_hash.clone(),
            policy: record.policy.clone(),
            seed: record.seed,
            episode: record.episode,
            success: record.success,
            ended_by: record.ended_by(),
        }
    }
}

/// The rows of one episode.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Which episode.
    pub origin: Origin,
    layout: Arc<Layout>,
    /// Rows of each block, one after the other.
    blocks: Vec<Vec<f64>>,
    /// Rows of states: one more than control steps; 0 before the first.
    rows: usize,
}

impl Trace {
    /// Without rows.
    pub fn new(layout: Arc<Layout>) -> Self {
        let blocks = vec![Vec::new(); layout.blocks.len()];
        Self { origin: Origin::default(), layout, blocks, rows: 0 }
    }

    /// Appends a row of the same layout.
    pub fn push(&mut self, row: &Row<'_>) {
        for (kept, block) in self.blocks.iter_mut().zip(&self.layout.blocks) {
            kept.extend_from_slice(row.of(block.quantity));
        }
        self.rows += 1;
    }

    /// What its columns are.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// Rows of states: the reset, and one after every control step.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Rows of a quantity: of one that only steps have, one less than of states. 0 if the trace does not have it.
    pub fn rows_of(&self, quantity: Quantity) -> usize {
        match self.layout.block(quantity) {
            Some(_) if quantity.is_of_steps() => self.rows.saturating_sub(1),
            Some(_) => self.rows,
            None => 0,
        }
    }

    /// Times of the rows of states, s.
    pub fn times(&self) -> Vec<f64> {
        (0..self.rows).map(|row| row as f64 * self.layout.period).collect()
    }

    /// One column over time; `None` if the trace does not have it.
    pub fn column(&self, quantity: Quantity, column: usize) -> Option<Vec<f64>> {
        let place = self.layout.place(quantity)?;
        let width = self.layout.blocks[place].columns.len();
        (column < width).then(|| self.blocks[place].iter().skip(column).step_by(width).copied().collect())
    }

    /// The rows of a quantity, each with a value for every column; none if the trace does not have it.
    pub fn block(&self, quantity: Quantity) -> impl Iterator<Item = &[f64]> {
        let place = self.layout.place(quantity);
        let width = place.map_or(1, |place| self.layout.blocks[place].columns.len()).max(1);
        place.into_iter().flat_map(move |place| self.blocks[place].chunks_exact(width))
    }

    /// Shows the rows in their order, as they were when the episode was played.
    pub fn replay(&self, mut look: impl FnMut(&Row<'_>)) {
        let mut values = Vec::new();
        for row in 0..self.rows {
            values.clear();
            for (kept, block) in self.blocks.iter().zip(&self.layout.blocks) {
                let width = block.columns.len();
                let place = if block.quantity.is_of_steps() { row.checked_sub(1) } else { Some(row) };
                match place.and_then(|place| kept.get(place * width..(place + 1) * width)) {
                    Some(part) => values.extend_from_slice(part),
                    None => values.resize(values.len() + width, 0.0),
                }
            }
            look(&Row::new(&self.layout, &values, row == 0));
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
