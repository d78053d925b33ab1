//! What an expression may stand for while it is checked.

use super::types::Type;
use crate::graph::NodeId;

/// A value that the graph computes.
#[derive(Debug, Clone, PartialEq)]
pub struct TypedValue {
    /// Which node.
    pub node: NodeId,
    /// Its type.
    pub kind: Type,
    /// How it was written.
    pub literal: LiteralKind,
}

/// How a value was written, where that decides what it may become.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LiteralKind {
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

impl TypedValue {
    /// A computed value.
    pub fn new(node: NodeId, kind: impl Into<Type>) -> Self {
        Self { node, kind: kind.into(), literal: LiteralKind::Plain }
    }

    /// The same, written so.
    pub fn with_literal(self, literal: LiteralKind) -> Self {
        Self { literal, ..self }
    }

    /// Whether it is written as a bracket of numbers.
    pub fn is_bracket(&self) -> bool {
        matches!(self.literal, LiteralKind::Bracket | LiteralKind::ZeroBracket)
    }

    /// Whether any dimension will do.
    pub fn is_zero(&self) -> bool {
        matches!(self.literal, LiteralKind::Zero | LiteralKind::ZeroBracket)
    }
}

/// A reference to an entity: a part of the body or of the scene that has properties.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EntityRef {
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
    Typed(TypedValue),
    /// One part of the body or of the scene.
    Entity(EntityRef),
    /// Several: properties map over them.
    Entities {
        /// In order.
        members: Vec<EntityRef>,
        /// Whether contact functions count them as one.
        group: bool,
    },
}
