//! Tests of tasks: what they show is played, what they expect is compared.
//!
//! 1. Every take of a test is an episode: its script sets where everything is (`script`), physics takes over after `run`;
//! 2. what expectations look at is kept at their moments (`take`);
//! 3. a [`TestReport`] lists what held and, with the numbers of both sides, what did not;
//! 4. what a cheat earns is ranked below what the demonstration earns (`returns`);
//! 5. exploits that no `cheat` describes yet are searched for ([`exploit`]).
//!
//! A test has no chance but that of episode 0 of seed 0, so it ends the same way everywhere.

pub mod exploit;
pub mod mutation;
mod report;
mod returns;
mod take;

pub use report::{Failure, SideValue, TestReport};
pub use returns::{DISCOUNT, Demonstration, Measure, Ranking, Returns, TermReturn};

use msk_program::task::TaskTests;
use msk_runtime::body::OutOfReach;
use msk_runtime::episode::{Environment, EpisodeError};
use msk_runtime::library::BoundBody;
use msk_runtime::policy::{PolicyError, PolicySource};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};
use take::{Extent, Played};

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

/// The demonstration of a task once it was played; `None` inside if no test succeeds.
type Shown = Arc<OnceLock<Option<Demonstration>>>;

/// Plays tests of one task. One value serves one thread.
pub struct Stage<'a> {
    tests: &'a TaskTests,
    episode: Environment,
    shown: Shown,
    /// The policy that is tested.
    policy: Option<&'a PolicySource>,
}

impl<'a> Stage<'a> {
    /// For the tests of a task on its body.
    ///
    /// # Errors
    /// A task that does not fit the body.
    pub fn new(tests: &'a TaskTests, body: &BoundBody) -> Result<Self, TestError> {
        Self::beside(tests, body, Shown::default())
    }

    /// One of several for the same tests: the demonstration is played by the first that needs it.
    fn beside(tests: &'a TaskTests, body: &BoundBody, shown: Shown) -> Result<Self, TestError> {
        let episode = Environment::new(body.model.clone(), body.body.clone(), tests.task.clone())?;
        Ok(Self { tests, episode, shown, policy: None })
    }

    /// The same with the policy that is tested.
    pub fn with_policy(self, policy: Option<&'a PolicySource>) -> Self {
        Self { policy, ..self }
    }

    /// Plays a test, by its place in [`TaskTests::tests`].
    pub fn play(&mut self, index: usize) -> TestReport {
        let test = &self.tests.tests[index];
        let readings: Vec<_> = test.expectations.iter().flat_map(|expectation| expectation.readings()).collect();
        let mut played: Vec<Played> = Vec::new();
        for (place, take) in test.takes.iter().enumerate() {
            let wanted = readings.iter().filter(|reading| reading.take == place).filter_map(|reading| reading.step).collect();
            let extent = if test.cheat && take.moment.is_none() { Extent::Horizon } else { Extent::Until };
            match take::play(&mut self.episode, take, wanted, (extent, self.policy), &mut |_| {}) {
                Ok(done) => played.push(done),
                Err(error) => return TestReport::unable(&self.tests.task, test, &error),
            }
        }
        let report = TestReport::of(self.tests, test, &played);
        let own = played.into_iter().zip(&test.takes).find(|(_, take)| test.cheat && take.moment.is_none());
        match own {
            Some((Played { returns, .. }, _)) => report.ranked(test, Ranking { returns, demonstration: self.demonstration() }),
            None => report,
        }
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
        let shown = self.shown.clone();
        let play = || {
            self.tests.demonstrations().find_map(|(test, take)| {
                let played =
                    take::play(&mut self.episode, take, Default::default(), (Extent::Horizon, None), &mut |_| {}).ok()?;
                let succeeds = played.returns.success;
                succeeds.then(|| Demonstration { title: test.title.clone(), returns: played.returns })
            })
        };
        shown.get_or_init(play).clone()
    }
}

/// A test of a task, by its place, with the body that the task runs on.
pub type Job<'a> = (&'a TaskTests, BoundBody, usize);

/// Plays tests on all cores; reports come in the order of the jobs. Tests that run the policy that is tested fail where there is none.
///
/// # Errors
/// A task that does not fit its body.
pub fn run_all(jobs: &[Job<'_>], policy: Option<&PolicySource>) -> Result<Vec<TestReport>, TestError> {
    // Tests of one task stand together.
    let same = |left: &Job<'_>, right: &Job<'_>| std::ptr::eq(left.0, right.0);
    let shown = jobs.chunk_by(same).flat_map(|jobs| vec![Shown::default(); jobs.len()]).collect::<Vec<_>>();
    let play = |((tests, body, place), shown): (&Job<'_>, Shown)| {
        Ok(Stage::beside(tests, body, shown)?.with_policy(policy).play(*place))
    };
    jobs.par_iter().zip(shown).map(play).collect()
}
