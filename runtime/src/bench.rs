//! How fast the simulator is: steps per second, time per stage, and what the constraint solver had to do.
//!
//! Muscles are excited at random throughout, a fresh uniform value for each every ten milliseconds: a body at rest would
//! flatter the constraint solver, whose work is done when the set of contacts and limits changes.

use crate::scene::ground::Ground;
use msk_physics::model::{GeomKind, JointKind, Model};
use msk_physics::scalar::Real;
use msk_physics::{Fault, STAGES, State, Workspace, kinematics, step_by_stage};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;
use std::time::{Duration, Instant};

/// What the body does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Protocol {
    /// From the reference configuration onto the ground and on for a second and a half, then again.
    Falling,
    /// From the reference configuration with its lowest point on the ground, for a fifth of a second, then again.
    Standing,
}

impl Protocol {
    /// Simulated time after which the body starts again, s.
    fn duration(self) -> f64 {
        match self {
            Self::Falling => 1.5,
            Self::Standing => 0.2,
        }
    }
}

/// What to measure.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// What the body does.
    pub protocol: Protocol,
    /// Wall-clock time to measure, s.
    pub seconds: f64,
    /// Independent bodies, one per thread.
    pub threads: usize,
    /// Seed of the excitations.
    pub seed: u64,
}

/// Mean and 95th percentile of a count over steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// 95 of 100 steps have at most this.
    pub p95: usize,
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// What the body did.
    pub protocol: Protocol,
    /// Threads.
    pub threads: usize,
    /// Steps of all threads.
    pub steps: usize,
    /// Steps of all threads per second of wall-clock time.
    pub steps_per_second: f64,
    /// The same for one thread.
    pub steps_per_second_per_thread: f64,
    /// Simulated seconds per second of wall-clock time, all threads.
    pub real_time_factor: f64,
    /// Mean time of each stage in microseconds, in the order of the step.
    pub us_per_stage: Vec<(&'static str, f64)>,
    /// Constraint rows.
    pub rows: Spread,
    /// Contacts.
    pub contacts: Spread,
    /// Iterations of the constraint solver.
    pub iterations: Spread,
    /// Bytes of a state, which is what an episode keeps.
    pub state_bytes: usize,
    /// Steps that could not be taken; the body started again.
    pub faults: usize,
}

/// What one thread counts.
#[derive(Default)]
struct Tally {
    steps: usize,
    faults: usize,
    stages: [Duration; STAGES.len()],
    rows: Vec<usize>,
    contacts: Vec<usize>,
    iterations: Vec<usize>,
}

impl Tally {
    fn merge(mut self, other: Self) -> Self {
        self.steps += other.steps;
        self.faults += other.faults;
        for (sum, part) in self.stages.iter_mut().zip(other.stages) {
            *sum += part;
        }
        for (all, part) in
            [(&mut self.rows, other.rows), (&mut self.contacts, other.contacts), (&mut self.iterations, other.iterations)]
        {
            // Histograms: entry n counts the steps with n.
            all.resize(all.len().max(part.len()), 0);
            all.iter_mut().zip(part).for_each(|(sum, count)| *sum += count);
        }
        self
    }
}

/// Runs `model` under `settings`.
pub fn run(model: &Model, settings: &Settings) -> Report {
    let threads = settings.threads.max(1);
    let start = Instant::now();
    // What no clock reaches, and what is no time, is none.
    let span = Duration::try_from_secs_f64(settings.seconds.at_least(0.0)).unwrap_or_default();
    let deadline = start.checked_add(span).unwrap_or(start);
    let tally = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads as u64)
            .map(|thread| scope.spawn(move || work(model, settings.protocol, settings.seed.wrapping_add(thread), deadline)))
            .collect();
        // A worker that panics is a defect of the simulator; its counts are missing then.
        workers.into_iter().filter_map(|worker| worker.join().ok()).fold(Tally::default(), Tally::merge)
    });
    let elapsed = start.elapsed().as_secs_f64();
    let steps_per_second = tally.steps as f64 / elapsed;
    let stage = |(name, time): (&'static str, Duration)| (name, time.as_secs_f64() * 1e6 / tally.steps.max(1) as f64);
    Report {
        protocol: settings.protocol,
        threads,
        steps: tally.steps,
        steps_per_second,
        steps_per_second_per_thread: steps_per_second / threads as f64,
        real_time_factor: steps_per_second * model.options.timestep,
        us_per_stage: STAGES.into_iter().zip(tally.stages).map(stage).collect(),
        rows: spread(&tally.rows),
        contacts: spread(&tally.contacts),
        iterations: spread(&tally.iterations),
        state_bytes: state_bytes(model),
        faults: tally.faults,
    }
}

