//! How an episode begins: a pose with noise on what is free, couplings solved, the root where the task wants it.

use super::streams::{EpisodeKey, Stream};
use crate::body::{Body, InitialGuess, Joint, OutOfReach};
use msk_physics::model::{Equality, Model, rotation};
use msk_physics::scalar::Real;
use msk_physics::{self as physics, State, Workspace};
use msk_program::task::{Init, ObjectStart, Settle, Spread};
use nalgebra::Vector3;

/// Puts `state` into the initial state of an episode: everything else in it is as after [`State::new`].
///
/// 0. Free objects stand where the task puts them, others where the scene has them.
/// 1. The task's coordinates, with normal noise on the independent hinges; a draw beyond a limit is folded back into the
///    range, since a pose that violates its limits would begin with a kick.
/// 2. Coupled joints follow from their couplings.
/// 3. The root stands upright at its heading, on the ground if the task asks for it: the noisy pose touches it, too.
/// 4. What is aligned comes to its place.
/// 5. The task's velocities, with noise on those of the independent joints; coupled velocities follow from the couplings'
///    derivatives.
///
/// The root itself gets no noise, so its quaternion stays a rotation.
///
/// # Errors
/// A place that joints cannot reach.
pub fn begin(
    model: &Model,
    body: &Body,
    init: &Init,
    key: EpisodeKey,
    state: &mut State<f64>,
    workspace: &mut Workspace<f64>,
) -> Result<(), OutOfReach> {
    init.objects.iter().for_each(|start| place_object(body, start, state));
    let mut noise = Stream::new(key, "init/noise/joints");
    let noisy = |(index, (joint, &coordinate)): (usize, (&Joint, &f64))| {
        let deviation = draw(init.coordinate_noise.get(index), &mut noise);
        fold(coordinate + deviation, coordinate, joint.range)
    };
    let coordinates: Vec<f64> = body.joints.iter().zip(&init.coordinates).enumerate().map(noisy).collect();
    body.place(model, &init.root, &coordinates, state, workspace);
    body.align(model, &init.alignments, InitialGuess::Pose, state, workspace)?;

    let mut noise = Stream::new(key, "init/noise/velocities");
    for (index, joint) in body.joints.iter().enumerate() {
        let velocity = init.velocities.get(index).copied().unwrap_or(0.0);
        state.velocity[joint.dof] = velocity + draw(init.velocity_noise.get(index), &mut noise);
    }
    body.solve_coupled_velocities(model, &state.position, &mut state.velocity);
    Ok(())
}

/// Puts an object that is placed for every episode where it stands in this one.
pub fn stand(body: &Body, start: &ObjectStart, state: &mut State<f64>) {
    let Some(placed) = body.objects.get(start.object).and_then(|object| object.placed) else { return };
    state.mocap_position[placed] = start.position.into();
    state.mocap_orientation[placed] = rotation::normalized(start.orientation).unwrap_or(rotation::IDENTITY);
}

/// Puts a free object in its place. Velocities are given in world axes; the state has the spin in the object's own.
fn place_object(body: &Body, start: &ObjectStart, state: &mut State<f64>) {
    let Some((position, dof)) = body.objects.get(start.object).and_then(|object| object.free) else { return };
    let orientation = rotation::normalized(start.orientation).unwrap_or(rotation::IDENTITY);
    let spin = rotation::matrix(orientation).tr_mul(&Vector3::from(start.spin));
    state.position[position..position + 3].copy_from_slice(&start.position);
    state.position[position + 3..position + 7].copy_from_slice(&orientation);
    state.velocity[dof..dof + 3].copy_from_slice(&start.velocity);
    state.velocity[dof + 3..dof + 6].copy_from_slice(spin.as_slice());
}

/// Takes what the scene holds `here` as it stands now: the second frame of each such connection is put where the first is.
pub fn hold(model: &Model, body: &Body, state: &mut State<f64>, workspace: &mut Workspace<f64>) {
    if !body.connections.iter().any(|connection| connection.here) {
        return;
    }
    let kinematics = &mut workspace.kinematics;
    physics::kinematics::update(model, state, kinematics);
    for connection in body.connections.iter().filter(|connection| connection.here) {
        let (Equality::Connect(attachment) | Equality::Weld { attachment, .. }) = &model.equalities.kind[connection.equality]
        else {
            continue;
        };
        let [first, second] = attachment.bodies;
        let point = kinematics.point(first, &attachment.position[0]) - kinematics.body_position[second];
        let frame = rotation::product(kinematics.body_orientation[first], attachment.orientation[0]);
        let [w, x, y, z] = kinematics.body_orientation[second];
        state.held[connection.equality] =
            (kinematics.body_rotation[second].tr_mul(&point), rotation::product([w, -x, -y, -z], frame));
    }
}

/// Lets physics pass with all muscles held at one activation. The time is 0 afterwards, and excitations are those of rest.
///
/// # Errors
/// Those of the physics.
pub fn settle(
    model: &Model,
    settle: &Settle,
    state: &mut State<f64>,
    workspace: &mut Workspace<f64>,
) -> Result<(), physics::Fault> {
    state.activation.fill(settle.activation);
    state.control.fill(settle.activation);
    for _ in 0..settle.steps {
        physics::step(model, state, workspace)?;
        state.activation.fill(settle.activation);
    }
    state.control.fill(0.0);
    if settle.at_rest {
        state.velocity.fill(0.0);
    }
    state.time = 0.0;
    Ok(())
}

/// A deviation; what does not scatter draws nothing.
fn draw(spread: Option<&Spread>, noise: &mut Stream) -> f64 {
    match spread {
        None | Some(Spread::None) => 0.0,
        Some(Spread::Normal(deviation)) => deviation * noise.normal(),
        Some(Spread::Uniform(low, high)) => low + (high - low) * noise.uniform(),
    }
}

/// Mirrors a value that noise has driven out of `range` at the limit it passed. A `centre` outside the range was the task's
/// own wish and is left as it is, noise included.
fn fold(value: f64, centre: f64, range: Option<[f64; 2]>) -> f64 {
    match range {
        Some([low, high]) if low <= centre && centre <= high => {
            let mirrored = if value < low {
                2.0 * low - value
            } else if value > high {
                2.0 * high - value
            } else {
                value
            };
            mirrored.clip(low, high)
        }
        _ => value,
    }
}

#[cfg(test)]
mod tests {
    use super::fold;

    #[test]
    fn noise_is_folded_back_at_a_limit() {
        let knee = Some([0.0, 2.0]);
        assert_eq!(fold(-0.01, 0.0, knee), 0.01);
        assert_eq!(fold(0.01, 0.0, knee), 0.01);
        assert_eq!(fold(2.5, 1.9, knee), 1.5);
    }

    #[test]
    fn noise_wider_than_the_range_stays_inside() {
        assert_eq!(fold(9.0, 1.0, Some([0.0, 2.0])), 0.0);
    }

    #[test]
    fn unlimited_joints_and_wilful_poses_are_left_alone() {
        assert_eq!(fold(9.0, 1.0, None), 9.0);
        assert_eq!(fold(-0.1, -0.2, Some([0.0, 2.0])), -0.1);
    }
}
