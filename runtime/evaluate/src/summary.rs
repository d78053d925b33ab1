//! All episodes of a run, summed up per task.

use super::metrics::{STANDARD, shares};
use super::record::metric_units;
use super::{EpisodeRecord, Plan, Protocol, RunSettings, Spread, wilson_interval};
use msk_runtime::condition::MuscleCondition;
use serde::{Deserialize, Serialize};

/// A run in numbers. It depends on the journal's content alone, not on the order of its lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the policy.
    pub policy: String,
    /// Episodes and seed asked for.
    pub protocol: Protocol,
    /// Means over the tasks of each family, in the order of the families' first tasks.
    pub families: Vec<GroupSummary>,
    /// Means over all tasks.
    pub overall: GroupSummary,
    /// One entry per task, in the plan's order.
    pub tasks: Vec<TaskSummary>,
}

/// Means over several tasks, each of which counts the same however many episodes it has. Tasks without episodes do not count.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GroupSummary {
    /// The family; `all tasks`.
    pub name: String,
    /// Tasks of the group.
    pub tasks: usize,
    /// Those that have episodes.
    pub evaluated: usize,
    /// Mean success rate, 0..1.
    pub success_rate: Option<f64>,
    /// Mean part of the horizon that episodes lasted, 0..1.
    pub horizon_part: Option<f64>,
}

/// The episodes of one task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TaskSummary {
    /// Name of the task.
    pub task: String,
    /// Family it belongs to.
    pub family: String,
    /// Condition of the body's muscles.
    #[serde(default, skip_serializing_if = "MuscleCondition::is_none")]
    pub condition: MuscleCondition,
    /// Why the policy cannot act on it, if it cannot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skipped: Option<String>,
    /// Control steps of a full episode.
    pub horizon: u32,
    /// Episodes that have ended.
    pub episodes: u64,
    /// Those that succeeded.
    pub successes: u64,
    /// Successes per episode, 0..1; `None` without episodes.
    pub success_rate: Option<f64>,
    /// Wilson's 95 % interval of the success rate.
    pub success_interval: [f64; 2],
    /// Sum of rewards per episode.
    #[serde(rename = "return")]
    pub total: Option<Spread>,
    /// Control steps per episode.
    pub steps: Option<Spread>,
    /// How episodes ended and how many did so, the most frequent first.
    pub ended_by: Vec<(String, u64)>,
    /// Episodes that a fault ended, with what broke.
    pub faults: Vec<(u64, String)>,
    /// One entry per reward term, in the task's order.
    pub terms: Vec<TermSummary>,
    /// Versions of weights that rewarded the episodes, and how many each did; empty where weights do not change.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub weights_versions: Vec<(String, u64)>,
    /// One entry per number that is logged, in the task's order.
    pub metrics: Vec<MetricSummary>,
    /// One entry per standard metric that some episode has.
    #[serde(default)]
    pub standard: Vec<StandardSummary>,
    /// One entry per recruitment family.
    #[serde(default)]
    pub recruitment: Vec<FamilySummary>,
}

/// A standard metric over the episodes of a task that have it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StandardSummary {
    /// Its name.
    pub name: String,
    /// Unit; empty if it is dimensionless.
    pub unit: String,
    /// Episodes that have it.
    pub episodes: u64,
    /// Of these.
    pub value: Spread,
}

/// A recruitment family over the episodes of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FamilySummary {
    /// The family.
    pub name: String,
    /// Mean activation mass: sum over its muscles of the mean activation.
    pub mass: f64,
    /// Its part of the mass of all families, 0..1.
    pub share: f64,
}

/// A logged number over the episodes of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MetricSummary {
    /// Label.
    pub name: String,
    /// Unit of its values; empty for plain numbers.
    pub unit: String,
    /// Its mean over the steps of an episode; of the episodes in which it was a number.
    pub mean: Option<Spread>,
    /// Its value at the last step.
    pub last: Option<Spread>,
}

/// One reward term over all steps of all episodes of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermSummary {
    /// Label.
    pub name: String,
    /// Weight.
    pub weight: f64,
    /// Mean unweighted value per step; `None` without steps.
    pub value_per_step: Option<f64>,
    /// Mean of weight times value per step.
    pub pay_per_step: Option<f64>,
    /// Part of the contributions of all terms: contribution / Σ |contribution|, in -1..1. Where no term costs anything this
    /// is the share of the return; unlike that share it stays meaningful when gains and costs cancel.
    pub share: Option<f64>,
}

