//! Compresses the body files and their models for embedding, so that the binary needs no files beside it.
//!
//! Writes `OUT_DIR/bodies.rs` with a table (path, gzip of the text), sorted by path, read by `src/bodies.rs`. The result
//! depends on nothing but the files' contents.

use flate2::Compression;
use flate2::write::GzEncoder;
use std::env;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// What is embedded, as (folder below `bodies`, extension).
const EMBEDDED: [(&str, &str); 2] = [("", "msk"), ("models", "xml")];

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
