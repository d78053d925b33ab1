//! Formulas as mathematics: what a paper would print.
//!
//! [`mathematics`] writes a formula in plain characters, close to its text. For print, a formula first becomes a tree of
//! mathematics ([`Formula`], built by `build` with the symbols of `letters`), which `latex` and `mathml` write.

mod build;
mod latex;
mod letters;
mod mathml;
mod plain;
mod reads;

pub(crate) use build::{condition, formula, paid};
pub(crate) use latex::{latex, words as latex_words};
pub(crate) use mathml::{escaped, mathml};
pub(crate) use plain::mathematics;
pub(crate) use reads::names_in;

/// A tree of mathematics.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Formula {
    /// Digits.
    Number(String),
    /// A product of powers of units: name, numerator and denominator of the exponent.
    Unit(Vec<(String, i32, i32)>),
    /// Upright words.
    Words(String),
    /// A declared name with its side or number: `foot lead`, `l`.
    Name(String, String),
    /// A symbol of physics.
    Letter(Letter),
    /// One after the other.
    Row(Vec<Formula>),
    /// An operator.
    Sign(Sign),
    Fraction(Box<Formula>, Box<Formula>),
    Power(Box<Formula>, Box<Formula>),
    Fence(Fence, Box<Formula>),
    Root(Box<Formula>),
    /// A function with its arguments.
    Call(String, Vec<Formula>),
    /// Values with their conditions, and what holds otherwise.
    Cases(Vec<(Formula, Formula)>, Box<Formula>),
    /// Something with words below.
    Below(Box<Formula>, String),
}

/// A symbol such as the velocity of the pelvis along z.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Letter {
    /// A letter, or the name of a Greek one.
    pub symbol: &'static str,
    /// Whether it is a vector.
    pub bold: bool,
    /// Dots above: derivatives.
    pub dots: u8,
    /// Words below, joined by commas.
    pub below: Vec<String>,
    /// A word above.
    pub above: &'static str,
}

/// Brackets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fence {
    Round,
    Square,
    Absolute,
    Norm,
    /// The indicator of a condition: 1 where it holds.
    Indicator,
}

/// Operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sign {
    Plus,
    Minus,
    Times,
    Slash,
    And,
    Or,
    Not,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    Comma,
    /// From one number to another.
    To,
    Sum,
}
