//! Human recordings: tables of numbers over time or over a gait cycle, in the formats in which they are published.
//!
//! * OpenSim's `.sto` and `.mot`: a header up to `endheader`, then names and rows;
//! * `.trc` of motion capture: three columns for each marker, a row for each frame;
//! * `.c3d` of motion capture: markers, and analog channels such as electromyograms;
//! * `.csv` (separated by commas, semicolons or tabs): names and rows, as envelopes of electromyograms are exported.
//!
//! Recordings of people are not part of this project: their owners publish them. Two data sets are read in the layouts in which they are
//! published, and [averaged](average) to such a table of envelopes: [`gait120`] (walking, stairs, slopes) and [`van_hooren`] (running).
//! [`OBTAIN`] says where they are.

mod c3d;
mod csv;
mod envelopes;
mod filter;
mod mat;
mod muscles;
mod storage;
mod trc;
mod workbook;

pub mod gait120;
pub mod van_hooren;

pub use envelopes::{Participant, average};
pub use muscles::muscle;

use crate::metrics::similarity::Envelope;

/// How to obtain envelopes of human electromyograms.
pub const OBTAIN: &str = "no recordings of people are included: download Gait120 (walking, stairs, slopes) from \
    https://doi.org/10.6084/m9.figshare.27677016, or the running of Van Hooren and Meijer from https://osf.io/7qbxc, and average a data \
    set with `msk trace envelopes FOLDER`; any other table with a column per muscle and a row per percent of the gait cycle, \
    as .csv or .sto, will do";

/// Most rows times columns that are read.
const MOST_NUMBERS: usize = 50_000_000;

/// A recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// Whether angles are in degrees, as far as the format tells.
    pub degrees: bool,
    /// Names of the columns.
    pub names: Vec<String>,
    /// A value for every row, column by column; NaN where a cell is empty.
    pub columns: Vec<Vec<f64>>,
}

/// Why a text is no recording.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RecordingError {
    /// An ending that names no format.
    #[error("has an unknown format: expected a name that ends in .sto, .mot, .trc, .c3d or .csv")]
    Format,
    /// MATLAB's newer format.
    #[error("is a MAT file of version 7.3, which is HDF5: expected level 5, which `save -v7` writes")]
    Hdf5,
    /// A sheet that is asked for and is not there.
    #[error("has no sheet `{0}`; it has {1}")]
    Sheet(String, String),
    /// A channel that the recording does not have.
    #[error("has {all} analog channels, expected `{name}` in channel {number}")]
    Channel {
        /// The muscle.
        name: String,
        /// Counted from 1.
        number: usize,
        /// As many as there are.
        all: usize,
    },
    /// A binary file whose parts contradict each other.
    #[error("is damaged: {0}")]
    Damaged(&'static str),
    /// Bytes that are no text.
    #[error("is no UTF-8 text")]
    Text,
    /// A part of the header is missing.
    #[error("has no {0}")]
    Missing(&'static str),
    /// A row of the wrong length.
    #[error("line {line} has {found} cells, expected {expected}")]
    Cells {
        /// From 1.
        line: usize,
        /// Columns of the head.
        expected: usize,
        /// As it is.
        found: usize,
    },
    /// A cell that is no number.
    #[error("line {line}: expected a number, found `{found}`")]
    Number {
        /// From 1.
        line: usize,
        /// The cell.
        found: String,
    },
    /// More than is read.
    #[error("has more numbers than are read")]
    Large,
    /// A variable that is asked for and is not there.
    #[error("has no variable `{0}`; it has {1}")]
    Variable(String, String),
    /// A column that is asked for and is not there.
    #[error("has no column `{0}`; it has {1}")]
    Column(String, String),
}

impl Recording {
    /// Reads the bytes of a file of that name.
    ///
    /// # Errors
    /// Another format, or a damaged file.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, RecordingError> {
        let text = || str::from_utf8(bytes).map_err(|_| RecordingError::Text);
        match name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).as_deref() {
            Some("sto" | "mot") => storage::read(text()?),
            Some("trc") => trc::read(text()?),
            Some("csv" | "tsv") => csv::read(text()?),
            Some("c3d") => c3d::read(bytes),
            _ => Err(RecordingError::Format),
        }
    }

    /// The column of that name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.names.iter().position(|known| known == name).map(|place| self.columns[place].as_slice())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Columns as envelopes of muscles, each pair a muscle and the column that it is compared with. Rows are at equal distances over a
    /// cycle; those whose cell is empty are left out.
    ///
    /// # Errors
    /// A column that does not exist.
    pub fn envelopes(&self, pairs: &[(String, String)]) -> Result<Vec<Envelope>, RecordingError> {
        let envelope = |(muscle, column): &(String, String)| {
            let values = self.column(column).ok_or_else(|| RecordingError::Column(column.clone(), self.names.join(", ")))?;
            let (muscle, column) = (muscle.clone(), column.clone());
            Ok(Envelope { muscle, column, values: values.iter().copied().filter(|value| value.is_finite()).collect() })
        };
        pairs.iter().map(envelope).collect()
    }

    /// Appends a row.
    fn push(&mut self, line: usize, cells: &[&str]) -> Result<(), RecordingError> {
        if cells.len() != self.names.len() {
            return Err(RecordingError::Cells { line, expected: self.names.len(), found: cells.len() });
        }
        if self.rows().saturating_mul(self.names.len()) > MOST_NUMBERS {
            return Err(RecordingError::Large);
        }
        self.columns.resize(self.names.len(), Vec::new());
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            let empty = cell.is_empty() || cell.eq_ignore_ascii_case("nan");
            let value = if empty { Ok(f64::NAN) } else { cell.parse() };
            column.push(value.map_err(|_| RecordingError::Number { line, found: cell.chars().take(40).collect() })?);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
