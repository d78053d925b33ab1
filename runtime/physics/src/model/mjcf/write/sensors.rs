//! Sensors as rows of attributes.

use super::rows::Row;
use crate::model::{Framed, GapQuantity, LimitQuantity, Limited, Measure, Model, Surface};

pub(super) fn sensor(model: &Model, sensor: usize) -> Row {
    let measure = &model.sensors.measure[sensor];
    let name = &model.sensors.name[sensor];
    let of = |tag: &'static str, attribute: &'static str, target: &str| Row::new(tag).text("name", name).text(attribute, target);
    let site = |tag, site: usize| of(tag, "site", &model.sites.name[site]);
    let joint = |tag, joint: usize| of(tag, "joint", &model.joints.name[joint]);
    let tendon = |tag, tendon: usize| of(tag, "tendon", &model.tendons.name[tendon]);
    let actuator = |tag, actuator: usize| of(tag, "actuator", &model.actuators.name[actuator]);
    let body = |tag, body: usize| of(tag, "body", &model.bodies.name[body]);
    let frame = |tag, object: Framed, reference: Option<Framed>| {
        let (kind, target) = framed(model, object);
        let row = of(tag, "objtype", kind).text("objname", target);
        match reference.map(|reference| framed(model, reference)) {
            Some((kind, target)) => row.text("reftype", kind).text("refname", target),
            None => row,
        }
    };
    let row = match *measure {
        Measure::Touch { site: index, .. } => site("touch", index),
        Measure::Accelerometer(index) => site("accelerometer", index),
        Measure::Velocimeter(index) => site("velocimeter", index),
        Measure::Gyro(index) => site("gyro", index),
        Measure::Force(index) => site("force", index),
        Measure::Torque(index) => site("torque", index),
        Measure::JointPosition(index) => joint("jointpos", index),
        Measure::JointVelocity(index) => joint("jointvel", index),
        Measure::JointActuatorForce(index) => joint("jointactuatorfrc", index),
        Measure::BallOrientation(index) => joint("ballquat", index),
        Measure::BallVelocity(index) => joint("ballangvel", index),
        Measure::TendonPosition(index) => tendon("tendonpos", index),
        Measure::TendonVelocity(index) => tendon("tendonvel", index),
        Measure::ActuatorPosition(index) => actuator("actuatorpos", index),
        Measure::ActuatorVelocity(index) => actuator("actuatorvel", index),
        Measure::ActuatorForce(index) => actuator("actuatorfrc", index),
        Measure::FramePosition(object, reference) => frame("framepos", object, reference),
        Measure::FrameOrientation(object, reference) => frame("framequat", object, reference),
        Measure::FrameAxis(object, reference, 0) => frame("framexaxis", object, reference),
        Measure::FrameAxis(object, reference, 1) => frame("frameyaxis", object, reference),
        Measure::FrameAxis(object, reference, _) => frame("framezaxis", object, reference),
        Measure::FrameVelocity(object, reference) => frame("framelinvel", object, reference),
        Measure::FrameAngularVelocity(object, reference) => frame("frameangvel", object, reference),
        Measure::FrameAcceleration(object) => frame("framelinacc", object, None),
        Measure::FrameAngularAcceleration(object) => frame("frameangacc", object, None),
        Measure::SubtreeCenter(index) => body("subtreecom", index),
        Measure::SubtreeVelocity(index) => body("subtreelinvel", index),
        Measure::SubtreeAngularMomentum(index) => body("subtreeangmom", index),
        Measure::TendonActuatorForce(index) => tendon("tendonactuatorfrc", index),
        Measure::Limit(Limited::Joint(index), quantity) => {
            joint(limit(quantity, ["jointlimitpos", "jointlimitvel", "jointlimitfrc"]), index)
        }
        Measure::Limit(Limited::Tendon(index), quantity) => {
            tendon(limit(quantity, ["tendonlimitpos", "tendonlimitvel", "tendonlimitfrc"]), index)
        }
        Measure::Range(index) => site("rangefinder", index),
        Measure::Gap(surfaces, quantity) => {
            let tag = match quantity {
                GapQuantity::Distance => "distance",
                GapQuantity::Normal => "normal",
                GapQuantity::Segment => "fromto",
            };
            let sides = [["geom1", "body1"], ["geom2", "body2"]];
            surfaces.into_iter().zip(sides).fold(Row::new(tag).text("name", name), |row, (surface, [geom, body])| match surface {
                Surface::Geom(index) => row.text(geom, &model.geoms.name[index]),
                Surface::Body(index) => row.text(body, &model.bodies.name[index]),
            })
        }
        Measure::Clock => of("clock", "name", ""),
    };
    row.unless_standard("sensor", "cutoff", [model.sensors.cutoff[sensor]])
}

fn framed(model: &Model, object: Framed) -> (&'static str, &str) {
    match object {
        Framed::InertialBody(body) => ("body", &model.bodies.name[body]),
        Framed::Body(body) => ("xbody", &model.bodies.name[body]),
        Framed::Geom(geom) => ("geom", &model.geoms.name[geom]),
        Framed::Site(site) => ("site", &model.sites.name[site]),
    }
}

/// The tag of a limit's quantity.
fn limit(quantity: LimitQuantity, [distance, velocity, force]: [&'static str; 3]) -> &'static str {
    match quantity {
        LimitQuantity::Distance => distance,
        LimitQuantity::Velocity => velocity,
        LimitQuantity::Force => force,
    }
}
