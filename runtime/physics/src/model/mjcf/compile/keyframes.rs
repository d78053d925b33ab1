//! Key frames.

use super::names::Kind;
use super::{Compiler, section};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{JointKind, Keyframe, rotation};
use nalgebra::Vector3;

/// All key frames of a model together may hold this many numbers.
const MOST_NUMBERS: usize = 20_000_000;

impl Compiler<'_> {
    /// Reads the `keyframe` sections. The model's sizes must be known.
    pub(super) fn read_keyframes(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        let standard = Keyframe::of_reference(&self.model);
        let size = 1 + self.model.nq + self.model.nv + self.model.na + standard.control.len() + 7 * standard.mocap_position.len();
        for element in section(&document.root, "keyframe") {
            let index = self.model.keyframes.len();
            if index.saturating_mul(size) > MOST_NUMBERS {
                return Err(element.invalid(format!("the key frames hold more than {MOST_NUMBERS} numbers")));
            }
            let name = self.names.register(Kind::Keyframe, element, index)?;
            let mut frame = Keyframe { name, time: element.number_or("time", 0.0)?, ..standard.clone() };
            fill(element, "qpos", &mut frame.position)?;
            fill(element, "qvel", &mut frame.velocity)?;
            fill(element, "act", &mut frame.activation)?;
            fill(element, "ctrl", &mut frame.control)?;
            let mut places: Vec<f64> = frame.mocap_position.iter().flatten().copied().collect();
            fill(element, "mpos", &mut places)?;
            let mut turns = frame.mocap_orientation.concat();
            fill(element, "mquat", &mut turns)?;
            frame.mocap_position = places.chunks_exact(3).map(Vector3::from_column_slice).collect();
            for (slot, quaternion) in frame.mocap_orientation.iter_mut().zip(turns.chunks_exact_mut(4)) {
                normalize(element, quaternion)?;
                slot.copy_from_slice(quaternion);
            }
            let joints = &self.model.joints;
            for (kind, &start) in joints.kind.iter().zip(&joints.position_address) {
                match kind {
                    JointKind::Free => normalize(element, &mut frame.position[start + 3..start + 7])?,
                    JointKind::Ball => normalize(element, &mut frame.position[start..start + 4])?,
                    JointKind::Hinge | JointKind::Slide => {}
                }
            }
            self.model.keyframes.push(frame);
        }
        Ok(())
    }
}

/// Replaces the numbers by those of an attribute, if it is given: as many as there are.
fn fill(element: &Element, attribute: &str, numbers: &mut [f64]) -> Result<(), ModelError> {
    if let Some(given) = element.list(attribute, numbers.len().max(1))? {
        if given.len() != numbers.len() {
            let (needed, found) = (numbers.len(), given.len());
            return Err(element.invalid(format!("`{attribute}` expects {needed} numbers in this model, found {found}")));
        }
        numbers.copy_from_slice(&given);
    }
    Ok(())
}

/// Makes a quaternion a unit one; one that is already keeps its bits.
fn normalize(element: &Element, quaternion: &mut [f64]) -> Result<(), ModelError> {
    let given = [quaternion[0], quaternion[1], quaternion[2], quaternion[3]];
    let unit = rotation::normalized(given).ok_or_else(|| element.invalid("a quaternion of the key frame is zero"))?;
    quaternion.copy_from_slice(&unit);
    Ok(())
}
