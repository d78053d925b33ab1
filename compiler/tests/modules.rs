//! The direction between the top-level modules of the compiler and of what it makes: no two of them need each other.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Which modules each module names, by the paths that begin with `crate`.
type Needs = BTreeMap<String, BTreeSet<String>>;

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
}

/// The text of a file without comments and without its tests.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

fn named(code: &str) -> impl Iterator<Item = String> {
    code.split("crate::").skip(1).map(|rest| rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect())
}

fn needs_of(crate_folder: &str) -> Needs {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(crate_folder).join("src");
    let mut all = Vec::new();
    files(&root, &mut all);
    let mut needs = Needs::new();
    for path in all {
        let first = path.strip_prefix(&root).unwrap().components().next().unwrap().as_os_str().to_str().unwrap();
        let own = first.trim_end_matches(".rs").to_owned();
        let code = code(&std::fs::read_to_string(&path).unwrap());
        let others: Vec<String> = named(&code).filter(|other| *other != own).collect();
        needs.entry(own).or_default().extend(others);
    }
    needs
}

/// A cycle, if there is one: modules that need nothing that is left are taken away until nothing changes.
fn cycle(mut needs: Needs) -> Vec<String> {
    loop {
        let left: BTreeSet<String> = needs.keys().cloned().collect();
        let free: Vec<String> =
            needs.iter().filter(|(_, others)| others.is_disjoint(&left)).map(|(own, _)| own.clone()).collect();
        if free.is_empty() {
            return needs.into_iter().map(|(own, others)| format!("{own} -> {:?}", others.intersection(&left))).collect();
        }
        needs.retain(|own, _| !free.contains(own));
    }
}

#[test]
fn modules_need_each_other_in_one_direction() {
    let (compiler, program) = (needs_of("."), needs_of("program"));
    assert!(compiler.len() > 15 && compiler["check"].contains("hir") && compiler["lint"].contains("check"), "{compiler:?}");
    assert!(program.len() > 20 && program["task"].contains("lower") && program["snapshot"].contains("task"), "{program:?}");
    // What is emitted depends on what type checking has decided, and on nothing that it was decided from.
    let decided = ["frame", "graph", "hir"].map(str::to_owned);
    assert_eq!(compiler["emit"], BTreeSet::from(decided));
    for needs in [compiler, program] {
        let found = cycle(needs);
        assert!(found.is_empty(), "these modules need each other:\n{}", found.join("\n"));
    }
}

#[test]
fn a_cycle_is_found() {
    let needs = |pairs: &[(&str, &str)]| {
        let mut needs = Needs::new();
        for (own, other) in pairs {
            needs.entry((*own).to_owned()).or_default().insert((*other).to_owned());
            needs.entry((*other).to_owned()).or_default();
        }
        needs
    };
    assert!(cycle(needs(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    assert_eq!(cycle(needs(&[("a", "b"), ("b", "c"), ("c", "b")])).len(), 3);
    assert_eq!(
        named(&code("use crate::one::{Two}; // crate::three\n#[cfg(test)]\nmod tests {\nuse crate::four;")).collect::<Vec<_>>(),
        ["one"]
    );
}
