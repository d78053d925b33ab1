//! Two evaluations of the same episodes, side by side: differences with intervals.
//!
//! Episodes of one seed and index begin in the same state, so they are compared in pairs. Intervals are percentile bootstraps (Efron and
//! Tibshirani 1993) at 95 % over the pairs. Returns are summed up by the interquartile mean, which outliers do not move as they move the
//! mean and which wastes fewer episodes than the median (Agarwal et al., NeurIPS 2021, "rliable").

use crate::EpisodeRecord;
use crate::statistics::quantile;
use msk_runtime::condition::MuscleCondition;
use msk_runtime::episode::{EpisodeKey, Stream};
use serde::Serialize;
use std::collections::BTreeMap;

/// Resamples of a bootstrap.
const RESAMPLES: usize = 2000;

/// A number with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Of all episodes.
    pub value: f64,
    /// 95 % interval.
    pub interval: [f64; 2],
}

/// A task under both evaluations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pairing {
    /// The task.
    pub task: String,
    /// Conditions of the muscles; empty where they are healthy.
    pub conditions: [String; 2],
    /// Hashes of the task.
    pub task_hashes: [String; 2],
    /// Hashes of the body's model.
    pub model_hashes: [String; 2],
    /// Episodes that both have.
    pub pairs: usize,
    /// Success rates, 0..1.
    pub success: [f64; 2],
    /// Second minus first.
    pub success_difference: Estimate,
    /// Interquartile means of the returns.
    pub returns: [Estimate; 2],
    /// Interquartile mean of the differences of the returns, second minus first.
    pub return_difference: Estimate,
}

/// Mean of the middle half: a quarter of the values, rounded down, is left out at each end, as SciPy's `trim_mean(values, 0.25)` has it.
/// NaN without values.
pub fn interquartile_mean(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let cut = sorted.len() / 4;
    let middle = &sorted[cut..sorted.len() - cut];
    middle.iter().sum::<f64>() / middle.len() as f64
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// A statistic with its percentile bootstrap; `name` decides the resamples, so that the same values have the same interval.
pub fn bootstrap(values: &[f64], statistic: fn(&[f64]) -> f64, name: &str) -> Estimate {
    let mut stream = Stream::new(EpisodeKey::default(), &format!("bootstrap/{name}"));
    let count = values.len();
    let mut resample = vec![0.0; count];
    let mut found: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            // A uniform number below 1 times the count is below the count.
            resample.iter_mut().for_each(|value| *value = values[((stream.uniform() * count as f64) as usize).min(count - 1)]);
            statistic(&resample)
        })
        .collect();
    found.sort_by(f64::total_cmp);
    Estimate { value: statistic(values), interval: [quantile(&found, 0.025), quantile(&found, 0.975)] }
}

/// What is compared of an evaluation: of each episode its success and return.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcomes {
    /// Name of the policy; empty without episodes.
    pub policy: String,
    tasks: Vec<TaskOutcomes>,
}

#[derive(Debug, Clone, PartialEq)]
struct TaskOutcomes {
    task: String,
    condition: MuscleCondition,
    hash: String,
    model_hash: String,
    /// Success and return by seed and index.
    episodes: BTreeMap<(u64, u64), (bool, f64)>,
}

impl Outcomes {
    /// Adds an episode.
    pub fn add(&mut self, record: &EpisodeRecord) {
        if self.policy.is_empty() {
            self.policy.clone_from(&record.policy);
        }
        let known = self.tasks.iter().position(|known| known.task == record.task && known.condition == record.condition);
        let place = known.unwrap_or_else(|| {
            self.tasks.push(TaskOutcomes {
                task: record.task.clone(),
                condition: record.condition.clone(),
                hash: record.task_hash.clone(),
                model_hash: record.model_hash.clone(),
                episodes: BTreeMap::new(),
            });
            self.tasks.len() - 1
        });
        self.tasks[place].episodes.insert((record.seed, record.episode), (record.success, record.total));
    }

    /// The task under the same condition, or under the only one that it was evaluated under.
    fn partner(&self, task: &TaskOutcomes) -> Option<&TaskOutcomes> {
        let same: Vec<&TaskOutcomes> = self.tasks.iter().filter(|known| known.task == task.task).collect();
        let exact = same.iter().find(|known| known.condition == task.condition);
        exact.or_else(|| same.first().filter(|_| same.len() == 1)).copied()
    }
}

impl<'a> FromIterator<&'a EpisodeRecord> for Outcomes {
    fn from_iter<I: IntoIterator<Item = &'a EpisodeRecord>>(records: I) -> Self {
        let mut outcomes = Self::default();
        records.into_iter().for_each(|record| outcomes.add(record));
        outcomes
    }
}

