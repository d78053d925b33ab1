//! Radars: of families, coverage and robustness, and one for each family over the axes of the paper: success, robustness to three
//! perturbations, learning speed, activation cost, smoothness, and similarity with electromyograms.

use super::Section;
use super::episodes::Compared;
use super::paper::{Column, standard, steps};
use super::read::Source;
use msk::draw::radar;
use msk::evaluate::Summary;
use msk::evaluate::metrics::similarity::mean_correlation;
use msk::evaluate::sweep::{Axis, Sweep};
use msk::physics::scalar::Real;

/// Fewest axes that are drawn.
const FEWEST: usize = 3;

/// Families, coverage, and the areas of the sweep of the same label, on axes from 0 to 100.
pub fn of_all(
    names: &[&str],
    success: &dyn Fn(&str) -> Vec<Option<f64>>,
    evaluated: &[(&str, &Summary)],
    swept: &[(&str, &Sweep)],
) -> String {
    let mut axes: Vec<String> = names.iter().map(|name| format!("{name}: success")).collect();
    axes.push("coverage".into());
    let kinds: Vec<&str> = swept.first().map_or(vec![], |(_, sweep)| sweep.axes.iter().map(|(axis, _)| axis.name()).collect());
    axes.extend(kinds.iter().map(|kind| format!("{kind} noise: area")));
    let series = evaluated.iter().enumerate().map(|(place, (label, summary))| {
        let mut values: Vec<f64> = names.iter().map(|name| 100.0 * success(name)[place].unwrap_or(0.0)).collect();
        let covered = summary.tasks.iter().filter(|task| task.successes > 0).count();
        values.push(100.0 * covered as f64 / summary.tasks.len().max(1) as f64);
        let own = swept.iter().find(|(known, _)| known == label);
        values.extend(kinds.iter().map(|kind| {
            let place = own.and_then(|(_, sweep)| sweep.axes.iter().position(|(axis, _)| axis.name() == *kind));
            place.zip(own).and_then(|(place, (_, sweep))| sweep.overall.curves[place].area).unwrap_or(0.0)
        }));
        ((*label).to_owned(), values)
    });
    radar::svg("Success and robustness, 0 to 100", &axes, &series.collect::<Vec<_>>())
}

/// How the value of an axis becomes a number from 0 to 100.
#[derive(Clone, Copy)]
enum Scale {
    /// It is one.
    Percent,
    /// Of the policy with the least value 100, of others the least over their own.
    LeastIsBest,
}

/// A radar for each family that policies were evaluated on; empty where there are too few axes.
pub fn section(columns: &[Column<'_>], sources: &[Source], compared: &[Compared]) -> Section {
    let mut families: Vec<&str> = Vec::new();
    for family in columns.iter().filter_map(|column| column.summary).flat_map(|summary| &summary.families) {
        if !families.contains(&family.name.as_str()) {
            families.push(&family.name);
        }
    }
    Section {
        title: "Axes of the paper".into(),
        words: "Means over the tasks of a family, outward is better. Success, areas under perturbations and r are in percent; of learning \
                speed (peak-efficiency steps), activation cost and smoothness (log10) the best policy has 100, others the best value over \
                their own. Axes of which nothing is known are left out; where one policy lacks a value it is at the centre."
            .into(),
        table: None,
        figures: families.iter().filter_map(|family| figure(family, columns, sources, compared)).collect(),
    }
}

fn figure(family: &str, columns: &[Column<'_>], sources: &[Source], compared: &[Compared]) -> Option<String> {
    let columns: Vec<&Column<'_>> = columns.iter().filter(|column| column.summary.is_some()).collect();
    let area = |axis: Axis| {
        move |column: &Column<'_>| {
            let place = column.sweep?.axes.iter().position(|(known, _)| *known == axis)?;
            column.sweep?.families.iter().find(|known| known.name == family)?.curves.get(place)?.area
        }
    };
    let mean_of = |name: &'static str| {
        move |column: &Column<'_>| {
            let tasks = column.summary?.tasks.iter().filter(|task| task.family == family);
            mean(tasks.filter_map(|task| standard(task, name)))
        }
    };
    let success = |column: &Column<'_>| {
        let found = column.summary?.families.iter().find(|known| known.name == family)?;
        found.success_rate.map(|rate| 100.0 * rate)
    };
    let similar = |column: &Column<'_>| {
        let own = |compared: &&Compared| {
            compared.policy == column.name && column.task(&compared.task).is_some_and(|task| task.family == family)
        };
        mean(compared.iter().filter(own).filter_map(|compared| mean_correlation(&compared.found))).map(|r| 100.0 * r)
    };
    let (action, observation, gain) = (area(Axis::Action), area(Axis::Observation), area(Axis::Gain));
    let (cost, jerk) = (mean_of("activation_cost"), mean_of("joint_smoothness"));
    let trained = |column: &Column<'_>| steps(column.name, sources);
    let all: [(&str, Scale, Of<'_>); 8] = [
        ("success", Scale::Percent, &success),
        ("action noise", Scale::Percent, &action),
        ("observation noise", Scale::Percent, &observation),
        ("dynamics", Scale::Percent, &gain),
        ("learning speed", Scale::LeastIsBest, &trained),
        ("activation cost", Scale::LeastIsBest, &cost),
        ("smoothness", Scale::LeastIsBest, &jerk),
        ("electromyograms", Scale::Percent, &similar),
    ];
    let axes = all.iter().map(|(name, scale, of)| (*name, scaled(*scale, columns.iter().map(|column| of(column)).collect())));
    let axes: Vec<(&str, Vec<f64>)> = axes.filter(|(_, values)| values.iter().any(|value| value.is_finite())).collect();
    let names: Vec<String> = axes.iter().map(|(name, _)| (*name).to_owned()).collect();
    let series: Vec<(String, Vec<f64>)> = columns
        .iter()
        .enumerate()
        .map(|(place, column)| (column.name.to_owned(), axes.iter().map(|(_, values)| values[place]).collect()))
        .collect();
    let title = if family.is_empty() { "no family" } else { family };
    (names.len() >= FEWEST).then(|| radar::svg(&format!("{title}, 0 to 100"), &names, &series))
}

