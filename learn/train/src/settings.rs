//! Settings of a training: presets, files, and what they may hold.

use msk_network::{Activation, Shape};
use msk_settings::{Checked, SettingsError};
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
    /// Maximum a posteriori policy optimisation, which differential extrinsic plasticity may explore for: DepRL.
    Mpo,
    /// Imitation: behaviour cloning, and DAgger with a teacher.
    Clone,
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
    pub const NAMED: [(&'static str, Self); 4] =
        [("ppo", Self::Ppo), ("sac", Self::Sac), ("mpo", Self::Mpo), ("clone", Self::Clone)];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ppo => "ppo",
            Self::Sac => "sac",
            Self::Mpo => "mpo",
            Self::Clone => "clone",
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
    /// Control steps for which a training that starts as an agent improves its critics alone.
    pub critics_first: u64,
    /// Those of PPO.
    pub ppo: PpoSettings,
    /// Those of SAC.
    pub sac: SacSettings,
    /// Those of MPO.
    pub mpo: MpoSettings,
    /// Those of what explores for MPO.
    pub dep: DepSettings,
    /// Those of imitation.
    pub clone: CloneSettings,
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

/// Settings of MPO alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MpoSettings {
    /// Step of Adam for the actor.
    pub actor_rate: f64,
    /// Step of Adam for the critic.
    pub critic_rate: f64,
    /// Step of Adam for the duals.
    pub dual_rate: f64,
    /// Transitions that are kept.
    pub replay: usize,
    /// Transitions before it learns.
    pub start: usize,
    /// Transitions of a gradient step.
    pub batch: usize,
    /// Gradient steps for each transition.
    pub updates: f64,
    /// Gradient steps that are taken one after the other.
    pub block: usize,
    /// Rewards that are summed up before the critic is asked.
    pub steps: usize,
    /// Actions that are drawn for each state.
    pub samples: usize,
    /// Share by which the targets follow: tau.
    pub follow: f64,
    /// How far weights of samples may be from equal ones.
    pub epsilon: f64,
    /// The same for those by which actions lie out of bounds.
    pub epsilon_penalty: f64,
    /// How far the mean of an entry may go from that of the target policy.
    pub epsilon_mean: f64,
    /// How far the deviation of an entry may go from that of the target policy.
    pub epsilon_std: f64,
}

/// Settings of differential extrinsic plasticity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DepSettings {
    /// Whether it explores for MPO.
    pub explores: bool,
    /// How strongly it answers: kappa.
    pub gain: f64,
    /// Changes of sensors that it remembers: tau.
    pub horizon: usize,
    /// How fast biases follow what was done: beta.
    pub bias_rate: f64,
    /// Control steps from a change to what it is thought to have brought about.
    pub delay: usize,
    /// Control steps over which sensors are smoothed.
    pub smoothing: usize,
    /// The chance of a step of the policy to be the last before it acts.
    pub probability: f64,
    /// Control steps for which it acts then.
    pub length: usize,
}

impl Default for MpoSettings {
    fn default() -> Self {
        Self {
            actor_rate: 3e-4,
            critic_rate: 3e-4,
            dual_rate: 1e-2,
            replay: 1_000_000,
            start: 5_000,
            batch: 128,
            updates: 0.1,
            block: 30,
            steps: 3,
            samples: 10,
            follow: 0.005,
            epsilon: 0.1,
            epsilon_penalty: 1e-3,
            epsilon_mean: 1e-3,
            epsilon_std: 1e-6,
        }
    }
}

impl Default for DepSettings {
    fn default() -> Self {
        Self {
            explores: true,
            gain: 1169.7,
            horizon: 40,
            bias_rate: 0.002,
            delay: 5,
            smoothing: 2,
            probability: 0.001,
            length: 5,
        }
    }
}

/// Settings of imitation alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CloneSettings {
    /// Step of Adam.
    pub learning_rate: f64,
    /// Whether it falls to 0 over the training.
    pub anneal: bool,
    /// Rows of a gradient step.
    pub batch: usize,
    /// Gradient steps for each control step.
    pub updates: f64,
    /// Share of the steps in which the teacher acts, which is taken to the power of the round.
    pub guided: f64,
    /// Rows that are kept of what was played, beside the data sets.
    pub memory: usize,
    /// Whether the hyperbolic tangent of the output acts, as SAC has it.
    pub squash: bool,
}

