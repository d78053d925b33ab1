//! What environments cost beside the bare simulator, and how much memory one more takes.
//!
//!     cargo bench --bench environments
//!
//! Many episodes of `walk` under random actions, one worker: resets, sensors, observation, reward and ends included. Beside it the
//! bare batch takes the same physics steps: the same excitations from the same initial states, which are put into it wherever an
//! episode begins. Both take turns; times are CPU time, where the system tells it, and the ratio is the median of those of the rounds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a program for whoever measures")]

use msk::compiler::compile;
use msk::physics::{Batch, State};
use msk::runtime::episode::{AutoresetMode, Engine, Environment, EpisodeKey, Stream, VectorEnvironment};
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Instant;

const EPISODES: usize = 64;
const STEPS: usize = 100;
const ROUNDS: usize = 9;
/// Episodes whose memory is measured together.
const KEPT: usize = 2000;

/// What the physics of a round was: of each control step the states that began, and the excitations.
type Recorded = Vec<(Vec<(usize, State<f64>)>, Vec<Vec<f64>>)>;

fn main() {
    let bodies = BodyLibrary::default();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks.msk");
    let compilation = compile(&file, &FileLoader, &bodies).unwrap();
    let task = compilation.tasks.iter().find(|task| task.name == "walk").unwrap().clone();
    let stage = bodies.stage(&task.body, &task.scene).unwrap();
    let engine = Engine::new(stage.model, stage.body, task).unwrap();
    let actions = actions(&engine);
    let recorded = record(&engine, &actions);
    let begun: usize = recorded.iter().map(|(begun, _)| begun.len()).sum();
    let times: Vec<[f64; 2]> = (0..ROUNDS).map(|_| [environments(&engine, &actions), batch(&engine, &recorded)]).collect();
    let [whole, bare] = [0, 1].map(|which| sorted(times.iter().map(|times| times[which] / (EPISODES * STEPS) as f64 * 1e6)));
    let shares = sorted(times.iter().map(|[whole, bare]| 100.0 * bare / whole));
    let (whole, bare, middle) = (whole[ROUNDS / 2], bare[ROUNDS / 2], shares[ROUNDS / 2]);
    println!("walk, {EPISODES} episodes, one worker, {STEPS} control steps, {begun} episodes begun");
    println!("environments {whole:.1} us, bare batch {bare:.1} us per control step");
    println!("share of the bare batch {middle:.1} % (rounds {:.1} to {:.1} %)", shares[0], shares[ROUNDS - 1]);
    if let Some(bytes) = memory(&engine) {
        println!("one more episode keeps {:.1} KB", bytes / 1024.0);
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Seconds for which this thread has had a processor; without a system that tells it, seconds since `start`.
fn seconds(start: Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds: Option<f64> = text.split_whitespace().next().and_then(|word| word.parse().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |count| 1e-9 * count)
}

/// Random actions of all control steps, slot after slot.
fn actions(engine: &Engine) -> Vec<Vec<f64>> {
    let mut chance = Stream::new(EpisodeKey { seed: 1, episode: 0 }, "bench");
    let mut actions = || (0..EPISODES * engine.action_size()).map(|_| 2.0 * chance.uniform() - 1.0).collect();
    (0..STEPS).map(|_| actions()).collect()
}

fn begin(engine: &Engine) -> VectorEnvironment {
    let count = NonZeroUsize::new(EPISODES).unwrap();
    let environments = VectorEnvironment::new(engine.clone(), count, NonZeroUsize::MIN).unwrap();
    environments.with_autoreset(AutoresetMode::SameStep)
}

fn record(engine: &Engine, actions: &[Vec<f64>]) -> Recorded {
    let mut environments = begin(engine);
    environments.reset(7);
    let mut all: Vec<usize> = (0..EPISODES).collect();
    let mut recorded = Recorded::new();
    for actions in actions {
        let begun = all.iter().map(|&slot| (slot, environments.episodes().nth(slot).unwrap().state().clone())).collect();
        let ends = environments.step(actions).unwrap().ends.iter().map(|end| end.slot).collect();
        let excitation = |entry: &f64| msk::runtime::episode::excitation(engine.body().excitation, *entry);
        let controls = actions.chunks(engine.action_size()).map(|own| own.iter().map(excitation).collect()).collect();
        recorded.push((begun, controls));
        all = ends;
    }
    recorded
}

fn environments(engine: &Engine, actions: &[Vec<f64>]) -> f64 {
    let mut environments = begin(engine);
    let clock = Instant::now();
    let start = seconds(clock);
    environments.reset(7);
    for actions in actions {
        environments.step(actions).unwrap();
    }
    seconds(clock) - start
}

fn batch(engine: &Engine, recorded: &Recorded) -> f64 {
    let mut batch = Batch::new(engine.model(), EPISODES);
    let substeps = (engine.control_period() / engine.model().options.timestep).round() as usize;
    let clock = Instant::now();
    let start = seconds(clock);
    for (begun, controls) in recorded {
        begun.iter().for_each(|(slot, state)| batch.set(*slot, state).unwrap());
        controls.iter().enumerate().for_each(|(slot, control)| batch.set_control(slot, control).unwrap());
        (0..substeps).for_each(|_| batch.step());
    }
    seconds(clock) - start
}

/// What an episode keeps, by the growth of the process; `None` where the system does not tell.
fn memory(engine: &Engine) -> Option<f64> {
    let mut environment = Environment::of(engine.clone());
    environment.reset(EpisodeKey::default());
    let before = resident()?;
    let kept: Vec<_> = (0..KEPT).map(|_| environment.snapshot()).collect();
    let bytes = (resident()? - before) / kept.len() as f64;
    Some(bytes)
}

/// Resident memory of the process, bytes.
fn resident() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: f64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(4096.0 * pages)
}
