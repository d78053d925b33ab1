//! Writes `OUT_DIR/texts.rs`, a table (path below the repository, text) of the tasks and motions, sorted by path: the package holds
//! them, so that it needs no files beside it.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Files and folders below the repository.
const EMBEDDED: &[&str] = &["tasks.msk", "tasks", "motions"];
const EXTENSIONS: &[&str] = &["msk", "csv"];

fn main() -> Result<(), Box<dyn Error>> {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("..");
    let mut names = Vec::new();
    for place in EMBEDDED {
        println!("cargo::rerun-if-changed={}", root.join(place).display());
        collect(&root.join(place), place, &mut names)?;
    }
    names.sort();
    let mut table = String::from("[\n");
    for name in names {
        let path = root.join(&name).canonicalize()?;
        writeln!(table, "    ({name:?}, include_str!({path:?})),")?;
    }
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("texts.rs"), table + "]\n")?;
    Ok(())
}

/// The files at and below `path`, with names that have forward slashes.
fn collect(path: &Path, name: &str, names: &mut Vec<String>) -> Result<(), Box<dyn Error>> {
    if path.is_dir() {
        for entry in fs::read_dir(path).map_err(|error| format!("{}: {error}", path.display()))? {
            let entry = entry?;
            collect(&entry.path(), &format!("{name}/{}", entry.file_name().to_string_lossy()), names)?;
        }
    } else if path.extension().is_some_and(|found| EXTENSIONS.iter().any(|extension| found == *extension)) {
        names.push(name.to_owned());
    }
    Ok(())
}
