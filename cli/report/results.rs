//! The parts of a report that are of whole evaluations, sweeps and trainings.

use super::read::Source;
use super::{Grid, Section, radars, sessions};
use msk::compiler::numbers::{exact, fixed, for_people};
use msk::draw::bars::{self, Bars};
use msk::draw::chart::{self, Chart, Panel};
use msk::evaluate::metrics::{STANDARD, peak};
use msk::evaluate::sweep::Sweep;
use msk::evaluate::{GroupSummary, Summary, TaskSummary};

/// Metrics that have bars of their own.
const BARS: [(&str, &str); 3] = [
    ("activation_cost", "Activation cost"),
    ("joint_smoothness", "Joint smoothness"),
    ("cost_of_transport", "Cost of transport"),
];

/// All of them, in their order.
pub fn sections(sources: &[Source]) -> Vec<Section> {
    let evaluated: Vec<(&str, &Summary)> =
        sources.iter().filter_map(|source| Some((source.label.as_str(), source.summary.as_ref()?))).collect();
    let swept: Vec<(&str, &Sweep)> =
        sources.iter().filter_map(|source| Some((source.label.as_str(), source.sweep.as_ref()?))).collect();
    let mut all = vec![leaderboard(&evaluated), families(&evaluated, &swept)];
    all.extend(evaluated.iter().flat_map(|(label, summary)| [metrics(label, summary), recruitment(label, summary)]));
    all.extend(swept.iter().map(|(label, sweep)| robustness(label, sweep)));
    all.push(learning(sources));
    all.push(sessions::section(sources));
    all
}

fn percent(rate: Option<f64>) -> String {
    rate.map_or("-".into(), |rate| format!("{} %", fixed(100.0 * rate, 0)))
}

fn grid(head: impl IntoIterator<Item = String>, rows: Vec<Vec<String>>) -> Option<Grid> {
    Some(Grid { head: head.into_iter().collect(), rows })
}

/// The tasks of all evaluations, each once under every condition, in the order of the first that has them.
fn tasks<'a>(evaluated: &[(&str, &'a Summary)]) -> Vec<&'a TaskSummary> {
    let mut tasks: Vec<&TaskSummary> = Vec::new();
    for task in evaluated.iter().flat_map(|(_, summary)| &summary.tasks) {
        if !tasks.iter().any(|known| known.name() == task.name()) {
            tasks.push(task);
        }
    }
    tasks
}

fn leaderboard(evaluated: &[(&str, &Summary)]) -> Section {
    let cells = |task: &TaskSummary| match task.skipped {
        Some(_) => ["skipped".to_owned(), "-".to_owned()],
        None => {
            let [low, high] = task.success_interval.map(|bound| fixed(100.0 * bound, 0));
            let success = task.success_rate.map_or("-".into(), |rate| format!("{} % [{low}, {high}]", fixed(100.0 * rate, 0)));
            [success, task.total.map_or("-".into(), |total| for_people(total.mean))]
        }
    };
    let row = |task: &&TaskSummary| {
        let of = |(_, summary): &(&str, &Summary)| {
            let found = summary.tasks.iter().find(|known| known.name() == task.name());
            found.map_or(["-".to_owned(), "-".to_owned()], cells)
        };
        [task.name(), task.family.clone()].into_iter().chain(evaluated.iter().flat_map(of)).collect()
    };
    let rows = tasks(evaluated).iter().map(row).collect();
    let head = evaluated.iter().flat_map(|(label, _)| [format!("{label}: success [95 %]"), "return".to_owned()]);
    Section {
        title: "Leaderboard".into(),
        words: "Success at the last step of the episode with Wilson's 95 % interval; mean return over the whole episode.".into(),
        table: grid(["task".to_owned(), "family".to_owned()].into_iter().chain(head), rows),
        figures: vec![],
    }
}

