//! Changes of weights, and why one is refused.

use super::{Bounds, LARGEST, may_be, written};
use crate::numbers::for_people;

/// A weight that changed.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Change {
    /// The task.
    pub task: String,
    /// The term.
    pub term: String,
    /// Before.
    pub from: f64,
    /// After.
    pub to: f64,
    /// Sign and digits before, as they stood in the text: going back restores them.
    pub was: String,
}

impl core::fmt::Display for Change {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}.{}: {} -> {}", self.task, self.term, written(self.from), written(self.to))?;
        if self.from != 0.0 && self.to != 0.0 {
            let percent = 100.0 * (self.to / self.from - 1.0);
            write!(f, " ({percent:+.1} %)")?;
        }
        Ok(())
    }
}

/// Why one wish is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// No such term.
    #[error("there is no term `{term}` with a weight{}", suggestion(.nearest))]
    Unknown {
        /// As wished.
        term: String,
        /// Which may have been meant.
        nearest: Vec<String>,
    },
    /// Several tasks have it.
    #[error("several tasks have a term `{term}`: write {}", .tasks.iter().map(|task| format!("`{task}.{term}`")).collect::<Vec<_>>().join(" or "))]
    Ambiguous {
        /// As wished.
        term: String,
        /// The tasks.
        tasks: Vec<String>,
    },
    /// The same weight twice.
    #[error("`{term}` is given twice")]
    Twice {
        /// As wished.
        term: String,
    },
    /// No number, or one beyond [`LARGEST`].
    #[error("the weight of `{term}` must be a number from -{most} to {most}, not {}", for_people(*.value), most = for_people(LARGEST))]
    NotFinite {
        /// As wished.
        term: String,
        /// As wished.
        value: f64,
    },
    /// The author does not allow it.
    #[error("{task}.{term} cannot be {}: it is {} and {}", written(*.wished), written(*.now), allowed(*.bounds, *.now))]
    OutOfBounds {
        /// The task.
        task: String,
        /// The term.
        term: String,
        /// The present weight.
        now: f64,
        /// The wish.
        wished: f64,
        /// What is allowed.
        bounds: Bounds,
    },
}

impl Problem {
    /// What is wrong with the wish that the weight of `task` and `term`, which is `now`, become `value`.
    pub fn of(wished: &str, value: f64, (task, term): (&str, &str), now: f64, bounds: Bounds) -> Option<Self> {
        if !may_be(value) {
            return Some(Self::NotFinite { term: wished.to_owned(), value });
        }
        if bounds.allow(now, value) {
            return None;
        }
        Some(Self::OutOfBounds { task: task.to_owned(), term: term.to_owned(), now, wished: value, bounds })
    }
}

fn suggestion(nearest: &[String]) -> String {
    match nearest {
        [] => String::new(),
        names => format!("; did you mean {}?", names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" or ")),
    }
}

fn allowed(bounds: Bounds, now: f64) -> String {
    match bounds {
        Bounds::Fixed => "fixed".into(),
        Bounds::Range(..) => format!("may be {}", bounds.described(now)),
        Bounds::Free => format!("must stay {}", bounds.described(now)),
    }
}

/// Nothing was changed, and why: every problem at once.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct Refused(pub Vec<Problem>);
