//! Weights: proposed, and written.

use crate::confine::Outside;
use crate::project::{Failure, Project};
use msk_compiler::compile::Compilation;
use msk_compiler::task::{CompiledTask, Origin};
use msk_compiler::weights::rules::{Rules, Weight};
use msk_compiler::weights::{Bounds, Edit, Weights};
use msk_storage::StorageError;
use msk_tuning::overlay::{EditError, Wish, edited, wished};
use msk_tuning::store::{Store, StoreError};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// What `propose_weights` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Propose {
    /// Name of the task.
    pub task: String,
    /// File with the task, relative to the project; tasks.msk if it is left out.
    pub file: Option<String>,
    /// Weights file over it, if one is in use.
    pub overlay: Option<String>,
    /// The weights that are wished for, by term.
    pub weights: BTreeMap<String, f64>,
    /// Largest relative change of a weight; 0.2 if it is left out.
    pub step: Option<f64>,
    /// Sum of the sizes of all weights in scope that must be kept, if any.
    pub norm: Option<f64>,
    /// Terms that stay and do not count in the norm.
    #[serde(default)]
    pub outside: Vec<String>,
}

/// What `apply_weights` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Apply {
    /// File with the tasks, relative to the project.
    pub file: String,
    /// Weights by `term` or `task.term`.
    pub weights: BTreeMap<String, f64>,
    /// Weights file to write instead of the source, relative to the project.
    pub overlay: Option<String>,
    /// Nothing is written unless this is false.
    pub dry_run: Option<bool>,
}

/// One weight as an agent sees it.
pub fn term(task: &CompiledTask, index: usize) -> Value {
    let term = &task.terms[index];
    let [low, high] = task.term_range(index).map(|bound| bound.is_finite().then_some(bound));
    json!({
        "term": term.name,
        "weight": term.weight,
        "weight_in_source": term.written,
        "weight_from": term.origin.to_string(),
        "weight_may_be": task.weight_bounds(index).described(term.written),
        "value_range": [low, high],
        "value_unit": "none",
        "formula": term.source,
    })
}

/// What the rules of change make of a wish. Nothing is written.
pub fn propose(project: &Project, asked: &Propose) -> Result<Value, Failure> {
    let task = project.task(asked.file.as_deref(), &asked.task, asked.overlay.as_deref())?;
    let mut wishes: Vec<f64> = task.weights();
    for (name, weight) in &asked.weights {
        wishes[task.find_term(name)?] = *weight;
    }
    let outside = asked.outside.iter().map(|name| task.find_term(name)).collect::<Result<Vec<_>, _>>()?;
    let weight = |(index, value): (usize, &f64)| {
        let bounds = task.weight_bounds(index);
        Weight { value: *value, bounds, in_scope: bounds != Bounds::Fixed && !outside.contains(&index) }
    };
    let present = task.weights();
    let weights: Vec<Weight> = present.iter().enumerate().map(weight).collect();
    let rules = Rules { step: asked.step.unwrap_or(Rules::default().step), norm: asked.norm };
    let allowed = rules.constrain(&weights, &wishes)?;
    let row = |index: usize| json!({ "term": task.terms[index].name, "now": present[index], "wished": wishes[index], "allowed": allowed[index] });
    let changed: BTreeMap<&str, f64> = (0..allowed.len())
        .filter(|&index| allowed[index] != present[index])
        .map(|index| (task.terms[index].name.as_str(), allowed[index]))
        .collect();
    Ok(json!({
        "task": task.name,
        "rules": { "step": rules.step, "norm": rules.norm },
        "terms": (0..allowed.len()).map(row).collect::<Vec<_>>(),
        "apply": changed,
    }))
}

/// Writes weights, within the bounds of the source, or returns what it would write.
pub fn apply(project: &Project, asked: &Apply) -> Result<Value, Failure> {
    let dry_run = asked.dry_run.unwrap_or(true);
    let compilation = project.compile(&asked.file)?;
    let changes = match &asked.overlay {
        Some(overlay) => into_overlay(project, &compilation, asked, overlay, dry_run)?,
        None => into_source(project, &compilation, asked, dry_run)?,
    };
    let file = asked.overlay.as_deref().unwrap_or(&asked.file);
    let hint = if dry_run { "nothing was written: pass `dry_run: false` to write it" } else { "written" };
    Ok(json!({ "file": file, "written": !dry_run, "changes": changes, "note": hint }))
}

#[derive(Debug, thiserror::Error)]
enum WriteError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Edit(#[from] EditError),
    #[error(transparent)]
    Refused(#[from] msk_compiler::weights::Refused),
    #[error("the file has errors: check it first")]
    Syntax,
}

fn into_overlay(
    project: &Project,
    compilation: &Compilation,
    asked: &Apply,
    overlay: &str,
    dry_run: bool,
) -> Result<Value, Failure> {
    let path = Path::new(overlay);
    if path.extension().is_none_or(|ending| ending != "toml") {
        return Err(Failure(json!({ "error": format!("a weights file ends in .toml, `{overlay}` does not") })));
    }
    let wishes: Vec<Wish> = asked.weights.iter().map(|(term, weight)| Wish { term: term.clone(), weight: *weight }).collect();
    let places = wished(&compilation.tasks, &wishes, &Origin::CommandLine)?.places;
    // The content of the file now counts as what is before.
    let store = store(project, path)?;
    let present = store.read()?;
    let before = if present.is_some() { project.overlaid(compilation, overlay)? } else { compilation.tasks.clone() };
    let weights: Vec<(&str, &str, f64)> = wishes
        .iter()
        .zip(&places)
        .map(|(wish, &(task, term))| (before[task].name.as_str(), before[task].terms[term].name.as_str(), wish.weight))
        .collect();
    let rows: Vec<Value> = weights
        .iter()
        .zip(&places)
        .map(|((task, term, weight), &(at, index))| {
            json!({ "task": task, "term": term, "from": before[at].terms[index].weight, "to": weight })
        })
        .collect();
    if dry_run {
        edited(&present.map(|version| version.text).unwrap_or_default(), &weights)?;
    } else {
        store.change::<(), WriteError>("mcp", |version| Ok((edited(&version.text, &weights)?, ())))?;
    }
    Ok(rows.into())
}

fn into_source(project: &Project, compilation: &Compilation, asked: &Apply, dry_run: bool) -> Result<Value, Failure> {
    let store = store(project, Path::new(&asked.file))?;
    let edits: Vec<Edit> = asked.weights.iter().map(|(term, weight)| Edit::new(term, *weight)).collect();
    let edit = |text: &str| {
        let mut weights = Weights::of(Default::default(), text).map_err(|_| WriteError::Syntax)?;
        weights.bounded_by(&compilation.tasks);
        Ok::<_, WriteError>(weights.edit(text, &edits)?)
    };
    if dry_run {
        let text = store.read()?.map(|version| version.text).unwrap_or_default();
        return Ok(json!(edit(&text)?.1));
    }
    let changes = store.edit("mcp", |version| edit(&version.text))?;
    Ok(json!(changes))
}

/// The store of a file of the project. It is opened beneath the project's folder, so that a folder which is exchanged for a link
/// meanwhile leads nowhere.
fn store(project: &Project, path: &Path) -> Result<Store, Failure> {
    let store = Store::new(project.confined.folder(), &project.confined.spelled(path));
    store.map_err(|error| match error {
        StoreError::Storage(StorageError::Outside { .. }) => Outside::Escapes(path.into()).into(),
        other => other.into(),
    })
}
