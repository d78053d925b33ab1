//! Differential extrinsic plasticity (Der and Martius, PNAS 2015): a controller without a goal, which learns within seconds to make of the
//! changes of its sensors the next ones; and when it acts for a learner (Schumacher et al., DepRL, ICLR 2023, arXiv 2206.00484).
//!
//! Its [sensors](crate::sensors) shrink where what they belong to pulls, so the inverse model of the body is minus the identity.

use crate::sensors::Sensors;
use crate::settings::DepSettings;
use msk_runtime::episode::{Episode, EpisodeKey, Stream};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Added to the range of a sensor, m or rad: one that hardly moves is not blown up.
const RANGE: f64 = 0.1;
/// Keeps quotients of norms finite.
const EPSILON: f64 = 1e-32;
/// Largest change of a bias in one step, and the share of it that is forgotten.
const BIAS: [f64; 2] = [0.05, 0.001];
/// Finished episodes of which one has no interventions.
const UNDISTURBED: u64 = 5;

/// A controller of one body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Controller {
    /// Least and greatest values of the sensors so far, in all episodes.
    bounds: Vec<[f64; 2]>,
    /// Smoothed sensors, the newest first.
    history: VecDeque<Vec<f64>>,
    /// Steps so far.
    steps: usize,
    bias: Vec<f64>,
    action: Vec<f64>,
}

/// Controllers of all slots, and the switch between them and a policy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Dep {
    controllers: Vec<Controller>,
    chance: Stream,
    /// Control steps of the present intervention, or more than it has.
    intervening: usize,
    /// Episodes that have ended.
    ended: u64,
}

impl Controller {
    /// The action that answers to sensors (equations 1 to 5 of the supplement of DepRL).
    fn act(&mut self, settings: &DepSettings, sensors: &[f64]) -> Vec<f64> {
        let count = sensors.len();
        let first = self.bounds.is_empty();
        if first {
            self.bounds = sensors.iter().map(|value| [*value, *value]).collect();
            (self.bias, self.action) = (vec![0.0; count], vec![0.0; count]);
        }
        for (bounds, value) in self.bounds.iter_mut().zip(sensors) {
            bounds[0] = if *value < bounds[0] { *value } else { bounds[0] };
            bounds[1] = if *value > bounds[1] { *value } else { bounds[1] };
        }
        // Within -1 and 1 over the range so far, then smoothed.
        let scaled = |(value, [low, high]): (&f64, &[f64; 2])| 2.0 * ((value - low) / (high - low + RANGE) - 0.5);
        let scaled = sensors.iter().zip(&self.bounds).map(scaled);
        let smoothed: Vec<f64> = match self.history.front() {
            Some(last) => scaled.zip(last).map(|(value, last)| last + (value - last) / settings.smoothing as f64).collect(),
            None => scaled.collect(),
        };
        self.history.push_front(smoothed);
        self.history.truncate(settings.horizon + settings.delay + 2);
        self.steps += 1;

        let mut drive = self.drive(settings);
        for (bias, before) in self.bias.iter_mut().zip(&self.action) {
            let change = settings.bias_rate * before;
            let change = if change > BIAS[0] { BIAS[0] } else { change };
            let change = if change < -BIAS[0] { -BIAS[0] } else { change };
            *bias -= change + BIAS[1] * *bias;
        }
        let norm = libm::sqrt(drive.iter().map(|value| value * value).sum::<f64>()) + EPSILON;
        drive.iter_mut().zip(&self.bias).for_each(|(value, bias)| *value = libm::tanh(settings.gain * *value / norm + bias));
        self.action.clone_from(&drive);
        drive
    }

    /// C x, where C is the sum of mu v' over recent steps: v the change of the sensors `delay` steps before, mu minus the change that
    /// followed; each row of C scaled to the gain. C itself is never made: it has as many entries as sensors squared, and few terms.
    fn drive(&self, settings: &DepSettings) -> Vec<f64> {
        let present = &self.history[0];
        let mut drive = vec![0.0; present.len()];
        // Counted from the newest, 1: terms 2 to the last whose changes are all known.
        let last = settings.horizon.min(self.steps.saturating_sub(settings.delay));
        if self.history.len() <= 2 + settings.delay || last <= 2 {
            return drive;
        }
        let change = |from: usize| -> Vec<f64> {
            self.history[from - 1].iter().zip(&self.history[from]).map(|(new, old)| new - old).collect()
        };
        let known = self.history.len();
        let terms = (2..last).filter(|term| term + settings.delay < known);
        let terms: Vec<[Vec<f64>; 2]> = terms.map(|term| [change(term), change(term + settings.delay)]).collect();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let along: Vec<f64> = terms.iter().map(|[_, before]| product(before, present)).collect();
        let gram: Vec<Vec<f64>> = terms.iter().map(|[_, a]| terms.iter().map(|[_, b]| product(a, b)).collect()).collect();
        for (row, drive) in drive.iter_mut().enumerate() {
            let after = |term: usize| -terms[term][0][row];
            let sum = |weights: &[f64]| (0..terms.len()).map(|term| after(term) * weights[term]).sum::<f64>();
            let square: f64 = (0..terms.len()).map(|term| after(term) * sum(&gram[term])).sum();
            let norm = libm::sqrt(if square > 0.0 { square } else { 0.0 });
            *drive = settings.gain * sum(&along) / (norm + EPSILON);
        }
        drive
    }
}

