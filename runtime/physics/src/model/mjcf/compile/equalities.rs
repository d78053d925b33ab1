//! Equality constraints: what the file couples, connects and welds.

use super::names::Kind;
use super::settings::softness;
use super::{Compiler, section};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{Attachment, AttachmentOrigin, Equality, JointKind, TendonCoupling, rotation};
use nalgebra::Vector3;

/// The polynomial of a coupling whose element gives none: one follows the other.
const IDENTITY_POLYNOMIAL: [f64; 5] = [0.0, 1.0, 0.0, 0.0, 0.0];

impl Compiler<'_> {
    /// Reads the `equality` sections. Frames that follow from the reference configuration are derived when it is known.
    pub(super) fn read_equalities(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        for element in section(&document.root, "equality") {
            let element = &self.defaults.resolve_equality(element)?;
            let kind = match element.tag.as_str() {
                "joint" => self.joint_coupling(element)?,
                "tendon" => Equality::Tendon(self.tendon_coupling(element)?),
                "connect" => Equality::Connect(self.connection(element)?),
                _ => Equality::Weld { attachment: self.weld(element)?, torque_scale: element.number_or("torquescale", 1.0)? },
            };
            let equalities = &mut self.model.equalities;
            let name = self.names.register(Kind::Equality, element, equalities.name.len())?;
            equalities.name.push(name);
            equalities.kind.push(kind);
            equalities.active.push(element.flag("active")?.unwrap_or(true));
            equalities.softness.push(softness(element, "solref", "solimp")?);
        }
        Ok(())
    }

    fn joint_coupling(&mut self, element: &Element) -> Result<Equality, ModelError> {
        let joint = self.scalar_joint(element, "joint1")?;
        let joint = joint.ok_or_else(|| element.invalid("a joint coupling needs the attribute `joint1`"))?;
        let leader = self.scalar_joint(element, "joint2")?;
        if leader == Some(joint) {
            return Err(element.invalid("a joint cannot be coupled to itself"));
        }
        let equality = self.model.equalities.kind.len();
        let couplings = &mut self.model.couplings;
        couplings.joint.push(joint);
        couplings.leader.push(leader);
        couplings.polynomial.push(element.numbers_over("polycoef", IDENTITY_POLYNOMIAL)?);
        couplings.equality.push(equality);
        Ok(Equality::Joint(couplings.joint.len() - 1))
    }

    fn tendon_coupling(&self, element: &Element) -> Result<TendonCoupling, ModelError> {
        let tendon = self.names.required(Kind::Tendon, element, "tendon1")?;
        let leader = self.names.optional(Kind::Tendon, element, "tendon2")?;
        if leader == Some(tendon) {
            return Err(element.invalid("a tendon cannot be coupled to itself"));
        }
        Ok(TendonCoupling { tendon, leader, polynomial: element.numbers_over("polycoef", IDENTITY_POLYNOMIAL)? })
    }

    /// A point of `body1`, where `body2` is at the reference configuration, or two sites.
    fn connection(&self, element: &Element) -> Result<Attachment, ModelError> {
        if let Some(sites) = self.sites(element, &["body1", "body2", "anchor"])? {
            return Ok(sites);
        }
        let bodies = self.bodies(element)?;
        let anchor = element.numbers::<3>("anchor")?;
        let anchor = anchor.ok_or_else(|| element.invalid("a connection of bodies needs the attribute `anchor`"))?;
        Ok(attachment(bodies, Vector3::from(anchor), Vector3::zeros(), AttachmentOrigin::Reference))
    }

    /// Frames of two bodies, by their pose at the reference configuration unless `relpose` gives it, or two sites.
    fn weld(&self, element: &Element) -> Result<Attachment, ModelError> {
        if let Some(sites) = self.sites(element, &["body1", "body2", "anchor", "relpose"])? {
            return Ok(sites);
        }
        let bodies = self.bodies(element)?;
        let anchor = element.vector_or("anchor", Vector3::zeros())?;
        let [x, y, z, quaternion @ ..] = element.numbers_over("relpose", [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
        if quaternion == [0.0; 4] {
            return Ok(attachment(bodies, Vector3::zeros(), anchor, AttachmentOrigin::Reference));
        }
        let orientation = rotation::normalized(quaternion);
        let orientation = orientation.ok_or_else(|| element.invalid("the quaternion of `relpose` is too small to be one"))?;
        let given = attachment(bodies, Vector3::new(x, y, z), anchor, AttachmentOrigin::Given);
        Ok(Attachment { orientation: [orientation, rotation::IDENTITY], ..given })
    }

    fn bodies(&self, element: &Element) -> Result<[usize; 2], ModelError> {
        if element.text("body1").is_none() {
            let tag = &element.tag;
            return Err(element.invalid(format!("`{tag}` needs `body1` (and perhaps `body2`), or both `site1` and `site2`")));
        }
        let first = self.names.required(Kind::Body, element, "body1")?;
        let second = self.names.optional(Kind::Body, element, "body2")?.unwrap_or(0);
        if first == second {
            return Err(element.invalid(format!("`{}` needs two different bodies", element.tag)));
        }
        Ok([first, second])
    }

    /// The frames of `site1` and `site2`, if the element gives them; then it may not give any of `others`.
    fn sites(&self, element: &Element, others: &[&str]) -> Result<Option<Attachment>, ModelError> {
        if element.text("site1").is_none() && element.text("site2").is_none() {
            return Ok(None);
        }
        if let Some(other) = others.iter().find(|other| element.text(other).is_some()) {
            return Err(element.invalid(format!("`{}` is given by its sites; `{other}` has no place beside them", element.tag)));
        }
        let first = self.names.required(Kind::Site, element, "site1")?;
        let second = self.names.required(Kind::Site, element, "site2")?;
        let both = [first, second];
        let sites = &self.model.sites;
        let bodies = both.map(|site| sites.body[site]);
        if bodies[0] == bodies[1] {
            return Err(element.invalid(format!("the sites of `{}` lie on one body", element.tag)));
        }
        Ok(Some(Attachment {
            bodies,
            position: both.map(|site| sites.position[site]),
            orientation: both.map(|site| sites.orientation[site]),
            origin: AttachmentOrigin::Sites(both),
        }))
    }

    /// A joint with a single coordinate.
    pub(super) fn scalar_joint(&self, element: &Element, attribute: &str) -> Result<Option<usize>, ModelError> {
        let joint = self.names.optional(Kind::Joint, element, attribute)?;
        let scalar = |joint: &usize| matches!(self.model.joints.kind[*joint], JointKind::Hinge | JointKind::Slide);
        if joint.as_ref().is_some_and(|joint| !scalar(joint)) {
            return Err(element.invalid(format!("`{attribute}` must be a hinge or slide joint")));
        }
        Ok(joint)
    }
}

/// Frames with the axes of their bodies.
fn attachment(bodies: [usize; 2], first: Vector3<f64>, second: Vector3<f64>, origin: AttachmentOrigin) -> Attachment {
    Attachment { bodies, position: [first, second], orientation: [rotation::IDENTITY; 2], origin }
}
