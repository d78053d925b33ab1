//! What an episode has of its own of body and scene: strengths, masses, frictions and places that the task draws.

use super::streams::{EpisodeKey, Stream};
use super::{Fault, initial_state};
use crate::body::Body;
use msk_physics::State;
use msk_physics::model::Model;
use msk_program::init::{Init, Scaling};

/// Writes into `state` what is drawn of body and scene; it stays for the whole episode.
///
/// # Errors
/// A number that no body can have.
pub(super) fn vary(model: &Model, body: &Body, init: &Init, key: EpisodeKey, state: &mut State<f64>) -> Result<(), Fault> {
    let variation = &init.variation;
    strengthen(&variation.strengths, key, &model.actuators.name, &mut state.strength)?;
    vary_masses(model, body, init, key, state)?;
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

/// The value, if it is finite and not below 0, or above 0 where `least` says so.
fn allowed(what: impl Fn() -> String, value: f64, least: Least) -> Result<f64, Fault> {
    let (holds, expected) = match least {
        Least::Zero => (value >= 0.0, "a number that is not negative"),
        Least::AboveZero => (value > 0.0, "a number above 0"),
    };
    let fault = || Fault::Variation { what: what(), value, expected: expected.to_owned() };
    if holds && value.is_finite() { Ok(value) } else { Err(fault()) }
}

/// What a drawn number is at least.
#[derive(Clone, Copy)]
enum Least {
    Zero,
    AboveZero,
}
