//! Every test file belongs to a test program: Cargo looks for none by itself (`autotests = false`), so that a crate's tests are
//! linked once.

use crate::support::manifests::{Manifest, manifests};
use crate::support::repository;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Files and folders of tests, without extension, that no test program of the crate names.
fn unregistered(folder: &Path, manifest: Manifest) -> Vec<String> {
    let mut known: BTreeSet<String> = BTreeSet::new();
    for target in manifest.test {
        let text = fs::read_to_string(folder.join(&target.path)).unwrap();
        known.insert(Path::new(&target.path).file_stem().unwrap().to_string_lossy().into_owned());
        let modules = text.lines().filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
        known.extend(modules.map(str::to_owned));
    }
    let Ok(entries) = fs::read_dir(folder.join("tests")) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    let code = paths.filter(|path| path.extension().is_some_and(|extension| extension == "rs") || path.join("mod.rs").exists());
    let mut names: Vec<String> = code.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    names.retain(|name| !known.contains(name));
    names.sort();
    names
}

#[test]
fn every_test_file_is_part_of_a_test_program() {
    let all = manifests();
    assert!(all.len() > 5);
    for (member, manifest) in all {
        let forgotten = unregistered(&repository(&member), manifest);
        assert!(forgotten.is_empty(), "{member}: no `mod` in a test program names {forgotten:?}");
    }
}
