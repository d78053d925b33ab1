//! Free bodies turned into their principal axes of inertia (`alignfree`, `align`).

use super::Compiler;
use super::tree::Frame;
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{JointKind, Quaternion, rotation};
use core::ops::Range;
use nalgebra::Vector3;

impl Compiler<'_> {
    /// Whether a body without children asks to be aligned: it must have a free joint, which may itself ask for it.
    pub(super) fn aligned(&self, element: &Element, body: usize) -> Result<bool, ModelError> {
        let joint = self.model.bodies.joints[body].start;
        if self.model.bodies.joints[body].is_empty() || self.model.joints.kind[joint] != JointKind::Free {
            return Ok(false);
        }
        let own = own_joints(element).into_iter().find(|joint| joint.tag == "freejoint");
        let own = own.map(|joint| joint.keyword("align", &["false", "true", "auto"])).transpose()?.flatten();
        Ok(match own {
            Some(0) => false,
            Some(1) => true,
            _ => self.settings.align_free,
        })
    }

    /// Moves the body's frame to its centre of mass and principal axes; what it carries stays where it is.
    pub(super) fn align(&mut self, body: usize, sites: Range<usize>) {
        let model = &mut self.model;
        let bodies = &mut model.bodies;
        let inertial = Frame { position: bodies.inertial_position[body], orientation: bodies.inertial_orientation[body] };
        let placed = Frame { position: bodies.position[body], orientation: bodies.orientation[body] }.then(&inertial);
        (bodies.position[body], bodies.orientation[body]) = (placed.position, placed.orientation);
        bodies.inertial_position[body] = Vector3::zeros();
        bodies.inertial_orientation[body] = rotation::IDENTITY;

        // The one joint has no anchor or axis of its own; its reference coordinates are the body's place in the world.
        let address = model.joints.position_address[bodies.joints[body].start];
        model.reference_position[address..address + 3].copy_from_slice(placed.position.as_slice());
        model.reference_position[address + 3..address + 7].copy_from_slice(&placed.orientation);

        let inverse = inertial.inverse();
        let geoms = &mut model.geoms;
        reframe(&inverse, &mut geoms.position, &mut geoms.orientation, bodies.geoms[body].clone());
        reframe(&inverse, &mut model.sites.position, &mut model.sites.orientation, sites);
    }
}

/// Places given in one frame, seen from another that stands at the inverse of `change` in it.
fn reframe(change: &Frame, positions: &mut [Vector3<f64>], orientations: &mut [Quaternion], range: Range<usize>) {
    for (position, orientation) in positions[range.clone()].iter_mut().zip(&mut orientations[range]) {
        let moved = change.then(&Frame { position: *position, orientation: *orientation });
        (*position, *orientation) = (moved.position, moved.orientation);
    }
}

/// The joints of a body's element, through the frames around them.
fn own_joints(element: &Element) -> Vec<&Element> {
    let mut found = Vec::new();
    for child in &element.children {
        if matches!(child.tag.as_str(), "freejoint" | "joint") {
            found.push(child);
        } else if child.tag == "frame" {
            found.extend(own_joints(child));
        }
    }
    found
}
