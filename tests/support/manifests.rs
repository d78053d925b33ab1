//! The manifests of the workspace, as far as tests look at them.

use super::repository;
use std::collections::BTreeMap;
use std::fs;

/// The manifest of a crate.
#[derive(serde::Deserialize)]
pub struct Manifest {
    pub package: Package,
    #[serde(default)]
    pub dependencies: BTreeMap<String, toml::Value>,
    /// Its test programs.
    #[serde(default)]
    pub test: Vec<Target>,
}

#[derive(serde::Deserialize)]
pub struct Package {
    pub name: String,
    pub description: String,
}

#[derive(serde::Deserialize)]
pub struct Target {
    pub path: String,
}

#[derive(serde::Deserialize)]
struct Root {
    workspace: Workspace,
}

#[derive(serde::Deserialize)]
struct Workspace {
    members: Vec<String>,
}

/// Folder and manifest of every crate, in the order of the workspace; that of the program, `.`, is the last.
pub fn manifests() -> Vec<(String, Manifest)> {
    let read = |folder: &str| fs::read_to_string(repository(folder).join("Cargo.toml")).unwrap();
    let root: Root = toml::from_str(&read(".")).unwrap();
    let folders = root.workspace.members.into_iter().chain([".".to_owned()]);
    folders.map(|folder| (folder.clone(), toml::from_str(&read(&folder)).unwrap())).collect()
}
