//! Tests of one task that are played one after another, take by take.

use super::TestError;
use super::report::TestReport;
use super::returns::{Demonstration, Ranking, Returns};
use super::take::{Extent, Played, Playing};
use msk_program::task::TaskTests;
use msk_program::testing::{Take, TaskTest};
use msk_runtime::episode::Environment;
use msk_runtime::policy::PolicySource;
use std::collections::{BTreeSet, VecDeque};
use std::ops::Deref;

/// What a series plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Item {
    /// A test, by its place in [`TaskTests::tests`].
    Test(usize),
    /// The demonstration of the task.
    Demonstration,
}

/// Tests of one task, and what has come of them so far.
pub(super) struct Series<'a, Tests> {
    tests: Tests,
    /// The policy that is tested.
    policy: Option<&'a PolicySource>,
    waiting: VecDeque<Item>,
    now: Option<Now>,
    playing: Option<Playing<'a>>,
    /// The demonstration of the task once it was played; `None` inside if no test succeeds.
    pub(super) demonstration: Option<Option<Demonstration>>,
    /// In the order in which the tests were played.
    pub(super) reports: Vec<Reported>,
    /// Whether cheats are ranked below the demonstration, which is played for that.
    ranks: bool,
    until_failure: bool,
}

/// What has come of a test.
#[derive(Clone)]
pub(super) struct Reported {
    pub(super) place: usize,
    pub(super) report: TestReport,
    /// What a cheat earns, if that is still to be ranked.
    returns: Option<Returns>,
}

/// What is being played.
struct Now {
    item: Item,
    played: Vec<Played>,
    /// Which test is tried as the demonstration.
    candidate: Option<usize>,
}

impl Reported {
    /// The report with its rank beside the demonstration.
    pub(super) fn ranked(self, tests: &TaskTests, demonstration: Option<&Demonstration>) -> TestReport {
        let Self { place, report, returns } = self;
        match returns {
            Some(returns) => report.ranked(&tests.tests[place], Ranking { returns, demonstration: demonstration.cloned() }),
            None => report,
        }
    }
}

impl<'a, Tests: Deref<Target = TaskTests>> Series<'a, Tests> {
    /// Items in their order, all of which are played.
    pub(super) fn new(tests: Tests, items: impl IntoIterator<Item = Item>, policy: Option<&'a PolicySource>) -> Self {
        Self {
            tests,
            policy,
            waiting: items.into_iter().collect(),
            now: None,
            playing: None,
            demonstration: None,
            reports: Vec::new(),
            ranks: false,
            until_failure: false,
        }
    }

    /// The same with cheats ranked, beside a demonstration that may be known.
    pub(super) fn ranking(self, demonstration: Option<Option<Demonstration>>) -> Self {
        Self { ranks: true, demonstration, ..self }
    }

    /// The same up to the first test that fails.
    pub(super) fn until_failure(self) -> Self {
        Self { until_failure: true, ..self }
    }

    /// Plays on in an environment of the task, always the same, until a pose waits for its
    /// [forward pass](msk_runtime::episode::PassGroup::pass); gives whether one does, else all has been played.
    pub(super) fn advance(&mut self, episode: &mut Environment) -> bool {
        loop {
            let Some(mut playing) = self.playing.take().or_else(|| self.next(episode)) else { return false };
            match playing.advance(episode, &mut |_| {}) {
                Ok(true) => {
                    self.playing = Some(playing);
                    return true;
                }
                Ok(false) => self.keep(Ok(playing.finish(episode))),
                Err(error) => self.keep(Err(error)),
            }
        }
    }

    /// Begins the next take.
    fn next(&mut self, episode: &mut Environment) -> Option<Playing<'a>> {
        loop {
            if self.now.is_none() {
                let item = self.waiting.pop_front()?;
                let candidate = (item == Item::Demonstration).then_some(0);
                self.now = Some(Now { item, played: Vec::new(), candidate });
            }
            let now = self.now.as_mut()?;
            if let (Item::Test(place), None) = (now.item, now.candidate) {
                let (test, number) = (&self.tests.tests[place], now.played.len());
                if let Some(take) = test.takes.get(number) {
                    let extent = if own(test) == Some(number) { Extent::Horizon } else { Extent::Until };
                    return Some(Playing::begin(episode, take, wanted(test, number), (extent, self.policy)));
                }
                if self.ranks && own(test).is_some() && self.demonstration.is_none() {
                    now.candidate = Some(0);
                }
            }
            if let (Some(candidate), None) = (now.candidate, &self.demonstration) {
                if let Some((_, take)) = self.tests.demonstrations().nth(candidate) {
                    return Some(Playing::begin(episode, take, BTreeSet::new(), (Extent::Horizon, None)));
                }
                self.demonstration = Some(None);
            }
            self.judge();
        }
    }

    /// Keeps what the take that was begun last has shown.
    fn keep(&mut self, played: Result<Played, TestError>) {
        let Some(now) = &mut self.now else { return };
        match (now.candidate, played) {
            (Some(candidate), Ok(played)) if played.returns.success => {
                let shown = self.tests.demonstrations().nth(candidate);
                self.demonstration =
                    Some(shown.map(|(test, _)| Demonstration { title: test.title.clone(), returns: played.returns }));
            }
            (Some(candidate), _) => now.candidate = Some(candidate + 1),
            (None, Ok(played)) => now.played.push(played),
            (None, Err(error)) => {
                if let Item::Test(place) = now.item {
                    let report = TestReport::unable(&self.tests.task, &self.tests.tests[place], &error);
                    self.report(Reported { place, report, returns: None });
                }
            }
        }
    }

    /// Reports a test all of which was played.
    fn judge(&mut self) {
        let Some(Now { item: Item::Test(place), played, .. }) = self.now.take() else { return };
        let test = &self.tests.tests[place];
        let report = TestReport::of(&self.tests, test, &played);
        let returns = own(test).and_then(|take| played.into_iter().nth(take)).map(|played| played.returns);
        let reported = Reported { place, report, returns };
        match self.demonstration.as_ref().filter(|_| self.ranks) {
            Some(demonstration) => {
                let report = reported.ranked(&self.tests, demonstration.as_ref());
                self.report(Reported { place, report, returns: None });
            }
            None => self.report(reported),
        }
    }

    fn report(&mut self, reported: Reported) {
        self.now = None;
        if self.until_failure && !reported.report.passed() {
            self.waiting.clear();
        }
        self.reports.push(reported);
    }
}

/// How long a test moves, in control steps; physics counts a hundredfold.
pub(super) fn length(test: &TaskTest) -> u32 {
    let long = |take: &Take| {
        let moved = take.script.last().map_or(0, |key| key.step);
        let run = take.run.as_ref().map_or(0, |run| take.until.unwrap_or(10_000).saturating_sub(run.from));
        moved.saturating_add(run.saturating_mul(100)).saturating_add(1)
    };
    // A cheat is held to the horizon, and the demonstration is played beside it.
    let ranked = if test.cheat { 1_000 } else { 0 };
    test.takes.iter().map(long).fold(ranked, u32::saturating_add)
}

/// The take of a cheat whose returns are ranked.
fn own(test: &TaskTest) -> Option<usize> {
    test.takes.iter().position(|take| test.cheat && take.moment.is_none())
}

/// The steps of a take at which expectations look.
fn wanted(test: &TaskTest, take: usize) -> BTreeSet<u32> {
    let readings = test.expectations.iter().flat_map(|expectation| expectation.readings());
    readings.filter(|reading| reading.take == take).filter_map(|reading| reading.step).collect()
}
