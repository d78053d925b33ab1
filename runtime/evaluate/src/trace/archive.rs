//! A trace as a NumPy archive (`.npz`).
//!
//! `time` has the times of the states, s. Every quantity is an array of doubles with a row per state, or per control step, and a column
//! for each name; `trace.json` in the archive has the names and units, and which episode it is:
//!
//! ```python
//! archive = numpy.load("walk-0000.npz")
//! layout = json.loads(archive["trace.json"])
//! ```

use super::{Layout, Origin, Quantity, Trace};
use crate::MOST_BYTES;
use crate::npz::{NpzReader, NpzWriter};
use msk_runtime::inspect::{Excitations, ExcitationsError};
use serde::{Deserialize, Serialize};
use std::io::{self, Cursor};
use std::sync::Arc;
use zip::result::ZipError;

/// Largest description that is read, bytes.
const MOST_TEXT: u64 = 64 << 20;
/// Most rows: the reset, and the steps of the largest horizon that a task may have.
const MOST_ROWS: usize = 100_000_001;
/// Largest header of an array that is read, bytes.
const MOST_HEADER: u64 = 1 << 16;
const DESCRIPTION: &str = "trace.json";
const FORMAT: &str = "msk trace 1";

/// Why bytes are no trace.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// Not an archive, or one without an entry.
    #[error("is not a trace: {0}")]
    Archive(#[from] ZipError),
    /// It cannot be read or written.
    #[error(transparent)]
    System(#[from] io::Error),
    /// Its description is not what a trace has.
    #[error("is not a trace: its `trace.json` is damaged: {0}")]
    Description(#[from] serde_json::Error),
    /// Another format.
    #[error("has the format `{0}`, expected `msk trace 1`: it was written by another version of the program")]
    Format(String),
    /// Columns that no trace has.
    #[error("is not a trace: its layout {0}")]
    Layout(String),
    /// An array that does not fit its description.
    #[error("its array `{name}` {reason}")]
    Array {
        /// Name of the array.
        name: String,
        /// What is wrong with it.
        reason: ExcitationsError,
    },
    /// Another number of rows than described.
    #[error("its array `{name}` has {found} rows, expected {expected}")]
    Rows {
        /// Name of the array.
        name: String,
        /// As described.
        expected: usize,
        /// As it is.
        found: usize,
    },
    /// More than is read.
    #[error("it describes {0} rows, more than are read")]
    Large(usize),
}

/// Everything of a trace but its numbers.
#[derive(Serialize, Deserialize)]
struct Description {
    format: String,
    origin: Origin,
    /// Rows of states.
    rows: usize,
    layout: Layout,
}

impl Trace {
    /// The trace as the bytes of a NumPy archive: the same trace has the same bytes.
    ///
    /// # Errors
    /// More than an archive holds.
    pub fn archive(&self) -> Result<Vec<u8>, ArchiveError> {
        let mut archive = NpzWriter::new(Cursor::new(Vec::new()));
        let description = Description {
            format: FORMAT.to_owned(),
            origin: self.origin.clone(),
            rows: self.rows,
            layout: Layout::clone(self.layout()),
        };
        archive.file(DESCRIPTION, &serde_json::to_vec_pretty(&description)?)?;
        archive.array("time", &self.times(), &[self.rows])?;
        for (block, values) in self.layout.blocks.iter().zip(&self.blocks) {
            archive.array(block.quantity.name(), values, &[self.rows_of(block.quantity), block.columns.len()])?;
        }
        Ok(archive.finish()?.into_inner())
    }

    /// Reads the bytes of a NumPy archive that [`archive`](Self::archive) made.
    ///
    /// # Errors
    /// Bytes that are no trace, or a damaged one.
    pub fn read(bytes: &[u8]) -> Result<Self, ArchiveError> {
        let mut archive = NpzReader::new(bytes)?;
        let description: Description = serde_json::from_slice(&archive.entry(DESCRIPTION, MOST_TEXT)?)?;
        if description.format != FORMAT {
            return Err(ArchiveError::Format(description.format));
        }
        if let Some(wrong) = description.layout.wrong() {
            return Err(ArchiveError::Layout(wrong));
        }
        if description.rows > MOST_ROWS {
            return Err(ArchiveError::Large(description.rows));
        }
        let mut trace = Self { origin: description.origin, rows: description.rows, ..Self::new(Arc::new(description.layout)) };
        let layout = Arc::clone(&trace.layout);
        for (place, block) in layout.blocks.iter().enumerate() {
            let (name, width) = (block.quantity.name(), block.columns.len());
            let expected = trace.rows_of(block.quantity);
            let size = (expected as u64).checked_mul(8 * width as u64).filter(|size| *size <= MOST_BYTES);
            let size = size.ok_or(ArchiveError::Large(expected))?;
            let array = archive.entry(&format!("{name}.npy"), size + MOST_HEADER)?;
            let damaged = |reason| ArchiveError::Array { name: name.to_owned(), reason };
            // Where a task follows nothing there is no error.
            let read = match block.quantity {
                Quantity::TrackingError => Excitations::with_gaps_from_npy(&array, width),
                _ => Excitations::from_npy(&array, width),
            };
            let read = read.map_err(damaged)?;
            if read.rows() != expected {
                return Err(ArchiveError::Rows { name: name.to_owned(), expected, found: read.rows() });
            }
            trace.blocks[place] = (0..expected).flat_map(|row| read.row(row)).copied().collect();
        }
        Ok(trace)
    }
}
