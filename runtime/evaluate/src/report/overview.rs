//! The one table that an evaluation ends with: tasks by family, means, coverage.

use super::table::{Table, as_code, cut};
use super::{endings, label, percent, spread, success};
use crate::{GroupSummary, Spread, Summary, TaskSummary};
use core::fmt::Write;
use msk_text::in_one_line;

/// Widest line of the overview: a terminal of the usual width shows it whole.
const WIDTH: usize = 80;
/// Most tasks of which the first fault is shown.
const FAULTS: usize = 3;

/// The overview, for a screen of 80 columns: terms, metrics and whatever does not fit stand in the [report](super::markdown).
pub fn overview(summary: &Summary) -> String {
    let mut text = format!("{}\n\n", cut(&super::heading(summary), WIDTH));
    let mut table = Table::new(&["task", "success [95 %]", "return", "horizon", "ended by"]);
    let several = summary.tasks.len() > 1;
    for family in &summary.families {
        let tasks = summary.tasks.iter().filter(|task| task.family == family.name);
        if several {
            table.row(means(family));
        }
        for task in tasks {
            let name = format!("{}{}", if several { "  " } else { "" }, label(task, summary.protocol.episodes));
            match &task.skipped {
                Some(reason) => table.remark(name, format!("skipped: {reason}")),
                None => table.row(cells(name, task)),
            }
        }
    }
    if several {
        table.row(means(&summary.overall));
    }
    text.push_str(&table.plain(WIDTH));
    text.push_str("\n[ ]: Wilson's interval; horizon: mean fraction of it that an episode lasted\n");
    let faulty: Vec<&TaskSummary> = summary.tasks.iter().filter(|task| !task.faults.is_empty()).collect();
    for task in faulty.iter().take(FAULTS) {
        let [(episode, fault), ..] = task.faults.as_slice() else { continue };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}",
            cut(&format!("Fault in {}, episode {episode}: {}", as_code(&task.task), in_one_line(fault)), WIDTH)
        );
    }
    if faulty.len() > FAULTS {
        let _ = writeln!(text, "Faults in {} more tasks", faulty.len() - FAULTS);
    }
    let _ = writeln!(text, "{}", coverage(summary));
    text
}

/// Tasks with a success, and how much of what was asked for has been played.
pub(super) fn coverage(summary: &Summary) -> String {
    let successful = summary.tasks.iter().filter(|task| task.successes > 0).count();
    let episodes: u64 = summary.tasks.iter().map(|task| task.episodes).sum();
    let tasks = summary.tasks.len();
    let skipped = match summary.tasks.iter().filter(|task| task.skipped.is_some()).count() {
        0 => String::new(),
        1 => ", 1 task skipped".to_owned(),
        skipped => format!(", {skipped} tasks skipped"),
    };
    let planned = summary.protocol.episodes.saturating_mul(tasks as u64);
    format!("Coverage: success in {successful} of {tasks} tasks; played: {episodes} of {planned} episodes{skipped}")
}

/// The name of a group, with the number of tasks that its means are of where that is not all of them.
pub(super) fn group(summary: &GroupSummary) -> String {
    let name = if summary.name.is_empty() { "no family" } else { &summary.name };
    match summary.evaluated == summary.tasks {
        true => name.to_owned(),
        false => format!("{name} ({} of {})", summary.evaluated, summary.tasks),
    }
}

fn means(summary: &GroupSummary) -> Vec<String> {
    vec![group(summary), percent(summary.success_rate), String::new(), percent(summary.horizon_part), String::new()]
}

fn cells(name: String, task: &TaskSummary) -> Vec<String> {
    let total = task.total.map(|total| Spread { deviation: None, ..total });
    vec![name, success(task), spread(total), percent(task.horizon_part()), endings(&task.ended_by, 1)]
}
