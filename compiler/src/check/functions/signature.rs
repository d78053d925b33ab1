//! Signatures: what every parameter of a function takes, in which shapes, and what the function gives.
//!
//! Calls are checked against these tables, and only against them: a function then computes nodes from arguments that are
//! already laid out alike. So no function decides by itself what it does with a list.

use super::apply::Bound;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::{Dimension, Rational};
use crate::check::types::{ElementType, Shape, Type};
use crate::emit::Emit;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Memory, Reduction, Unary};
use std::fmt;

/// What a parameter takes: each element of an argument must be one of these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Takes {
    /// A number of this dimension.
    Quantity(Dimension),
    /// A number of any dimension.
    Number,
    /// A number of any dimension, or control steps.
    Ordered,
    /// A number of any dimension, or a condition, which counts 0 or 1.
    Counted,
    /// What can be added up: numbers, conditions, vectors.
    Summed,
    /// What has a mean: what can be added up, and places.
    Averaged,
    /// What changes gradually: numbers, vectors, places.
    Gradual,
    /// A condition.
    Condition,
    /// An angle.
    Angle,
    /// A vector of two or three components.
    Vector,
    /// A vector of three components.
    Vector3,
    /// A place, or a part of the body that is at one.
    Place,
    /// An orientation.
    Rotation,
    /// Any computed value.
    Anything,
    /// A whole number of control steps known while compiling.
    Duration,
    /// A positive time known while compiling.
    TimeConstant,
}

/// In which shapes a parameter takes its argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    /// One, or a list: the function maps over lists, and one value meets every element of a list.
    Each,
    /// A list, of which the function makes one value.
    List,
    /// A list, or one, which stands for itself.
    OneOrList,
    /// One.
    One,
}

/// A parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// What its elements are.
    pub takes: Takes,
    /// In which shapes.
    pub shapes: Shapes,
    /// Whether its elements agree with those of the other parameters that are alike: in dimension and axes.
    pub alike: bool,
}

/// A parameter over which the function maps.
pub(super) const fn each(name: &'static str, takes: Takes) -> Parameter {
    Parameter { name, takes, shapes: Shapes::Each, alike: false }
}

/// A parameter over which the function maps, and which agrees with the others of its kind.
pub(super) const fn alike(name: &'static str, takes: Takes) -> Parameter {
    Parameter { name, takes, shapes: Shapes::Each, alike: true }
}

/// A parameter that is a list.
pub(super) const fn list(takes: Takes) -> Parameter {
    Parameter { name: "list", takes, shapes: Shapes::List, alike: false }
}

/// A parameter that is a single value.
pub(super) const fn one(name: &'static str, takes: Takes) -> Parameter {
    Parameter { name, takes, shapes: Shapes::One, alike: false }
}

/// What a function gives for every element of its subject: of the arguments that are alike, else of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gives {
    /// What the subject is.
    Same,
    /// The first, or the last, element of the subject.
    ElementAt {
        /// The last.
        last: bool,
    },
    /// A number of this dimension.
    Quantity(Dimension),
    /// A whole number.
    Whole,
    /// A condition.
    Condition,
    /// An angle that wraps.
    WrappingAngle,
    /// A number of the subject's dimension, which does not wrap.
    Magnitude,
    /// The subject without its sign, which does not wrap.
    Unsigned,
    /// The subject; whole numbers become plain ones.
    Blend,
    /// A sum: conditions become whole numbers.
    Sum,
    /// A mean: conditions and whole numbers become plain ones.
    Mean,
    /// The dimension's powers halved.
    Root,
    /// Over time: of places a vector.
    Rate,
    /// Times time.
    Integral,
    /// As many powers of the dimension as the list is long.
    Product,
    /// The product of the dimensions of two vectors: a number.
    Dot,
    /// The product of the dimensions of two vectors: a vector.
    Cross,
    /// A vector without unit.
    Direction,
}

