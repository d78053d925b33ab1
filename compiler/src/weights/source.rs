//! Weights in a text: where they stand, and how they are changed without touching anything else.

use super::{Bounds, written};
use crate::diagnostics::{Diagnostic, FileId, Severity, Span, nearest};
use crate::syntax::parse;
use crate::syntax::tree::{self, Item, Task, TaskStatement, walk};

/// A weight of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The task it belongs to.
    pub task: String,
    /// Its term.
    pub term: String,
    /// Its value.
    pub value: f64,
    /// What a tuner may do with it.
    pub bounds: Bounds,
    /// The sign and the digits.
    pub span: Span,
}

/// A wish.
#[derive(Debug, Clone, PartialEq)]
pub struct Edit {
    /// `pose`, or `stand.pose` where several tasks have a term of that name.
    pub term: String,
    /// The new weight.
    pub value: f64,
}

/// A weight that changed.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Change {
    /// The task.
    pub task: String,
    /// The term.
    pub term: String,
    /// Before.
    pub from: f64,
    /// After.
    pub to: f64,
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
    #[error("there is no term `{term}` with a weight{}", said(.nearest))]
    Unknown {
        /// As wished.
        term: String,
        /// Which may have been meant.
        nearest: Vec<String>,
    },
    /// Several tasks have it.
    #[error("several tasks have a term `{term}`: say {}", .tasks.iter().map(|task| format!("`{task}.{term}`")).collect::<Vec<_>>().join(" or "))]
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
    /// No number.
    #[error("the weight of `{term}` must be a finite number, not {value}")]
    NotFinite {
        /// As wished.
        term: String,
        /// As wished.
        value: f64,
    },
    /// The author does not allow it.
    #[error("{task}.{term} may not become {}: it is {} and {}", written(*.wished), written(*.now), allowed(*.bounds, *.now))]
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

fn said(nearest: &[String]) -> String {
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

/// The weights of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// In the order of the text.
    pub entries: Vec<Entry>,
}

impl Weights {
    /// The weights of a text.
    ///
    /// # Errors
    /// The syntax errors of a text that cannot be read whole: an edit of half a file could miss what it means.
    pub fn of(file: FileId, text: &str) -> Result<Self, Vec<Diagnostic>> {
        let parsed = parse(file, text);
        if parsed.has_errors() {
            return Err(parsed.diagnostics.into_iter().filter(|told| told.severity == Severity::Error).collect());
        }
        let mut entries = Vec::new();
        for item in &parsed.tree.items {
            if let Item::Task(task) = item {
                entries.extend(weights_of(task));
            }
        }
        Ok(Self { entries })
    }

    /// The entry of `term`, which may be qualified by its task.
    ///
    /// # Errors
    /// None or several.
    pub fn find(&self, term: &str) -> Result<usize, Problem> {
        let fits = |entry: &Entry| match term.split_once('.') {
            Some((task, term)) => entry.task == task && entry.term == term,
            None => entry.term == term,
        };
        let found: Vec<usize> = (0..self.entries.len()).filter(|index| fits(&self.entries[*index])).collect();
        match found.as_slice() {
            [only] => Ok(*only),
            [] => {
                let qualified = |entry: &Entry| format!("{}.{}", entry.task, entry.term);
                let names: Vec<String> = if term.contains('.') {
                    self.entries.iter().map(qualified).collect()
                } else {
                    self.entries.iter().map(|entry| entry.term.clone()).collect()
                };
                let near = nearest(term, names.iter().map(String::as_str)).into_iter().map(str::to_owned).collect();
                Err(Problem::Unknown { term: term.to_owned(), nearest: near })
            }
            several => {
                let tasks = several.iter().map(|index| self.entries[*index].task.clone()).collect();
                Err(Problem::Ambiguous { term: term.to_owned(), tasks })
            }
        }
    }

    /// Makes all `edits` of `text`, which these are the weights of, or none: the new text, and what changed.
    ///
    /// # Errors
    /// Every wish that cannot be fulfilled.
    pub fn edit(&self, text: &str, edits: &[Edit]) -> Result<(String, Vec<Change>), Refused> {
        let mut wished: Vec<Option<f64>> = vec![None; self.entries.len()];
        let mut problems = Vec::new();
        for edit in edits {
            match self.find(&edit.term) {
                Err(problem) => problems.push(problem),
                Ok(index) => {
                    if let Some(problem) = self.problem(index, edit) {
                        problems.push(problem);
                    } else if wished[index].replace(edit.value).is_some() {
                        problems.push(Problem::Twice { term: edit.term.clone() });
                    }
                }
            }
        }
        if !problems.is_empty() {
            return Err(Refused(problems));
        }
        let mut edited = String::with_capacity(text.len());
        let mut changes = Vec::new();
        let mut at = 0;
        for (entry, wish) in self.entries.iter().zip(wished) {
            let Some(to) = wish.filter(|to| *to != entry.value) else { continue };
            edited.push_str(&text[at..entry.span.start as usize]);
            edited.push_str(&written(to));
            at = entry.span.end as usize;
            changes.push(Change { task: entry.task.clone(), term: entry.term.clone(), from: entry.value, to });
        }
        edited.push_str(&text[at..]);
        Ok((edited, changes))
    }

    fn problem(&self, index: usize, edit: &Edit) -> Option<Problem> {
        let entry = &self.entries[index];
        if !edit.value.is_finite() {
            return Some(Problem::NotFinite { term: edit.term.clone(), value: edit.value });
        }
        if entry.bounds.allow(entry.value, edit.value) {
            return None;
        }
        let (task, term) = (entry.task.clone(), entry.term.clone());
        Some(Problem::OutOfBounds { task, term, now: entry.value, wished: edit.value, bounds: entry.bounds })
    }
}

fn weights_of(task: &Task) -> impl Iterator<Item = Entry> + '_ {
    let rewards = task.statements.iter().filter_map(|statement| match statement {
        TaskStatement::Reward(reward) => Some(reward),
        _ => None,
    });
    rewards.flat_map(|reward| walk::items(&reward.terms)).filter_map(|term| {
        let weight = term.weight.as_ref()?;
        let bounds = match weight.bounds {
            tree::Bounds::Free => Bounds::Free,
            tree::Bounds::Fixed(_) => Bounds::Fixed,
            tree::Bounds::Range { low, high, .. } => Bounds::Range(low, high),
        };
        Some(Entry { task: task.name.text.clone(), term: term.name.text.clone(), value: weight.value, bounds, span: weight.span })
    })
}
