//! Tests, mutants and episodes at rest come to the same bits in lanes and one by one, on any number of threads.

use msk_compiler::compile;
use msk_compiler::mutation::Part;
use msk_compiler::task::CompiledTask;
use msk_evaluate::probe;
use msk_evaluate::testing::mutation::{Outcome, Verdict, mutate};
use msk_evaluate::testing::{self, Job, Stage, TestReport};
use msk_runtime::library::{BodyLibrary, FileLoader, WithText};
use std::path::Path;
use std::sync::{Arc, OnceLock};

fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

/// A task on the body alone, with tests that only show, that let physics take over, that are ranked, and that fail with numbers.
fn task(name: &str, elevation: u32) -> String {
    format!(
        "task {name} {{
    body human; control 50 Hz; horizon 30 steps
    init {{ pose neutral; root {{ height on ground }} }}
    observe {{ pelvis.height }}
    reward {{ 1 raised = shoulder_elevation_r.q / 1 rad; -0.1 effort = mean(muscles.activation^2); 0.01 pressed = contact_force(feet, ground).z / 1 N }}
    terminate {{ fallen when pelvis.height < 0.5 m }}
    success survived and shoulder_elevation_r.q > 60 deg
    test \"raised\" {{
        pose neutral
        at 0.2 s {{ shoulder_elevation_r = {elevation} deg }}
        expect success
    }}
    test \"never so far\" {{
        pose neutral
        at 0.3 s {{ shoulder_elevation_r = {elevation} deg }}
        expect shoulder_elevation_r.q > 3 rad; expect not success
    }}
    test \"let go\" {{
        moment held {{ until 0.1 s }}
        moment slackening {{ pose neutral {{ activation = 0.5 }}; run zero for 0.06 s }}
        expect pelvis.height at held < pelvis.height at slackening
    }}
    cheat \"the other arm\" {{ pose neutral; at 0.2 s {{ shoulder_elevation_l = {elevation} deg }} }}
    cheat \"both, for a moment\" {{ pose neutral; at 0.1 s {{ shoulder_elevation_{{l,r}} = 110 deg }}; at 0.4 s pose neutral }}
}}
"
    )
}

fn compiled(text: String) -> Vec<Arc<CompiledTask>> {
    let loader = WithText { path: "lanes.msk".into(), text, others: &FileLoader };
    compile(Path::new("lanes.msk"), &loader, bodies()).unwrap_or_else(|report| panic!("{report}")).tasks
}

fn on_threads<Found: Send>(threads: usize, work: impl FnOnce() -> Found + Send) -> Found {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// All that a report says, to the last digit.
fn in_full(reports: &[TestReport]) -> String {
    format!("{reports:#?}")
}

#[test]
fn tests_have_the_same_bits_in_lanes_and_one_by_one_on_any_number_of_threads() {
    let tasks = compiled(format!("{}{}{}", task("low", 70), task("middle", 90), task("high", 120)));
    let staged = |task: &CompiledTask| bodies().stage(&task.body, &task.scene).unwrap();
    let tests: Vec<_> = tasks.iter().map(|task| (task.tests.clone().unwrap(), staged(task))).collect();
    let jobs: Vec<Job<'_>> = tests
        .iter()
        .flat_map(|(tests, body)| (0..tests.tests.len()).map(|place| (tests.as_ref(), body.clone(), place)))
        .collect();
    let alone: Vec<TestReport> = jobs.iter().map(|(tests, body, place)| Stage::new(tests, body).unwrap().play(*place)).collect();
    assert!(alone.iter().any(|report| report.ranking.as_ref().is_some_and(|ranking| ranking.demonstration.is_some())));
    assert!(alone.iter().any(TestReport::passed) && alone.iter().any(|report| !report.passed()));
    for threads in [1, 2, 5] {
        let together = on_threads(threads, || testing::run_all(&jobs, None).unwrap());
        assert_eq!(in_full(&together), in_full(&alone), "{threads} threads");
    }
}

#[test]
fn mutants_have_the_same_verdicts_on_any_number_of_threads() {
    // Without the test that fails before anything is mutated.
    let text = task("mutated", 90).replace("expect shoulder_elevation_r.q > 3 rad; expect not success", "expect success");
    let verdicts = |threads: usize| -> Vec<Verdict> {
        let judged = || mutate(Path::new("mutated.msk"), &text, "mutated", &[Part::Meaning], &FileLoader, bodies());
        on_threads(threads, judged).unwrap_or_else(|report| panic!("{report}"))
    };
    let one = verdicts(1);
    assert!(one.iter().any(|verdict| matches!(verdict.outcome, Outcome::Killed(_))));
    assert!(one.iter().any(|verdict| verdict.outcome == Outcome::Survived));
    assert_eq!(verdicts(3), one);
}

#[test]
fn episodes_at_rest_are_judged_alike_beside_others_and_alone_on_any_number_of_threads() {
    // Lying down is rewarded, so that every task is reported with what it earns.
    let resting = |name: &str, weight: u32| {
        format!(
            "task {name} {{ body human; control 50 Hz; horizon 60 steps; init {{ pose neutral }} observe {{ pelvis.height }}
            reward {{ {weight} low = 1 - pelvis.height / 1 m }} success pelvis.height > 2 m }}\n"
        )
    };
    let tasks = compiled(["a", "b", "c", "d", "e", "f"].iter().zip(1..).map(|(name, weight)| resting(name, weight)).collect());
    let told = |tasks: &[Arc<CompiledTask>]| format!("{:#?}", probe::episodes(tasks, bodies(), &|| {}));
    let alone: Vec<String> = tasks.iter().map(|task| told(std::slice::from_ref(task))).collect();
    assert!(alone.iter().all(|told| told.contains("doing nothing earns more")), "{alone:?}");
    let whole = on_threads(1, || told(&tasks));
    assert_eq!(on_threads(4, || told(&tasks)), whole);
    let lines = |text: &str| text.lines().filter(|line| line.contains("per step")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(alone.iter().flat_map(|told| lines(told)).collect::<Vec<_>>(), lines(&whole));
}
