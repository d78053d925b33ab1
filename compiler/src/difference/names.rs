//! Which names of a formula mean something else, as their declarations are written.

use super::NameChange;
use crate::task::CompiledTask;
use msk_program::debug::Definition;
use std::collections::{BTreeMap, BTreeSet};

/// The names that `formula` names, directly or through other names, whose declarations differ.
pub(super) fn unlike(formula: &str, before: &CompiledTask, after: &CompiledTask) -> Vec<NameChange> {
    let (old, new) = (declared(before), declared(after));
    let mut pending: Vec<String> = words(formula).rev().map(str::to_owned).collect();
    let (mut seen, mut found) = (BTreeSet::new(), Vec::new());
    while let Some(name) = pending.pop() {
        let (Some(before), Some(after)) = (old.get(name.as_str()), new.get(name.as_str())) else { continue };
        if !seen.insert(name.clone()) {
            continue;
        }
        pending.extend(words(after).map(str::to_owned));
        if before != after {
            found.push(NameChange { name, before: before.clone(), after: after.clone() });
        }
    }
    found
}

/// What each declared name of a task is, as it is written; of several phases the first that declares it counts.
fn declared(task: &CompiledTask) -> BTreeMap<&str, String> {
    let mut known = BTreeMap::new();
    for definition in task.phases.iter().flat_map(|phase| &phase.debug.definitions) {
        known.entry(definition.name.as_str()).or_insert_with(|| written(definition));
    }
    known
}

fn written(definition: &Definition) -> String {
    let parts = definition.parts.iter().map(|(word, formula)| format!("{word} {}", formula.plain).trim_start().to_owned());
    parts.collect::<Vec<_>>().join(" ")
}

/// The names in a formula as it is written.
fn words(formula: &str) -> impl DoubleEndedIterator<Item = &str> {
    let apart = formula.split(|letter: char| !(letter.is_alphanumeric() || letter == '_'));
    apart.filter(|word| word.starts_with(|letter: char| letter.is_alphabetic()))
}
