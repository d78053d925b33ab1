//! Per-term statistics of episodes: mean value, weighted contribution, correlation with success.

use msk_compiler::task::CompiledTask;
use msk_compiler::weights::Bounds;
use msk_evaluate::{ByTerm, EpisodeRecord, Spread};
use msk_physics::scalar::Real;
use serde::{Deserialize, Serialize};

/// Episodes of one task, summed up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Number of episodes.
    pub episodes: u64,
    /// Control steps of all of them.
    pub steps: u64,
    /// Part of the episodes that succeeded, 0..1.
    pub success_rate: f64,
    /// Control steps survived.
    pub survival: Option<Spread>,
    /// Sum of rewards of an episode.
    #[serde(rename = "return")]
    pub total: Option<Spread>,
    /// How episodes ended and how many did so, the most frequent first.
    pub ended_by: Vec<(String, u64)>,
    /// One entry for each term, in the task's order.
    pub terms: Vec<TermStatistics>,
    /// One entry for each number that the task logs.
    pub metrics: Vec<MetricStatistics>,
}

/// One term over all steps of all episodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermStatistics {
    /// Its name.
    pub term: String,
    /// The weight in force.
    pub weight: f64,
    /// What its author allows the weight to be.
    pub bounds: Allowed,
    /// Whether the weight may be changed at all now.
    pub in_scope: bool,
    /// Between which values the term stays; `None` where it is not bounded on that side.
    pub range: [Option<f64>; 2],
    /// Mean of the unweighted value over the steps.
    pub mean: Option<f64>,
    /// Its standard deviation over the steps.
    pub deviation: Option<f64>,
    /// Part of all contributions, -1..1.
    pub share: Option<f64>,
    /// Correlation of its mean in an episode with whether the episode succeeded, -1..1; `None` where either never varies.
    pub with_success: Option<f64>,
    /// Correlation with the number of steps survived.
    pub with_survival: Option<f64>,
    /// Part of the steps at which it was as large as it can be, to a hundredth.
    pub saturated: Option<f64>,
    /// Part of the steps at which it was nothing, or below a hundredth of its largest size.
    pub dead: Option<f64>,
}

/// What may be done with a weight, as given to a reasoner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Allowed {
    /// Anything that keeps its sign.
    SameSign,
    /// Nothing.
    Fixed,
    /// Anything between the two.
    Between(f64, f64),
}

/// A number that the task logs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MetricStatistics {
    /// Its name.
    pub metric: String,
    /// Unit, empty for plain numbers.
    pub unit: String,
    /// Mean of an episode, over the episodes.
    pub mean: Option<Spread>,
    /// Value at the last step.
    pub last: Option<Spread>,
}

impl Statistics {
    /// Of the episodes of a task of which `weights` are in force and those `in_scope` may be changed.
    pub fn of(task: &CompiledTask, weights: &[f64], in_scope: &[bool], records: &[EpisodeRecord]) -> Self {
        let count = records.len() as f64;
        let successes = records.iter().filter(|record| record.success).count() as f64;
        // Of the episodes in which it is a number: a return may have overflowed.
        let spread = |number: fn(&EpisodeRecord) -> f64| {
            Spread::of(&records.iter().map(number).filter(|number| number.is_finite()).collect::<Vec<_>>())
        };
        Self {
            episodes: records.len() as u64,
            steps: records.iter().map(|record| u64::from(record.steps)).sum(),
            success_rate: if records.is_empty() { 0.0 } else { successes / count },
            survival: spread(|record| f64::from(record.steps)),
            total: spread(|record| record.total),
            ended_by: endings(records),
            terms: terms(task, weights, in_scope, records),
            metrics: metrics(task, records),
        }
    }
}

