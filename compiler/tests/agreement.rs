//! The index beside the compiler: for every name that the checker resolved the index has the same declaration.

use msk_compiler::body::BodyDescription;
use msk_compiler::diagnostics::{FileId, Span};
use msk_compiler::files::{BodySource, LoadError, Loader};
use msk_compiler::hir::{NameUse, Resolution};
use msk_compiler::resolve::index::Index;
use msk_compiler::vocabulary::Vocabulary;
use msk_compiler::{Inspection, inspect};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Files of the repository.
struct Repository;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

impl Loader for Repository {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        std::fs::read_to_string(root().join(path)).map_err(|_| LoadError::Missing(path.to_path_buf()))
    }
}

impl BodySource for Repository {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        let path = PathBuf::from(format!("bodies/{name}.msk"));
        Some((path.clone(), self.load(&path).ok()?))
    }

    fn vocabulary(&self, _: &BodyDescription) -> Result<Vocabulary, String> {
        let text = include_str!("fixtures/human_vocabulary.json");
        serde_json::from_str(text).map_err(|error| error.to_string())
    }
}

/// Where both disagree in a file and in all that it uses, and on how many names they agree.
fn compare(entry: &Path) -> (BTreeSet<String>, usize) {
    let index = Index::of(&[entry.to_path_buf()], &Repository);
    let inspection = inspect(entry, &Repository, &Repository);
    let file = |id: FileId| inspection.files.iter().find(|known| known.tree.file == id).and_then(|known| index.file(&known.path));
    let mut declared: BTreeMap<usize, Vec<(usize, Span)>> = BTreeMap::new();
    for place in index.occurrences.iter().filter(|place| place.declares) {
        declared.entry(place.symbol).or_default().push((place.file, place.span));
    }
    // Every place at which a name stands, with every place at which it is declared.
    let known: BTreeSet<_> = index
        .occurrences
        .iter()
        .flat_map(|named| declared.get(&named.symbol).into_iter().flatten().map(|place| ((named.file, named.span), *place)))
        .collect();
    let uses = inspection.scopes.iter().flat_map(|scope| &scope.typed).flat_map(|typed| typed.hir().uses());
    let (mut wrong, mut agreed) = (BTreeSet::new(), 0);
    for name in uses {
        let Resolution::Definition(declared) = name.resolution else { continue };
        let pair = file(name.file).zip(file(declared.file)).map(|(here, there)| ((here, name.span), (there, declared.span)));
        if pair.is_some_and(|pair| known.contains(&pair)) {
            agreed += 1;
        } else {
            wrong.insert(place(&inspection, name));
        }
    }
    (wrong, agreed)
}

fn place(inspection: &Inspection, name: &NameUse) -> String {
    let sources = &inspection.report.sources;
    let (line, column) = sources.line_column(name.file, name.span.start as usize);
    format!("{}:{line}:{column}: `{}`", sources.path(name.file), name.span.of(sources.text(name.file)))
}

#[test]
fn the_index_has_for_every_name_the_declaration_that_the_checker_found() {
    let examples = std::fs::read_dir(root().join("examples")).unwrap();
    let examples = examples.map(|entry| Path::new("examples").join(entry.unwrap().file_name()));
    let examples = examples.filter(|path| path.extension().is_some_and(|extension| extension == "msk"));
    let (mut wrong, mut agreed) = (BTreeSet::new(), 0);
    for entry in examples.chain([PathBuf::from("tasks.msk")]) {
        let (unlike, like) = compare(&entry);
        wrong.extend(unlike);
        agreed += like;
    }
    assert!(wrong.is_empty(), "{}", wrong.into_iter().collect::<Vec<_>>().join("\n"));
    assert!(agreed > 1000, "{agreed} names were compared");
}
