//! Tests inside files.

use super::{Align, Assignment, Expr, Ident, Placement, Text};
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
    /// `pose neutral { root.height = 0.5 m }`: how it begins
    Pose(Situation),
    /// `at 2 s pose squatting { root.at = [1 m, 0 m] } as low`: scripted motion
    Keyframe {
        /// When.
        time: Expr,
        /// In which pose; what is not set stays as it was.
        situation: Situation,
        /// The name of this moment.
        label: Option<Ident>,
        /// The statement.
        span: Span,
    },
    /// `cube_target { at [1 m, 0, 0] }`: how it begins
    Object(Placement),
    /// `repeat i in 0..10 { at i * 1 s pose neutral }`
    Repeat {
        /// Counts the copies.
        variable: Ident,
        /// From where to where.
        range: Expr,
        /// What is copied.
        statements: Vec<TestStatement>,
        /// The statement.
        span: Span,
    },
    /// `at 1 s play motion "walk.csv" start 0.5 for 2 s { root.heading = 90 deg } as there`: the body as a motion has it
    Play(Box<Playing>),
    /// `given target = [0.5 m, 0, 1 m]`: instead of chance
    Given {
        /// Which random.
        name: Ident,
        /// Its value.
        value: Expr,
        /// The statement.
        span: Span,
    },
    /// `until 2 s`: when it ends if the task does not end it
    Until {
        /// When.
        time: Expr,
        /// The statement.
        span: Span,
    },
    /// `moment low { pose squatting }`: an episode of its own, read at its end
    Moment {
        /// Its name.
        name: Ident,
        /// How it comes about.
        statements: Vec<TestStatement>,
        /// The statement.
        span: Span,
    },
    /// `run zero for 2 s`
    Run {
        /// Name of the policy.
        policy: Ident,
        /// For how long; to the end if left out.
        duration: Option<Expr>,
        /// The statement.
        span: Span,
    },
    /// `reset 50 times`: the initial state as the task draws it
    Reset {
        /// How many episodes; one if left out.
        times: Option<Expr>,
        /// The statement.
        span: Span,
    },
    /// `expect ended by fallen`
    Expect {
        /// What must hold.
        condition: Expr,
        /// At which moment; at the end if left out.
        moment: Option<Ident>,
        /// The statement.
        span: Span,
    },
}

/// A motion that is played.
#[derive(Debug, Clone, PartialEq)]
pub struct Playing {
    /// When it begins; with the episode if left out.
    pub time: Option<Expr>,
    /// What is played.
    pub motion: Played,
    /// From which phase.
    pub start: Option<Expr>,
    /// For how long.
    pub duration: Option<Expr>,
    /// What differs from the motion.
    pub situation: Situation,
    /// The name of the moment at which it ends.
    pub label: Option<Ident>,
    /// The statement.
    pub span: Span,
}

/// What is played.
#[derive(Debug, Clone, PartialEq)]
pub enum Played {
    /// `motion "walk.csv"`: a table
    File(Text),
    /// A reference of the task, at the phase that it then has.
    Reference(Ident),
}

/// A pose with changes to it, to the root and to objects.
#[derive(Debug, Clone, PartialEq)]
pub struct Situation {
    /// The pose to begin with; without one, what was before.
    pub pose: Option<Ident>,
    /// In the order of the text.
    pub changes: Vec<Change>,
    /// The text of it.
    pub span: Span,
}

/// A change of a situation.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// `knee_angle_r = 80 deg`, `root.height = 0.6 m`, `cube.at = [1 m, 0, 1 m]`, `activation = 0.2`
    Assign(Assignment),
    /// `align palm_l to rack.grip_l`
    Align(Align),
}
