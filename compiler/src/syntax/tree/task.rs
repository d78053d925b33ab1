//! Declarations of tasks and what they share: bindings, functions, observations.

use super::{Docs, Element, Expr, Field, Ident, InitStatement, Name, SceneStatement, Test, Text};
use crate::diagnostics::{FileId, Span};
use std::sync::Arc;

/// `use "lib/posture.msk"`
#[derive(Debug, Clone, PartialEq)]
pub struct Use {
    /// Relative to the file that uses it.
    pub path: Text,
    /// The statement.
    pub span: Span,
}

/// `let x: length = ...` or `const x = ...`
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    /// Documentation.
    pub docs: Option<Docs>,
    /// The name it binds.
    pub name: Ident,
    /// The optional annotation: `length`, `int`, `vec3`, ...
    pub annotation: Option<Ident>,
    /// What it stands for.
    pub value: Expr,
    /// The statement.
    pub span: Span,
}

/// `fn bell(x, width) = exp(-(x / width)^2)`
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// In order.
    pub parameters: Vec<Parameter>,
    /// The optional annotation of the result.
    pub annotation: Option<Ident>,
    /// The formula.
    pub body: Expr,
    /// The statement.
    pub span: Span,
}

/// A parameter of a function.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: Ident,
    /// The optional annotation.
    pub annotation: Option<Ident>,
}

/// `observation proprioception { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// What it holds.
    pub channels: Vec<Entry<Channel>>,
    /// The statement.
    pub span: Span,
}

/// `task stand extends quiet { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// The task it overrides.
    pub extends: Option<Ident>,
    /// In the order of the text.
    pub statements: Vec<TaskStatement>,
    /// The declaration.
    pub span: Span,
}

/// `sequence carry_and_sit { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// In the order of the text; phases are among them.
    pub statements: Vec<TaskStatement>,
    /// The declaration.
    pub span: Span,
}

/// A line of a list that an extending task may override, or whose lints may be allowed.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry<T> {
    /// The line itself.
    Item(T),
    /// `remove gait`
    Remove(Remove),
    /// `allow dead_term "pays only in phase 2"`: for the entry below.
    Allow(Allow),
}

/// `remove gait`
#[derive(Debug, Clone, PartialEq)]
pub struct Remove {
    /// What is left out.
    pub name: Name,
    /// The statement.
    pub span: Span,
}

/// `allow dead_term "pays only in phase 2"`
#[derive(Debug, Clone, PartialEq)]
pub struct Allow {
    /// Name of the lint.
    pub lint: Ident,
    /// Why it does not matter here.
    pub reason: Text,
    /// The statement.
    pub span: Span,
}

/// A statement of a task or a sequence.
#[derive(Debug, Clone, PartialEq)]
pub enum TaskStatement {
    /// `family stabilization`
    Family(Ident),
    /// `body human with core.peak_force *= 3`
    Body(BodyUse),
    /// `control 100 Hz`
    Control(Expr),
    /// `horizon 1000 steps`
    Horizon(Expr),
    /// `act cmc { joints legs, range 0.5 rad }`
    Act(Act),
    /// `symmetric`
    Symmetric(Span),
    /// `params { ... }`
    Params(Block<Entry<TaskParameter>>),
    /// `scene { ... }`
    Scene(Block<SceneStatement>),
    /// `init { ... }`
    Init(Block<InitStatement>),
    /// `observe { ... }`
    Observe(Block<Entry<Channel>>),
    /// `critic { ... }`
    Critic(Block<Entry<Channel>>),
    /// `reward { ... }`
    Reward(Reward),
    /// `metrics { ... }`
    Metrics(Block<Entry<Channel>>),
    /// `terminate after 20 steps { ... }`
    Terminate(Ends),
    /// `finish { ... }`
    Finish(Ends),
    /// `success survived`
    Success(Expr),
    /// `let lean = ...`
    Let(Binding),
    /// `state passed: int = 0 becomes passed + 1 when reached`
    State(StateDeclaration),
    /// `clock phase at 1.1 Hz`
    Clock(Clock),
    /// `random target = uniform(...) where ... redraw when ...`
    Random(Random),
    /// `reference gait = motion "gait" start uniform`
    Reference(Reference),
    /// `disturb pelvis { force [50 N, 0, 0], at 3 s, for 0.1 s }`
    Disturb(Element),
    /// `phase walk until at_bar`: only in a sequence
    Phase(Phase),
    /// `test "a fall ends the episode" { ... }` and `cheat "heel raises" { ... }`: shared, since they are the larger part of a task, and
    /// what inherits and sequences copy are statements.
    Test(Arc<Test>),
    /// `allow unobserved "..."`
    Allow(Allow),
}

