//! Settings of a training: presets, files, and what they may hold.

use msk_network::{Activation, Shape};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// How an agent learns.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Algorithm {
    /// Proximal policy optimisation.
    #[default]
    Ppo,
    /// Soft actor-critic.
    Sac,
}

/// A named set of settings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Networks that take about as long as the simulation.
    #[default]
    Fast,
    /// The values of the benchmark's paper: days on two cores.
    Paper,
}

impl Algorithm {
    /// All of them, with their names.
    pub const NAMED: [(&'static str, Self); 2] = [("ppo", Self::Ppo), ("sac", Self::Sac)];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ppo => "ppo",
            Self::Sac => "sac",
        }
    }
}

impl Preset {
    /// All of them, with their names.
    pub const NAMED: [(&'static str, Self); 2] = [("fast", Self::Fast), ("paper", Self::Paper)];
}

/// Settings of a training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// How it learns.
    pub algorithm: Algorithm,
    /// The settings that a file does not set.
    pub preset: Preset,
    /// Episodes side by side.
    pub episodes: usize,
    /// Sizes of the hidden layers of every network.
    pub hidden: Vec<usize>,
    /// What follows a hidden layer.
    pub activation: Activation,
    /// Whether hidden layers are normalised.
    pub layer_norm: bool,
    /// Weight of a reward that comes one control step later: gamma.
    pub discount: f64,
    /// Whether networks see observations with running mean 0 and deviation 1.
    pub normalize_observations: bool,
    /// Whether rewards are divided by the running deviation of the discounted return.
    pub normalize_rewards: bool,
    /// Control steps from one evaluation to the next.
    pub evaluate_every: u64,
    /// Episodes of an evaluation.
    pub evaluation_episodes: usize,
    /// Control steps from one checkpoint to the next.
    pub checkpoint_every: u64,
    /// Those of PPO.
    pub ppo: PpoSettings,
    /// Those of SAC.
    pub sac: SacSettings,
}

/// Settings of PPO alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PpoSettings {
    /// Step of Adam.
    pub learning_rate: f64,
    /// Whether it falls to 0 over the training.
    pub anneal: bool,
    /// Control steps of each episode between two updates.
    pub horizon: usize,
    /// Transitions of a gradient step.
    pub minibatch: usize,
    /// How often each transition is used.
    pub epochs: usize,
    /// Decay of the weight of later errors in an advantage: lambda.
    pub lambda: f64,
    /// Largest change of a ratio of densities that the objective rewards: epsilon.
    pub clip: f64,
    /// Whether values are kept near those before the update, too.
    pub clip_values: bool,
    /// Weight of the entropy.
    pub entropy: f64,
    /// Weight of the error of the values.
    pub value_weight: f64,
    /// Largest norm of a gradient.
    pub gradient_norm: f64,
    /// Logarithm of the first standard deviation of actions.
    pub log_std: f64,
}

/// Settings of SAC alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SacSettings {
    /// Step of Adam for the actor.
    pub actor_rate: f64,
    /// Step of Adam for the critics.
    pub critic_rate: f64,
    /// Transitions that are kept.
    pub replay: usize,
    /// Transitions with random actions before it learns.
    pub start: usize,
    /// Transitions of a gradient step.
    pub batch: usize,
    /// Gradient steps for each transition.
    pub updates: f64,
    /// Gradient steps of the critics for one of the actor, which is then updated as often.
    pub actor_delay: usize,
    /// Share by which the target critics follow: tau.
    pub follow: f64,
    /// Weight of the entropy; with `automatic` where it begins.
    pub temperature: f64,
    /// Whether the weight of the entropy is tuned so that the entropy is minus the number of entries of an action.
    pub automatic: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self::of(Algorithm::default(), Preset::default())
    }
}

impl Default for PpoSettings {
    fn default() -> Self {
        Self {
            learning_rate: 3e-4,
            anneal: true,
            horizon: 256,
            minibatch: 64,
            epochs: 10,
            lambda: 0.95,
            clip: 0.2,
            clip_values: true,
            entropy: 0.0,
            value_weight: 0.5,
            gradient_norm: 0.5,
            log_std: 0.0,
        }
    }
}

impl Default for SacSettings {
    fn default() -> Self {
        Self {
            actor_rate: 3e-4,
            critic_rate: 1e-3,
            replay: 1_000_000,
            start: 5_000,
            batch: 256,
            updates: 0.25,
            actor_delay: 2,
            follow: 0.005,
            temperature: 0.2,
            automatic: true,
        }
    }
}

