//! The meaning of tasks as a specification: the pages under `tests/language/`, compiled whole.

#[allow(dead_code)] // `reading` serves the pages about syntax.
use crate::support;

use msk_compiler::diagnostics::codes;
use msk_compiler::task::Spread;
use support::compiling::{Compiling, compile_text, complete};
use support::{ENTRY, Reading, check_pages};

#[test]
fn pages_about_meaning_tell_the_truth() {
    check_pages("meaning", &Compiling);
}

#[test]
fn mistakes_of_beginners_are_answered() {
    check_pages("mistakes", &Compiling);
}

#[test]
fn known_defects_are_caught() {
    check_pages("defects", &Compiling);
}

/// Pages whose example is no list of statements of a task, or is a description; those of motions are read by `motions.rs`.
const ELSEWHERE: [&str; 9] = ["E0208", "E0412", "E0434", "E0436", "E0437", "E0438", "E0439", "W0500", "W0514"];

#[test]
fn examples_of_codes_cause_them_and_fixes_do_not() {
    let mut wrong = Vec::new();
    let pages = [
        codes::names::ALL,
        codes::types::ALL,
        codes::tasks::ALL,
        codes::scene::ALL,
        codes::composition::ALL,
        codes::lints::ALL,
        codes::intent::ALL,
        codes::incentive::ALL,
        codes::slips::ALL,
        codes::exploits::ALL,
        codes::channels::ALL,
    ];
    for code in pages.into_iter().flatten().filter(|code| !ELSEWHERE.contains(&code.id)) {
        let found = |statements: &str| -> Vec<&str> {
            Compiling.read(&complete(statements), &[]).diagnostics.iter().map(|diagnostic| diagnostic.code.id).collect()
        };
        let (example, fix) = (found(code.example), found(code.fix));
        if example.is_empty() || example.iter().any(|id| *id != code.id) {
            wrong.push(format!("{}: its example gives {example:?}", code.id));
        }
        if !fix.is_empty() {
            wrong.push(format!("{}: its fix gives {fix:?}", code.id));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn examples_of_the_chapter_on_scenes_compile() {
    let page = include_str!("../../grammar/REFERENCE.md");
    let chapter = page.split("\n## 7 ").nth(1).unwrap().split("\n## 8 ").next().unwrap();
    let mut wrong = String::new();
    let files = chapter.split("\n```csv ").skip(1).map(|block| block.split("\n```").next().unwrap().split_once('\n').unwrap());
    let files: Vec<(String, String)> = files.map(|(path, text)| (path.to_owned(), text.to_owned())).collect();
    for block in chapter.split("\n```msk task\n").skip(1) {
        let snippet = block.split("\n```").next().unwrap();
        for diagnostic in Compiling.read(&complete(snippet), &files).diagnostics {
            wrong += &format!("{}: {}\n{snippet}\n", diagnostic.code.id, diagnostic.message);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_standing_task_compiles_without_a_warning() {
    let stand = include_str!("../../tasks/stabilization/stand.msk").replace("../lib/", "lib/");
    let compilation = compile_text(&stand, &[]).unwrap_or_else(|report| panic!("{report}"));
    assert!(compilation.warnings.is_empty(), "{ENTRY}");
    let task = &compilation.tasks[0];
    assert_eq!(task.terms.iter().map(|term| term.weight).collect::<Vec<_>>(), [10.0, 15.0, 10.0, 10.0, 5.0, -0.01]);
    assert_eq!(task.terms[1].weight_range, Some([5.0, 30.0]));
    assert_eq!(task.terminations, ["fallen", "tilted"]);
    assert_eq!((task.horizon, task.control_frequency, task.symmetric), (1000, 100.0, true));
    assert!(task.init.coordinate_noise.iter().all(|spread| matches!(spread, Spread::None | Spread::Normal(0.005))));
}
