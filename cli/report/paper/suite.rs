//! The comparison of policies over the whole suite, and a table for each family with activation cost, robustness at every scale,
//! peak-efficiency steps, success and smoothness.

use super::super::read::Source;
use super::table::{Cell, Group, Head, NOTHING, PaperTable, cell, head, mark_largest, number};
use super::{Column, standard};
use msk::compiler::numbers::exact;
use msk::evaluate::Summary;
use msk::evaluate::metrics::peak;
use msk::evaluate::sweep::{Axis, Curve, Robustness, Sweep};

/// Axes of perturbations, with their words in the tables.
const AXES: [(Axis, &str); 3] = [(Axis::Action, "Action"), (Axis::Observation, "Observation"), (Axis::Gain, "Dynamics")];

/// The comparison and the families; none without an evaluation.
pub fn tables(columns: &[Column<'_>], sources: &[Source]) -> Vec<PaperTable> {
    let Some(first) = columns.iter().find_map(|column| column.summary) else { return Vec::new() };
    let families = first.families.iter().map(|family| of_family(&family.name, columns, first, sources));
    [aggregate(columns, first)].into_iter().chain(families).collect()
}

/// Success by family, areas under perturbations, coverage: policies beside each other, the best of each row marked.
fn aggregate(columns: &[Column<'_>], first: &Summary) -> PaperTable {
    let families = first.families.iter().chain([&first.overall]);
    let success = families.map(|group| {
        let name = if group.name == first.overall.name { "Average".to_owned() } else { capital(&group.name) };
        let of = |column: &Column<'_>| {
            let summary = column.summary?;
            let known = summary.families.iter().chain([&summary.overall]).find(|known| known.name == group.name)?;
            let of = (known.evaluated < known.tasks).then_some((known.evaluated, known.tasks));
            Some(Value { number: 100.0 * known.success_rate?, of })
        };
        row(format!("{name} ({})", group.tasks), columns.iter().map(of).collect())
    });
    let area = |column: &Column<'_>, axis: Axis| column.sweep.and_then(|sweep| curve(sweep, &sweep.overall, axis)?.area);
    let areas = |name: &str, of: &dyn Fn(&Column<'_>) -> Option<f64>| {
        row(name.to_owned(), columns.iter().map(|column| of(column).map(|number| Value { number, of: None })).collect())
    };
    let mut robust: Vec<Vec<Cell>> = AXES.iter().map(|(axis, name)| areas(name, &|column| area(column, *axis))).collect();
    robust.push(areas("Average", &|column| {
        let all: Option<Vec<f64>> = AXES.iter().map(|(axis, _)| area(column, *axis)).collect();
        all.map(|all| all.iter().sum::<f64>() / all.len() as f64)
    }));
    let group = |name: &str, rows: Vec<Vec<Cell>>| Group { name: Some(name.into()), rows };
    PaperTable {
        caption: "Success and robustness of all tasks. Means weight tasks equally; areas are 0 to 100. Bold: best of the row; a remark \
                  such as 3/6: of 3 of 6 tasks."
            .into(),
        columns: format!("@{{}}ll{}@{{}}", "r".repeat(columns.len())),
        head: vec![[head("Group"), head("Metric")].into_iter().chain(columns.iter().map(|column| head(column.name))).collect()],
        groups: vec![
            group("SR (%) \u{2191}", success.collect()),
            group("Robust. \u{2191}", robust),
            group("Coverage \u{2191}", vec![coverage(columns)]),
        ],
    }
}

/// How many tasks each policy succeeds in at least once.
fn coverage(columns: &[Column<'_>]) -> Vec<Cell> {
    let count = |summary: &Summary| summary.tasks.iter().filter(|task| task.successes > 0).count();
    let counts: Vec<Option<f64>> = columns.iter().map(|column| column.summary.map(|summary| count(summary) as f64)).collect();
    let text = |column: &Column<'_>| {
        column.summary.map_or(NOTHING.to_owned(), |summary| format!("{}/{}", count(summary), summary.tasks.len()))
    };
    let mut cells: Vec<Cell> = columns.iter().map(|column| cell(text(column))).collect();
    mark_largest(&mut cells, &counts);
    [cell("SR > 0")].into_iter().chain(cells).collect()
}

/// A mean, and of how many of how many tasks where some were not evaluated: it is then no better than another.
#[derive(Debug, Clone, Copy)]
struct Value {
    number: f64,
    of: Option<(usize, usize)>,
}

fn row(name: String, values: Vec<Option<Value>>) -> Vec<Cell> {
    let whole: Vec<Option<f64>> =
        values.iter().map(|value| value.filter(|value| value.of.is_none()).map(|value| value.number)).collect();
    let remark =
        |value: &Option<Value>| value.and_then(|value| value.of).map_or(String::new(), |(some, all)| format!("{some}/{all}"));
    let mut cells: Vec<Cell> =
        values.iter().map(|value| Cell { remark: remark(value), ..number(value.map(|value| value.number), 2) }).collect();
    mark_largest(&mut cells, &whole);
    [cell(name)].into_iter().chain(cells).collect()
}

/// The tasks of a family, each with a row per policy.
fn of_family(family: &str, columns: &[Column<'_>], first: &Summary, sources: &[Source]) -> PaperTable {
    let scales: Vec<Vec<f64>> = AXES.map(|(axis, _)| scales(columns, axis)).into();
    let count: usize = scales.iter().map(Vec::len).sum();
    let spans = AXES.iter().zip(&scales).map(|((_, name), scales)| Head { text: (*name).into(), columns: scales.len() });
    let row_of = |before: [&str; 3], between: Vec<Head>, after: [&str; 3]| -> Vec<Head> {
        before.map(head).into_iter().chain(between).chain(after.map(head)).collect()
    };
    let robustness = vec![Head { text: "Robustness (%)".into(), columns: count }];
    let numbers = scales.iter().flatten().map(|scale| head(exact(*scale))).collect();
    let tasks = first.tasks.iter().filter(|task| task.family == family);
    let rows = |task: &str| columns.iter().map(|column| cells(task, column, &scales, sources)).collect();
    PaperTable {
        caption: format!("Performance and robustness: {family}. Robustness in percent of successes at every scale."),
        columns: format!("lc c *{{{count}}}{{c}} ccc"),
        head: vec![
            row_of(["Task", "Policy", "Activation"], robustness, ["Max", "SR", "log10 smooth"]),
            row_of(["", "", "Cost"], spans.collect(), ["Steps (\u{d7}10\u{2077})", "(%)", "(rad\u{b2}/s\u{2076})"]),
            row_of(["", "", ""], numbers, ["", "", ""]),
        ],
        groups: tasks.map(|task| Group { name: Some(task.task.clone()), rows: rows(&task.task) }).collect(),
    }
}

fn cells(task: &str, column: &Column<'_>, scales: &[Vec<f64>], sources: &[Source]) -> Vec<Cell> {
    let own = column.task(task);
    let standard = |name: &str| own.and_then(|own| standard(own, name));
    let mut cells = vec![cell(column.name), number(standard("activation_cost"), 4)];
    for ((axis, _), scales) in AXES.iter().zip(scales) {
        let robust = column.sweep.and_then(|sweep| Some((sweep, sweep.tasks.iter().find(|known| known.name == task)?)));
        let success = robust.and_then(|(sweep, robust)| Some(curve(sweep, robust, *axis)?.success.clone()));
        let at = |place: usize| success.as_ref().and_then(|success| *success.get(place)?);
        cells.extend((0..scales.len()).map(|place| number(at(place).map(|rate| 100.0 * rate), 0)));
    }
    cells.push(number(steps(column.name, sources).map(|steps| steps / 1e7), 2));
    cells.push(number(own.and_then(|own| own.success_rate).map(|rate| 100.0 * rate), 0));
    cells.push(number(standard("joint_smoothness"), 3));
    cells
}

/// Peak-efficiency steps of the training whose folder a policy `agent FOLDER` names.
pub fn steps(policy: &str, sources: &[Source]) -> Option<f64> {
    let folder = std::path::Path::new(policy.strip_prefix("agent ")?);
    let names: Vec<_> = folder.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    let training = sources.iter().find(|source| !source.curve.is_empty() && names.contains(&source.label))?;
    peak::peak(training.curve.iter().map(|[steps, total, _]| (*steps, *total))).map(|(steps, _)| steps)
}

/// The scales of an axis: of the first policy that was swept along it, else the usual ones.
fn scales(columns: &[Column<'_>], axis: Axis) -> Vec<f64> {
    let of = |sweep: &Sweep| sweep.axes.iter().find(|(known, _)| *known == axis).map(|(_, scales)| scales.clone());
    columns.iter().filter_map(|column| column.sweep).find_map(of).unwrap_or_else(|| axis.grid().to_vec())
}

fn curve<'a>(sweep: &Sweep, of: &'a Robustness, axis: Axis) -> Option<&'a Curve> {
    let place = sweep.axes.iter().position(|(known, _)| *known == axis)?;
    of.curves.get(place)
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
