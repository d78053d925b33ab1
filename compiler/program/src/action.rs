//! Action spaces: what the entries of a policy's action ask for.
//!
//! Every entry is in [-1, 1]. On its way to the body an action is scaled, delayed and filtered; then it becomes one action per
//! muscle (and torques, in [`ActionTarget::Torque`]), which the body's excitation map makes excitations of.

use crate::vocabulary::Vocabulary;
use std::sync::Arc;

/// The action space of a task.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionSpace {
    /// What the entries stand for.
    pub target: ActionTarget,
    /// Whether entries for muscles ask for activations at the end of the control step, for which excitations are found, instead of
    /// excitations.
    pub activations: bool,
    /// Factor of every entry.
    pub scale: f64,
    /// Time constant of the low-pass filter of first order that every entry passes, s; 0 for none.
    pub filter: f64,
    /// Control steps after which an action takes effect; 0 for the step that it is given to.
    pub latency: u32,
    /// The controller to whose actions those of the policy are added, muscle by muscle.
    pub residual: Option<BaseController>,
}

/// What the entries of an action stand for.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum ActionTarget {
    /// The actions of all muscles, in the order of the vocabulary.
    #[default]
    AllMuscles,
    /// The actions of these muscles; the others rest.
    Muscles(Vec<usize>),
    /// The actions of groups of muscles, each shared by all muscles of its group; muscles of no group rest.
    Synergies(Vec<Synergy>),
    /// Torques on hinges; all muscles rest.
    Torque {
        /// Independent hinges of the body.
        joints: Vec<usize>,
        /// The torque of an entry of 1 on each of them, N m.
        ranges: Vec<f64>,
    },
    /// Offsets of what computed muscle control tracks.
    MuscleControl(TrackingOffsets),
}

/// Muscles that share an action.
#[derive(Debug, Clone, PartialEq)]
pub struct Synergy {
    /// Its name.
    pub name: String,
    /// Its muscles.
    pub muscles: Vec<usize>,
}

/// Which targets of computed muscle control an action moves, and how far an entry of 1 moves them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackingOffsets {
    /// Independent hinges of the body whose targets are moved.
    pub joints: Vec<usize>,
    /// By how much, rad.
    pub range: f64,
    /// By how much the target of the centre of mass is moved, along each of forward, left and up of the root's heading, m; 0 if it is
    /// not.
    pub center_of_mass: f64,
    /// By how much the target of the root's orientation is turned, about each of its axes forward, left and up, rad; 0 if it is not.
    pub root: f64,
    /// Hands that reach: landmarks of the body's group `hands`.
    pub hands: Vec<usize>,
    /// How far from where they are when an episode begins, along each of forward, left and up of the root's heading, m.
    pub reach: f64,
    /// The natural logarithm of the factor by which balance, and feet at rest, count more or less against the joints; 0 if they do as
    /// ever. The language has no word for it; planners use it.
    pub priorities: f64,
    /// What has the targets.
    pub along: Along,
}

/// What has the targets of computed muscle control before an action moves them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Along {
    /// The reference motion of the task, or the pose of its initial state.
    #[default]
    Reference,
    /// The script with which the task's tests show that it can succeed.
    Demonstration,
    /// A gait, which steps wherever balance needs it.
    Gait {
        /// How fast it walks forward where entries are 0, m/s.
        speed: f64,
        /// By how much an entry of 1 changes how fast it walks forward and to its left, m/s, and turns to the left, rad/s.
        pace: [f64; 3],
        /// The time of the demonstration from which the body goes on with it, s, once an entry of its own asks for that; `None` where there
        /// is no such entry, and the gait goes on.
        then: Option<f64>,
    },
}

impl Along {
    /// The largest speeds of a gait forward and to its left, m/s, and of its turn, rad/s: beyond what it keeps up.
    pub const MOST_PACE: [f64; 3] = [2.0, 1.0, 2.0];

    /// The entry that changes over from a gait to the demonstration does so above this: halfway.
    pub const CHANGES_OVER: f64 = 0.5;
}

/// A controller that acts beside a policy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BaseController {
    /// Computed muscle control of the task's reference motion, or of the pose of its initial state.
    MuscleControl,
    /// Computed muscle control of the script with which the task's tests show that it can succeed.
    Demonstration,
    /// A network that sees the observation of the task and gives an action for each muscle.
    Network(Arc<BaseNetwork>),
}

impl BaseController {
    /// Those that the language knows by a name.
    pub const NAMED: [Self; 2] = [Self::MuscleControl, Self::Demonstration];

    /// Its name in texts and results: that of the policy which acts in the same way.
    pub fn name(&self) -> &'static str {
        match self {
            Self::MuscleControl => "cmc",
            Self::Demonstration => "demonstration",
            Self::Network(_) => "network",
        }
    }
}

/// A network as it was read, unopened: the compiler does not know what is in it.
#[derive(Clone, PartialEq, Eq)]
pub struct BaseNetwork {
    /// As the task names it; the ending tells its format.
    pub path: String,
    /// SHA-256 of the bytes, hexadecimal.
    pub digest: String,
    /// The file.
    pub bytes: Arc<[u8]>,
}

impl core::fmt::Debug for BaseNetwork {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("BaseNetwork").field("path", &self.path).field("digest", &self.digest).finish_non_exhaustive()
    }
}

