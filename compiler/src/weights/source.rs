//! Weights in a text: where they stand, and how they are changed without touching anything else.

use super::{Bounds, Change, Problem, Refused, written};
use crate::diagnostics::{Diagnostic, FileId, Severity, Span, nearest};
use crate::syntax::parse;
use crate::syntax::tree::{self, Item, Task, TaskStatement, walk};
use crate::task::CompiledTask;
use std::sync::Arc;

/// A weight of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The task it belongs to.
    pub task: String,
    /// Its term.
    pub term: String,
    /// Its value; of a scheduled weight the last one, which alone is edited.
    pub value: f64,
    /// The first value of a scheduled weight.
    pub from: Option<f64>,
    /// Its sign and digits as they stand in the text.
    pub digits: String,
    /// What a tuner may do with it.
    pub bounds: Bounds,
    /// Where the sign and the digits stand.
    pub span: Span,
}

/// A wish.
#[derive(Debug, Clone, PartialEq)]
pub struct Edit {
    /// `pose`, or `stand.pose` where several tasks have a term of that name.
    pub term: String,
    /// The new weight.
    pub value: f64,
    /// How it shall be written, where the shortest digits will not do: `10.0`.
    pub digits: Option<String>,
}

impl Edit {
    /// The wish that `term` become `value`.
    pub fn new(term: impl Into<String>, value: f64) -> Self {
        Self { term: term.into(), value, digits: None }
    }
}

/// The weights of a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// In the order of the text.
    pub entries: Vec<Entry>,
    /// Whether a task of the text extends another, whose ranges then hold for weights that are written alone.
    pub inherits: bool,
}

impl Weights {
    /// The weights of a text.
    ///
    /// # Errors
    /// The syntax errors of a text that cannot be read whole: an edit of half a file could miss what it means.
    pub fn of(file: FileId, text: &str) -> Result<Self, Vec<Diagnostic>> {
        let parsed = parse(file, text);
        if parsed.has_errors() {
            return Err(parsed.diagnostics.into_iter().filter(|diagnostic| diagnostic.severity == Severity::Error).collect());
        }
        let (mut entries, mut inherits) = (Vec::new(), false);
        for item in &parsed.tree.items {
            if let Item::Task(task) = item {
                inherits |= task.extends.is_some();
                entries.extend(weights_of(task, text));
            }
        }
        Ok(Self { entries, inherits })
    }

    /// Takes over the bounds that weights have from the tasks that theirs extend, which the text alone does not show.
    pub fn bounded_by(&mut self, tasks: &[Arc<CompiledTask>]) {
        for entry in self.entries.iter_mut().filter(|entry| entry.bounds == Bounds::Free) {
            let task = tasks.iter().find(|task| task.name == entry.task);
            if let Some((task, Ok(term))) = task.map(|task| (task, task.find_term(&entry.term))) {
                entry.bounds = task.weight_bounds(term);
            }
        }
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
        let mut wished: Vec<Option<(f64, String)>> = vec![None; self.entries.len()];
        let mut problems = Vec::new();
        for edit in edits {
            match self.find(&edit.term) {
                Err(problem) => problems.push(problem),
                Ok(index) => {
                    let digits = self.digits(index, edit);
                    if let Some(problem) = self.problem(index, edit) {
                        problems.push(problem);
                    } else if wished[index].replace((edit.value, digits)).is_some() {
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
            let Some((to, digits)) = wish.filter(|(to, digits)| *to != entry.value || *digits != entry.digits) else { continue };
            edited.push_str(&text[at..entry.span.start as usize]);
            edited.push_str(&digits);
            at = entry.span.end as usize;
            let (task, term, was) = (entry.task.clone(), entry.term.clone(), entry.digits.clone());
            changes.push(Change { task, term, from: entry.value, to, was });
        }
        edited.push_str(&text[at..]);
        Ok((edited, changes))
    }

    fn problem(&self, index: usize, edit: &Edit) -> Option<Problem> {
        let entry = &self.entries[index];
        Problem::of(&edit.term, edit.value, (&entry.task, &entry.term), entry.value, entry.bounds)
    }

    /// How the wish is written: as given, if that reads as the number; as it is, if nothing changes; else in the shortest way.
    fn digits(&self, index: usize, edit: &Edit) -> String {
        let entry = &self.entries[index];
        match &edit.digits {
            Some(digits) if digits.parse() == Ok(edit.value) => digits.clone(),
            _ if edit.value == entry.value => entry.digits.clone(),
            _ => written(edit.value),
        }
    }
}

fn weights_of<'a>(task: &'a Task, text: &'a str) -> impl Iterator<Item = Entry> + 'a {
    let rewards = task.statements.iter().filter_map(|statement| match statement {
        TaskStatement::Reward(reward) => Some(reward),
        _ => None,
    });
    rewards.flat_map(|reward| walk::items(&reward.terms)).filter_map(move |term| {
        let weight = term.weight.as_ref()?;
        let bounds = match weight.bounds {
            tree::Bounds::Free => Bounds::Free,
            tree::Bounds::Fixed(_) => Bounds::Fixed,
            tree::Bounds::Range { low, high, .. } => Bounds::Range(low, high),
        };
        Some(Entry {
            task: task.name.text.clone(),
            term: term.name.text.clone(),
            value: weight.value,
            from: weight.schedule.as_ref().map(|schedule| schedule.from),
            digits: weight.span.of(text).to_owned(),
            bounds,
            span: weight.span,
        })
    })
}
