//! Who notices a change of a task: the compiler, its lints, a test, or nobody.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use msk::compiler::mutation::{Class, Mutant, Part};
use msk::runtime::library::{BodyLibrary, FileLoader};
use msk::runtime::testing::mutation::{Count, Notice, Verdict, mutate};
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

/// Who noticed that `from`, at its last place before `test`, became `to`.
fn notice(verdicts: &[Verdict], text: &str, from: &str, to: &str) -> (Notice, String) {
    let wanted = |verdict: &&Verdict| verdict.mutant.span.of(text) == from && verdict.mutant.replacement == to;
    let found = verdicts.iter().rfind(wanted).unwrap_or_else(|| panic!("no {from} -> {to} in {verdicts:#?}"));
    (found.notice, found.by.clone())
}

#[test]
fn a_change_is_noticed_by_checks_lints_tests_or_nobody() {
    let all = verdicts(TEXT);
    let told = |from, to| notice(&all, TEXT, from, to);
    // A speed is no length.
    assert_eq!(told("height", "speed"), (Notice::Checks, "E0301".into()));
    // The task would begin with its end.
    assert_eq!(told("<", ">").0, Notice::Lints);
    assert_eq!(told("0.3", "0.15"), (Notice::Tests, "low".into()));
    assert_eq!(told("2", "4"), (Notice::Unseen, String::new()));
    let count = Count::of(all.iter(), |_, _| true);
    assert_eq!(count.checks + count.lints + count.tests + count.unseen, count.all);
    assert_eq!(count.all, all.iter().filter(|verdict| verdict.notice != Notice::Same).count());
    assert_eq!(Count::of(all.iter(), |_, class| class == Class::Comparison).all, 1);
}

#[test]
fn probing_notices_what_no_test_looks_at() {
    let text = TEXT.replace("success survived", "success pelvis.height > 1 m");
    let all = verdicts(&text);
    // Nobody stands so high.
    assert_eq!(notice(&all, &text, "1", "2"), (Notice::Lints, "W0533".into()));
}

#[test]
fn a_change_without_meaning_is_counted_nowhere() {
    // Nobody reads the number: `1 * 1` is as much as `1 / 1`.
    let text = TEXT.replace("pelvis.height / 1 m", "pelvis.height / 1 m * 1");
    let all = verdicts(&text);
    assert_eq!(notice(&all, &text, "*", "/"), (Notice::Same, String::new()));
    let counted = Count::of(all.iter(), |_, class| class == Class::Sign);
    assert_eq!(counted.all, all.iter().filter(|verdict| verdict.mutant.class == Class::Sign).count() - 1);
}

#[test]
fn warnings_that_were_there_before_notice_nothing() {
    let text = TEXT.replace("    success", "    let unread = 3\n    success");
    let all = verdicts(&text);
    let unread: Vec<&Verdict> = all.iter().filter(|verdict| verdict.mutant.span.of(&text) == "3").collect();
    assert_eq!(unread.len(), 3);
    assert!(unread.iter().all(|verdict| verdict.notice == Notice::Same), "{unread:#?}");
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
fn surroundings_are_a_part_of_their_own_that_tests_notice_where_they_look() {
    let around = "scene { ground; sphere ball { radius 40 cm, at [0.6 m, 0, 40 cm] } }
    init { pose neutral { elbow_flexion_l = 30 deg } }";
    let test = "test \"the ball\" {
        moment begun { until 0.01 s }
        expect 39 cm < ball.radius < 41 cm and elbow_flexion_l.q < 31 deg at begun
    }
    test \"low\"";
    let text = TEXT.replace("init { pose neutral }", around).replace("test \"low\"", test);
    let parts = [Part::Scene, Part::Beginning, Part::Channels];
    let all = mutate(Path::new("example.msk"), &text, "example", &parts, &FileLoader, &BodyLibrary::default()).unwrap();
    let told = |part, from, to| {
        let wanted = |mutant: &Mutant| mutant.part == part && mutant.span.of(&text) == from && mutant.replacement == to;
        let found = all.iter().find(|verdict| wanted(&verdict.mutant));
        found.unwrap_or_else(|| panic!("no {from} -> {to} in {all:#?}")).notice
    };
    assert_eq!(told(Part::Scene, "40", "44"), Notice::Tests);
    // Nobody looks at how far away it is, unless the body begins within it.
    assert_eq!(told(Part::Scene, "0.6", "1.2"), Notice::Unseen);
    assert_eq!(told(Part::Scene, "0.6", "0.3"), Notice::Lints);
    assert_eq!(told(Part::Beginning, "30", "33"), Notice::Tests);
    assert_eq!(told(Part::Channels, "height", "speed"), Notice::Unseen);
    assert!(all.iter().all(|verdict| verdict.mutant.part != Part::Meaning));
}
