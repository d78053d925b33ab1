//! The matched comparison of settings, such as of the reasoners that tuned a reward: survival, tracking error and activation cost of
//! evaluations of one task that follows a reference motion.

use super::super::read::Source;
use super::standard;
use super::table::{Cell, Group, PaperTable, cell, head, number};
use msk::evaluate::TaskSummary;

/// A table for each task that follows a motion, if several folders have evaluated it.
pub fn tables(sources: &[Source]) -> Vec<PaperTable> {
    let tasks = |source: &'_ Source| source.summary.as_ref().map_or_else(Vec::new, |summary| summary.tasks.clone());
    let mut names: Vec<String> = Vec::new();
    for task in sources.iter().flat_map(tasks).filter(|task| standard(task, "tracking_error").is_some()) {
        if !names.contains(&task.task) {
            names.push(task.task);
        }
    }
    names.iter().filter_map(|name| table(name, sources)).collect()
}

fn table(task: &str, sources: &[Source]) -> Option<PaperTable> {
    let own = |source: &'_ Source| {
        source.summary.as_ref()?.tasks.iter().find(|known| known.task == task && known.episodes > 0).cloned()
    };
    let rows: Vec<Vec<Cell>> = sources.iter().filter_map(|source| Some(row(&source.label, &own(source)?))).collect();
    (rows.len() > 1).then(|| PaperTable {
        caption: format!("Matched comparison of settings on {task}. Means over episodes."),
        columns: "@{}lrrr@{}".into(),
        head: vec![
            ["Setting", "Survival (steps) \u{2191}", "Tracking RMSE (m) \u{2193}", "Activation \u{2193}"].map(head).into(),
        ],
        groups: vec![Group { name: None, rows }],
    })
}

fn row(label: &str, task: &TaskSummary) -> Vec<Cell> {
    let survival = task.steps.map(|steps| steps.mean);
    vec![
        cell(label),
        number(survival, 1),
        number(standard(task, "tracking_error"), 4),
        number(standard(task, "activation_cost"), 4),
    ]
}
