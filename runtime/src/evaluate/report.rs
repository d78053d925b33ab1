//! The summary for people: Markdown whose tables are aligned, so that a terminal shows it well and a page renders it.

use super::{MetricSummary, Spread, Summary, TaskSummary, TermSummary};
use core::fmt::Write;
use msk_compiler::numbers::{exact, for_people};

/// The whole report.
pub fn markdown(summary: &Summary) -> String {
    let protocol = summary.protocol;
    let mut text = format!("# Policy `{}`, {} episodes per task, seed {}\n\n", summary.policy, protocol.episodes, protocol.seed);
    let mut tasks = Table::new(&["task", "success [95 %]", "return", "steps", "ended by"]);
    for task in &summary.tasks {
        tasks.row(task_row(task, protocol.episodes));
    }
    text.push_str(&tasks.print());
    for task in &summary.tasks {
        faults(task, &mut text);
    }
    for task in summary.tasks.iter().filter(|task| !task.terms.is_empty()) {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n## {}: reward terms\n\n", task.task);
        let mut terms = Table::new(&["term", "weight", "value per step", "pay per step", "share"]);
        for term in &task.terms {
            terms.row(term_row(term));
        }
        text.push_str(&terms.print());
        if !task.weights_versions.is_empty() {
            let paid = task.weights_versions.iter().map(|(version, count)| format!("{version} ({count})"));
            let _ = write!(text, "\nWeights while it ran (episodes): {}\n", paid.collect::<Vec<_>>().join(", "));
        }
    }
    for task in summary.tasks.iter().filter(|task| !task.metrics.is_empty()) {
        let _ = write!(text, "\n## {}: metrics\n\n{}", task.task, metrics(&task.metrics));
    }
    text.push_str(
        "\nReturn and steps: mean ± standard deviation over episodes. Interval: Wilson's. Value: mean over all\n\
         steps; pay: weight times value; share: pay over the sum of the magnitudes of all pay.\n",
    );
    text
}

/// The first few faults in full: what broke matters more than how often.
fn faults(task: &TaskSummary, text: &mut String) {
    const SHOWN: usize = 3;
    for (episode, fault) in task.faults.iter().take(SHOWN) {
        // Writing to a string cannot fail.
        let _ = write!(text, "\nFault in `{}`, episode {episode}: {fault}\n", task.task);
    }
    if task.faults.len() > SHOWN {
        let _ = write!(text, "\n... and {} more episodes of `{}`\n", task.faults.len() - SHOWN, task.task);
    }
}

/// The terms of one episode or task alone, as a table.
pub fn terms(terms: &[TermSummary]) -> String {
    let mut table = Table::new(&["term", "weight", "value per step", "pay per step", "share"]);
    for term in terms {
        table.row(term_row(term));
    }
    table.print()
}

/// What is logged and not paid, as a table: mean over the steps, and value at the last step.
pub fn metrics(metrics: &[MetricSummary]) -> String {
    let mut table = Table::new(&["metric", "mean", "at the end"]);
    let number = |spread: Option<Spread>| match spread {
        None => "-".into(),
        Some(Spread { mean, deviation: None }) => for_people(mean),
        Some(Spread { mean, deviation: Some(deviation) }) => format!("{} ± {}", for_people(mean), for_people(deviation)),
    };
    for metric in metrics {
        table.row(vec![metric.name.clone(), number(metric.mean), number(metric.last)]);
    }
    table.print()
}

fn task_row(task: &TaskSummary, planned: u64) -> Vec<String> {
    let [low, high] = task.success_interval.map(|bound| format!("{:.0}", 100.0 * bound));
    vec![
        if task.episodes == planned { task.task.clone() } else { format!("{}, {} so far", task.task, task.episodes) },
        task.success_rate.map_or("-".into(), |rate| format!("{:.0} % [{low}, {high}]", 100.0 * rate)),
        spread(task.total),
        spread(task.steps),
        endings(&task.ended_by),
    ]
}

/// The two most frequent ends, and how many episodes ended otherwise.
fn endings(ended_by: &[(String, u64)]) -> String {
    let named = ended_by.iter().take(2).map(|(reason, count)| format!("{reason} {count}"));
    let others: u64 = ended_by.iter().skip(2).map(|(_, count)| count).sum();
    named.chain((others > 0).then(|| format!("other {others}"))).collect::<Vec<_>>().join(", ")
}

fn term_row(term: &TermSummary) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or("-".into(), for_people);
    vec![
        term.name.clone(),
        exact(term.weight),
        number(term.value_per_step),
        number(term.pay_per_step),
        term.share.map_or("-".into(), |share| format!("{:.2} %", 100.0 * share)),
    ]
}

