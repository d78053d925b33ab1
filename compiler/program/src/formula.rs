//! Formulas as people read them: what explanations print, without the syntax that they were written in.

/// A formula as mathematics.
#[derive(Debug, Clone, PartialEq)]
pub struct Notation {
    /// In plain characters, close to its text.
    pub plain: String,
    /// For print.
    pub tree: Formula,
}

/// A tree of mathematics.
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
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
    /// One above the other.
    Fraction(Box<Formula>, Box<Formula>),
    /// Base and exponent.
    Power(Box<Formula>, Box<Formula>),
    /// Something within brackets.
    Fence(Fence, Box<Formula>),
    /// A square root.
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
pub struct Letter {
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
pub enum Fence {
    /// `(x)`
    Round,
    /// `[x]`
    Square,
    /// `|x|`
    Absolute,
    /// `‖x‖`
    Norm,
    /// The indicator of a condition: 1 where it holds.
    Indicator,
}

/// Operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Addition.
    Plus,
    /// Subtraction, or the sign of a number.
    Minus,
    /// Multiplication.
    Times,
    /// Division in a line.
    Slash,
    /// Both hold.
    And,
    /// One of them holds.
    Or,
    /// It does not hold.
    Not,
    /// `<`
    Less,
    /// `≤`
    LessEqual,
    /// `>`
    Greater,
    /// `≥`
    GreaterEqual,
    /// `=`
    Equal,
    /// `≠`
    NotEqual,
    /// Between arguments.
    Comma,
    /// From one number to another.
    To,
    /// The sum of a list.
    Sum,
}
