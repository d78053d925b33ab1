//! A body in the frames of a motion.

use super::{Body, Joint};
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace};
use msk_program::motion::{Motion, RootPart};
use msk_program::task::RootPlacement;

impl Body {
    /// Puts the body where a motion is at `time` (s): joints that it does not move stand as in the standing pose, coupled ones
    /// follow from their couplings. A motion without the root's height stands on the ground.
    pub fn follow(&self, model: &Model, motion: &Motion, time: f64, state: &mut State<f64>, workspace: &mut Workspace<f64>) {
        let moved = |joint: &Joint| motion.joint(&joint.name).map(|column| motion.value(column, time));
        let coordinates: Vec<f64> =
            self.joints.iter().zip(self.neutral()).map(|(joint, neutral)| moved(joint).unwrap_or(*neutral)).collect();
        let part = |part: RootPart| motion.root(part).map(|column| motion.value(column, time));
        let turn = |part_of: RootPart| part(part_of).unwrap_or(0.0);
        let placement = RootPlacement {
            height: part(RootPart::Height),
            position: [turn(RootPart::X), turn(RootPart::Y)],
            heading: turn(RootPart::Heading),
            pitch: turn(RootPart::Pitch),
            roll: turn(RootPart::Roll),
            ..RootPlacement::default()
        };
        self.place(model, &placement, &coordinates, state, workspace);
        physics::kinematics::update(model, state, &mut workspace.kinematics);
    }

    /// Where the landmarks are at each row of a motion: world axes, m.
    pub fn trace(&self, model: &Model, motion: &Motion) -> Vec<Vec<[f64; 3]>> {
        let (mut state, mut workspace) = (State::new(model), Workspace::new(model));
        let row = |time: &f64| {
            self.follow(model, motion, *time, &mut state, &mut workspace);
            (0..self.landmarks.len()).map(|landmark| self.landmark_position(&workspace.kinematics, landmark).into()).collect()
        };
        motion.times.iter().map(row).collect()
    }
}
