//! Good model files broken at random, by a generator whose every file can be made again from its number: each is read or
//! refused in bounded time and memory, and what is read can be stepped.
//!
//! The usual run takes the first two thousand; `cargo test --release -p msk-physics --test suite mjcf_mutants -- --ignored` all
//! ten thousand. A failure gives the file's number and prints the file.

mod mutate;
mod seeds;

use msk_physics::model::{Model, ModelError};
use msk_physics::{self as physics, State, Workspace};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// No file may take longer, even in a build without optimisation on a busy machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// All of them together may not need more memory, in KiB.
const MEMORY: u64 = 3 << 20;

/// What became of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Stepped,
    Fault,
    Unsupported,
    Refused,
}

/// Reads the file and takes three steps.
fn attempt(files: &mutate::Files) -> Outcome {
    let model = if files.others.is_empty() {
        Model::from_mjcf(&files.main)
    } else {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("main.xml"), &files.main).unwrap();
        for (name, contents) in &files.others {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, contents).unwrap();
        }
        Model::from_file(folder.path().join("main.xml"))
    };
    let model = match model {
        Ok(model) => model,
        Err(ModelError::Unsupported(list)) => {
            assert!(!list.is_empty(), "nothing is unsupported");
            return Outcome::Unsupported;
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.len() < 5_000, "an endless message: {message:.500}");
            return Outcome::Refused;
        }
    };
    let mut state = State::<f64>::new(&model);
    state.control.fill(0.5);
    let mut workspace = Workspace::new(&model);
    for _ in 0..3 {
        if physics::step(&model, &mut state, &mut workspace).is_err() {
            return Outcome::Fault;
        }
        assert!(state.position.iter().chain(&state.velocity).all(|value| value.is_finite()), "a state that is not finite");
    }
    Outcome::Stepped
}

/// Makes and tries the files with these numbers; returns how many had which outcome.
fn survey(numbers: core::ops::Range<u64>) -> BTreeMap<Outcome, usize> {
    let outcomes: Vec<Outcome> = numbers
        .into_par_iter()
        .map(|number| {
            let files = mutate::files(number);
            let start = Instant::now();
            let outcome = catch_unwind(AssertUnwindSafe(|| attempt(&files)));
            let took = start.elapsed();
            let show = || files.main.chars().take(20_000).collect::<String>();
            assert!(took < PATIENCE, "file {number} took {took:?}:\n{}", show());
            outcome.unwrap_or_else(|_| panic!("file {number} panics:\n{}", show()))
        })
        .collect();
    assert!(peak_memory() < MEMORY, "{} KiB of memory", peak_memory());
    let mut counts = BTreeMap::new();
    outcomes.into_iter().for_each(|outcome| *counts.entry(outcome).or_default() += 1);
    counts
}

/// The most memory that this process ever had, in KiB; 0 where the system does not report it.
fn peak_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

#[test]
fn two_thousand_broken_files_are_answered() {
    let counts = survey(0..2_000);
    println!("{counts:?}");
    // The generator is worth something only while it reaches every answer.
    for outcome in [Outcome::Stepped, Outcome::Refused, Outcome::Unsupported] {
        assert!(counts.get(&outcome).copied().unwrap_or(0) >= 20, "{counts:?}");
    }
}

#[test]
#[ignore = "takes minutes in a build without optimisation: see docs/reliability.md"]
fn ten_thousand_broken_files_are_answered() {
    println!("{:?}", survey(0..10_000));
}

#[test]
fn the_seeds_themselves_are_good() {
    for (name, text) in seeds::SEEDS {
        let files = mutate::Files { main: text.to_owned(), others: seeds::others(text) };
        assert_eq!(attempt(&files), Outcome::Stepped, "{name}");
    }
}

#[test]
fn a_number_always_makes_the_same_file() {
    for number in [0, 17, 1234, 9999] {
        assert_eq!(mutate::files(number).main, mutate::files(number).main);
    }
    assert_ne!(mutate::files(1).main, mutate::files(2).main);
}
