//! Probing tells what shows only with the model at hand, tells it where it stands, and is silent about the benchmark.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use msk_compiler::compile;
use msk_compiler::diagnostics::{Diagnostic, codes};
use msk_compiler::files::{LoadError, Loader};
use msk_runtime::library::{BodyLibrary, FileLoader};
use msk_runtime::probe;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

struct One(String);

impl Loader for One {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if path == Path::new("example.msk") { Ok(self.0.clone()) } else { Err(LoadError::Missing(path.to_path_buf())) }
    }
}

/// What probing tells of a task of these statements, and the text of the main place of each.
fn told(statements: &str) -> Vec<(Diagnostic, String)> {
    let mut text = format!("task example {{\nbody human\nreward {{ 1 tall = pelvis.height / 1 m }}\n{statements}\n");
    for (word, line) in [
        ("control", "control 100 Hz"),
        ("horizon", "horizon 1000 steps"),
        ("observe", "observe { pelvis.height }"),
        ("init", "init { pose neutral }"),
        ("success", "success survived"),
    ] {
        if !statements.lines().any(|said| said.starts_with(word)) {
            text = format!("{text}{line}\n");
        }
    }
    let text = format!("{text}}}\n");
    let compilation =
        compile(Path::new("example.msk"), &One(text), bodies()).unwrap_or_else(|report| panic!("{statements}:\n{report}"));
    let found = probe::tasks(&compilation.tasks, bodies());
    let place = |told: &Diagnostic| told.span().of(compilation.sources.text(told.file())).to_owned();
    found.into_iter().map(|told| (told.clone(), place(&told))).collect()
}

fn codes_of(statements: &str) -> Vec<&'static str> {
    told(statements).iter().map(|(told, _)| told.code.id).collect()
}

#[test]
fn examples_of_codes_cause_them_and_fixes_do_not() {
    for code in codes::probing::ALL {
        assert!(codes_of(code.example).contains(&code.id), "{}: {:?}", code.id, told(code.example));
        assert_eq!(codes_of(code.fix), [""; 0], "{}: {:?}", code.id, told(code.fix));
    }
}

#[test]
fn an_overlap_is_told_with_names_and_millimetres_at_the_beginning() {
    let told = told("init { pose neutral\n root { height 0.8 m } }");
    let (overlap, place) = told.iter().find(|(told, _)| told.code.id == "W0530").unwrap();
    assert_eq!(place, "init");
    assert!(
        overlap.message.contains("`floor` 1") && overlap.message.contains(" mm inside `l_bofoot_col2`"),
        "{}",
        overlap.message
    );
}

#[test]
fn ends_that_hold_at_the_first_step_are_told_where_they_stand() {
    let statements = "init { pose neutral\n root { height on ground } }\n\
        terminate { low when pelvis.height < 1.2 m }\nsuccess com.height > 0.5 m";
    let told = told(statements);
    let places: Vec<(&str, &str)> = told.iter().map(|(told, place)| (told.code.id, place.as_str())).collect();
    assert_eq!(places, [("W0512", "pelvis.height < 1.2 m"), ("W0512", "com.height > 0.5 m")]);
    assert!(told[0].0.message.contains("3 of 3 episodes"), "{}", told[0].0.message);
}

#[test]
fn what_is_told_can_be_allowed_with_a_reason() {
    for (lint, code) in [("starts_inside", 0), ("starts_apart", 1), ("cannot_begin", 2)] {
        let code = codes::probing::ALL[code];
        let found = codes_of(&format!("allow {lint} \"on purpose\"\n{}", code.example));
        assert!(!found.contains(&code.id), "{lint}: {found:?}");
    }
    let holds = "terminate { low when pelvis.height < 1.2 m }";
    assert_eq!(codes_of(holds), ["W0512"]);
    assert_eq!(codes_of(&format!("allow holds_at_reset \"on purpose\"\n{holds}")), [""; 0]);
}

/// Defects of the corpus of which is said that probing catches them.
#[test]
fn defects_that_are_said_to_be_caught_are() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../compiler/tests/language/defects");
    let mut caught = 0;
    for page in ["hands", "standing", "steps", "walking"] {
        let text = std::fs::read_to_string(folder.join(page).with_extension("md")).unwrap();
        for defect in text.split("\n## ").filter(|defect| defect.contains("Verdict: caught by probing")) {
            let (kind, rest) = defect.split_once("\n```msk ").unwrap().1.split_once('\n').unwrap();
            let body = rest.split_once("\n```").unwrap().0;
            let statements = if kind == "beginning" { body.to_owned() } else { format!("{kind} {{\n{body}\n}}") };
            assert!(codes_of(&statements).iter().any(|code| code.starts_with("W053")), "{page}: {defect}");
            caught += 1;
        }
    }
    assert!(caught >= 5, "{caught}");
}

#[test]
fn the_suite_and_the_examples_begin_as_they_should() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files: Vec<PathBuf> = ["tasks.msk", "tasks/composed.msk", "tasks/loads.msk"].map(|file| root.join(file)).into();
    let examples = std::fs::read_dir(root.join("examples")).unwrap().map(|entry| entry.unwrap().path());
    files.extend(examples.filter(|path| path.extension().is_some_and(|extension| extension == "msk")));
    files.sort();
    for file in files {
        let compilation = compile(&file, &FileLoader, bodies()).unwrap_or_else(|report| panic!("{}:\n{report}", file.display()));
        let found = probe::tasks(&compilation.tasks, bodies());
        assert!(found.is_empty(), "{}: {found:#?}", file.display());
    }
}