impl Default for CloneSettings {
    fn default() -> Self {
        Self { learning_rate: 1e-3, anneal: true, batch: 256, updates: 0.5, guided: 0.0, memory: 200_000, squash: false }
    }
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
            (Algorithm::Sac | Algorithm::Mpo | Algorithm::Clone, Preset::Fast) => vec![256, 256],
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
            normalize_rewards: algorithm == Algorithm::Ppo || (algorithm == Algorithm::Sac && preset == Preset::Paper),
            evaluate_every: 50_000,
            evaluation_episodes: 10,
            checkpoint_every: 50_000,
            critics_first: 10_000,
            ppo: PpoSettings::default(),
            sac: SacSettings::default(),
            mpo: MpoSettings::default(),
            dep: DepSettings::default(),
            clone: CloneSettings::default(),
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
        let mpo = MpoSettings {
            actor_rate: 5e-5,
            critic_rate: 8e-5,
            dual_rate: 2e-3,
            start: 100_000,
            batch: 256,
            updates: 0.03,
            samples: 20,
            ..MpoSettings::default()
        };
        let episodes = if algorithm == Algorithm::Mpo { 16 } else { fast.episodes };
        let evaluate_every = if algorithm == Algorithm::Ppo { 500_000 } else { 200_000 };
        Self { episodes, evaluate_every, checkpoint_every: evaluate_every, ppo, sac, mpo, ..fast }
    }

    /// Reads a TOML file: keys that it does not set are those of its `algorithm` and its `preset`.
    ///
    /// # Errors
    /// No TOML, an unknown key, a value of another kind, or one that makes no sense.
    pub fn read(text: &str) -> Result<Self, SettingsError> {
        let settings = msk_settings::read(text, |written: &Self| Self::of(written.algorithm, written.preset))?;
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
        let checked = Checked::of(text);
        let Self { ppo, sac, mpo, dep, clone, .. } = self;
        let numbers: [(&'static str, f64, RangeInclusive<f64>); 30] = [
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
            ("actor_rate", mpo.actor_rate, 1e-8..=1.0),
            ("critic_rate", mpo.critic_rate, 1e-8..=1.0),
            ("dual_rate", mpo.dual_rate, 1e-8..=1.0),
            ("updates", mpo.updates, 1e-4..=64.0),
            ("follow", mpo.follow, 1e-6..=1.0),
            ("epsilon", mpo.epsilon, 1e-6..=10.0),
            ("epsilon_penalty", mpo.epsilon_penalty, 1e-9..=10.0),
            ("epsilon_mean", mpo.epsilon_mean, 1e-9..=10.0),
            ("epsilon_std", mpo.epsilon_std, 1e-12..=10.0),
            ("gain", dep.gain, 1e-3..=1e9),
            ("bias_rate", dep.bias_rate, 0.0..=1.0),
            ("probability", dep.probability, 0.0..=1.0),
            ("learning_rate", clone.learning_rate, 1e-8..=1.0),
            ("updates", clone.updates, 1e-4..=64.0),
            ("guided", clone.guided, 0.0..=1.0),
            ("critics_first", self.critics_first as f64, 0.0..=1e12),
            ("evaluate_every", self.evaluate_every as f64, 1.0..=1e12),
        ];
        for (key, found, range) in numbers {
            checked.number(key, found, range, "")?;
        }
        let counts: [(&'static str, usize, RangeInclusive<usize>); 22] = [
            ("episodes", self.episodes, 1..=4096),
            ("evaluation_episodes", self.evaluation_episodes, 1..=1000),
            ("checkpoint_every", usize::try_from(self.checkpoint_every).unwrap_or(usize::MAX), 1..=1_000_000_000_000),
            ("horizon", ppo.horizon, 1..=1_000_000),
            ("minibatch", ppo.minibatch, 1..=1_000_000),
            ("epochs", ppo.epochs, 1..=1000),
            ("replay", sac.replay, 1..=100_000_000),
            ("start", sac.start, 1..=100_000_000),
            ("batch", sac.batch, 1..=1_000_000),
            ("replay", mpo.replay, 1..=100_000_000),
            ("start", mpo.start, 1..=100_000_000),
            ("batch", mpo.batch, 1..=1_000_000),
            ("block", mpo.block, 1..=100_000),
            ("steps", mpo.steps, 1..=1000),
            ("samples", mpo.samples, 1..=10_000),
            ("horizon", dep.horizon, 3..=10_000),
            ("delay", dep.delay, 0..=1000),
            ("smoothing", dep.smoothing, 1..=1000),
            ("length", dep.length, 1..=100_000),
            ("batch", clone.batch, 1..=1_000_000),
            ("memory", clone.memory, 1..=100_000_000),
            ("actor_delay", sac.actor_delay, 1..=1000),
        ];
        for (key, found, range) in counts {
            checked.count(key, found, range)?;
        }
        if !(1..=16).contains(&self.hidden.len()) {
            return checked.refuse("hidden", format!("{:?}", self.hidden), "1 to 16 sizes of layers".into());
        }
        if let Some(size) = self.hidden.iter().find(|size| !(1..=16384).contains(*size)) {
            return checked.refuse("hidden", size.to_string(), "sizes from 1 to 16384".into());
        }
        if self.algorithm == Algorithm::Ppo && ppo.minibatch > ppo.horizon * self.episodes {
            let all = ppo.horizon * self.episodes;
            return checked.refuse(
                "minibatch",
                ppo.minibatch.to_string(),
                format!("at most `horizon` x `episodes`, which is {all}"),
            );
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
        assert_eq!(message("hidden = []"), "line 1: `hidden` is []; expected 1 to 16 sizes of layers");
        assert_eq!(message("hidden = [64, 0]"), "line 1: `hidden` is 0; expected sizes from 1 to 16384");
        assert_eq!(
            message("[ppo]\nminibatch = 5000"),
            "line 2: `minibatch` is 5000; expected at most `horizon` x `episodes`, which is 2048"
        );
        assert!(message("algorithm = \"ddpg\"").contains("expected one of `ppo`, `sac`, `mpo`, `clone`"));
    }
}
