//! From the description of a scene to bodies, joints and shapes.

use super::builder::SceneBuilder;
use super::check::BuildError;
use super::elements::{NewAttachment, NewBody, NewGeom, NewJoint, NewSite};
use super::terrain;
use crate::body::Body;
use msk_physics::model::{GeomKind, JointKind, Model, SolverParameters, rotation};
use msk_program::scene::{Connection, Motion, Object, ObjectJoint, ObjectJointKind, Parent, SceneDescription, Shape, Surface};
use nalgebra::Vector3;

/// What is wrong with a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// Something that the scene refers to is not there.
    #[error("{user} names `{name}`, which is neither a landmark of the body nor an object of the scene before it")]
    Unknown {
        /// What refers to it.
        user: String,
        /// The name.
        name: String,
    },
    /// A number that makes no sense.
    #[error("object `{object}`: {reason}")]
    Object {
        /// The object.
        object: String,
        /// What is wrong.
        reason: String,
    },
    /// No model can hold the scene.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// A scene put into a builder.
#[derive(Debug)]
pub(super) struct Placed<'a> {
    pub builder: SceneBuilder<'a>,
    /// A ground that the model does not have.
    pub ground: Option<usize>,
    /// Each object's body.
    pub bodies: Vec<usize>,
    /// Each object's own shapes.
    pub geoms: Vec<Vec<usize>>,
    /// Each object's joints, with the free one.
    pub joints: Vec<Vec<usize>>,
    /// The equality of each connection.
    pub connections: Vec<usize>,
}

/// Puts all objects into a builder for `model`, which `body` is bound to.
pub(super) fn add<'a>(model: &'a Model, body: &Body, scene: &SceneDescription) -> Result<Placed<'a>, SceneError> {
    let bits = Bits::of(model, body);
    let builder = SceneBuilder::new(model);
    let mut placed =
        Placed { builder, ground: None, bodies: Vec::new(), geoms: Vec::new(), joints: Vec::new(), connections: Vec::new() };
    placed.ground = set_ground(model, body, scene, &mut placed.builder);
    for object in &scene.objects {
        let carrier = carrier(object, model, body, &placed.bodies)?;
        let added = placed.builder.body(carrier);
        placed.bodies.push(added);
        let builder = &mut placed.builder;
        let joint =
            |joint: NewJoint| builder.joint(added, NewJoint { name: free_name(&joint.name, &model.joints.name), ..joint });
        placed.joints.push(joints(object).into_iter().map(joint).collect());
        let shape = |geom: NewGeom| {
            let geom = NewGeom { name: free_name(&geom.name, &model.geoms.name), ..geom };
            builder.geom(added, bits.apply(geom, &object.surface))
        };
        let shapes = object.shape.as_ref().map(|shape| shapes_of(&object.name, shape, object.mass));
        placed.geoms.push(shapes.into_iter().flatten().map(shape).collect());
    }
    for (index, connection) in scene.connections.iter().enumerate() {
        let equality = connect(index, connection, body, scene, &mut placed)?;
        placed.connections.push(equality);
    }
    Ok(placed)
}

/// Holds the frames of two landmarks or objects together.
fn connect(
    index: usize,
    connection: &Connection,
    body: &Body,
    scene: &SceneDescription,
    placed: &mut Placed<'_>,
) -> Result<usize, SceneError> {
    let word = if connection.weld { "weld" } else { "connect" };
    let name = format!("{word}[{index}]");
    let mut end = |end: &str, of: &str| -> Result<usize, SceneError> {
        let name = format!("{name}.{end}");
        if let Some(landmark) = body.landmarks.iter().find(|landmark| landmark.name == of) {
            let orientation = rotation::from_matrix(&landmark.axes);
            return Ok(placed.builder.site(landmark.body, NewSite { name, position: landmark.point, orientation }));
        }
        let object = scene.objects.iter().position(|object| object.name == of);
        let object = object.ok_or_else(|| SceneError::Unknown { user: format!("`{word}`"), name: of.to_owned() })?;
        let site = NewSite { name, position: Vector3::zeros(), orientation: rotation::IDENTITY };
        Ok(placed.builder.site(placed.bodies[object], site))
    };
    let sites = [end("from", &connection.from)?, end("to", &connection.to)?];
    let softness = SolverParameters::default();
    Ok(placed.builder.attach(NewAttachment { name, sites, weld: connection.weld, softness }))
}

/// The model's own ground goes where the scene has none, and becomes as rough as in the scene. A ground that is added.
fn set_ground(model: &Model, body: &Body, scene: &SceneDescription, builder: &mut SceneBuilder<'_>) -> Option<usize> {
    let Some(surface) = &scene.ground else {
        body.ground.iter().for_each(|&plane| builder.make_intangible(plane));
        return None;
    };
    if body.ground.is_empty() {
        let plane = NewGeom { name: free_name("ground", &model.geoms.name), kind: GeomKind::Plane, ..NewGeom::default() };
        return Some(builder.geom(0, Bits::of(model, body).apply(plane, surface)));
    }
    if surface.friction != Surface::default().friction || surface.decides {
        let priority = priority(surface);
        body.ground.iter().for_each(|&plane| builder.set_friction(plane, surface.friction, priority));
    }
    None
}