/// The families of all evaluations and all tasks, with the means of each evaluation.
fn families(evaluated: &[(&str, &Summary)], swept: &[(&str, &Sweep)]) -> Section {
    let mut names: Vec<&str> = Vec::new();
    for family in evaluated.iter().flat_map(|(_, summary)| &summary.families) {
        if !names.contains(&family.name.as_str()) {
            names.push(&family.name);
        }
    }
    let group = |summary: &Summary, name: &str| -> Option<GroupSummary> {
        let known = summary.families.iter().chain([&summary.overall]).find(|family| family.name == name);
        known.cloned()
    };
    names.push("all tasks");
    let success = |name: &str| -> Vec<Option<f64>> {
        evaluated.iter().map(|(_, summary)| group(summary, name).and_then(|family| family.success_rate)).collect()
    };
    // A mean over some of the tasks says so.
    let cell = |(_, summary): &(&str, &Summary), name: &str| match group(summary, name) {
        Some(group) if group.evaluated < group.tasks && group.evaluated > 0 => {
            format!("{} of {} of {} tasks", percent(group.success_rate), group.evaluated, group.tasks)
        }
        found => percent(found.and_then(|group| group.success_rate)),
    };
    let coverage = |(_, summary): &(&str, &Summary)| {
        format!("{} of {}", summary.tasks.iter().filter(|task| task.successes > 0).count(), summary.tasks.len())
    };
    let row = |name: &&str| -> Vec<String> {
        [(*name).to_owned()].into_iter().chain(evaluated.iter().map(|column| cell(column, name))).collect()
    };
    let mut rows: Vec<Vec<String>> = if evaluated.is_empty() { vec![] } else { names.iter().map(row).collect() };
    if !rows.is_empty() {
        rows.push(["tasks with a success".to_owned()].into_iter().chain(evaluated.iter().map(coverage)).collect());
    }
    let series: Vec<String> = evaluated.iter().map(|(label, _)| (*label).to_owned()).collect();
    let in_percent =
        |name: &&str| success(name).into_iter().map(|rate| rate.map_or(f64::NAN, |rate| 100.0 * rate)).collect::<Vec<_>>();
    let bars = names.iter().map(|name| ((*name).to_owned(), in_percent(name))).collect();
    let bars = bars::svg(&Bars { title: "Mean success, %".into(), series: series.clone(), rows: bars });
    let mut figures = if evaluated.is_empty() { vec![] } else { vec![bars] };
    if !evaluated.is_empty() && names.len() > 3 {
        figures.push(radars::of_all(&names, &success, evaluated, swept));
    }
    Section {
        title: "Families".into(),
        words: "Means over tasks, each of which counts the same.".into(),
        table: grid(["family".to_owned()].into_iter().chain(series), rows),
        figures,
    }
}

fn metrics(label: &str, summary: &Summary) -> Section {
    let value =
        |task: &TaskSummary, name: &str| task.standard.iter().find(|metric| metric.name == name).map(|metric| metric.value.mean);
    let there: Vec<(&str, &str)> =
        STANDARD.into_iter().filter(|(name, _)| summary.tasks.iter().any(|task| value(task, name).is_some())).collect();
    let row = |task: &TaskSummary| {
        let cells = there.iter().map(|(name, _)| value(task, name).map_or("-".into(), for_people));
        [task.name()].into_iter().chain(cells).collect()
    };
    let rows: Vec<Vec<String>> = summary.tasks.iter().filter(|task| !task.standard.is_empty()).map(row).collect();
    let head = there.iter().map(|(name, unit)| {
        let name = name.replace('_', " ");
        if unit.is_empty() { name } else { format!("{name}, {unit}") }
    });
    let bars = BARS.iter().filter_map(|(name, title)| {
        let rows: Vec<(String, Vec<f64>)> =
            summary.tasks.iter().filter_map(|task| Some((task.name(), vec![value(task, name)?]))).collect();
        let unit = STANDARD.iter().find(|(known, _)| known == name).map_or("", |(_, unit)| unit);
        let title = if unit.is_empty() { format!("{title}, {label}") } else { format!("{title}, {unit}, {label}") };
        (rows.len() > 1).then(|| bars::svg(&Bars { title, series: vec![label.to_owned()], rows }))
    });
    Section {
        title: format!("Standard metrics: {label}"),
        words: "Means over episodes; docs/evaluation.md has the formulas.".into(),
        figures: bars.collect(),
        table: grid(["task".to_owned()].into_iter().chain(head), rows),
    }
}