/// One decimal, or none where the numbers are large, or powers of ten where they are very large.
fn spread(spread: Option<Spread>) -> String {
    let Some(Spread { mean, deviation }) = spread else { return "-".into() };
    if !mean.is_finite() || mean.abs() >= 1e6 {
        let deviation = deviation.map_or(String::new(), |deviation| format!(" ± {}", for_people(deviation)));
        return for_people(mean) + &deviation;
    }
    let decimals = usize::from(mean.abs() < 1000.0);
    let deviation = deviation.map_or(String::new(), |deviation| format!(" ± {deviation:.decimals$}"));
    format!("{mean:.decimals$}{deviation}")
}

/// A Markdown table with aligned columns: words to the left, numbers to the right.
struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    fn new(head: &[&str]) -> Self {
        Self { rows: vec![head.iter().map(|&title| title.into()).collect()] }
    }

    fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    fn print(&self) -> String {
        let columns = self.rows.first().map_or(0, Vec::len);
        let width = |column: usize| self.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let left = |column: usize| column == 0 || self.rows[0][column] == "ended by";
        let mut text = String::new();
        for (index, row) in self.rows.iter().enumerate() {
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                // Writing to a string cannot fail.
                let _ = if left(column) { write!(text, "| {cell:<width$} ") } else { write!(text, "| {cell:>width$} ") };
            }
            text.push_str("|\n");
            if index == 0 {
                for (column, &width) in widths.iter().enumerate() {
                    let rule = "-".repeat(width);
                    text.push_str(&if left(column) { format!("|:{rule}-") } else { format!("|-{rule}:") });
                }
                text.push_str("|\n");
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Protocol, wilson_interval};
    use super::*;

    #[test]
    fn the_report_fits_a_terminal_and_renders_as_tables() {
        let task = TaskSummary {
            task: "single_leg_stand".into(),
            family: "stabilization".into(),
            horizon: 1000,
            episodes: 50,
            successes: 47,
            success_rate: Some(0.94),
            success_interval: wilson_interval(47, 50),
            total: Some(Spread { mean: 38123.46, deviation: Some(1234.5) }),
            steps: Some(Spread { mean: 971.2, deviation: Some(120.0) }),
            ended_by: vec![("horizon".into(), 40), ("fallen".into(), 7), ("tilted".into(), 2), ("fault".into(), 1)],
            faults: vec![(31, "at 0.2 s the velocity of joint `knee` (body `tibia`) is inf".into())],
            terms: vec![TermSummary {
                name: "pose".into(),
                weight: 10.0,
                value_per_step: Some(0.93),
                pay_per_step: Some(9.3),
                share: Some(0.25),
            }],
            weights_versions: vec![("0123456789abcdef".into(), 40), ("fedcba9876543210".into(), 10)],
            metrics: vec![MetricSummary { name: "lean".into(), mean: Some(Spread { mean: 0.5, deviation: None }), last: None }],
        };
        let protocol = Protocol { episodes: 50, seed: 0 };
        let text = markdown(&Summary { policy: "posture".into(), protocol, tasks: vec![task] });
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
        assert!(text.contains("| task             | success [95 %] |"), "{text}");
        assert!(
            text.contains("| single_leg_stand |  94 % [84, 98] | 38123 ± 1234 | 971.2 ± 120.0 | horizon 40, fallen 7, other 3 |"),
            "{text}"
        );
        assert!(text.contains("\nFault in `single_leg_stand`, episode 31: at 0.2 s the velocity of joint `knee`"), "{text}");
        assert!(text.contains("| lean   |  0.5 |          - |"), "{text}");
        assert!(text.contains("| pose |     10 |           0.93 |          9.3 | 25.00 % |"), "{text}");
    }

    #[test]
    fn a_run_that_has_only_begun_says_so() {
        let text = markdown(&Summary {
            policy: "zero".into(),
            protocol: Protocol { episodes: 5, seed: 0 },
            tasks: vec![TaskSummary {
                task: "stand".into(),
                family: String::new(),
                horizon: 1,
                episodes: 0,
                successes: 0,
                success_rate: None,
                success_interval: [0.0, 1.0],
                total: None,
                steps: None,
                ended_by: vec![],
                faults: vec![],
                terms: vec![],
                weights_versions: vec![],
                metrics: vec![],
            }],
        });
        assert!(text.contains("| stand, 0 so far |              - |      - |     - |"), "{text}");
    }
}
