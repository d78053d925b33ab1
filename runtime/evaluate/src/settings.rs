//! What is run: enough to tell whether two runs are the same.

use super::journal::json;
use super::journal::line::hex;
use super::{EpisodeRecord, Plan, Shard};
use msk_program::task::{CompiledTask, Origin};
use msk_runtime::condition::MuscleCondition;
use msk_runtime::perturbation::Perturbation;
use msk_text::numbers::exact;
use serde::{Deserialize, Serialize};

/// Hash of everything in the program that decides results: the sources of compiler and runtime, the grammar, the bodies inside
/// the binary, and the versions of all libraries. The build script computes it, so a changed program is another program
/// independently of its version.
pub const BUILD: &str = env!("MSK_BUILD");

/// How many episodes, and from which seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Protocol {
    /// Episodes per task; 0 where a run goes on until something else ends it.
    pub episodes: u64,
    /// Seed of all chance; episode i of seed s is the same wherever and whenever it runs.
    pub seed: u64,
}

/// The identity of a run. Two runs with equal settings have equal results, wall times aside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunSettings {
    /// Version of the program.
    pub version: String,
    /// Hash of the sources that decide results: see [`BUILD`].
    #[serde(default)]
    pub build: String,
    /// Name of the policy.
    pub policy: String,
    /// Episodes and seed.
    pub protocol: Protocol,
    /// The tasks, in order.
    pub tasks: Vec<TaskSettings>,
    /// Which of the episodes are there; no part of the identity, which is that of the whole run.
    #[serde(default, skip_serializing_if = "Shard::is_whole")]
    pub shard: Shard,
    /// The weights file that is read anew before every episode, if one is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live: Option<String>,
}

/// A task of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TaskSettings {
    /// Its name.
    pub name: String,
    /// Family it belongs to.
    pub family: String,
    /// Hash of its meaning.
    pub hash: String,
    /// Hash of the body it runs on.
    pub model_hash: String,
    /// Condition of its muscles.
    #[serde(default, skip_serializing_if = "MuscleCondition::is_none")]
    pub condition: MuscleCondition,
    /// What its episodes are perturbed by, in words that tell all that differ; empty if by nothing.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub perturbation: String,
    /// Control steps per episode.
    pub horizon: u32,
    /// Weights of the terms, in order.
    pub weights: Vec<(String, f64)>,
    /// Terms whose weights are not those of the source, with where they come from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub overlaid: Vec<(String, String)>,
}

impl TaskSettings {
    /// Whether `record` is an episode of this task, on this body, under this condition.
    pub fn owns(&self, record: &EpisodeRecord) -> bool {
        self.name == record.task
            && self.hash == record.task_hash
            && self.model_hash == record.model_hash
            && self.condition == record.condition
    }

    /// What decides of results: where weights come from does not.
    fn decisive(&self) -> Self {
        Self { overlaid: Vec::new(), ..self.clone() }
    }
}

