//! What compiled tasks cost: beside the same formulas by hand, beside the physics, and to compile.
//!
//!     cargo bench --bench compiled
//!
//! For three tasks of different kind it prints the time of one control step's observation, reward, terminations and success as
//! compiled and by hand (`benches/hand`), their ratio, and the share of the whole control step that the compiled task takes. By hand,
//! sums run from the first number to the last, as `iter().sum()` does; "in columns" they run as those of compiled tasks do. Then
//! the time to read, check and lower every task of the suite, cold and with bodies known, of which its texts alone and its body
//! alone, and one task after an edit; the time to put the body into a scene; and the first time again, as compiled, of every task of
//! the suite. Times are the least of several rounds; `tests/hand_written.rs` holds that all ways come to the same numbers.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a program for whoever measures")]

mod hand;

use hand::{Hand, Outcome, Sums, TASKS};
use msk::compiler::files::BodySource;
use msk::compiler::syntax::parse;
use msk::compiler::task::{CompiledTask, StepReport, TaskState};
use msk::compiler::{Compilation, Middle, compile};
use msk::runtime::episode::{Environment, EpisodeKey};
use msk::runtime::library::{BodyLibrary, FileLoader};
use msk::runtime::scene::stage;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

const ROUNDS: usize = 40;

fn main() {
    let bodies = BodyLibrary::default();
    println!(
        "{:<12} {:>12} {:>10} {:>7} {:>15} {:>7} {:>15} {:>7}",
        "task", "compiled, us", "hand, us", "ratio", "in columns, us", "ratio", "whole step, us", "share"
    );
    for (file, by_hand) in TASKS {
        let task = compile(&path(file), &FileLoader, &bodies).unwrap().tasks[0].clone();
        let (frames, whole) = record(&bodies, &task);
        let [compiled, hand] = compare(&task, &mut *by_hand(&task, Sums::Chain), &frames);
        let [again, columns] = compare(&task, &mut *by_hand(&task, Sums::Columns), &frames);
        let name = &task.name;
        println!(
            "{name:<12} {compiled:>12.2} {hand:>10.2} {:>7.2} {columns:>15.2} {:>7.2} {whole:>15.1} {:>6.2}%",
            compiled / hand,
            again / columns,
            100.0 * compiled / whole
        );
    }
    let suite = path("tasks.msk");
    let count = compile(&suite, &FileLoader, &bodies).unwrap().tasks.len();
    let to_compile = |file: &Path, bodies: &BodyLibrary| to_make(|| compile(file, &FileLoader, bodies).unwrap());
    let cold = least(5, || to_compile(&suite, &BodyLibrary::default()));
    let known = least(20, || to_compile(&suite, &bodies));
    let (file, _) = TASKS[2];
    let edited = least(20, || to_compile(&path(file), &bodies));
    let task = compile(&path(file), &FileLoader, &bodies).unwrap().tasks[0].clone();
    let alone = bodies.stage(&task.body, &Default::default()).unwrap();
    let staged = least(20, || time(|| drop(black_box(stage(&alone.model, &alone.body, &task.scene).unwrap()))));
    println!("\nread, check and lower {count} tasks: {:.1} ms cold, {:.1} ms with the body known", 1e3 * cold, 1e3 * known);
    // What is kept from here on scatters what the allocator gives, so that compiling after it takes longer.
    let compiled = compile(&suite, &FileLoader, &bodies).unwrap();
    println!("of which {}", parts(&compiled));
    println!("the file of one task after an edit: {:.2} ms", 1e3 * edited);
    println!("the body put among the {} objects of that task: {:.1} ms", task.scene.objects.len(), 1e3 * staged);
    println!("\na control step of each task of the suite, compiled, us: {}", of_each(&bodies, &compiled.tasks));
}

/// The least, the median and the most time of a control step among tasks, with their names.
fn of_each(bodies: &BodyLibrary, tasks: &[Arc<CompiledTask>]) -> String {
    let mut times: Vec<(f64, &str)> =
        tasks.iter().map(|task| (alone(task, &record(bodies, task).0), task.name.as_str())).collect();
    times.sort_by(|one, other| one.0.total_cmp(&other.0));
    let [least, median, most] =
        [0, times.len() / 2, times.len() - 1].map(|place| format!("{:.2} (`{}`)", times[place].0, times[place].1));
    format!("least {least}, median {median}, most {most}")
}