impl Summary {
    /// Of the episodes of a plan.
    pub fn of(plan: &Plan, records: &[EpisodeRecord]) -> Self {
        let settings = RunSettings::of(plan);
        let tasks = settings.tasks.iter().zip(&plan.trials).map(|(task, trial)| {
            let episodes: Vec<&EpisodeRecord> = records.iter().filter(|record| task.owns(record)).collect();
            let successes = episodes.iter().filter(|record| record.success).count() as u64;
            let trials = episodes.len() as u64;
            let spread =
                |number: fn(&EpisodeRecord) -> f64| Spread::of(&episodes.iter().map(|record| number(record)).collect::<Vec<_>>());
            TaskSummary {
                task: task.name.clone(),
                family: task.family.clone(),
                condition: task.condition.clone(),
                skipped: None,
                horizon: task.horizon,
                episodes: trials,
                successes,
                success_rate: (trials > 0).then(|| successes as f64 / trials as f64),
                success_interval: wilson_interval(successes, trials),
                total: spread(|record| record.total),
                steps: spread(|record| f64::from(record.steps)),
                ended_by: endings(&episodes),
                faults: faults(&episodes),
                terms: terms(&task.weights, &episodes),
                weights_versions: versions(&episodes),
                metrics: metrics(&metric_units(&trial.task), &episodes),
                standard: standard(&episodes),
                recruitment: recruitment(&episodes),
            }
        });
        Self::new(settings.policy, settings.protocol, tasks.collect())
    }

    /// Of summaries of tasks.
    pub fn new(policy: String, protocol: Protocol, tasks: Vec<TaskSummary>) -> Self {
        let mut names: Vec<&str> = Vec::new();
        for task in &tasks {
            if !names.contains(&task.family.as_str()) {
                names.push(&task.family);
            }
        }
        let of = |name: &&str| GroupSummary::of(name, tasks.iter().filter(|task| task.family == **name));
        let families = names.iter().map(of).collect();
        Self { policy, protocol, families, overall: GroupSummary::of("all tasks", tasks.iter()), tasks }
    }

    /// The same, with the reasons why the policy cannot act on tasks, by their place in the plan.
    pub fn with_skipped(mut self, skipped: &[(usize, String)]) -> Self {
        for (trial, reason) in skipped {
            if let Some(task) = self.tasks.get_mut(*trial) {
                task.skipped = Some(reason.clone());
            }
        }
        self
    }

    /// As JSON.
    pub fn json(&self) -> String {
        super::journal::pretty(self) + "\n"
    }
}

impl TaskSummary {
    /// Mean part of the horizon that episodes lasted, 0..1.
    pub fn horizon_part(&self) -> Option<f64> {
        self.steps.map(|steps| steps.mean / f64::from(self.horizon.max(1)))
    }
}

impl GroupSummary {
    fn of<'a>(name: &str, tasks: impl Iterator<Item = &'a TaskSummary>) -> Self {
        let tasks: Vec<&TaskSummary> = tasks.collect();
        let mean = |number: fn(&TaskSummary) -> Option<f64>| {
            let numbers: Vec<f64> = tasks.iter().filter_map(|task| number(task)).collect();
            Spread::of(&numbers).map(|spread| spread.mean)
        };
        Self {
            name: name.to_owned(),
            tasks: tasks.len(),
            evaluated: tasks.iter().filter(|task| task.episodes > 0).count(),
            success_rate: mean(|task| task.success_rate),
            horizon_part: mean(TaskSummary::horizon_part),
        }
    }
}

