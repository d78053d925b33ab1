//! The benchmark's tasks: each compiles without a remark, begins with nothing inside anything else, runs, and passes its tests.

use msk::compiler::task::CompiledTask;
use msk::compiler::{Compilation, compile};
use msk::evaluate::testing;
use msk::runtime::episode::{Ending, Environment, EpisodeKey};
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::fmt::Write;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// The suite.
const FILE: &str = "tasks.msk";

/// What goes beyond the benchmark: tasks of several parts, the load study, and the paper's own formulas.
const FURTHER: [&str; 3] = ["tasks/composed.msk", "tasks/loads.msk", "tasks/paper.msk"];

fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

fn compiled(file: &str) -> Compilation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    compile(&path, &FileLoader, bodies()).unwrap_or_else(|report| panic!("{file}:\n{report}"))
}

fn episodes() -> Vec<Environment> {
    // Of the further files those in their suites: tasks that these are made of begin as they do.
    let further = FURTHER.iter().map(|file| compiled(file)).flat_map(|compilation| {
        let named: Vec<String> =
            compilation.suites.iter().flat_map(|suite| &suite.families).flat_map(|(_, tasks)| tasks.clone()).collect();
        compilation.tasks.into_iter().filter(move |task| named.contains(&task.name))
    });
    let tasks = compiled(FILE).tasks.into_iter().chain(further);
    let begin = |task: Arc<CompiledTask>| {
        let staged = bodies().stage(&task.body, &task.scene).unwrap_or_else(|error| panic!("{}: {error:?}", task.name));
        Environment::new(staged.model, staged.body, task).unwrap()
    };
    tasks.map(begin).collect()
}

#[test]
fn tasks_compile_without_a_remark() {
    let compilation = compiled(FILE);
    assert!(compilation.warnings.is_empty(), "{:#?}", compilation.warnings);
    for suite in &compilation.suites {
        let named: Vec<&String> = suite.families.iter().flat_map(|(_, tasks)| tasks).collect();
        assert_eq!(named.len(), compilation.tasks.len(), "every task is in the suite once");
    }
}

#[test]
fn further_tasks_compile_without_a_remark() {
    let agents = ["agents/targets.msk", "agents/synergies.msk", "agents/activations.msk", "agents/suite.msk"];
    for file in FURTHER.into_iter().chain(agents) {
        let compilation = compiled(file);
        assert!(compilation.warnings.is_empty(), "{file}: {:#?}", compilation.warnings);
        assert!(!compilation.suites.is_empty(), "{file} has no suite");
    }
}

/// A task in another action space is named `poised_` or `paced_` and the task of the benchmark.
#[test]
fn the_suite_of_the_agents_has_every_task_of_the_benchmark() {
    let families = |file: &str| compiled(file).suites.remove(0).families;
    let plain = |name: String| name.trim_start_matches("poised_").trim_start_matches("paced_").to_owned();
    let played = families("agents/suite.msk").into_iter().map(|(family, tasks)| (family, tasks.into_iter().map(plain).collect()));
    assert_eq!(played.collect::<Vec<(String, Vec<String>)>>(), families(FILE));
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

/// Plays the tests of all tasks of a family.
fn passes_its_tests(family: &str) {
    pass_their_tests(compiled(FILE).tasks.into_iter().filter(|task| task.family == family).collect());
}

fn pass_their_tests(tasks: Vec<Arc<CompiledTask>>) {
    let mut jobs = Vec::new();
    for task in &tasks {
        let staged = bodies().stage(&task.body, &task.scene).unwrap();
        let tests = task.tests.as_ref().unwrap_or_else(|| panic!("{} has no tests", task.name));
        jobs.extend((0..tests.tests.len()).map(|place| (tests.as_ref(), staged.clone(), place)));
    }
    let failed: Vec<_> = testing::run_all(&jobs, None).unwrap().into_iter().filter(|report| !report.passed()).collect();
    assert!(!jobs.is_empty() && failed.is_empty(), "{failed:#?}");
}

#[test]
fn stabilization_passes_its_tests() {
    passes_its_tests("stabilization");
}

#[test]
fn locomotion_passes_its_tests() {
    passes_its_tests("locomotion");
}

#[test]
fn interaction_passes_its_tests() {
    passes_its_tests("interaction");
}

#[test]
fn further_tasks_pass_their_tests() {
    let benchmark = compiled(FILE).tasks;
    for file in FURTHER {
        let further = compiled(file).tasks.into_iter().filter(|task| benchmark.iter().all(|known| known.name != task.name));
        // The paper's formulas need no tests of their own: their reports stand in the suite's.
        pass_their_tests(further.filter(|task| task.tests.is_some() || !task.name.starts_with("paper_")).collect());
    }
}

/// Known exploits, in scripts; each is ranked below a demonstration when the tests are played.
#[test]
fn every_task_has_a_demonstration_and_three_exploits() {
    for task in compiled(FILE).tasks {
        let tests = task.tests.as_ref().unwrap();
        assert!(tests.demonstrations().next().is_some(), "{}: no test expects success at its end", task.name);
        let exploits = tests.tests.iter().filter(|test| test.cheat).count();
        assert!(exploits >= 3, "{}: {exploits} exploits", task.name);
    }
}

/// A task shows how it succeeds, how it does not, every way in which it ends, and for every term two situations of which one is
/// rewarded more.
#[test]
fn every_task_has_its_demonstrations() {
    let mut missing = String::new();
    for task in compiled(FILE).tasks {
        let tests = &task.tests.as_ref().unwrap().tests;
        let written: Vec<&str> =
            tests.iter().flat_map(|test| &test.expectations).map(|expectation| expectation.source.as_str()).collect();
        let mut wanted = |what: String, there: bool| {
            if !there {
                let _ = writeln!(missing, "{}: {what}", task.name);
            }
        };
        wanted("succeeds".into(), written.contains(&"success"));
        wanted("is cheated".into(), tests.iter().any(|test| test.cheat));
        for reason in task.terminations.iter().chain(&task.finishes) {
            wanted(format!("ends by {reason}"), written.iter().any(|text| text.starts_with(&format!("ended by {reason}"))));
        }
        for term in &task.terms {
            let contribution = format!("reward.{} at ", term.name);
            wanted(format!("pays {} in order", term.name), written.iter().any(|text| text.matches(&contribution).count() >= 2));
        }
    }
    assert!(missing.is_empty(), "\n{missing}");
}