/// What of a compilation needs no task: its texts to syntax trees, on one thread, and its one body to a model with a vocabulary.
fn parts(compiled: &Compilation) -> String {
    let texts: Vec<_> = compiled.sources.files().map(|file| (file, compiled.sources.text(file))).collect();
    // Motions are texts, too, but none of the language.
    let texts: Vec<_> = texts.into_iter().filter(|(file, _)| compiled.sources.path(*file).ends_with(".msk")).collect();
    let trees = || texts.iter().map(|(file, text)| parse(*file, text)).collect::<Vec<_>>();
    let parsing = least(20, || to_make(trees));
    let binding = least(5, || {
        let library = BodyLibrary::default();
        to_make(|| library.vocabulary(&compiled.bodies[0]))
    });
    let bytes: usize = texts.iter().map(|(_, text)| text.len()).sum();
    let (count, kilobytes) = (texts.len(), bytes as f64 / 1e3);
    format!("{count} texts of {kilobytes:.0} kB to trees on one thread {:.1} ms, the body {:.1} ms", 1e3 * parsing, 1e3 * binding)
}

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

/// Seconds until something is there; what it takes to go away again does not count.
fn to_make<T>(make: impl FnOnce() -> T) -> f64 {
    let begun = Instant::now();
    let _made = black_box(make());
    begun.elapsed().as_secs_f64()
}

fn time(work: impl FnOnce()) -> f64 {
    let begun = Instant::now();
    work();
    begun.elapsed().as_secs_f64()
}

fn least(rounds: usize, mut round: impl FnMut() -> f64) -> f64 {
    (0..rounds).map(|_| round()).fold(f64::INFINITY, f64::min)
}

/// Records of an episode, and the least time of a whole control step in microseconds.
fn record(bodies: &BodyLibrary, task: &Arc<CompiledTask>) -> (Vec<Vec<f64>>, f64) {
    let staged = bodies.stage(&task.body, &task.scene).unwrap();
    let mut episode = Environment::new(staged.model, staged.body, Arc::clone(task)).unwrap();
    let muscles = episode.context().body.muscles.len();
    let (mut frames, mut whole) = (Vec::new(), f64::INFINITY);
    for number in 0..4 {
        episode.reset(EpisodeKey { seed: 1, episode: number });
        for step in 0..16 {
            let action: Vec<f64> =
                (0..muscles).map(|muscle| f64::from(((muscle * 7 + step * 3) % 11) as u8) / 5.0 - 1.0).collect();
            whole = whole.min(time(|| drop(black_box(episode.step(&action).map(|report| report.reward)))));
            frames.push(episode.frame().to_vec());
        }
    }
    (frames, 1e6 * whole)
}

/// Least time of a control step, compiled, in microseconds.
fn alone(task: &CompiledTask, frames: &[Vec<f64>]) -> f64 {
    let best = least(ROUNDS, || step_through(task, frames, &mut Buffers::of(task)));
    1e6 * best / frames.len() as f64
}

/// What the steps of a compiled task write to.
struct Buffers {
    weights: Vec<f64>,
    state: TaskState,
    report: StepReport,
    observation: Vec<f64>,
}

impl Buffers {
    fn of(task: &CompiledTask) -> Self {
        let observation = vec![0.0; task.observation_size()];
        Self { weights: task.weights(), state: TaskState::default(), report: StepReport::default(), observation }
    }
}

/// Seconds that a compiled task takes for these records, after its reset.
fn step_through(task: &CompiledTask, frames: &[Vec<f64>], buffers: &mut Buffers) -> f64 {
    let Buffers { weights, state, report, observation } = buffers;
    task.reset(&frames[0], &mut Middle, state).unwrap();
    time(|| {
        for frame in frames {
            task.step(black_box(frame), weights, &mut Middle, state, report).unwrap();
            task.observe(frame, state, observation);
            black_box((&report, &observation));
        }
    })
}

/// Least time of a control step, compiled and by hand in turn, in microseconds.
fn compare(task: &CompiledTask, hand: &mut dyn Hand, frames: &[Vec<f64>]) -> [f64; 2] {
    let (mut buffers, mut outcome) = (Buffers::of(task), Outcome::default());
    let mut observation = vec![0.0; task.observation_size()];
    let mut best = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        let compiled = step_through(task, frames, &mut buffers);
        hand.reset(&frames[0]);
        let by_hand = time(|| {
            for frame in frames {
                hand.step(black_box(frame), &buffers.weights, &mut outcome);
                hand.observe(frame, &mut observation);
                black_box((&outcome, &observation));
            }
        });
        best = [best[0].min(compiled), best[1].min(by_hand)];
    }
    best.map(|time| 1e6 * time / frames.len() as f64)
}
