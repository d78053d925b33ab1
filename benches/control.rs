//! What a control step spends on computed muscle control and on physics, and what snapshots and resets cost.
//!
//!     cargo bench --bench control
//!
//! Eight episodes of a task in the lanes of one worker under the policy `cmc`, and one alone. Wall-clock time per episode and control
//! step, medians of the rounds: for a machine that does nothing else. Then eight lanes of every task of the suite for as many control steps as its
//! horizon has, and the mean over all: an episode that ends is followed by the next in its lane, as in an environment that resets by itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a benchmark ends at its first failure")]

use msk::compiler::compile;
use msk::runtime::episode::{Controlled, Engine, Environment, EpisodeKey, Member};
use msk::runtime::library::{BodyLibrary, FileLoader};
use msk::runtime::policy::{Policy, create};
use std::hint::black_box;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

const STEPS: usize = 100;
const ROUNDS: usize = 7;

fn main() {
    println!("{:<10} {:>9} {:>15} {:>15}", "task", "episodes", "controller, us", "rest, us");
    for name in ["stand", "squat", "walk"] {
        let engine = engine(name);
        for episodes in [1, 8] {
            let rounds: Vec<Spent> = (0..ROUNDS).map(|_| play(&engine, episodes, STEPS)).collect();
            let [control, rest] = [0, 1].map(|part| median(rounds.iter().map(|round| round.per_step()[part])));
            println!("{name:<10} {episodes:>9} {control:>15.1} {rest:>15.1}");
        }
    }
    let mut all = Spent::default();
    println!("\n{:<18} {:>7} {:>15} {:>15}", "one after another", "steps", "controller, us", "rest, us");
    for engine in engines(|_| true) {
        let spent = play(&engine, 8, engine.task().horizon as usize);
        println!("{:<18} {spent}", engine.task().name);
        all = Spent { control: all.control + spent.control, rest: all.rest + spent.rest, steps: all.steps + spent.steps };
    }
    println!("{:<18} {all}", "all 22 tasks");
    let mut environment = Environment::of(engine("walk"));
    environment.reset(EpisodeKey::default());
    let kept = environment.snapshot();
    let of = |work: &mut dyn FnMut(u64)| {
        median((0..ROUNDS).map(|round| {
            let start = seconds();
            (0..20).for_each(|index| work(20 * round as u64 + index));
            (seconds() - start) * 1e6 / 20.0
        }))
    };
    let snapshot = of(&mut |_| drop(black_box(environment.snapshot())));
    let restore = of(&mut |_| environment.restore(black_box(&kept)));
    let reset = of(&mut |episode| environment.reset(EpisodeKey { seed: 1, episode }));
    println!("\nwalk: snapshot {snapshot:.1} us, restore {restore:.1} us, reset {reset:.0} us");
}

/// Time of some control steps, s, of the controller, and of all else.
#[derive(Default)]
struct Spent {
    control: f64,
    rest: f64,
    steps: f64,
}

impl Spent {
    /// Microseconds.
    fn per_step(&self) -> [f64; 2] {
        [self.control, self.rest].map(|time| time * 1e6 / self.steps)
    }
}

impl std::fmt::Display for Spent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [control, rest] = self.per_step();
        write!(f, "{:>7} {control:>15.1} {rest:>15.1}", self.steps)
    }
}

fn engine(task: &str) -> Engine {
    engines(|name| name == task).next().unwrap()
}

/// Those of the tasks of the suite that are wanted.
fn engines(wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = Engine> {
    let bodies = BodyLibrary::default();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks.msk");
    let compilation = compile(&file, &FileLoader, &bodies).unwrap();
    compilation.tasks.into_iter().filter(move |task| wanted(&task.name)).map(move |task| {
        let stage = bodies.stage(&task.body, &task.scene).unwrap();
        Engine::new(stage.model, stage.body, task).unwrap()
    })
}

/// So many control steps of as many lanes. An episode that ends is followed by the next.
fn play(engine: &Engine, count: usize, most: usize) -> Spent {
    let mut scratch = engine.group_scratch(count);
    let weights = engine.task().weights();
    let mut policies: Vec<Box<dyn Policy>> = (0..count).map(|_| create("cmc").unwrap()).collect();
    let mut episodes: Vec<_> = (0..count).map(|_| engine.episode()).collect();
    let mut rates: Vec<_> = (0..count).map(|_| None).collect();
    let mut next = 0;
    let mut actions: Vec<_> = policies.iter().map(|policy| engine.action(policy.acts_on())).collect();
    let mut spent = Spent::default();
    for step in 0..most {
        for (lane, episode) in episodes.iter_mut().enumerate().filter(|(_, episode)| step == 0 || episode.ending().is_some()) {
            let key = EpisodeKey { seed: 1, episode: next };
            next += 1;
            rates[lane] = scratch.begin(lane, engine, (key, &[]), episode);
            policies[lane].reset(&engine.context(episode, &weights, scratch.lane(lane))).unwrap();
        }
        let start = seconds();
        let mut controlled: Vec<Controlled<'_>> = policies
            .iter_mut()
            .zip(&episodes)
            .zip(&mut actions)
            .enumerate()
            .map(|(lane, ((policy, episode), action))| Controlled {
                lane,
                engine,
                episode,
                weights: &weights,
                controls: policy.controls().unwrap(),
                entries: &[],
                action: &mut action.entries,
            })
            .collect();
        scratch.control(&mut controlled).into_iter().for_each(|acted| acted.unwrap());
        let middle = seconds();
        scratch.step(
            episodes.iter_mut().zip(&mut rates).zip(&actions).map(|((episode, rates), action)| {
                Some(Member { engine, episode, rates, weights: &weights, action: action.into() })
            }),
        );
        spent.control += middle - start;
        spent.rest += seconds() - middle;
        spent.steps += count as f64;
    }
    spent
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Seconds since the first call: a control step is shorter than what systems count CPU time by.
fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
