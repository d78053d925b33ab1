//! The table of returns that `msk test` prints for a task: the demonstration first, its exploits under it.

use msk::compiler::numbers::for_people;
use msk::runtime::testing::{Measure, Returns, TestReport};

/// The table of the cheats among the reports of one task; empty without cheats.
pub fn table(reports: &[&TestReport]) -> String {
    let mut ranked: Vec<(&str, &Returns)> = Vec::new();
    let mut demonstration = None;
    for report in reports {
        let Some(ranking) = &report.ranking else { continue };
        demonstration = demonstration.or(ranking.demonstration.as_ref());
        ranked.push((&report.title, &ranking.returns));
    }
    if ranked.is_empty() {
        return String::new();
    }
    let Some(demonstration) = demonstration else {
        return "  no test expects `success` at its end: the returns of the cheats are not compared\n".to_owned();
    };
    ranked.sort_by(|left, right| right.1.by(Measure::Return).total_cmp(&left.1.by(Measure::Return)));
    let mut rows = vec![head()];
    rows.push(row(&format!("demonstration: {}", demonstration.title), &demonstration.returns));
    rows.extend(ranked.into_iter().map(|(title, returns)| row(title, returns)));
    aligned(&rows)
}

fn head() -> Vec<String> {
    let measures = Measure::ALL.map(Measure::name);
    let names = ["script"].into_iter().chain(measures).chain(["steps", "ended by"]);
    names.map(str::to_owned).collect()
}

fn row(title: &str, returns: &Returns) -> Vec<String> {
    let figures = Measure::ALL.map(|measure| for_people(returns.by(measure)));
    let ends = [returns.steps.to_string(), returns.ended_by.clone()];
    [title.to_owned()].into_iter().chain(figures).chain(ends).collect()
}

/// Columns of one width: words to the left, numbers to the right.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column {
            0 => format!("{cell:<width$}"),
            _ if column + 1 == columns => cell.clone(),
            _ => format!("{cell:>width$}"),
        });
        text += &format!("    {}\n", cells.collect::<Vec<_>>().join("  "));
    }
    text
}