/// How nodes that are laid out alike become the value.
pub(super) enum Computes {
    Unary(Unary),
    Binary(Binary),
    Memory(Memory),
    /// Of the whole list.
    Reduce(Reduction),
    /// By a formula of its own.
    Emits(Emit),
    /// By one that depends on what type checking finds of the values.
    Looks(for<'c, 'a> fn(&'c mut Checker<'a>, &Bound<'a>) -> Checked<NodeId>),
}

/// One way to call a function.
pub struct Signature {
    /// In order.
    pub parameters: &'static [Parameter],
    /// Whether the last parameter may be repeated.
    pub variadic: bool,
    /// The value's type.
    pub gives: Gives,
    pub(super) computes: Computes,
}

/// A signature of exactly these parameters.
pub(super) const fn of(parameters: &'static [Parameter], gives: Gives, computes: Computes) -> Signature {
    Signature { parameters, variadic: false, gives, computes }
}

/// A signature whose last parameter may be repeated.
pub(super) const fn repeated(parameters: &'static [Parameter], gives: Gives, computes: Computes) -> Signature {
    Signature { parameters, variadic: true, gives, computes }
}

impl Takes {
    /// Whether an element is one of these.
    pub(super) fn accepts(self, element: ElementType) -> bool {
        use ElementType as E;
        match self {
            Self::Quantity(dimension) => element.is_number() && element.dimension() == Some(dimension),
            Self::Number => element.is_number(),
            Self::Ordered => element.is_number() || element == E::Steps,
            Self::Counted => element.is_number() || element == E::Bool,
            Self::Summed => element.is_number() || matches!(element, E::Bool | E::Vector { .. }),
            Self::Averaged => element.is_number() || matches!(element, E::Bool | E::Vector { .. } | E::Place(_)),
            Self::Gradual => element.is_number() || matches!(element, E::Vector { .. } | E::Place(_)),
            Self::Condition => element == E::Bool,
            Self::Angle => element.is_number() && element.dimension() == Some(Dimension::ANGLE),
            Self::Vector => matches!(element, E::Vector { .. }),
            Self::Vector3 => matches!(element, E::Vector { size: 3, .. }),
            Self::Place => matches!(element, E::Place(_)),
            Self::Rotation => element == E::Rotation,
            Self::Anything => true,
            Self::Duration => matches!(element, E::Steps | E::Number(Dimension::TIME)),
            Self::TimeConstant => element == E::Number(Dimension::TIME),
        }
    }

    /// Whether a bracket of numbers is read as a vector or a place.
    pub(super) fn reads_brackets(self) -> bool {
        matches!(self, Self::Vector | Self::Vector3 | Self::Place)
    }

    /// Whether the argument is evaluated while compiling.
    pub(super) fn is_constant(self) -> bool {
        matches!(self, Self::Duration | Self::TimeConstant)
    }
}

impl fmt::Display for Takes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Quantity(dimension) => return formatter.write_str(&dimension.described()),
            Self::Number => "a number",
            Self::Ordered => "a number or control steps",
            Self::Counted => "a number or condition",
            Self::Summed => "a number, condition or vector",
            Self::Averaged => "a number, condition, vector or place",
            Self::Gradual => "a number, vector or place",
            Self::Condition => "a condition",
            Self::Angle => "an angle",
            Self::Vector => "a vector",
            Self::Vector3 => "a vector of three components",
            Self::Place => "a place",
            Self::Rotation => "an orientation",
            Self::Anything => "anything",
            Self::Duration => "a constant duration",
            Self::TimeConstant => "a constant positive time",
        })
    }
}

impl fmt::Display for Gives {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Same => "the type of its argument",
            Self::ElementAt { .. } => "that element",
            Self::Quantity(dimension) => return formatter.write_str(&dimension.described()),
            Self::Whole => "a whole number",
            Self::Condition => "a condition",
            Self::WrappingAngle => "an angle that wraps",
            Self::Magnitude => "a number of that dimension, which does not wrap",
            Self::Unsigned => "the type of its argument, without wrapping",
            Self::Blend => "the type of its argument, never whole",
            Self::Sum => "the type of its argument; of conditions a whole number",
            Self::Mean => "the type of its argument, never whole",
            Self::Root => "a number, half the powers of the dimension",
            Self::Rate => "the type of its argument per time; of places a vector",
            Self::Integral => "a number, times time",
            Self::Product => "a number, the power of the dimension by the length of the list",
            Self::Dot => "a number, the product of the dimensions",
            Self::Cross => "a vector, the product of the dimensions",
            Self::Direction => "a dimensionless vector",
        })
    }
}

