//! Recordings and the program that shows them, as one HTML page.
//!
//! The recordings are one stream: the length of a JSON header in four bytes, the header, the bytes of all tracks; compressed by
//! DEFLATE, which browsers unpack themselves, and written as base64.

use crate::Recording;
use crate::anatomy::Anatomy;
use crate::recording::Header;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde::Serialize;
use std::io::{self, Write};

/// The frame of the page.
const FRAME: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// The program, in the order in which its parts need each other.
const PROGRAM: [&str; 21] = [
    include_str!("page/algebra.js"),
    include_str!("page/data.js"),
    include_str!("page/kinematics.js"),
    include_str!("page/palette.js"),
    include_str!("page/paths.js"),
    include_str!("page/shaders.js"),
    include_str!("page/solids.js"),
    include_str!("page/stage.js"),
    include_str!("page/renderer.js"),
    include_str!("page/camera.js"),
    include_str!("page/chart.js"),
    include_str!("page/terms.js"),
    include_str!("page/families.js"),
    include_str!("page/signals.js"),
    include_str!("page/inspector.js"),
    include_str!("page/player.js"),
    include_str!("page/pictures.js"),
    include_str!("page/keys.js"),
    include_str!("page/viewer.js"),
    include_str!("page/panels.js"),
    include_str!("page/main.js"),
];

#[derive(Serialize)]
struct Contents<'a> {
    version: u32,
    title: &'a str,
    models: Vec<&'a Anatomy>,
    recordings: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    model: usize,
    /// Where its tracks begin among the bytes of all.
    start: usize,
    #[serde(flatten)]
    header: &'a Header,
}

/// A page that shows `recordings`, the first at first. The same recordings give the same bytes.
///
/// # Errors
/// None that is known: memory takes all that is written.
pub fn page(title: &str, recordings: &[Recording]) -> io::Result<String> {
    let data = STANDARD.encode(packed(title, recordings)?);
    let program = PROGRAM.concat();
    let parts = [("{{title}}", escape(title)), ("{{style}}", STYLE.into()), ("{{program}}", program), ("{{data}}", data)];
    // Each mark stands once, and the parts are filled in from the end so that none is looked for in another.
    let mut page = FRAME.to_owned();
    for (mark, part) in parts.iter().rev() {
        if let Some(at) = page.find(mark) {
            page.replace_range(at..at + mark.len(), part);
        }
    }
    Ok(page)
}

fn packed(title: &str, recordings: &[Recording]) -> io::Result<Vec<u8>> {
    let mut models: Vec<&Anatomy> = Vec::new();
    let mut entries = Vec::new();
    let mut start = 0;
    for recording in recordings {
        let model = models.iter().position(|known| **known == recording.anatomy).unwrap_or_else(|| {
            models.push(&recording.anatomy);
            models.len() - 1
        });
        entries.push(Entry { model, start, header: &recording.header });
        start += recording.bytes.len();
    }
    let header = serde_json::to_vec(&Contents { version: 1, title, models, recordings: entries })?;
    let length = u32::try_from(header.len()).map_err(io::Error::other)?;
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&length.to_le_bytes())?;
    encoder.write_all(&header)?;
    recordings.iter().try_for_each(|recording| encoder.write_all(&recording.bytes))?;
    encoder.finish()
}

/// Text as it may stand in HTML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
