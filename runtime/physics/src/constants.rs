//! Constants of a model that follow from the physics at its reference configuration.
//!
//! 1. inverse weights: how much a unit force accelerates a body or dof, the scale of every constraint's regularisation;
//! 2. tendon lengths, at the reference configuration and where joint springs rest, where springs without a length do too;
//! 3. the frames that equalities hold together as they stand at the reference configuration;
//! 4. the joint-space acceleration that an actuator causes per unit force, from which MuJoCo sets peak forces not given,
//!    and the damping of servos that ask for a damping ratio.

use super::{
    actuation,
    inertia::{self, Inertia},
    kinematics::{self, Kinematics},
    rotation::{MINIMUM, conjugate, multiply},
    spatial::pair,
    state::State,
    tendons::{self, TendonPaths},
};
use crate::model::{Actuators, AttachmentOrigin, Bias, Equality, Gain, JointKind, Model};
use crate::scalar::Real;
use nalgebra::Vector3;

/// Fills [`Bodies::inverse_weight`](crate::model::Bodies), [`Dofs::inverse_weight`](crate::model::Dofs), lengths and inverse
/// weights of [`Tendons`](crate::model::Tendons), the derived frames of [`Equalities`](crate::model::Equalities) and
/// [`Actuators::acceleration_scale`](crate::model::Actuators). Everything else in the model must be complete.
///
/// # Errors
/// A mass matrix without an inverse: the message names a joint that takes part in it.
pub fn derive(model: &mut Model) -> Result<(), String> {
    let state = State::<f64>::new(model);
    let mut kinematics = Kinematics::new(model);
    let mut inertia = Inertia::new(model);
    let mut tendons = TendonPaths::new(model);
    kinematics::update_lanes(model, &state, &mut kinematics);
    inertia::update(model, &state, &kinematics, &mut inertia);
    model.mean_inertia = mean_inertia(model, &inertia.matrix);
    inertia::factorize(model, &mut inertia);
    invertible(model, &inertia.factor)?;
    tendons::update(&state, &kinematics, &mut tendons);

    model.tendons.reference_length = tendons.length.clone();
    derive_attachments(model, &kinematics);
    let mut row = vec![0.0; model.nv];
    let mut weight = |body: usize| body_weight(model, &kinematics, &inertia.factor, body, &mut row);
    model.bodies.inverse_weight = (0..model.bodies.parent.len()).map(&mut weight).collect();
    model.dofs.inverse_weight = dof_weights(model, &inertia.factor);
    let tendon_weight = |tendon: usize| {
        tendons::moment_arms(model, &kinematics, &tendons, tendon, &mut row);
        response(model, &inertia.factor, &mut row)
    };
    model.tendons.inverse_weight = (0..model.tendons.path.len()).map(tendon_weight).collect();
    for actuator in 0..model.actuators.name.len() {
        actuation::moment(model, &state, &kinematics, &tendons, actuator, &mut row);
        let moment = row.clone();
        inertia::solve(model, &inertia.factor, &mut row);
        model.actuators.acceleration_scale[actuator] = row.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        let response = moment.iter().zip(&row).map(|(arm, acceleration)| arm * acceleration).sum();
        settle_damping(&mut model.actuators, actuator, response);
    }
    model.tendons.resting_length = resting_lengths(model, state, &mut kinematics, tendons);
    Ok(())
}

/// Mean of the diagonal of the mass matrix, one where nothing moves.
fn mean_inertia(model: &Model, matrix: &[f64]) -> f64 {
    let trace: f64 = model.dofs.row.iter().map(|row| matrix[row.end - 1]).sum();
    if model.nv == 0 { 1.0 } else { (trace / model.nv as f64).at_least(MINIMUM) }
}

/// Whether every pivot D of the factorised mass matrix L'DL is positive. One is not where rounding leaves nothing of a joint's own
/// inertia: two slides along one axis, under a mass of 1e14 kg with an armature of 1e-5 kg each, or without any armature.
fn invertible(model: &Model, factor: &[f64]) -> Result<(), String> {
    let pivot = |dof: usize| factor[model.dofs.row[dof].end - 1];
    match (0..model.nv).find(|&dof| !(pivot(dof) > 0.0 && pivot(dof).is_finite())) {
        None => Ok(()),
        Some(dof) => Err(format!(
            "the mass matrix has no inverse at the reference configuration: rounding leaves nothing of the inertia that joint {} (`{}`) \
             moves by itself; two joints may have the same axis, or masses differ by more than fifteen digits (an `armature` gives \
             a joint inertia of its own)",
            model.dofs.joint[dof], model.joints.name[model.dofs.joint[dof]]
        )),
    }
}

