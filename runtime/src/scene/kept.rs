//! What a model contains besides its parts: sensors read the same parts in a scene, and key frames put them where they
//! put them alone, with what was added at its reference configuration and at rest.

use super::assembly::widths;
use super::builder::SceneBuilder;
use msk_physics::model::{Framed, Keyframe, Limited, Measure, Model, Surface};

/// Moves a sensor's references to bodies, joints, shapes and sites.
pub(super) fn move_measure(measure: &mut Measure, [bodies, joints, geoms, sites]: [&Vec<usize>; 4]) {
    let framed = |frame: &mut Framed| match frame {
        Framed::InertialBody(body) | Framed::Body(body) => *body = bodies[*body],
        Framed::Geom(geom) => *geom = geoms[*geom],
        Framed::Site(site) => *site = sites[*site],
    };
    match measure {
        Measure::Touch { site, .. }
        | Measure::Accelerometer(site)
        | Measure::Velocimeter(site)
        | Measure::Gyro(site)
        | Measure::Force(site)
        | Measure::Torque(site)
        | Measure::Range(site) => *site = sites[*site],
        Measure::JointPosition(joint)
        | Measure::JointVelocity(joint)
        | Measure::JointActuatorForce(joint)
        | Measure::BallOrientation(joint)
        | Measure::BallVelocity(joint)
        | Measure::Limit(Limited::Joint(joint), _) => *joint = joints[*joint],
        Measure::FramePosition(frame, reference)
        | Measure::FrameOrientation(frame, reference)
        | Measure::FrameAxis(frame, reference, _)
        | Measure::FrameVelocity(frame, reference)
        | Measure::FrameAngularVelocity(frame, reference) => {
            framed(frame);
            reference.iter_mut().for_each(framed);
        }
        Measure::FrameAcceleration(frame) | Measure::FrameAngularAcceleration(frame) => framed(frame),
        Measure::SubtreeCenter(body) | Measure::SubtreeVelocity(body) | Measure::SubtreeAngularMomentum(body) => {
            *body = bodies[*body];
        }
        Measure::Gap(surfaces, _) => {
            for surface in surfaces {
                match surface {
                    Surface::Geom(geom) => *geom = geoms[*geom],
                    Surface::Body(body) => *body = bodies[*body],
                }
            }
        }
        // Tendons and actuators keep their places.
        Measure::TendonPosition(_)
        | Measure::TendonVelocity(_)
        | Measure::ActuatorPosition(_)
        | Measure::ActuatorVelocity(_)
        | Measure::ActuatorForce(_)
        | Measure::TendonActuatorForce(_)
        | Measure::Limit(Limited::Tendon(_), _)
        | Measure::Clock => {}
    }
}

/// The model's key frames in the scene, whose joints stand in `order`.
pub(super) fn keyframes(builder: &SceneBuilder<'_>, order: &[usize], model: &Model) -> Vec<Keyframe> {
    let base = &builder.base.joints;
    let grown = |frame: &Keyframe| {
        let mut position = model.reference_position.clone();
        let mut velocity = vec![0.0; position.len()];
        let (mut coordinate, mut dof) = (0, 0);
        for &index in order {
            let kind = base.kind.get(index).copied();
            let [coordinates, freedom] = widths(kind.unwrap_or_else(|| builder.joints[index - base.kind.len()].1.kind));
            if kind.is_some() {
                let (from, first) = (base.position_address[index], base.dof_address[index]);
                position[coordinate..coordinate + coordinates].copy_from_slice(&frame.position[from..from + coordinates]);
                velocity[dof..dof + freedom].copy_from_slice(&frame.velocity[first..first + freedom]);
            }
            (coordinate, dof) = (coordinate + coordinates, dof + freedom);
        }
        velocity.truncate(dof);
        Keyframe { position, velocity, ..frame.clone() }
    };
    builder.base.keyframes.iter().map(grown).collect()
}
