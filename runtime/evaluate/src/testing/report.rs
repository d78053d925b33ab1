//! What came of a test.

use super::TestError;
use super::returns::Ranking;
use super::take::Played;
use msk_program::numbers::beside;
use msk_program::source::{FileId, Span};
use msk_program::task::{CompiledTask, TaskTests};
use msk_program::testing::{Check, Comparison, Expectation, Reading, Side, TaskTest};
use msk_runtime::episode::Ending;
use serde::Serialize;

/// What came of a test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestReport {
    /// The task.
    pub task: String,
    /// What the test shows.
    pub title: String,
    /// Whether it is a way of cheating.
    pub cheat: bool,
    /// Where it stands.
    #[serde(skip)]
    pub at: (FileId, Span),
    /// What did not hold, in the order of the text. None: it has passed.
    pub failures: Vec<Failure>,
    /// What a cheat earns, held to the horizon, beside the demonstration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ranking: Option<Ranking>,
}

/// An expectation that did not hold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failure {
    /// As written.
    pub expected: String,
    /// What was instead, in words.
    pub found: String,
    /// Where it stands.
    #[serde(skip)]
    pub at: (FileId, Span),
    /// The numbers of a comparison.
    pub sides: Vec<SideValue>,
}

/// A number of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SideValue {
    /// As written.
    pub source: String,
    /// Its value in SI units; `None` where its moment was not reached.
    pub value: Option<f64>,
    /// Unit, empty for plain numbers.
    pub unit: String,
}

impl TestReport {
    /// Whether all held.
    pub fn passed(&self) -> bool {
        self.failures.is_empty()
    }

    pub(super) fn unable(task: &CompiledTask, test: &TaskTest, error: &TestError) -> Self {
        let failure = Failure { expected: "that it runs".into(), found: error.to_string(), at: test.at, sides: Vec::new() };
        Self { failures: vec![failure], ..Self::empty(task, test) }
    }

    fn empty(task: &CompiledTask, test: &TaskTest) -> Self {
        Self {
            task: task.name.clone(),
            title: test.title.clone(),
            cheat: test.cheat,
            at: test.at,
            failures: Vec::new(),
            ranking: None,
        }
    }

    pub(super) fn of(tests: &TaskTests, test: &TaskTest, played: &[Played]) -> Self {
        let judge = Judge { tests, test, played };
        let failures = test.expectations.iter().filter_map(|expectation| judge.failure(expectation)).collect();
        Self { failures, ..Self::empty(&tests.task, test) }
    }

    /// With what the cheat earns. A cheat that succeeds, or that could not be played, is reported as such and not compared.
    pub(super) fn ranked(mut self, test: &TaskTest, ranking: Ranking) -> Self {
        if self.passed() {
            self.failures = ranking.failures(test);
        }
        Self { ranking: Some(ranking), ..self }
    }
}

/// What is looked at to decide on expectations.
struct Judge<'a> {
    tests: &'a TaskTests,
    test: &'a TaskTest,
    played: &'a [Played],
}