impl RunSettings {
    /// Of a plan.
    pub fn of(plan: &Plan) -> Self {
        let tasks = plan.trials.iter().map(|trial| TaskSettings {
            name: trial.task.name.clone(),
            family: trial.task.family.clone(),
            hash: trial.task.hash.clone(),
            model_hash: trial.body.hash().to_owned(),
            condition: trial.body.condition.clone(),
            perturbation: perturbation(&trial.perturbation),
            horizon: trial.task.horizon,
            weights: trial.task.terms.iter().map(|term| (term.name.clone(), term.weight)).collect(),
            overlaid: overlaid(&trial.task),
        });
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            build: BUILD.into(),
            policy: plan.policy.name().to_owned(),
            protocol: plan.protocol,
            tasks: tasks.collect(),
            shard: plan.shard,
            live: None,
        }
    }

    /// The whole run of which this may be a shard.
    pub fn whole(&self) -> Self {
        Self { shard: Shard::WHOLE, ..self.clone() }
    }

    /// The same run with weights from `file`, read anew before every episode.
    pub fn live(self, file: impl Into<String>) -> Self {
        // What the file holds when the run is begun, or begun again, is no part of what is run; what wins over it is.
        let tasks = self.tasks.into_iter().map(|mut task| {
            task.overlaid.retain(|(_, origin)| *origin == Origin::CommandLine.to_string());
            task.weights.retain(|(term, _)| task.overlaid.iter().any(|(name, _)| name == term));
            task
        });
        Self { tasks: tasks.collect(), live: Some(file.into()), ..self }
    }

    /// Tells this run from all others, 16 hexadecimal digits: a hash of all that decides results. Every line of its journal
    /// carries it.
    pub fn identity(&self) -> String {
        let tasks = self.tasks.iter().map(TaskSettings::decisive).collect();
        hex(json(&Self { tasks, ..self.whole() }).as_bytes())
    }

    /// Why `record` cannot be an episode of this run, if it cannot.
    pub(super) fn stranger(&self, record: &EpisodeRecord) -> Option<String> {
        let Protocol { episodes, seed } = self.protocol;
        if record.policy != self.policy {
            return Some(format!("its policy is {}, not {}", record.policy, self.policy));
        }
        if record.seed != seed {
            return Some(format!("its seed is {}, not {seed}", record.seed));
        }
        if self.place(record).is_none() {
            let condition = match record.condition.is_none() {
                true => String::new(),
                false => format!(" with muscles in the condition `{}`", record.condition),
            };
            return Some(format!("no task of the run is its `{}`{condition}", record.task));
        }
        (episodes > 0 && record.episode >= episodes)
            .then(|| format!("it is episode {} of a run of {episodes}, counted from 0", record.episode))
    }

    /// The first thing in which `other` differs, in words; `None` if they are the same run.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let differ = |what: &str, here: &str, there: &str| (here != there).then(|| format!("its {what} is {here}, not {there}"));
        let number = |what: &str, here: u64, there: u64| differ(what, &here.to_string(), &there.to_string());
        let names = |settings: &Self| {
            let names: Vec<&str> = settings.tasks.iter().map(|task| task.name.as_str()).collect();
            names.join(", ")
        };
        differ("policy", &self.policy, &other.policy)
            .or_else(|| number("seed", self.protocol.seed, other.protocol.seed))
            .or_else(|| number("number of episodes", self.protocol.episodes, other.protocol.episodes))
            .or_else(|| differ("list of tasks", &names(self), &names(other)))
            .or_else(|| differ("program version", &self.version, &other.version))
            .or_else(|| {
                // Earlier programs kept none.
                let build = |settings: &Self| match settings.build.is_empty() {
                    true => "unknown".to_owned(),
                    false => settings.build.clone(),
                };
                differ("program's build", &build(self), &build(other))
            })
            .or_else(|| {
                let file = |settings: &Self| settings.live.clone().unwrap_or_else(|| "none".into());
                differ("live weights file", &file(self), &file(other))
            })
            .or_else(|| {
                let words = |settings: &Self| if settings.shard.is_whole() { "none".into() } else { settings.shard.to_string() };
                differ("shard", &words(self), &words(other))
            })
            .or_else(|| {
                let pairs = || self.tasks.iter().zip(&other.tasks);
                let changed = pairs().find(|(here, there)| here.decisive() != there.decisive())?;
                let only_weights =
                    changed.0.decisive() == TaskSettings { weights: changed.0.weights.clone(), ..changed.1.decisive() };
                if only_weights {
                    let mut pairs = changed.0.weights.iter().zip(&changed.1.weights);
                    let name = &changed.0.name;
                    return Some(match pairs.find(|(here, there)| here != there) {
                        Some(((term, here), (same, there))) if term == same => {
                            format!("the weight of `{term}` in task `{name}` is {}, not {}", exact(*here), exact(*there))
                        }
                        _ => format!("other weights of task `{name}` are set"),
                    });
                }
                if changed.0.condition != changed.1.condition {
                    return Some(format!("the condition of the muscles in task `{}` differs", changed.0.name));
                }
                if changed.0.perturbation != changed.1.perturbation {
                    let words = |words: &str| if words.is_empty() { "none".to_owned() } else { words.to_owned() };
                    let [here, there] = [&changed.0, &changed.1].map(|task| words(&task.perturbation));
                    return Some(format!("the perturbation of task `{}` is {here}, not {there}", changed.0.name));
                }
                let what = if changed.0.model_hash == changed.1.model_hash { "task" } else { "body of task" };
                Some(format!("the {what} `{}` has changed since", changed.0.name))
            })
    }
}

/// A perturbation in words.
fn perturbation(perturbation: &Perturbation) -> String {
    if perturbation.is_none() {
        return String::new();
    }
    let normalized = perturbation.normalization.as_ref();
    let by = normalized.map_or_else(String::new, |by| format!(", normalized by {}", hex(json(by).as_bytes())));
    format!("{perturbation}{by}")
}

