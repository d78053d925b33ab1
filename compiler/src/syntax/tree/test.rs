//! Tests inside files.

use super::{Expr, Ident, Placement, PoseUse, Text};
use crate::diagnostics::Span;

/// `test "a fall ends the episode" { ... }` or `cheat "heel raises" { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    /// What it shows.
    pub title: Text,
    /// Whether it is a way of cheating that must not succeed.
    pub cheat: bool,
    /// In the order of the text.
    pub statements: Vec<TestStatement>,
    /// The statement.
    pub span: Span,
}

/// A statement of a test.
#[derive(Debug, Clone, PartialEq)]
pub enum TestStatement {
    /// `pose neutral { root.height = 0.5 m }`
    Pose(PoseUse),
    /// `at 2 s pose squatting`: scripted motion
    Keyframe {
        /// When.
        time: Expr,
        /// In which pose.
        pose: PoseUse,
    },
    /// `cube_target { at [1 m, 0, 0] }`
    Object(Placement),
    /// `run zero for 2 s`
    Run {
        /// Name of the policy.
        policy: Ident,
        /// For how long; to the end if left out.
        duration: Option<Expr>,
        /// The statement.
        span: Span,
    },
    /// `expect ended by fallen`
    Expect {
        /// What must hold.
        condition: Expr,
        /// The statement.
        span: Span,
    },
}
