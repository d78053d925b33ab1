//! The loop: episodes, statistics, a proposal, the rules of change, new weights, again.
//!
//! A session lives in a folder and can be interrupted and continued at any time:
//!
//! | file | what |
//! |---|---|
//! | `tune.json` | what is tuned: a folder holds one session for good |
//! | `weights.toml` | the weights in force, read anew before every episode; `.msk` has their history |
//! | `run.json`, `episodes.jsonl` | the journal of all episodes, in order |
//! | `rounds.jsonl` | a line for each round: statistics, prompt, proposal, what was applied, or why it was not |
//! | `best.toml` | the weights of the best round so far |
//!
//! A round ends with the episode in which the control steps of all workers together reach the interval. Episodes are counted
//! in the order of their index, so what belongs to a round does not depend on how many workers there are.

mod learner;
mod log;
mod play;
mod settings;

pub use learner::{Learner, LearnerError};
pub use log::{Applied, Round};
pub use settings::{KeptRules, Objective, OnFailure, Settings};

use crate::live::{Live, LiveError};
use crate::overlay::{EditError, edited};
use crate::reasoner::{Past, Proposal, Reasoner, ReasonerError, Request, prompt};
use crate::statistics::Statistics;
use crate::store::{Store, StoreError, Version};
use learner::Fixed;
use log::{Log, LogError};
use msk_compiler::weights::rules::{RuleError, Weight, normalized};
use msk_compiler::weights::{Bounds, Problem};
use msk_evaluate::{EpisodeRecord, EvaluationError, Journal, JournalError, Plan, Protocol, RunSettings, Shard, Trial};
use msk_storage::{Folder, StorageError};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const WEIGHTS: &str = "weights.toml";
const BEST: &str = "best.toml";
/// How many earlier rounds a reasoner is given.
const REMEMBERED: usize = 5;

/// Looks on while a session runs.
pub trait Watcher: Sync {
    /// A control step has been taken, in any worker.
    fn stepped(&self);
    /// An episode has ended and counts in the present round.
    fn ended(&self, record: &EpisodeRecord);
    /// A round is over and logged.
    fn round(&self, round: &Round);
    /// The reasoner is being asked.
    fn asking(&self, reasoner: &str);
}

/// How a session came to an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// All that it was allowed is used up.
    Budget,
    /// It was asked to stop; the same call continues it.
    Interrupted,
    /// The reasoner failed, and the session was to stop then.
    Failed,
}

/// Why a session cannot be begun or go on.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// A file of weights cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The weights of the session cannot be used.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// A file of weights is damaged.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The episodes cannot be played.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// The folder, or a file in it, cannot be used.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// What learns between the rounds cannot go on.
    #[error(transparent)]
    Learner(#[from] LearnerError),
    /// The log cannot be used.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The journal and the log contradict each other.
    #[error(
        "the journal of the session is damaged: expected the episodes in order, of which rounds.jsonl counts {counted}; episode \
         {missing} is not in its place in episodes.jsonl"
    )]
    Episodes {
        /// The first that is not there.
        missing: u64,
        /// How many episodes belong to rounds that are over.
        counted: u64,
    },
    /// The weights cannot keep the rules from the beginning.
    #[error("the weights cannot be scaled to the norm: {0}")]
    Norm(String),
    /// A setting that makes no sense.
    #[error("{0}")]
    Setting(String),
    /// A term that is not there.
    #[error(transparent)]
    Term(#[from] Problem),
}

/// A session in its folder.
pub struct Session {
    folder: Folder,
    settings: Settings,
    trial: Trial,
    in_scope: Vec<bool>,
    store: Store,
    live: Arc<Live>,
    journal: Journal,
    log: Log,
    /// Episodes that count in no round that is over.
    open: Vec<EpisodeRecord>,
}

impl Session {
    /// Begins a session in `folder`, or continues the one that is there. `notify` gets messages about weights files that somebody
    /// changed so that they are refused.
    ///
    /// # Errors
    /// Settings that make no sense, a folder that holds another session, is in use or damaged.
    pub fn open(
        folder: &Path,
        settings: Settings,
        trial: Trial,
        notify: impl Fn(&str) + Send + Sync + 'static,
    ) -> Result<Self, SessionError> {
        Self::open_in(Folder::create(folder)?, settings, trial, notify)
    }

