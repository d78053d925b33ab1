//! Frames and the motion subspace.

use super::{
    rotation::{constant_quaternion, from_axis_angle, matrix, multiply, normalize},
    spatial::{Spatial, constant, cross, lane_of, matrix_of, product, rotate, scale, spatial_zero, zero},
    state::State,
};
use crate::{
    batch::one_lane,
    model::{JointKind, Model},
    overrides::Overrides,
    scalar::Real,
};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Outputs of position kinematics, MuJoCo's names in words. World frame, metres.
#[derive(Debug, Clone)]
pub struct Kinematics<T: Real> {
    /// Body frame origins (`xpos`).
    pub body_position: Vec<Vector3<T>>,
    /// Body orientations w x y z (`xquat`).
    pub body_orientation: Vec<[T; 4]>,
    /// Body rotation matrices (`xmat`).
    pub body_rotation: Vec<Matrix3<T>>,
    /// Centres of mass of the bodies (`xipos`).
    pub inertial_position: Vec<Vector3<T>>,
    /// Principal axes of the bodies (`ximat`).
    pub inertial_rotation: Vec<Matrix3<T>>,
    /// Joint anchors (`xanchor`).
    pub joint_anchor: Vec<Vector3<T>>,
    /// Joint axes (`xaxis`).
    pub joint_axis: Vec<Vector3<T>>,
    /// Geom centres (`geom_xpos`).
    pub geom_position: Vec<Vector3<T>>,
    /// Geom rotation matrices (`geom_xmat`).
    pub geom_rotation: Vec<Matrix3<T>>,
    /// Masses of the bodies, kg: those of the model, scaled by the state.
    pub mass: Vec<T>,
    /// Mass of each body's subtree, kg (`body_subtreemass`).
    pub subtree_mass: Vec<T>,
    /// Centre of mass of each body's subtree (`subtree_com`).
    pub subtree_com: Vec<Vector3<T>>,
    /// Motion axis of every dof, angular then linear, about the centre of mass of its kinematic tree (`cdof`).
    pub dof_axis: Vec<Spatial<T>>,
    /// Shapes that episodes have of their own.
    pub overrides: Overrides,
    plan: Arc<Plan>,
}

one_lane!(Kinematics {
    body_position, body_orientation, body_rotation, inertial_position, inertial_rotation, joint_anchor, joint_axis, geom_position,
    geom_rotation, mass, subtree_mass, subtree_com, dof_axis, overrides; but plan
});

/// What follows from the model alone: rotation matrices of the frames that are fixed in their bodies; `None` where they coincide
/// with the body's.
#[derive(Debug)]
pub(crate) struct Plan {
    inertial: Vec<Option<Matrix3<f64>>>,
    geom: Vec<Option<Matrix3<f64>>>,
    /// Index among the bodies that are placed from outside.
    placed: Vec<Option<usize>>,
}

impl Plan {
    pub fn new(model: &Model) -> Self {
        let turned = |q: &[f64; 4]| (*q != [1.0, 0.0, 0.0, 0.0]).then(|| matrix(q));
        Self {
            inertial: model.bodies.inertial_orientation.iter().map(turned).collect(),
            geom: model.geoms.orientation.iter().map(turned).collect(),
            placed: model
                .bodies
                .mocap
                .iter()
                .scan(0, |count, &placed| {
                    let index = placed.then_some(*count);
                    *count += usize::from(placed);
                    Some(index)
                })
                .collect(),
        }
    }
}

impl<T: Real> Kinematics<T> {
    /// Memory for `model`, with every frame at the world's.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Arc::new(Plan::new(model)))
    }

    pub(crate) fn of(model: &Model, plan: &Arc<Plan>) -> Self {
        let bodies = model.bodies.parent.len();
        let joints = model.joints.kind.len();
        let geoms = model.geoms.kind.len();
        let identity = Matrix3::from_diagonal_element(T::splat(1.0));
        Self {
            body_position: vec![zero(); bodies],
            body_orientation: vec![constant_quaternion(&[1.0, 0.0, 0.0, 0.0]); bodies],
            body_rotation: vec![identity; bodies],
            inertial_position: vec![zero(); bodies],
            inertial_rotation: vec![identity; bodies],
            joint_anchor: vec![zero(); joints],
            joint_axis: vec![zero(); joints],
            geom_position: vec![zero(); geoms],
            geom_rotation: vec![identity; geoms],
            mass: vec![T::splat(0.0); bodies],
            subtree_mass: vec![T::splat(0.0); bodies],
            subtree_com: vec![zero(); bodies],
            dof_axis: vec![spatial_zero(); model.nv],
            overrides: Overrides::none(T::LANES),
            plan: Arc::clone(plan),
        }
    }

    /// The index of a body among those that are placed from outside.
    #[inline(always)]
    pub(crate) fn placed(&self, body: usize) -> Option<usize> {
        self.plan.placed[body]
    }

    /// World position of a point given in the frame of `body`, m.
    #[inline(always)]
    pub fn point(&self, body: usize, local: &Vector3<T>) -> Vector3<T> {
        rotate(&self.body_rotation[body], local) + self.body_position[body]
    }

    /// World position of a site (`site_xpos`), m. Computed on request: the step itself needs only those on tendon paths.
    pub fn site_position(&self, model: &Model, site: usize) -> Vector3<T> {
        self.point(model.sites.body[site], &constant(&model.sites.position[site]))
    }

    /// World orientation of a site (`site_xmat`).
    pub fn site_rotation(&self, model: &Model, site: usize) -> Matrix3<T> {
        product(&self.body_rotation[model.sites.body[site]], &matrix(&constant_quaternion(&model.sites.orientation[site])))
    }

    /// The point that all spatial vectors of `body` refer to: the centre of mass of its kinematic tree.
    #[inline(always)]
    pub fn reference(&self, model: &Model, body: usize) -> &Vector3<T> {
        &self.subtree_com[model.bodies.root[body]]
    }
}

