//! Recruitment by family for evaluations of few tasks, such as those of the load study.

use super::table::{Cell, Group, Head, PaperTable, cell, head, number};
use msk::evaluate::{Summary, TaskSummary};

/// Most tasks beside each other.
const MOST_TASKS: usize = 6;

/// Activation mass A_k and share P_k of each muscle family, tasks beside each other; none for evaluations of many tasks.
pub fn table(summary: &Summary) -> Option<PaperTable> {
    let tasks: Vec<&TaskSummary> = summary.tasks.iter().filter(|task| !task.recruitment.is_empty()).collect();
    let first = tasks.first().filter(|_| summary.tasks.len() <= MOST_TASKS)?;
    let spans = tasks.iter().map(|task| Head { text: task.task.clone(), columns: 2 });
    let heads = tasks.iter().flat_map(|_| [head("A_k"), head("P_k (%)")]);
    let row = |name: &String| {
        let cells = tasks.iter().flat_map(|task| {
            let own = task.recruitment.iter().find(|known| known.name == *name);
            [number(own.map(|own| own.mass), 3), number(own.map(|own| 100.0 * own.share), 1)]
        });
        [cell(name.as_str())].into_iter().chain(cells).collect::<Vec<Cell>>()
    };
    Some(PaperTable {
        caption: format!("Recruitment under {}: activation mass A_k and its share P_k of all families.", summary.policy),
        columns: format!("@{{}}l{}@{{}}", "rr".repeat(tasks.len())),
        head: vec![[head("")].into_iter().chain(spans).collect(), [head("Family")].into_iter().chain(heads).collect()],
        groups: vec![Group { name: None, rows: first.recruitment.iter().map(|family| row(&family.name)).collect() }],
    })
}
