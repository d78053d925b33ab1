//! Adding bodies, joints, shapes and sites to a model.

use super::assembly;
use crate::model::inertia::{MassProperties, combine, moments};
use crate::model::rotation::{self, IDENTITY};
use crate::model::{GeomKind, HeightField, JointKind, Model, Quaternion, Softness};
use nalgebra::Vector3;

/// What cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// A name that two things of a kind share.
    #[error("there are two {kind}s with the name `{name}`")]
    Twice {
        /// Kind of thing.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A number that is not finite, or a size that is not positive.
    #[error("the {what} of `{name}` is {value}; {expected}")]
    Number {
        /// Name of the thing.
        name: String,
        /// Which of its numbers.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A joint that its body cannot have.
    #[error("body `{body}` cannot have the joint `{joint}`: {reason}")]
    Joint {
        /// The body.
        body: String,
        /// The joint.
        joint: String,
        /// Why not.
        reason: &'static str,
    },
    /// Shapes that can meet, without a way to compute where they touch.
    #[error("contact of {first:?} with {second:?} (`{names}`) is not supported; make one of them not solid")]
    Contact {
        /// Kind of the first shape.
        first: GeomKind,
        /// Kind of the second shape.
        second: GeomKind,
        /// Their names.
        names: String,
    },
    /// What the model as a whole cannot be.
    #[error("{0}")]
    Model(String),
}

/// A body to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewBody {
    /// Name, unique among the bodies.
    pub name: String,
    /// What carries it: a body of the model or one added before.
    pub parent: usize,
    /// Position in the parent's frame, m.
    pub position: Vector3<f64>,
    /// Orientation in the parent's frame.
    pub orientation: Quaternion,
}

impl Default for NewBody {
    fn default() -> Self {
        Self { name: String::new(), parent: 0, position: Vector3::zeros(), orientation: IDENTITY }
    }
}

/// A joint to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewJoint {
    /// Name, unique among the joints.
    pub name: String,
    /// Kind.
    pub kind: JointKind,
    /// Axis in the body's frame, of any length; without meaning for ball and free joints.
    pub axis: Vector3<f64>,
    /// Anchor in the body's frame, m; free joints have none.
    pub anchor: Vector3<f64>,
    /// Range, rad or m.
    pub range: Option<[f64; 2]>,
    /// Damping, N m s/rad or N s/m.
    pub damping: f64,
    /// Stiffness, N m/rad or N/m.
    pub stiffness: f64,
    /// Friction loss, N m or N.
    pub friction_loss: f64,
}

impl Default for NewJoint {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: JointKind::Hinge,
            axis: Vector3::z(),
            anchor: Vector3::zeros(),
            range: None,
            damping: 0.0,
            stiffness: 0.0,
            friction_loss: 0.0,
        }
    }
}

/// A shape to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewGeom {
    /// Name, unique among the shapes.
    pub name: String,
    /// Kind; not a mesh.
    pub kind: GeomKind,
    /// Size as the kind says, m; without meaning for height fields.
    pub size: Vector3<f64>,
    /// The heights of a height field.
    pub heights: Option<HeightField>,
    /// Position in the body's frame, m.
    pub position: Vector3<f64>,
    /// Orientation in the body's frame.
    pub orientation: Quaternion,
    /// Mass, kg: spread evenly over the shape.
    pub mass: f64,
    /// Contact type bits.
    pub contact_type: u32,
    /// Contact affinity bits.
    pub contact_affinity: u32,
    /// Contact dimension: 1, 3, 4 or 6.
    pub contact_dimension: u8,
    /// Sliding, torsional (m) and rolling (m) friction.
    pub friction: [f64; 3],
    /// Softness of contacts.
    pub softness: Softness,
}

impl Default for NewGeom {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: GeomKind::Sphere,
            size: Vector3::zeros(),
            heights: None,
            position: Vector3::zeros(),
            orientation: IDENTITY,
            mass: 0.0,
            contact_type: 1,
            contact_affinity: 1,
            contact_dimension: 3,
            friction: [1.0, 0.005, 0.0001],
            softness: Softness::default(),
        }
    }
}

