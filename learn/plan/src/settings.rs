//! Settings of a planner: presets, files, and what they may hold.

use msk_physics::scalar::Real;
use msk_program::action;
use msk_settings::{Checked, SettingsError};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// A named set of settings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// To look at behaviour: seconds of computing for each simulated second.
    #[default]
    Fast,
    /// For results: what is imagined is closer to what will be, for half as much computing again.
    Good,
    /// As far as patience goes.
    Best,
}

impl Preset {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Self); 3] = [("fast", Self::Fast), ("good", Self::Good), ("best", Self::Best)];
}

/// How the values of plans make a better one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Predictive sampling: the best plan.
    Predictive,
    /// The cross-entropy method: the mean of the best few, which also set how far the next ones are drawn.
    Cem,
    /// Model-predictive path integral control: the mean of all, weighted exponentially by value.
    Mppi,
}

/// How a plan goes from knot to knot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// In a straight line.
    Linear,
    /// Smoothly, by cubics.
    Cubic,
}

/// What a plan decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SpaceChoice {
    /// What the task's `act` block declares; without one, targets.
    Auto,
    /// Actions of the task's own space.
    Task,
    /// Targets of computed muscle control.
    Targets,
    /// What is added to the action of each muscle under computed muscle control.
    Muscles,
    /// The same for the recruitment families of the body's muscles, those of each side apart.
    Synergies,
}

/// Which targets of computed muscle control a plan moves, and how far.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Targets {
    /// Names of joints and of groups of joints; empty for legs, lumbar spine, shoulders and elbows, as far as the body has them, and of a gait for the lumbar spine.
    pub joints: Vec<String>,
    /// Largest offset of a joint, rad.
    pub joint_range: f64,
    /// The same for shoulders and elbows, which reach further without a fall.
    pub arm_range: f64,
    /// Largest shift of the centre of mass, m.
    pub center_of_mass: f64,
    /// Largest turn of the root, rad.
    pub root: f64,
    /// How far hands reach from where they are when an episode begins, along each axis of the root's heading, m; 0 where they do not.
    pub reach: f64,
    /// Largest factor by which balance and resting feet count more or less against the joints; 1 where they count as ever.
    pub priority_factor: f64,
    /// Largest speeds of a gait forward and to the left, m/s, and of its turn, rad/s. Of its balance plans move nothing else.
    pub pace: [f64; 3],
    /// The largest speed forward of a fast gait, m/s, which is taken on level ground where the largest pace forward serves best and it earns much more; 0 for none.
    pub fast: f64,
    /// What has the targets that are moved.
    pub along: Along,
}

/// What has the targets of computed muscle control before a plan moves them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Along {
    /// Whichever of the others earns most by itself in the first seconds: the demonstration counts where the task follows no motion, and it
    /// decides nothing that is drawn; the gait, at a few constant paces.
    #[default]
    Auto,
    /// The task's reference motion, or its initial pose.
    Reference,
    /// The task's demonstration, where it has one.
    Demonstration,
    /// A gait, which steps wherever balance needs it: plans say how fast it walks and turns.
    Gait,
}

impl Default for Targets {
    fn default() -> Self {
        Self {
            joints: Vec::new(),
            joint_range: 0.6,
            arm_range: 1.5,
            center_of_mass: 0.15,
            root: 0.4,
            reach: 0.6,
            priority_factor: 4.0,
            pace: [1.0, 0.2, 0.5],
            fast: 2.0,
            along: Along::Auto,
        }
    }
}

