//! A body and its scene in the mirror that stands in the world's plane y = 0: left and right are exchanged.
//!
//! Parts pair by their names, `knee_l` with `knee_r`; what has no side is its own partner. Whether a joint turns the other way round in the
//! mirror follows from the axes of both in the standing pose. Objects pair by where they are, which fails in a scene that is not the same
//! on both sides.

use msk_physics::State;
use msk_physics::kinematics::{self, Kinematics};
use msk_physics::model::{JointKind, Model, Quaternion, rotation};
use msk_runtime::body::Body;
use nalgebra::{Matrix3, Vector3};

/// Objects are in the same place up to this, m.
const SAME: f64 = 1e-6;

/// Partners of everything that moves.
pub(super) struct Mirror {
    /// By joint: its partner and the sign of the coordinate.
    joints: Vec<(usize, f64)>,
    muscles: Vec<usize>,
    /// By object: its partner.
    objects: Vec<usize>,
    /// Anatomical axes of the root in its own frame.
    axes: Matrix3<f64>,
}

/// The name of the other side.
fn other_side(name: &str) -> Option<String> {
    let swapped = |from: &str, to: &str| name.strip_suffix(from).map(|stem| format!("{stem}{to}"));
    swapped("_l", "_r").or_else(|| swapped("_r", "_l"))
}

/// The place of each name's partner.
fn partners(names: &[&str]) -> Vec<usize> {
    let partner = |(index, name): (usize, &&str)| {
        other_side(name).and_then(|other| names.iter().position(|known| *known == other)).unwrap_or(index)
    };
    names.iter().enumerate().map(partner).collect()
}

/// A vector in the mirror.
fn reflected(v: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.x, -v.y, v.z)
}

/// An orientation in the mirror, of something that is the same on both sides of its own middle plane.
fn turned(r: &Matrix3<f64>) -> Matrix3<f64> {
    let flip = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
    flip * r * flip
}

impl Mirror {
    /// For a body in a scene at `begins`; `None` where the scene has two unlike sides, or things whose joints have no partner.
    pub fn new(model: &Model, body: &Body, begins: &State<f64>) -> Option<Self> {
        let mut frames = Kinematics::new(model);
        let mut standing = begins.clone();
        for (joint, &coordinate) in body.joints.iter().zip(body.neutral()) {
            standing.position[joint.position] = coordinate;
        }
        if let Some((root, _)) = body.root.free {
            let upright = body.facing(&msk_program::task::RootPlacement::default());
            standing.position[root + 3..root + 7].copy_from_slice(&rotation::from_matrix(&upright));
        }
        kinematics::update(model, &standing, &mut frames);
        if body.joints.iter().any(|joint| joint.of_scene) {
            return None;
        }
        let names: Vec<&str> = body.joints.iter().map(|joint| joint.name.as_str()).collect();
        let joints = partners(&names).into_iter().enumerate().map(|(joint, partner)| {
            let [here, there] = [joint, partner].map(|joint| frames.joint_axis[body.joints[joint].index]);
            let image = if body.joints[joint].kind == JointKind::Slide { reflected(here) } else { -reflected(here) };
            (partner, if image.dot(&there) < 0.0 { -1.0 } else { 1.0 })
        });
        let joints = joints.collect();
        let names: Vec<&str> = body.muscles.iter().map(|muscle| muscle.name.as_str()).collect();
        let mut there = Kinematics::new(model);
        kinematics::update(model, begins, &mut there);
        let objects = paired(model, body, &there)?;
        Some(Self { joints, muscles: partners(&names), objects, axes: body.root.axes })
    }

    /// The mirror image of a state.
    pub fn image(&self, model: &Model, body: &Body, state: &State<f64>) -> State<f64> {
        let mut image = state.clone();
        for (joint, &(partner, sign)) in body.joints.iter().zip(&self.joints) {
            let other = &body.joints[partner];
            image.position[other.position] = sign * state.position[joint.position];
            image.velocity[other.dof] = sign * state.velocity[joint.dof];
        }
        body.solve_couplings(model, &mut image.position);
        body.solve_coupled_velocities(model, &image.position, &mut image.velocity);
        for (muscle, &partner) in self.muscles.iter().enumerate() {
            image.activation[partner] = state.activation[muscle];
            image.control[partner] = state.control[muscle];
        }
        if let Some(free) = body.root.free {
            // The middle plane of the root is that of its anatomical axes.
            let flip = self.axes * Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0)) * self.axes.transpose();
            move_free(state, &mut image, free, free, &flip);
        }
        for (object, &partner) in body.objects.iter().zip(&self.objects) {
            if let (Some(from), Some(to)) = (object.free, body.objects[partner].free) {
                move_free(state, &mut image, from, to, &Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0)));
            }
        }
        image
    }
}

/// Writes the mirror image of a free joint; `flip` mirrors a thing in its own frame.
fn move_free(state: &State<f64>, image: &mut State<f64>, from: (usize, usize), to: (usize, usize), flip: &Matrix3<f64>) {
    let ((place, dof), (to_place, to_dof)) = (from, to);
    let at = &state.position;
    let vector = |values: &[f64], first: usize| Vector3::new(values[first], values[first + 1], values[first + 2]);
    let orientation: Quaternion = [at[place + 3], at[place + 4], at[place + 5], at[place + 6]];
    let turn = rotation::matrix(orientation);
    let new = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0)) * turn * flip;
    image.position[to_place..to_place + 3].copy_from_slice(reflected(vector(at, place)).as_slice());
    image.position[to_place + 3..to_place + 7].copy_from_slice(&rotation::from_matrix(&new));
    let (velocity, spin) = (vector(&state.velocity, dof), turn * vector(&state.velocity, dof + 3));
    image.velocity[to_dof..to_dof + 3].copy_from_slice(reflected(velocity).as_slice());
    image.velocity[to_dof + 3..to_dof + 6].copy_from_slice(new.tr_mul(&-reflected(spin)).as_slice());
}

/// The partner of every object: of the same shapes, in its mirror image.
fn paired(model: &Model, body: &Body, frames: &Kinematics<f64>) -> Option<Vec<usize>> {
    let shapes = |object: usize| -> Vec<usize> {
        (0..model.geoms.body.len()).filter(|geom| model.geoms.body[*geom] == body.objects[object].body).collect()
    };
    let alike = |one: usize, other: usize| {
        let (first, second) = (body.objects[one].body, body.objects[other].body);
        let there = reflected(frames.body_position[first]) - frames.body_position[second];
        let (image, own) = (turned(&frames.body_rotation[first]), frames.body_rotation[second]);
        // Boxes and round shapes are the same upside down.
        let axes = (0..3).all(|axis| (image.column(axis).dot(&own.column(axis)).abs() - 1.0).abs() < SAME);
        let (one, other) = (shapes(one), shapes(other));
        let same = one.len() == other.len()
            && one.iter().zip(&other).all(|(a, b)| {
                model.geoms.kind[*a] == model.geoms.kind[*b] && (model.geoms.size[*a] - model.geoms.size[*b]).norm() < SAME
            });
        there.norm() < SAME && axes && same && (model.bodies.mass[first] - model.bodies.mass[second]).abs() < SAME
    };
    let fixed_to_body = |object: usize| body.members.contains(&body.objects[object].body);
    (0..body.objects.len())
        .map(|object| {
            if fixed_to_body(object) {
                // What is worn moves with the body; it must be worn in the middle, or the body is lopsided.
                return Some(object);
            }
            (0..body.objects.len()).find(|other| !fixed_to_body(*other) && alike(object, *other))
        })
        .collect()
}