fn work(model: &Model, protocol: Protocol, seed: u64, deadline: Instant) -> Tally {
    let mut tally = Tally::default();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut workspace = Workspace::new(model);
    let origin = initial_state(model, protocol, &mut workspace);
    let mut state = origin.clone();
    let steps_per_excitation = (0.01 / model.options.timestep).round().at_least(1.0) as usize;
    while Instant::now() < deadline {
        if state.time >= protocol.duration() {
            state.clone_from(&origin);
        }
        state.control.fill_with(|| random.random());
        for _ in 0..steps_per_excitation {
            if step(model, &mut state, &mut workspace, &mut tally.stages).is_err() {
                tally.faults += 1;
                state.clone_from(&origin);
                break;
            }
            tally.steps += 1;
            let episode = &workspace.lanes[0];
            count(&mut tally.rows, episode.constraints.rows.len());
            count(&mut tally.contacts, episode.constraints.contacts.len());
            count(&mut tally.iterations, episode.newton.iterations);
        }
    }
    tally
}

/// [`step_by_stage`] with a clock after each stage.
fn step(
    model: &Model,
    state: &mut State<f64>,
    workspace: &mut Workspace<f64>,
    stages: &mut [Duration; STAGES.len()],
) -> Result<(), Fault> {
    let mut clock = Instant::now();
    let mut stages = stages.iter_mut();
    step_by_stage(model, state, workspace, &mut || {
        let now = Instant::now();
        if let Some(stage) = stages.next() {
            *stage += now - clock;
        }
        clock = now;
    })
}

/// The reference configuration; for [`Protocol::Standing`] with the lowest shape on the ground.
fn initial_state(model: &Model, protocol: Protocol, workspace: &mut Workspace<f64>) -> State<f64> {
    let mut state = State::new(model);
    if protocol == Protocol::Standing {
        kinematics::update(model, &state, &mut workspace.kinematics);
        let geoms = &model.geoms;
        let solid = |geom: &usize| geoms.contact_type[*geom] != 0 || geoms.contact_affinity[*geom] != 0;
        let (ground, shapes): (Vec<usize>, Vec<usize>) =
            (0..geoms.kind.len()).filter(solid).partition(|&geom| geoms.kind[geom] == GeomKind::Plane);
        let height = Ground { model, kinematics: &workspace.kinematics, shapes: &ground }.clearance(&shapes);
        let free = model.joints.kind.iter().position(|kind| *kind == JointKind::Free);
        if let Some(joint) = free.filter(|_| height.is_finite()) {
            state.position[model.joints.position_address[joint] + 2] -= height;
        }
    }
    state
}

fn count(histogram: &mut Vec<usize>, value: usize) {
    if histogram.len() <= value {
        histogram.resize(value + 1, 0);
    }
    histogram[value] += 1;
}

fn spread(histogram: &[usize]) -> Spread {
    let total: usize = histogram.iter().sum();
    let sum: usize = histogram.iter().enumerate().map(|(value, count)| value * count).sum();
    let mut seen = 0;
    let p95 = histogram.iter().position(|count| {
        seen += count;
        20 * seen >= 19 * total
    });
    Spread { mean: sum as f64 / total.max(1) as f64, p95: p95.unwrap_or(0) }
}

fn state_bytes(model: &Model) -> usize {
    let fibres = if model.elastic_tendons.is_some() { model.actuators.name.len() } else { 0 };
    let inputs = model.na + model.actuators.name.len() + 2 * fibres;
    let numbers = model.nq + 3 * model.nv + inputs + 6 * model.bodies.parent.len();
    size_of::<State<f64>>() + numbers * size_of::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_has_its_mean_and_the_value_that_95_of_100_stay_below() {
        let mut histogram = Vec::new();
        for value in 0..100 {
            count(&mut histogram, value);
        }
        assert_eq!(spread(&histogram), Spread { mean: 49.5, p95: 94 });
        assert_eq!(spread(&[]), Spread { mean: 0.0, p95: 0 });
    }
}