/// Fills all frames from the positions of `state`, then the centres of mass and motion axes.
#[inline(never)]
pub fn update(model: &Model, state: &State<f64>, out: &mut Kinematics<f64>) {
    update_lanes(model, state, out);
}

/// [`update`] over any scalar.
#[inline(always)]
pub fn update_lanes<T: Real>(model: &Model, state: &State<T>, out: &mut Kinematics<T>) {
    for body in 1..model.bodies.parent.len() {
        place_body(model, state, out, body);
    }
    out.overrides.copy_from(&state.overrides);
    place_geoms(model, out);
    weigh(model, state, out);
    centres_of_mass(model, out);
    motion_axes(model, out);
}

/// Places one body and its joints from its parent's frame, then its inertial frame.
#[inline(always)]
fn place_body<T: Real>(model: &Model, state: &State<T>, out: &mut Kinematics<T>, body: usize) {
    let bodies = &model.bodies;
    let joints = bodies.joints[body].clone();
    let free = joints.len() == 1 && model.joints.kind[joints.start] == JointKind::Free;
    let (mut position, mut orientation);
    if free {
        let q = &state.position[model.joints.position_address[joints.start]..];
        position = Vector3::new(q[0], q[1], q[2]);
        orientation = normalize(&[q[3], q[4], q[5], q[6]]);
        out.joint_anchor[joints.start] = position;
        out.joint_axis[joints.start] = constant(&model.joints.axis[joints.start]);
    } else if let Some(index) = out.plan.placed[body] {
        position = state.mocap_position[index];
        orientation = normalize(&state.mocap_orientation[index]);
    } else {
        let parent = bodies.parent[body];
        position = out.point(parent, &constant(&bodies.position[body]));
        orientation = multiply(&out.body_orientation[parent], &constant_quaternion(&bodies.orientation[body]));
        for joint in joints {
            move_by_joint(model, state, out, joint, &mut position, &mut orientation);
        }
        orientation = normalize(&orientation);
    }
    let rotation = matrix(&orientation);
    out.body_position[body] = position;
    out.body_orientation[body] = orientation;
    out.body_rotation[body] = rotation;
    out.inertial_position[body] = rotate(&rotation, &constant(&bodies.inertial_position[body])) + position;
    out.inertial_rotation[body] = turned(&rotation, &out.plan.inertial[body]);
}

/// Moves a body's frame by one hinge, slide or ball joint.
#[inline(always)]
fn move_by_joint<T: Real>(
    model: &Model,
    state: &State<T>,
    out: &mut Kinematics<T>,
    joint: usize,
    position: &mut Vector3<T>,
    orientation: &mut [T; 4],
) {
    let address = model.joints.position_address[joint];
    let local_anchor = constant(&model.joints.anchor[joint]);
    let local_axis = constant(&model.joints.axis[joint]);
    let rotation = matrix(orientation);
    let anchor = rotate(&rotation, &local_anchor) + *position;
    let axis = rotate(&rotation, &local_axis);
    let displacement = state.position[address] - T::splat(model.reference_position[address]);
    let turn = match model.joints.kind[joint] {
        JointKind::Slide => {
            *position += scale(&axis, displacement);
            None
        }
        JointKind::Hinge => Some(from_axis_angle(&local_axis, displacement)),
        // A free joint is alone on its body and placed by `place_body`.
        JointKind::Ball | JointKind::Free => {
            let q = &state.position[address..];
            Some(normalize(&[q[0], q[1], q[2], q[3]]))
        }
    };
    if let Some(turn) = turn {
        *orientation = multiply(orientation, &turn);
        // The anchor stays where it was: a joint may turn the body about a point away from its origin.
        *position = anchor - rotate(&matrix(orientation), &local_anchor);
    }
    out.joint_anchor[joint] = anchor;
    out.joint_axis[joint] = axis;
}