/// Tendon lengths with every hinge and slide where its spring rests, and free and ball joints at the reference.
fn resting_lengths(
    model: &Model,
    mut state: State<f64>,
    kinematics: &mut Kinematics<f64>,
    mut tendons: TendonPaths<f64>,
) -> Vec<f64> {
    let joints = &model.joints;
    for joint in 0..joints.kind.len() {
        if matches!(joints.kind[joint], JointKind::Hinge | JointKind::Slide) {
            state.position[joints.position_address[joint]] = joints.spring_reference[joint];
        }
    }
    kinematics::update_lanes(model, &state, kinematics);
    tendons::update(&state, kinematics, &mut tendons);
    tendons.length
}

/// The frame that the file does not give of each attachment that holds at the reference configuration: a connection's point
/// in its second body, a weld's frame in its first.
fn derive_attachments(model: &mut Model, kinematics: &Kinematics<f64>) {
    let local =
        |body: usize, point: Vector3<f64>| kinematics.body_rotation[body].tr_mul(&(point - kinematics.body_position[body]));
    for kind in &mut model.equalities.kind {
        match kind {
            Equality::Connect(attachment) if attachment.origin == AttachmentOrigin::Reference => {
                let [first, second] = attachment.bodies;
                attachment.position[1] = local(second, kinematics.point(first, &attachment.position[0]));
            }
            Equality::Weld { attachment, .. } if attachment.origin == AttachmentOrigin::Reference => {
                let [first, second] = attachment.bodies;
                attachment.position[0] = local(first, kinematics.point(second, &attachment.position[1]));
                let [first, second] = [first, second].map(|body| kinematics.body_orientation[body]);
                attachment.orientation[0] = multiply(&conjugate(&first), &second);
            }
            _ => {}
        }
    }
}

/// Gives joints the spring and damper that have the wanted time constant t (s) and damping ratio z with the inertia
/// m that the joint feels at the reference configuration, as a constraint with these figures would: stiffness m / (t z)², damping 2 m / t.
pub fn resolve_spring_damper(model: &mut Model, wanted: &[(usize, [f64; 2])]) {
    if wanted.is_empty() {
        return;
    }
    let state = State::<f64>::new(model);
    let mut kinematics = Kinematics::new(model);
    let mut inertia = Inertia::new(model);
    kinematics::update_lanes(model, &state, &mut kinematics);
    inertia::update(model, &state, &kinematics, &mut inertia);
    inertia::factorize(model, &mut inertia);
    let weights = dof_weights(model, &inertia.factor);
    for &(joint, [time, ratio]) in wanted {
        let dofs: Vec<usize> = (0..model.nv).filter(|&dof| model.dofs.joint[dof] == joint).collect();
        let mean = dofs.len() as f64 / dofs.iter().map(|&dof| weights[dof]).sum::<f64>().at_least(MINIMUM);
        model.joints.stiffness[joint] = mean / (time * ratio).squared().at_least(MINIMUM);
        for dof in dofs {
            model.dofs.damping[dof] = 2.0 * mean / time.at_least(MINIMUM);
        }
    }
}

/// Turns the damping ratio of a servo (a positive last figure of its bias) into a damping, given the acceleration that a unit
/// force causes along its own direction, 1/kg: critical damping of a mass m on a spring k is 2 sqrt(k m).
fn settle_damping(actuators: &mut Actuators, actuator: usize, response: f64) {
    if let (Gain::Fixed(pull), Bias::Affine([_, back, damping])) = (actuators.gain[actuator], &mut actuators.bias[actuator])
        && pull == -*back
        && *damping > 0.0
    {
        *damping *= -2.0 * (pull / response.at_least(MINIMUM)).at_least(0.0).sqrt();
    }
}

/// J M^-1 J' for one Jacobian row, of which `row` holds J on entry and scratch on return.
fn response(model: &Model, factor: &[f64], row: &mut [f64]) -> f64 {
    // With M = L'DL this is the sum of squares of L'^-1 J' weighted by 1 / D.
    inertia::solve_transposed(model, factor, row);
    row.iter().enumerate().map(|(dof, entry)| entry * entry / factor[model.dofs.row[dof].end - 1]).sum()
}

