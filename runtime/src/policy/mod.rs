//! Policies: what turns an observation into an action.
//!
//! A policy gives numbers in [-1, 1] at every control step: an action of the task's own action space, or one per muscle. Learned
//! policies look at the observation only; model-based ones may read body, state and the forward pass.

mod cmc;
#[cfg(feature = "system")]
mod outside;
mod pace;
mod random;
#[cfg(feature = "system")]
mod source;
mod zero;

pub use cmc::ComputedMuscleControl;
#[cfg(feature = "system")]
pub(crate) use outside::{Evaluation, NetworkContent};
pub use pace::Pace;
pub use random::Random;
#[cfg(feature = "system")]
pub use source::{PolicyMaker, PolicySource, TIMEOUT};
pub use zero::Zero;

pub use crate::action::ActsOn;

use crate::action::Controls;
use crate::body::Body;
use crate::body::sensors::Snapshot;
use crate::cmc::{Moment, Present};
use crate::episode::{Engine, Episode, EpisodeKey};
use msk_physics::model::Model;
use msk_physics::{State, Workspace};
use msk_program::action::Along;
use msk_program::task::{CompiledTask, TaskState};

/// What a policy may look at: the snapshot that the next action answers to.
#[derive(Clone, Copy)]
pub struct PolicyContext<'a> {
    /// What the episode is played with: a policy that looks ahead plays copies of it.
    pub engine: &'a Engine,
    /// The episode.
    pub episode: &'a Episode,
    /// The weights that reward it, one per term.
    pub weights: &'a [f64],
    /// The task.
    pub task: &'a CompiledTask,
    /// The body, bound to its model.
    pub body: &'a Body,
    /// The model.
    pub model: &'a Model,
    /// Which episode: the key of all random streams.
    pub key: EpisodeKey,
    /// Control steps since reset.
    pub step: u32,
    /// Physics steps that one action is held for.
    pub substeps: u32,
    /// How far the task has come, and what chance has drawn.
    pub progress: &'a TaskState,
    /// Observation, in the order and units of the task's channels.
    pub observation: &'a [f64],
    /// Present state.
    pub state: &'a State<f64>,
    /// Forward pass of that state, contacts and all.
    pub workspace: &'a Workspace<f64>,
}

impl<'a> PolicyContext<'a> {
    /// Number of entries of an action in the task's own action space.
    pub fn action_size(&self) -> usize {
        ActsOn::Task.size(self.task, self.body)
    }

    /// The same, as controllers see it.
    pub(crate) fn moment(&self) -> Moment<'a> {
        let &Self { task, progress, substeps, observation, body, model, state, workspace, .. } = self;
        Moment { task, progress, substeps, observation, present: Present { body, model, state, workspace } }
    }

    /// The body in its scene at this moment, as sensors and pictures take it.
    pub fn snapshot(&self) -> Snapshot<'a> {
        Snapshot { body: self.body, model: self.model, state: self.state, workspace: self.workspace }
    }
}

/// A policy. One value serves one episode at a time; every worker has its own.
pub trait Policy: Send {
    /// Its name in results.
    fn name(&self) -> &str;

    /// Prepares for an episode, which has just been reset.
    ///
    /// # Errors
    /// A body or task that the policy cannot act on.
    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError>;

    /// Which entries its actions have; asked for after a reset.
    fn acts_on(&self) -> ActsOn {
        ActsOn::Task
    }

    /// Writes the next action, entries in [-1, 1] as [`acts_on`](Self::acts_on) has them. What lies outside is clipped by the
    /// episode.
    ///
    /// # Errors
    /// What keeps the policy from acting; the evaluation stops.
    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError>;

    /// What acts for it, if that is the same controls all the time and it gives them no entries: those of several episodes then
    /// act [together](crate::episode::GroupScratch::control), to the bits of [`act`](Self::act).
    fn controls(&mut self) -> Option<&mut Controls> {
        None
    }
}

