//! Returns of scripts for people and machines: the demonstration of a task first, its exploits under it.

use msk::compiler::numbers::for_people;
use msk::evaluate::report::Table;
use msk::evaluate::testing::{Demonstration, Measure, Returns, TestReport};
use serde_json::json;

/// The table of the cheats among the reports of one task; empty without cheats.
pub fn table(reports: &[&TestReport]) -> String {
    let mut ranked: Vec<(String, &Returns)> = Vec::new();
    let mut demonstration = None;
    for report in reports {
        let Some(ranking) = &report.ranking else { continue };
        demonstration = demonstration.or(ranking.demonstration.as_ref());
        ranked.push((report.title.clone(), &ranking.returns));
    }
    match (ranked.is_empty(), demonstration) {
        (true, _) => String::new(),
        (false, None) => "  no test expects `success` at its end: the returns of the cheats are not compared\n".to_owned(),
        (false, demonstration) => table_of(demonstration, ranked),
    }
}

/// The table of scripts with their returns, the greatest return first; empty without any.
pub fn table_of(demonstration: Option<&Demonstration>, mut ranked: Vec<(String, &Returns)>) -> String {
    if ranked.is_empty() && demonstration.is_none() {
        return String::new();
    }
    ranked.sort_by(|left, right| right.1.by(Measure::Return).total_cmp(&left.1.by(Measure::Return)));
    let names = Measure::ALL.map(Measure::name);
    let head: Vec<&str> = ["script"].into_iter().chain(names).chain(["steps", "ended by"]).collect();
    let mut table = Table::new(&head);
    if let Some(demonstration) = demonstration {
        table.row(row(&format!("demonstration: {}", demonstration.title), &demonstration.returns));
    }
    ranked.into_iter().for_each(|(title, returns)| table.row(row(&title, returns)));
    // As wide as its columns: a title is not cut.
    table.plain(usize::MAX).lines().fold(String::new(), |text, line| text + "    " + line + "\n")
}

fn row(title: &str, returns: &Returns) -> Vec<String> {
    let figures = Measure::ALL.map(|measure| for_people(returns.by(measure)));
    let ends = [returns.steps.to_string(), returns.ended_by.clone()];
    [title.to_owned()].into_iter().chain(figures).chain(ends).collect()
}

/// A demonstration for machines.
pub fn demonstration(shown: &Demonstration) -> serde_json::Value {
    json!({ "test": shown.title, "returns": figures(&shown.returns) })
}

/// Returns for machines.
pub fn figures(returns: &Returns) -> serde_json::Value {
    let by = |measure| returns.by(measure);
    json!({
        "steps": returns.steps,
        "ended_by": returns.ended_by,
        "return": by(Measure::Return),
        "per_step": by(Measure::PerStep),
        "discounted": by(Measure::Discounted),
        "discounted_per_step": by(Measure::DiscountedPerStep),
        "terms": returns.terms,
    })
}
