//! Tests of tasks: what they show is played, what they expect is compared.
//!
//! 1. Every take of a test is an episode: its script says where everything is (`script`), physics takes over if it says `run`;
//! 2. what expectations look at is kept at their moments (`take`);
//! 3. a [`TestReport`] says what held and, with the numbers of both sides, what did not.
//!
//! A test has no chance but that of episode 0 of seed 0, so it ends the same way everywhere.

pub mod mutation;
mod report;
mod script;
mod take;

pub use report::{Failure, TestReport, Told};
pub use script::Script;

use crate::episode::{Episode, EpisodeError};
use crate::library::BoundBody;
use crate::policy::PolicyError;
use msk_compiler::testing::TaskTests;
use rayon::prelude::*;
use take::Played;

/// Why a test could not be run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TestError {
    /// The task does not fit its body.
    #[error(transparent)]
    Episode(#[from] EpisodeError),
    /// What was to act cannot.
    #[error(transparent)]
    Policy(#[from] PolicyError),
}

/// Plays tests of one task. One value serves one thread.
pub struct Stage<'a> {
    tests: &'a TaskTests,
    episode: Episode,
}

impl<'a> Stage<'a> {
    /// For the tests of a task on its body.
    ///
    /// # Errors
    /// A task that does not fit the body.
    pub fn new(tests: &'a TaskTests, body: &BoundBody) -> Result<Self, TestError> {
        let episode = Episode::new(body.model.clone(), body.body.clone(), tests.task.clone())?;
        Ok(Self { tests, episode })
    }

    /// Plays a test, by its place in [`TaskTests::tests`].
    pub fn play(&mut self, index: usize) -> TestReport {
        let test = &self.tests.tests[index];
        let readings: Vec<_> = test.expectations.iter().flat_map(|expectation| expectation.readings()).collect();
        let mut played: Vec<Played> = Vec::new();
        for (place, take) in test.takes.iter().enumerate() {
            let wanted = readings.iter().filter(|reading| reading.take == place).filter_map(|reading| reading.step).collect();
            match take::play(&mut self.episode, take, wanted) {
                Ok(done) => played.push(done),
                Err(error) => return TestReport::unable(&self.tests.task, test, &error),
            }
        }
        TestReport::of(self.tests, test, &played)
    }
}

/// A test of a task, by its place, with the body that the task runs on.
pub type Job<'a> = (&'a TaskTests, BoundBody, usize);

/// Plays tests on all cores; reports come in the order of the jobs.
///
/// # Errors
/// A task that does not fit its body.
pub fn run_all(jobs: &[Job<'_>]) -> Result<Vec<TestReport>, TestError> {
    jobs.par_iter().map(|(tests, body, place)| Ok(Stage::new(tests, body)?.play(*place))).collect()
}