/// Compares the episodes that two evaluations have in common, task by task in the order of the first; tasks without a pair are left out.
/// A task is compared under the same condition where both have that, else under another one, which the pairing names.
/// Pairs are of the same task, seed and index; a return that is not finite makes no pair.
pub fn compare(first: &Outcomes, second: &Outcomes) -> Vec<Pairing> {
    first.tasks.iter().filter_map(|task| pairing(task, second.partner(task)?)).collect()
}

fn pairing(first: &TaskOutcomes, second: &TaskOutcomes) -> Option<Pairing> {
    let pairs = first.episodes.iter().filter_map(|(key, one)| Some([*one, *second.episodes.get(key)?]));
    let pairs: Vec<[(bool, f64); 2]> = pairs.filter(|pair| pair.iter().all(|(_, total)| total.is_finite())).collect();
    if pairs.is_empty() {
        return None;
    }
    let of = |value: &dyn Fn([(bool, f64); 2]) -> f64| -> Vec<f64> { pairs.iter().map(|pair| value(*pair)).collect() };
    let success = |(success, _): (bool, f64)| f64::from(u8::from(success));
    let returns = [of(&|[(_, first), _]| first), of(&|[_, (_, second)]| second)];
    let differences = of(&|[first, second]| success(second) - success(first));
    let task = &first.task;
    Some(Pairing {
        task: task.clone(),
        conditions: [first, second].map(|of| if of.condition.is_none() { String::new() } else { of.condition.to_string() }),
        task_hashes: [first, second].map(|of| of.hash.clone()),
        model_hashes: [first, second].map(|of| of.model_hash.clone()),
        pairs: pairs.len(),
        success: [mean(&of(&|[first, _]| success(first))), mean(&of(&|[_, second]| success(second)))],
        success_difference: bootstrap(&differences, mean, &format!("{task}/success")),
        returns: returns.map(|returns| bootstrap(&returns, interquartile_mean, &format!("{task}/return"))),
        return_difference: bootstrap(
            &of(&|[(_, first), (_, second)]| second - first),
            interquartile_mean,
            &format!("{task}/difference"),
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(task: &str, episode: u64, success: bool, total: f64) -> EpisodeRecord {
        let line = format!(
            r#"{{"task":"{task}","policy":"zero","seed":0,"episode":{episode},"success":{success},"terminated_by":[],"truncated":true,
            "fault":null,"steps":10,"return":{total},"terms":{{}},"values":{{}},"task_hash":"a","model_hash":"b"}}"#
        );
        serde_json::from_str(&line).unwrap()
    }

    #[test]
    fn the_interquartile_mean_is_scipys() {
        // tests/oracle/metrics.py: trim_mean(values, 0.25)
        assert!((interquartile_mean(&[9.0, 1.0, 2.0, 3.0, 100.0, -50.0, 4.0]) - 3.8).abs() < 1e-12);
        assert!((interquartile_mean(&[1.0, 2.0, 3.0, 10.0]) - 2.5).abs() < 1e-12);
        assert_eq!(interquartile_mean(&[7.0]), 7.0);
    }

    #[test]
    fn an_interval_holds_its_value_and_narrows() {
        let values = |count: u32| (0..count).map(|index| f64::from(index % 10)).collect::<Vec<_>>();
        let few = bootstrap(&values(20), mean, "a");
        let many = bootstrap(&values(2000), mean, "a");
        assert_eq!((few.value, many.value), (4.5, 4.5));
        let width = |estimate: Estimate| estimate.interval[1] - estimate.interval[0];
        // The standard error of the mean of ten digits is 2.872 / sqrt(n), the interval 3.92 times as wide.
        assert!((width(few) - 3.92 * 2.872 / 20_f64.sqrt()).abs() < 0.2, "{few:?}");
        assert!((width(many) - 3.92 * 2.872 / 2000_f64.sqrt()).abs() < 0.02, "{many:?}");
        assert_eq!(bootstrap(&values(20), mean, "a"), few);
        assert_eq!(bootstrap(&[2.0; 5], mean, "b"), Estimate { value: 2.0, interval: [2.0, 2.0] });
    }

    #[test]
    fn episodes_are_compared_in_pairs() {
        let first: Vec<EpisodeRecord> = (0..8).map(|index| record("stand", index, index < 4, index as f64)).collect();
        // Each is better by one; the order of lines does not matter, and two have no partner.
        let mut second: Vec<EpisodeRecord> = (2..10).map(|index| record("stand", index, true, index as f64 + 1.0)).collect();
        second.reverse();
        second.push(record("walk", 0, true, 1.0));
        let (first, second): (Outcomes, Outcomes) = (first.iter().collect(), second.iter().collect());
        let found = compare(&first, &second);
        let [stand] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((stand.pairs, stand.success), (6, [2.0 / 6.0, 1.0]));
        assert_eq!(stand.return_difference, Estimate { value: 1.0, interval: [1.0, 1.0] });
        assert!(stand.success_difference.interval[0] > 0.0, "{stand:?}");
        assert!(compare(&first, &Outcomes::default()).is_empty());
    }
}