/// Settings of a planner. Times are in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// The settings that those of a file change.
    pub preset: Preset,
    /// What a plan decides.
    pub space: SpaceChoice,
    /// For how long each of what may have the targets is imagined by itself before the first plan, s: the best is followed. With 0 it is the task's
    /// reference motion, or its initial pose.
    pub look: f64,
    /// After how long a body that walks is asked anew whether the demonstration from some time of it on is better, s; 0 for never.
    pub look_again: f64,
    /// How plans are improved.
    pub method: Method,
    /// How far a plan reaches, s.
    pub horizon: f64,
    /// For how long a plan is judged after its end, while nothing is asked for, s.
    pub tail: f64,
    /// How many times a reward in the tail counts: the tail stands for all that comes after the horizon.
    pub tail_weight: f64,
    /// What failing at the beginning of the tail costs: the largest reward in sight for so many seconds.
    pub failure_price: f64,
    /// What a capture point costs that at the end of the tail misses its place well within the support by 0.3 m or more: the usual reward for so
    /// many seconds. Tasks that follow a motion do not have this price.
    pub balance_price: f64,
    /// What a plan costs with every entry at the end of its range: the usual reward over the horizon, times this.
    pub change_price: f64,
    /// Time constant of the low-pass filter between a plan and what is asked for, s: proposals begin where the last plan has led.
    pub smooth: f64,
    /// Plans of a round.
    pub samples: usize,
    /// Rounds for each plan.
    pub rounds: u32,
    /// Rounds for the first plan of an episode.
    pub first_rounds: u32,
    /// Control steps after which a new plan is made.
    pub replan: u32,
    /// Knots over the horizon.
    pub knots: usize,
    /// How a plan goes from knot to knot.
    pub interpolation: Interpolation,
    /// Standard deviation of proposals, as a share of the range of an entry.
    pub noise: f64,
    /// The least to which `cem` and `mppi` bring it.
    pub least_noise: f64,
    /// Correlation of the noise of neighbouring knots.
    pub colour: f64,
    /// The chance of an entry to be changed in a proposal that does not change all.
    pub part: f64,
    /// What is left of a plan after its end.
    pub decay: f64,
    /// Plans that `cem` takes the mean of.
    pub elites: usize,
    /// By how much of the better half's spread a plan may be worse before `mppi` weights it down by e.
    pub temperature: f64,
    /// For how long muscles keep what was asked of them in imagined episodes, in whole control steps, s.
    pub hold: f64,
    /// Whether computed muscle control shares forces out roughly in imagined episodes, in less time.
    pub rough: bool,
    /// Physics steps of the task in one of imagined episodes.
    pub coarseness: u32,
    /// Seed of the planner's own chance, beside that of the episode.
    pub seed: u64,
    /// Whether an episode that ends with success counts as failed: what else does the reward ask for?
    pub avoid_success: bool,
    /// What is moved where a plan decides targets.
    pub targets: Targets,
}

impl Default for Settings {
    fn default() -> Self {
        Self::of(Preset::Fast)
    }
}

/// For how long at least a gait is planned, and is judged after that, s: three steps of its feet each.
const SIGHT: f64 = 1.5;
/// For how long a pace lasts at least, s.
const LASTS: f64 = 0.3;

impl Settings {
    /// Those of a preset.
    pub fn of(preset: Preset) -> Self {
        let fast = Self {
            preset,
            space: SpaceChoice::Auto,
            look: 5.0,
            look_again: 0.5,
            method: Method::Cem,
            horizon: 0.6,
            tail: 0.2,
            tail_weight: 1.0,
            failure_price: 0.5,
            balance_price: 8.0,
            change_price: 0.1,
            smooth: 0.06,
            samples: 24,
            rounds: 1,
            first_rounds: 3,
            replan: 10,
            knots: 4,
            interpolation: Interpolation::Linear,
            noise: 0.15,
            least_noise: 0.04,
            colour: 0.5,
            part: 0.3,
            decay: 0.95,
            elites: 4,
            temperature: 0.5,
            hold: 0.02,
            rough: true,
            coarseness: 5,
            seed: 0,
            avoid_success: false,
            targets: Targets::default(),
        };
        match preset {
            Preset::Fast => fast,
            Preset::Good => Self { rough: false, coarseness: 2, ..fast },
            Preset::Best => Self { samples: 48, rounds: 2, replan: 5, rough: false, coarseness: 1, ..fast },
        }
    }

