//! No dependency has a known hole: every locked version is looked up in RustSec's advisories.
//!
//! `cargo deny check advisories` asks the same, but has to fetch the database with git; `advisories/database.jsonl` is a copy of
//! what it knows, so that the check runs wherever the tests run. `advisories/renew.py` renews the copy. What is accepted stands in
//! `deny.toml` with its reason, for both.

use semver::{Version, VersionReq};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::read_to_string;
use std::path::{Path, PathBuf};

/// What is known about some versions of a crate.
#[derive(Deserialize)]
struct Advisory {
    id: String,
    package: String,
    title: String,
    /// Versions without the hole from some version on.
    patched: Vec<VersionReq>,
    /// Versions that never had it.
    unaffected: Vec<VersionReq>,
}

impl Advisory {
    fn affects(&self, version: &Version) -> bool {
        !self.patched.iter().chain(&self.unaffected).any(|request| request.matches(version))
    }
}

#[derive(Deserialize)]
struct Lock {
    package: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    version: Version,
}

#[derive(Deserialize)]
struct Deny {
    advisories: Accepted,
}

#[derive(Deserialize)]
struct Accepted {
    ignore: Vec<Ignored>,
}

#[derive(Deserialize)]
struct Ignored {
    id: String,
    reason: String,
}

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// All advisories by crate; the first line of the file says where they come from.
fn database() -> BTreeMap<String, Vec<Advisory>> {
    let mut known: BTreeMap<String, Vec<Advisory>> = BTreeMap::new();
    for line in read_to_string(root("tests/advisories/database.jsonl")).unwrap().lines().skip(1) {
        let advisory: Advisory = serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        known.entry(advisory.package.clone()).or_default().push(advisory);
    }
    known
}

/// Identifiers of the advisories that apply to a crate's version.
fn affecting<'a>(database: &'a BTreeMap<String, Vec<Advisory>>, name: &str, version: &Version) -> Vec<&'a Advisory> {
    database.get(name).into_iter().flatten().filter(|advisory| advisory.affects(version)).collect()
}

#[test]
fn no_locked_version_has_a_known_hole() {
    let database = database();
    let deny: Deny = toml::from_str(&read_to_string(root("deny.toml")).unwrap()).unwrap();
    let mut unused: BTreeSet<&str> = deny.advisories.ignore.iter().map(|ignored| ignored.id.as_str()).collect();
    let mut found = Vec::new();
    for lock in ["Cargo.lock", "fuzz/Cargo.lock"] {
        let packages = toml::from_str::<Lock>(&read_to_string(root(lock)).unwrap()).unwrap().package;
        assert!(packages.len() > 100, "{lock} lists {} packages", packages.len());
        for Package { name, version } in packages {
            for advisory in affecting(&database, &name, &version) {
                unused.remove(advisory.id.as_str());
                if !deny.advisories.ignore.iter().any(|ignored| ignored.id == advisory.id) {
                    found.push(format!("{lock}: {name} {version}: {}: {}", advisory.id, advisory.title));
                }
            }
        }
    }
    assert!(found.is_empty(), "update these, or accept them with a reason in deny.toml:\n{}", found.join("\n"));
    assert!(unused.is_empty(), "deny.toml accepts what no longer applies: {unused:?}");
    assert!(deny.advisories.ignore.iter().all(|ignored| !ignored.reason.is_empty()));
}

#[test]
fn a_version_with_a_hole_is_found() {
    let database = database();
    assert!(database.values().flatten().count() > 1000);
    let ids = |name: &str, version: &str| -> Vec<&str> {
        affecting(&database, name, &version.parse().unwrap()).iter().map(|advisory| advisory.id.as_str()).collect()
    };
    // nalgebra: patched from 0.27.1 on, never in versions before 0.11.0.
    assert_eq!(ids("nalgebra", "0.27.0"), ["RUSTSEC-2021-0070"]);
    assert!(ids("nalgebra", "0.27.1").is_empty() && ids("nalgebra", "0.10.9").is_empty());
    // Without a patched version every version is affected.
    assert_eq!(ids("paste", "1.0.15"), ["RUSTSEC-2024-0436"]);
}