fn endings(records: &[EpisodeRecord]) -> Vec<(String, u64)> {
    let mut counts = std::collections::BTreeMap::<String, u64>::new();
    for record in records {
        *counts.entry(record.ended_by()).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    // The sort is stable: equal counts stay in alphabetical order.
    counts.sort_by_key(|(_, count)| core::cmp::Reverse(*count));
    counts
}

fn terms(task: &CompiledTask, weights: &[f64], in_scope: &[bool], records: &[EpisodeRecord]) -> Vec<TermStatistics> {
    let steps: f64 = records.iter().map(|record| f64::from(record.steps)).sum();
    let sum = |index: usize, part: fn(&EpisodeRecord) -> &ByTerm| -> f64 {
        records.iter().filter_map(|record| part(record).0.get(index)).map(|(_, sum)| sum).sum()
    };
    let per_step = |total: f64| (steps > 0.0).then(|| total / steps);
    let contributions: Vec<f64> = (0..task.terms.len()).map(|index| sum(index, |record| &record.terms)).collect();
    let magnitude: f64 = contributions.iter().map(|contribution| contribution.abs()).sum();
    let success = |record: &EpisodeRecord| f64::from(u8::from(record.success));
    let survived = |record: &EpisodeRecord| f64::from(record.steps);
    let term = |index: usize| {
        let mean = per_step(sum(index, |record| &record.values));
        let square = per_step(sum(index, |record| &record.squares));
        let [low, high] = task.term_range(index);
        TermStatistics {
            term: task.terms[index].name.clone(),
            weight: weights.get(index).copied().unwrap_or_default(),
            bounds: match task.weight_bounds(index) {
                Bounds::Free => Allowed::SameSign,
                Bounds::Fixed => Allowed::Fixed,
                Bounds::Range(low, high) => Allowed::Between(low, high),
            },
            in_scope: in_scope.get(index).copied().unwrap_or_default(),
            range: [low, high].map(|bound| bound.is_finite().then_some(bound)),
            mean,
            // Rounding may put the mean of the squares a hair below the square of the mean.
            deviation: mean.zip(square).map(|(mean, square)| (square - mean * mean).at_least(0.0).sqrt()),
            share: (magnitude > 0.0).then(|| contributions[index] / magnitude),
            with_success: correlation(index, records, success),
            with_survival: correlation(index, records, survived),
            saturated: per_step(sum(index, |record| &record.saturated)),
            dead: per_step(sum(index, |record| &record.dead)),
        }
    };
    (0..task.terms.len()).map(term).collect()
}

/// Pearson's correlation of a term's mean in an episode with a number of the episode.
fn correlation(term: usize, records: &[EpisodeRecord], number: impl Fn(&EpisodeRecord) -> f64) -> Option<f64> {
    let pair = |record: &EpisodeRecord| {
        let (_, sum) = record.values.0.get(term)?;
        (record.steps > 0 && sum.is_finite()).then(|| (sum / f64::from(record.steps), number(record)))
    };
    let pairs: Vec<(f64, f64)> = records.iter().filter_map(pair).collect();
    let count = pairs.len() as f64;
    let (x, y) = pairs.iter().fold((0.0, 0.0), |(x, y), pair| (x + pair.0 / count, y + pair.1 / count));
    let mut sums = [0.0; 3];
    for (a, b) in &pairs {
        sums[0] += (a - x) * (a - x);
        sums[1] += (b - y) * (b - y);
        sums[2] += (a - x) * (b - y);
    }
    // What varies by rounding alone does not vary.
    let varies = |sum: f64, mean: f64| sum > count * (1e-12 * (1.0 + mean.abs())).squared();
    (pairs.len() > 1 && varies(sums[0], x) && varies(sums[1], y)).then(|| (sums[2] / (sums[0] * sums[1]).sqrt()).clip(-1.0, 1.0))
}

fn metrics(task: &CompiledTask, records: &[EpisodeRecord]) -> Vec<MetricStatistics> {
    let Some(first) = records.first() else { return Vec::new() };
    let spread = |index: usize, part: fn(&EpisodeRecord) -> &ByTerm| {
        let numbers = records.iter().filter_map(|record| part(record).0.get(index)).map(|(_, number)| *number);
        Spread::of(&numbers.filter(|number| number.is_finite()).collect::<Vec<_>>())
    };
    let unit = |label: &str| {
        let name = label.split('[').next().unwrap_or(label);
        task.metrics.iter().find(|metric| metric.name == name).map_or(String::new(), |metric| metric.unit.clone())
    };
    let metric = |(index, (name, _)): (usize, &(String, f64))| MetricStatistics {
        metric: name.clone(),
        unit: unit(name),
        mean: spread(index, |record| &record.metrics),
        last: spread(index, |record| &record.last_metrics),
    };
    first.metrics.0.iter().enumerate().map(metric).collect()
}