/// `act synergies { of [quads_l, quads_r], filter 50 ms }`
#[derive(Debug, Clone, PartialEq)]
pub struct Act {
    /// The word `act`.
    pub keyword: Span,
    /// What the entries of an action stand for.
    pub target: Ident,
    /// In the order of the text.
    pub fields: Vec<Field>,
    /// The statement.
    pub span: Span,
}

/// A block in braces.
#[derive(Debug, Clone, PartialEq)]
pub struct Block<T> {
    /// The word before the brace.
    pub keyword: Span,
    /// In the order of the text.
    pub entries: Vec<T>,
    /// From the word to the closing brace.
    pub span: Span,
}

/// `body human with core.peak_force *= 3, calves.peak_force = 2000 N`
#[derive(Debug, Clone, PartialEq)]
pub struct BodyUse {
    /// Which body.
    pub name: Ident,
    /// What is changed on it.
    pub edits: Vec<BodyEdit>,
    /// The statement.
    pub span: Span,
}

/// `core.peak_force *= 3`
#[derive(Debug, Clone, PartialEq)]
pub struct BodyEdit {
    /// What is changed.
    pub target: Expr,
    /// `*=` rather than `=`.
    pub scales: bool,
    /// By or to what.
    pub value: Expr,
}

/// `speed: velocity = 1.3 m/s (0.5..2 m/s) per episode`
#[derive(Debug, Clone, PartialEq)]
pub struct TaskParameter {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// The optional annotation.
    pub annotation: Option<Ident>,
    /// The value unless set from outside.
    pub value: Expr,
    /// What it may be set to: a `Range`.
    pub range: Option<Expr>,
    /// `per episode`: whether a caller may set it for every episode.
    pub per_episode: Option<Span>,
    /// What extending tasks, and in the end the outside, set it to: the last holds. Never filled by the parser.
    pub set: Vec<(Expr, FileId)>,
    /// The statement.
    pub span: Span,
}

/// A line of `observe`, `metrics` or an observation: `torso.orientation`, `lean = torso.up.x`
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Documentation.
    pub docs: Option<Docs>,
    /// The label before `=`.
    pub label: Option<Ident>,
    /// What is observed.
    pub value: Expr,
    /// What lies between the value and the policy, in order.
    pub settings: Vec<ChannelSetting>,
    /// The statement.
    pub span: Span,
}

/// `noise normal(0, 1 cm)`, `delay 2 steps`, `history 3`, `scale 0.3 rad`, `clip -5 .. 5`
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSetting {
    /// Its word.
    pub word: Ident,
    /// What follows.
    pub value: Expr,
    /// The whole setting.
    pub span: Span,
}

/// `reward { ... }` or `reward per second { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Reward {
    /// Whether the terms are rates, multiplied by the control step.
    pub per_second: bool,
    /// The terms.
    pub terms: Vec<Entry<Term>>,
    /// The statement.
    pub span: Span,
}

