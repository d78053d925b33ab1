//! What is kept of an episode: one line of the journal.

use super::Trial;
use msk_physics::scalar::Real;
use msk_program::task::CompiledTask;
use msk_runtime::condition::MuscleCondition;
use msk_runtime::episode::{Ending, Episode};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Numbers by the names of the task's terms, in the task's order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ByTerm(pub Vec<(String, f64)>);

impl ByTerm {
    /// The number by a name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }

    /// Whether there is nothing by any name.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// One episode.
///
/// Everything but `wall_time` is a function of the task, the body, the policy, the seed and the episode's index.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EpisodeRecord {
    /// Name of the task.
    pub task: String,
    /// Name of the policy.
    pub policy: String,
    /// Seed of the evaluation.
    pub seed: u64,
    /// Index of the episode, from 0.
    pub episode: u64,
    /// Whether the task's success held at the last step.
    pub success: bool,
    /// The task's reasons for failure at the last step; several may hold.
    pub terminated_by: Vec<String>,
    /// The task's reasons to finish at the last step, which are no failures; several may hold.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub finished_by: Vec<String>,
    /// Whether the horizon was reached and nothing else ended the episode.
    pub truncated: bool,
    /// Of a sequence that reached its horizon before its last phase: the phase, and until what it lasts, which never held.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub awaited: String,
    /// What broke the computation, if anything did.
    pub fault: Option<String>,
    /// Control steps survived.
    pub steps: u32,
    /// Sum of rewards over the steps.
    #[serde(rename = "return", deserialize_with = "number")]
    pub total: f64,
    /// First control step at which the task's success held; none if it never did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub success_step: Option<u32>,
    /// Sum of rewards up to that step, as evaluators count them that stop there; none if success never held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub return_to_success: Option<f64>,
    /// Sum over the steps of each term's weight times value: these add up to the return.
    pub terms: ByTerm,
    /// Sum over the steps of each term's unweighted value.
    pub values: ByTerm,
    /// Sum over the steps of the square of each term's unweighted value.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub squares: ByTerm,
    /// Number of steps at which each term was dead: below a hundredth of the largest size that it can have, or nothing.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub dead: ByTerm,
    /// Number of steps at which each term was saturated: above 99 hundredths of the largest size that it can have.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub saturated: ByTerm,
    /// Version of the weights that rewarded it, where they may change while a run goes on; else empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub weights_version: String,
    /// Those weights.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub weights: ByTerm,
    /// The parameters that the episode had of its own, in SI units; none if the task declares none `per episode`.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub parameters: ByTerm,
    /// The mean of each metric over the steps at which it was a finite number; of lists and vectors element by element.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub metrics: ByTerm,
    /// Each metric at the last step.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub last_metrics: ByTerm,
    /// Its [standard metrics](crate::metrics::STANDARD), those that it has.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub standard: ByTerm,
    /// Activation mass of every recruitment family.
    #[serde(default, skip_serializing_if = "ByTerm::is_empty")]
    pub recruitment: ByTerm,
    /// Hash of the compiled task.
    pub task_hash: String,
    /// Hash of the body file's meaning and the model.
    pub model_hash: String,
    /// Condition of its muscles.
    #[serde(default, skip_serializing_if = "MuscleCondition::is_none")]
    pub condition: MuscleCondition,
    /// Seconds that the episode took, its share of the steps that were taken together with others; 0 if that is not known. It differs from
    /// run to run and stands in a file of its own.
    #[serde(default, skip_serializing)]
    pub wall_time: f64,
}

/// Part of the largest size below which a term counts as dead.
const DEAD: f64 = 0.01;
/// Part of the largest size above which a term counts as saturated.
const SATURATED: f64 = 0.99;

/// Sums up an episode while it runs.
#[derive(Debug, Clone)]
pub struct Tally {
    steps: u32,
    /// First step at which success held, and the return up to it.
    success: Option<(u32, f64)>,
    values: Vec<f64>,
    squares: Vec<f64>,
    dead: Vec<f64>,
    saturated: Vec<f64>,
    /// The largest size that each term can have, infinite where it is not known.
    largest: Vec<f64>,
    /// Sum of the finite values of each metric, and how many there were.
    metrics: Vec<(f64, u32)>,
    last_metrics: Vec<f64>,
}

impl Tally {
    /// No reward and no metrics yet.
    pub fn new(task: &CompiledTask) -> Self {
        let terms = task.terms.len();
        let metrics = task.metrics.iter().map(|metric| metric.size).sum();
        Self {
            steps: 0,
            success: None,
            values: vec![0.0; terms],
            squares: vec![0.0; terms],
            dead: vec![0.0; terms],
            saturated: vec![0.0; terms],
            largest: (0..terms).map(|term| task.term_range(term)).map(|[low, high]| low.abs().at_least(high.abs())).collect(),
            metrics: vec![(0.0, 0); metrics],
            last_metrics: vec![f64::NAN; metrics],
        }
    }

