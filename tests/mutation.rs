//! What kills a mutant of a task: the compiler, a lint, a test, or nothing.

use msk::compiler::mutation::{Class, Mutant, Part};
use msk::evaluate::testing::mutation::{Count, Killer, Outcome, Verdict, mutate};
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::path::Path;

const TEXT: &str = r#"task example {
    body human; control 100 Hz; horizon 20 steps
    init { pose neutral }
    observe { pelvis.height }
    reward {
        2 tall = pelvis.height / 1 m
        -1 effort = mean(muscles.activation^2)
    }
    terminate { fallen when pelvis.height < 0.3 m }
    success survived
    test "low" {
        moment low { pose neutral { root.height = 0.25 m } }
        moment high { pose neutral { root.height = 0.35 m } }
        expect ended by fallen at low
        expect not terminated at high
    }
}
"#;

fn verdicts(text: &str) -> Vec<Verdict> {
    mutate(Path::new("example.msk"), text, "example", &[Part::Meaning], &FileLoader, &BodyLibrary::default())
        .unwrap_or_else(|report| panic!("{report}"))
}

/// What became of the mutant in which the last `from` is `to`.
fn outcome(verdicts: &[Verdict], text: &str, from: &str, to: &str) -> (Outcome, String) {
    let wanted = |verdict: &&Verdict| verdict.mutant.span.of(text) == from && verdict.mutant.replacement == to;
    let found = verdicts.iter().rfind(wanted).unwrap_or_else(|| panic!("no {from} -> {to} in {verdicts:#?}"));
    (found.outcome, found.by.clone())
}

#[test]
fn a_mutant_is_killed_by_checks_lints_or_tests_or_survives() {
    let all = verdicts(TEXT);
    let became = |from, to| outcome(&all, TEXT, from, to);
    // A speed is no length.
    assert_eq!(became("height", "speed"), (Outcome::Killed(Killer::Checks), "E0301".into()));
    // The task would begin with its end.
    assert_eq!(became("<", ">").0, Outcome::Killed(Killer::Lints));
    assert_eq!(became("0.3", "0.15"), (Outcome::Killed(Killer::Tests), "low".into()));
    assert_eq!(became("2", "4"), (Outcome::Survived, String::new()));
    let count = Count::of(all.iter(), |_, _| true);
    assert_eq!(count.checks + count.lints + count.tests + count.survived, count.all);
    assert_eq!(count.all, all.iter().filter(|verdict| verdict.outcome != Outcome::Equivalent).count());
    assert_eq!(Count::of(all.iter(), |_, class| class == Class::Comparison).all, 1);
}

#[test]
fn probing_kills_what_no_test_looks_at() {
    let text = TEXT.replace("success survived", "success pelvis.height > 1 m");
    let all = verdicts(&text);
    // No body stands so high.
    assert_eq!(outcome(&all, &text, "1", "2"), (Outcome::Killed(Killer::Lints), "W0533".into()));
}

#[test]
fn an_equivalent_mutant_is_counted_nowhere() {
    // No formula reads the number: `1 * 1` is as much as `1 / 1`.
    let text = TEXT.replace("pelvis.height / 1 m", "pelvis.height / 1 m * 1");
    let all = verdicts(&text);
    assert_eq!(outcome(&all, &text, "*", "/"), (Outcome::Equivalent, String::new()));
    let counted = Count::of(all.iter(), |_, class| class == Class::Sign);
    assert_eq!(counted.all, all.iter().filter(|verdict| verdict.mutant.class == Class::Sign).count() - 1);
}

#[test]
fn warnings_that_were_there_before_kill_nothing() {
    let text = TEXT.replace("    success", "    let unread = 3\n    success");
    let all = verdicts(&text);
    let unread: Vec<&Verdict> = all.iter().filter(|verdict| verdict.mutant.span.of(&text) == "3").collect();
    assert_eq!(unread.len(), 3);
    assert!(unread.iter().all(|verdict| verdict.outcome == Outcome::Equivalent), "{unread:#?}");
}

#[test]
fn a_text_that_does_not_compile_is_an_error_and_a_task_that_is_not_there_has_no_changes() {
    let bodies = BodyLibrary::default();
    let broken = TEXT.replace("0.3 m }", "0.3 s }");
    let report = mutate(Path::new("example.msk"), &broken, "example", &[Part::Meaning], &FileLoader, &bodies).unwrap_err();
    assert_eq!(report.diagnostics[0].code.id, "E0301");
    assert_eq!(mutate(Path::new("example.msk"), TEXT, "other", &[Part::Meaning], &FileLoader, &bodies).unwrap(), []);
}

#[test]
fn scene_initial_state_and_observation_are_parts_of_their_own_whose_mutants_tests_kill_where_they_look() {
    let around = "scene { ground; sphere ball { radius 40 cm, at [0.6 m, 0, 40 cm] } }
    init { pose neutral { elbow_flexion_l = 30 deg } }";
    let test = "test \"the ball\" {
        moment begun { until 0.01 s }
        expect 39 cm < ball.radius < 41 cm and elbow_flexion_l.q < 31 deg at begun
    }
    test \"low\"";
    let text = TEXT.replace("init { pose neutral }", around).replace("test \"low\"", test);
    let parts = [Part::Scene, Part::InitialState, Part::Observation];
    let all = mutate(Path::new("example.msk"), &text, "example", &parts, &FileLoader, &BodyLibrary::default()).unwrap();
    let became = |part, from, to| {
        let wanted = |mutant: &Mutant| mutant.part == part && mutant.span.of(&text) == from && mutant.replacement == to;
        let found = all.iter().find(|verdict| wanted(&verdict.mutant));
        found.unwrap_or_else(|| panic!("no {from} -> {to} in {all:#?}")).outcome
    };
    assert_eq!(became(Part::Scene, "40", "44"), Outcome::Killed(Killer::Tests));
    // Nothing measures how far away it is, unless the body begins within it.
    assert_eq!(became(Part::Scene, "0.6", "1.2"), Outcome::Survived);
    assert_eq!(became(Part::Scene, "0.6", "0.3"), Outcome::Killed(Killer::Lints));
    assert_eq!(became(Part::InitialState, "30", "33"), Outcome::Killed(Killer::Tests));
    assert_eq!(became(Part::Observation, "height", "speed"), Outcome::Survived);
    assert!(all.iter().all(|verdict| verdict.mutant.part != Part::Meaning));
}
