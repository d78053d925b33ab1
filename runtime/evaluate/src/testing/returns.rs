//! Returns of scripts: what an exploit earns beside the demonstration of its task.
//!
//! An episode is played to its end or to the horizon, its last pose held. After an early end nothing is earned. Four figures of the
//! exploit must each stay below the demonstration's: the return and the mean reward of a step, without discount and with [`DISCOUNT`].

use super::report::{Failure, SideValue};
use msk_program::numbers::{distinguished, for_people};
use msk_program::task::CompiledTask;
use msk_program::testing::TaskTest;
use msk_runtime::episode::{Ending, Environment};
use serde::Serialize;

/// Discount per control step of the discounted figures.
pub const DISCOUNT: f64 = 0.99;

/// So many terms are named in a failure.
const NAMED: usize = 3;

/// What an episode has earned, term by term.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Returns {
    /// Control steps until the task ended the episode, or the horizon.
    pub steps: u32,
    /// The names of the terminations that ended it, or `horizon`.
    pub ended_by: String,
    /// Whether success held at the last step.
    pub success: bool,
    /// Of every term, in the order of the task.
    pub terms: Vec<TermReturn>,
}

/// What a term has contributed to an episode, weight included.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TermReturn {
    /// The term.
    pub name: String,
    /// Sum over the steps.
    pub plain: f64,
    /// The same, the reward of step n + 1 multiplied by [`DISCOUNT`] to the power of n.
    pub discounted: f64,
}

/// A figure by which episodes are ranked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// The return over the horizon.
    Return,
    /// The mean reward of a step.
    PerStep,
    /// The discounted return over the horizon.
    Discounted,
    /// The mean reward of a step, weighted by the discount.
    DiscountedPerStep,
}

impl Measure {
    /// All, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Return, Self::PerStep, Self::Discounted, Self::DiscountedPerStep];

    /// As a heading.
    pub fn name(self) -> &'static str {
        match self {
            Self::Return => "return",
            Self::PerStep => "per step",
            Self::Discounted => "return, discount 0.99",
            Self::DiscountedPerStep => "per step, discount 0.99",
        }
    }
}

/// The demonstration of a task: its first test that expects success at its end and, held to the horizon, succeeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Demonstration {
    /// The title of the test.
    pub title: String,
    /// What it earns.
    pub returns: Returns,
}

/// What a cheat earns, beside the demonstration if the task has one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranking {
    /// What the cheat earns.
    pub returns: Returns,
    /// What it is compared with.
    pub demonstration: Option<Demonstration>,
}

/// Discounted returns while an episode goes on.
#[derive(Debug, Clone)]
pub(super) struct Tally {
    discounted: Vec<f64>,
    discount: f64,
}

impl Tally {
    pub(super) fn new(task: &CompiledTask) -> Self {
        Self { discounted: vec![0.0; task.terms.len()], discount: 1.0 }
    }

    /// Adds the step that was just taken.
    pub(super) fn add(&mut self, episode: &Environment) {
        let values = episode.report().terms.iter().zip(episode.weights());
        for (term, (value, weight)) in values.enumerate() {
            self.discounted[term] += self.discount * weight * value;
        }
        self.discount *= DISCOUNT;
    }

    /// The returns of an episode that has come so far.
    pub(super) fn finish(self, episode: &Environment) -> Returns {
        let task = episode.task();
        let terms = task.terms.iter().zip(episode.episode().totals().iter().copied().zip(self.discounted));
        let terms = terms.map(|(term, (plain, discounted))| TermReturn { name: term.name.clone(), plain, discounted });
        let ended_by = match episode.ending() {
            Some(Ending::Fault(fault)) => format!("fault: {fault}"),
            Some(Ending::Truncated) | None => "horizon".to_owned(),
            Some(ending) => ending.conditions(task),
        };
        Returns { steps: episode.steps(), ended_by, success: episode.success(), terms: terms.collect() }
    }
}

impl TermReturn {
    fn by(&self, measure: Measure, steps: u32) -> f64 {
        let steps = steps.max(1);
        match measure {
            Measure::Return => self.plain,
            Measure::PerStep => self.plain / f64::from(steps),
            Measure::Discounted => self.discounted,
            Measure::DiscountedPerStep => {
                // Sum of the discounts of the steps.
                let weight = (1.0 - libm::pow(DISCOUNT, f64::from(steps))) / (1.0 - DISCOUNT);
                self.discounted / weight
            }
        }
    }
}

impl Returns {
    /// One of the figures by which episodes are ranked.
    pub fn by(&self, measure: Measure) -> f64 {
        self.terms.iter().map(|term| term.by(measure, self.steps)).sum()
    }

    /// The terms by which this earns more than `other`, the greatest difference first.
    fn surplus<'a>(&'a self, other: &Returns, measure: Measure) -> Vec<(&'a str, f64)> {
        let pairs = self.terms.iter().zip(&other.terms);
        let more = pairs.map(|(mine, its)| (mine.name.as_str(), mine.by(measure, self.steps) - its.by(measure, other.steps)));
        let mut more: Vec<(&str, f64)> = more.filter(|(_, more)| *more > 0.0).collect();
        more.sort_by(|left, right| right.1.total_cmp(&left.1));
        more
    }
}

impl Ranking {
    /// What of the cheat `test` is not as it must be.
    pub(super) fn failures(&self, test: &TaskTest) -> Vec<Failure> {
        // An exploit that only takes longer is none: what it earns would be what the task asks for.
        if self.returns.success {
            let expected = "no success, held to the horizon".to_owned();
            let found = format!("it succeeds after {} steps: it is a demonstration, use `test`", self.returns.steps);
            return vec![Failure { expected, found, at: test.at, sides: Vec::new() }];
        }
        let Some(demonstration) = &self.demonstration else { return Vec::new() };
        Measure::ALL.into_iter().filter_map(|measure| self.failure(test, demonstration, measure)).collect()
    }

    fn failure(&self, test: &TaskTest, demonstration: &Demonstration, measure: Measure) -> Option<Failure> {
        let (mine, its) = (self.returns.by(measure), demonstration.returns.by(measure));
        if mine < its {
            return None;
        }
        let surplus = self.returns.surplus(&demonstration.returns, measure);
        let terms = surplus.iter().take(NAMED).map(|(name, more)| format!("`{name}` earns {} more", for_people(*more)));
        let terms: Vec<String> = terms.collect();
        let because = if terms.is_empty() { String::new() } else { format!(": {}", terms.join(", ")) };
        let [shown, its_shown] = distinguished(&[mine, its]);
        let side = |source: &str, value: f64| SideValue { source: source.to_owned(), value: Some(value), unit: String::new() };
        Some(Failure {
            expected: format!("{} below that of the demonstration \"{}\"", measure.name(), demonstration.title),
            found: format!("{shown} against {its_shown}{because}"),
            at: test.at,
            sides: vec![side("exploit", mine), side("demonstration", its)],
        })
    }
}
