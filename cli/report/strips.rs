//! The film strips of a report: pictures within its page.

use super::Section;
use super::read::Source;
use crate::error::{Context, Error};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use msk_storage::Folder;
use std::path::Path;

/// Largest picture that is read, bytes.
const LARGEST: u64 = 16 << 20;

/// The first bytes of every PNG file.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// A part for every folder that has strips.
///
/// # Errors
/// A picture that cannot be read.
pub fn sections(sources: &[Source]) -> Result<Vec<Section>, Error> {
    let section = |source: &Source| -> Result<Section, Error> {
        Ok(Section {
            title: format!("Film strips: {}", source.label),
            words: "Moments of episodes at equal distances, with their times; muscles by activation.".into(),
            table: None,
            figures: source.strips.iter().map(|path| figure(path)).collect::<Result<_, _>>()?,
        })
    };
    sources.iter().map(section).collect()
}

fn figure(path: &Path) -> Result<String, Error> {
    let cannot = || format!("cannot read `{}`", path.display());
    let (folder, file) = (path.parent().unwrap_or(Path::new("")), path.file_name().unwrap_or_default());
    // A page is passed on: no link may bring another file of this machine into it.
    let bytes = Folder::open(folder).and_then(|folder| folder.read_private(Path::new(file), LARGEST)).context(cannot)?;
    let Some(bytes) = bytes.filter(|bytes| bytes.starts_with(SIGNATURE)) else {
        return Err(
            Error::new(format!("`{}` is not a PNG picture", path.display())).hint("`msk eval --strip` writes film strips")
        );
    };
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    // Names of tasks are words of letters, digits and underscores; a file may be called anything.
    let name: String = name.chars().filter(|letter| letter.is_alphanumeric() || "_- ".contains(*letter)).collect();
    let data = STANDARD.encode(bytes);
    Ok(format!("<figure><figcaption>{name}</figcaption><img alt=\"{name}\" src=\"data:image/png;base64,{data}\"></figure>"))
}