/// What an axis shows of a policy, if it is known.
type Of<'a> = &'a dyn Fn(&Column<'_>) -> Option<f64>;

/// The values of an axis from 0 to 100; what is not known is no number.
fn scaled(scale: Scale, values: Vec<Option<f64>>) -> Vec<f64> {
    let known = values.iter().flatten().copied().filter(|value| *value > 0.0);
    let least = known.fold(f64::INFINITY, |least, value| least.at_most(value));
    let of = |value: Option<f64>| match (value, scale) {
        (None, _) => f64::NAN,
        (Some(value), Scale::Percent) => value.clip(0.0, 100.0),
        // What is nothing or less cannot be beaten.
        (Some(value), Scale::LeastIsBest) => {
            if value > 0.0 {
                100.0 * least / value
            } else {
                100.0
            }
        }
    };
    values.into_iter().map(of).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_of_what_costs_has_a_hundred() {
        assert_eq!(scaled(Scale::LeastIsBest, vec![Some(4.0), Some(2.0), None])[..2], [50.0, 100.0]);
        assert_eq!(scaled(Scale::LeastIsBest, vec![Some(-1.0), Some(2.0)]), [100.0, 100.0]);
        assert!(scaled(Scale::Percent, vec![None])[0].is_nan());
        assert_eq!(scaled(Scale::Percent, vec![Some(-20.0), Some(70.0)]), [0.0, 70.0]);
    }

    #[test]
    fn a_family_has_a_radar_over_what_is_known() {
        let summary: msk::evaluate::Summary = serde_json::from_value(serde_json::json!({
            "policy": "cmc", "protocol": { "episodes": 5, "seed": 0 },
            "families": [{ "name": "locomotion", "tasks": 1, "evaluated": 1, "success_rate": 0.5, "horizon_part": null }],
            "overall": { "name": "all tasks", "tasks": 1, "evaluated": 1, "success_rate": 0.5, "horizon_part": null },
            "tasks": [{
                "task": "walk", "family": "locomotion", "horizon": 10, "episodes": 5, "successes": 2, "success_rate": 0.4,
                "success_interval": [0.0, 1.0], "return": null, "steps": null, "ended_by": [], "faults": [], "terms": [], "metrics": [],
                "standard": [
                    { "name": "activation_cost", "unit": "", "episodes": 5, "value": { "mean": 0.25, "deviation": null } },
                    { "name": "joint_smoothness", "unit": "", "episodes": 5, "value": { "mean": 5.0, "deviation": null } },
                ],
            }],
        }))
        .unwrap();
        let columns = [Column { name: "cmc", summary: Some(&summary), sweep: None }];
        let found = section(&columns, &[], &[]);
        assert_eq!(found.figures.len(), 1);
        for part in ["locomotion, 0 to 100", "success", "activation cost", "smoothness"] {
            assert!(found.figures[0].contains(part), "no `{part}`");
        }
        assert!(!found.figures[0].contains("electromyograms"));
    }
}
