//! Debug information of a compiled task: what explanations, snapshots and lints need beyond what runs.

use crate::formula::Notation;
use crate::graph::NodeId;
use crate::graph::interval::Bounds;
use crate::source::{FileId, Span};
use crate::spoken::SpokenUnit;

/// What explanations and snapshots need beyond what runs.
#[derive(Debug, Clone, Default)]
pub struct DebugInfo {
    /// Per term.
    pub terms: Vec<TermDebug>,
    /// Per reason of `terminate`.
    pub terminations: Vec<ConditionDebug>,
    /// Per reason of `finish`.
    pub finishes: Vec<ConditionDebug>,
    /// Per channel of the phase's own.
    pub channels: Vec<ChannelDebug>,
    /// Per metric.
    pub metrics: Vec<ChannelDebug>,
    /// When the next phase begins.
    pub until: Option<ConditionDebug>,
    /// When the task has succeeded.
    pub success: Option<ConditionDebug>,
    /// Comparisons in formulas.
    pub comparisons: Vec<Compared>,
    /// Between which values each term stays.
    pub term_bounds: Vec<Bounds>,
    /// Names of the declared states.
    pub states: Vec<String>,
    /// What `let` names, in the order in which it was checked.
    pub lets: Vec<NamedValue>,
    /// What formulas name and the task or its libraries declare; what is read stands before its readers.
    pub definitions: Vec<Definition>,
}

/// A term.
#[derive(Debug, Clone)]
pub struct TermDebug {
    /// Its formula.
    pub formula: Notation,
    /// Its documentation: the first paragraph.
    pub docs: String,
    /// Signals and declared names in it.
    pub reads: Vec<String>,
    /// Whether the formula is a condition, which counts 0 or 1.
    pub condition: bool,
    /// Whether the formula shows by itself that it does not always contribute: it is gated.
    pub gated: bool,
    /// Whether it counts per second, so that it is multiplied by the control step.
    pub per_second: bool,
}

/// A condition.
#[derive(Debug, Clone)]
pub struct ConditionDebug {
    /// As written.
    pub source: String,
    /// Its formula.
    pub formula: Notation,
    /// Its documentation: the first paragraph.
    pub docs: String,
    /// The time from reset before which it does not count, as written; empty if it always does.
    pub after: String,
}

/// A channel or a metric.
#[derive(Debug, Clone)]
pub struct ChannelDebug {
    /// Its formula.
    pub formula: Notation,
    /// Its documentation: the first paragraph.
    pub docs: String,
    /// The block of a library that it comes from; empty if it is the task's own.
    pub block: String,
    /// What lies between the formula and the policy, as it is written; empty if nothing does.
    pub settings: String,
}

/// A declaration that formulas name.
#[derive(Debug, Clone)]
pub struct Definition {
    /// `let`, `const`, `fn`, `state`, `clock`, `random`, `params`, `reference`.
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// Of a function.
    pub parameters: Vec<String>,
    /// Its formula, or several with a word before each: `becomes`, `where`.
    pub parts: Vec<(&'static str, Notation)>,
    /// Its documentation: the first paragraph.
    pub docs: String,
}

/// A value with a name of the task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedValue {
    /// Its name.
    pub name: String,
    /// What computes it.
    pub node: NodeId,
    /// Unit, as printed; empty for plain numbers.
    pub unit: String,
}

/// A comparison as it stands in a text, for those who look whether anything reaches it.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The condition.
    pub node: NodeId,
    /// What is compared, in the order of the text.
    pub sides: [NodeId; 2],
    /// In which file it stands.
    pub file: FileId,
    /// And where there.
    pub span: Span,
    /// Of both sides.
    pub unit: SpokenUnit,
}
