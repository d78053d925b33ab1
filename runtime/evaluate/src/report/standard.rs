//! Standard metrics and recruitment, all tasks in a table.

use super::Table;
use crate::TaskSummary;
use msk_text::numbers::{fixed, for_people};

/// Columns of the first table: heads and metrics.
const EFFORT: [(&str, &str); 6] = [
    ("activation", "activation_cost"),
    ("smoothness", "joint_smoothness"),
    ("W/kg", "metabolic_power"),
    ("transport", "cost_of_transport"),
    ("ground", "peak_ground_reaction"),
    ("joint", "peak_joint_reaction"),
];
/// Columns of the second table.
const GAIT: [(&str, &str); 5] = [
    ("steps/min", "cadence"),
    ("length, m", "step_length"),
    ("stance", "stance_share"),
    ("length asym.", "step_length_asymmetry"),
    ("stance asym.", "stance_asymmetry"),
];
/// Tasks that fit beside each other.
const BESIDE: usize = 4;
/// Families that are named of each task, where more tasks do not fit beside each other.
const NAMED: usize = 3;

/// The tables, each below its heading; empty if no episode has a standard metric.
pub(super) fn markdown(tasks: &[TaskSummary]) -> String {
    let mut text = String::new();
    let mut section = |title: &str, table: Option<Table>, words: &str| {
        if let Some(table) = table {
            text.push_str(&format!("\n## {title}\n\n{}\n{words}\n", table.markdown()));
        }
    };
    section(
        "Standard metrics",
        numbers(tasks, &EFFORT),
        "Activation: mean squared activation. Smoothness: log10 of the mean squared angular jerk,\nrad^2/s^6. W/kg: metabolic power. Transport: cost of transport. Ground, joint: largest reactions,\nbody weights. Means over episodes.",
    );
    section("Gait", numbers(tasks, &GAIT), "Asymmetry: |l - r| over the mean of both feet; 0 is symmetric.");
    section(
        "Tracking",
        numbers(tasks, &[("error, m", "tracking_error")]),
        "Root mean square distance, per coordinate, of the landmarks from where the reference motion has them.",
    );
    section(
        "Recruitment",
        recruitment(tasks),
        "Sum over a family's muscles of their mean activations, and its part of that of all families.",
    );
    text
}

/// The tasks that have one of the metrics.
fn numbers(tasks: &[TaskSummary], columns: &[(&str, &str)]) -> Option<Table> {
    let value =
        |task: &TaskSummary, name: &str| task.standard.iter().find(|known| known.name == name).map(|known| known.value.mean);
    let mut head = vec!["task"];
    head.extend(columns.iter().map(|(head, _)| head));
    let mut table = Table::new(&head);
    let mut any = false;
    for task in tasks {
        let values: Vec<Option<f64>> = columns.iter().map(|(_, name)| value(task, name)).collect();
        if values.iter().any(Option::is_some) {
            any = true;
            let cells = values.into_iter().map(|value| value.map_or("-".into(), for_people));
            table.row([task.task.clone()].into_iter().chain(cells).collect());
        }
    }
    any.then_some(table)
}

/// Families as rows where the tasks fit beside each other, else the most active families of each task.
fn recruitment(tasks: &[TaskSummary]) -> Option<Table> {
    let tasks: Vec<&TaskSummary> = tasks.iter().filter(|task| !task.recruitment.is_empty()).collect();
    let first = tasks.first()?;
    let cell = |mass: f64, share: f64| format!("{} ({} %)", for_people(mass), fixed(100.0 * share, 0));
    // Bodies may differ: rows are of one family each.
    let names = |task: &TaskSummary| task.recruitment.iter().map(|family| family.name.clone()).collect::<Vec<_>>();
    if tasks.len() <= BESIDE && tasks.iter().all(|task| names(task) == names(first)) {
        let head: Vec<&str> = ["family"].into_iter().chain(tasks.iter().map(|task| task.task.as_str())).collect();
        let mut table = Table::new(&head);
        for (place, family) in first.recruitment.iter().enumerate() {
            let cells = tasks.iter().map(|task| cell(task.recruitment[place].mass, task.recruitment[place].share));
            table.row([family.name.clone()].into_iter().chain(cells).collect());
        }
        return Some(table);
    }
    let mut table = Table::new(&["task", "most active", "second", "third"]);
    for task in tasks {
        let mut families = task.recruitment.clone();
        families.sort_by(|a, b| b.mass.total_cmp(&a.mass));
        let named = families.iter().map(|family| format!("{} {} %", family.name, fixed(100.0 * family.share, 0)));
        let cells = named.chain(std::iter::repeat(String::new())).take(NAMED);
        table.row([task.task.clone()].into_iter().chain(cells).collect());
    }
    Some(table)
}
