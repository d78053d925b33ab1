//! Compiling without physics: the body's vocabulary is a fixture, texts are in memory.
//!
//! The fixture is the output of `msk vocabulary --json` for the body; a test of the workspace compares them.

use super::{ENTRY, Reading};
use msk_compiler::body::BodyDescription;
use msk_compiler::diagnostics::Report;
use msk_compiler::files::{BodySource, LoadError, Loader};
use msk_compiler::vocabulary::Vocabulary;
use msk_compiler::{Compilation, compile};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Texts by path.
pub struct Texts(BTreeMap<PathBuf, String>);

impl Loader for Texts {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        self.0.get(path).cloned().ok_or_else(|| LoadError::Missing(path.to_path_buf()))
    }
}

/// The human body, its vocabulary read from the fixture.
pub struct Bodies;

impl BodySource for Bodies {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        let text = include_str!("../../../bodies/human.msk");
        (name == "human").then(|| (PathBuf::from("bodies/human.msk"), text.to_owned()))
    }

    fn vocabulary(&self, _: &BodyDescription) -> Result<Vocabulary, String> {
        Ok(vocabulary())
    }
}

/// The same with a body file as short as can be: pages are compiled by the hundred, and do not depend on that file.
struct Brief;

impl BodySource for Brief {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        let text = "body human {\n    model \"human.xml\"\n    root pelvis { forward x, up z }\n}\n";
        (name == "human").then(|| (PathBuf::from("bodies/human.msk"), text.to_owned()))
    }

    fn vocabulary(&self, _: &BodyDescription) -> Result<Vocabulary, String> {
        Ok(vocabulary())
    }
}

/// The fixture.
pub fn vocabulary() -> Vocabulary {
    static HUMAN: OnceLock<Vocabulary> = OnceLock::new();
    HUMAN.get_or_init(|| serde_json::from_str(include_str!("../fixtures/human_vocabulary.json")).unwrap()).clone()
}

/// Compiles a text beside the library and other files.
pub fn compile_text(entry: &str, files: &[(String, String)]) -> Result<Compilation, Report> {
    compile(Path::new(ENTRY), &texts(entry, files), &Bodies)
}

/// A text beside the library and other files.
pub fn texts(entry: &str, files: &[(String, String)]) -> Texts {
    let mut texts: BTreeMap<PathBuf, String> = files.iter().map(|(path, text)| (path.into(), text.clone())).collect();
    texts.insert("lib/posture.msk".into(), include_str!("../../../tasks/lib/posture.msk").to_owned());
    texts.insert(ENTRY.into(), entry.to_owned());
    Texts(texts)
}

/// What every task must declare, by keyword.
const REQUIRED: [(&str, &str); 7] = [
    ("body", "body human"),
    ("control", "control 100 Hz"),
    ("horizon", "horizon 1000 steps"),
    ("init", "init { pose neutral }"),
    ("observe", "observe { pelvis.height; pelvis.position; pelvis.yaw; t }"),
    ("reward", "reward { 1 tall = pelvis.height / 1 m }"),
    ("success", "success survived and torso.up.z > 0.5"),
];

/// Lines of a task around statements that leave out those with the given keywords.
fn task_without(declared: impl Fn(&str) -> bool) -> String {
    let lines = REQUIRED.iter().filter(|(keyword, _)| !declared(keyword)).map(|(_, line)| format!("{line}\n"));
    format!("use \"lib/posture.msk\"\ntask example {{\n{}", lines.collect::<String>())
}

/// A whole task of a few statements: whatever they do not declare is added.
pub fn complete(statements: &str) -> String {
    let mut depth = 0;
    let mut outer = Vec::new();
    for line in statements.lines() {
        outer.extend(line.split_whitespace().next().filter(|_| depth == 0));
        depth += line.matches('{').count() as i32 - line.matches('}').count() as i32;
    }
    let declared = |keyword: &str| outer.contains(&keyword);
    format!("{}{statements}\n}}\n", task_without(declared))
}

/// Pages are compiled whole.
pub struct Compiling;

impl Reading for Compiling {
    fn surroundings(&self, kind: &str) -> Option<(String, String)> {
        Some(match kind {
            "" => (String::new(), String::new()),
            "task" => (task_without(|_| false), "}\n".to_owned()),
            "reward" | "observe" | "init" => {
                (format!("{}{kind} {{\n", task_without(|keyword| keyword == kind)), "}\n}\n".to_owned())
            }
            "observed" => (task_without(|keyword| keyword == "observe"), "}\n".to_owned()),
            "beginning" => (task_without(|keyword| keyword == "init"), "}\n".to_owned()),
            "scene" => (format!("{}scene {{\n", task_without(|_| false)), "}\n}\n".to_owned()),
            "terminate" => (format!("{}terminate {{\n", task_without(|_| false)), "}\n}\n".to_owned()),
            "success" => (format!("{}success ", task_without(|keyword| keyword == "success")), "}\n".to_owned()),
            "body" => ("body example {\nmodel \"human.xml\"\nroot pelvis { forward x, up z }\n".to_owned(), "}\n".to_owned()),
            // `task-observe-reward`: statements that declare these themselves.
            _ => {
                let keywords = kind.strip_prefix("task-")?;
                (task_without(|keyword| keywords.split('-').any(|word| word == keyword)), "}\n".to_owned())
            }
        })
    }

    fn read(&self, entry: &str, files: &[(String, String)]) -> Report {
        match compile(Path::new(ENTRY), &texts(entry, files), &Brief) {
            Ok(compilation) => Report::new(compilation.sources, compilation.warnings),
            Err(report) => report,
        }
    }
}