/// A marked point to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewSite {
    /// Name, unique among the sites.
    pub name: String,
    /// Position in the body's frame, m.
    pub position: Vector3<f64>,
    /// Orientation in the body's frame.
    pub orientation: Quaternion,
}

/// A model with what was added, and where everything is now.
///
/// Indices that stood for something in the [`SceneBuilder`] are positions in these lists.
#[derive(Debug, Clone, PartialEq)]
pub struct Built {
    /// The model.
    pub model: Model,
    /// Where each body is now.
    pub bodies: Vec<usize>,
    /// Where each joint is now.
    pub joints: Vec<usize>,
    /// Where each shape is now.
    pub geoms: Vec<usize>,
    /// Where each site is now.
    pub sites: Vec<usize>,
}

/// Adds bodies, joints, shapes and sites to a model.
///
/// What the model has keeps its index while building; what is added is numbered on from there. [`build`](Self::build) puts
/// everything into depth-first order and tells where it has gone. The result is what reading the same scene from a file
/// would give.
///
/// ```
/// use msk_runtime::model::{GeomKind, JointKind, Model};
/// use msk_runtime::scene::{NewBody, NewGeom, NewJoint, SceneBuilder};
/// use nalgebra::Vector3;
///
/// let room = Model::from_mjcf(r#"<mujoco><worldbody><geom name="floor" type="plane" size="0 0 1"/></worldbody></mujoco>"#)?;
/// let mut scene = SceneBuilder::new(&room);
/// let ball = scene.body(NewBody { name: "ball".into(), position: Vector3::new(0.0, 0.0, 1.0), ..NewBody::default() });
/// scene.joint(ball, NewJoint { name: "flight".into(), kind: JointKind::Free, ..NewJoint::default() });
/// let size = Vector3::new(0.11, 0.0, 0.0);
/// scene.geom(ball, NewGeom { name: "ball".into(), kind: GeomKind::Sphere, size, mass: 0.4, ..NewGeom::default() });
/// let built = scene.build()?;
/// assert_eq!((built.model.nq, built.model.bodies.mass[built.bodies[ball]]), (7, 0.4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneBuilder<'a> {
    pub(super) base: &'a Model,
    pub(super) bodies: Vec<NewBody>,
    /// With the bodies that carry them.
    pub(super) joints: Vec<(usize, NewJoint)>,
    pub(super) geoms: Vec<(usize, NewGeom)>,
    pub(super) sites: Vec<(usize, NewSite)>,
    /// Shapes of the model that nothing can touch any more.
    pub(super) intangible: Vec<usize>,
    /// New friction of shapes of the model.
    pub(super) frictions: Vec<(usize, [f64; 3])>,
}

impl<'a> SceneBuilder<'a> {
    /// Begins with a model.
    pub fn new(base: &'a Model) -> Self {
        Self {
            base,
            bodies: Vec::new(),
            joints: Vec::new(),
            geoms: Vec::new(),
            sites: Vec::new(),
            intangible: Vec::new(),
            frictions: Vec::new(),
        }
    }

    /// Adds a body; its index.
    pub fn body(&mut self, body: NewBody) -> usize {
        self.bodies.push(body);
        self.base.bodies.name.len() + self.bodies.len() - 1
    }

    /// Adds a joint to a body that was added before; its index. A body's joints act one after the other.
    pub fn joint(&mut self, body: usize, joint: NewJoint) -> usize {
        self.joints.push((body, joint));
        self.base.joints.name.len() + self.joints.len() - 1
    }

    /// Adds a shape to any body, the world (0) included; its index. A body's mass is that of the shapes added to it: bodies of
    /// the model keep theirs.
    pub fn geom(&mut self, body: usize, geom: NewGeom) -> usize {
        self.geoms.push((body, geom));
        self.base.geoms.name.len() + self.geoms.len() - 1
    }

    /// Adds a marked point to any body; its index.
    pub fn site(&mut self, body: usize, site: NewSite) -> usize {
        self.sites.push((body, site));
        self.base.sites.name.len() + self.sites.len() - 1
    }

    /// Lets nothing touch a shape of the model any more.
    pub fn make_intangible(&mut self, geom: usize) {
        self.intangible.push(geom);
    }

