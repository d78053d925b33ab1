//! Expressions: formulas, conditions, places, lists.

use super::{Ident, Name, Text};
use crate::diagnostics::{Reported, Span};

/// An expression.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands, blanks and comments around it excluded.
    pub span: Span,
}

/// The forms of an expression.
#[derive(Debug, Clone, PartialEq)]
pub enum ExprKind {
    /// `0.25 m`, `10 s/m`, `3`
    Number(Quantity),
    /// `true`, `false`
    Bool(bool),
    /// `"gait"`, and quoted element names in lists
    Text(String),
    /// `pelvis`, `ankle_{l,r}`
    Name(Name),
    /// `muscle "QL_post_I.1-L3_r"`, `muscles "glmax*"`
    Selector {
        /// `muscle`, `muscles`, `joint`, ...
        kind: Ident,
        /// The quoted name or pattern.
        pattern: Text,
    },
    /// `com.speed`, `rack.grip_{l,r}`
    Field {
        /// Left of the dot.
        base: Box<Expr>,
        /// Right of the dot; may be any word.
        name: Name,
    },
    /// `norm(x)`, `scan(heading, offsets, range = 2.5 m)`, `gait.q(knee)`
    Call {
        /// What is called: a name or a field.
        function: Box<Expr>,
        /// In order.
        arguments: Vec<Argument>,
    },
    /// `offsets[2]`
    Index {
        /// The list.
        base: Box<Expr>,
        /// The place in it.
        index: Box<Expr>,
    },
    /// `[1 m, 0, 0.9 m]`
    List(Vec<Expr>),
    /// `[f(i) for i in 0..10]`
    Comprehension {
        /// Evaluated for each value.
        element: Box<Expr>,
        /// The loop variable.
        variable: Ident,
        /// What it runs through: a `Range`, or a list.
        source: Box<Expr>,
    },
    /// `0.3 m .. 0.8 m`
    Range {
        /// Lower bound.
        low: Box<Expr>,
        /// Upper bound.
        high: Box<Expr>,
    },
    /// `(...)`
    Paren(Box<Expr>),
    /// `-x`, `not c`
    Unary {
        /// Which.
        operator: UnaryOperator,
        /// What it applies to.
        operand: Box<Expr>,
    },
    /// `a + b`, `a and b`, `a^2`
    Binary {
        /// Which.
        operator: BinaryOperator,
        /// Where the operator itself stands.
        operator_span: Span,
        /// Left.
        left: Box<Expr>,
        /// Right.
        right: Box<Expr>,
    },
    /// `a < b`, `0 < x < 1`: one more operand than operators, all in one direction.
    Compare {
        /// Two or more.
        operands: Vec<Expr>,
        /// Between them.
        operators: Vec<(CompareOperator, Span)>,
    },
    /// `v in pelvis`, `v in heading(pelvis)`
    InFrame {
        /// What is expressed anew.
        value: Box<Expr>,
        /// In which frame.
        frame: Frame,
    },
    /// `if a then b else if c then d else e`
    If {
        /// Conditions with their values, in order; at least one.
        branches: Vec<(Expr, Expr)>,
        /// After the last `else`.
        otherwise: Box<Expr>,
    },
    /// `x when c`: x where c holds, else zero.
    When {
        /// The value.
        value: Box<Expr>,
        /// When it counts.
        condition: Box<Expr>,
    },
    /// `ended by fallen`
    EndedBy(Ident),
    /// `reward.pose at squatting`: only in `expect`
    At {
        /// What is looked at.
        value: Box<Expr>,
        /// At which pose.
        pose: Ident,
    },
    /// What could not be read.
    Error(Reported),
}

/// A literal with its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The digits as a number, the unit not applied.
    pub value: f64,
    /// Whether it is written without point and exponent.
    pub whole: bool,
    /// The digits only.
    pub digits: Span,
    /// The unit expression.
    pub unit: Option<UnitExpr>,
}

/// `s^2/m^2`, flattened: a product of powers.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitExpr {
    /// As written.
    pub text: String,
    /// In the order of the text.
    pub factors: Vec<UnitFactor>,
    /// Where it stands.
    pub span: Span,
}

/// One unit word with its power; a division has negated it.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitFactor {
    /// `m`, `kg`, `%`, `steps`, ...
    pub name: String,
    /// Numerator of the exponent.
    pub numerator: i32,
    /// Denominator of the exponent, positive.
    pub denominator: i32,
    /// The word.
    pub span: Span,
}

/// An argument of a call.
#[derive(Debug, Clone, PartialEq)]
pub struct Argument {
    /// `range` in `range = 2.5 m`.
    pub name: Option<Ident>,
    /// Its value; may be a `Range`.
    pub value: Expr,
}

/// Right side of `in`.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The landmark, `world`, ...
    pub name: Name,
    /// Whether only its heading: `heading(pelvis)`.
    pub heading: bool,
    /// Where it stands.
    pub span: Span,
}

/// Prefix operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnaryOperator {
    /// `-`
    Negate,
    /// `not`
    Not,
}

/// Infix operators but for comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinaryOperator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `^`
    Power,
    /// `and`
    And,
    /// `or`
    Or,
}

pub use msk_program::testing::Comparison as CompareOperator;
