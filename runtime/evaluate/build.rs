//! Names the build: the environment variable `MSK_BUILD` of the compilation is a hash of everything that affects results.

use sha2::{Digest, Sha256};
use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// What affects results, relative to the root of the repository.
const DECISIVE: &[&str] = &[
    "runtime/Cargo.toml",
    "runtime/src",
    "runtime/evaluate/Cargo.toml",
    "runtime/evaluate/src",
    "runtime/storage/Cargo.toml",
    "runtime/storage/src",
    "runtime/physics/Cargo.toml",
    "runtime/physics/src",
    "learn/network/Cargo.toml",
    "learn/network/src",
    "learn/plan/Cargo.toml",
    "learn/plan/src",
    "learn/settings/Cargo.toml",
    "learn/settings/src",
    "learn/train/Cargo.toml",
    "learn/train/src",
    "compiler/Cargo.toml",
    "compiler/src",
    "compiler/program/Cargo.toml",
    "compiler/program/src",
    "runtime/text/Cargo.toml",
    "runtime/text/src",
    "grammar/msk.pest",
    "bodies",
    "Cargo.lock",
];

/// Hashes the sources of compiler, compiled tasks, runtime, planner, learners, evaluation and storage, the grammar, the bodies and the versions of all
/// libraries to 16 hexadecimal digits, from the names and bytes of these files alone: the same on every machine.
fn main() -> Result<(), Box<dyn Error>> {
    let repository = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../..");
    let mut hasher = Sha256::new();
    for place in DECISIVE {
        let root = repository.join(place);
        println!("cargo::rerun-if-changed={}", root.display());
        let mut files = Vec::new();
        collect(&root, place, &mut files)?;
        files.sort();
        for (name, path) in files {
            let bytes = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            // Lengths separate the contents of consecutive files.
            hasher.update(format!("{name} {}\n", bytes.len()));
            hasher.update(bytes);
        }
    }
    let build = hasher.finalize().iter().take(8).fold(String::new(), |text, byte| text + &format!("{byte:02x}"));
    println!("cargo::rustc-env=MSK_BUILD={build}");
    Ok(())
}

/// The files at and below `path`, with names that have forward slashes. A place that a package does not carry has none.
fn collect(path: &Path, name: &str, files: &mut Vec<(String, PathBuf)>) -> Result<(), Box<dyn Error>> {
    if path.is_file() {
        files.push((name.to_owned(), path.to_owned()));
    } else if path.is_dir() {
        for entry in fs::read_dir(path)? {
            let entry = entry?;
            collect(&entry.path(), &format!("{name}/{}", entry.file_name().to_string_lossy()), files)?;
        }
    }
    Ok(())
}