/// Terms whose weights are not those of the source.
fn overlaid(task: &CompiledTask) -> Vec<(String, String)> {
    let terms = task.terms.iter().filter(|term| term.origin != Origin::Source);
    terms.map(|term| (term.name.clone(), term.origin.to_string())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_runtime::condition::Weakness;

    fn settings() -> RunSettings {
        let task = TaskSettings {
            name: "stand".into(),
            family: "stabilization".into(),
            hash: "a".into(),
            model_hash: "b".into(),
            condition: MuscleCondition::default(),
            perturbation: String::new(),
            horizon: 1000,
            weights: vec![("pose".into(), 10.0)],
            overlaid: vec![],
        };
        let protocol = Protocol { episodes: 50, seed: 0 };
        RunSettings {
            version: "1".into(),
            build: "2".into(),
            policy: "zero".into(),
            protocol,
            tasks: vec![task],
            shard: Shard::WHOLE,
            live: None,
        }
    }

    #[test]
    fn equal_settings_are_the_same_run() {
        assert_eq!(settings().difference(&settings()), None);
    }

    #[test]
    fn every_difference_makes_another_identity_and_nothing_else_does() {
        let identity = |change: &dyn Fn(&mut RunSettings)| {
            let mut other = settings();
            change(&mut other);
            other.identity()
        };
        let changes: [&dyn Fn(&mut RunSettings); 10] = [
            &|_| {},
            &|s| s.version = "2".into(),
            &|s| s.build = "3".into(),
            &|s| s.policy = "random".into(),
            &|s| s.protocol.seed = 1,
            &|s| s.protocol.episodes = 51,
            &|s| s.tasks[0].hash = "c".into(),
            &|s| s.tasks[0].model_hash = "c".into(),
            &|s| s.tasks[0].weights[0].1 = 11.0,
            &|s| s.tasks[0].condition.fatigue = Some(msk_runtime::condition::Fatigue::default()),
        ];
        let identities: std::collections::BTreeSet<String> = changes.iter().map(|change| identity(*change)).collect();
        assert_eq!(identities.len(), changes.len());
        assert_eq!(identity(&|s| s.tasks[0].overlaid.push(("pose".into(), "w.toml".into()))), settings().identity());
        let read: RunSettings = serde_json::from_str(&json(&settings())).unwrap();
        assert_eq!(read.identity(), settings().identity());
    }

    #[test]
    fn the_build_is_a_hash_of_its_sources() {
        assert!(BUILD.len() == 16 && BUILD.chars().all(|digit| digit.is_ascii_hexdigit()), "{BUILD}");
    }

    #[test]
    fn any_change_of_meaning_is_another_run_and_is_named() {
        let difference = |change: &dyn Fn(&mut RunSettings)| {
            let mut other = settings();
            change(&mut other);
            settings().difference(&other).unwrap_or_default()
        };
        assert_eq!(difference(&|s| s.policy = "random".into()), "its policy is zero, not random");
        assert_eq!(difference(&|s| s.protocol.seed = 4), "its seed is 0, not 4");
        assert_eq!(difference(&|s| s.protocol.episodes = 10), "its number of episodes is 50, not 10");
        assert_eq!(difference(&|s| s.tasks[0].name = "sit".into()), "its list of tasks is stand, not sit");
        assert_eq!(difference(&|s| s.version = "2".into()), "its program version is 1, not 2");
        assert_eq!(difference(&|s| s.build = "3".into()), "its program's build is 2, not 3");
        assert_eq!(difference(&|s| s.tasks[0].hash = "c".into()), "the task `stand` has changed since");
        assert_eq!(difference(&|s| s.tasks[0].weights[0].1 = 9.0), "the weight of `pose` in task `stand` is 10, not 9");
        assert_eq!(difference(&|s| s.tasks[0].weights.clear()), "other weights of task `stand` are set");
        assert_eq!(difference(&|s| s.tasks[0].overlaid.push(("pose".into(), "w.toml".into()))), "");
        assert_eq!(difference(&|s| s.live = Some("w.toml".into())), "its live weights file is none, not w.toml");
        let weak = Weakness { muscles: None, factor: 0.5 };
        let condition = MuscleCondition { weakness: vec![weak], fatigue: None };
        let found = difference(&|s| s.tasks[0].condition = condition.clone());
        assert_eq!(found, "the condition of the muscles in task `stand` differs");
        let noisy = difference(&|s| s.tasks[0].perturbation = "action 0.1".into());
        assert_eq!(noisy, "the perturbation of task `stand` is none, not action 0.1");
        assert_eq!(difference(&|s| s.tasks[0].model_hash = "c".into()), "the body of task `stand` has changed since");
    }
}
