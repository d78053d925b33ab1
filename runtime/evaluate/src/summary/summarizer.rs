//! Sums over episodes that come one after the other, none of which is kept.

use super::{FamilySummary, MetricSummary, StandardSummary, Summary, TaskSummary, TermSummary};
use crate::metrics::{STANDARD, shares};
use crate::record::metric_units;
use crate::settings::TaskSettings;
use crate::statistics::Moments;
use crate::{ByTerm, EpisodeRecord, Plan, RunSettings, wilson_interval};
use std::collections::BTreeMap;

/// Most episodes with a fault whose faults a summary keeps.
const MOST_FAULTS: usize = 100;

/// Sums up a run. The same episodes in the same order have the same bits.
#[derive(Debug, Clone)]
pub struct Summarizer {
    settings: RunSettings,
    tasks: Vec<TaskTally>,
}

impl Summarizer {
    /// Of a plan without episodes.
    pub fn new(plan: &Plan) -> Self {
        Self::of(RunSettings::of(plan), plan.trials.iter().map(|trial| metric_units(&trial.task)).collect())
    }

    /// Of settings, with the units of the metrics of each task.
    pub(crate) fn of(settings: RunSettings, units: Vec<Vec<String>>) -> Self {
        let tasks = settings.tasks.iter().zip(units).map(|(task, units)| TaskTally::new(task, units));
        Self { tasks: tasks.collect(), settings }
    }

    /// Adds an episode; one of another run is left out.
    pub fn add(&mut self, record: &EpisodeRecord) {
        if let Some(task) = self.settings.place(record).and_then(|place| self.tasks.get_mut(place)) {
            task.add(record);
        }
    }

    /// The run so far.
    pub fn summary(&self) -> Summary {
        let tasks = self.tasks.iter().map(TaskTally::summary).collect();
        Summary::new(self.settings.policy.clone(), self.settings.protocol, tasks)
    }
}

/// Sums over the episodes of a task.
#[derive(Debug, Clone)]
pub(super) struct TaskTally {
    task: TaskSettings,
    /// Units of the task's metrics.
    units: Vec<String>,
    episodes: u64,
    successes: u64,
    total: Moments,
    to_success: Moments,
    steps: Moments,
    /// Control steps of all episodes.
    all_steps: f64,
    ended_by: BTreeMap<String, u64>,
    faults: Vec<(u64, String)>,
    terms: Vec<TermTally>,
    versions: Vec<(String, u64)>,
    /// Names of the metrics, mean and last value of each.
    metrics: Vec<(String, [Moments; 2])>,
    /// One for each of [`STANDARD`].
    standard: Vec<Moments>,
    families: Vec<(String, Moments)>,
}

/// Sums over the episodes of a task, of one reward term.
#[derive(Debug, Clone, Copy, Default)]
struct TermTally {
    contribution: f64,
    value: f64,
    /// Weights of episodes that have their own: the first, whether all are equal, and their moments.
    first: Option<f64>,
    differ: bool,
    weights: Moments,
}

impl TaskTally {
    pub fn new(task: &TaskSettings, units: Vec<String>) -> Self {
        Self {
            units,
            episodes: 0,
            successes: 0,
            total: Moments::default(),
            to_success: Moments::default(),
            steps: Moments::default(),
            all_steps: 0.0,
            ended_by: BTreeMap::new(),
            faults: Vec::new(),
            terms: vec![TermTally::default(); task.weights.len()],
            versions: Vec::new(),
            metrics: Vec::new(),
            standard: vec![Moments::default(); STANDARD.len()],
            families: Vec::new(),
            task: task.clone(),
        }
    }

    pub fn add(&mut self, record: &EpisodeRecord) {
        self.episodes += 1;
        self.successes += u64::from(record.success);
        self.total.add(record.total);
        self.to_success.add(record.return_to_success.unwrap_or(record.total));
        self.steps.add(f64::from(record.steps));
        self.all_steps += f64::from(record.steps);
        *self.ended_by.entry(record.ended_by()).or_default() += 1;
        if let Some(fault) = record.fault.as_ref().filter(|_| self.faults.len() < MOST_FAULTS) {
            self.faults.push((record.episode, fault.clone()));
        }
        let own_weights = record.weights.0.len() == self.terms.len();
        for (index, term) in self.terms.iter_mut().enumerate() {
            let of = |part: &ByTerm| part.0.get(index).map_or(0.0, |(_, number)| *number);
            term.contribution += of(&record.terms);
            term.value += of(&record.values);
            if own_weights {
                term.weigh(of(&record.weights));
            }
        }
        self.add_version(&record.weights_version);
        self.add_metrics(record);
        for ((name, _), moments) in STANDARD.iter().zip(&mut self.standard) {
            record.standard.get(name).into_iter().for_each(|value| moments.add(value));
        }
        if self.families.is_empty() {
            self.families = record.recruitment.0.iter().map(|(name, _)| (name.clone(), Moments::default())).collect();
        }
        for (name, moments) in &mut self.families {
            record.recruitment.get(name).into_iter().for_each(|mass| moments.add(mass));
        }
    }

