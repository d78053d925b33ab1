//! Scenes and how an episode begins: elements with fields, connections, poses, noise.

use super::{Allow, Docs, Expr, Ident, Name, Remove, Text};
use crate::diagnostics::Span;

/// A statement of `scene`.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneStatement {
    /// `ground`, `box seat { ... }`, `body door { ... }`, `stairs flight { ... }`
    Element(Element),
    /// `weld wrist_l to rack.grip_l here`
    Connection(Connection),
    /// `group poles = pole_{*}`
    Group(Group),
    /// `marker goal at target`
    Marker(Marker),
    /// `repeat i in 0..10 { ... }`
    Repeat(Repeat),
    /// `remove pole_3`
    Remove(Remove),
    /// `allow ...`
    Allow(Allow),
}

/// `box seat { size [0.45 m, 0.50 m, 0.04 m], at [-0.40 m, 0, 0.45 m] }`: a kind, a name, fields and parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Documentation.
    pub docs: Option<Docs>,
    /// `box`, `body`, `hinge`, `ground`, `landmark`, ...
    pub kind: Ident,
    /// Its name.
    pub name: Option<ElementName>,
    /// `on chest`: what it is a rigid child of.
    pub on: Option<Expr>,
    /// In the order of the text.
    pub fields: Vec<Field>,
    /// Elements inside its braces.
    pub parts: Vec<Element>,
    /// The statement.
    pub span: Span,
}

/// A name, or a quoted name of the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ElementName {
    /// `seat`, `pole_{i}`
    Name(Name),
    /// `"Full Body"`
    Quoted(Text),
}

impl ElementName {
    /// Where it stands.
    pub fn span(&self) -> Span {
        match self {
            Self::Name(name) => name.span,
            Self::Quoted(text) => text.span,
        }
    }
}

/// `mass 2 kg`, `walkable`, `height on ground`, `forward -y`
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Its word; any word may be one.
    pub name: Ident,
    /// What follows; nothing for a flag.
    pub value: FieldValue,
    /// The whole field.
    pub span: Span,
}

/// `align palm_l to rack.grip_l`, `align palm_l to rack.grip_l with arms`
#[derive(Debug, Clone, PartialEq)]
pub struct Align {
    /// A place of the body or of an object.
    pub place: Expr,
    /// Where it shall be.
    pub target: Expr,
    /// The joints that bring it there; without them, what owns the place is moved.
    pub joints: Option<Expr>,
    /// The field.
    pub span: Span,
}

/// What follows the word of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldValue {
    /// Nothing: `free`, `walkable`
    Flag,
    /// `mass 2 kg`, `range 0 deg .. 90 deg`
    Value(Expr),
    /// `height on ground`
    On(Expr),
    /// `align palm_l to rack.grip_l`: the root or the object is moved until they coincide.
    Align(Align),
    /// `from [..] to [..]`
    FromTo {
        /// First end.
        from: Expr,
        /// Second end.
        to: Expr,
    },
}

/// `weld wrist_l to rack.grip_l here release when let_go`
#[derive(Debug, Clone, PartialEq)]
pub struct Connection {
    /// `weld` or `connect`.
    pub kind: Ident,
    /// What is held.
    pub from: Expr,
    /// To what.
    pub to: Expr,
    /// Whether the present offset is kept.
    pub here: bool,
    /// When it lets go.
    pub release: Option<Expr>,
    /// The statement.
    pub span: Span,
}

/// `group poles = pole_{*}`
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// Its members.
    pub members: Expr,
    /// The statement.
    pub span: Span,
}

/// `marker goal at target`
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// Its name.
    pub name: Name,
    /// Where it is shown.
    pub at: Expr,
    /// The statement.
    pub span: Span,
}

/// `repeat i in 0..10 { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Repeat {
    /// The loop variable.
    pub variable: Ident,
    /// A `Range`.
    pub range: Expr,
    /// What is repeated.
    pub statements: Vec<SceneStatement>,
    /// The statement.
    pub span: Span,
}

/// A statement of `init`.
#[derive(Debug, Clone, PartialEq)]
pub enum InitStatement {
    /// `pose hanging { elbow_flex_{l,r} = 20 deg }`
    Pose(PoseUse),
    /// `root { height on ground, heading 0 deg }`, `cube_target { velocity [-4 m/s, 0, 1 m/s] }`
    Object(Placement),
    /// `noise joints normal(0, 0.005 rad)`
    Noise(Noise),
    /// Strength or mass.
    Scaling(Scaling),
    /// `settle 50 ms with activation 0.2 at rest`
    Settle(Settle),
    /// `remove settle`
    Remove(Remove),
    /// `allow ...`
    Allow(Allow),
}

/// `pose hanging { elbow_flex_{l,r} = 20 deg }`
#[derive(Debug, Clone, PartialEq)]
pub struct PoseUse {
    /// Name of the pose.
    pub name: Ident,
    /// What differs from it.
    pub adjustments: Vec<Assignment>,
    /// The statement.
    pub span: Span,
}

/// `root { height on ground }`, `cube_target { velocity [-4 m/s, 0, 1 m/s] }`: where a thing starts and how fast.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// What is placed.
    pub object: Name,
    /// In the order of the text.
    pub fields: Vec<Field>,
    /// The statement.
    pub span: Span,
}

/// `elbow_flex_{l,r} = 20 deg`, `root.height = 0.5 m`
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// A name, a selector or a field.
    pub target: Expr,
    /// Its value.
    pub value: Expr,
    /// The whole assignment.
    pub span: Span,
}

/// `noise joints normal(0, 0.005 rad)`
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// On what.
    pub target: Expr,
    /// A call.
    pub distribution: Expr,
    /// The statement.
    pub span: Span,
}

/// `strength calves weak`, `mass robot uniform(0.9 .. 1.1)`
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// What is scaled.
    pub quantity: ScaledQuantity,
    /// Of what.
    pub target: Expr,
    /// A number, or a call of a distribution.
    pub factor: Expr,
    /// The statement.
    pub span: Span,
}

/// What an initial state scales.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScaledQuantity {
    /// The active force of muscles.
    Strength,
    /// Mass and inertia of segments.
    Mass,
    /// Damping of joints.
    Damping,
    /// Stiffness of joints.
    Stiffness,
}

impl ScaledQuantity {
    /// The word with which its statements begin.
    pub fn word(self) -> &'static str {
        match self {
            Self::Strength => "strength",
            Self::Mass => "mass",
            Self::Damping => "damping",
            Self::Stiffness => "stiffness",
        }
    }
}

/// `settle 50 ms with activation 0.2 at rest`
#[derive(Debug, Clone, PartialEq)]
pub struct Settle {
    /// For how long.
    pub duration: Expr,
    /// Activation of every muscle meanwhile.
    pub activation: Option<Expr>,
    /// Whether velocities are set to zero afterwards.
    pub at_rest: bool,
    /// The statement.
    pub span: Span,
}
