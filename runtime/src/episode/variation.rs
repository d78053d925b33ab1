//! What an episode has of its own of body and scene: strengths, masses, frictions, joints, shapes and places that the task draws.

use super::streams::{EpisodeKey, Stream};
use super::{EpisodeError, Fault, initial_state};
use crate::body::Body;
use msk_physics::State;
use msk_physics::model::Model;
use msk_program::body::Property;
use msk_program::init::{Init, JointValue, Scaling};

mod shapes;

/// Writes into `state` what is drawn of body and scene; it stays for the whole episode.
///
/// # Errors
/// A number that no body can have.
pub(super) fn vary(model: &Model, body: &Body, init: &Init, key: EpisodeKey, state: &mut State<f64>) -> Result<(), Fault> {
    let variation = &init.variation;
    strengthen(&variation.strengths, key, &model.actuators.name, &mut state.strength)?;
    vary_masses(model, body, init, key, state)?;
    vary_joints(model, body, init, key, state)?;
    shapes::vary(model, body, variation, state)?;
    for friction in &variation.frictions {
        let whose = || match friction.object {
            Some(object) => format!("the friction of `{}`", model.bodies.name[body.objects[object].body]),
            None => "the friction of the ground".to_owned(),
        };
        let sliding = allowed(whose, friction.sliding, Least::Zero)?;
        let shapes = friction.object.map_or(&body.level, |object| &body.objects[object].shapes);
        shapes.iter().for_each(|&shape| state.friction[shape] = sliding);
    }
    for start in &init.objects {
        initial_state::stand(body, start, state);
    }
    Ok(())
}

fn vary_masses(model: &Model, body: &Body, init: &Init, key: EpisodeKey, state: &mut State<f64>) -> Result<(), Fault> {
    let landmarks = body.landmarks.iter().filter(|landmark| !landmark.of_scene).count();
    let mut factors = Stream::new(key, "init/mass");
    for scaling in &init.variation.segments {
        // All landmarks together stand for all segments, those without a landmark, too.
        let mut segments: Vec<usize> = match scaling.members.len() == landmarks {
            true => body.own().collect(),
            false => scaling.members.iter().map(|&landmark| body.landmarks[landmark].body).collect(),
        };
        segments.sort_unstable();
        segments.dedup();
        for segment in segments {
            let factor = factor(scaling, &mut factors);
            state.mass_scale[segment] *=
                allowed(|| format!("the factor of the mass of `{}`", model.bodies.name[segment]), factor, Least::AboveZero)?;
        }
    }
    for known in &init.variation.masses {
        let object = body.objects[known.object].body;
        let mass = allowed(
            || format!("the mass of `{}`", model.bodies.name[body.objects[known.object].body]),
            known.mass,
            Least::AboveZero,
        )?;
        // An object whose mass is drawn has one in the model.
        state.mass_scale[object] *= mass / model.bodies.mass[object];
    }
    Ok(())
}

fn vary_joints(model: &Model, body: &Body, init: &Init, key: EpisodeKey, state: &mut State<f64>) -> Result<(), Fault> {
    let variation = &init.variation;
    let mut factors = Stream::new(key, "init/damping");
    for scaling in &variation.dampings {
        for joint in scaling.members.iter().map(|&joint| &body.joints[joint]) {
            let factor = factor(scaling, &mut factors);
            state.damping[joint.dof] *=
                allowed(|| format!("the factor of the damping of `{}`", joint.name), factor, Least::Zero)?;
        }
    }
    let mut factors = Stream::new(key, "init/stiffness");
    for scaling in &variation.stiffnesses {
        for joint in scaling.members.iter().map(|&joint| &body.joints[joint]) {
            let factor = factor(scaling, &mut factors);
            state.stiffness[joint.index] *=
                allowed(|| format!("the factor of the stiffness of `{}`", joint.name), factor, Least::Zero)?;
        }
    }
    for JointValue { object, joint, property, value } in &variation.joints {
        let joint = model.bodies.joints[body.objects[*object].body].start + joint;
        let word = if *property == Property::Stiffness { "stiffness" } else { "damping" };
        let value = allowed(|| format!("the {word} of `{}`", model.joints.name[joint]), *value, Least::Zero)?;
        match property {
            Property::Stiffness => state.stiffness[joint] = value,
            _ => {
                let dofs = (0..model.nv).filter(|&dof| model.dofs.joint[dof] == joint);
                dofs.for_each(|dof| state.damping[dof] = value);
            }
        }
    }
    Ok(())
}

/// Whether the factors of an initial state scale anything.
///
/// # Errors
/// A joint whose damping or stiffness is zero.
pub(super) fn check(model: &Model, body: &Body, init: &Init) -> Result<(), EpisodeError> {
    let variation = &init.variation;
    let rows = [("damping", &variation.dampings), ("stiffness", &variation.stiffnesses)];
    for (what, scaling) in rows.into_iter().flat_map(|(what, rows)| rows.iter().map(move |row| (what, row))) {
        let known = |joint: usize| match what {
            "damping" => model.dofs.damping[body.joints[joint].dof],
            _ => model.joints.stiffness[body.joints[joint].index],
        };
        if scaling.members.iter().all(|&joint| known(joint) == 0.0) {
            let joint = scaling.members.first().map_or_else(String::new, |&joint| body.joints[joint].name.clone());
            return Err(EpisodeError::NothingToScale { what, joint });
        }
    }
    Ok(())
}

/// Muscles are the actuators of the model, in their order.
fn strengthen(rows: &[Scaling], key: EpisodeKey, names: &[String], strength: &mut [f64]) -> Result<(), Fault> {
    let mut factors = Stream::new(key, "init/strength");
    for scaling in rows {
        for &muscle in &scaling.members {
            let factor = factor(scaling, &mut factors);
            strength[muscle] *= allowed(|| format!("the factor of the strength of `{}`", names[muscle]), factor, Least::Zero)?;
        }
    }
    Ok(())
}

/// The factor of the next member.
fn factor(scaling: &Scaling, factors: &mut Stream) -> f64 {
    match scaling.each {
        Some([low, high]) => low + (high - low) * factors.uniform(),
        None => scaling.factor,
    }
}

/// The value, if it is finite and as `least` has it.
fn allowed(what: impl Fn() -> String, value: f64, least: Least) -> Result<f64, Fault> {
    let (holds, expected) = match least {
        Least::Zero => (value >= 0.0, "a number that is not negative"),
        Least::AboveZero => (value > 0.0, "a number above 0"),
        Least::NotZero => (value != 0.0, "a number other than 0"),
        Least::Finite => (true, "a finite number"),
    };
    let fault = || Fault::Variation { what: what(), value, expected: expected.to_owned() };
    if holds && value.is_finite() { Ok(value) } else { Err(fault()) }
}

/// What a drawn number is at least.
#[derive(Clone, Copy)]
enum Least {
    Zero,
    AboveZero,
    NotZero,
    Finite,
}
