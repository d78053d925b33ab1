//! What a session is.

use super::SessionError;
use crate::statistics::Statistics;
use msk_compiler::numbers::exact;
use msk_compiler::task::CompiledTask;
use msk_compiler::weights::rules::Rules;
use msk_compiler::weights::{Bounds, Problem};
use msk_evaluate::Trial;
use msk_runtime::policy::PolicySource;
use msk_storage::Folder;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::Path;

/// Largest description of a session that is read, bytes.
const LARGEST: u64 = 1 << 20;

/// How a session is run. What it may spend may differ from one call to the next; the rest is its identity.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The policy that plays; with a [`Learner`](super::Learner) its name alone counts, as part of the identity.
    pub policy: PolicySource,
    /// Seed of all chance.
    pub seed: u64,
    /// Control steps of a round, of all workers together.
    pub interval: u64,
    /// What a change must keep to.
    pub rules: KeptRules,
    /// Terms that stay as they are, such as the price of a fall, and do not count in the norm.
    pub outside: Vec<String>,
    /// What makes one round better than another.
    pub objective: Objective,
    /// Most rounds.
    pub rounds: u64,
    /// Most control steps.
    pub steps: Option<u64>,
    /// What happens when the reasoner fails.
    pub on_failure: OnFailure,
}

/// The rules of change, as they are kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct KeptRules {
    /// Largest relative change of a weight in one round.
    pub step: f64,
    /// Sum of the sizes of all weights in scope, if it is kept.
    pub norm: Option<f64>,
}

/// What happens when the reasoner fails or its proposal cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnFailure {
    /// The weights stay, the failure is logged, the session goes on.
    Keep,
    /// The session stops.
    Stop,
}

/// What makes one round better than another.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Objective {
    /// Part of the episodes that succeed; among equals, how long they last.
    Success,
    /// How long episodes last.
    Survival,
    /// The mean of a metric: more is better.
    More(String),
    /// The mean of a metric: less is better.
    Less(String),
}

impl Objective {
    /// `success`, `survival`, or a metric, `-` before it if less is better.
    pub fn parse(text: &str) -> Self {
        match (text, text.strip_prefix('-')) {
            ("success", _) => Self::Success,
            ("survival", _) => Self::Survival,
            (_, Some(metric)) => Self::Less(metric.trim().to_owned()),
            (metric, None) => Self::More(metric.to_owned()),
        }
    }

    /// Larger is better. Success counts whole, survival as a part of the horizon too small to outweigh an episode's success.
    pub fn score(&self, statistics: &Statistics, horizon: u32) -> f64 {
        let survived = statistics.survival.map_or(0.0, |spread| spread.mean / f64::from(horizon.max(1)));
        let metric = |name: &str| {
            let metric = statistics.metrics.iter().find(|metric| metric.metric == name);
            metric.and_then(|metric| metric.mean).map_or(f64::NAN, |spread| spread.mean)
        };
        let score = match self {
            Self::Success => statistics.success_rate + survived / (statistics.episodes.max(1) as f64 + 1.0),
            Self::Survival => survived,
            Self::More(name) => metric(name),
            Self::Less(name) => -metric(name),
        };
        // A metric that was never a number is the worst that there is, and JSON has no word for infinity.
        if score.is_finite() { score } else { f64::MIN }
    }

    /// In words.
    pub fn described(&self) -> String {
        match self {
            Self::Success => "as many episodes as possible succeed, and last".into(),
            Self::Survival => "episodes last as long as possible".into(),
            Self::More(metric) => format!("the metric {metric} becomes large"),
            Self::Less(metric) => format!("the metric {metric} becomes small"),
        }
    }
}

impl Settings {
    /// The rules of change.
    pub(super) fn rules(&self) -> Rules {
        Rules { step: self.rules.step, norm: self.rules.norm }
    }

    pub(super) fn check(&self, task: &CompiledTask) -> Result<(), SessionError> {
        let wrong = |text: String| Err(SessionError::Setting(text));
        if self.interval == 0 || self.rounds == 0 {
            return wrong("the interval and the number of rounds must be at least 1".into());
        }
        if !(self.rules.step > 0.0 && self.rules.step <= 1.0) {
            return wrong(format!("a step is a fraction of a weight, above 0 and at most 1, not {}", exact(self.rules.step)));
        }
        if let Some(norm) = self.rules.norm.filter(|norm| !(*norm > 0.0 && norm.is_finite())) {
            return wrong(format!("a norm is a number above 0, not {}", exact(norm)));
        }
        if let Objective::More(name) | Objective::Less(name) = &self.objective {
            let known: Vec<&str> = task.metrics.iter().map(|metric| metric.name.as_str()).collect();
            let label = name.split('[').next().unwrap_or(name);
            if !known.contains(&label) {
                let known = if known.is_empty() { "it logs none".into() } else { format!("it logs: {}", known.join(", ")) };
                return wrong(format!("task `{}` has no metric `{name}`; {known}; or use success or survival", task.name));
            }
        }
        Ok(())
    }

    /// Which terms are tuned, and count in the norm.
    pub(super) fn scope(&self, task: &CompiledTask) -> Result<Vec<bool>, Problem> {
        let outside = self.outside.iter().map(|name| task.find_term(name)).collect::<Result<Vec<_>, _>>()?;
        Ok((0..task.terms.len()).map(|term| task.weight_bounds(term) != Bounds::Fixed && !outside.contains(&term)).collect())
    }

    /// Makes `folder` the place of this session, or checks that it is.
    pub(super) fn claim(&self, folder: &Folder, trial: &Trial) -> Result<(), SessionError> {
        let identity = json!({
            "task": trial.task.name,
            "task_hash": trial.task.hash,
            "model_hash": trial.body.hash(),
            "policy": self.policy.name(),
            "seed": self.seed,
            "interval": self.interval,
            "rules": self.rules,
            "outside": self.outside,
            "objective": self.objective,
        });
        let text = format!("{identity:#}\n");
        let other = |difference: String| {
            SessionError::Setting(format!("`{}` contains another session: {difference}", folder.path().display()))
        };
        let path = Path::new("tune.json");
        let Some(before) = folder.read_text(path, LARGEST)? else { return Ok(folder.replace(path, text.as_bytes())?) };
        let before: Value = serde_json::from_str(&before).map_err(|error| other(format!("tune.json: {error}")))?;
        for (name, value) in identity.as_object().into_iter().flatten() {
            if before[name] != *value {
                return Err(other(format!("its {name} is {}, not {value}", before[name])));
            }
        }
        Ok(())
    }
}