fn endings(episodes: &[&EpisodeRecord]) -> Vec<(String, u64)> {
    let mut counts = std::collections::BTreeMap::<String, u64>::new();
    for record in episodes {
        *counts.entry(record.ended_by()).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    // The sort is stable: equal counts stay in alphabetical order.
    counts.sort_by_key(|(_, count)| core::cmp::Reverse(*count));
    counts
}

fn faults(episodes: &[&EpisodeRecord]) -> Vec<(u64, String)> {
    episodes.iter().filter_map(|record| Some((record.episode, record.fault.clone()?))).collect()
}

fn terms(weights: &[(String, f64)], episodes: &[&EpisodeRecord]) -> Vec<TermSummary> {
    let weights = in_force(weights, episodes);
    let steps: f64 = episodes.iter().map(|record| f64::from(record.steps)).sum();
    let sum = |index: usize, part: fn(&EpisodeRecord) -> &super::ByTerm| -> f64 {
        episodes.iter().filter_map(|record| part(record).0.get(index)).map(|(_, sum)| sum).sum()
    };
    let contributions: Vec<f64> = (0..weights.len()).map(|index| sum(index, |record| &record.terms)).collect();
    let magnitude: f64 = contributions.iter().map(|contribution| contribution.abs()).sum();
    let rows = weights.iter().zip(&contributions).enumerate().map(|(index, ((name, weight), &contribution))| TermSummary {
        name: name.clone(),
        weight: *weight,
        value_per_step: (steps > 0.0).then(|| sum(index, |record| &record.values) / steps),
        pay_per_step: (steps > 0.0).then(|| contribution / steps),
        share: (magnitude > 0.0).then(|| contribution / magnitude),
    });
    rows.collect()
}

/// The weight of each term; where they changed while the run went on, their mean over the episodes.
fn in_force(weights: &[(String, f64)], episodes: &[&EpisodeRecord]) -> Vec<(String, f64)> {
    let weighted: Vec<&EpisodeRecord> =
        episodes.iter().copied().filter(|record| record.weights.0.len() == weights.len()).collect();
    let Some(first) = weighted.first() else { return weights.to_vec() };
    let mean = |index: usize| {
        let same = weighted.iter().all(|record| record.weights.0[index].1 == first.weights.0[index].1);
        let sum: f64 = weighted.iter().map(|record| record.weights.0[index].1).sum();
        if same { first.weights.0[index].1 } else { sum / weighted.len() as f64 }
    };
    weights.iter().enumerate().map(|(index, (name, _))| (name.clone(), mean(index))).collect()
}

/// The versions of weights that rewarded the episodes, in the order of the episodes, and how many each did.
fn versions(episodes: &[&EpisodeRecord]) -> Vec<(String, u64)> {
    let mut versions: Vec<(String, u64)> = Vec::new();
    for record in episodes.iter().filter(|record| !record.weights_version.is_empty()) {
        match versions.iter_mut().find(|(version, _)| *version == record.weights_version) {
            Some((_, count)) => *count += 1,
            None => versions.push((record.weights_version.clone(), 1)),
        }
    }
    versions
}

/// The numbers that are logged, with their units in the same order.
fn metrics(units: &[String], episodes: &[&EpisodeRecord]) -> Vec<MetricSummary> {
    let Some(first) = episodes.first() else { return Vec::new() };
    let spread = |index: usize, part: fn(&EpisodeRecord) -> &super::ByTerm| {
        let numbers = episodes.iter().filter_map(|record| part(record).0.get(index)).map(|(_, number)| *number);
        let numbers: Vec<f64> = numbers.filter(|number| number.is_finite()).collect();
        Spread::of(&numbers)
    };
    let summaries = first.metrics.0.iter().enumerate().map(|(index, (name, _))| MetricSummary {
        name: name.clone(),
        unit: units.get(index).cloned().unwrap_or_default(),
        mean: spread(index, |record| &record.metrics),
        last: spread(index, |record| &record.last_metrics),
    });
    summaries.collect()
}

/// The standard metrics that some episode has.
fn standard(episodes: &[&EpisodeRecord]) -> Vec<StandardSummary> {
    let summaries = STANDARD.iter().filter_map(|(name, unit)| {
        let of = |record: &&EpisodeRecord| record.standard.get(name);
        let values: Vec<f64> = episodes.iter().filter_map(of).collect();
        let value = Spread::of(&values)?;
        Some(StandardSummary { name: (*name).to_owned(), unit: (*unit).to_owned(), episodes: values.len() as u64, value })
    });
    summaries.collect()
}

/// Mean activation masses of the families, and their shares.
fn recruitment(episodes: &[&EpisodeRecord]) -> Vec<FamilySummary> {
    let Some(first) = episodes.iter().find(|record| !record.recruitment.is_empty()) else { return Vec::new() };
    let mean = |name: &String| {
        let masses: Vec<f64> = episodes.iter().filter_map(|record| record.recruitment.get(name)).collect();
        (name.clone(), Spread::of(&masses).map_or(0.0, |spread| spread.mean))
    };
    let masses: Vec<(String, f64)> = first.recruitment.0.iter().map(|(name, _)| mean(name)).collect();
    let shares = shares(&masses);
    masses.into_iter().zip(shares).map(|((name, mass), (_, share))| FamilySummary { name, mass, share }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::ByTerm;
    use super::*;

    fn record(episode: u64, steps: u32, pose: f64, effort: f64, ended: &str) -> EpisodeRecord {
        let horizon = ended == "horizon";
        let by_term = |pose: f64, effort: f64| ByTerm(vec![("pose".into(), pose), ("effort".into(), effort)]);
        EpisodeRecord {
            task: "stand".into(),
            policy: "zero".into(),
            seed: 0,
            episode,
            success: horizon,
            terminated_by: if horizon { vec![] } else { vec![ended.into()] },
            finished_by: vec![],
            truncated: horizon,
            awaited: String::new(),
            fault: None,
            steps,
            total: pose + effort,
            terms: by_term(pose, effort),
            values: by_term(pose / 10.0, -effort),
            squares: ByTerm::default(),
            dead: ByTerm::default(),
            saturated: ByTerm::default(),
            weights_version: String::new(),
            weights: ByTerm::default(),
            parameters: ByTerm::default(),
            metrics: ByTerm(vec![("lean".into(), pose)]),
            last_metrics: ByTerm(vec![("lean".into(), f64::NAN)]),
            standard: ByTerm(vec![("activation_cost".into(), pose)]),
            recruitment: ByTerm(vec![("Calves".into(), 3.0), ("Glutes".into(), 1.0)]),
            task_hash: String::new(),
            model_hash: String::new(),
            condition: Default::default(),
            wall_time: 0.0,
        }
    }

    #[test]
    fn terms_are_averaged_over_steps_and_shares_over_what_was_paid_and_charged() {
        let episodes = [record(0, 10, 60.0, -10.0, "horizon"), record(1, 30, 20.0, -10.0, "fallen")];
        let weights = [("pose".to_string(), 10.0), ("effort".to_string(), -1.0)];
        let terms = terms(&weights, &episodes.iter().collect::<Vec<_>>());
        assert_eq!(terms[0].value_per_step, Some(0.2));
        assert_eq!(terms[0].pay_per_step, Some(2.0));
        assert_eq!(terms[0].share, Some(0.8));
        assert_eq!(terms[1].value_per_step, Some(0.5));
        assert_eq!(terms[1].share, Some(-0.2));
    }

    #[test]
    fn metrics_are_averaged_over_the_episodes_in_which_they_are_numbers() {
        let episodes = [record(0, 10, 60.0, -10.0, "horizon"), record(1, 30, 20.0, -10.0, "fallen")];
        let metrics = metrics(&["rad".to_owned()], &episodes.iter().collect::<Vec<_>>());
        assert_eq!(metrics[0].name, "lean");
        assert_eq!(metrics[0].mean.map(|spread| spread.mean), Some(40.0));
        assert_eq!(metrics[0].last, None);
    }

    #[test]
    fn nothing_run_is_nothing_known() {
        let weights = [("pose".to_string(), 10.0)];
        let term = terms(&weights, &[]).remove(0);
        assert_eq!((term.value_per_step, term.pay_per_step, term.share), (None, None, None));
    }

    #[test]
    fn endings_are_counted_the_most_frequent_first() {
        let ends = ["tilted", "fallen", "horizon", "horizon"];
        let episodes: Vec<_> = (0..).zip(ends).map(|(i, end)| record(i, 10, 1.0, 0.0, end)).collect();
        let counted = endings(&episodes.iter().collect::<Vec<_>>());
        assert_eq!(counted, [("horizon".into(), 2), ("fallen".into(), 1), ("tilted".into(), 1)]);
    }
}
