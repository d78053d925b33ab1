//! Settings of a training: presets, files, and what they may hold.

mod check;
mod presets;

use msk_network::{Activation, Shape};
use msk_settings::SettingsError;
use serde::{Deserialize, Serialize};

/// How an agent learns.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Algorithm {
    /// Proximal policy optimisation.
    #[default]
    Ppo,
    /// Soft actor-critic.
    Sac,
    /// Soft actor-critic with residual networks of the kind of `SimBa`.
    Simba,
    /// Soft actor-critic of groups of muscles that change together: `DynSyn`.
    Dynsyn,
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
    pub const NAMED: [(&'static str, Self); 6] = [
        ("ppo", Self::Ppo),
        ("sac", Self::Sac),
        ("simba", Self::Simba),
        ("dynsyn", Self::Dynsyn),
        ("mpo", Self::Mpo),
        ("clone", Self::Clone),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ppo => "ppo",
            Self::Sac => "sac",
            Self::Simba => "simba",
            Self::Dynsyn => "dynsyn",
            Self::Mpo => "mpo",
            Self::Clone => "clone",
        }
    }
}

impl Preset {
    /// All of them, with their names.
    pub const NAMED: [(&'static str, Self); 2] = [("fast", Self::Fast), ("paper", Self::Paper)];
}

/// How exactly a replay buffer keeps numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Single precision: 32 bits.
    #[default]
    Single,
    /// 16 bits: a share of what a number's column spans in a block of transitions.
    Compact,
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
    /// Sizes of the hidden layers of every network; of residual ones the sizes of their blocks.
    pub hidden: Vec<usize>,
    /// Those of critics, where they are others.
    pub critic_hidden: Vec<usize>,
    /// What follows a hidden layer.
    pub activation: Activation,
    /// Whether hidden layers are normalised.
    pub layer_norm: bool,
    /// Whether hidden layers are residual blocks, which always have norms.
    pub residual: bool,
    /// Weight of a reward that comes one control step later: gamma.
    pub discount: f64,
    /// Control steps that an action lasts for: an agent chooses the next one after that many.
    pub action_repeat: usize,
    /// Whether networks see observations with running mean 0 and deviation 1.
    pub normalize_observations: bool,
    /// Whether rewards are divided by the running deviation of the discounted return.
    pub normalize_rewards: bool,
    /// Share of the noise of actions that is left in the next one: 0 for noise that is new every time.
    pub noise_correlation: f64,
    /// Control steps from one evaluation to the next.
    pub evaluate_every: u64,
    /// Episodes of an evaluation.
    pub evaluation_episodes: usize,
    /// Control steps from one checkpoint to the next.
    pub checkpoint_every: u64,
    /// How exactly replay buffers keep observations and actions.
    pub replay_precision: Precision,
    /// Memory of a replay buffer, GiB: it keeps as many transitions as fit, if `replay` asks for more.
    pub replay_memory: f64,
    /// Control steps for which a training that starts as an agent, or with `zero_init`, improves its critics alone.
    pub critics_first: u64,
    /// Those of PPO.
    pub ppo: PpoSettings,
    /// Those of SAC and of what is built on it.
    pub sac: SacSettings,
    /// Those of the groups of `DynSyn`.
    pub dynsyn: DynsynSettings,
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

/// Settings of SAC, of `SimBa` and of `DynSyn`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SacSettings {
    /// Step of Adam for the actor.
    pub actor_rate: f64,
    /// Step of Adam for the critics.
    pub critic_rate: f64,
    /// Transitions that are kept.
    pub replay: usize,
    /// Transitions with random actions, one for each action, before it learns.
    pub start: usize,
    /// Whether the actor begins with actions near 0 in place of random ones, and stays so for `critics_first` control steps.
    pub zero_init: bool,
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
    /// Whether the weight of the entropy is tuned so that the entropy is minus `target_entropy` for each entry of an action.
    pub automatic: bool,
    /// See `automatic`.
    pub target_entropy: f64,
    /// Share of the rates that is left at the end; they fall in proportion to what is left of the training until they have reached it.
    pub anneal: f64,
    /// Share by which weights shrink in a gradient step, times the rate.
    pub weight_decay: f64,
}

/// Settings of the groups of `DynSyn`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DynsynSettings {
    /// Groups of entries that act together, at most one per entry.
    pub groups: usize,
    /// How far the weight of an entry may be from 1 at the end.
    pub amplitude: f64,
    /// Share of the training from which on weights are freed, up to `amplitude` at the end.
    pub release: f64,
    /// Control steps for which the body is shaken to find the groups.
    pub rollout: usize,
    /// Largest speed that a shake gives to a joint, rad/s or m/s.
    pub speed: f64,
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

impl Settings {
    /// The shape of a network between so many numbers.
    pub(crate) fn shape(&self, inputs: usize, outputs: usize) -> Shape {
        let Self { activation, layer_norm, residual, .. } = *self;
        Shape { inputs, hidden: self.hidden.clone(), outputs, activation, layer_norm, residual }
    }

    /// That of a critic.
    pub(crate) fn critic_shape(&self, inputs: usize, outputs: usize) -> Shape {
        let shape = self.shape(inputs, outputs);
        if self.critic_hidden.is_empty() { shape } else { Shape { hidden: self.critic_hidden.clone(), ..shape } }
    }

    /// Control steps of one slot after another that so many transitions take.
    pub(crate) fn control_steps(&self, transitions: usize) -> u64 {
        (transitions * self.action_repeat) as u64
    }

    /// Weight of a reward that comes one action later.
    pub(crate) fn action_discount(&self) -> f64 {
        libm::pow(self.discount, self.action_repeat as f64)
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
        assert!(message("algorithm = \"ddpg\"").contains("expected one of `ppo`, `sac`, `simba`, `dynsyn`, `mpo`, `clone`"));
        assert_eq!(
            message("algorithm = \"simba\"\ncritic_hidden = [64, 32]"),
            "line 2: `critic_hidden` is [64, 32]; expected blocks of one size, because `residual` adds them up"
        );
    }
}
