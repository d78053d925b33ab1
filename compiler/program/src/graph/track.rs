//! What a graph reads of a motion.

use crate::motion::Motion;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Columns of a motion, or their rates, at a time.
#[derive(Debug, Clone)]
pub struct Track {
    /// The motion.
    pub motion: Arc<Motion>,
    /// Which of its columns.
    pub columns: Vec<usize>,
    /// Whether their rates are read.
    pub rates: bool,
}

impl Track {
    /// Writes the columns at `time`, s, in SI units.
    #[inline]
    pub fn read(&self, time: f64, out: &mut [f64]) {
        for (value, &column) in out.iter_mut().zip(&self.columns) {
            *value = if self.rates { self.motion.rate(column, time) } else { self.motion.value(column, time) };
        }
    }

    /// Between which values each column stays; `None` for those that go on for ever.
    pub fn ranges(&self) -> impl Iterator<Item = Option<[f64; 2]>> + '_ {
        self.columns.iter().map(|&column| match (self.rates, self.motion.advance(column) != 0.0) {
            (true, _) => Some(self.motion.rate_range(column)),
            (false, false) => Some(self.motion.range(column)),
            (false, true) => None,
        })
    }

    fn identity(&self) -> (&str, &[usize], bool) {
        (self.motion.digest(), &self.columns, self.rates)
    }
}

// Two tracks are equal if they read the same numbers: the names of their files do not matter.

impl PartialEq for Track {
    fn eq(&self, other: &Self) -> bool {
        self.identity() == other.identity()
    }
}

impl Eq for Track {}

impl Hash for Track {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.identity().hash(state);
    }
}
