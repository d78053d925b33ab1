//! Tests of tasks: what they show is played, what they expect is compared.
//!
//! 1. Every take of a test is an episode: its script sets where everything is (`script`), physics takes over after `run`;
//! 2. what expectations look at is kept at their moments (`take`); scripts of several tests are shown together (`series`, `lanes`);
//! 3. a [`TestReport`] lists what held and, with the numbers of both sides, what did not;
//! 4. what a cheat earns is ranked below what the demonstration earns (`returns`);
//! 5. exploits that no `cheat` describes yet are searched for ([`exploit`]).
//!
//! A test has no chance but that of episode 0 of seed 0, so it ends the same way everywhere.

pub mod exploit;
mod lanes;
pub mod mutation;
mod report;
mod returns;
mod series;
mod take;

pub use report::{Failure, SideValue, TestReport};
pub use returns::{DISCOUNT, Demonstration, Measure, Ranking, Returns, TermReturn};

use lanes::{Line, Queue, Waiting};
use msk_physics::lanes::WIDTH;
use msk_program::task::TaskTests;
use msk_runtime::body::OutOfReach;
use msk_runtime::episode::{Engine, Environment, EpisodeError};
use msk_runtime::library::BoundBody;
use msk_runtime::policy::{PolicyError, PolicySource};
use rayon::prelude::*;
use series::{Item, Reported, Series};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use take::Extent;

/// Why a test could not be run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TestError {
    /// The task does not fit its body.
    #[error(transparent)]
    Episode(#[from] EpisodeError),
    /// Joints do not reach what they are aligned to.
    #[error(transparent)]
    Reach(#[from] OutOfReach),
    /// What was to act cannot.
    #[error(transparent)]
    Policy(#[from] PolicyError),
}

/// Plays tests of one task. One value serves one thread.
pub struct Stage<'a> {
    tests: &'a TaskTests,
    episode: Environment,
    /// The demonstration of the task once it was played; `None` inside if no test succeeds.
    shown: Option<Option<Demonstration>>,
    /// The policy that is tested.
    policy: Option<&'a PolicySource>,
}

impl<'a> Stage<'a> {
    /// For the tests of a task on its body.
    ///
    /// # Errors
    /// A task that does not fit the body.
    pub fn new(tests: &'a TaskTests, body: &BoundBody) -> Result<Self, TestError> {
        let episode = Environment::new(body.model.clone(), body.body.clone(), tests.task.clone())?;
        Ok(Self { tests, episode, shown: None, policy: None })
    }

    /// The same with the policy that is tested.
    pub fn with_policy(self, policy: Option<&'a PolicySource>) -> Self {
        Self { policy, ..self }
    }

    /// The same where the demonstration was played already.
    fn with_demonstration(self, demonstration: Option<Demonstration>) -> Self {
        Self { shown: Some(demonstration), ..self }
    }

    /// Plays a test, by its place in [`TaskTests::tests`].
    pub fn play(&mut self, index: usize) -> TestReport {
        let mut series = Series::new(self.tests, [Item::Test(index)], self.policy).ranking(self.shown.take());
        while series.advance(&mut self.episode) {}
        self.shown = series.demonstration;
        // One test has one report.
        series.reports.swap_remove(0).report
    }

    /// Plays the episodes of a test once more, as far as their scripts go; `look` gets the place of each among the episodes of the test
    /// and sees it after its reset and after every control step. Moments that are only reset are left out.
    ///
    /// # Errors
    /// What was to act cannot.
    pub fn show(&mut self, index: usize, look: &mut dyn FnMut(usize, &Environment)) -> Result<(), TestError> {
        for (place, take) in self.tests.tests[index].takes.iter().enumerate().filter(|(_, take)| take.resets.is_none()) {
            let extent = (Extent::Until, self.policy);
            take::play(&mut self.episode, take, Default::default(), extent, &mut |episode| look(place, episode))?;
        }
        Ok(())
    }

    /// The first test that expects success at its end and, held to the horizon, succeeds.
    fn demonstration(&mut self) -> Option<Demonstration> {
        let mut series = Series::new(self.tests, [Item::Demonstration], None).ranking(self.shown.take());
        while series.advance(&mut self.episode) {}
        self.shown = series.demonstration;
        self.shown.clone().flatten()
    }
}

/// A test of a task, by its place, with the body that the task runs on.
pub type Job<'a> = (&'a TaskTests, BoundBody, usize);

/// Plays tests on all cores; reports come in the order of the jobs. Tests that run the policy that is tested fail where there is none.
///
/// Up to eight tests of tasks on one model are played at once, the longest first.
///
/// # Errors
/// A task that does not fit its body.
pub fn run_all(jobs: &[Job<'_>], policy: Option<&PolicySource>) -> Result<Vec<TestReport>, TestError> {
    // Tests of one task stand together.
    let groups: Vec<&[Job<'_>]> = jobs.chunk_by(|left, right| std::ptr::eq(left.0, right.0)).collect();
    let mut queue = Queue::default();
    for (group, jobs) in groups.iter().enumerate() {
        let (tests, body, _) = &jobs[0];
        let engine = Engine::new(body.model.clone(), body.body.clone(), tests.task.clone())?;
        let ranked = jobs.iter().any(|(_, _, place)| tests.tests[*place].cheat);
        let items = jobs.iter().map(|(_, _, place)| Item::Test(*place)).chain(ranked.then_some(Item::Demonstration));
        for item in items {
            queue.add(Waiting { group, tests, engine: engine.clone(), item });
        }
    }
    let threads = rayon::current_num_threads();
    let width = queue.len().div_ceil(threads).clamp(1, WIDTH);
    let found: Vec<Mutex<Found>> = groups.iter().map(|_| Mutex::default()).collect();
    let queue = Mutex::new(queue);
    let work = |_| {
        let mut claim = |present: Option<&Engine>| {
            let Waiting { group, tests, engine, item } = queue.lock().unwrap_or_else(PoisonError::into_inner).claim(present)?;
            Some((group, Line::new(Series::new(tests, [item], policy), engine)))
        };
        let mut done = |group: usize, series: Series<'_, &TaskTests>| {
            let Found { demonstration, reported } = &mut *found[group].lock().unwrap_or_else(PoisonError::into_inner);
            *demonstration = demonstration.take().or(series.demonstration.flatten());
            reported.extend(series.reports.into_iter().map(|reported| (reported.place, reported)));
        };
        lanes::play(width, &mut claim, &mut done);
    };
    (0..threads).into_par_iter().for_each(work);
    let mut reports = Vec::new();
    for (jobs, found) in groups.into_iter().zip(found) {
        let Found { demonstration, reported } = found.into_inner().unwrap_or_else(PoisonError::into_inner);
        let own =
            jobs.iter().filter_map(|(tests, _, place)| Some(reported.get(place)?.clone().ranked(tests, demonstration.as_ref())));
        reports.extend(own);
    }
    Ok(reports)
}

/// What has come of the tests of a task, by their places.
#[derive(Default)]
struct Found {
    demonstration: Option<Demonstration>,
    reported: BTreeMap<usize, Reported>,
}