#[inline(always)]
fn place_geoms<T: Real>(model: &Model, out: &mut Kinematics<T>) {
    for geom in 0..model.geoms.kind.len() {
        let body = model.geoms.body[geom];
        out.geom_position[geom] = out.point(body, &constant(&model.geoms.position[geom]));
        out.geom_rotation[geom] = turned(&out.body_rotation[body], &out.plan.geom[geom]);
    }
    if !out.overrides.is_empty() {
        place_own_shapes(model, out);
    }
}

/// Places the shapes that episodes have of their own.
fn place_own_shapes<T: Real>(model: &Model, out: &mut Kinematics<T>) {
    let Kinematics { body_position, body_rotation, geom_position, overrides, .. } = out;
    for lane in 0..T::LANES {
        for shape in overrides.lane(lane).iter().flat_map(|own| &own.shapes) {
            let body = model.geoms.body[shape.geom];
            let (origin, rotation) = (lane_of(&body_position[body], lane), matrix_of(&body_rotation[body], lane));
            let place = rotate(&rotation, &shape.position) + origin;
            geom_position[shape.geom].iter_mut().zip(place.iter()).for_each(|(slot, value)| slot.set_lane(lane, *value));
        }
    }
}

/// Masses of all bodies and subtrees.
#[inline(always)]
fn weigh<T: Real>(model: &Model, state: &State<T>, out: &mut Kinematics<T>) {
    let bodies = &model.bodies;
    for ((mass, &own), &factor) in out.mass.iter_mut().zip(&bodies.mass).zip(&state.mass_scale) {
        *mass = T::splat(own) * factor;
    }
    out.subtree_mass.copy_from_slice(&out.mass);
    for body in (1..bodies.parent.len()).rev() {
        let mass = out.subtree_mass[body];
        out.subtree_mass[bodies.parent[body]] += mass;
    }
}

/// Centre of mass of every subtree, swept from the leaves to the root.
#[inline(always)]
fn centres_of_mass<T: Real>(model: &Model, out: &mut Kinematics<T>) {
    let parents = &model.bodies.parent;
    for body in 0..parents.len() {
        out.subtree_com[body] = scale(&out.inertial_position[body], out.mass[body]);
    }
    for body in (1..parents.len()).rev() {
        let moment = out.subtree_com[body];
        out.subtree_com[parents[body]] += moment;
        out.subtree_com[body] = divided(model, body, &moment, out);
    }
    out.subtree_com[0] = divided(model, 0, &out.subtree_com[0], out);
}

/// The centre of a subtree with this first moment; of one without mass, the body's own centre.
#[inline(always)]
fn divided<T: Real>(model: &Model, body: usize, moment: &Vector3<T>, of: &Kinematics<T>) -> Vector3<T> {
    match model.bodies.subtree_mass[body] < super::rotation::MINIMUM {
        true => of.inertial_position[body],
        false => scale(moment, T::splat(1.0) / of.subtree_mass[body]),
    }
}

/// Motion axes of all dofs about the centre of mass of their tree.
#[inline(always)]
fn motion_axes<T: Real>(model: &Model, out: &mut Kinematics<T>) {
    let unit = |axis: usize| Vector3::from_fn(|row, _| T::splat(if row == axis { 1.0 } else { 0.0 }));
    for joint in 0..model.joints.kind.len() {
        let body = model.joints.body[joint];
        let first = model.joints.dof_address[joint];
        let arm = out.reference(model, body) - out.joint_anchor[joint];
        let turning = |axis: Vector3<T>| [axis, cross(&axis, &arm)];
        let rotation = out.body_rotation[body];
        match model.joints.kind[joint] {
            JointKind::Hinge => out.dof_axis[first] = turning(out.joint_axis[joint]),
            JointKind::Slide => out.dof_axis[first] = [zero(), out.joint_axis[joint]],
            JointKind::Ball => {
                for axis in 0..3 {
                    out.dof_axis[first + axis] = turning(rotation.column(axis).into_owned());
                }
            }
            JointKind::Free => {
                for axis in 0..3 {
                    out.dof_axis[first + axis] = [zero(), unit(axis)];
                    out.dof_axis[first + 3 + axis] = turning(rotation.column(axis).into_owned());
                }
            }
        }
    }
}

#[inline(always)]
fn turned<T: Real>(rotation: &Matrix3<T>, local: &Option<Matrix3<f64>>) -> Matrix3<T> {
    match local {
        None => *rotation,
        Some(local) => product(rotation, &local.map(T::splat)),
    }
}
