//! The workers of an evaluation. Each plays up to eight episodes of one model at once, every one under a policy of its own.

use super::desk::Desk;
use super::metrics::Measurement;
use super::order::Turn;
use super::record::Tally;
use super::tracing::{self, TraceRecorder};
use super::{EvaluationError, Extras, Fed, Job, Journal, JournalError, Outcome, Plan, Resumed, Watcher};
use msk_physics::Rates;
use msk_physics::lanes::WIDTH;
use msk_runtime::action::{ActionBuffer, ActsOn};
use msk_runtime::episode::{Controlled, Engine, Episode, EpisodeKey, GroupScratch, Member};
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
    engine: &'a Engine,
    policy: Box<dyn Policy + 'a>,
    episode: Episode,
    rates: Option<Rates>,
    weights: Vec<f64>,
    action: ActionBuffer,
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
                let job = match self.seats.iter().flatten().next().map(|seat| seat.engine) {
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
        let mut seat = Seat {
            trial,
            engine,
            policy: match self.policies.pop() {
                Some(policy) => policy,
                None => crew.plan.policy.open(crew.stop)?,
            },
            episode: engine.episode(),
            rates: None,
            weights: fed.as_ref().map_or_else(|| task.weights(), |fed| fed.weights.clone()),
            action: engine.action(ActsOn::Task),
            tally: Tally::new(task),
            measurement: Measurement::new(engine),
            trace: TraceRecorder::new(engine, index, crew.extras.tracing)?,
            fed,
            seconds: 0.0,
        };
        let start = Instant::now();
        let key = EpisodeKey { seed: crew.plan.protocol.seed, episode: index };
        seat.rates = scratch.begin(lane, engine, (key, &[]), &mut seat.episode);
        // An episode that could not begin has nothing that a policy could look at.
        let ready = match seat.episode.ending() {
            None => {
                let context = engine.context(&seat.episode, &seat.weights, scratch.lane(lane));
                seat.measurement.look(&context);
                seat.trace.look(&context);
                seat.policy.reset(&context)
            }
            Some(_) => Ok(()),
        };
        seat.action = engine.action(seat.policy.acts_on());
        seat.seconds = start.elapsed().as_secs_f64();
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
                self.crew.skip((seat.trial, seat.episode.key().episode), reason)?;
                self.policies.push(seat.policy);
                Ok(())
            }
            error => Err(error.into()),
        }
    }

    /// Takes one control step in every lane, and keeps the episodes that have ended. Gives whether there was one.
    fn step(&mut self) -> Result<bool, EvaluationError> {
        let start = Instant::now();
        let Some(scratch) = &mut self.scratch else { return Ok(false) };
        let mut unable = Vec::new();
        for (lane, error) in act(&mut self.seats, scratch) {
            unable.extend(self.seats[lane].take().map(|seat| (seat, error)));
        }
        scratch.step(self.seats.iter_mut().map(|place| {
            let seat = place.as_mut().filter(|seat| seat.episode.ending().is_none())?;
            let Seat { engine, episode, rates, weights, action, .. } = seat;
            Some(Member { engine, episode, rates, weights, action: (&*action).into() })
        }));
        for (seat, error) in unable {
            self.give_up(seat, error)?;
        }
        let count = self.seats.iter().flatten().count();
        let share = start.elapsed().as_secs_f64() / (count as f64);
        for lane in 0..WIDTH {
            let (Some(seat), Some(scratch)) = (&mut self.seats[lane], &self.scratch) else { continue };
            seat.seconds += share;
            if seat.episode.steps() > seat.tally.steps() {
                seat.tally.add(&seat.episode);
                let context = seat.engine.context(&seat.episode, &seat.weights, scratch.lane(lane));
                seat.measurement.look(&context);
                seat.trace.look(&context);
                self.crew.watcher.stepped();
            }
            if seat.episode.ending().is_some() {
                self.end(lane)?;
            }
        }
        Ok(count > 0)
    }

    /// Keeps the episode in a lane, which has ended.
    fn end(&mut self, lane: usize) -> Result<(), EvaluationError> {
        let Some(seat) = self.seats[lane].take() else { return Ok(()) };
        let trial = &self.crew.plan.trials[seat.trial];
        let record = seat.tally.record(trial, &seat.episode, seat.policy.name(), seat.seconds);
        let mut record = seat.measurement.note(record);
        if let Some(fed) = &seat.fed {
            fed.note(trial, &mut record);
        }
        self.policies.push(seat.policy);
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

/// Lets every policy act; gives what keeps some from acting, with their lanes.
fn act(seats: &mut [Option<Seat<'_>>], scratch: &mut GroupScratch) -> Vec<(usize, PolicyError)> {
    let (mut unable, mut controlled) = (Vec::new(), Vec::new());
    for (lane, seat) in seats.iter_mut().enumerate() {
        let Some(seat) = seat.as_mut().filter(|seat| seat.episode.ending().is_none()) else { continue };
        let Seat { engine, episode, policy, action, weights, .. } = seat;
        let action = &mut action.entries;
        if policy.controls().is_none() {
            let acted = policy.act(&engine.context(episode, weights, scratch.lane(lane)), action);
            unable.extend(acted.err().map(|error| (lane, error)));
        } else if let Some(controls) = policy.controls() {
            controlled.push(Controlled { lane, engine, episode, weights, controls, entries: &[], action });
        }
    }
    let acted = scratch.control(&mut controlled);
    let lanes: Vec<usize> = controlled.iter().map(|member| member.lane).collect();
    unable.extend(lanes.into_iter().zip(acted).filter_map(|(lane, acted)| {
        let reason = acted.err()?.to_string();
        let policy = seats[lane].as_ref().map_or_else(String::new, |seat| seat.policy.name().to_owned());
        Some((lane, PolicyError::Unable { policy, reason }))
    }));
    unable
}
