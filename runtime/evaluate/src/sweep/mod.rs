//! Perturbation sweeps: how success falls as noise, forces or parameters grow.
//!
//! 1. An [`Axis`] is what grows, along the scales of a [`SweepProtocol`]; the episodes of each scale are an evaluation of their own, with a journal.
//! 2. The first scale of every axis is 0: those episodes are played once and serve all axes.
//! 3. Noise on observations is relative to each entry's deviation over unperturbed episodes ([`normalization`]), as a normaliser of a
//!    learner has it.
//! 4. A [`Sweep`] sums up: success by scale, and the normalised area under it, of tasks, families and all tasks.

mod normalization;
mod table;

pub use msk_program::sweep::{Axis, SweepProtocol};
pub use normalization::{NORMALIZING, normalization};
pub use table::markdown;

use crate::{Summary, Trial};
use msk_runtime::perturbation::{Normalization, Perturbation};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The perturbation of a scale.
pub fn perturbation(axis: Axis, scale: f64, normalization: Option<Arc<Normalization>>) -> Perturbation {
    let mut perturbation = Perturbation::default();
    match axis {
        Axis::Action => perturbation.action = scale,
        Axis::Observation => {
            perturbation.observation = scale;
            perturbation.normalization = normalization;
        }
        Axis::Gain => perturbation.gain = scale,
        Axis::Push => perturbation.push = scale,
        Axis::Friction => perturbation.friction = scale,
        Axis::Mass => perturbation.mass = scale,
        // Its scales are whole numbers.
        Axis::Latency => perturbation.latency = scale as u32,
    }
    perturbation
}

/// The trials at one scale of an axis, with the normalisation of each trial's observations.
pub fn perturbed(trials: &[Trial], axis: Axis, scale: f64, normalizations: &[Arc<Normalization>]) -> Vec<Trial> {
    let perturbed = |(place, trial): (usize, &Trial)| {
        let normalization = normalizations.get(place).cloned();
        Trial { perturbation: self::perturbation(axis, scale, normalization), ..trial.clone() }
    };
    trials.iter().enumerate().map(perturbed).collect()
}

/// Success of a task, or the mean of several, along an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Success rate at every scale, 0..1; none where nothing was played.
    pub success: Vec<Option<f64>>,
    /// Normalised area under them, 0..100: see [`area`].
    pub area: Option<f64>,
}

/// A task, a family or all tasks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robustness {
    /// Its name.
    pub name: String,
    /// Family of a task.
    pub family: String,
    /// One curve for each axis.
    pub curves: Vec<Curve>,
    /// Mean of the areas of all axes that have one.
    pub area: Option<f64>,
}

/// A sweep in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// Name of the policy.
    pub policy: String,
    /// Seed.
    pub seed: u64,
    /// Episodes of each task at each scale.
    pub episodes: u64,
    /// Axes with their scales.
    pub axes: Vec<(Axis, Vec<f64>)>,
    /// Tasks, in the order of the plan.
    pub tasks: Vec<Robustness>,
    /// Means over the tasks of each family.
    pub families: Vec<Robustness>,
    /// Means over all tasks.
    pub overall: Robustness,
}

/// 100 Σ_i (x_{i+1} - x_i)(s_i + s_{i+1})/2 / (x_n - x_0): the mean of success along the axis by trapezoids, 0..100.
pub fn area(scales: &[f64], success: &[f64]) -> Option<f64> {
    let (first, last) = (scales.first()?, scales.last()?);
    let trapezoids = scales.windows(2).zip(success.windows(2)).map(|(x, s)| 0.5 * (x[1] - x[0]) * (s[0] + s[1])).sum::<f64>();
    (scales.len() == success.len() && last > first).then(|| 100.0 * trapezoids / (last - first))
}

impl Curve {
    fn of(scales: &[f64], success: Vec<Option<f64>>) -> Self {
        let whole: Option<Vec<f64>> = success.iter().copied().collect();
        Self { area: whole.and_then(|whole| area(scales, &whole)), success }
    }
}

fn mean(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let values: Vec<f64> = values.flatten().collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

impl Robustness {
    fn new(name: &str, family: &str, curves: Vec<Curve>) -> Self {
        let area = mean(curves.iter().map(|curve| curve.area));
        Self { name: name.to_owned(), family: family.to_owned(), curves, area }
    }

    /// Mean of tasks, each of which counts the same; tasks without a value do not count.
    fn mean(name: &str, tasks: &[&Self], axes: &[(Axis, Vec<f64>)]) -> Self {
        let curve = |(place, (_, scales)): (usize, &(Axis, Vec<f64>))| {
            let at = |scale: usize| mean(tasks.iter().map(|task| task.curves[place].success[scale]));
            let area = mean(tasks.iter().map(|task| task.curves[place].area));
            Curve { success: (0..scales.len()).map(at).collect(), area }
        };
        let curves: Vec<Curve> = axes.iter().enumerate().map(curve).collect();
        let area = mean(tasks.iter().map(|task| task.area));
        Self { name: name.to_owned(), family: String::new(), curves, area }
    }
}

impl Sweep {
    /// Of the summaries of every scale of every axis, all of one list of tasks.
    pub fn of(points: &[(Axis, Vec<(f64, Summary)>)]) -> Option<Self> {
        let (_, first) = points.first()?;
        let (_, reference) = first.first()?;
        let axes: Vec<(Axis, Vec<f64>)> =
            points.iter().map(|(axis, scales)| (*axis, scales.iter().map(|(scale, _)| *scale).collect())).collect();
        let tasks = reference.tasks.iter().enumerate().map(|(place, task)| {
            let curve = |(_, points): &(Axis, Vec<(f64, Summary)>)| {
                let scales: Vec<f64> = points.iter().map(|(scale, _)| *scale).collect();
                let success = |(_, summary): &(f64, Summary)| {
                    summary.tasks.get(place).filter(|task| task.skipped.is_none()).and_then(|task| task.success_rate)
                };
                Curve::of(&scales, points.iter().map(success).collect())
            };
            Robustness::new(&task.task, &task.family, points.iter().map(curve).collect())
        });
        let tasks: Vec<Robustness> = tasks.collect();
        let families = reference.families.iter().map(|family| {
            let members: Vec<&Robustness> = tasks.iter().filter(|task| task.family == family.name).collect();
            Robustness::mean(&family.name, &members, &axes)
        });
        let families = families.collect();
        let overall = Robustness::mean("all tasks", &tasks.iter().collect::<Vec<_>>(), &axes);
        let (policy, protocol) = (reference.policy.clone(), reference.protocol);
        Some(Self { policy, seed: protocol.seed, episodes: protocol.episodes, axes, tasks, families, overall })
    }

    /// As JSON.
    pub fn json(&self) -> String {
        crate::journal::pretty(self) + "\n"
    }
}

#[cfg(test)]
mod tests;
