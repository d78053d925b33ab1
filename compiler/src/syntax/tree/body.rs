//! Bodies and suites.

use super::{Assignment, Docs, Element, Expr, Ident, Name, Text};
use crate::diagnostics::Span;

/// `body human { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// In the order of the text.
    pub statements: Vec<BodyStatement>,
    /// The declaration.
    pub span: Span,
}

/// A statement of a body.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyStatement {
    /// `model "models/human416.xml"`
    Model(Text),
    /// `excitation linear`, `tendons rigid`
    Setting {
        /// Which.
        name: Ident,
        /// To what.
        value: Ident,
    },
    /// `root "Full Body" { forward -y, up z }`, `landmark ankle_{l,r} { ... }`
    Element(Element),
    /// `joint shoulder_elevation_r = shoulder_elv`, `joints legs = [...]`, `muscles calves = [...]`, `landmarks feet = [...]`,
    /// `family calves "Calves" = [...]`
    Group(BodyGroup),
    /// `pose squatting { knee_angle_{l,r} = 80 deg }`
    Pose(BodyPose),
}

/// A named set of a body, or an alias for one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyGroup {
    /// Documentation.
    pub docs: Option<Docs>,
    /// `joint`, `joints`, `muscle`, `muscles`, `landmarks` or `family`.
    pub kind: Ident,
    /// Name in tasks.
    pub name: Name,
    /// Name in print: `"Calves"`.
    pub title: Option<Text>,
    /// A name, a quoted name or a list of them.
    pub members: Expr,
    /// The statement.
    pub span: Span,
}

/// `pose squatting { knee_angle_{l,r} = 80 deg }`
#[derive(Debug, Clone, PartialEq)]
pub struct BodyPose {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// Joints not named stay at zero.
    pub joints: Vec<Assignment>,
    /// The statement.
    pub span: Span,
}

/// `suite msk_bench { ... }`
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// `family stabilization { stand }`, in order.
    pub families: Vec<Family>,
    /// `protocol quick { episodes 5, seed 0 }`, in order.
    pub protocols: Vec<Protocol>,
    /// The declaration.
    pub span: Span,
}

/// `protocol quick { episodes 5, seed 0 }`
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    /// Its name; the only protocol of a suite needs none.
    pub name: Option<Ident>,
    /// Its settings.
    pub settings: Element,
}

/// `family stabilization { stand, sit }`
#[derive(Debug, Clone, PartialEq)]
pub struct Family {
    /// Documentation.
    pub docs: Option<Docs>,
    /// Its name.
    pub name: Ident,
    /// Its tasks, in order.
    pub tasks: Vec<Ident>,
    /// The statement.
    pub span: Span,
}
