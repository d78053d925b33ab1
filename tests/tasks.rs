//! The benchmark's tasks: each compiles without a remark, begins with nothing inside anything else, and runs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use msk::compiler::{Compilation, compile};
use msk::runtime::episode::{Ending, Episode, EpisodeKey};
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

/// The suite, and the tasks that are written but not proven.
const FILES: [&str; 2] = ["tasks.msk", "tasks/drafts.msk"];

/// What goes beyond the benchmark: tasks of several parts, and the load study.
const FURTHER: [&str; 2] = ["tasks/composed.msk", "tasks/loads.msk"];

fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

fn compiled(file: &str) -> Compilation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    compile(&path, &FileLoader, bodies()).unwrap_or_else(|report| panic!("{file}:\n{report}"))
}

fn episodes() -> Vec<Episode> {
    // Of the further files those in their suites: tasks that these are made of begin as they do.
    let further = FURTHER.iter().map(|file| compiled(file)).flat_map(|compilation| {
        let named: Vec<String> =
            compilation.suites.iter().flat_map(|suite| &suite.families).flat_map(|(_, tasks)| tasks.clone()).collect();
        compilation.tasks.into_iter().filter(move |task| named.contains(&task.name))
    });
    let tasks = FILES.iter().flat_map(|file| compiled(file).tasks).chain(further);
    let begin = |task: std::sync::Arc<msk::compiler::task::CompiledTask>| {
        let staged = bodies().stage(&task.body, &task.scene).unwrap_or_else(|error| panic!("{}: {error:?}", task.name));
        Episode::new(staged.model, staged.body, task).unwrap()
    };
    tasks.map(begin).collect()
}

#[test]
fn tasks_compile_without_a_remark() {
    for file in FILES {
        let compilation = compiled(file);
        assert!(compilation.warnings.is_empty(), "{file}: {:#?}", compilation.warnings);
        for suite in &compilation.suites {
            let named: Vec<&String> = suite.families.iter().flat_map(|(_, tasks)| tasks).collect();
            assert_eq!(named.len(), compilation.tasks.len(), "{file}: every task is in the suite once");
        }
    }
}

#[test]
fn further_tasks_compile_without_a_remark() {
    for file in FURTHER {
        let compilation = compiled(file);
        assert!(compilation.warnings.is_empty(), "{file}: {:#?}", compilation.warnings);
        assert!(!compilation.suites.is_empty(), "{file} has no suite");
    }
}

#[test]
fn nothing_begins_inside_anything_else() {
    let mut problems = String::new();
    for episode in episodes() {
        for seed in 0..3 {
            let report = episode.inspect_start(EpisodeKey { seed, episode: 0 }).unwrap();
            for found in report.penetrations {
                let _ = writeln!(problems, "{}: {:?} {:.1} mm deep", episode.task().name, found.shapes, 1e3 * found.depth);
            }
            for found in report.residuals {
                let _ = writeln!(
                    problems,
                    "{}: {} misses {} and {} rad",
                    episode.task().name,
                    found.name,
                    found.distance,
                    found.turn
                );
            }
        }
    }
    assert!(problems.is_empty(), "\n{problems}");
}

#[test]
fn every_task_runs_without_a_fault() {
    let mut problems = String::new();
    for mut episode in episodes() {
        let muscles = episode.context().body.muscles.len();
        for action in [-1.0, -0.8] {
            episode.reset(EpisodeKey { seed: 1, episode: 0 });
            for _ in 0..20 {
                if episode.ending().is_some() {
                    break;
                }
                episode.step(&vec![action; muscles]).unwrap();
            }
            if let Some(Ending::Fault(fault)) = episode.ending() {
                let _ = writeln!(problems, "{}, action {action}: {fault}", episode.task().name);
            }
        }
    }
    assert!(problems.is_empty(), "\n{problems}");
}