/// `15 (5..30) stillness = exp(-10 s/m * com.speed)`
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its weight; an extending task may leave it out.
    pub weight: Option<Weight>,
    /// Its name.
    pub name: Ident,
    /// Its formula; an extending task may leave it out.
    pub formula: Option<Expr>,
    /// The statement.
    pub span: Span,
}

/// The weight of a term: `15 (5..30)`, `-0.01`, `5 (fixed)`, `10 -> 5 over 30 %`
#[derive(Debug, Clone, PartialEq)]
pub struct Weight {
    /// How it comes to be what it is at the end of a training.
    pub schedule: Option<Schedule>,
    /// With its sign; of a scheduled weight the last one.
    pub value: f64,
    /// The sign and the digits, for edits that change nothing else.
    pub span: Span,
    /// In which file: an override of the weight alone may stand in another than the formula.
    pub file: FileId,
    /// What a tuner may do.
    pub bounds: Bounds,
}

/// How a weight changes during a training: `10 -> ... over 20 % .. 50 %`
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// The weight at the beginning, with its sign.
    pub from: f64,
    /// The sign and the digits of that.
    pub from_span: Span,
    /// The share of the training until which it stays; the beginning if left out.
    pub begin: Option<Expr>,
    /// The share from which it is the last one.
    pub end: Expr,
    /// From the arrow to the last share.
    pub span: Span,
}

/// What a tuner may do with a weight.
#[derive(Debug, Clone, PartialEq)]
pub enum Bounds {
    /// Anything that keeps the sign.
    Free,
    /// Nothing: `(fixed)`.
    Fixed(Span),
    /// `(5..30)`
    Range {
        /// Lowest weight.
        low: f64,
        /// Highest weight.
        high: f64,
        /// From bracket to bracket.
        span: Span,
    },
}

/// `terminate after 20 steps { ... }` or `finish { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Ends {
    /// `after 20 steps`
    pub after: Option<Expr>,
    /// The reasons.
    pub reasons: Vec<Entry<Reason>>,
    /// The statement.
    pub span: Span,
}

/// `fallen when com.height < 0.8 m`, `arrived bootstrap when reached`
#[derive(Debug, Clone, PartialEq)]
pub struct Reason {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// `bootstrap`: whether a learner values what would have followed.
    pub bootstrap: Option<Span>,
    /// When it holds.
    pub condition: Expr,
    /// The statement.
    pub span: Span,
}

/// `state passed: int = 0 becomes passed + 1 when reached`
#[derive(Debug, Clone, PartialEq)]
pub struct StateDeclaration {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// The optional annotation.
    pub annotation: Option<Ident>,
    /// At reset.
    pub initial: Expr,
    /// The first whose condition holds is taken.
    pub updates: Vec<Update>,
    /// The statement.
    pub span: Span,
}

/// `becomes passed + 1 when reached`
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// The new value.
    pub value: Expr,
    /// When; always if left out.
    pub condition: Option<Expr>,
    /// The clause.
    pub span: Span,
}

/// `clock phase at 1.1 Hz`
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// Turns per second.
    pub frequency: Expr,
    /// The statement.
    pub span: Span,
}

/// `random target = uniform(0 m .. 1 m) where accepted redraw when touched`
#[derive(Debug, Clone, PartialEq)]
pub struct Random {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// The optional annotation.
    pub annotation: Option<Ident>,
    /// What is drawn.
    pub distribution: Expr,
    /// Draws are repeated until it holds.
    pub accept: Option<Expr>,
    /// When it is drawn anew.
    pub redraw: Option<Expr>,
    /// The statement.
    pub span: Span,
}

/// `reference gait = motion "gait" start uniform`
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// Name of the motion.
    pub motion: Text,
    /// Where in it an episode starts.
    pub start: Option<Expr>,
    /// The statement.
    pub span: Span,
}

/// `phase walk until at_bar`
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Which task.
    pub task: Ident,
    /// When the next phase begins.
    pub until: Option<Expr>,
    /// The statement.
    pub span: Span,
}
