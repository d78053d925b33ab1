//! The workers of an evaluation. Each plays up to eight episodes of one model at once, every one under a policy of its own.

use super::desk::Desk;
use super::metrics::Measurement;
use super::order::Turn;
use super::record::Tally;
use super::together::{self, LaneRollout};
use super::tracing::{self, TraceRecorder};
use super::{EvaluationError, Extras, Fed, Job, Journal, JournalError, Outcome, Plan, Resumed, Watcher};
use msk_physics::lanes::WIDTH;
use msk_runtime::episode::{Engine, EpisodeKey, GroupScratch};
use msk_runtime::policy::{Policy, PolicyError};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long a worker sleeps when it has nothing to do until others have caught up.
const NAP: Duration = Duration::from_millis(5);

/// What all workers share.
pub(super) struct Crew<'a> {
    plan: &'a Plan,
    /// Of the tasks that have episodes to be played.
    engines: BTreeMap<usize, Engine>,
    /// Episodes that a worker plays at once.
    width: usize,
    desk: Mutex<Desk<'a>>,
    /// What made the first worker fail; the others may fail only because of it.
    failure: Mutex<Option<EvaluationError>>,
    failed: AtomicBool,
    journal: &'a Journal,
    stop: &'a AtomicBool,
    watcher: &'a dyn Watcher,
    extras: Extras<'a>,
}

/// One worker: its memory, and the episodes that it plays.
struct Worker<'c, 'a> {
    crew: &'c Crew<'a>,
    /// Of the model that is played.
    scratch: Option<GroupScratch>,
    seats: [Option<Seat<'c>>; WIDTH],
    /// Policies that have no episode.
    policies: Vec<Box<dyn Policy + 'c>>,
}

/// An episode that is played, in a lane.
struct Seat<'a> {
    trial: usize,
    rollout: LaneRollout<'a>,
    tally: Tally,
    measurement: Measurement,
    trace: TraceRecorder,
    /// Where the weights come from, if not from the task.
    fed: Option<Fed>,
    /// Its share of the clock time, s.
    seconds: f64,
}

impl<'a> Crew<'a> {
    /// # Errors
    /// A task that does not fit its body, or whose traces do not fit into memory.
    pub fn new(
        plan: &'a Plan,
        resumed: Resumed,
        threads: NonZeroUsize,
        (journal, stop): (&'a Journal, &'a AtomicBool),
        watcher: &'a dyn Watcher,
        extras: Extras<'a>,
    ) -> Result<Self, EvaluationError> {
        let Resumed { kept, summarizer } = resumed;
        let desk = Desk::new(journal, (plan.trials.len(), plan.protocol.episodes), plan.shard, kept, summarizer);
        let mut engines = BTreeMap::new();
        for (task, trial) in plan.trials.iter().enumerate().filter(|(task, _)| desk.order().misses(*task)) {
            let engine = trial.engine()?;
            TraceRecorder::new(&engine, 0, extras.tracing)?;
            engines.insert(task, engine);
        }
        let most = plan.policy.most_at_once().min(WIDTH);
        // Not more than that many are of interest.
        let missing = usize::try_from(desk.order().missing()).unwrap_or(usize::MAX);
        Ok(Self {
            plan,
            engines,
            width: missing.div_ceil(threads.get()).clamp(1, most),
            desk: Mutex::new(desk),
            failure: Mutex::new(None),
            failed: AtomicBool::new(false),
            journal,
            stop,
            watcher,
            extras,
        })
    }

    /// Plays episodes, those of the plan in order, until there are none, the run is stopped, or a worker fails.
    pub fn work(&self) {
        let mut worker = Worker { crew: self, scratch: None, seats: Default::default(), policies: Vec::new() };
        // Those that ended before their turn in an earlier attempt may be due. The desk must be free before the worker plays.
        let entered = self.desk().enter();
        if let Err(error) = entered.map_err(EvaluationError::from).and_then(|()| worker.play()) {
            self.failed.store(true, Ordering::Relaxed);
            self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
    }

    /// What has come of the run.
    ///
    /// # Errors
    /// What made the first worker fail.
    pub fn outcome(self) -> Result<Outcome, EvaluationError> {
        if let Some(failure) = self.failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(failure);
        }
        Ok(self.desk.into_inner().unwrap_or_else(PoisonError::into_inner).outcome())
    }

    fn is_over(&self) -> bool {
        self.failed.load(Ordering::Relaxed) || self.stop.load(Ordering::Relaxed)
    }

    fn desk(&self) -> MutexGuard<'_, Desk<'a>> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Skips a task.
    fn skip(&self, job: Job, reason: String) -> Result<(), JournalError> {
        if self.desk().skip(job, reason.clone())? {
            self.watcher.skipped(job.0, &reason);
        }
        Ok(())
    }
}

