//! Every example compiles without a remark, begins soundly, runs, is laid out, and teaches: its header ends with a thing to try,
//! and the course lists it.

use msk::compiler::diagnostics::SourceMap;
use msk::compiler::format::format;
use msk::compiler::{self, Compilation};
use msk::runtime::action::ActsOn;
use msk::runtime::episode::{Ending, Environment, EpisodeKey};
use msk_runtime::library::{BodyLibrary, FileLoader};
use std::path::{Path, PathBuf};
use std::{fs, sync::OnceLock};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

fn examples() -> Vec<PathBuf> {
    let files = tasks_in(&folder());
    assert!(files.len() >= 14, "{files:?}");
    files
}

/// Those of the course, and other people's tasks.
fn examples_and_peers() -> Vec<PathBuf> {
    examples().into_iter().chain(tasks_in(&folder().join("peers"))).collect()
}

fn tasks_in(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "msk"));
    files.sort();
    files
}

fn compiled(file: &Path) -> Compilation {
    compiler::compile(file, &FileLoader, bodies()).unwrap_or_else(|report| panic!("{}:\n{report}", file.display()))
}

#[test]
fn every_example_compiles_without_a_remark() {
    for file in examples_and_peers() {
        let compilation = compiled(&file);
        assert!(compilation.warnings.is_empty(), "{}: {:?}", file.display(), compilation.warnings);
        assert!(!compilation.tasks.is_empty(), "{} holds no task", file.display());
    }
}

#[test]
fn every_example_begins_soundly_and_runs() {
    for file in examples_and_peers() {
        for task in compiled(&file).tasks {
            let name = format!("{}, {}", file.display(), task.name);
            let staged = bodies().stage(&task.body, &task.scene).unwrap_or_else(|error| panic!("{name}: {error:?}"));
            let mut episode = Environment::new(staged.model, staged.body, task).unwrap();
            let start = episode.inspect_start(EpisodeKey { seed: 0, episode: 0 }).unwrap();
            assert!(start.penetrations.is_empty() && start.residuals.is_empty(), "{name}: {start:?}");
            episode.reset(EpisodeKey { seed: 0, episode: 0 });
            let rest = episode.engine().action(ActsOn::Task);
            for _ in 0..10 {
                if episode.ending().is_some() {
                    break;
                }
                episode.step(&rest).unwrap();
            }
            assert!(!matches!(episode.ending(), Some(Ending::Fault(_))), "{name}: {:?}", episode.ending());
        }
    }
}

#[test]
fn every_example_is_laid_out_teaches_and_is_part_of_the_course() {
    let course = fs::read_to_string(folder().join("README.md")).unwrap();
    for file in examples() {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&file).unwrap();
        let source = SourceMap::default().add(name.clone(), text.as_str());
        assert!(format(source, &text).is_ok_and(|formatted| formatted == text), "{name}: lay it out with `msk fmt examples`");
        let header: Vec<&str> = text.lines().take_while(|line| line.starts_with("//!")).collect();
        let tries = header.iter().rposition(|line| line.contains("Try")).unwrap_or(0);
        assert!(header.len() >= 2 && tries >= 1, "{name}: the header teaches, and ends with a thing to try");
        assert!(course.contains(&format!("({name})")), "{name} is not in examples/README.md");
    }
}
