//! The tables of the paper, as LaTeX in its layouts: the comparison of policies over the whole suite, a table for each family with
//! activation cost, robustness at every scale, peak-efficiency steps, success and smoothness, and recruitment by family for evaluations of few
//! tasks, such as those of the load study.

use super::page::{END_FITTED, FITTED, escaped};
use super::read::Source;
use core::fmt::Write;
use msk::evaluate::metrics::peak;
use msk::evaluate::sweep::{Axis, Robustness, Sweep};
use msk::evaluate::{Summary, TaskSummary};

/// What a table has where nothing was evaluated.
const NOTHING: &str = "--";
/// Axes of perturbations, with their words in the tables.
const AXES: [(Axis, &str); 3] = [(Axis::Action, "Action"), (Axis::Observation, "Observation"), (Axis::Gain, "Dynamics")];

/// A policy: its evaluation, its sweep, and the trainings of its agents.
struct Column<'a> {
    name: &'a str,
    summary: Option<&'a Summary>,
    sweep: Option<&'a Sweep>,
}

/// All tables that the sources fill; empty if they have no evaluation and no sweep.
pub fn latex(sources: &[Source]) -> String {
    let columns = columns(sources);
    let Some(first) = columns.iter().find_map(|column| column.summary) else { return String::new() };
    let mut text = String::from("% Needs the packages booktabs, multirow and adjustbox.\n\n");
    text.push_str(&aggregate(&columns, first));
    for family in &first.families {
        text.push_str(&of_family(&family.name, &columns, first, sources));
    }
    for source in sources {
        text.extend(source.summary.as_ref().and_then(recruitment));
    }
    text
}

/// Evaluations and sweeps of one policy belong together.
fn columns(sources: &[Source]) -> Vec<Column<'_>> {
    let mut columns: Vec<Column<'_>> = Vec::new();
    for source in sources {
        let named = source.summary.as_ref().map(|summary| summary.policy.as_str());
        let Some(name) = named.or_else(|| source.sweep.as_ref().map(|sweep| sweep.policy.as_str())) else { continue };
        let place = columns.iter().position(|column| column.name == name).unwrap_or_else(|| {
            columns.push(Column { name, summary: None, sweep: None });
            columns.len() - 1
        });
        let column = &mut columns[place];
        // The episodes of an evaluation are more than the unperturbed ones of a sweep.
        if let Some(summary) = source.summary.as_ref().filter(|_| column.summary.is_none() || source.sweep.is_none()) {
            column.summary = Some(summary);
        }
        column.sweep = column.sweep.or(source.sweep.as_ref());
    }
    columns
}

/// Success by family, areas under perturbations, coverage: policies beside each other, the best of each row in bold.
fn aggregate(columns: &[Column<'_>], first: &Summary) -> String {
    let mut text = begin(
        "Success and robustness of all tasks. Means weight tasks equally; areas are 0 to 100. Bold: best of the row; \\textsuperscript{3/6}: of 3 of 6 tasks.",
    );
    let heads: Vec<String> = columns.iter().map(|column| escaped(column.name)).collect();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "\\begin{{tabular}}{{@{{}}ll{}@{{}}}}\n\\toprule\nGroup & Metric & {} \\\\\n\\midrule\n",
        "r".repeat(columns.len()),
        heads.join(" & ")
    );
    let groups = first.families.iter().chain([&first.overall]);
    let rows = groups.map(|group| {
        let name = if group.name == first.overall.name { "Average".to_owned() } else { capital(&group.name) };
        let of = |summary: &Summary| {
            let known = summary.families.iter().chain([&summary.overall]).find(|known| known.name == group.name)?;
            let of = (known.evaluated < known.tasks).then_some((known.evaluated, known.tasks));
            Some(Value { number: 100.0 * known.success_rate?, of })
        };
        let values = columns.iter().map(|column| column.summary.and_then(of)).collect();
        (format!("{} ({})", escaped(&name), group.tasks), values)
    });
    text.push_str(&block("SR (\\%) $\\uparrow$", &rows.collect::<Vec<_>>()));
    let area = |column: &Column<'_>, axis: Axis| column.sweep.and_then(|sweep| curve(sweep, &sweep.overall, axis)?.area);
    let whole = |number: Option<f64>| number.map(|number| Value { number, of: None });
    let mut rows: Vec<(String, Vec<Option<Value>>)> = AXES
        .iter()
        .map(|(axis, name)| ((*name).to_owned(), columns.iter().map(|column| whole(area(column, *axis))).collect()))
        .collect();
    let average = |column: &Column<'_>| {
        let areas: Option<Vec<f64>> = AXES.iter().map(|(axis, _)| area(column, *axis)).collect();
        areas.map(|areas| areas.iter().sum::<f64>() / areas.len() as f64)
    };
    rows.push(("Average".to_owned(), columns.iter().map(average).map(whole).collect()));
    let _ = write!(text, "\\midrule\n{}\\midrule\n", block("Robust. $\\uparrow$", &rows));
    let covered =
        |column: &Column<'_>| column.summary.map(|summary| summary.tasks.iter().filter(|task| task.successes > 0).count());
    let counts: Vec<Option<f64>> = columns.iter().map(|column| covered(column).map(|count| count as f64)).collect();
    let cell = |(column, count): (&Column<'_>, &Option<f64>)| {
        let all = column.summary.map_or(0, |summary| summary.tasks.len());
        count.map_or(NOTHING.to_owned(), |count| bold(format!("{count:.0}/{all}"), is_best(count, &counts)))
    };
    let cells: Vec<String> = columns.iter().zip(&counts).map(cell).collect();
    let _ = write!(text, "Coverage $\\uparrow$ & SR $>0$ & {} \\\\\n{}", cells.join(" & "), end());
    text
}

