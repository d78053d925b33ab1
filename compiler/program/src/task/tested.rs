//! The tests of a task, with the program that also computes what they look at.

use super::CompiledTask;
use crate::testing::{Check, Expectation, Keyframe, Reading, Take, TaskTest};
use std::sync::Arc;

/// The tests of a task.
pub struct TaskTests {
    /// The task with what the tests look at among its metrics.
    pub task: Arc<CompiledTask>,
    /// For each phase (a task by itself has one): the place in [`StepReport::metrics`](super::StepReport::metrics) of the first number that tests look at
    /// there.
    pub first: Vec<usize>,
    /// In the order of the text.
    pub tests: Vec<TaskTest>,
}

impl TaskTests {
    /// The tests that may be the task's demonstration, with the episodes that they play: those that expect success at their end.
    pub fn demonstrations(&self) -> impl Iterator<Item = (&TaskTest, &Take)> {
        self.tests.iter().filter(|test| !test.cheat && !test.needs_policy()).filter_map(|test| {
            let own = test.takes.iter().position(|take| take.moment.is_none())?;
            let end = Reading { take: own, step: None };
            let succeeds = |expectation: &Expectation| {
                let at_its_end = matches!(&expectation.check, Check::Holds { reading, .. } if *reading == end);
                at_its_end && expectation.source == "success"
            };
            test.expectations.iter().any(succeeds).then(|| (test, &test.takes[own]))
        })
    }

    /// The first script that moves and after which the task is expected to have succeeded.
    pub fn demonstration(&self) -> Option<&[Keyframe]> {
        self.demonstrated().map(|take| take.script.as_slice())
    }

    /// The episode of that script, with what it decides of what is drawn.
    pub fn demonstrated(&self) -> Option<&Take> {
        self.tests.iter().filter(|test| !test.cheat).find_map(|test| {
            let success = |expectation: &&Expectation| expectation.source == "success";
            let take = test.expectations.iter().filter(success).find_map(|expectation| {
                let Check::Holds { reading, .. } = &expectation.check else { return None };
                test.takes.get(reading.take)
            })?;
            (take.script.len() > 1 && take.run.is_none()).then_some(take)
        })
    }
}
