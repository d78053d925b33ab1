//! Several policies on the same tasks, side by side.

use super::percent;
use super::table::{Table, cut};
use crate::{GroupSummary, Summary, TaskSummary};
use core::fmt::Write;
use msk_text::{in_one_line, numbers::for_people};

/// Widest line: a terminal of the usual width shows it whole.
const WIDTH: usize = 80;

/// Success rate and mean return of every task under every policy, and the means of the families. All summaries are of one list of
/// tasks; the first gives their order.
pub fn comparison(summaries: &[Summary]) -> String {
    let Some(first) = summaries.first() else { return String::new() };
    let numbers: Vec<String> = (1..=summaries.len()).map(|number| format!("({number})")).collect();
    let mut text = String::new();
    for (number, Summary { policy, protocol, .. }) in numbers.iter().zip(summaries) {
        let line = format!("{number} {policy}, {} episodes per task, seed {}", protocol.episodes, protocol.seed);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", cut(&in_one_line(&line), WIDTH));
    }
    let mut head = vec!["task"];
    for number in &numbers {
        head.extend([number, "return"]);
    }
    let mut table = Table::new(&head);
    let several = first.tasks.len() > 1;
    for (place, family) in first.families.iter().enumerate() {
        if several {
            table.row(means(&family.name, summaries.iter().map(|summary| summary.families.get(place))));
        }
        for (place, task) in first.tasks.iter().enumerate().filter(|(_, task)| task.family == family.name) {
            let mut cells = vec![format!("{}{}", if several { "  " } else { "" }, task.task)];
            for summary in summaries {
                cells.extend(summary.tasks.get(place).map_or_else(Default::default, outcome));
            }
            table.row(cells);
        }
    }
    if several {
        table.row(means("all tasks", summaries.iter().map(|summary| Some(&summary.overall))));
        table.row(coverage(summaries));
    }
    let _ = write!(text, "\n{}", table.plain(WIDTH));
    text.push_str("\nPer policy: success, mean return; -: it cannot act, or no episode has ended\n");
    text
}

/// Success and return of a task; both are missing where there are no episodes.
fn outcome(task: &TaskSummary) -> [String; 2] {
    match task.total.filter(|_| task.skipped.is_none()) {
        Some(total) => [percent(task.success_rate), for_people(total.mean)],
        None => ["-".into(), "-".into()],
    }
}

/// Tasks with a success.
fn coverage(summaries: &[Summary]) -> Vec<String> {
    let of = |summary: &Summary| {
        let successful = summary.tasks.iter().filter(|task| task.successes > 0).count();
        [format!("{successful}/{}", summary.tasks.len()), String::new()]
    };
    ["tasks with a success".to_owned()].into_iter().chain(summaries.iter().flat_map(of)).collect()
}

fn means<'a>(name: &str, groups: impl Iterator<Item = Option<&'a GroupSummary>>) -> Vec<String> {
    let name = if name.is_empty() { "no family" } else { name };
    let mut cells = vec![name.to_owned()];
    for group in groups {
        cells.extend([percent(group.and_then(|group| group.success_rate)), String::new()]);
    }
    cells
}