impl Judge<'_> {
    fn failure(&self, expectation: &Expectation) -> Option<Failure> {
        // A fault is no way to end an episode, whatever a test expects of its end.
        if let Some(fault) = self.fault(expectation) {
            let (expected, at) = (expectation.source.clone(), expectation.at);
            return Some(Failure { expected, found: fault, at, sides: Vec::new() });
        }
        let (found, sides) = self.misses(expectation)?;
        Some(Failure { expected: expectation.source.clone(), found, at: expectation.at, sides })
    }

    /// What was instead, with the numbers of a comparison: of the first episode in which the expectation does not hold.
    fn misses(&self, expectation: &Expectation) -> Option<(String, Vec<SideValue>)> {
        let readings = expectation.readings();
        let resets = |reading: &&Reading| self.played.get(reading.take).is_some_and(|played| played.episodes() > 1);
        let several = readings.iter().find(resets);
        let episodes = several.and_then(|reading| self.played.get(reading.take)).map_or(1, Played::episodes);
        (0..episodes).find_map(|episode| {
            let (found, sides) = self.misses_in(expectation, episode)?;
            let each = several.is_some_and(|_| expectation.is_of_each());
            Some((if each { format!("episode {episode}: {found}") } else { found }, sides))
        })
    }

    fn misses_in(&self, expectation: &Expectation, episode: usize) -> Option<(String, Vec<SideValue>)> {
        match &expectation.check {
            Check::Holds { probe, reading } => match self.value(probe, *reading, episode) {
                Some(value) if value != 0.0 => None,
                Some(_) => Some((self.state_of(reading.take, reading.step), Vec::new())),
                None => Some((self.not_there(probe, *reading), Vec::new())),
            },
            Check::Order { sides, comparisons } => {
                let values: Vec<Option<f64>> = sides.iter().map(|side| self.side(side, episode)).collect();
                if holds(&values, comparisons) {
                    return None;
                }
                let missing = sides.iter().zip(&values).find(|(_, value)| value.is_none());
                let found = match missing {
                    Some((side, _)) => self.not_there(&side.probe, side.reading),
                    None => in_words(sides, &values),
                };
                let shown = sides.iter().zip(&values);
                let shown =
                    shown.map(|(side, &value)| SideValue { source: side.source.clone(), value, unit: side.unit.si.clone() });
                Some((found, shown.collect()))
            }
        }
    }

    /// The number of a side in an episode, or what is taken over all of them.
    fn side(&self, side: &Side, episode: usize) -> Option<f64> {
        let Some(statistic) = side.statistic else { return self.value(&side.probe, side.reading, episode) };
        let episodes = self.played.get(side.reading.take)?.episodes();
        let values: Option<Vec<f64>> = (0..episodes).map(|episode| self.value(&side.probe, side.reading, episode)).collect();
        statistic.of(&values?)
    }

    fn value(&self, probe: &[Option<usize>], reading: Reading, episode: usize) -> Option<f64> {
        let seen = self.played.get(reading.take)?.seen_of(episode, reading.step)?;
        let place = self.tests.first.get(seen.phase)? + (*probe.get(seen.phase)?)?;
        seen.metrics.get(place).copied()
    }

    fn fault(&self, expectation: &Expectation) -> Option<String> {
        expectation.readings().into_iter().find_map(|reading| {
            let played = self.played.get(reading.take)?;
            let Some(Ending::Fault(fault)) = &played.ending else { return None };
            let reached = reading.step.is_some_and(|step| played.seen(Some(step)).is_some());
            (!reached).then(|| format!("{}the episode was stopped by a fault: {fault}", self.prefix(reading.take)))
        })
    }

    /// `moment low: `
    fn prefix(&self, take: usize) -> String {
        let moment = self.test.takes.get(take).and_then(|take| take.moment.as_ref());
        moment.map_or(String::new(), |moment| format!("moment {moment}: "))
    }

    fn state_of(&self, take: usize, step: Option<u32>) -> String {
        if self.played.get(take).is_some_and(|played| !played.resets.is_empty()) {
            return format!("{}does not hold at reset", self.prefix(take));
        }
        match step {
            Some(step) => format!("does not hold at {}", self.time(step)),
            None => format!("{}{}", self.prefix(take), self.end_of(take)),
        }
    }

    /// Why there is no number: its moment was not reached, or what is looked at belongs to other phases.
    fn not_there(&self, probe: &[Option<usize>], Reading { take, step }: Reading) -> String {
        let phases = self.tests.task.phases();
        if let Some(seen) = self.played.get(take).and_then(|played| played.seen(step)) {
            let name = |phase: usize| phases.get(phase).copied().unwrap_or_default();
            let of: Vec<String> =
                (0..probe.len()).filter(|&phase| probe[phase].is_some()).map(|phase| format!("`{}`", name(phase))).collect();
            let moment = step.map_or("its end".to_owned(), |step| self.time(step));
            let (prefix, present) = (self.prefix(take), name(seen.phase));
            return format!("{prefix}at {moment} the phase is `{present}`; this is defined in {}", of.join(", "));
        }
        let moment = step.map_or("its end".to_owned(), |step| self.time(step));
        format!("{}{moment} was not reached: {}", self.prefix(take), self.end_of(take))
    }

    fn time(&self, step: u32) -> String {
        format!("{:.2} s", f64::from(step) / self.tests.task.control_frequency)
    }

    /// How a take ended.
    fn end_of(&self, take: usize) -> String {
        let Some(played) = self.played.get(take) else { return "the script is empty".into() };
        let time = self.time(played.steps);
        let task = &self.tests.task;
        match &played.ending {
            Some(ending @ Ending::Terminated(_)) => format!("the episode ended by {} at {time}", ending.conditions(task)),
            Some(ending @ Ending::Finished(_)) => format!("the episode finished by {} at {time}", ending.conditions(task)),
            Some(Ending::Truncated) => {
                let waits = u32::try_from(played.last.phase).ok().and_then(|phase| task.awaited(phase));
                let waits = waits.map_or(String::new(), |waits| format!(" in {waits}, which never held"));
                format!("the episode reached the horizon at {time}{waits}")
            }
            Some(Ending::Fault(fault)) => format!("the episode was stopped by a fault: {fault}"),
            None => format!("the test was over at {time}"),
        }
    }
}

fn holds(values: &[Option<f64>], comparisons: &[Comparison]) -> bool {
    values.windows(2).zip(comparisons).all(|(pair, comparison)| match pair {
        [Some(left), Some(right)] => comparison.holds(*left, *right),
        _ => false,
    })
}

/// `reward.pose = 9.87, pelvis.height = 0.93 m`
fn in_words(sides: &[Side], values: &[Option<f64>]) -> String {
    // What a comparison tells apart, the eye shall.
    let amounts: Vec<Option<f64>> =
        sides.iter().zip(values).map(|(side, value)| value.map(|value| side.unit.amount(value))).collect();
    let known: Vec<f64> = amounts.iter().copied().flatten().collect();
    let shown = sides.iter().zip(&amounts).filter(|(side, _)| !side.constant);
    let shown = shown.map(|(side, amount)| {
        let amount = amount.map_or("?".into(), |amount| beside(amount, &known));
        format!("{} = {}", side.source, side.unit.with_unit(&amount))
    });
    shown.collect::<Vec<_>>().join(", ")
}