/// Why settings are rejected.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    /// No TOML, an unknown key, or a value of another kind: the message shows the place in the file.
    #[error("{0}")]
    Invalid(String),
    /// A number that makes no sense.
    #[error("{place}`{key}` is {found}; expected {expected}", place = if *line > 0 { format!("line {line}: ") } else { String::new() })]
    Range {
        /// Line in the file, from 1; 0 if the file does not set it.
        line: usize,
        /// Its name.
        key: &'static str,
        /// What it is.
        found: String,
        /// What it may be.
        expected: String,
    },
}

impl Settings {
    /// The shape of a network between so many numbers.
    pub(crate) fn shape(&self, inputs: usize, outputs: usize) -> Shape {
        let Self { activation, layer_norm, .. } = *self;
        Shape { inputs, hidden: self.hidden.clone(), outputs, activation, layer_norm }
    }

    /// Those of a preset.
    pub fn of(algorithm: Algorithm, preset: Preset) -> Self {
        let hidden = match (algorithm, preset) {
            (_, Preset::Paper) => vec![1024, 1024],
            (Algorithm::Ppo, Preset::Fast) => vec![64, 64],
            (Algorithm::Sac, Preset::Fast) => vec![256, 256],
        };
        let fast = Self {
            algorithm,
            preset,
            episodes: 8,
            hidden,
            activation: if algorithm == Algorithm::Ppo { Activation::Tanh } else { Activation::Relu },
            layer_norm: false,
            discount: 0.99,
            normalize_observations: true,
            normalize_rewards: algorithm == Algorithm::Ppo || preset == Preset::Paper,
            evaluate_every: 50_000,
            evaluation_episodes: 10,
            checkpoint_every: 50_000,
            ppo: PpoSettings::default(),
            sac: SacSettings::default(),
        };
        if preset == Preset::Fast {
            return fast;
        }
        let ppo = PpoSettings {
            anneal: false,
            horizon: 2048,
            minibatch: 256,
            clip_values: false,
            entropy: 0.005,
            ..PpoSettings::default()
        };
        let sac = SacSettings {
            actor_rate: 1e-4,
            critic_rate: 1e-4,
            start: 100,
            updates: 0.125,
            actor_delay: 1,
            temperature: 0.05,
            automatic: false,
            ..SacSettings::default()
        };
        let evaluate_every = if algorithm == Algorithm::Ppo { 500_000 } else { 200_000 };
        Self { evaluate_every, checkpoint_every: evaluate_every, ppo, sac, ..fast }
    }

    /// Reads a TOML file: keys that it does not set are those of its `algorithm` and its `preset`.
    ///
    /// # Errors
    /// No TOML, an unknown key, a value of another kind, or one that makes no sense.
    pub fn read(text: &str) -> Result<Self, SettingsError> {
        let written: Self = toml::from_str(text).map_err(|error| SettingsError::Invalid(error.to_string()))?;
        let invalid = |error: &dyn ToString| SettingsError::Invalid(error.to_string());
        let base = Self::of(written.algorithm, written.preset);
        let mut table = toml::Table::try_from(base).map_err(|error| invalid(&error))?;
        let changes: toml::Table = text.parse().map_err(|error: toml::de::Error| invalid(&error))?;
        for (key, value) in changes {
            match (table.get_mut(&key), value) {
                (Some(toml::Value::Table(inner)), toml::Value::Table(changes)) => inner.extend(changes),
                (_, value) => drop(table.insert(key, value)),
            }
        }
        let settings: Self = table.try_into().map_err(|error| invalid(&error))?;
        settings.check(text)?;
        Ok(settings)
    }

    /// As a TOML file that [`read`](Self::read) reads.
    pub fn text(&self) -> String {
        // Plain data of numbers and lists always has a TOML form.
        toml::to_string(self).unwrap_or_default()
    }

