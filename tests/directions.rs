//! Which crate may depend on which: the compiler knows no physics, the physics knows no language, and nothing knows the command line.
//! `docs/architecture/crates.md` draws it: `MSK_UPDATE=1 cargo test --test suite directions` writes the page anew.

use crate::support::manifests::{Manifest, Package, manifests};
use crate::support::repository;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;

/// Each crate of the workspace with all crates of the workspace that it may name, dependencies of its tests aside.
const ALLOWED: [(&str, &[&str]); 18] = [
    ("msk-text", &[]),
    ("msk-storage", &[]),
    ("msk-physics", &["msk-storage", "msk-text"]),
    ("msk-program", &["msk-text"]),
    ("msk-compiler", &["msk-program", "msk-text"]),
    ("msk-network", &[]),
    ("msk-settings", &["msk-text"]),
    ("msk-runtime", &["msk-physics", "msk-program", "msk-storage"]),
    ("msk-plan", &["msk-physics", "msk-program", "msk-runtime", "msk-settings", "msk-storage"]),
    ("msk-train", &["msk-network", "msk-program", "msk-runtime", "msk-settings", "msk-storage"]),
    ("msk-evaluate", &["msk-compiler", "msk-physics", "msk-program", "msk-runtime", "msk-storage", "msk-text"]),
    ("msk-export", &["msk-physics", "msk-program", "msk-runtime"]),
    ("msk-draw", &["msk-physics", "msk-program", "msk-runtime", "msk-text"]),
    ("msk-view", &["msk-physics", "msk-program", "msk-runtime"]),
    ("msk-tuning", &["msk-compiler", "msk-evaluate", "msk-physics", "msk-runtime", "msk-storage", "msk-text"]),
    ("msk-lsp", &["msk-compiler"]),
    ("msk-mcp", &["msk-compiler", "msk-evaluate", "msk-physics", "msk-runtime", "msk-storage", "msk-tuning"]),
    (
        "msk",
        &[
            "msk-compiler",
            "msk-draw",
            "msk-evaluate",
            "msk-export",
            "msk-lsp",
            "msk-mcp",
            "msk-physics",
            "msk-plan",
            "msk-runtime",
            "msk-storage",
            "msk-text",
            "msk-train",
            "msk-tuning",
            "msk-view",
        ],
    ),
];

/// Folder and manifest of every crate, those first on which others depend.
fn crates() -> Vec<(String, Manifest)> {
    let mut found = manifests();
    let place = |name: &str| ALLOWED.iter().position(|(known, _)| *known == name);
    found.sort_by_key(|(_, manifest)| place(&manifest.package.name));
    found
}

/// The crates of the workspace that one depends on.
fn own(manifest: &Manifest) -> BTreeSet<&str> {
    manifest.dependencies.keys().map(String::as_str).filter(|key| key.starts_with("msk")).collect()
}

#[test]
fn crates_depend_in_one_direction() {
    let mut allowed: BTreeMap<&str, BTreeSet<&str>> =
        ALLOWED.map(|(name, others)| (name, others.iter().copied().collect())).into();
    for (_, manifest) in &crates() {
        let name = manifest.package.name.as_str();
        let may = allowed.remove(name).unwrap_or_else(|| panic!("`{name}` is not in the table of directions"));
        assert_eq!(own(manifest), may, "dependencies of `{name}`");
    }
    assert!(allowed.is_empty(), "no such crates: {allowed:?}");
    // The table itself goes one way: each crate names only those above it.
    for (place, (name, others)) in ALLOWED.iter().enumerate() {
        let above: BTreeSet<&str> = ALLOWED[..place].iter().map(|(name, _)| *name).collect();
        assert!(others.iter().all(|other| above.contains(other)), "`{name}` depends on a crate below it");
    }
}

/// Dependencies of a crate that none of its other dependencies has: the arrows of the picture.
fn direct<'a>(manifest: &'a Manifest, all: &'a [(String, Manifest)]) -> BTreeSet<&'a str> {
    let of = |name: &str| all.iter().find(|(_, other)| other.package.name == name).map(|(_, other)| own(other));
    let behind: BTreeSet<&str> = own(manifest).iter().filter_map(|name| of(name)).flatten().collect();
    own(manifest).into_iter().filter(|name| !behind.contains(name)).collect()
}

#[test]
fn the_picture_of_the_crates_is_that_of_the_manifests() {
    let all = crates();
    let mut page = "# The crates\n\nDrawn from the manifests by `MSK_UPDATE=1 cargo test --test suite directions`. An arrow leads from a crate to one that it \
        depends on;\nwhat follows from other arrows is left out.\n\n```mermaid\ngraph BT\n"
        .to_owned();
    for (_, manifest) in &all {
        let name = &manifest.package.name;
        let _ = writeln!(page, "    {name}[{name}]");
        for other in direct(manifest, &all) {
            let _ = writeln!(page, "    {name} --> {other}");
        }
    }
    page += "```\n\n| crate | folder | is |\n|---|---|---|\n";
    for (folder, manifest) in &all {
        let Package { name, description } = &manifest.package;
        let place = if folder == "." { "cli" } else { folder };
        let _ = writeln!(page, "| `{name}` | [`{place}/`](../../{place}) | {description} |");
    }
    let path = repository("docs/architecture/crates.md");
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        fs::write(&path, &page).unwrap();
    }
    assert_eq!(fs::read_to_string(&path).unwrap_or_default(), page, "MSK_UPDATE=1 writes the page anew");
}

/// Clippy reads the nearest of its files alone: a second one, in the folder of a crate, would let through what it does not repeat.
#[test]
fn one_file_of_clippy_rules_every_crate() {
    let folders = crates().into_iter().map(|(folder, _)| folder).chain(["python", "fuzz"].map(String::from));
    let has = |folder: &str| ["clippy.toml", ".clippy.toml"].into_iter().any(|name| repository(folder).join(name).exists());
    let found: Vec<String> = folders.flat_map(|folder| above(&folder)).filter(|folder| has(folder)).collect();
    assert!(found.iter().all(|folder| folder == "."), "a second file of rules in {found:?}");
    assert!(has("."), "no rules at all");
}

/// A folder of the repository and those above it, from which its rules may come.
fn above(folder: &str) -> Vec<String> {
    let parts: Vec<&str> = folder.split('/').collect();
    (1..=parts.len()).map(|count| parts[..count].join("/")).chain([".".to_owned()]).collect()
}

/// The workspace allows what clippy's file rejects, for tests and examples. Every library and the program choose anew.
#[test]
fn every_crate_heeds_the_rules_or_says_why_not() {
    for (folder, _) in crates() {
        let roots = if folder == "." {
            vec!["cli/lib.rs".to_owned(), "cli/main.rs".to_owned()]
        } else {
            vec![format!("{folder}/src/lib.rs")]
        };
        for root in roots {
            let text = fs::read_to_string(repository(&root)).unwrap();
            let heeds = text.contains("#![cfg_attr(not(test), warn(clippy::disallowed_methods))]");
            assert!(
                heeds || text.contains("#![allow(clippy::disallowed_methods, reason = "),
                "`{root}` does not warn of disallowed methods"
            );
        }
    }
}
