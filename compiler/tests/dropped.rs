//! Nothing vanishes: whatever a text declares is compiled, or an error gives the reason.

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::diagnostics::{FileId, Report};
use msk_compiler::syntax;
use msk_compiler::syntax::tree::Item;
use proptest::prelude::*;
use support::compiling::{compile_text, complete};

const TABLE: &str = "# name: wave\n# source: made up\n# cycle: yes\n# duration: 1 s\nphase, knee_angle_r [deg], root.x [m]\n0, 10, 0\n0.25, 20, 0\n0.5, 30, 0\n0.75, 20, 0\n1, 10, 0\n";

/// A task that plays a motion, repeats elements of a scene, draws, holds states and has tests.
const TASK: &str = r#"
    reference gait = motion "wave.csv"
    random far = uniform(1 m .. 2 m)
    state best = 0 becomes best + 1 when rising(com.height > 1 m)
    scene {
        ground
        repeat i in 0..3 { cylinder post_{i} { radius 5 cm, length 1 m, at [1 m * i, 2 m, 0.5 m] } }
        box cube { size [0.1 m, 0.1 m, 0.1 m], mass 1 kg, free, at [far, 0, 1 m] }
    }
    reward { 1 a = gait.phase + best
        2 b = distance(cube, post_1) / 1 m }
    terminate { low when pelvis.height < 0.5 m }
    test "stands" { pose neutral; expect not success }
"#;

/// How many objects the only task of a text has, or its errors.
fn objects(statements: &str) -> Result<usize, String> {
    let compiled = compile_text(&complete(statements), &[]);
    compiled.map(|compiled| compiled.tasks[0].scene.objects.len()).map_err(|report| report.to_string())
}

/// What a text and a table declare is there, or an error gives the reason.
fn nothing_vanishes(text: &str, table: &str) -> Result<(), TestCaseError> {
    let declared = syntax::parse(FileId::default(), text).tree.items;
    let declared = declared.iter().filter(|item| matches!(item, Item::Task(_) | Item::Sequence(_))).count();
    match compile_text(text, &[("wave.csv".to_owned(), table.to_owned())]) {
        Ok(compiled) => prop_assert_eq!(compiled.tasks.len(), declared, "{}\n{}", text, table),
        Err(report) => prop_assert!(report.has_errors(), "{}\n{}", text, table),
    }
    Ok(())
}

fn error_of(report: Result<usize, String>) -> String {
    report.unwrap_err()
}

#[test]
fn the_whole_compiles() {
    let compiled = compile_text(&complete(TASK), &[("wave.csv".to_owned(), TABLE.to_owned())]);
    let task = &compiled.unwrap_or_else(|report: Report| panic!("{report}")).tasks[0];
    assert_eq!((task.terms.len(), task.scene.objects.len(), task.tests.as_ref().unwrap().tests.len()), (2, 4, 1));
}

#[test]
fn a_table_may_be_cut_at_any_line() {
    for (end, _) in TABLE.match_indices('\n') {
        nothing_vanishes(&complete(TASK), &TABLE[..end]).unwrap();
    }
    let headings = TABLE.find("0, 10").unwrap();
    let report = compile_text(&complete(TASK), &[("wave.csv".to_owned(), TABLE[..headings].to_owned())]).err().unwrap();
    assert!(report.to_string().contains("a cycle has at least four rows, found 0"), "{report}");
}

#[test]
fn a_place_that_only_what_is_free_or_fixed_to_the_world_may_have() {
    let free = "random r = uniform(1 m .. 2 m)\nscene { ground\nsphere a { radius 1 cm, mass 1 kg, free, at [r, 0, 1 m] }";
    assert_eq!(objects(&format!("{free} }}")), Ok(1));
    let fixed = format!("{free}\nsphere b {{ radius 1 cm, at [r, 0, 1 m] }} }}");
    assert_eq!(objects(&fixed), Ok(2));
    let both = format!("{free}\nsphere b {{ radius 1 cm, mass 1 kg, at [r, 0, 1 m], hinge turn {{ axis [0, 0, 1] }} }} }}");
    assert!(error_of(objects(&both)).contains("error["));
}

#[test]
fn a_state_that_reads_one_below_it() {
    // The warning stands before: it is no reason to drop the error.
    let text = "let twice = (if com.height > 1 m then com.height else com.height) / 1 m\nstate a = twice + b becomes 1 when t > 1 s\nstate b = 0 becomes 1 when t > 1 s\nreward { 1 r = a + b }";
    let report = compile_text(&complete(text), &[]).err().unwrap().to_string();
    assert!(report.contains("W0508") && report.contains("the state `b` has no value here yet"), "{report}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn nothing_vanishes_from_texts_that_are_cut_or_spliced(
        from in any::<prop::sample::Index>(), to in any::<prop::sample::Index>(), put in any::<prop::sample::Index>(), motion in any::<bool>(),
    ) {
        let task = complete(TASK);
        let whole = if motion { TABLE } else { &task };
        let (mut from, mut to) = (from.index(whole.len()), to.index(whole.len()));
        if from > to {
            std::mem::swap(&mut from, &mut to);
        }
        // A piece goes, and another piece comes in its place.
        let put = put.index(whole.len());
        let piece = &whole[put..(put + 12).min(whole.len())];
        let spliced = format!("{}{piece}{}", &whole[..from], &whole[to..]);
        if motion { nothing_vanishes(&task, &spliced)? } else { nothing_vanishes(&spliced, TABLE)? }
    }
}