/// A surface whose friction decides alone comes before those of the body and of other objects.
fn priority(surface: &Surface) -> i32 {
    i32::from(surface.decides)
}

/// The first of `name`, `name'`, `name''`, ... that the model has not taken: tasks know other names than models.
fn free_name(name: &str, taken: &[String]) -> String {
    let mut name = name.to_owned();
    while taken.contains(&name) {
        name.push('\'');
    }
    name
}

/// Contact bits that meet every shape of the body that can touch anything, and those of other objects.
struct Bits {
    kind: u32,
    affinity: u32,
}

impl Bits {
    fn of(model: &Model, body: &Body) -> Self {
        let join = |bits: &[u32]| body.shapes.iter().fold(1, |all, &geom| all | bits[geom]);
        Self { kind: join(&model.geoms.contact_affinity), affinity: join(&model.geoms.contact_type) }
    }

    /// The shape with the surface of its object.
    fn apply(&self, geom: NewGeom, surface: &Surface) -> NewGeom {
        let [_, torsional, rolling] = surface.friction;
        let [_, usual_torsional, usual_rolling] = Surface::default().friction;
        // Who writes a friction against twisting or rolling wants it to act.
        let contact_dimension = match (torsional != usual_torsional, rolling != usual_rolling) {
            (_, true) => 6,
            (true, false) => 4,
            (false, false) => 3,
        };
        let (kind, affinity) = if surface.solid { (self.kind, self.affinity) } else { (0, 0) };
        NewGeom {
            contact_type: kind,
            contact_affinity: affinity,
            contact_dimension,
            friction: surface.friction,
            priority: priority(surface),
            ..geom
        }
    }
}

/// The body of an object, where its parent carries it.
fn carrier(object: &Object, model: &Model, body: &Body, bodies: &[usize]) -> Result<NewBody, SceneError> {
    let name = free_name(&object.name, &model.bodies.name);
    let wrong = |reason: &str| SceneError::Object { object: object.name.clone(), reason: reason.to_owned() };
    let orientation = rotation::normalized(object.orientation).ok_or_else(|| wrong("its orientation is not a rotation"))?;
    let position = Vector3::from(object.position);
    let unknown = |name: String| SceneError::Unknown { user: format!("object `{}`", object.name), name };
    Ok(match &object.parent {
        Parent::World => {
            NewBody { name, parent: 0, position, orientation, placed: matches!(object.motion, Motion::Placed | Motion::Driven) }
        }
        Parent::Object(parent) => {
            let parent = *bodies.get(*parent).ok_or_else(|| unknown(format!("object {parent}")))?;
            NewBody { name, parent, position, orientation, placed: false }
        }
        Parent::Landmark(landmark) => {
            let known = body.landmarks.iter().find(|known| known.name == *landmark).ok_or_else(|| unknown(landmark.clone()))?;
            let axes = rotation::from_matrix(&known.axes);
            let orientation = rotation::normalized(rotation::product(axes, orientation));
            NewBody {
                name,
                parent: known.body,
                position: known.point + known.axes * position,
                orientation: orientation.unwrap_or(rotation::IDENTITY),
                placed: false,
            }
        }
    })
}

fn joints(object: &Object) -> Vec<NewJoint> {
    match &object.motion {
        Motion::Fixed | Motion::Placed | Motion::Driven => Vec::new(),
        Motion::Free => vec![NewJoint { name: object.name.clone(), kind: JointKind::Free, ..NewJoint::default() }],
        Motion::Joints(joints) => joints.iter().map(joint).collect(),
    }
}

fn joint(joint: &ObjectJoint) -> NewJoint {
    NewJoint {
        name: joint.name.clone(),
        kind: match joint.kind {
            ObjectJointKind::Hinge => JointKind::Hinge,
            ObjectJointKind::Slide => JointKind::Slide,
            ObjectJointKind::Ball => JointKind::Ball,
        },
        axis: Vector3::from(joint.axis),
        anchor: Vector3::from(joint.anchor),
        range: joint.range,
        damping: joint.damping,
        stiffness: joint.stiffness,
        friction_loss: joint.friction_loss,
    }
}

/// The shapes of an object of this shape and mass. One that is alone bears the object's name.
pub(crate) fn shapes_of(name: &str, shape: &Shape, mass: f64) -> Vec<NewGeom> {
    let (kind, size) = match *shape {
        Shape::Box(extents) => (GeomKind::Box, Vector3::from(extents) * 0.5),
        Shape::Sphere(radius) => (GeomKind::Sphere, Vector3::new(radius, 0.0, 0.0)),
        Shape::Capsule(radius, length) => (GeomKind::Capsule, Vector3::new(radius, 0.5 * length, 0.0)),
        Shape::Cylinder(radius, length) => (GeomKind::Cylinder, Vector3::new(radius, 0.5 * length, 0.0)),
        Shape::Ellipsoid(half_axes) => (GeomKind::Ellipsoid, Vector3::from(half_axes)),
        Shape::Plane => (GeomKind::Plane, Vector3::zeros()),
        Shape::Terrain(ref terrain) => return terrain::shapes(name, terrain),
    };
    vec![NewGeom { name: name.to_owned(), kind, size, mass, ..NewGeom::default() }]
}
