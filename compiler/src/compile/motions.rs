//! The motions that texts name, read once each.

use super::{SourceFile, plain};
use crate::check::reference::{Table, Tables};
use crate::diagnostics::{Checked, Diagnostic, FileId, SourceMap, codes};
use crate::files::Loader;
use crate::syntax::tree::{Item, Played, Sequence, Task, TaskStatement, TestStatement, Text};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads every motion that a text names; its path is relative to that text.
pub(super) fn read(
    files: &[SourceFile],
    loader: &dyn Loader,
    sources: &mut SourceMap,
    diagnostics: &mut Vec<Diagnostic>,
) -> Tables {
    let mut tables = Tables::new();
    // A motion that several texts name is read once; its errors are reported once.
    let mut known: BTreeMap<PathBuf, Checked<Table>> = BTreeMap::new();
    for file in files {
        let base = file.path.parent().map(Path::to_path_buf).unwrap_or_default();
        for named in file.tree.items.iter().flat_map(named) {
            let path = plain(&base.join(&named.value));
            let table = known.entry(path.clone()).or_insert_with(|| match loader.load(&path) {
                Ok(text) => table(&path, text, sources, diagnostics),
                Err(problem) => Err(cannot_read(file.tree.file, named, &problem.to_string()).report(diagnostics)),
            });
            tables.insert((file.tree.file, named.value.clone()), table.clone());
        }
    }
    tables
}

fn table(path: &Path, text: String, sources: &mut SourceMap, diagnostics: &mut Vec<Diagnostic>) -> Checked<Table> {
    let file = sources.add(path.display().to_string(), text);
    crate::motion::read_into(file, sources.text(file), diagnostics).map(|motion| Table { file, motion: Arc::new(motion) })
}

fn cannot_read(file: FileId, named: &Text, problem: &str) -> Diagnostic {
    let message = format!("cannot read the motion \"{}\": {problem}", named.value);
    Diagnostic::new(codes::composition::MOTION, file, named.span, message).help("the path is relative to the file that names it")
}

/// The motions that an item of a file names.
fn named(item: &Item) -> Vec<&Text> {
    let (Item::Task(Task { statements, .. }) | Item::Sequence(Sequence { statements, .. })) = item else { return Vec::new() };
    let mut motions = Vec::new();
    for statement in statements {
        match statement {
            TaskStatement::Reference(reference) => motions.push(&reference.motion),
            TaskStatement::Test(test) => played(&test.statements, &mut motions),
            _ => {}
        }
    }
    motions
}

/// The motions that tests play.
fn played<'a>(statements: &'a [TestStatement], motions: &mut Vec<&'a Text>) {
    for statement in statements {
        match statement {
            TestStatement::Play(playing) => {
                if let Played::File(path) = &playing.motion {
                    motions.push(path);
                }
            }
            TestStatement::Repeat { statements, .. } | TestStatement::Moment { statements, .. } => played(statements, motions),
            _ => {}
        }
    }
}