    /// Control steps that were added.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// Adds the present step of `episode`. A step that met a fault has no values and adds nothing.
    pub fn add(&mut self, episode: &Episode) {
        let report = episode.report();
        self.steps = episode.steps();
        if report.success && self.success.is_none() {
            self.success = Some((episode.steps(), episode.total()));
        }
        for (index, value) in report.terms.iter().enumerate() {
            let (size, largest) = (value.abs(), self.largest[index]);
            self.values[index] += value;
            self.squares[index] += value * value;
            let known = largest.is_finite();
            self.dead[index] += f64::from(u8::from(if known { size < DEAD * largest } else { size == 0.0 }));
            self.saturated[index] += f64::from(u8::from(known && size > SATURATED * largest));
        }
        for (((sum, count), last), &value) in self.metrics.iter_mut().zip(&mut self.last_metrics).zip(&report.metrics) {
            *last = value;
            if value.is_finite() {
                *sum += value;
                *count += 1;
            }
        }
    }

    /// The record of `episode`, which has ended.
    pub fn record(self, trial: &Trial, episode: &Episode, policy: &str, wall_time: f64) -> EpisodeRecord {
        let task = &*trial.task;
        let by_term = |sums: Vec<f64>| ByTerm(task.terms.iter().map(|term| term.name.clone()).zip(sums).collect());
        let fault = match episode.ending() {
            Some(Ending::Fault(fault)) => Some(fault.to_string()),
            _ => None,
        };
        // Several reasons may hold at once, also of both kinds: all are recorded.
        let holding = |names: &[String], holds: &[bool]| {
            let names = names.iter().zip(holds).filter(|(_, holds)| **holds && fault.is_none());
            names.map(|(name, _)| name.clone()).collect::<Vec<_>>()
        };
        let terminated_by = holding(&task.terminations, &episode.report().terminations);
        let finished_by = holding(&task.finishes, &episode.report().finishes);
        let truncated = episode.ending() == Some(&Ending::Truncated);
        let labels = metric_labels(task);
        let means = self.metrics.iter().map(|(sum, count)| if *count > 0 { sum / f64::from(*count) } else { f64::NAN });
        let metrics = ByTerm(labels.iter().cloned().zip(means).collect());
        let last_metrics = ByTerm(labels.into_iter().zip(self.last_metrics.iter().copied()).collect());
        EpisodeRecord {
            task: task.name.clone(),
            policy: policy.into(),
            seed: episode.key().seed,
            episode: episode.key().episode,
            success: episode.report().success,
            terminated_by,
            finished_by,
            truncated,
            awaited: task.awaited(episode.report().phase).filter(|_| truncated).unwrap_or_default(),
            fault,
            steps: episode.steps(),
            total: episode.total(),
            success_step: self.success.map(|(step, _)| step),
            return_to_success: self.success.map(|(_, total)| total),
            terms: by_term(episode.totals().to_vec()),
            values: by_term(self.values),
            squares: by_term(self.squares),
            dead: by_term(self.dead),
            saturated: by_term(self.saturated),
            weights_version: String::new(),
            weights: ByTerm::default(),
            parameters: ByTerm(parameters_of(task, episode)),
            metrics,
            last_metrics,
            standard: ByTerm::default(),
            recruitment: ByTerm::default(),
            task_hash: task.hash.clone(),
            model_hash: trial.body.hash().into(),
            condition: trial.body.condition.clone(),
            wall_time,
        }
    }
}

/// The parameters of an episode that the task declares `per episode`, in SI units.
fn parameters_of(task: &CompiledTask, episode: &Episode) -> Vec<(String, f64)> {
    let values = task.complete_parameters(episode.parameters());
    task.parameters_per_episode().map(|(place, parameter)| (parameter.name.clone(), values[place])).collect()
}

/// The names of all numbers that the metrics of a task log: of lists and vectors one for each element.
fn metric_labels(task: &CompiledTask) -> Vec<String> {
    let labels = task.metrics.iter().flat_map(|metric| {
        (0..metric.size).map(move |lane| match metric.size {
            1 => metric.name.clone(),
            _ => format!("{}[{lane}]", metric.name),
        })
    });
    labels.collect()
}

/// The units of the same numbers, in the same order; of a list of different dimensions each has all of them.
pub(super) fn metric_units(task: &CompiledTask) -> Vec<String> {
    task.metrics.iter().flat_map(|metric| std::iter::repeat_n(metric.unit.clone(), metric.size)).collect()
}