    /// The same for plans that say how a gait goes, with times in control steps by `in_steps`. A pace lasts: it is seen for some steps of the feet, made
    /// anew less often, and asks for no less where its plan ends.
    #[must_use]
    pub(crate) fn walking(&self, in_steps: impl Fn(f64) -> u32) -> Self {
        Self {
            horizon: self.horizon.at_least(SIGHT),
            tail: self.tail.at_least(SIGHT),
            replan: self.replan.max(in_steps(LASTS)),
            decay: 1.0,
            change_price: 0.0,
            colour: self.colour.at_least(0.9),
            ..self.clone()
        }
    }

    /// Reads a TOML file: keys that it does not set are those of its `preset`, or of `fast`.
    ///
    /// # Errors
    /// No TOML, an unknown key, a value of another kind, or one that makes no sense.
    pub fn read(text: &str) -> Result<Self, SettingsError> {
        let settings = msk_settings::read(text, |written: &Self| Self::of(written.preset))?;
        settings.check(text)?;
        Ok(settings)
    }

    /// Whether every number lies where it makes sense.
    fn check(&self, text: &str) -> Result<(), SettingsError> {
        let checked = Checked::of(text);
        let [forward, left, turn] = self.targets.pace;
        let [most_forward, most_left, most_turn] = action::Along::MOST_PACE;
        let numbers: [(&'static str, f64, RangeInclusive<f64>, &str); 26] = [
            ("look", self.look, 0.0..=10.0, "s"),
            ("look_again", self.look_again, 0.0..=100.0, "s"),
            ("horizon", self.horizon, 0.01..=10.0, "s"),
            ("tail", self.tail, 0.0..=10.0, "s"),
            ("tail_weight", self.tail_weight, 0.0..=1000.0, ""),
            ("failure_price", self.failure_price, 0.0..=1000.0, "s"),
            ("balance_price", self.balance_price, 0.0..=1000.0, "s"),
            ("change_price", self.change_price, 0.0..=1000.0, ""),
            ("smooth", self.smooth, 0.0..=10.0, "s"),
            ("hold", self.hold, 0.0..=1.0, "s"),
            ("noise", self.noise, 1e-3..=2.0, ""),
            ("least_noise", self.least_noise, 0.0..=2.0, ""),
            ("colour", self.colour, 0.0..=0.999, ""),
            ("part", self.part, 0.0..=1.0, ""),
            ("decay", self.decay, 0.0..=1.0, ""),
            ("temperature", self.temperature, 1e-3..=1e3, ""),
            ("joint_range", self.targets.joint_range, 0.0..=3.2, "rad"),
            ("arm_range", self.targets.arm_range, 0.0..=3.2, "rad"),
            ("center_of_mass", self.targets.center_of_mass, 0.0..=1.0, "m"),
            ("root", self.targets.root, 0.0..=3.2, "rad"),
            ("reach", self.targets.reach, 0.0..=2.0, "m"),
            ("pace", forward, 0.01..=most_forward, "m/s"),
            ("fast", self.targets.fast, 0.0..=most_forward, "m/s"),
            ("pace", left, 0.01..=most_left, "m/s"),
            ("pace", turn, 0.01..=most_turn, "rad/s"),
            ("priority_factor", self.targets.priority_factor, 1.0..=100.0, ""),
        ];
        for (key, found, range, unit) in numbers {
            checked.number(key, found, range, unit)?;
        }
        let counts: [(&'static str, usize, RangeInclusive<usize>); 7] = [
            ("samples", self.samples, 4..=4096),
            ("rounds", self.rounds as usize, 1..=100),
            ("first_rounds", self.first_rounds as usize, 1..=1000),
            ("replan", self.replan as usize, 1..=1000),
            ("knots", self.knots, 2..=64),
            ("elites", self.elites, 1..=4096),
            ("coarseness", self.coarseness as usize, 1..=10),
        ];
        counts.into_iter().try_for_each(|(key, found, range)| checked.count(key, found, range))
    }
}