    /// Versions of weights, in the order of the episodes.
    fn add_version(&mut self, version: &str) {
        if version.is_empty() {
            return;
        }
        match self.versions.iter_mut().rev().find(|(known, _)| known == version) {
            Some((_, count)) => *count += 1,
            None => self.versions.push((version.to_owned(), 1)),
        }
    }

    /// Metrics, of the episodes in which they are numbers.
    fn add_metrics(&mut self, record: &EpisodeRecord) {
        if self.metrics.is_empty() {
            self.metrics = record.metrics.0.iter().map(|(name, _)| (name.clone(), Default::default())).collect();
        }
        for (index, (_, moments)) in self.metrics.iter_mut().enumerate() {
            for (moments, part) in moments.iter_mut().zip([&record.metrics, &record.last_metrics]) {
                let value = part.0.get(index).map(|(_, value)| *value).filter(|value| value.is_finite());
                value.into_iter().for_each(|value| moments.add(value));
            }
        }
    }

    pub fn summary(&self) -> TaskSummary {
        let Self { task, episodes, successes, .. } = self;
        TaskSummary {
            task: task.name.clone(),
            family: task.family.clone(),
            condition: task.condition.clone(),
            skipped: None,
            horizon: task.horizon,
            episodes: *episodes,
            successes: *successes,
            success_rate: (*episodes > 0).then(|| *successes as f64 / *episodes as f64),
            success_interval: wilson_interval(*successes, *episodes),
            total: self.total.spread(),
            return_to_success: self.to_success.spread(),
            steps: self.steps.spread(),
            ended_by: self.endings(),
            faults: self.faults.clone(),
            terms: self.terms(),
            weights_versions: self.versions.clone(),
            metrics: self.metrics(),
            standard: self.standard(),
            recruitment: self.recruitment(),
        }
    }

    fn endings(&self) -> Vec<(String, u64)> {
        let mut counts: Vec<_> = self.ended_by.clone().into_iter().collect();
        // The sort is stable: equal counts stay in alphabetical order.
        counts.sort_by_key(|(_, count)| core::cmp::Reverse(*count));
        counts
    }

    fn terms(&self) -> Vec<TermSummary> {
        let magnitude: f64 = self.terms.iter().map(|term| term.contribution.abs()).sum();
        let steps = self.all_steps;
        let row = |((name, weight), term): (&(String, f64), &TermTally)| TermSummary {
            name: name.clone(),
            weight: term.weight().unwrap_or(*weight),
            value_per_step: (steps > 0.0).then(|| term.value / steps),
            pay_per_step: (steps > 0.0).then(|| term.contribution / steps),
            share: (magnitude > 0.0).then(|| term.contribution / magnitude),
        };
        self.task.weights.iter().zip(&self.terms).map(row).collect()
    }

    fn metrics(&self) -> Vec<MetricSummary> {
        let summary = |(index, (name, [mean, last])): (usize, &(String, [Moments; 2]))| MetricSummary {
            name: name.clone(),
            unit: self.units.get(index).cloned().unwrap_or_default(),
            mean: mean.spread(),
            last: last.spread(),
        };
        self.metrics.iter().enumerate().map(summary).collect()
    }

    fn standard(&self) -> Vec<StandardSummary> {
        let summaries = STANDARD.iter().zip(&self.standard).filter_map(|((name, unit), moments)| {
            let value = moments.spread()?;
            Some(StandardSummary { name: (*name).to_owned(), unit: (*unit).to_owned(), episodes: moments.count(), value })
        });
        summaries.collect()
    }

    fn recruitment(&self) -> Vec<FamilySummary> {
        let masses: Vec<(String, f64)> = self.families.iter().map(|(name, moments)| (name.clone(), moments.mean())).collect();
        let shares = shares(&masses);
        masses.into_iter().zip(shares).map(|((name, mass), (_, share))| FamilySummary { name, mass, share }).collect()
    }
}

impl TermTally {
    fn weigh(&mut self, weight: f64) {
        self.differ |= *self.first.get_or_insert(weight) != weight;
        self.weights.add(weight);
    }

    /// The weight that episodes had; where it changed while the run went on, the mean over them.
    fn weight(&self) -> Option<f64> {
        if self.differ { Some(self.weights.mean()) } else { self.first }
    }
}
