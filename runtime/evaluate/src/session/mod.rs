//! Direct control: an episode that waits for each decision of whoever acts, a person, a script or a language model.
//!
//! A decision is one action that is held for some control steps. Nothing runs between decisions: a [`Session`] is plain data, and each
//! decision plays the whole episode again from its reset, with the decisions before it. The hash of what came of each tells whether the
//! replay went the same way. Actions are accepted as they are or rejected; none is clipped, smoothed or interpolated.

mod action;
mod folder;
mod gate;
mod tracking;

pub use action::{ActionError, read_action};
pub use folder::{SessionFolder, SessionFolderError};
pub use gate::{FALLEN_HEIGHT, FALLEN_TILT, fallen};
pub use tracking::{Comparison, Errors, Tracking};

use crate::journal::line::hex;
use crate::settings::BUILD;
use crate::trace::{Quantity, StepReader, Trace};
use crate::{EvaluationError, Trial};
use msk_program::numbers::exact;
use msk_runtime::action::ActionBuffer;
use msk_runtime::episode::{Ending, Environment, EpisodeKey};
use msk_runtime::policy::ActsOn;
use serde::{Deserialize, Serialize};

/// What a session is of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionSettings {
    /// The task, as its owner named it.
    pub task: String,
    /// Hash of its meaning.
    pub task_hash: String,
    /// Hash of its body.
    pub model_hash: String,
    /// Hash of the program.
    pub build: String,
    /// Seed of the episode, which has the index 0.
    pub seed: u64,
    /// Control steps for which an action is held.
    pub hold: u32,
    /// Most decisions.
    pub decisions: u32,
}

/// An action and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// Entries of the task's action space.
    pub action: Vec<f64>,
    /// Control steps of the episode after it.
    pub steps: u32,
    /// Hash of state and observation after it.
    pub hash: String,
}

/// A session: all that is needed to go on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// What it is of.
    pub settings: SessionSettings,
    /// Decisions so far.
    pub decisions: Vec<Decision>,
    /// Why there is no further decision: `fall`, the task's own reasons, `horizon`, `fault`, or `decisions` if all were taken; `None` while
    /// it waits for one.
    pub stopped: Option<String>,
    /// Whether the task's success held at the last step.
    pub success: bool,
    /// Return so far.
    pub total: f64,
}

/// What one who decides may see.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Visible {
    /// Number of the decision that it answers to, from 0.
    pub decision: usize,
    /// Simulated time, s.
    pub time: f64,
    /// Channels of the observation, in order.
    pub observation: Vec<VisibleChannel>,
    /// Entries that an action has, each from -1 to 1.
    pub action: Vec<String>,
    /// How long the action is held, s.
    pub hold: f64,
}

/// A channel of the observation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VisibleChannel {
    /// Its name.
    pub name: String,
    /// Unit of its values; empty for dimensionless ones.
    pub unit: String,
    /// Its values.
    pub values: Vec<f64>,
}

/// What a decision, or the reset, has come to.
#[derive(Debug, Clone)]
pub struct Moment {
    /// The session with it.
    pub session: Session,
    /// What is seen next; `None` if there is no further decision.
    pub visible: Option<Visible>,
    /// Every step so far, which one who decides must not see.
    pub trace: Trace,
}

/// Why a session does not go on.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// It has come to its end.
    #[error("the session has stopped: {0}")]
    Stopped(String),
    /// The task, body or program is another one.
    #[error("the {what} has changed since the session began: it was {before}, now it is {now}")]
    Changed {
        /// Which.
        what: &'static str,
        /// At the beginning.
        before: String,
        /// Now.
        now: String,
    },
    /// The decisions before did not come to the same.
    #[error("decision {0} comes to another state when it is played again: its recorded hash differs")]
    Diverged(usize),
    /// An action cannot be held for so long.
    #[error("{} s are {} control steps of `{task}`; an action is held for a whole number of control steps, from 1 to 1000000", exact(*.seconds), exact(*.steps))]
    Hold {
        /// As asked for, s.
        seconds: f64,
        /// Control steps.
        steps: f64,
        /// The task.
        task: String,
    },
    /// The episode could not begin.
    #[error("the episode cannot begin: {0}")]
    Fault(String),
    /// It cannot be played.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}

impl Session {
    /// The control steps of a trial for which an action is held, of seconds.
    ///
    /// # Errors
    /// Not a whole number of them, none, or more than a million.
    pub fn hold(trial: &Trial, seconds: f64) -> Result<u32, SessionError> {
        let steps = seconds * trial.task.control_frequency;
        let whole = steps.round();
        match (1.0..=1e6).contains(&whole) && (steps - whole).abs() < 1e-6 {
            // Within the range of the type.
            true => Ok(whole as u32),
            false => Err(SessionError::Hold { seconds, steps, task: trial.task.name.clone() }),
        }
    }

    /// Control steps so far.
    pub fn steps(&self) -> u32 {
        self.decisions.last().map_or(0, |decision| decision.steps)
    }

