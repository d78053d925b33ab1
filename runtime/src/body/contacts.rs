//! What the body touches.

use super::sensors::Snapshot;
use nalgebra::Vector3;

/// A contact of the body with something else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct External {
    /// The body's shape.
    pub shape: usize,
    /// The other shape.
    pub other: usize,
    /// Where they touch, world frame, m.
    pub position: Vector3<f64>,
    /// Force on the body, world axes, N.
    pub force: Vector3<f64>,
}

impl Snapshot<'_> {
    /// The contacts of the body with anything that is not the body, where forces act.
    pub fn external_contacts(&self) -> impl Iterator<Item = External> + Clone + '_ {
        // One episode has one lane.
        let constraints = self.workspace.lanes.first().map(|lane| &lane.constraints);
        let owns = |geom: usize| self.body.owns(self.model.geoms.body[geom]);
        constraints.into_iter().flat_map(move |constraints| {
            constraints.contacts.iter().filter_map(move |contact| {
                // Contacts in the gap beyond the margin are reported, but carry no force.
                if contact.distance >= constraints.plan.candidates[contact.candidate].margin {
                    return None;
                }
                let [normal, first_tangent, second_tangent, ..] = contact.force;
                let force = contact.frame.transpose() * Vector3::new(normal, first_tangent, second_tangent);
                let ([first, second], position) = (contact.geoms, contact.position);
                match [owns(first), owns(second)] {
                    [false, true] => Some(External { shape: second, other: first, position, force }),
                    [true, false] => Some(External { shape: first, other: second, position, force: -force }),
                    _ => None,
                }
            })
        })
    }
}