impl Dep {
    /// For so many slots.
    pub fn new(settings: &DepSettings, slots: usize, seed: u64) -> Self {
        Self {
            controllers: vec![Controller::default(); slots],
            chance: Stream::new(EpisodeKey { seed, episode: 0 }, "train/dep"),
            intervening: settings.length + 1,
            ended: 0,
        }
    }

    /// Counts episodes that have ended.
    pub fn count(&mut self, ended: usize) {
        self.ended += ended as u64;
    }

    /// Actions for all slots where it acts now: always while the learner only collects, and then now and again for some steps, but in
    /// one of five episodes. It keeps learning while the policy acts.
    pub fn act<'a>(
        &mut self,
        settings: &DepSettings,
        sensors: &mut Sensors,
        episodes: impl Iterator<Item = &'a Episode>,
        collecting: bool,
    ) -> Option<Vec<f32>> {
        if !collecting && self.ended.is_multiple_of(UNDISTURBED) {
            return None;
        }
        let mut actions = Vec::new();
        for (controller, episode) in self.controllers.iter_mut().zip(episodes) {
            let measured = sensors.measure(episode);
            actions.extend(controller.act(settings, &measured).into_iter().map(|value| value as f32));
        }
        if collecting {
            return Some(actions);
        }
        let acts = self.intervening < settings.length;
        self.intervening = self.intervening.saturating_add(1);
        if !acts && self.chance.uniform() < settings.probability {
            self.intervening = 0;
        }
        acts.then_some(actions)
    }

    /// Whether it is of so many slots.
    pub fn fits(&self, other: &Self) -> bool {
        self.controllers.len() == other.controllers.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule as it is written: C as a whole matrix.
    fn drive_by_the_matrix(controller: &Controller, settings: &DepSettings) -> Vec<f64> {
        let (history, count) = (&controller.history, controller.bias.len());
        let mut matrix = vec![vec![0.0; count]; count];
        for term in 2..settings.horizon.min(controller.steps - settings.delay) {
            if term + settings.delay >= history.len() {
                continue;
            }
            for (row, matrix) in matrix.iter_mut().enumerate() {
                let after = -(history[term - 1][row] - history[term][row]);
                for (column, entry) in matrix.iter_mut().enumerate() {
                    let [new, old] = [term - 1, term].map(|place| history[place + settings.delay][column]);
                    *entry += after * (new - old);
                }
            }
        }
        let of_row = |row: &Vec<f64>| {
            let norm = row.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
            row.iter().zip(&history[0]).map(|(entry, sensor)| settings.gain * entry / (norm + EPSILON) * sensor).sum()
        };
        matrix.iter().map(of_row).collect()
    }

    #[test]
    fn terms_give_what_the_matrix_gives() {
        let settings = DepSettings { horizon: 9, delay: 3, ..DepSettings::default() };
        let mut controller = Controller::default();
        for step in 0..40 {
            let sensors: Vec<f64> =
                (0..5).map(|index| libm::sin(0.3 * f64::from(step) * (1.0 + 0.2 * f64::from(index)))).collect();
            let action = controller.act(&settings, &sensors);
            assert!(action.iter().all(|entry| (-1.0..=1.0).contains(entry)));
            if step > 12 {
                let (found, expected) = (controller.drive(&settings), drive_by_the_matrix(&controller, &settings));
                for (found, expected) in found.iter().zip(&expected) {
                    assert!((found - expected).abs() < 1e-9 * settings.gain, "{step}: {found}, expected {expected}");
                }
            }
        }
    }

    #[test]
    fn it_swings_a_mass_on_two_antagonists() {
        // Two springs that pull a mass to and fro: their lengths are 1 + x and 1 - x.
        let settings = DepSettings::default();
        let (mut controller, mut state) = (Controller::default(), [0.01, 0.0]);
        let mut extremes = [0.0_f64, 0.0];
        for _ in 0..400 {
            let action = controller.act(&settings, &[1.0 + state[0], 1.0 - state[0]]);
            // The first shortens what is 1 + x, so it pulls down.
            let force = action[1] - action[0] - 4.0 * state[0] - 0.2 * state[1];
            state[1] += 0.05 * force;
            state[0] += 0.05 * state[1];
            extremes = [extremes[0].min(state[0]), extremes[1].max(state[0])];
        }
        assert!(extremes[0] < -0.2 && extremes[1] > 0.2, "{extremes:?}");
    }
}