/// A mean, and of how many of how many tasks where some were not evaluated: it is then no better than another.
#[derive(Debug, Clone, Copy)]
struct Value {
    number: f64,
    of: Option<(usize, usize)>,
}

/// Rows of a group beside its name.
fn block(name: &str, rows: &[(String, Vec<Option<Value>>)]) -> String {
    let mut text = format!("\\multirow{{{}}}{{*}}{{{name}}}\n", rows.len());
    for (metric, values) in rows {
        let whole = |value: &Option<Value>| value.filter(|value| value.of.is_none()).map(|value| value.number);
        let numbers: Vec<Option<f64>> = values.iter().map(whole).collect();
        let cell = |value: &Option<Value>| match value {
            Some(Value { number, of: None }) => bold(format!("{number:.2}"), is_best(*number, &numbers)),
            Some(Value { number, of: Some((some, all)) }) => format!("{number:.2}\\textsuperscript{{{some}/{all}}}"),
            None => NOTHING.to_owned(),
        };
        let cells: Vec<String> = values.iter().map(cell).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "& {metric} & {} \\\\", cells.join(" & "));
    }
    text
}

/// The tasks of a family, each with a row per policy.
fn of_family(family: &str, columns: &[Column<'_>], first: &Summary, sources: &[Source]) -> String {
    let scales: Vec<Vec<f64>> = AXES.map(|(axis, _)| scales(columns, axis)).into();
    let caption = format!("Performance and robustness: {}. Robustness in percent of successes at every scale.", escaped(family));
    let mut text = begin(&caption);
    let count: usize = scales.iter().map(Vec::len).sum();
    let spans: Vec<String> =
        AXES.iter().zip(&scales).map(|((_, name), scales)| format!("\\multicolumn{{{}}}{{c}}{{{name}}}", scales.len())).collect();
    // Columns before the scales: task, policy, activation cost.
    let (mut rules, mut from) = (String::new(), 4);
    for scales in &scales {
        let _ = write!(rules, "\\cmidrule(lr){{{from}-{}}} ", from + scales.len() - 1);
        from += scales.len();
    }
    let numbers: Vec<String> = scales.iter().flatten().map(f64::to_string).collect();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "\\begin{{tabular}}{{lc c *{{{count}}}{{c}} ccc}}\n\\toprule\n\
         \\multirow{{3}}{{*}}{{\\textbf{{Task}}}} & \\multirow{{3}}{{*}}{{\\textbf{{Policy}}}} & \\textbf{{Activation}} & \
         \\multicolumn{{{count}}}{{c}}{{\\textbf{{Robustness (\\%)}}}} & \\textbf{{Max}} & \\textbf{{SR}} & \\textbf{{$\\log_{{10}}$smooth}} \\\\\n\
         & & \\textbf{{Cost}} & {} & \\textbf{{Steps}} ($\\times 10^7$) & \\textbf{{(\\%)}} & \\textbf{{(rad$^2$/s$^6$)}} \\\\\n\
         {}\n& & & {} & & & \\\\\n\\midrule\n",
        spans.join(" & "),
        rules.trim_end(),
        numbers.join(" & ")
    );
    let tasks: Vec<&TaskSummary> = first.tasks.iter().filter(|task| task.family == family).collect();
    for (place, task) in tasks.iter().enumerate() {
        if place > 0 {
            let _ = writeln!(text, "\\cmidrule{{1-{}}}", count + 6);
        }
        let _ = writeln!(text, "\\multirow{{{}}}{{*}}{{{}}}", columns.len(), escaped(&task.task));
        for column in columns {
            let _ = writeln!(text, "& {} \\\\", row(&task.task, column, &scales, sources).join(" & "));
        }
    }
    text.push_str(&end());
    text
}

