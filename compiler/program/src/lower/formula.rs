//! Formulas of single numbers as closures: each is made for its function and for where its inputs stand, and calls those that
//! are computed within it.

use super::lane::{Bank, Run};
use crate::graph::operation::{Binary, Reduction, Unary};

/// What formulas read.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    /// Sensors.
    pub frame: &'a [f64],
    /// The task's own record.
    pub record: &'a [f64],
}

impl<'a> View<'a> {
    /// One of the two lists.
    #[inline]
    pub(super) fn bank(&self, bank: Bank) -> &'a [f64] {
        match bank {
            Bank::Frame => self.frame,
            Bank::Record => self.record,
        }
    }

    /// Numbers side by side.
    #[inline]
    pub(super) fn run(&self, run: Run) -> &'a [f64] {
        &self.bank(run.bank)[run.from..run.from + run.length]
    }
}

/// One number of a view.
pub(super) type Formula = Box<dyn Fn(&View<'_>) -> f64 + Send + Sync>;

/// Where a number is read.
pub(crate) enum Scalar {
    Frame(usize),
    Record(usize),
    Constant(f64),
    Formula(Formula),
}

impl Scalar {
    /// The number.
    #[inline]
    pub(crate) fn read(&self, view: &View<'_>) -> f64 {
        match self {
            Self::Frame(place) => view.frame[*place],
            Self::Record(place) => view.record[*place],
            Self::Constant(value) => *value,
            Self::Formula(formula) => formula(view),
        }
    }

    /// Whether the condition holds.
    #[inline]
    pub(crate) fn holds(&self, view: &View<'_>) -> bool {
        self.read(view) != 0.0
    }
}

/// A function of one number.
pub(super) fn unary(function: Unary, input: Scalar) -> Formula {
    match function {
        Unary::Negate => of_one(input, |x| Unary::Negate.apply(x)),
        Unary::Absolute => of_one(input, |x| Unary::Absolute.apply(x)),
        Unary::SquareRoot => of_one(input, |x| Unary::SquareRoot.apply(x)),
        Unary::Exponential => of_one(input, |x| Unary::Exponential.apply(x)),
        Unary::Not => of_one(input, |x| Unary::Not.apply(x)),
        other => of_one(input, move |x| other.apply(x)),
    }
}

/// A function of two numbers.
pub(super) fn binary(function: Binary, left: Scalar, right: Scalar) -> Formula {
    match function {
        Binary::Add => of_two(left, right, |a, b| Binary::Add.apply(a, b)),
        Binary::Subtract => of_two(left, right, |a, b| Binary::Subtract.apply(a, b)),
        Binary::Multiply => of_two(left, right, |a, b| Binary::Multiply.apply(a, b)),
        Binary::Divide => of_two(left, right, |a, b| Binary::Divide.apply(a, b)),
        Binary::Minimum => of_two(left, right, |a, b| Binary::Minimum.apply(a, b)),
        Binary::Maximum => of_two(left, right, |a, b| Binary::Maximum.apply(a, b)),
        Binary::Less => of_two(left, right, |a, b| Binary::Less.apply(a, b)),
        Binary::LessEqual => of_two(left, right, |a, b| Binary::LessEqual.apply(a, b)),
        Binary::And => of_two(left, right, |a, b| Binary::And.apply(a, b)),
        other => of_two(left, right, move |a, b| other.apply(a, b)),
    }
}

/// A number kept between two.
pub(super) fn clip(input: Scalar, low: f64, high: f64) -> Formula {
    of_one(input, move |x| Binary::Minimum.apply(Binary::Maximum.apply(x, low), high))
}

/// One of two numbers; the other is not computed.
pub(super) fn choose(condition: Scalar, yes: Scalar, no: Scalar) -> Formula {
    Box::new(move |view| if condition.holds(view) { yes.read(view) } else { no.read(view) })
}

/// Numbers side by side become one.
pub(super) fn reduce_run(reduction: Reduction, run: Run) -> Formula {
    match reduction {
        Reduction::Sum => Box::new(move |view| Reduction::Sum.apply(view.run(run))),
        Reduction::Norm => Box::new(move |view| Reduction::Norm.apply(view.run(run))),
        other => Box::new(move |view| other.apply(view.run(run))),
    }
}

/// So many numbers from anywhere become one.
pub(super) fn reduce_each<const MOST: usize>(reduction: Reduction, scalars: Vec<Scalar>) -> Formula {
    Box::new(move |view| {
        let mut numbers = [0.0; MOST];
        numbers.iter_mut().zip(&scalars).for_each(|(number, scalar)| *number = scalar.read(view));
        reduction.apply(&numbers[..scalars.len()])
    })
}

fn of_one(input: Scalar, function: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Formula {
    match input {
        Scalar::Frame(place) => Box::new(move |view| function(view.frame[place])),
        Scalar::Record(place) => Box::new(move |view| function(view.record[place])),
        Scalar::Constant(value) => Box::new(move |_| function(value)),
        Scalar::Formula(formula) => Box::new(move |view| function(formula(view))),
    }
}

fn of_two(left: Scalar, right: Scalar, function: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Formula {
    match left {
        Scalar::Frame(place) => of_second(move |view| view.frame[place], right, function),
        Scalar::Record(place) => of_second(move |view| view.record[place], right, function),
        Scalar::Constant(value) => of_second(move |_| value, right, function),
        Scalar::Formula(formula) => of_second(move |view| formula(view), right, function),
    }
}

fn of_second(
    left: impl Fn(&View<'_>) -> f64 + Send + Sync + 'static,
    right: Scalar,
    function: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
) -> Formula {
    match right {
        Scalar::Frame(place) => Box::new(move |view| function(left(view), view.frame[place])),
        Scalar::Record(place) => Box::new(move |view| function(left(view), view.record[place])),
        Scalar::Constant(value) => Box::new(move |view| function(left(view), value)),
        Scalar::Formula(formula) => Box::new(move |view| function(left(view), formula(view))),
    }
}
