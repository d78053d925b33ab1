//! Which crate may depend on which: the compiler knows no physics, the physics knows no language, and nothing knows the program.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Each crate of the workspace with all crates of the workspace that it may name, dependencies of its tests aside.
const ALLOWED: [(&str, &[&str]); 9] = [
    ("msk-storage", &[]),
    ("msk-physics", &["msk-storage"]),
    ("msk-compiler", &[]),
    ("msk-runtime", &["msk-compiler", "msk-physics", "msk-storage"]),
    ("msk-draw", &["msk-compiler", "msk-physics", "msk-runtime"]),
    ("msk-tuning", &["msk-compiler", "msk-physics", "msk-runtime", "msk-storage"]),
    ("msk-lsp", &["msk-compiler"]),
    ("msk-mcp", &["msk-compiler", "msk-physics", "msk-runtime", "msk-storage", "msk-tuning"]),
    ("msk", &["msk-compiler", "msk-draw", "msk-lsp", "msk-mcp", "msk-physics", "msk-runtime", "msk-storage", "msk-tuning"]),
];

#[derive(serde::Deserialize)]
struct Manifest {
    package: Package,
    dependencies: BTreeMap<String, toml::Value>,
}

#[derive(serde::Deserialize)]
struct Package {
    name: String,
}

#[derive(serde::Deserialize)]
struct Root {
    workspace: Workspace,
}

#[derive(serde::Deserialize)]
struct Workspace {
    members: Vec<String>,
}

#[test]
fn crates_depend_in_one_direction() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |folder: &str| fs::read_to_string(root.join(folder).join("Cargo.toml")).unwrap();
    let members: Root = toml::from_str(&read(".")).unwrap();
    let mut allowed: BTreeMap<&str, BTreeSet<&str>> =
        ALLOWED.map(|(name, others)| (name, others.iter().copied().collect())).into();
    for folder in members.workspace.members.iter().map(String::as_str).chain(["."]) {
        let manifest: Manifest = toml::from_str(&read(folder)).unwrap();
        let name = manifest.package.name.as_str();
        let may = allowed.remove(name).unwrap_or_else(|| panic!("`{name}` is not in the table of directions"));
        let found: BTreeSet<&str> =
            manifest.dependencies.keys().map(String::as_str).filter(|key| key.starts_with("msk")).collect();
        assert_eq!(found, may, "dependencies of `{name}`");
    }
    assert!(allowed.is_empty(), "no such crates: {allowed:?}");
}