impl<'c> Worker<'c, '_> {
    fn play(&mut self) -> Result<(), EvaluationError> {
        let result = loop {
            if self.crew.is_over() {
                break Ok(());
            }
            match self.fill().and_then(|more| Ok((more, self.step()?))) {
                Ok((_, true)) => {}
                Ok((true, false)) => std::thread::sleep(NAP),
                Ok((false, false)) => break Ok(()),
                Err(error) => break Err(error),
            }
        };
        match result {
            // The wait for a policy was given up because the run is to stop.
            Err(EvaluationError::Policy(PolicyError::Interrupted)) => Ok(()),
            result => result,
        }
    }

    /// Begins episodes in free lanes, as far as there are jobs that go with those that are played, those of later tasks too: full lanes
    /// take less time. Gives whether there will be more.
    fn fill(&mut self) -> Result<bool, EvaluationError> {
        let crew = self.crew;
        for lane in 0..crew.width {
            while self.seats[lane].is_none() {
                let job = match self.seats.iter().flatten().next().map(|seat| seat.rollout.engine) {
                    Some(present) => {
                        let fits = |task: usize| crew.engines.get(&task).is_some_and(|engine| engine.goes_with(present));
                        let Some(job) = crew.desk().claim_of(&fits) else { return Ok(true) };
                        job
                    }
                    None => match crew.desk().claim() {
                        Turn::Play(job) => job,
                        Turn::Wait => return Ok(true),
                        Turn::Over => return Ok(false),
                    },
                };
                self.begin(lane, job, &crew.engines[&job.0])?;
            }
        }
        Ok(true)
    }

    /// Begins an episode in a lane, unless the policy cannot act on its task.
    fn begin(&mut self, lane: usize, (trial, index): Job, engine: &'c Engine) -> Result<(), EvaluationError> {
        let crew = self.crew;
        let known = self.scratch.take().filter(|scratch| scratch.serves(engine));
        let scratch = self.scratch.insert(known.unwrap_or_else(|| engine.group_scratch(crew.width)));
        let task = engine.task();
        let fed = crew.extras.feed.map(|feed| feed.weights(task));
        let policy = match self.policies.pop() {
            Some(policy) => policy,
            None => crew.plan.policy.open(crew.stop)?,
        };
        let weights = fed.as_ref().map_or_else(|| task.weights(), |fed| fed.weights.clone());
        let mut rollout = LaneRollout::new(engine, weights, policy);
        let (mut measurement, mut trace) = (Measurement::new(engine), TraceRecorder::new(engine, index, crew.extras.tracing)?);
        let start = Instant::now();
        let key = EpisodeKey { seed: crew.plan.protocol.seed, episode: index };
        let ready = rollout.reset(lane, key, scratch, &mut |context| {
            measurement.look(context);
            trace.look(context);
        });
        let seconds = start.elapsed().as_secs_f64();
        let seat = Seat { trial, rollout, tally: Tally::new(task), measurement, trace, fed, seconds };
        match ready {
            Ok(()) => self.seats[lane] = Some(seat),
            Err(error) => self.give_up(seat, error)?,
        }
        Ok(())
    }

    /// Lets go of an episode whose policy cannot act.
    ///
    /// # Errors
    /// What is more than a task that the policy does not support.
    fn give_up(&mut self, seat: Seat<'c>, error: PolicyError) -> Result<(), EvaluationError> {
        match error {
            PolicyError::Unable { reason, .. } => {
                self.crew.skip((seat.trial, seat.rollout.episode.key().episode), reason)?;
                self.policies.push(seat.rollout.policy);
                Ok(())
            }
            error => Err(error.into()),
        }
    }

    /// Takes one control step in every lane, and keeps the episodes that have ended. Gives whether there was one.
    fn step(&mut self) -> Result<bool, EvaluationError> {
        let start = Instant::now();
        let Some(scratch) = &mut self.scratch else { return Ok(false) };
        let unable = together::step(self.seats.each_mut().map(|seat| Some(&mut seat.as_mut()?.rollout)), scratch);
        for (lane, error) in unable {
            let Some(seat) = self.seats[lane].take() else { continue };
            self.give_up(seat, error)?;
        }
        let count = self.seats.iter().flatten().count();
        let share = start.elapsed().as_secs_f64() / (count as f64);
        for lane in 0..WIDTH {
            let (Some(seat), Some(scratch)) = (&mut self.seats[lane], &self.scratch) else { continue };
            seat.seconds += share;
            if seat.rollout.episode.steps() > seat.tally.steps() {
                seat.tally.add(&seat.rollout.episode);
                let context = seat.rollout.context(lane, scratch);
                seat.measurement.look(&context);
                seat.trace.look(&context);
                self.crew.watcher.stepped();
            }
            if seat.rollout.is_over() {
                self.end(lane)?;
            }
        }
        Ok(count > 0)
    }

    /// Keeps the episode in a lane, which has ended.
    fn end(&mut self, lane: usize) -> Result<(), EvaluationError> {
        let Some(seat) = self.seats[lane].take() else { return Ok(()) };
        let trial = &self.crew.plan.trials[seat.trial];
        let record = seat.tally.record(trial, &seat.rollout.episode, seat.rollout.policy.name(), seat.seconds);
        let mut record = seat.measurement.note(record);
        if let Some(fed) = &seat.fed {
            fed.note(trial, &mut record);
        }
        self.policies.push(seat.rollout.policy);
        if let Some(trace) = seat.trace.finish(&record) {
            tracing::keep(self.crew.journal, &trace)?;
        }
        let (job, shown) = ((seat.trial, record.episode), record.clone());
        if self.crew.desk().keep(job, record)? {
            self.crew.watcher.ended(seat.trial, &shown);
        }
        Ok(())
    }
}