fn row(task: &str, column: &Column<'_>, scales: &[Vec<f64>], sources: &[Source]) -> Vec<String> {
    let own = column.summary.and_then(|summary| summary.tasks.iter().find(|known| known.task == task));
    let number = |value: Option<f64>, digits: usize| value.map_or(NOTHING.to_owned(), |value| format!("{value:.digits$}"));
    let standard = |name: &str| own?.standard.iter().find(|known| known.name == name).map(|known| known.value.mean);
    let mut cells = vec![escaped(column.name), number(standard("activation_cost"), 4)];
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

/// Most tasks beside each other in a table of recruitment.
const MOST_TASKS: usize = 6;

/// Activation mass A_k and share P_k of each muscle family, tasks beside each other; none for evaluations of many tasks.
fn recruitment(summary: &Summary) -> Option<String> {
    let tasks: Vec<&TaskSummary> = summary.tasks.iter().filter(|task| !task.recruitment.is_empty()).collect();
    if tasks.is_empty() || summary.tasks.len() > MOST_TASKS {
        return None;
    }
    let policy = escaped(&summary.policy);
    let mut text = begin(&format!("Recruitment under {policy}: activation mass $A_k$ and its share $P_k$ of all families."));
    let heads: Vec<String> = tasks.iter().map(|task| format!("\\multicolumn{{2}}{{c}}{{{}}}", escaped(&task.task))).collect();
    let rules: Vec<String> =
        (0..tasks.len()).map(|place| format!("\\cmidrule(lr){{{}-{}}}", 2 * place + 2, 2 * place + 3)).collect();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "\\begin{{tabular}}{{@{{}}l{}@{{}}}}\n\\toprule\nFamily & {} \\\\\n{}\n{} \\\\\n\\midrule\n",
        "rr".repeat(tasks.len()),
        heads.join(" & "),
        rules.join(" "),
        " & $A_k$ & $P_k$ (\\%)".repeat(tasks.len())
    );
    for family in &tasks[0].recruitment {
        let cells = tasks.iter().map(|task| {
            let own = task.recruitment.iter().find(|known| known.name == family.name);
            own.map_or(format!("{NOTHING} & {NOTHING}"), |own| format!("{:.3} & {:.1}", own.mass, 100.0 * own.share))
        });
        let _ = writeln!(text, "{} & {} \\\\", escaped(&family.name), cells.collect::<Vec<_>>().join(" & "));
    }
    text.push_str(&end());
    Some(text)
}

/// Peak-efficiency steps of the training whose folder a policy `agent FOLDER` names.
fn steps(policy: &str, sources: &[Source]) -> Option<f64> {
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

fn curve<'a>(sweep: &Sweep, of: &'a Robustness, axis: Axis) -> Option<&'a msk::evaluate::sweep::Curve> {
    let place = sweep.axes.iter().position(|(known, _)| *known == axis)?;
    of.curves.get(place)
}

fn is_best(value: f64, row: &[Option<f64>]) -> bool {
    row.len() > 1 && value > 0.0 && row.iter().flatten().all(|other| *other <= value)
}