    /// [`Session::open`] in an opened folder.
    ///
    /// # Errors
    /// As there.
    pub fn open_in(
        folder: Folder,
        settings: Settings,
        trial: Trial,
        notify: impl Fn(&str) + Send + Sync + 'static,
    ) -> Result<Self, SessionError> {
        settings.check(&trial.task)?;
        let in_scope = settings.scope(&trial.task)?;
        let first = settings.first_weights(&trial.task, &in_scope)?;
        let plan = Plan {
            trials: vec![trial.clone()],
            policy: settings.policy.clone(),
            // How many episodes there will be is not known beforehand.
            protocol: Protocol { episodes: 0, seed: settings.seed },
            shard: Shard::WHOLE,
        };
        let (journal, episodes) = Journal::open_in(folder.clone(), &RunSettings::of(&plan).live(WEIGHTS))?;
        settings.claim(&folder, &trial)?;
        let log = Log::open(&folder)?;
        let store = Store::new(&folder, Path::new(WEIGHTS))?;
        begin_weights(&store, &trial, &in_scope, &first, log.rounds().last())?;
        let live = Live::over(store.clone(), vec![trial.task.clone()], notify)?;
        let (live, open) = (Arc::new(live), uncounted(episodes, &log)?);
        let session = Self { folder, settings, trial, in_scope, store, live, journal, log, open };
        // A session that ended between its log and this file left an earlier one.
        if let Some(best) = session.best().filter(|best| best.round == session.rounds().len() as u64) {
            session.keep_best(best)?;
        }
        Ok(session)
    }

    /// The rounds that are over.
    pub fn rounds(&self) -> &[Round] {
        self.log.rounds()
    }

    /// The best round so far; of equals the first.
    pub fn best(&self) -> Option<&Round> {
        self.rounds().iter().fold(None, |best: Option<&Round>, round| match best {
            Some(best) if round.score <= best.score => Some(best),
            _ => Some(round),
        })
    }

