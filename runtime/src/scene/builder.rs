//! Adding bodies, joints, shapes and sites to a model.

use super::assembly;
use super::check::BuildError;
use super::elements::{NewAttachment, NewBody, NewGeom, NewJoint, NewSite};
use msk_physics::model::Model;
use msk_physics::model::inertia::{MassProperties, combine, moments};
use msk_physics::model::rotation::IDENTITY;
use nalgebra::Vector3;

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
/// use msk_physics::model::{GeomKind, JointKind, Model};
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
    pub(super) attachments: Vec<NewAttachment>,
    /// Shapes of the model that nothing can touch any more.
    pub(super) intangible: Vec<usize>,
    /// New friction of shapes of the model, and their priority.
    pub(super) frictions: Vec<(usize, [f64; 3], i32)>,
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
            attachments: Vec::new(),
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

    /// Holds two sites together; the index of the equality, which it keeps.
    pub fn attach(&mut self, attachment: NewAttachment) -> usize {
        self.attachments.push(attachment);
        self.base.equalities.name.len() + self.attachments.len() - 1
    }

    /// The body that carries a site.
    pub(super) fn carrier_of(&self, site: usize) -> usize {
        self.base.sites.body.get(site).copied().unwrap_or_else(|| self.sites[site - self.base.sites.body.len()].0)
    }

    /// Lets nothing touch a shape of the model any more.
    pub fn make_intangible(&mut self, geom: usize) {
        self.intangible.push(geom);
    }

    /// Sets sliding, torsional (m) and rolling (m) friction of a shape of the model, and its priority in contacts.
    pub fn set_friction(&mut self, geom: usize, friction: [f64; 3], priority: i32) {
        self.frictions.push((geom, friction, priority));
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
}
