//! What differs between two tasks in meaning: terms, weights, ranges, thresholds, observations, ends, scene and initial state.
//!
//! Two [`Snapshot`]s are compared section by section. What is only written differently makes no difference; what is written
//! the same and means something else, because a name that it uses has changed, does.

mod constants;
mod names;
mod people;
mod text;
mod units;

use crate::snapshot::{Section, Snapshot};
use crate::task::CompiledTask;
use serde::{Deserialize, Serialize};

/// What differs between two tasks.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Difference {
    /// Name of the first task.
    pub before: String,
    /// Name of the second.
    pub after: String,
    /// In the order of the second task; what it lacks last.
    pub changes: Vec<Change>,
}

/// A section that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// How.
    pub kind: ChangeKind,
    /// What it is: `term`, `terminate`, `channel`, `object`, ...
    pub section: String,
    /// Its name; empty where there is one of its kind only.
    pub name: String,
    /// Numbers and words that differ; of what is added or removed all of them.
    pub fields: Vec<FieldChange>,
    /// How its formula differs, if it does.
    pub formula: Option<FormulaChange>,
}

/// How a section differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChangeKind {
    /// Only the second task has it.
    Added,
    /// Only the first task has it.
    Removed,
    /// Both have it, with different content.
    Changed,
    /// What both have comes in another order.
    Reordered,
}

/// A field that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldChange {
    /// Its name: `weight`, `range`, `horizon`, ...
    pub field: String,
    /// In the first task.
    pub before: Option<String>,
    /// In the second.
    pub after: Option<String>,
}

/// How a formula differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FormulaChange {
    /// As mathematics, in the first task; empty if it has none.
    pub before: String,
    /// In the second.
    pub after: String,
    /// Constants that only the first computes with, in SI units.
    pub constants_before: Vec<String>,
    /// Constants that only the second computes with.
    pub constants_after: Vec<String>,
    /// Names in it that mean something else, where it is written as before and both tasks are there as texts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<NameChange>,
}

/// A declared name that means something else.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NameChange {
    /// The name.
    pub name: String,
    /// Its formula in the first task, as it is written.
    pub before: String,
    /// In the second.
    pub after: String,
}

/// Sections whose order counts: it is that of the reports, weights and observations.
const ORDERED: [&str; 3] = ["term", "channel", "metric"];

impl Difference {
    /// What differs from `before` to `after`. Their names count only where `named`.
    pub fn between(before: &Snapshot, after: &Snapshot, named: bool) -> Self {
        let mut changes = Vec::new();
        for section in &after.sections {
            let change = match partner(before, section) {
                Some(old) => changed(old, section),
                None => Some(one_sided(ChangeKind::Added, section)),
            };
            changes.extend(change);
        }
        for section in before.sections.iter().filter(|section| partner(after, section).is_none()) {
            changes.push(one_sided(ChangeKind::Removed, section));
        }
        for kind in ORDERED {
            changes.extend(reordered(before, after, kind));
        }
        let (before, after) = (before.task().to_owned(), after.task().to_owned());
        if named && before != after {
            let name = FieldChange { field: "name".into(), before: Some(before.clone()), after: Some(after.clone()) };
            changes.insert(
                0,
                Change {
                    kind: ChangeKind::Changed,
                    section: "task".into(),
                    name: String::new(),
                    fields: vec![name],
                    formula: None,
                },
            );
        }
        Self { before, after, changes }
    }

    /// The same with the names whose formulas differ, wherever a formula that names them is written as before.
    #[must_use]
    pub fn with_names(mut self, before: &CompiledTask, after: &CompiledTask) -> Self {
        let formulas = self.changes.iter_mut().filter_map(|change| change.formula.as_mut());
        for formula in formulas.filter(|formula| formula.before == formula.after) {
            formula.names = names::unlike(&formula.after, before, after);
        }
        self
    }

    /// The same with the units of what a snapshot writes in bare SI numbers (poses, velocities and noise of joints), which `task`
    /// knows: either of the two.
    #[must_use]
    pub fn with_units(mut self, task: &CompiledTask) -> Self {
        units::write(&mut self.changes, &task.vocabulary.joints);
        self
    }

    /// Whether both mean the same.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }
}

/// The section of the other task of the same kind; of tasks there is only one.
fn partner<'a>(other: &'a Snapshot, section: &Section) -> Option<&'a Section> {
    other.sections.iter().find(|known| known.kind == section.kind && (known.name == section.name || section.kind == "task"))
}

fn one_sided(kind: ChangeKind, section: &Section) -> Change {
    let added = kind == ChangeKind::Added;
    let fields = section.fields.iter().map(|(field, value)| FieldChange {
        field: field.clone(),
        before: (!added).then(|| value.clone()),
        after: added.then(|| value.clone()),
    });
    let formula = (!section.formula.is_empty()).then(|| FormulaChange {
        before: if added { String::new() } else { section.formula.clone() },
        after: if added { section.formula.clone() } else { String::new() },
        constants_before: Vec::new(),
        constants_after: Vec::new(),
        names: Vec::new(),
    });
    Change { kind, section: section.kind.clone(), name: section.name.clone(), fields: fields.collect(), formula }
}

fn changed(before: &Section, after: &Section) -> Option<Change> {
    let mut fields = Vec::new();
    for (field, value) in &after.fields {
        let old = before.get(field);
        if old != Some(value) {
            fields.push(FieldChange { field: field.clone(), before: old.map(str::to_owned), after: Some(value.clone()) });
        }
    }
    for (field, value) in before.fields.iter().filter(|(field, _)| after.get(field).is_none()) {
        fields.push(FieldChange { field: field.clone(), before: Some(value.clone()), after: None });
    }
    let formula = (before.graph != after.graph).then(|| {
        let (constants_before, constants_after) = constants::unlike(&before.graph, &after.graph);
        let (before, after) = (before.formula.clone(), after.formula.clone());
        FormulaChange { before, after, constants_before, constants_after, names: Vec::new() }
    });
    if fields.is_empty() && formula.is_none() {
        return None;
    }
    Some(Change { kind: ChangeKind::Changed, section: after.kind.clone(), name: after.name.clone(), fields, formula })
}

/// What both tasks have of a kind, if it comes in another order.
fn reordered(before: &Snapshot, after: &Snapshot, kind: &str) -> Option<Change> {
    let order = |own: &Snapshot, other: &Snapshot| -> Vec<String> {
        let sections = own.sections.iter().filter(|section| section.kind == kind && partner(other, section).is_some());
        sections.map(|section| section.name.clone()).collect()
    };
    let (old, new) = (order(before, after), order(after, before));
    if old == new {
        return None;
    }
    let field = FieldChange { field: "order".into(), before: Some(old.join(", ")), after: Some(new.join(", ")) };
    Some(Change {
        kind: ChangeKind::Reordered,
        section: kind.to_owned(),
        name: String::new(),
        fields: vec![field],
        formula: None,
    })
}