impl Gives {
    /// The element that stands for one of the subject; nothing where its unit would grow beyond reason.
    fn element(self, subject: ElementType) -> Option<ElementType> {
        use ElementType as E;
        let dimension = subject.dimension().unwrap_or(Dimension::NONE);
        Some(match self {
            Self::Same | Self::ElementAt { .. } => subject,
            Self::Quantity(dimension) => E::Number(dimension),
            Self::Whole => E::Int,
            Self::Condition => E::Bool,
            Self::WrappingAngle => E::WrappingAngle,
            Self::Magnitude => E::Number(dimension),
            Self::Unsigned if subject == E::WrappingAngle => E::ANGLE,
            Self::Unsigned => subject,
            Self::Blend if subject == E::Int => E::PLAIN,
            Self::Blend => subject,
            Self::Sum if subject == E::Bool => E::Int,
            Self::Sum => subject,
            Self::Mean if matches!(subject, E::Bool | E::Int) => E::PLAIN,
            Self::Mean => subject,
            Self::Root => E::Number(dimension.power(Rational::new(1, 2)?)?),
            Self::Rate => match subject {
                E::Place(frame) => E::Vector { size: 3, dimension: Dimension::SPEED, frame },
                _ => subject.in_dimension(dimension.per(Dimension::TIME)?),
            },
            Self::Integral => E::Number(dimension.times(Dimension::TIME)?),
            Self::Product | Self::Dot => E::Number(dimension),
            Self::Cross => subject,
            Self::Direction => subject.in_dimension(Dimension::NONE),
        })
    }

    /// The type of the value, of the shape in which its arguments meet; of no shape where a list is made into one value.
    pub(super) fn kind(self, bound: &Bound<'_>, shape: Option<Shape>) -> Option<Type> {
        let Some(shape) = shape else {
            return self.of_list(&bound.kinds[0]).map(Type::One);
        };
        let mapped = match (self, bound.kinds.as_slice()) {
            (Self::Dot | Self::Cross, [left, right]) => left.zip(right, |a, b| {
                let dimension = a.dimension()?.times(b.dimension()?)?;
                Some(if self == Self::Dot { ElementType::Number(dimension) } else { a.in_dimension(dimension) })
            }),
            _ => bound.arguments.subject.map(|element| self.element(element)),
        }?;
        Some(match (mapped.shape(), shape) {
            (Shape::One, Shape::List(_)) => Type::new(mapped.element_at(0), shape),
            _ => mapped,
        })
    }

    /// The one value that is made of a list.
    fn of_list(self, list: &Type) -> Option<ElementType> {
        match self {
            Self::Product => {
                let power = Rational::new(i32::try_from(list.shape().count()).ok()?, 1)?;
                list.dimension().unwrap_or(Dimension::NONE).power(power).map(ElementType::Number)
            }
            Self::ElementAt { last: false } => Some(list.element_at(0)),
            Self::ElementAt { last: true } => Some(list.element_at(list.shape().count().saturating_sub(1))),
            _ => self.element(list.met()?),
        }
    }

    /// How an error calls a value whose unit grows beyond reason.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Rate => "rate",
            Self::Integral => "integral",
            Self::Root => "root",
            _ => "product",
        }
    }
}

impl Signature {
    pub(super) fn takes_so_many(&self, count: usize) -> bool {
        if self.variadic { count >= self.parameters.len() } else { count == self.parameters.len() }
    }

    /// What it takes, in the words of the reference: parameters of one kind together.
    pub(super) fn takes_in_words(&self) -> String {
        let alike = |a: &Parameter, b: &Parameter| (a.takes, a.shapes, a.alike) == (b.takes, b.shapes, b.alike);
        let groups = self.parameters.chunk_by(alike).map(|group| {
            let names: Vec<String> = group.iter().map(|parameter| format!("`{}`", parameter.name)).collect();
            let (names, takes) = (names.join(", "), group[0].takes);
            match group[0].shapes {
                Shapes::List => format!("{names}: a list, each element {takes}"),
                Shapes::OneOrList => format!("{names}: {takes}, or a list"),
                Shapes::One => format!("{names}: {takes}, never a list"),
                Shapes::Each if group[0].alike && group.len() > 1 => format!("{names}: each {takes}, of the same type"),
                Shapes::Each => format!("{names}: {takes}"),
            }
        });
        groups.collect::<Vec<_>>().join("; ")
    }

    pub(super) fn parameter(&self, place: usize) -> &Parameter {
        &self.parameters[place.min(self.parameters.len() - 1)]
    }
}