/// Why a policy cannot act, or does not exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PolicyError {
    /// No policy of that name.
    #[error("there is no policy `{0}`; choose one of: {names}", names = NAMES.join(", "))]
    Unknown(String),
    /// No policy that a command line names like this.
    #[error("there is no policy `{0}`; choose one of: {names}, plan [PRESET | FILE], agent FOLDER, agents [FOLDER], process COMMAND, network FILE, replay FILE", names = NAMES.join(", "))]
    UnknownSource(String),
    /// A policy that only the command line names.
    #[error(
        "`{0}` is not available here: it imagines hundreds of episodes for each that it plays; use it with `msk run` and `msk eval`"
    )]
    CommandLineOnly(String),
    /// The policy that is tested, where none is.
    #[error("this test runs the policy that is tested: name one, `msk test --policy cmc`")]
    NotGiven,
    /// A policy from outside without what it is.
    #[error("`{policy}` needs a {}: write `{example}`", match *policy { "process" => "command", "agent" => "folder", _ => "file" })]
    Incomplete {
        /// Its kind.
        policy: &'static str,
        /// A complete one.
        example: &'static str,
    },
    /// A process with an option that it does not have.
    #[error("`process` has no option `{0}`: write `process COMMAND` for lines of JSON or `process --messagepack COMMAND`")]
    ProcessOption(String),
    /// A file that cannot be read.
    #[error("cannot read `{path}`: {reason}")]
    Unreadable {
        /// As it was named.
        path: String,
        /// Why not.
        reason: String,
    },
    /// A policy that has another name today.
    #[error("the policy `{former}` is now called `{present}`")]
    Renamed {
        /// Its name once.
        former: &'static str,
        /// Its name.
        present: &'static str,
    },
    /// The policy cannot act on this body or task.
    #[error("policy `{policy}` does not support this: {reason}")]
    Unable {
        /// Its name.
        policy: String,
        /// What is missing.
        reason: String,
    },
    /// A policy from outside broke down.
    #[error("policy `{policy}` failed: {reason}")]
    Failed {
        /// Its name.
        policy: String,
        /// What happened, with what it wrote last.
        reason: String,
    },
    /// A gait without a sensible pace.
    #[error("`{text}` {reason}; write `gait FORWARD LEFT TURN` in m/s, m/s and rad/s, at most {}, {} and {}, and `smooth` behind them for actions to imitate", Along::MOST_PACE[0], Along::MOST_PACE[1], Along::MOST_PACE[2])]
    Gait {
        /// As it was written.
        text: String,
        /// Why not, in words that continue it.
        reason: String,
    },
    /// The wait for a policy from outside was given up because the run is to stop.
    #[error("interrupted")]
    Interrupted,
}

/// The built-in policies.
pub const NAMES: &[&str] =
    &["zero", "random", "cmc", "cmc smooth", "demonstration", "demonstration smooth", "gait", "gait smooth"];

/// The name under which results know a policy, given that or a former one that still works.
pub fn present_name(name: &str) -> &str {
    if name == "posture" { "cmc" } else { name }
}

/// A new built-in policy of that name. [`PolicySource`] names those from outside, too.
///
/// # Errors
/// An unknown name.
pub fn create(name: &str) -> Result<Box<dyn Policy>, PolicyError> {
    match present_name(name) {
        "zero" => Ok(Box::new(Zero)),
        "random" => Ok(Box::new(Random)),
        "cmc" => Ok(Box::<ComputedMuscleControl>::default()),
        "demonstration" => Ok(Box::new(ComputedMuscleControl::demonstration())),
        "cmc smooth" => Ok(Box::new(ComputedMuscleControl::default().smooth())),
        "demonstration smooth" => Ok(Box::new(ComputedMuscleControl::demonstration().smooth())),
        "witness" => Err(PolicyError::Renamed { former: "witness", present: "demonstration" }),
        gait if gait.split_whitespace().next() == Some("gait") => {
            let smooth = gait.strip_suffix(" smooth");
            let gait = ComputedMuscleControl::gait(Pace::read(smooth.unwrap_or(gait))?);
            Ok(Box::new(if smooth.is_some() { gait.smooth() } else { gait }))
        }
        // It is another crate's: this one knows its name for the message.
        plan if plan.split_whitespace().next() == Some("plan") => Err(PolicyError::CommandLineOnly(plan.into())),
        unknown => Err(PolicyError::Unknown(unknown.into())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_in_the_list_makes_a_policy() {
        for name in NAMES {
            assert!(create(name).is_ok(), "{name}");
        }
    }

    #[test]
    fn policies_keep_the_name_that_they_were_made_by() {
        for name in ["cmc", "demonstration smooth", "gait 0.5 0.1", "gait 0.5 smooth", "gait smooth"] {
            assert_eq!(create(name).map(|policy| policy.name().to_owned()), Ok(name.to_owned()));
        }
        assert!(create("gait smooth 0.5").is_err());
    }

    #[test]
    fn former_names_lead_to_the_present_ones() {
        assert_eq!(create("posture").map(|policy| policy.name().to_owned()), Ok("cmc".to_owned()));
        let message = create("witness").err().map(|error| error.to_string());
        assert_eq!(message.as_deref(), Some("the policy `witness` is now called `demonstration`"));
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let message = create("perfect").err().map(|error| error.to_string()).unwrap_or_default();
        assert!(message.contains("`perfect`") && NAMES.iter().all(|name| message.contains(name)), "{message}");
    }
}