    /// Whether every number lies where it makes sense; NaN does not.
    fn check(&self, text: &str) -> Result<(), SettingsError> {
        let refuse = |key: &'static str, found: String, expected: String| {
            let is_of = |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
            let line = text.lines().position(is_of).map_or(0, |index| index + 1);
            Err(SettingsError::Range { line, key, found, expected })
        };
        let (ppo, sac) = (&self.ppo, &self.sac);
        let numbers: [(&'static str, f64, RangeInclusive<f64>); 14] = [
            ("discount", self.discount, 0.0..=1.0),
            ("learning_rate", ppo.learning_rate, 1e-8..=1.0),
            ("lambda", ppo.lambda, 0.0..=1.0),
            ("clip", ppo.clip, 1e-3..=10.0),
            ("entropy", ppo.entropy, 0.0..=10.0),
            ("value_weight", ppo.value_weight, 0.0..=100.0),
            ("gradient_norm", ppo.gradient_norm, 1e-6..=1e6),
            ("log_std", ppo.log_std, -10.0..=2.0),
            ("actor_rate", sac.actor_rate, 1e-8..=1.0),
            ("critic_rate", sac.critic_rate, 1e-8..=1.0),
            ("updates", sac.updates, 1e-4..=64.0),
            ("follow", sac.follow, 1e-6..=1.0),
            ("temperature", sac.temperature, 1e-8..=100.0),
            ("evaluate_every", self.evaluate_every as f64, 1.0..=1e12),
        ];
        for (key, found, range) in numbers {
            if !range.contains(&found) {
                return refuse(key, found.to_string(), format!("a number from {} to {}", range.start(), range.end()));
            }
        }
        let counts: [(&'static str, usize, RangeInclusive<usize>); 11] = [
            ("episodes", self.episodes, 1..=4096),
            ("evaluation_episodes", self.evaluation_episodes, 1..=1000),
            ("checkpoint_every", usize::try_from(self.checkpoint_every).unwrap_or(usize::MAX), 1..=1_000_000_000_000),
            ("horizon", ppo.horizon, 1..=1_000_000),
            ("minibatch", ppo.minibatch, 1..=1_000_000),
            ("epochs", ppo.epochs, 1..=1000),
            ("replay", sac.replay, 1..=100_000_000),
            ("start", sac.start, 1..=100_000_000),
            ("batch", sac.batch, 1..=1_000_000),
            ("actor_delay", sac.actor_delay, 1..=1000),
            ("hidden", self.hidden.len(), 1..=16),
        ];
        for (key, found, range) in counts {
            if !range.contains(&found) {
                let what = if key == "hidden" { "sizes of layers" } else { "" };
                let expected = format!("a whole number from {} to {} {what}", range.start(), range.end());
                return refuse(key, found.to_string(), expected.trim_end().to_owned());
            }
        }
        if let Some(size) = self.hidden.iter().find(|size| !(1..=16384).contains(*size)) {
            return refuse("hidden", size.to_string(), "sizes from 1 to 16384".into());
        }
        if self.algorithm == Algorithm::Ppo && ppo.minibatch > ppo.horizon * self.episodes {
            let all = ppo.horizon * self.episodes;
            return refuse("minibatch", ppo.minibatch.to_string(), format!("at most `horizon` x `episodes`, which is {all}"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_what_a_file_begins_with() {
        let paper = Settings::read("preset = \"paper\"\n[ppo]\nepochs = 3").unwrap();
        let expected = Settings::of(Algorithm::Ppo, Preset::Paper);
        assert_eq!(paper, Settings { ppo: PpoSettings { epochs: 3, ..expected.ppo.clone() }, ..expected });
        for (_, algorithm) in Algorithm::NAMED {
            for (_, preset) in Preset::NAMED {
                let settings = Settings::of(algorithm, preset);
                assert_eq!(Settings::read(&settings.text()).as_ref(), Ok(&settings));
            }
        }
    }

    #[test]
    fn what_makes_no_sense_is_rejected_with_its_place() {
        let message = |text: &str| Settings::read(text).err().map(|error| error.to_string()).unwrap_or_default();
        let unknown = message("hidden = [64]\nlearning_rat = 1");
        assert!(unknown.contains("line 2") && unknown.contains("unknown field `learning_rat`"), "{unknown}");
        assert_eq!(message("\ndiscount = nan"), "line 2: `discount` is NaN; expected a number from 0 to 1");
        assert_eq!(message("episodes = 0"), "line 1: `episodes` is 0; expected a whole number from 1 to 4096");
        assert_eq!(message("hidden = []"), "line 1: `hidden` is 0; expected a whole number from 1 to 16 sizes of layers");
        assert_eq!(message("hidden = [64, 0]"), "line 1: `hidden` is 0; expected sizes from 1 to 16384");
        assert_eq!(
            message("[ppo]\nminibatch = 5000"),
            "line 2: `minibatch` is 5000; expected at most `horizon` x `episodes`, which is 2048"
        );
        assert!(message("algorithm = \"ddpg\"").contains("expected `ppo` or `sac`"));
    }
}