fn recruitment(label: &str, summary: &Summary) -> Section {
    /// Tasks whose families are drawn beside each other.
    const BESIDE: usize = 6;
    let tasks: Vec<&TaskSummary> = summary.tasks.iter().filter(|task| !task.recruitment.is_empty()).collect();
    let Some(first) = tasks.first() else { return Section::default() };
    let mass = |task: &TaskSummary, name: &str| task.recruitment.iter().find(|family| family.name == name).cloned();
    let rows = first.recruitment.iter().map(|family| {
        let cells = tasks.iter().map(|task| {
            mass(task, &family.name)
                .map_or("-".into(), |found| format!("{} ({} %)", for_people(found.mass), fixed(100.0 * found.share, 0)))
        });
        [family.name.clone()].into_iter().chain(cells).collect()
    });
    let drawn = &tasks[..tasks.len().min(BESIDE)];
    let bars = first.recruitment.iter().map(|family| {
        let masses = drawn.iter().map(|task| mass(task, &family.name).map_or(f64::NAN, |found| found.mass));
        (family.name.clone(), masses.collect())
    });
    let bars = Bars {
        title: format!("Activation mass of muscle families, {label}"),
        series: drawn.iter().map(|task| task.name()).collect(),
        rows: bars.collect(),
    };
    Section {
        title: format!("Recruitment: {label}"),
        words: "Sum over the muscles of a family of their mean activations, and its part of that of all families.".into(),
        figures: vec![bars::svg(&bars)],
        table: grid(["family".to_owned()].into_iter().chain(tasks.iter().map(|task| task.name())), rows.collect()),
    }
}

fn robustness(label: &str, sweep: &Sweep) -> Section {
    let head = sweep.axes.iter().flat_map(|(axis, scales)| {
        let scales = scales.iter().map(move |scale| format!("{} {}", axis.name(), exact(*scale)));
        scales.chain([format!("{} area", axis.name())])
    });
    let all = sweep.tasks.iter().chain(&sweep.families).chain([&sweep.overall]);
    let rows = all.map(|of| {
        let curves = of.curves.iter().flat_map(|curve| {
            let area = curve.area.map_or("-".into(), |area| fixed(area, 1));
            curve.success.iter().map(|rate| rate.map_or("-".into(), |rate| fixed(100.0 * rate, 0))).chain([area])
        });
        [of.name.clone()].into_iter().chain(curves).collect()
    });
    let figure = |(place, (axis, scales)): (usize, &(msk::evaluate::sweep::Axis, Vec<f64>))| {
        let of = sweep.families.iter().chain([&sweep.overall]);
        let curves = of.map(|of| {
            let success = of.curves[place].success.iter().map(|rate| rate.map_or(f64::NAN, |rate| 100.0 * rate));
            (of.name.clone(), success.collect())
        });
        let panel = Panel { label: "success [%]".into(), curves: curves.collect() };
        let title = format!("{} perturbation, {label}", axis.name());
        chart::svg(&Chart {
            title,
            axis: format!("{} scale", axis.name()),
            at: scales.clone(),
            panels: vec![panel],
            bands: vec![],
        })
    };
    Section {
        title: format!("Robustness: {label}"),
        words: "Success in percent at every scale; area: its mean along the axis by trapezoids, 0 to 100.".into(),
        figures: sweep.axes.iter().enumerate().map(figure).collect(),
        table: grid(["task".to_owned()].into_iter().chain(head), rows.collect()),
    }
}

fn learning(sources: &[Source]) -> Section {
    let trained: Vec<&Source> = sources.iter().filter(|source| !source.curve.is_empty()).collect();
    let rows = trained.iter().map(|source| {
        let peak = peak::peak(source.curve.iter().map(|[steps, total, _]| (*steps, *total)));
        let cell = |part: fn((f64, f64)) -> f64| peak.map_or("-".into(), |peak| for_people(part(peak)));
        let last = source.curve.last().map_or("-".into(), |[steps, ..]| for_people(*steps));
        vec![source.label.clone(), cell(|(steps, _)| steps), cell(|(_, total)| total), last]
    });
    let figures = trained.iter().map(|source| {
        let curve = |part: usize, name: &str| Panel {
            label: name.to_owned(),
            curves: vec![(String::new(), source.curve.iter().map(|point| point[part]).collect())],
        };
        let at = source.curve.iter().map(|[steps, ..]| *steps).collect();
        let panels = vec![curve(1, "mean return"), curve(2, "success, part")];
        chart::svg(&Chart { title: source.label.clone(), axis: "environment steps".into(), at, panels, bands: vec![] })
    });
    Section {
        title: "Learning".into(),
        words: "Peak-efficiency steps: the least number of environment steps with the largest mean return.".into(),
        table: grid(["training", "peak-efficiency steps", "return there", "steps"].map(String::from), rows.collect()),
        figures: figures.collect(),
    }
}
