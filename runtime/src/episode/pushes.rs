//! Forces that disturb an episode: those of the task, and those that an evaluation adds.

use crate::body::Body;
use msk_physics::model::Model;
use msk_physics::{State, kinematics::Kinematics};
use msk_program::task::Disturbance;
use nalgebra::Vector3;

/// Sets the forces of everything that acts, at the places where landmarks are now. Forces keep their direction in the world.
pub(super) fn apply<'a>(
    pushes: impl Iterator<Item = &'a Disturbance>,
    model: &Model,
    body: &Body,
    kinematics: &Kinematics<f64>,
    state: &mut State<f64>,
) {
    state.body_force.fill([Vector3::zeros(); 2]);
    for push in pushes {
        let Some(landmark) = body.landmarks.get(push.landmark) else { continue };
        let carrier = landmark.body;
        if model.bodies.weld[carrier] == 0 {
            continue;
        }
        let force = Vector3::from(push.force);
        // The state's forces act at the centre of mass.
        let arm = body.landmark_position(kinematics, push.landmark) - kinematics.inertial_position[carrier];
        state.body_force[carrier][0] += force;
        state.body_force[carrier][1] += Vector3::from(push.torque) + arm.cross(&force);
    }
}