impl EpisodeRecord {
    /// Whether the other is the same episode with the same bits, the time that it took aside. Two values that are both no
    /// numbers are the same.
    pub fn same_as(&self, other: &Self) -> bool {
        super::journal::json(self) == super::journal::json(other)
    }

    /// How the episode ended, in words: the reasons, `horizon` (of a sequence before its last phase with what never held), or `fault`.
    pub fn ended_by(&self) -> String {
        if self.fault.is_some() {
            "fault".into()
        } else if self.truncated && !self.awaited.is_empty() {
            format!("horizon in {}", self.awaited)
        } else if self.truncated {
            "horizon".into()
        } else {
            let reasons = self.terminated_by.iter().chain(&self.finished_by);
            reasons.map(String::as_str).collect::<Vec<_>>().join(" and ")
        }
    }
}

impl Serialize for ByTerm {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

impl<'de> Deserialize<'de> for ByTerm {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> serde::de::Visitor<'de> for InOrder {
            type Value = ByTerm;
            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str("numbers by name")
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, mut map: A) -> Result<ByTerm, A::Error> {
                let mut entries = Vec::new();
                while let Some((name, value)) = map.next_entry::<String, Option<f64>>()? {
                    entries.push((name, value.unwrap_or(f64::NAN)));
                }
                Ok(ByTerm(entries))
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

/// JSON has no word for a number that overflowed: it is written `null` and read back as not a number.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;

    pub fn record() -> EpisodeRecord {
        EpisodeRecord {
            task: "stand".into(),
            policy: "zero".into(),
            seed: 3,
            episode: 11,
            success: false,
            terminated_by: vec!["fallen".into(), "tilted".into()],
            finished_by: vec![],
            truncated: false,
            awaited: String::new(),
            fault: None,
            steps: 57,
            total: 0.1 + 0.2,
            success_step: Some(40),
            return_to_success: Some(0.25),
            terms: ByTerm(vec![("pose".into(), 1.0 / 3.0), ("balance".into(), -2.5e-17)]),
            values: ByTerm(vec![("pose".into(), 1.0 / 30.0), ("balance".into(), 0.0)]),
            squares: ByTerm(vec![("pose".into(), 1.0 / 90.0), ("balance".into(), 0.0)]),
            dead: ByTerm(vec![("pose".into(), 0.0), ("balance".into(), 57.0)]),
            saturated: ByTerm(vec![("pose".into(), 3.0), ("balance".into(), 0.0)]),
            weights_version: "w".into(),
            weights: ByTerm(vec![("pose".into(), 10.0), ("balance".into(), -1.0)]),
            parameters: ByTerm(vec![("speed".into(), 1.25)]),
            metrics: ByTerm(vec![("lean".into(), 0.25)]),
            last_metrics: ByTerm(vec![("lean".into(), 0.5)]),
            standard: ByTerm(vec![("activation_cost".into(), 0.25)]),
            recruitment: ByTerm(vec![("Calves".into(), 1.5)]),
            task_hash: "t".into(),
            model_hash: "m".into(),
            condition: MuscleCondition::default(),
            wall_time: 0.0,
        }
    }

    #[test]
    fn a_line_of_the_journal_reads_back_bit_for_bit_with_terms_in_order() {
        let line = serde_json::to_string(&record()).unwrap();
        assert!(line.contains(r#""terms":{"pose":0.3333333333333333,"balance":-2.5e-17}"#), "{line}");
        assert!(line.contains(r#""return":0.30000000000000004"#), "{line}");
        assert_eq!(serde_json::from_str::<EpisodeRecord>(&line).unwrap(), record());
    }

    #[test]
    fn an_overflowed_return_still_reads_back() {
        let line = serde_json::to_string(&EpisodeRecord { total: f64::INFINITY, ..record() }).unwrap();
        assert!(serde_json::from_str::<EpisodeRecord>(&line).unwrap().total.is_nan());
    }

    #[test]
    fn endings_are_distinguished() {
        let ended_by = |record: EpisodeRecord| record.ended_by();
        assert_eq!(ended_by(record()), "fallen and tilted");
        assert_eq!(ended_by(EpisodeRecord { terminated_by: vec![], finished_by: vec!["done".into()], ..record() }), "done");
        assert_eq!(ended_by(EpisodeRecord { truncated: true, terminated_by: vec![], ..record() }), "horizon");
        let awaited = "`walk` until `arrived`".to_owned();
        let waits = EpisodeRecord { truncated: true, awaited, terminated_by: vec![], ..record() };
        assert_eq!(ended_by(waits.clone()), "horizon in `walk` until `arrived`");
        let line = serde_json::to_string(&waits).unwrap();
        assert_eq!(serde_json::from_str::<EpisodeRecord>(&line).unwrap(), waits);
        assert_eq!(ended_by(EpisodeRecord { fault: Some("diverged".into()), terminated_by: vec![], ..record() }), "fault");
    }
}