    /// What makes one round better than another, in words.
    pub fn objective(&self) -> String {
        self.settings.objective.described()
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Plays rounds until the budget is used up, `stop` becomes true, or the reasoner fails and that is to end it.
    ///
    /// # Errors
    /// Episodes that cannot be played, or files that cannot be written.
    pub fn run(
        &mut self,
        reasoner: &dyn Reasoner,
        threads: NonZeroUsize,
        stop: &AtomicBool,
        watcher: &dyn Watcher,
    ) -> Result<Ended, SessionError> {
        self.run_learner(&mut Fixed(self.settings.policy.clone()), reasoner, threads, stop, watcher)
    }

    /// [`Session::run`] with a policy that learns before each round by the weights in force; that of the settings names it.
    ///
    /// # Errors
    /// As there, and a learner that cannot go on.
    pub fn run_learner(
        &mut self,
        learner: &mut dyn Learner,
        reasoner: &dyn Reasoner,
        threads: NonZeroUsize,
        stop: &AtomicBool,
        watcher: &dyn Watcher,
    ) -> Result<Ended, SessionError> {
        // A session that ended right after its best round left the policy of an earlier one.
        if self.best().is_some_and(|best| best.round == self.rounds().len() as u64) {
            learner.keep()?;
        }
        // A session that its reasoner ended goes on with the next round: the user who continues it has fixed the reasoner.
        while !self.spent() {
            let counted = self.rounds().last().map_or(0, |round| round.episodes[1]);
            let (_, weights) = self.weights();
            let Some(policy) = learner.learn(self.rounds().len() as u64 + 1, &weights, stop)? else {
                return Ok(Ended::Interrupted);
            };
            let records = std::mem::take(&mut self.open);
            let hall = play::Hall {
                trial: &self.trial,
                policy: &policy,
                seed: self.settings.seed,
                interval: self.settings.interval,
                feed: self.live.as_ref(),
                journal: &self.journal,
                stop,
                watcher,
            };
            self.open = hall.play(counted, records, threads)?;
            if self.steps() < self.settings.interval {
                return Ok(Ended::Interrupted);
            }
            let round = match self.judge(reasoner, stop, watcher)? {
                Some(round) => round,
                None => return Ok(Ended::Interrupted),
            };
            if self.best().is_some_and(|best| best.round == round.round) {
                learner.keep()?;
            }
            watcher.round(&round);
            if round.rejected.is_some() && self.settings.on_failure == OnFailure::Stop {
                return Ok(Ended::Failed);
            }
        }
        Ok(Ended::Budget)
    }

    /// Whether there is nothing left to spend.
    fn spent(&self) -> bool {
        let steps: u64 = self.rounds().iter().map(|round| round.statistics.steps).sum();
        self.rounds().len() as u64 >= self.settings.rounds || self.settings.steps.is_some_and(|most| steps >= most)
    }

    /// Control steps of the open round. An episode that a fault ended before its first step counts as one.
    fn steps(&self) -> u64 {
        self.open.iter().map(play::counted).sum()
    }

    /// Ends the round: statistics, score, best, question, proposal, rules, log, new weights, in this order.
    fn judge(
        &mut self,
        reasoner: &dyn Reasoner,
        stop: &AtomicBool,
        watcher: &dyn Watcher,
    ) -> Result<Option<Round>, SessionError> {
        let task = &self.trial.task;
        let (version, weights) = self.weights();
        let statistics = Statistics::of(task, &weights, &self.in_scope, &self.open);
        let number = self.rounds().len() as u64 + 1;
        let score = self.settings.objective.score(&statistics, task.horizon);
        let request = self.request(number, statistics.clone());
        // The weights of a last round would never be tried.
        let last = number >= self.settings.rounds
            || self.settings.steps.is_some_and(|most| {
                self.rounds().iter().map(|round| round.statistics.steps).sum::<u64>() + statistics.steps >= most
            });
        let answer = if last {
            None
        } else {
            watcher.asking(&reasoner.name());
            let answer = reasoner.propose(&request, stop);
            if matches!(answer, Err(ReasonerError::Interrupted)) || stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            Some(answer)
        };
        let (proposal, applied, rejected) = match answer {
            None => (None, None, None),
            Some(Err(error)) => (None, None, Some(error.to_string())),
            Some(Ok(proposal)) => match self.constrained(&weights, &proposal) {
                Ok(applied) => (Some(proposal), Some(applied), None),
                Err(error) => (Some(proposal), None, Some(error.to_string())),
            },
        };
        let named = |weights: &[f64]| task.terms.iter().map(|term| term.name.clone()).zip(weights.iter().copied()).collect();
        let next = applied.as_ref().filter(|next| **next != weights);
        let text = next.map(|next| self.overlay(&weights, next)).transpose()?;
        let episodes =
            [self.open.first().map_or(0, |record| record.episode), self.open.last().map_or(0, |last| last.episode + 1)];
        let round = Round {
            round: number,
            time: log::now(),
            episodes,
            reasoner: reasoner.name(),
            score,
            weights: named(&weights),
            version,
            prompt: if last { String::new() } else { prompt(&request) },
            statistics,
            proposal,
            applied: applied.as_deref().map(named),
            next: text.as_ref().map(|(before, text)| Applied { before: before.clone(), text: text.clone() }),
            rejected,
        };
        let better = self.best().is_none_or(|best| round.score > best.score);
        // First the log: a session that ends here applies on its return the entries of the log.
        self.log.append(&round)?;
        if better {
            self.keep_best(&round)?;
        }
        if let Some(next) = &round.next {
            apply(&self.store, next, &format!("tune, round {number}, {}", round.reasoner))?;
        }
        self.open.clear();
        Ok(Some(round))
    }

    /// The weights in force, with their version.
    fn weights(&self) -> (String, Vec<f64>) {
        let in_force = self.live.current();
        let weights = in_force.tasks.first().map(|(_, weights)| weights.clone());
        (in_force.version.clone(), weights.unwrap_or_else(|| self.trial.task.weights()))
    }

    fn request(&self, round: u64, statistics: Statistics) -> Request {
        let task = &self.trial.task;
        let past = |round: &Round| Past { round: round.round, score: round.score, weights: round.weights.clone() };
        let rounds = self.rounds();
        Request {
            task: task.name.clone(),
            summary: task.summary.clone(),
            horizon: task.horizon,
            formulas: task.terms.iter().map(|term| (term.name.clone(), term.source.clone())).collect(),
            round,
            objective: self.settings.objective.described(),
            step: self.settings.rules.step,
            norm: self.settings.rules.norm,
            statistics,
            history: rounds[rounds.len().saturating_sub(REMEMBERED)..].iter().map(past).collect(),
        }
    }

    /// What the rules make of a proposal.
    fn constrained(&self, weights: &[f64], proposal: &Proposal) -> Result<Vec<f64>, RuleError> {
        let task = &self.trial.task;
        let wished: Vec<f64> = task
            .terms
            .iter()
            .zip(weights)
            .map(|(term, weight)| proposal.weights.iter().find(|(name, _)| *name == term.name).map_or(*weight, |(_, wish)| *wish))
            .collect();
        self.settings.rules().constrain(&self.tunable(weights), &wished)
    }

    fn tunable(&self, weights: &[f64]) -> Vec<Weight> {
        let weight = |(term, value): (usize, &f64)| Weight {
            value: *value,
            bounds: self.trial.task.weight_bounds(term),
            in_scope: self.in_scope[term],
        };
        weights.iter().enumerate().map(weight).collect()
    }

    /// The version that is there, and the text with the weights that change in it.
    fn overlay(&self, before: &[f64], next: &[f64]) -> Result<(String, String), SessionError> {
        let present = self.store.read()?.unwrap_or_else(|| Version::of(""));
        let task = &self.trial.task;
        let changes: Vec<(&str, &str, f64)> = (0..next.len())
            .filter(|&term| next[term] != before[term])
            .map(|term| (task.name.as_str(), task.terms[term].name.as_str(), next[term]))
            .collect();
        Ok((present.hash, edited(&present.text, &changes)?))
    }

    fn keep_best(&self, round: &Round) -> Result<(), SessionError> {
        let task = &self.trial.task.name;
        let weights: Vec<(&str, &str, f64)> =
            round.weights.iter().map(|(term, weight)| (task.as_str(), term.as_str(), *weight)).collect();
        Store::new(&self.folder, Path::new(BEST))?
            .change::<(), SessionError>(&format!("tune, round {}", round.round), |version| {
                Ok((edited(&version.text, &weights)?, ()))
            })?;
        Ok(())
    }
}

/// The episodes of the journal that no round of the log counts. They are appended in order, so all that rounds count are there.
fn uncounted(mut episodes: Vec<EpisodeRecord>, log: &Log) -> Result<Vec<EpisodeRecord>, SessionError> {
    let counted = log.rounds().last().map_or(0, |round| round.episodes[1]);
    let whole = episodes.iter().zip(0..).take_while(|(record, index)| record.episode == *index).count();
    if whole < episodes.len() || (whole as u64) < counted {
        return Err(SessionError::Episodes { missing: whole as u64, counted });
    }
    Ok(episodes.split_off(usize::try_from(counted).unwrap_or(whole)))
}

/// Writes the first weights of a session, or those that a session had logged and not yet applied when it ended.
fn begin_weights(
    store: &Store,
    trial: &Trial,
    in_scope: &[bool],
    first: &[f64],
    last: Option<&Round>,
) -> Result<(), SessionError> {
    if let Some(last) = last {
        return last.next.as_ref().map_or(Ok(()), |next| apply(store, next, &format!("tune, round {}, continued", last.round)));
    }
    if store.read()?.is_some() {
        return Ok(());
    }
    let task = &trial.task;
    let weights: Vec<(&str, &str, f64)> = (0..first.len())
        .filter(|&term| in_scope[term])
        .map(|term| (task.name.as_str(), task.terms[term].name.as_str(), first[term]))
        .collect();
    store.change::<(), SessionError>("tune, beginning", |version| Ok((edited(&version.text, &weights)?, ())))?;
    Ok(())
}

/// Puts logged weights in force, unless the file has moved on: they are there already, or a person has changed it since.
fn apply(store: &Store, next: &Applied, by: &str) -> Result<(), SessionError> {
    store.change::<(), SessionError>(by, |version| {
        let untouched = version.hash == next.before;
        Ok((if untouched { next.text.clone() } else { version.text.clone() }, ()))
    })?;
    Ok(())
}

impl Settings {
    /// The weights that a session begins with: those of the task, scaled to the norm if one is kept.
    fn first_weights(&self, task: &msk_compiler::task::CompiledTask, in_scope: &[bool]) -> Result<Vec<f64>, SessionError> {
        let values = task.weights();
        let Some(norm) = self.rules.norm else { return Ok(values) };
        let weight = |(term, value): (usize, &f64)| Weight { value: *value, bounds: Bounds::Free, in_scope: in_scope[term] };
        let weights: Vec<Weight> = values.iter().enumerate().map(weight).collect();
        let scaled = normalized(&weights, norm).map_err(|error| SessionError::Norm(error.to_string()))?;
        for (term, value) in scaled.iter().enumerate().filter(|(term, _)| in_scope[*term]) {
            task.check_weight(term, *value).map_err(|problem| SessionError::Norm(problem.to_string()))?;
        }
        Ok(scaled)
    }
}
