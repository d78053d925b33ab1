//! `--policy "learner ..."`: an agent that learns before each round by the weights in force.

use crate::error::Error;
use crate::train::{provenance, read_settings};
use indicatif::ProgressBar;
use msk::evaluate::Trial;
use msk::runtime::policy::{PolicyError, PolicySource};
use msk::train::session::{Ended, Observer, Progress, Session};
use msk::train::{Agent, Algorithm, Evaluation, Lessons, Preset, Round, Settings, Training, source_of};
use msk::tuning::session::{Learner, LearnerError};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Folder of a session in which the training is.
const TRAINING: &str = "training";
/// Folder of the agent of the best round, in that of the training.
const BEST: &str = "best-by-objective";

/// What `--policy` and `--learn` ask for.
pub struct Wanted {
    /// As it was written: part of the identity of the session.
    name: String,
    settings: Settings,
    start: Option<PathBuf>,
    /// Control steps that it learns from before each round.
    steps: u64,
}

impl Wanted {
    /// `learner`, `learner ALGORITHM` or `learner FILE`; `None` for another policy.
    ///
    /// # Errors
    /// A file that cannot be read, or settings that make no sense.
    pub fn parse(policy: &str, start: Option<PathBuf>, steps: u64) -> Result<Option<Self>, Error> {
        let (word, rest) = policy.split_once(char::is_whitespace).unwrap_or((policy, ""));
        if word != "learner" {
            return Ok(None);
        }
        let known = Algorithm::NAMED.into_iter().find(|(name, _)| *name == rest.trim());
        let settings = match (rest.trim(), known) {
            ("", _) => Settings::default(),
            (_, Some((_, algorithm))) => Settings::of(algorithm, Preset::Fast),
            (file, None) => read_settings(Path::new(file))?,
        };
        if settings.algorithm == Algorithm::Clone {
            return Err(
                Error::new("`clone` learns from a teacher, whatever the weights are").hint("use ppo, sac, simba, dynsyn or mpo")
            );
        }
        let name = format!("learner {}, {steps} steps a round", settings.algorithm.name());
        Ok(Some(Self { name, settings, start, steps }))
    }

    /// The learner in the folder `training` of a session, for so many rounds.
    ///
    /// # Errors
    /// A task that cannot be learned, or a folder that holds another training.
    pub fn open(&self, trial: &Trial, folder: &Path, key: (u64, u64), threads: NonZeroUsize) -> Result<Learning, Error> {
        let (seed, rounds) = key;
        let start = self.start.as_deref().map(Agent::read).transpose()?.map(Arc::new);
        let lessons = Lessons { start, ..Lessons::default() };
        let key = (seed, self.steps.saturating_mul(rounds));
        let training =
            Training::with(&trial.engine()?, &self.settings, &lessons, key, threads)?.with_provenance(provenance(trial));
        let (session, _) = Session::open(&folder.join(TRAINING), training)?;
        Ok(Learning { name: self.name.clone(), session, steps: self.steps, bar: ProgressBar::hidden() })
    }
}

/// A training that goes on by the weights of each round.
pub struct Learning {
    name: String,
    session: Session,
    steps: u64,
    bar: ProgressBar,
}

impl Learning {
    /// Shows its steps in this line.
    pub fn show(&mut self, bar: ProgressBar) {
        self.bar = bar;
    }

    /// The agent as it is now, under the name that identifies the session.
    ///
    /// # Errors
    /// The operating system gives no threads.
    pub fn policy(&self) -> Result<PolicySource, PolicyError> {
        source_of(self.session.agent(), self.name.clone())
    }
}

impl Learner for Learning {
    fn learn(&mut self, round: u64, weights: &[f64], stop: &AtomicBool) -> Result<Option<PolicySource>, LearnerError> {
        self.session.set_weights(weights);
        match self.session.run_to(round.saturating_mul(self.steps), stop, &mut Shown(self.bar.clone()))? {
            Ended::Interrupted => Ok(None),
            Ended::Whole => Ok(Some(self.policy()?)),
        }
    }

    fn keep(&mut self) -> Result<(), LearnerError> {
        Ok(self.session.keep_agent(BEST)?)
    }
}

/// The line of the session, while it learns.
struct Shown(ProgressBar);

impl Observer for Shown {
    fn round(&mut self, _: &Round, progress: &Progress) {
        let Progress { step, steps, rate, .. } = progress;
        self.0.set_message(format!("learning: {step} of {steps} steps, {rate:.0} steps/s"));
    }

    fn evaluated(&mut self, _: u64, _: &Evaluation) {}
}