    /// A session of a trial, before its first decision.
    ///
    /// # Errors
    /// A task that does not fit its body, or an episode that cannot begin.
    pub fn begin(trial: &Trial, task: &str, (seed, hold, decisions): (u64, u32, u32)) -> Result<Moment, SessionError> {
        let settings = SessionSettings {
            task: task.to_owned(),
            task_hash: trial.task.hash.clone(),
            model_hash: trial.body.hash().to_owned(),
            build: BUILD.to_owned(),
            seed,
            hold,
            decisions,
        };
        Self { settings, decisions: Vec::new(), stopped: None, success: false, total: 0.0 }.play(trial, None)
    }

    /// The session after one more action, whose entries [`read_action`] has accepted.
    ///
    /// # Errors
    /// A session that has stopped, another task, body or program, or a replay that goes another way.
    pub fn decide(self, trial: &Trial, action: Vec<f64>) -> Result<Moment, SessionError> {
        if let Some(reason) = self.stopped {
            return Err(SessionError::Stopped(reason));
        }
        let now = [("task", trial.task.hash.as_str()), ("body", trial.body.hash()), ("program", BUILD)];
        let before = [&self.settings.task_hash, &self.settings.model_hash, &self.settings.build];
        if let Some(((what, now), before)) = now.into_iter().zip(before).find(|((_, now), before)| *now != before.as_str()) {
            return Err(SessionError::Changed { what, before: before.clone(), now: now.to_owned() });
        }
        self.play(trial, Some(action))
    }

    /// Plays all decisions, and one more.
    fn play(mut self, trial: &Trial, next: Option<Vec<f64>>) -> Result<Moment, SessionError> {
        let mut environment = trial.episode().map_err(EvaluationError::from)?;
        environment.reset(EpisodeKey { seed: self.settings.seed, episode: 0 });
        if let Some(Ending::Fault(fault)) = environment.ending() {
            return Err(SessionError::Fault(fault.to_string()));
        }
        let mut reader = StepReader::new(environment.engine(), &Quantity::ALL);
        let steps = self.settings.hold.saturating_mul(self.settings.decisions).min(trial.task.horizon);
        reader.layout().ensure_room(&trial.task, steps).map_err(EvaluationError::from)?;
        let mut trace = Trace::new(reader.layout().clone());
        trace.push(&reader.read(&environment.context()));
        let known = self.decisions.len();
        let actions: Vec<Vec<f64>> = self.decisions.iter().map(|decision| decision.action.clone()).chain(next).collect();
        for (place, action) in actions.into_iter().enumerate() {
            let stopped = hold(&mut environment, &action, self.settings.hold, &mut reader, &mut trace)?;
            let decision = Decision { action, steps: environment.steps(), hash: hash(&environment) };
            match self.decisions.get(place) {
                Some(recorded) if recorded.hash != decision.hash => return Err(SessionError::Diverged(place)),
                Some(_) => {}
                None => self.decisions.push(decision),
            }
            self.stopped = stopped;
        }
        if self.stopped.is_none() && self.decisions.len() >= self.settings.decisions as usize && self.decisions.len() > known {
            self.stopped = Some("decisions".into());
        }
        (self.success, self.total) = (environment.report().success && self.stopped.is_some(), environment.episode().total());
        trace.origin.task.clone_from(&trial.task.name);
        trace.origin.policy = "session".into();
        trace.origin.seed = self.settings.seed;
        trace.origin.ended_by = self.stopped.clone().unwrap_or_default();
        let visible = self.stopped.is_none().then(|| self.visible(&environment));
        Ok(Moment { session: self, visible, trace })
    }

    fn visible(&self, environment: &Environment) -> Visible {
        let task = environment.task();
        let channel = |channel: &msk_program::task::Channel| VisibleChannel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            values: environment.observation()[channel.offset..channel.offset + channel.size].to_vec(),
        };
        Visible {
            decision: self.decisions.len(),
            time: f64::from(environment.steps()) * environment.control_period(),
            observation: task.channels.iter().map(channel).collect(),
            action: task.action.names(&task.vocabulary),
            hold: f64::from(self.settings.hold) * environment.control_period(),
        }
    }
}

/// Holds an action; gives why the episode is over, if it is.
fn hold(
    environment: &mut Environment,
    action: &[f64],
    steps: u32,
    reader: &mut StepReader,
    trace: &mut Trace,
) -> Result<Option<String>, EvaluationError> {
    let mut buffer: ActionBuffer = environment.engine().action(ActsOn::Task);
    buffer.entries.clear();
    buffer.entries.extend_from_slice(action);
    for _ in 0..steps {
        environment.step(&buffer)?;
        if let Some(Ending::Fault(_)) = environment.ending() {
            return Ok(Some("fault".into()));
        }
        trace.push(&reader.read(&environment.context()));
        if let Some(ending) = environment.ending() {
            let reason = ending.conditions(environment.task());
            return Ok(Some(if reason.is_empty() { "horizon".into() } else { reason }));
        }
        if fallen(environment) {
            return Ok(Some("fall".into()));
        }
    }
    Ok(None)
}

/// Hash of everything that decides how the episode goes on, as far as it is a number, and of the observation.
fn hash(environment: &Environment) -> String {
    let state = environment.state();
    let numbers = state.position.iter().chain(&state.velocity).chain(&state.activation).chain(environment.observation());
    let bytes: Vec<u8> = numbers.flat_map(|number| number.to_bits().to_le_bytes()).collect();
    hex(&bytes)
}
