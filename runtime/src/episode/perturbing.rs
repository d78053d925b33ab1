//! What an evaluation perturbs in an episode: see [`Perturbation`](crate::perturbation::Perturbation).

use super::streams::Stream;
use super::{Episode, Player};
use crate::action::Action;
use msk_physics::scalar::Real;
use msk_program::task::Disturbance;

/// When the first push begins, how long a push lasts, and from when to when, s.
const FIRST_PUSH: f64 = 1.0;
const PUSH: f64 = 0.2;
const BETWEEN_PUSHES: f64 = 2.0;

impl Player<'_> {
    /// Draws what the episode has of its own of body and scene, beside what its task draws.
    pub fn perturb_parameters(&mut self) {
        let engine = self.engine;
        let (perturbation, body) = (&engine.perturbation, &engine.body);
        let Episode { key, state, pushes, .. } = &mut *self.episode;
        let factor = |stream: &mut Stream, size: f64| 1.0 - size + 2.0 * size * stream.uniform();
        if perturbation.gain > 0.0 {
            let mut stream = Stream::new(*key, "perturbation/gain");
            state.strength.iter_mut().for_each(|strength| *strength *= factor(&mut stream, perturbation.gain));
        }
        if perturbation.friction > 0.0 {
            let drawn = factor(&mut Stream::new(*key, "perturbation/friction"), perturbation.friction);
            body.ground.iter().for_each(|&shape| state.friction[shape] *= drawn);
        }
        if perturbation.mass > 0.0 {
            let mut stream = Stream::new(*key, "perturbation/mass");
            body.own().for_each(|member| state.mass_scale[member] *= factor(&mut stream, perturbation.mass));
        }
        let root = body.landmarks.iter().position(|landmark| landmark.body == body.root.body);
        if let Some(landmark) = root.filter(|_| perturbation.push > 0.0) {
            let (sine, cosine) = libm::sincos(core::f64::consts::TAU * Stream::new(*key, "perturbation/push").uniform());
            let size = perturbation.push * body.mass * engine.model.options.gravity.norm();
            let steps = |time: f64| (time * engine.task.control_frequency).round().at_least(1.0) as u32;
            let force = [size * cosine, size * sine, 0.0];
            let (start, steps, every) = (steps(FIRST_PUSH), steps(PUSH), steps(BETWEEN_PUSHES));
            pushes.push(Disturbance { landmark, force, torque: [0.0; 3], start, steps, every });
        }
    }

    /// The entries of the action that takes effect in the step to be taken: late, and with noise. `None` where they are those of the
    /// policy.
    pub fn perturbed_entries(&mut self, action: Action<'_>) -> Option<Vec<f64>> {
        let engine = self.engine;
        let perturbation = &engine.perturbation;
        if perturbation.latency == 0 && perturbation.action == 0.0 {
            return None;
        }
        let mut entries = action.entries.to_vec();
        if perturbation.latency > 0 {
            let late = &mut self.episode.late;
            let given = std::mem::replace(&mut entries, engine.action(action.acts_on).entries);
            late.push_back(given);
            if late.len() > perturbation.latency as usize {
                entries = late.pop_front().unwrap_or(entries);
            }
        }
        if perturbation.action > 0.0 {
            let mut stream = Stream::new(self.episode.key, &format!("perturbation/action/{}", self.episode.steps()));
            for entry in &mut entries {
                *entry = (entry.clip(-1.0, 1.0) + perturbation.action * stream.normal()).clip(-1.0, 1.0);
            }
        }
        Some(entries)
    }

    /// Adds noise to the observation that has just been written.
    pub fn perturb_observation(&mut self) {
        let perturbation = &self.engine.perturbation;
        if perturbation.observation > 0.0 {
            let step = self.episode.steps();
            let mut stream = Stream::new(self.episode.key, &format!("perturbation/observation/{step}"));
            perturbation.disturb(&mut self.episode.observation, || stream.normal());
        }
    }
}