/// The same for a row that is zero but on the path from the dof `last` to the root; `row` holds zeros on return.
fn path_response(model: &Model, factor: &[f64], last: usize, row: &mut [f64]) -> f64 {
    let path = &model.dofs.column[model.dofs.row[last].clone()];
    for &dof in path.iter().rev() {
        let (entries, value) = (model.dofs.row[dof].clone(), row[dof]);
        let above = model.dofs.column[entries.clone()].iter().zip(&factor[entries]);
        above.filter(|(column, _)| **column != dof).for_each(|(&column, &entry)| row[column] -= entry * value);
    }
    let square = |&dof: &usize| row[dof] * row[dof] / factor[model.dofs.row[dof].end - 1];
    let sum = path.iter().map(square).sum();
    path.iter().for_each(|&dof| row[dof] = 0.0);
    sum
}

/// Mean response of a body's centre of mass to forces (1/kg) and of its orientation to torques (1/(kg m²)).
///
/// `row` is scratch memory of `nv` zeros, and zero again on return.
fn body_weight(model: &Model, kinematics: &Kinematics<f64>, factor: &[f64], body: usize, row: &mut [f64]) -> [f64; 2] {
    let weld = model.bodies.weld[body];
    if weld == 0 {
        return [0.0; 2];
    }
    let Some(last) = model.bodies.dofs[weld].clone().next_back() else {
        return [0.0; 2];
    };
    if only_slides(model, body) {
        return [1.0 / model.bodies.mass[body].at_least(MINIMUM), 0.0];
    }
    let arm = kinematics.inertial_position[body] - kinematics.reference(model, body);
    let mut mean = |force: &dyn Fn(Vector3<f64>) -> [Vector3<f64>; 2]| {
        let mut sum = 0.0;
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            for dof in core::iter::successors(Some(last), |&dof| model.dofs.parent[dof]) {
                row[dof] = pair(&kinematics.dof_axis[dof], &force(axis));
            }
            sum += path_response(model, factor, last, row);
        }
        sum / 3.0
    };
    [mean(&|axis| [arm.cross(&axis), axis]), mean(&|axis| [axis, Vector3::zeros()])]
}

/// Whether a body does nothing but slide along its own axes, with its centre of mass at their origin, on what is fixed, and
/// carries no other. For such a body MuJoCo takes the mass alone: not the mean over directions, and without rotor inertia.
fn only_slides(model: &Model, body: usize) -> bool {
    let (bodies, joints) = (&model.bodies, &model.joints);
    let along_axis = |joint: usize| {
        let aligned = joints.axis[joint].iter().any(|part| part.abs() > 1.0 - MINIMUM);
        joints.kind[joint] == JointKind::Slide && aligned && joints.anchor[joint].norm() < SMALL
    };
    let [_, x, y, z] = bodies.inertial_orientation[body];
    let centred = bodies.inertial_position[body].norm() < SMALL && Vector3::new(x, y, z).norm() < SMALL;
    body > 0
        && bodies.weld[bodies.parent[body]] == 0
        && !bodies.joints[body].is_empty()
        && bodies.joints[body].clone().all(along_axis)
        && centred
        && !bodies.parent.contains(&body)
}

/// Distances (m) and angles (rad) below this are none where frames are compared.
const SMALL: f64 = 1e-6;

/// Diagonal of the inverse mass matrix, averaged over a ball's three dofs and a free joint's two triples.
fn dof_weights(model: &Model, factor: &[f64]) -> Vec<f64> {
    let mut row = vec![0.0; model.nv];
    let mut weights: Vec<f64> = (0..model.nv)
        .map(|dof| {
            row[dof] = 1.0;
            path_response(model, factor, dof, &mut row)
        })
        .collect();
    for dof in (0..model.nv).filter(|&dof| only_slides(model, model.dofs.body[dof])) {
        weights[dof] = 1.0 / model.bodies.mass[model.dofs.body[dof]].at_least(MINIMUM);
    }
    for joint in 0..model.joints.kind.len() {
        let triples = match model.joints.kind[joint] {
            JointKind::Free => 2,
            JointKind::Ball => 1,
            JointKind::Hinge | JointKind::Slide => 0,
        };
        let first = model.joints.dof_address[joint];
        for triple in weights[first..first + 3 * triples].chunks_exact_mut(3) {
            let mean = triple.iter().sum::<f64>() / 3.0;
            triple.fill(mean);
        }
    }
    weights
}
