//! The kinematic tree: bodies depth first, each with its joints, shapes and sites in the order of the file.

use super::Compiler;
use super::inertias::Parts;
use super::names::Kind;
use super::settings::softness;
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{JointKind, Quaternion, rotation};
use nalgebra::Vector3;

/// A pose in what encloses it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub position: Vector3<f64>,
    pub orientation: Quaternion,
}

impl Frame {
    const IDENTITY: Self = Self { position: Vector3::new(0.0, 0.0, 0.0), orientation: rotation::IDENTITY };

    /// What encloses this frame, as seen from it.
    pub fn inverse(&self) -> Self {
        let [w, x, y, z] = self.orientation;
        let orientation = [w, -x, -y, -z];
        Self { position: -rotation::rotate(orientation, self.position), orientation }
    }

    /// The pose of `inner`, given in this frame, in what encloses this frame. Exact where this frame is the identity.
    pub fn then(&self, inner: &Self) -> Self {
        if self.orientation == rotation::IDENTITY {
            return Self { position: self.position + inner.position, orientation: inner.orientation };
        }
        let orientation = rotation::product(self.orientation, inner.orientation);
        Self {
            position: self.position + rotation::rotate(self.orientation, inner.position),
            orientation: rotation::normalized(orientation).unwrap_or(rotation::IDENTITY),
        }
    }
}

/// Where an element stands: its body, the `frame` elements around it, and the class its surroundings give.
#[derive(Clone, Copy)]
struct Surroundings<'a> {
    body: usize,
    frame: Frame,
    class: Option<&'a str>,
}

