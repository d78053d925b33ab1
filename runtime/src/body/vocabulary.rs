//! What the compiler may know of a body.

use super::Body;
use msk_physics::model::{self, Model};
use msk_physics::{self as physics, State, Workspace};
use msk_program::task::RootPlacement;
use msk_program::vocabulary::{Joint, JointKind, Landmark, Muscle, Vocabulary};
use nalgebra::Matrix3;

impl Body {
    /// What exists on this body, for the compiler: plain data without any physics.
    pub fn vocabulary(&self, model: &Model) -> Vocabulary {
        let neutral = self.neutral();
        let mut state = State::new(model);
        let mut workspace = Workspace::new(model);
        self.place(model, &RootPlacement::default(), neutral, &mut state, &mut workspace);
        physics::kinematics::update(model, &state, &mut workspace.kinematics);
        let kinematics = &workspace.kinematics;
        let landmark = |landmark: &super::Landmark| Landmark {
            name: landmark.name.clone(),
            description: landmark.description.clone(),
            mass: model.bodies.mass[landmark.body],
            neutral_position: kinematics.point(landmark.body, &landmark.point).into(),
            neutral_axes: columns(&(kinematics.body_rotation[landmark.body] * landmark.axes)),
            has_segment: !landmark.segment.is_empty(),
            of_scene: landmark.of_scene,
        };
        let joint = |(joint, neutral): (&super::Joint, f64)| Joint {
            name: joint.name.clone(),
            kind: if joint.kind == model::JointKind::Slide { JointKind::Slide } else { JointKind::Hinge },
            range: joint.range,
            neutral,
            independent: joint.independent,
            of_scene: joint.of_scene,
        };
        let muscle = |muscle: &super::Muscle| Muscle {
            name: muscle.name.clone(),
            peak_force: muscle.peak_force,
            family: muscle.family.clone(),
        };
        Vocabulary {
            body: self.name.clone(),
            physics_step: model.options.timestep,
            mass: self.mass,
            gravity: model.options.gravity.norm(),
            neutral_com: self.centre_of_mass(model, kinematics).into(),
            landmarks: self.landmarks.iter().map(landmark).collect(),
            // Poses do not contain objects, whose joints stand at zero.
            joints: self.joints.iter().zip(neutral.iter().copied().chain(core::iter::repeat(0.0))).map(joint).collect(),
            muscles: self.muscles.iter().map(muscle).collect(),
            groups: self.groups.clone(),
            poses: self.poses.clone(),
        }
    }
}

/// Columns one after the other.
fn columns(axes: &Matrix3<f64>) -> [f64; 9] {
    let mut lanes = [0.0; 9];
    lanes.iter_mut().zip(axes.iter()).for_each(|(lane, value)| *lane = *value);
    lanes
}
