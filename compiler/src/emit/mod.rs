//! Emission: nodes of the graph for what type checking has decided.
//!
//! Nothing here can fail, and nothing looks at a text, at names or at a body: which operation, of which types, in which frame and
//! laid out for how many elements are arguments. `layout` brings values to one shape, the other files hold the formulas of the
//! language's functions, signals and statements, each by its topic.

pub(crate) mod channels;
pub(crate) mod draws;
pub(crate) mod elementary;
pub(crate) mod frames;
pub(crate) mod layout;
pub(crate) mod lists;
pub(crate) mod motion;
pub(crate) mod places;
pub(crate) mod signals;
pub(crate) mod temporal;
pub(crate) mod time;
pub(crate) mod vectors;

use crate::graph::{Graph, NodeId};
use crate::hir::types::Type;

/// The arguments of a call, laid out alike.
pub(crate) struct Arguments {
    /// Of each argument.
    pub nodes: Vec<NodeId>,
    /// The type of the arguments that are alike, else of the first.
    pub subject: Type,
    /// Elements of the first.
    pub length: usize,
    /// Lanes of an element of the first.
    pub lanes: usize,
    /// Length of a control step, s.
    pub interval: f64,
}

impl Arguments {
    /// All of them; a signature and what it emits name equally many.
    fn take<const COUNT: usize>(&self) -> [NodeId; COUNT] {
        debug_assert_eq!(self.nodes.len(), COUNT);
        std::array::from_fn(|place| self.nodes[place])
    }
}

/// What a function emits for its arguments.
pub(crate) type Emit = fn(&mut Graph, &Arguments) -> NodeId;