fn bold(cell: String, is_best: bool) -> String {
    if is_best { format!("\\textbf{{{cell}}}") } else { cell }
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn begin(caption: &str) -> String {
    format!("\\begin{{table*}}\n\\centering\n\\setlength{{\\tabcolsep}}{{2pt}}\n\\caption{{{caption}}}\n{FITTED}")
}

fn end() -> String {
    format!("\\bottomrule\n\\end{{tabular}}\n{END_FITTED}\\end{{table*}}\n\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn summary(policy: &str, success: [f64; 2]) -> Summary {
        let task = |name: &str, family: &str, rate: f64| {
            json!({
                "task": name, "family": family, "horizon": 10, "episodes": 50, "successes": (50.0 * rate) as u64,
                "success_rate": rate, "success_interval": [0.0, 1.0], "return": null, "steps": null, "ended_by": [], "faults": [],
                "terms": [], "metrics": [],
                "standard": [{ "name": "activation_cost", "unit": "", "episodes": 50, "value": { "mean": 0.25, "deviation": null } }],
            })
        };
        let group = |name: &str, tasks: usize, rate: f64| json!({ "name": name, "tasks": tasks, "evaluated": tasks, "success_rate": rate, "horizon_part": null });
        let mean = success.iter().sum::<f64>() / 2.0;
        serde_json::from_value(json!({
            "policy": policy, "protocol": { "episodes": 50, "seed": 0 },
            "families": [group("stabilization", 1, success[0]), group("locomotion", 1, success[1])],
            "overall": group("all tasks", 2, mean),
            "tasks": [task("stand", "stabilization", success[0]), task("walk_turn", "locomotion", success[1])],
        }))
        .unwrap()
    }

    fn sweep(policy: &str) -> Sweep {
        let of =
            |name: &str| json!({ "name": name, "family": "", "area": 75.0, "curves": [{ "success": [1.0, 0.5], "area": 75.0 }] });
        serde_json::from_value(json!({
            "policy": policy, "seed": 0, "episodes": 30, "axes": [["action", [0.0, 0.2]]],
            "tasks": [of("stand"), of("walk_turn")], "families": [], "overall": of("all tasks"),
        }))
        .unwrap()
    }

    #[test]
    fn the_papers_tables_have_its_columns() {
        let source = |label: &str| Source { label: label.into(), ..Source::default() };
        let sources = [
            Source { summary: Some(summary("agent runs/walk_ppo/best", [0.5, 1.0])), ..source("a") },
            Source { sweep: Some(sweep("cmc")), ..source("b") },
            Source { summary: Some(summary("cmc", [1.0, 0.0])), ..source("c") },
            Source { curve: vec![[1e7, 2.0, 0.1], [3e7, 5.0, 0.2]], ..source("walk_ppo") },
        ];
        let text = latex(&sources);
        for line in [
            "\\begin{tabular}{@{}llrr@{}}",
            "Group & Metric & agent runs/walk\\_ppo/best & cmc \\\\",
            "& Stabilization (1) & 50.00 & \\textbf{100.00} \\\\",
            "& Average (2) & \\textbf{75.00} & 50.00 \\\\",
            "\\begin{adjustbox}{max width=\\linewidth}",
            "& Action & -- & \\textbf{75.00} \\\\",
            // Not all axes were swept.
            "& Average & -- & -- \\\\",
            "Coverage $\\uparrow$ & SR $>0$ & \\textbf{2/2} & 1/2 \\\\",
            "\\begin{tabular}{lc c *{12}{c} ccc}",
            "\\cmidrule(lr){4-5} \\cmidrule(lr){6-10} \\cmidrule(lr){11-15}",
            "& & & 0 & 0.2 & 0 & 0.02 & 0.05 & 0.08 & 0.1 & 0 & 0.05 & 0.1 & 0.15 & 0.2 & & & \\\\",
            "\\multirow{2}{*}{walk\\_turn}",
            "& cmc & 0.2500 & 100 & 50 & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & 0 & -- \\\\",
            "& agent runs/walk\\_ppo/best & 0.2500 & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & 3.00 & 100 & -- \\\\",
        ] {
            assert!(text.lines().any(|found| found == line), "no `{line}` in\n{text}");
        }
        assert_eq!(text.matches("\\begin{table*}").count(), 3, "one for all tasks, one for each family");
        assert_eq!(latex(&[]), "");
        // Nobody has measured recruitment above.
        assert!(!text.contains("Recruitment"));
        let mut loads = summary("cmc", [1.0, 0.0]);
        for (task, mass) in loads.tasks.iter_mut().zip([2.0, 3.5]) {
            task.recruitment = vec![msk::evaluate::FamilySummary { name: "Elbow flexors".into(), mass, share: mass / 10.0 }];
        }
        let text = latex(&[Source { summary: Some(loads), ..source("loads") }]);
        for line in [
            "Family & \\multicolumn{2}{c}{stand} & \\multicolumn{2}{c}{walk\\_turn} \\\\",
            "\\cmidrule(lr){2-3} \\cmidrule(lr){4-5}",
            "Elbow flexors & 2.000 & 20.0 & 3.500 & 35.0 \\\\",
        ] {
            assert!(text.lines().any(|found| found == line), "no `{line}` in\n{text}");
        }
        // A mean of fewer tasks is no better.
        let mut some = summary("agents", [1.0, 0.0]);
        (some.families[0].tasks, some.overall.evaluated) = (6, 1);
        let text = latex(&[
            Source { summary: Some(some), ..source("a") },
            Source { summary: Some(summary("cmc", [0.5, 0.25])), ..source("c") },
        ]);
        for line in [
            "& Stabilization (6) & 100.00\\textsuperscript{1/6} & \\textbf{50.00} \\\\",
            "& Average (2) & 50.00\\textsuperscript{1/2} & \\textbf{37.50} \\\\",
        ] {
            assert!(text.lines().any(|found| found == line), "no `{line}` in\n{text}");
        }
    }
}