impl Compiler<'_> {
    /// Reads all `worldbody` sections. They are one body, the world, whose own shapes come before any other's.
    pub(super) fn read_tree(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        let name = self.names.world();
        let world = self.add_body(name, 0, &Frame::IDENTITY);
        let worlds: Vec<&Element> = document.root.children.iter().filter(|child| child.tag == "worldbody").collect();
        let surroundings = Surroundings { body: world, frame: Frame::IDENTITY, class: None };
        let mut ignored = Parts::default();
        self.open_ranges(world);
        for element in &worlds {
            self.read_contents(element, surroundings, &mut ignored)?;
        }
        self.close_ranges(world);
        if let Some(joint) = self.model.joints.name.first() {
            return Err(document.root.invalid(format!("the world cannot have joints, found `{joint}`")));
        }
        for element in &worlds {
            self.read_child_bodies(element, surroundings)?;
        }
        Ok(())
    }

    /// Joints, shapes and sites of a body; those inside `frame` elements belong to it too.
    fn read_contents(&mut self, owner: &Element, around: Surroundings<'_>, parts: &mut Parts) -> Result<(), ModelError> {
        for child in &owner.children {
            match child.tag.as_str() {
                "joint" | "freejoint" => self.read_joint(child, around)?,
                "geom" => {
                    let geom = self.defaults.resolve(child, around.class)?;
                    if geom.text("type").map(str::trim) == Some("mesh") {
                        self.read_mesh_geom(&geom, around.body, &around.frame, parts)?;
                    } else {
                        self.read_geom(&geom, around.body, &around.frame)?;
                        self.add_solid(&geom, parts)?;
                    }
                }
                "site" => {
                    let site = self.defaults.resolve(child, around.class)?;
                    self.read_site(&site, around.body, &around.frame)?;
                }
                "frame" => self.read_contents(child, self.inside(child, around)?, parts)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn read_child_bodies(&mut self, owner: &Element, around: Surroundings<'_>) -> Result<(), ModelError> {
        for child in &owner.children {
            match child.tag.as_str() {
                "body" => self.read_body(child, around)?,
                "frame" => self.read_child_bodies(child, self.inside(child, around)?)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// The surroundings of what a `frame` element holds.
    fn inside<'a>(&self, element: &'a Element, around: Surroundings<'a>) -> Result<Surroundings<'a>, ModelError> {
        let class = self.child_class(element)?.or(around.class);
        Ok(Surroundings { body: around.body, frame: around.frame.then(&self.frame(element)?), class })
    }

    /// The `childclass` of an element, which must exist.
    fn child_class<'a>(&self, element: &'a Element) -> Result<Option<&'a str>, ModelError> {
        match element.text("childclass") {
            Some(class) if !self.defaults.contains(class) => Err(element.invalid(format!("there is no default class `{class}`"))),
            class => Ok(class),
        }
    }

    fn read_body(&mut self, element: &Element, around: Surroundings<'_>) -> Result<(), ModelError> {
        let class = self.child_class(element)?.or(around.class);
        let placed = around.frame.then(&self.frame(element)?);
        let name = self.names.register(Kind::Body, element, self.model.bodies.name.len())?;
        let body = self.add_body(name, around.body, &placed);
        self.model.bodies.gravity_compensation[body] = element.number_or("gravcomp", 0.0)?;
        let surroundings = Surroundings { body, frame: Frame::IDENTITY, class };
        let mut parts = Parts::default();
        let first_site = self.model.sites.name.len();
        self.open_ranges(body);
        self.read_contents(element, surroundings, &mut parts)?;
        self.close_ranges(body);
        self.check_joints(element, body)?;
        self.model.bodies.mocap[body] = self.mocap(element, body)?;
        self.read_inertia(element, body, parts)?;
        let sites = first_site..self.model.sites.name.len();
        self.read_child_bodies(element, surroundings)?;
        if body + 1 == self.model.bodies.name.len() && self.aligned(element, body)? {
            self.align(body, sites);
        }
        Ok(())
    }

    /// Whether the body is placed from outside.
    fn mocap(&self, element: &Element, body: usize) -> Result<bool, ModelError> {
        let mocap = element.flag("mocap")?.unwrap_or(false);
        let bodies = &self.model.bodies;
        if mocap && (bodies.parent[body] != 0 || !bodies.joints[body].is_empty()) {
            return Err(element.invalid("a `mocap` body must be a child of the world without joints"));
        }
        Ok(mocap)
    }

    /// Appends a body with no mass yet.
    fn add_body(&mut self, name: String, parent: usize, frame: &Frame) -> usize {
        let bodies = &mut self.model.bodies;
        bodies.name.push(name);
        bodies.parent.push(parent);
        bodies.position.push(frame.position);
        bodies.orientation.push(frame.orientation);
        bodies.inertial_position.push(Vector3::zeros());
        bodies.inertial_orientation.push(rotation::IDENTITY);
        bodies.mass.push(0.0);
        bodies.inertia.push(Vector3::zeros());
        bodies.mocap.push(false);
        bodies.gravity_compensation.push(0.0);
        bodies.joints.push(0..0);
        bodies.geoms.push(0..0);
        bodies.name.len() - 1
    }

    fn open_ranges(&mut self, body: usize) {
        self.model.bodies.joints[body].start = self.model.joints.name.len();
        self.model.bodies.geoms[body].start = self.model.geoms.name.len();
    }

    fn close_ranges(&mut self, body: usize) {
        self.model.bodies.joints[body].end = self.model.joints.name.len();
        self.model.bodies.geoms[body].end = self.model.geoms.name.len();
    }

    fn read_joint(&mut self, element: &Element, around: Surroundings<'_>) -> Result<(), ModelError> {
        const KINDS: [(&str, JointKind); 4] =
            [("free", JointKind::Free), ("ball", JointKind::Ball), ("slide", JointKind::Slide), ("hinge", JointKind::Hinge)];
        // A `freejoint` takes nothing from the defaults.
        let free = element.tag == "freejoint";
        let element = &if free { element.clone() } else { self.defaults.resolve(element, around.class)? };
        let kind = match element.keyword("type", &KINDS.map(|(word, _)| word))? {
            _ if free => JointKind::Free,
            index => index.map_or(JointKind::Hinge, |index| KINDS[index].1),
        };
        let directed = matches!(kind, JointKind::Hinge | JointKind::Slide);
        let axis = if directed { element.vector_or("axis", Vector3::z())? } else { Vector3::z() };
        let axis = rotation::unit_vector(axis).ok_or_else(|| element.invalid("the joint's `axis` is zero"))?;
        let anchor = match kind {
            JointKind::Free => Vector3::zeros(),
            _ => element.vector_or("pos", Vector3::zeros())?,
        };
        let placed = around.frame.then(&Frame { position: anchor, orientation: rotation::IDENTITY });
        let turned = around.frame.orientation != rotation::IDENTITY && directed;
        let index = self.model.joints.name.len();
        let name = self.names.register(Kind::Joint, element, index)?;
        let range = match kind {
            JointKind::Free => None,
            _ => self.settings.limited(element, "limited", "range")?,
        };
        let coordinates = self.coordinates(element, kind)?;
        let actuator_force_range = self.settings.limited(element, "actuatorfrclimited", "actuatorfrcrange")?.filter(|_| directed);
        let joints = &mut self.model.joints;
        joints.name.push(name);
        joints.kind.push(kind);
        joints.body.push(around.body);
        joints.anchor.push(if kind == JointKind::Free { anchor } else { placed.position });
        joints.axis.push(if turned { rotation::rotate(around.frame.orientation, axis) } else { axis });
        joints.range.push(range.map(|range| range.map(coordinates.scale)));
        joints.margin.push(element.number_or("margin", 0.0)?);
        joints.limit_softness.push(softness(element, "solreflimit", "solimplimit")?);
        joints.friction_softness.push(softness(element, "solreffriction", "solimpfriction")?);
        joints.stiffness.push(linear(element, "stiffness")?);
        joints.spring_reference.push(coordinates.spring);
        joints.actuator_force_range.push(actuator_force_range);
        joints.actuator_compensates.push(element.flag("actuatorgravcomp")?.unwrap_or(false));
        let reference = coordinates.reference;
        let spring = element.numbers_over("springdamper", [0.0; 2])?;
        if spring.iter().all(|figure| *figure > 0.0) {
            self.springs.push((index, spring));
        }
        joints.position_address.push(self.model.reference_position.len());
        joints.dof_address.push(self.model.dofs.body.len());
        self.add_coordinates(kind, around.body, reference);
        self.add_dofs(element, kind, around.body, index)
    }

    /// The file's unit of the joint's coordinate, and its reference values in ours.
    fn coordinates(&self, element: &Element, kind: JointKind) -> Result<Coordinates, ModelError> {
        let angular = matches!(kind, JointKind::Hinge | JointKind::Ball);
        let scale: fn(f64) -> f64 = if angular && self.settings.degrees { f64::to_radians } else { |value| value };
        let scalar = matches!(kind, JointKind::Hinge | JointKind::Slide);
        let read = |attribute| Ok::<_, ModelError>(if scalar { scale(element.number_or(attribute, 0.0)?) } else { 0.0 });
        Ok(Coordinates { scale, reference: read("ref")?, spring: read("springref")? })
    }

    /// Appends the joint's coordinates at the reference configuration.
    fn add_coordinates(&mut self, kind: JointKind, body: usize, reference: f64) {
        let position = self.model.bodies.position[body];
        let orientation = self.model.bodies.orientation[body];
        let coordinates = &mut self.model.reference_position;
        match kind {
            JointKind::Free => {
                coordinates.extend(position.iter());
                coordinates.extend(orientation);
            }
            JointKind::Ball => coordinates.extend(rotation::IDENTITY),
            JointKind::Slide | JointKind::Hinge => coordinates.push(reference),
        }
    }

    fn add_dofs(&mut self, element: &Element, kind: JointKind, body: usize, joint: usize) -> Result<(), ModelError> {
        let armature = element.size_or("armature", 0.0)?;
        let damping = linear(element, "damping")?;
        let friction_loss = element.size_or("frictionloss", 0.0)?;
        let dofs = &mut self.model.dofs;
        for _ in 0..dof_count(kind) {
            dofs.body.push(body);
            dofs.joint.push(joint);
            dofs.armature.push(armature);
            dofs.damping.push(damping);
            dofs.friction_loss.push(friction_loss);
        }
        Ok(())
    }

    /// A free joint stands alone, on a child of the world.
    fn check_joints(&self, element: &Element, body: usize) -> Result<(), ModelError> {
        let range = self.model.bodies.joints[body].clone();
        let free = self.model.joints.kind[range.clone()].contains(&JointKind::Free);
        if free && range.len() > 1 {
            return Err(element.invalid("a body with a free joint cannot have other joints"));
        }
        let dofs: usize = self.model.joints.kind[range].iter().map(|kind| dof_count(*kind)).sum();
        if dofs > 6 {
            return Err(element.invalid(format!("a body cannot have more than 6 degrees of freedom, found {dofs}")));
        }
        if free && self.model.bodies.parent[body] != 0 {
            return Err(element.invalid("only a child of the world can have a free joint"));
        }
        Ok(())
    }
}

/// How many degrees of freedom a joint has.
fn dof_count(kind: JointKind) -> usize {
    match kind {
        JointKind::Free => 6,
        JointKind::Ball => 3,
        JointKind::Slide | JointKind::Hinge => 1,
    }
}

/// How a file gives a joint's coordinates.
struct Coordinates {
    /// From the file's unit to radians or metres.
    scale: fn(f64) -> f64,
    /// Where the joint is at the reference configuration.
    reference: f64,
    /// Where its spring rests.
    spring: f64,
}

/// A stiffness or damping: one number, or a polynomial whose higher coefficients are zero.
pub(super) fn linear(element: &Element, attribute: &str) -> Result<f64, ModelError> {
    let [first, second, third] = element.numbers_over(attribute, [0.0; 3])?;
    if second != 0.0 || third != 0.0 {
        return Err(element.invalid(format!("`{attribute}` with a polynomial of higher degree is not supported")));
    }
    if first < 0.0 {
        return Err(element.invalid(format!("`{attribute}` must not be negative, found {first}")));
    }
    Ok(first)
}
