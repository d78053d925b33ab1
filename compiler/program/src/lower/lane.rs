//! Single numbers of a step: where they stand or how they come about.
//!
//! Nodes of the graph are lists of numbers. Here each number is a [`Lane`] of its own, so that choosing lanes and putting them
//! side by side costs nothing, and formulas of single numbers can be computed without writing down what lies between.

use crate::graph::operation::{Binary, Memory, Reduction, Unary};
use crate::graph::track::Track;
use std::rc::Rc;

/// Where the number of the control step stands in the record.
pub(super) const STEP: usize = 0;

/// Where the record holds a zero.
pub(super) const ZERO: usize = 1;

/// The longest list whose numbers are computed one by one; longer ones are computed as a whole.
pub(super) const NARROW: usize = 16;

/// One number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lane {
    /// In the frame of sensors.
    Frame(usize),
    /// In the task's own record.
    Record(usize),
    /// There too, and it never changes.
    Constant(usize),
    /// What a [`Computation`] comes to.
    Computed(usize),
}

/// Numbers of one node.
pub(super) type Lanes = Rc<[Lane]>;

/// Which of the two flat lists numbers stand in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bank {
    Frame,
    Record,
}

/// Numbers that stand side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    pub(super) bank: Bank,
    pub(super) from: usize,
    pub(super) length: usize,
}

impl Lane {
    /// Bank and place of a number that stands somewhere.
    pub(super) fn place(self) -> Option<(Bank, usize)> {
        match self {
            Self::Frame(place) => Some((Bank::Frame, place)),
            Self::Record(place) | Self::Constant(place) => Some((Bank::Record, place)),
            Self::Computed(_) => None,
        }
    }
}

impl Run {
    /// Lanes that stand side by side, as one.
    pub(super) fn of(lanes: &[Lane]) -> Option<Self> {
        let (bank, from) = lanes.first()?.place()?;
        let apart = lanes.iter().enumerate().any(|(index, lane)| lane.place() != Some((bank, from + index)));
        (!apart).then_some(Self { bank, from, length: lanes.len() })
    }

    /// Its lanes.
    pub(super) fn lanes(self) -> Lanes {
        let range = self.from..self.from + self.length;
        match self.bank {
            Bank::Frame => range.map(Lane::Frame).collect(),
            Bank::Record => range.map(Lane::Record).collect(),
        }
    }
}

/// The lane at `index` of a list that may have one for all.
pub(super) fn lane(lanes: &[Lane], index: usize) -> Lane {
    match lanes {
        [] => Lane::Constant(ZERO),
        [only] => *only,
        several => several[index],
    }
}

/// One number from others, without memory.
#[derive(Debug)]
pub(super) enum Computation {
    Unary(Unary, Lane),
    Binary(Binary, Lane, Lane),
    /// The second where the first holds, else the third.
    Choose([Lane; 3]),
    /// Numbers side by side, or few.
    Reduce(Reduction, Lanes),
    /// Of two lists that stand somewhere.
    Pairs(Pairing, [Lanes; 2]),
}

/// A reduction of what pairs of numbers come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pairing {
    SumOfProducts,
    NormOfDifferences,
}

impl Computation {
    /// Calls `visit` with every number that it reads.
    pub(super) fn each_input(&self, visit: &mut dyn FnMut(Lane)) {
        match self {
            Self::Unary(_, lane) => visit(*lane),
            Self::Binary(_, left, right) => [*left, *right].into_iter().for_each(visit),
            Self::Choose(lanes) => lanes.iter().copied().for_each(visit),
            Self::Reduce(_, lanes) => lanes.iter().copied().for_each(visit),
            Self::Pairs(_, lists) => lists.iter().flat_map(|lanes| lanes.iter()).copied().for_each(visit),
        }
    }
}

/// Something that is done once per step: it writes to the record.
#[derive(Debug)]
pub(super) enum Effect {
    /// Writes numbers side by side.
    Put { at: usize, lanes: Lanes },
    /// Gives the cells of a state their first values; done at reset only.
    Begin { cell: usize, lanes: Lanes },
    /// Copies the cells of a random; where the episode begins it is drawn first.
    Draw { draw: usize, at: usize },
    /// Advances cells that remember, lane by lane; what they come to is written down if it is not what they hold.
    Remember { memory: Memory, cell: usize, lanes: Vec<[Lane; 3]>, at: Option<usize> },
    /// Computes a list as a whole.
    Block { code: Code, inputs: Vec<Run>, at: usize, width: usize },
    /// Copies element number `place` of a list.
    Pick { list: Run, place: Lane, at: usize, width: usize },
    /// Writes what a motion shows at a time.
    Follow { track: Track, time: Lane, at: usize },
}

/// How a list is computed as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Code {
    Unary(Unary),
    Binary(Binary),
    Choose,
    /// Every group of so many numbers becomes one.
    Reduce(Reduction, usize),
    Quaternion,
}

impl Effect {
    /// Calls `visit` with every number that it reads, but for those of runs, which stand somewhere.
    pub(super) fn each_input(&self, visit: &mut dyn FnMut(Lane)) {
        match self {
            Self::Put { lanes, .. } | Self::Begin { lanes, .. } => lanes.iter().copied().for_each(visit),
            Self::Remember { lanes, .. } => lanes.iter().flatten().copied().for_each(visit),
            Self::Pick { place: lane, .. } | Self::Follow { time: lane, .. } => visit(*lane),
            Self::Draw { .. } | Self::Block { .. } => {}
        }
    }
}

/// When something is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Time {
    /// Before the states are updated; `first` before the episode begins as well.
    Before { first: bool },
    /// After.
    After,
    /// At each try of a draw.
    Try(usize),
}

/// What is done, in an order in which whatever is read stands first.
#[derive(Debug)]
pub(super) enum Act {
    /// Number of a [`Computation`].
    Compute(usize),
    Do(Effect),
}
