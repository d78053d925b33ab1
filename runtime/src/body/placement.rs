//! Where a body begins: joints in a pose, the root turned to its heading and lowered until something touches the ground.

use super::Body;
use crate::scene::ground::Ground;
use msk_physics::model::{Model, rotation};
use msk_physics::{self as physics, State, Workspace, kinematics::Kinematics};
use msk_program::frame::Origin;
use msk_program::task::{Init, RootPlacement};
use nalgebra::{Matrix3, Vector2, Vector3};

impl Body {
    /// Sets positions and velocities of the body: `coordinates` (rad or m, in the order of `joints`), from which coupled joints follow,
    /// and the root's placement. All joint velocities become zero. A body fixed to the world ignores the placement.
    ///
    /// Without a given height the lowest point of the body's shapes touches the ground, or is as far above it as it is lifted. Where landmarks shall meet places, the
    /// root is moved until the mean of what is missing vanishes; objects must stand in their places by then.
    pub fn place(
        &self,
        model: &Model,
        placement: &RootPlacement,
        coordinates: &[f64],
        state: &mut State<f64>,
        workspace: &mut Workspace<f64>,
    ) {
        for (joint, &coordinate) in self.joints.iter().zip(coordinates) {
            state.position[joint.position] = coordinate;
            state.velocity[joint.dof] = 0.0;
        }
        self.solve_couplings(model, &mut state.position);
        let Some((position, dof)) = self.root.free else { return };
        let orientation = rotation::from_matrix(&self.facing(placement));
        let [x, y] = placement.position;
        state.position[position..position + 3].copy_from_slice(&[x, y, placement.height.unwrap_or(0.0)]);
        state.position[position + 3..position + 7].copy_from_slice(&orientation);
        state.velocity[dof..dof + 3].copy_from_slice(&placement.velocity);
        // A free joint turns in its own axes.
        let spin = rotation::matrix(orientation).tr_mul(&Vector3::from(placement.spin));
        state.velocity[dof + 3..dof + 6].copy_from_slice(spin.as_slice());
        if !placement.meets.is_empty() {
            physics::kinematics::update(model, state, &mut workspace.kinematics);
            let missing = self.missing(&placement.meets, &workspace.kinematics);
            for (coordinate, shift) in state.position[position..position + 3].iter_mut().zip(missing.iter()) {
                *coordinate += shift;
            }
        } else if placement.height.is_none() {
            physics::kinematics::update(model, state, &mut workspace.kinematics);
            let ground = Ground { model, kinematics: &workspace.kinematics, shapes: &self.ground };
            let clearance = ground.clearance(&self.shapes);
            // A body without shapes stands on its root.
            state.position[position + 2] = placement.lift - if clearance.is_finite() { clearance } else { 0.0 };
        }
    }

    /// Gives joints, root and free objects the velocities of an initial state: those of root and objects in world axes; the state
    /// has spins in their own.
    pub fn launch(&self, init: &Init, state: &mut State<f64>) {
        for (joint, &velocity) in self.joints.iter().zip(&init.velocities) {
            state.velocity[joint.dof] = velocity;
        }
        let root = self.root.free.map(|free| (free, init.root.velocity, init.root.spin));
        let objects = init.objects.iter().filter_map(|start| {
            let free = self.objects.get(start.object).and_then(|object| object.free)?;
            Some((free, start.velocity, start.spin))
        });
        for ((place, dof), velocity, spin) in root.into_iter().chain(objects) {
            let at = &state.position;
            let orientation = [at[place + 3], at[place + 4], at[place + 5], at[place + 6]];
            let spin = rotation::matrix(orientation).tr_mul(&Vector3::from(spin));
            state.velocity[dof..dof + 3].copy_from_slice(&velocity);
            state.velocity[dof + 3..dof + 6].copy_from_slice(spin.as_slice());
        }
    }

    /// The mean way from landmarks to where they shall be.
    fn missing(&self, meets: &[(usize, Origin)], kinematics: &Kinematics<f64>) -> Vector3<f64> {
        let way = |(landmark, place): &(usize, Origin)| {
            self.place_of(kinematics, place) - self.landmark_position(kinematics, *landmark)
        };
        meets.iter().map(way).sum::<Vector3<f64>>() / meets.len() as f64
    }

    /// Where a landmark is, m.
    pub fn landmark_position(&self, kinematics: &Kinematics<f64>, landmark: usize) -> Vector3<f64> {
        let landmark = &self.landmarks[landmark];
        kinematics.body_position[landmark.body] + kinematics.body_rotation[landmark.body] * landmark.point
    }

    /// Where a landmark's forward axis points, seen from above: unit vector; world x where it is vertical.
    pub fn heading(&self, kinematics: &Kinematics<f64>, landmark: usize) -> Vector2<f64> {
        let landmark = &self.landmarks[landmark];
        let forward = kinematics.body_rotation[landmark.body] * landmark.axes.column(0);
        forward.xy().try_normalize(1e-12).unwrap_or_else(Vector2::x)
    }

    /// The axes of the root's heading, forward, left, up. A root that looks straight up or down has none: its axes are those of the world.
    pub(crate) fn root_heading(&self, kinematics: &Kinematics<f64>) -> Matrix3<f64> {
        let forward = kinematics.body_rotation[self.root.body] * self.root.axes.column(0);
        let ahead = Vector3::new(forward.x, forward.y, 0.0).try_normalize(1e-9).unwrap_or_else(Vector3::x);
        Matrix3::from_columns(&[ahead, Vector3::new(-ahead.y, ahead.x, 0.0), Vector3::z()])
    }

    /// The place that an origin names, m.
    pub fn place_of(&self, kinematics: &Kinematics<f64>, origin: &Origin) -> Vector3<f64> {
        match origin {
            Origin::World(place) => Vector3::from(*place),
            Origin::Landmark(landmark, [forward, left, up]) => {
                let ahead = self.heading(kinematics, *landmark);
                let level = ahead * *forward + Vector2::new(-ahead.y, ahead.x) * *left;
                self.landmark_position(kinematics, *landmark) + Vector3::new(level.x, level.y, *up)
            }
        }
    }

    /// The root's rotation: upright and facing world x, turned by heading, then pitch, then roll about its own axes.
    pub fn facing(&self, placement: &RootPlacement) -> Matrix3<f64> {
        let (sin, cos) = libm::sincos(placement.heading);
        let yaw = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        let (sin, cos) = libm::sincos(placement.pitch);
        let pitch = Matrix3::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos);
        let (sin, cos) = libm::sincos(placement.roll);
        let roll = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos);
        yaw * pitch * roll * self.root.axes.transpose()
    }

    /// Heading, pitch and roll, rad, of a root that is turned so: those that [`facing`](Self::facing) turns it by. Where it looks straight up or
    /// down, heading and roll are one turn.
    pub fn turns(&self, orientation: [f64; 4]) -> [f64; 3] {
        let turned = rotation::matrix(orientation) * self.root.axes;
        let level = libm::hypot(turned[(0, 0)], turned[(1, 0)]);
        let heading = libm::atan2(turned[(1, 0)], turned[(0, 0)]);
        [heading, libm::atan2(-turned[(2, 0)], level), libm::atan2(turned[(2, 1)], turned[(2, 2)])]
    }
}
