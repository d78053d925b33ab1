//! Tracking error: e = sqrt(mean over rows of e(t)²), m, where e(t) is the root mean square distance, per coordinate, of the body's
//! landmarks from where the reference motion of the task has them at the time.
//!
//! Rows are the reset and every control step at which the task follows a motion; without one there is no metric. It is the tracking error
//! of direct control and of imitation (Peng et al., "DeepMimic", ACM Trans. Graph. 37, 2018, compare places of end effectors likewise).

use crate::trace::{Quantity, Row};

/// Sums up squares of errors.
#[derive(Debug, Clone, Default)]
pub(super) struct Tracking {
    squares: f64,
    rows: u32,
}

impl Tracking {
    pub fn look(&mut self, row: &Row<'_>) {
        if let [error] = *row.of(Quantity::TrackingError)
            && error.is_finite()
        {
            self.squares += error * error;
            self.rows += 1;
        }
    }

    /// The error, m; `None` of a task that follows nothing.
    pub fn finish(&self) -> Option<f64> {
        (self.rows > 0).then(|| (self.squares / f64::from(self.rows)).sqrt())
    }
}
