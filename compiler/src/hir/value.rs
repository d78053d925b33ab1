//! What an expression may stand for while it is checked.

use super::types::Type;
use crate::graph::NodeId;

/// A value that the graph computes.
#[derive(Debug, Clone, PartialEq)]
pub struct Data {
    /// Which node.
    pub node: NodeId,
    /// Its type.
    pub kind: Type,
    /// How it was written.
    pub form: Form,
}

/// How a value was written, where that decides what it may become.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Form {
    /// In no such way.
    #[default]
    Plain,
    /// A bare `0`, which fits any dimension.
    Zero,
    /// A bracket, which becomes a vector where one is wanted.
    Bracket,
    /// A bracket with zeros only.
    ZeroBracket,
}

impl Data {
    /// A computed value.
    pub fn new(node: NodeId, kind: impl Into<Type>) -> Self {
        Self { node, kind: kind.into(), form: Form::Plain }
    }

    /// The same, written so.
    pub fn with_form(self, form: Form) -> Self {
        Self { form, ..self }
    }

    /// Whether it is written as a bracket of numbers.
    pub fn is_bracket(&self) -> bool {
        matches!(self.form, Form::Bracket | Form::ZeroBracket)
    }

    /// Whether any dimension will do.
    pub fn is_zero(&self) -> bool {
        matches!(self.form, Form::Zero | Form::ZeroBracket)
    }
}

/// Something of the body that has properties.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Thing {
    /// Index among the landmarks.
    Landmark(usize),
    /// Index among the joints.
    Joint(usize),
    /// Index among the muscles.
    Muscle(usize),
    /// The whole body's centre of mass.
    CentreOfMass,
    /// The ground.
    Ground,
    /// All shapes of the body itself.
    Robot,
}

/// What an expression stands for.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Numbers.
    Data(Data),
    /// One element of the body.
    Thing(Thing),
    /// Several: properties map over them.
    Things {
        /// In order.
        members: Vec<Thing>,
        /// Whether contact functions count them as one.
        group: bool,
    },
}
