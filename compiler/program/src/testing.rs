//! The tests of a task, compiled: plain data.
//!
//! A test is made of [`Take`]s, each an episode of its own: one for the test itself, one for every `moment`. What expectations
//! read are numbers that [`TaskTests::task`](crate::task::TaskTests::task) reports among its metrics at every step; the task that users run has none of them, and its
//! hash does not know of tests.

use crate::extremes::{maximum, minimum};
use crate::init::Init;
use crate::source::{FileId, Span};
use crate::spoken::SpokenUnit;

/// A test.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskTest {
    /// What it shows.
    pub title: String,
    /// Whether it is a way of cheating.
    pub cheat: bool,
    /// Where it stands.
    pub at: (FileId, Span),
    /// Episodes; the test's own is the last if anything looks at it.
    pub takes: Vec<Take>,
    /// What must hold, in the order of the text.
    pub expectations: Vec<Expectation>,
}

/// An episode of a test: played as scripted, then run if the script asks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Take {
    /// The moment that it is; `None` for the test's own.
    pub moment: Option<String>,
    /// Values that randoms have instead of those that chance gives: place among the task's randoms, SI units.
    pub given: Vec<(usize, Vec<f64>)>,
    /// What is shown, in the order of time; the last is held. Empty where the physics begins as the task does.
    pub script: Vec<Keyframe>,
    /// When it ends if the task does not end it, control steps: `None` at the horizon.
    pub until: Option<u32>,
    /// What acts once the script is over.
    pub run: Option<Run>,
    /// So many episodes are only reset, as the task does, and read before anything moves; `None` for an episode that is played.
    pub resets: Option<u32>,
}

/// What is shown at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Keyframe {
    /// When, control steps since the beginning.
    pub step: u32,
    /// Joints, root and objects; noise and settling are without meaning.
    pub init: Init,
    /// Activation and excitation of every muscle.
    pub activation: f64,
    /// Whether the motion that it follows goes on from here to the next keyframe.
    pub plays: bool,
}

/// Physics under a policy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// Its name.
    pub policy: String,
    /// It begins after so many control steps.
    pub from: u32,
}

impl Run {
    /// The name of the policy that `msk test --policy` gives.
    pub const GIVEN: &str = "policy";

    /// Whether the policy is the one that is tested, which the text does not name.
    pub fn is_of_given_policy(&self) -> bool {
        self.policy == Self::GIVEN
    }
}

impl TaskTest {
    /// Whether it tests a policy, so that it is played only where one is given: `run policy`.
    pub fn needs_policy(&self) -> bool {
        self.takes.iter().filter_map(|take| take.run.as_ref()).any(Run::is_of_given_policy)
    }
}

/// A number that tests look at: for each phase its place among those of that phase, or `None` where the phase has no such
/// thing. A task by itself is one phase.
pub type Probe = Vec<Option<usize>>;

/// Where a number is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reading {
    /// In which take.
    pub take: usize,
    /// At which control step; `None` at the last.
    pub step: Option<u32>,
}

/// What must hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// As written.
    pub source: String,
    /// Where it stands.
    pub at: (FileId, Span),
    /// How it is decided.
    pub check: Check,
}

/// How an expectation is decided.
#[derive(Debug, Clone, PartialEq)]
pub enum Check {
    /// A condition, given as one of the numbers that tests look at: it holds unless that is 0.
    Holds {
        /// Which of them.
        probe: Probe,
        /// Where it is read.
        reading: Reading,
    },
    /// Numbers in an order: each holds to the next.
    Order {
        /// One more than comparisons.
        sides: Vec<Side>,
        /// Between them.
        comparisons: Vec<Comparison>,
    },
}

/// A number of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    /// As written.
    pub source: String,
    /// Unit.
    pub unit: SpokenUnit,
    /// Which of the numbers that tests look at.
    pub probe: Probe,
    /// Where it is read.
    pub reading: Reading,
    /// What is taken of the values of all episodes of a moment that is reset several times.
    pub statistic: Option<Statistic>,
    /// Its value if it is the same in every episode: it is then not printed.
    pub constant: bool,
}

/// A number that stands for the values of several episodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// The lowest.
    Min,
    /// The highest.
    Max,
    /// The mean.
    Mean,
    /// The standard deviation, divided by n.
    Std,
}

impl Statistic {
    /// All, in the order of the reference.
    pub const ALL: [Self; 4] = [Self::Min, Self::Max, Self::Mean, Self::Std];

    /// As written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Max => "max",
            Self::Mean => "mean",
            Self::Std => "std",
        }
    }

    /// Of these values; `None` if there are none.
    pub fn of(self, values: &[f64]) -> Option<f64> {
        let count = values.len() as f64;
        let mean = || values.iter().sum::<f64>() / count;
        let first = *values.first()?;
        Some(match self {
            Self::Min => values.iter().copied().fold(first, minimum),
            Self::Max => values.iter().copied().fold(first, maximum),
            Self::Mean => mean(),
            Self::Std => {
                let mean = mean();
                (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt()
            }
        })
    }
}

/// Comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
}

impl Comparison {
    /// Whether it holds; never of what is no number.
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Less => left < right,
            Self::LessEqual => left <= right,
            Self::Greater => left > right,
            Self::GreaterEqual => left >= right,
            Self::Equal => left == right,
            Self::NotEqual => left != right && !left.is_nan() && !right.is_nan(),
        }
    }

    /// As written.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
            Self::Equal => "==",
            Self::NotEqual => "!=",
        }
    }
}

impl TaskTest {
    /// Leaves out the test's own episode, which is the last, where nothing looks at it.
    pub fn drop_unread(&mut self) {
        let Some(own) = self.takes.len().checked_sub(1) else { return };
        if !self.expectations.iter().flat_map(Expectation::readings).any(|reading| reading.take == own) {
            self.takes.pop();
        }
    }
}

impl Expectation {
    /// What is the same in every episode is read wherever another side is.
    pub fn settle(&mut self) {
        let Check::Order { sides, .. } = &mut self.check else { return };
        if let Some(reading) = sides.iter().find(|side| !side.constant).map(|side| side.reading) {
            sides.iter_mut().filter(|side| side.constant).for_each(|side| side.reading = reading);
        }
    }

    /// Whether it must hold in each episode of a moment that is reset several times: something is read of each, and not over all.
    pub fn is_of_each(&self) -> bool {
        match &self.check {
            Check::Holds { .. } => true,
            Check::Order { sides, .. } => sides.iter().any(|side| side.statistic.is_none() && !side.constant),
        }
    }

    /// Every place where it reads something.
    pub fn readings(&self) -> Vec<Reading> {
        match &self.check {
            Check::Holds { reading, .. } => vec![*reading],
            Check::Order { sides, .. } => sides.iter().filter(|side| !side.constant).map(|side| side.reading).collect(),
        }
    }
}