    /// Sets sliding, torsional (m) and rolling (m) friction of a shape of the model.
    pub fn set_friction(&mut self, geom: usize, friction: [f64; 3]) {
        self.frictions.push((geom, friction));
    }

    /// The model with everything that was added, all derived constants included.
    ///
    /// # Errors
    /// Numbers, names, joints or contacts that no model can have.
    pub fn build(&self) -> Result<Built, BuildError> {
        self.check()?;
        assembly::assemble(self)
    }

    /// Mass properties of an added body: those of its shapes together.
    pub(super) fn mass_properties(&self, body: usize) -> MassProperties {
        let solid = |geom: &NewGeom| MassProperties {
            mass: geom.mass,
            centre: geom.position,
            axes: geom.orientation,
            moments: moments(geom.kind, geom.size, geom.mass),
        };
        let own = self.geoms.iter().filter(|(owner, geom)| *owner == body && geom.mass > 0.0);
        let solids: Vec<MassProperties> = own.map(|(_, geom)| solid(geom)).collect();
        let none = MassProperties { mass: 0.0, centre: Vector3::zeros(), axes: IDENTITY, moments: Vector3::zeros() };
        combine(&solids).unwrap_or(none)
    }

    fn check(&self) -> Result<(), BuildError> {
        let base = self.base;
        unique("body", &base.bodies.name, self.bodies.iter().map(|body| &body.name))?;
        unique("joint", &base.joints.name, self.joints.iter().map(|(_, joint)| &joint.name))?;
        unique("shape", &base.geoms.name, self.geoms.iter().map(|(_, geom)| &geom.name))?;
        unique("site", &base.sites.name, self.sites.iter().map(|(_, site)| &site.name))?;
        self.bodies.iter().try_for_each(check_body)?;
        self.joints.iter().try_for_each(|(_, joint)| check_joint(joint))?;
        self.geoms.iter().try_for_each(|(_, geom)| check_geom(geom))?;
        self.sites.iter().try_for_each(|(_, site)| finite(&site.name, "position", site.position.iter()))?;
        (0..self.bodies.len()).try_for_each(|body| self.check_joints_of(body))
    }

    /// A free joint stands alone, on a child of the world; together joints have at most six degrees of freedom.
    fn check_joints_of(&self, added: usize) -> Result<(), BuildError> {
        let body = &self.bodies[added];
        let index = self.base.bodies.name.len() + added;
        let joints = || self.joints.iter().filter(|(owner, _)| *owner == index).map(|(_, joint)| joint);
        let refuse = |joint: &NewJoint, reason: &'static str| {
            Err(BuildError::Joint { body: body.name.clone(), joint: joint.name.clone(), reason })
        };
        let dofs: usize = joints().map(|joint| assembly::widths(joint.kind)[1]).sum();
        match (joints().find(|joint| joint.kind == JointKind::Free), joints().last()) {
            (Some(free), _) if joints().count() > 1 => refuse(free, "a free body has no other joints"),
            (Some(free), _) if body.parent != 0 => refuse(free, "only what the world carries can be free"),
            (None, Some(last)) if dofs > 6 => refuse(last, "its joints have more than six degrees of freedom together"),
            _ => Ok(()),
        }
    }
}

/// No two names but empty ones are the same.
fn unique<'n>(kind: &'static str, known: &'n [String], added: impl Iterator<Item = &'n String>) -> Result<(), BuildError> {
    let mut seen: std::collections::BTreeSet<&String> = known.iter().collect();
    for name in added {
        if !name.is_empty() && !seen.insert(name) {
            return Err(BuildError::Twice { kind, name: name.clone() });
        }
    }
    Ok(())
}

fn finite<'v>(name: &str, what: &'static str, mut values: impl Iterator<Item = &'v f64>) -> Result<(), BuildError> {
    /// Products of a few such numbers stay finite (the same bound as for files).
    const LARGEST: f64 = 1e30;
    match values.find(|value| !(value.abs() <= LARGEST)) {
        None => Ok(()),
        Some(&value) => {
            Err(BuildError::Number { name: name.into(), what, value, expected: "it must be a finite number of at most 1e30" })
        }
    }
}

