//! The table of returns that `msk test` prints for a task: the demonstration first, its exploits under it.

use msk::compiler::numbers::for_people;
use msk::runtime::evaluate::report::Table;
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
    let names = Measure::ALL.map(Measure::name);
    let head: Vec<&str> = ["script"].into_iter().chain(names).chain(["steps", "ended by"]).collect();
    let mut table = Table::new(&head);
    table.row(row(&format!("demonstration: {}", demonstration.title), &demonstration.returns));
    ranked.into_iter().for_each(|(title, returns)| table.row(row(title, returns)));
    // As wide as its columns: a title is not cut.
    table.plain(usize::MAX).lines().fold(String::new(), |text, line| text + "    " + line + "\n")
}

fn row(title: &str, returns: &Returns) -> Vec<String> {
    let figures = Measure::ALL.map(|measure| for_people(returns.by(measure)));
    let ends = [returns.steps.to_string(), returns.ended_by.clone()];
    [title.to_owned()].into_iter().chain(figures).chain(ends).collect()
}
