//! All episodes of a run, summed up per task.

mod folder;
mod summarizer;

pub(crate) use folder::{BesideJournal, LARGEST};
pub use summarizer::Summarizer;

use super::{EpisodeRecord, Plan, Protocol, Spread};
use msk_runtime::condition::MuscleCondition;
use serde::{Deserialize, Serialize};

/// A run in numbers.
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
    /// Sum of rewards per episode up to the first step at which success held; of others, the whole return.
    #[serde(default)]
    pub return_to_success: Option<Spread>,
    /// Control steps per episode.
    pub steps: Option<Spread>,
    /// How episodes ended and how many did so, the most frequent first.
    pub ended_by: Vec<(String, u64)>,
    /// The first episodes that a fault ended, with what broke; `ended_by` counts all.
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
        let mut summarizer = Summarizer::new(plan);
        records.iter().for_each(|record| summarizer.add(record));
        summarizer.summary()
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
    /// Name of the task, with the condition of the muscles unless they are healthy.
    pub fn name(&self) -> String {
        if self.condition.is_none() { self.task.clone() } else { format!("{} ({})", self.task, self.condition) }
    }

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

#[cfg(test)]
mod tests;