fn not_negative(name: &str, what: &'static str, value: f64) -> Result<(), BuildError> {
    finite(name, what, [value].iter())?;
    if value >= 0.0 {
        return Ok(());
    }
    Err(BuildError::Number { name: name.into(), what, value, expected: "it must not be negative" })
}

fn rotation(name: &str, orientation: Quaternion) -> Result<(), BuildError> {
    if rotation::normalized(orientation) == Some(orientation) {
        return Ok(());
    }
    let value = orientation.iter().map(|part| part * part).sum::<f64>().sqrt();
    Err(BuildError::Number {
        name: name.into(),
        what: "length of the quaternion",
        value,
        expected: "orientations are unit quaternions",
    })
}

fn check_body(body: &NewBody) -> Result<(), BuildError> {
    finite(&body.name, "position", body.position.iter())?;
    rotation(&body.name, body.orientation)
}

fn check_joint(joint: &NewJoint) -> Result<(), BuildError> {
    let name = &joint.name;
    finite(name, "anchor", joint.anchor.iter())?;
    finite(name, "axis", joint.axis.iter())?;
    not_negative(name, "damping", joint.damping)?;
    not_negative(name, "stiffness", joint.stiffness)?;
    not_negative(name, "friction loss", joint.friction_loss)?;
    if rotation::unit_vector(joint.axis).is_none() {
        return Err(BuildError::Number {
            name: name.clone(),
            what: "axis' length",
            value: 0.0,
            expected: "it needs a direction",
        });
    }
    if let Some([low, high]) = joint.range {
        finite(name, "range", [low, high].iter())?;
        if low >= high {
            let expected = "its upper bound must lie above its lower bound";
            return Err(BuildError::Number { name: name.clone(), what: "range's upper bound", value: high, expected });
        }
    }
    Ok(())
}

fn check_geom(geom: &NewGeom) -> Result<(), BuildError> {
    let name = &geom.name;
    finite(name, "position", geom.position.iter())?;
    finite(name, "size", geom.size.iter())?;
    rotation(name, geom.orientation)?;
    not_negative(name, "mass", geom.mass)?;
    geom.friction.iter().try_for_each(|&friction| not_negative(name, "friction", friction))?;
    if geom.kind == GeomKind::Mesh {
        return Err(BuildError::Model(format!("shape `{name}`: meshes cannot be added")));
    }
    check_heights(name, geom)?;
    match geom.size.iter().take(size_count(geom.kind)).find(|size| **size <= 0.0) {
        None => Ok(()),
        Some(&value) => Err(BuildError::Number { name: name.clone(), what: "size", value, expected: "it must be positive" }),
    }
}

/// A height field has as many samples as its rows and columns say, at least two by two, between 0 and 1.
fn check_heights(name: &str, geom: &NewGeom) -> Result<(), BuildError> {
    let wrong = |what: &'static str, value: f64, expected: &'static str| {
        Err(BuildError::Number { name: name.into(), what, value, expected })
    };
    let Some(field) = &geom.heights else {
        return if geom.kind == GeomKind::HeightField {
            wrong("number of heights", 0.0, "a height field needs them")
        } else {
            Ok(())
        };
    };
    finite(name, "heights' samples", field.samples.iter())?;
    let count = field.samples.len();
    if field.rows < 2 || field.columns < 2 || field.rows.checked_mul(field.columns) != Some(count) {
        return wrong("number of heights", count as f64, "it must be rows times columns, at least 2 each");
    }
    if let Some(&sample) = field.samples.iter().find(|sample| !(0.0..=1.0).contains(*sample)) {
        return wrong("heights' sample", sample, "samples lie between 0 and 1");
    }
    match [field.radius[0], field.radius[1], field.elevation, field.base]
        .into_iter()
        .find(|extent| !(*extent > 0.0 && extent.is_finite()))
    {
        Some(extent) => wrong("extent of the heights", extent, "it must be positive"),
        None => Ok(()),
    }
}

/// How many sizes a kind has.
fn size_count(kind: GeomKind) -> usize {
    match kind {
        GeomKind::Plane | GeomKind::HeightField | GeomKind::Mesh => 0,
        GeomKind::Sphere => 1,
        GeomKind::Capsule | GeomKind::Cylinder => 2,
        GeomKind::Ellipsoid | GeomKind::Box => 3,
    }
}
