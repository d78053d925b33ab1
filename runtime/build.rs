//! Names the build, and embeds the bodies.
//!
//! The environment variable `MSK_BUILD` of the compilation is a hash of all that decides results: see [`build`].
//!
//! Compresses the body files and their models for embedding, so that the binary needs no files beside it.
//!
//! Writes `OUT_DIR/bodies.rs` with a table (path, gzip of the text), sorted by path, read by `src/bodies.rs`. The result
//! depends on nothing but the files' contents.

use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};
use std::env;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// What is embedded, as (folder below `bodies`, extension).
const EMBEDDED: [(&str, &str); 2] = [("", "msk"), ("models", "xml")];

/// What decides results, relative to this crate.
const DECISIVE: &[&str] = &[
    "Cargo.toml",
    "src",
    "storage/Cargo.toml",
    "storage/src",
    "physics/Cargo.toml",
    "physics/src",
    "../compiler/Cargo.toml",
    "../compiler/src",
    "../compiler/program/Cargo.toml",
    "../compiler/program/src",
    "../grammar/msk.pest",
    "../bodies",
    "../Cargo.lock",
];

fn main() -> Result<(), Box<dyn Error>> {
    let bodies = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../bodies");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    println!("cargo::rerun-if-changed={}", bodies.display());
    let mut table = String::from("[\n");
    for (index, (name, file)) in files(&bodies)?.into_iter().enumerate() {
        println!("cargo::rerun-if-changed={}", file.display());
        let compressed = format!("body{index}.gz");
        let mut encoder = GzEncoder::new(fs::File::create(out.join(&compressed))?, Compression::best());
        encoder.write_all(&fs::read(&file)?)?;
        encoder.finish()?;
        writeln!(table, "    ({name:?}, include_bytes!(concat!(env!(\"OUT_DIR\"), {:?}))),", format!("/{compressed}"))?;
    }
    table.push_str("]\n");
    fs::write(out.join("bodies.rs"), table)?;
    println!("cargo::rustc-env=MSK_BUILD={}", build()?);
    Ok(())
}

/// A hash of the sources of compiler, compiled tasks, runtime and storage, of the grammar, the bodies and the versions of all libraries: 16 hexadecimal
/// digits. It depends on the names and bytes of these files alone, so the same sources have the same hash on every machine.
fn build() -> Result<String, Box<dyn Error>> {
    let runtime = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let mut hasher = Sha256::new();
    for place in DECISIVE {
        let root = runtime.join(place);
        println!("cargo::rerun-if-changed={}", root.display());
        let mut files = Vec::new();
        collect(&root, place, &mut files)?;
        files.sort();
        for (name, path) in files {
            let bytes = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            // Lengths keep apart what stands side by side.
            hasher.update(format!("{name} {}\n", bytes.len()));
            hasher.update(bytes);
        }
    }
    Ok(hasher.finalize().iter().take(8).fold(String::new(), |text, byte| text + &format!("{byte:02x}")))
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

/// The files to embed with their names, which are paths below the repository with forward slashes.
fn files(bodies: &Path) -> Result<Vec<(String, PathBuf)>, Box<dyn Error>> {
    let mut files = Vec::new();
    for (folder, extension) in EMBEDDED {
        let folder_path = bodies.join(folder);
        for entry in fs::read_dir(&folder_path).map_err(|error| format!("{}: {error}", folder_path.display()))? {
            let path = entry?.path();
            if path.extension().is_some_and(|found| found == extension) {
                let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let name = if folder.is_empty() { format!("bodies/{file}") } else { format!("bodies/{folder}/{file}") };
                files.push((name, path));
            }
        }
    }
    files.sort();
    Ok(files)
}