impl Default for ActionSpace {
    fn default() -> Self {
        Self { target: ActionTarget::AllMuscles, activations: false, scale: 1.0, filter: 0.0, latency: 0, residual: None }
    }
}

impl ActionSpace {
    /// Whether what it does depends on the observation, because a network acts beside the policy.
    pub fn reads_observation(&self) -> bool {
        matches!(self.residual, Some(BaseController::Network(_)))
    }

    /// Whether an action is one entry per muscle that reaches it unchanged, as in tasks without `act`.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Number of entries of an action on a body of so many muscles.
    pub fn size(&self, muscles: usize) -> usize {
        match &self.target {
            ActionTarget::AllMuscles => muscles,
            ActionTarget::Muscles(chosen) => chosen.len(),
            ActionTarget::Synergies(synergies) => synergies.len(),
            ActionTarget::Torque { joints, .. } => joints.len(),
            ActionTarget::MuscleControl(offsets) => offsets.size(),
        }
    }

    /// The entry that asks for nothing, which is in force before the first step: 0 where entries add to something or are torques,
    /// else -1, a muscle at rest.
    pub fn rest(&self) -> f64 {
        match self.target {
            ActionTarget::Torque { .. } | ActionTarget::MuscleControl(_) => 0.0,
            _ if self.residual.is_some() => 0.0,
            _ => -1.0,
        }
    }

    /// The word of the language for what its entries stand for.
    pub fn word(&self) -> &'static str {
        match self.target {
            ActionTarget::AllMuscles | ActionTarget::Muscles(_) => "muscles",
            ActionTarget::Synergies(_) => "synergies",
            ActionTarget::Torque { .. } => "torque",
            ActionTarget::MuscleControl(_) => "cmc",
        }
    }

    /// Names of the entries of an action, in order: muscles, synergies or joints, then `com.forward`, `root.left` and the like.
    pub fn names(&self, vocabulary: &Vocabulary) -> Vec<String> {
        let muscle = |&index: &usize| vocabulary.muscles.get(index).map_or_else(String::new, |muscle| muscle.name.clone());
        let joint = |&index: &usize| vocabulary.joints.get(index).map_or_else(String::new, |joint| joint.name.clone());
        match &self.target {
            ActionTarget::AllMuscles => vocabulary.muscles.iter().map(|muscle| muscle.name.clone()).collect(),
            ActionTarget::Muscles(muscles) => muscles.iter().map(muscle).collect(),
            ActionTarget::Synergies(synergies) => synergies.iter().map(|synergy| synergy.name.clone()).collect(),
            ActionTarget::Torque { joints, .. } => joints.iter().map(joint).collect(),
            ActionTarget::MuscleControl(offsets) => {
                let axes = |of: &'static str| ["forward", "left", "up"].map(|axis| format!("{of}.{axis}"));
                let moved = |range: f64, of: &'static str| axes(of).into_iter().filter(move |_| range > 0.0);
                let joints = offsets.joints.iter().map(joint);
                let priorities = ["balance", "feet"].into_iter().filter(|_| offsets.priorities > 0.0).map(str::to_owned);
                let walk = ["forward", "left", "turn"].into_iter().filter(|_| offsets.walks()).map(|axis| format!("walk.{axis}"));
                let axes = moved(offsets.center_of_mass, "com").chain(moved(offsets.root, "root"));
                let demonstration = offsets.changes_over_to().map(|_| "demonstration".to_owned());
                let hand =
                    |&hand: &usize| vocabulary.landmarks.get(hand).map_or_else(String::new, |landmark| landmark.name.clone());
                let hands = offsets
                    .hands
                    .iter()
                    .map(hand)
                    .flat_map(|name| ["forward", "left", "up"].map(|axis| format!("{name}.{axis}")));
                joints.chain(axes).chain(hands).chain(walk).chain(demonstration).chain(priorities).collect()
            }
        }
    }
}

/// The ranges of several joints as people write them: one where all are the same.
pub fn distinct(ranges: &[f64]) -> &[f64] {
    match ranges {
        [first, rest @ ..] if rest.iter().all(|range| range == first) => core::slice::from_ref(first),
        _ => ranges,
    }
}

impl TrackingOffsets {
    /// Number of entries that they take.
    pub fn size(&self) -> usize {
        let axes = |range: f64| if range > 0.0 { 3 } else { 0 };
        let (walk, priorities) = (if self.walks() { 3 } else { 0 }, if self.priorities > 0.0 { 2 } else { 0 });
        let demonstration = usize::from(self.changes_over_to().is_some());
        self.joints.len() + axes(self.center_of_mass) + axes(self.root) + 3 * self.hands.len() + walk + demonstration + priorities
    }

    /// Whether the controller is a gait.
    pub fn walks(&self) -> bool {
        matches!(self.along, Along::Gait { .. })
    }

    /// How far entries change the speeds of its gait, forward and left, m/s, and its turn, rad/s; 0 without one.
    pub fn pace(&self) -> [f64; 3] {
        if let Along::Gait { pace, .. } = self.along { pace } else { [0.0; 3] }
    }

    /// The time of the demonstration from which an entry of its gait goes on with it, s; `None` where no entry does.
    pub fn changes_over_to(&self) -> Option<f64> {
        if let Along::Gait { then, .. } = self.along { then } else { None }
    }

    /// How fast its gait walks forward where entries are 0, m/s.
    pub fn speed(&self) -> f64 {
        if let Along::Gait { speed, .. } = self.along { speed } else { 0.0 }
    }
}
