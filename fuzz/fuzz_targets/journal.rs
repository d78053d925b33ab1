//! Any folder given as the results of a run: it is read or refused with a reason, and refusing changes nothing.
//!
//! The first line is `run.json`, the others are episodes, each given its run and the right checksum, or else nothing but the checksum would
//! be looked at; a line behind `!` stays as it is.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msk_evaluate::{Journal, RunSettings};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use tempfile::TempDir;

const WALL_TIME: &str = ",\"wall_time\":";

/// The folder of the results, on disk.
fn folder() -> &'static TempDir {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| tempfile::tempdir().expect("a temporary folder"))
}

/// The line as the journal would have written it, if it is an episode's.
fn sealed(line: &str, run: &str) -> String {
    if let Some(raw) = line.strip_prefix('!') {
        return raw.to_owned();
    }
    let (line, end) = line.strip_suffix('\n').map_or((line, ""), |line| (line, "\n"));
    // Earlier programs wrote the wall time behind the checksum.
    let (content, time) = match line.rsplit_once(WALL_TIME) {
        Some((content, time)) => (content, format!("{WALL_TIME}{time}")),
        None => match line.strip_suffix('}') {
            Some(content) => (content, "}".to_owned()),
            None => return format!("{line}{end}"),
        },
    };
    let content = format!("{content},\"run\":\"{run}\"");
    let digest = Sha256::digest(content.as_bytes());
    let checksum = digest.iter().take(8).fold(String::new(), |text, byte| text + &format!("{byte:02x}"));
    format!("{content},\"checksum\":\"{checksum}\"{time}{end}")
}

fuzz_target!(|text: &str| {
    let (settings, lines) = text.split_once('\n').unwrap_or((text, ""));
    let known: Option<RunSettings> = serde_json::from_str(settings).ok();
    let run = known.as_ref().map(RunSettings::identity).unwrap_or_default();
    let episodes: String = lines.split_inclusive('\n').map(|line| sealed(line, &run)).collect();
    let path = folder().path();
    fs::write(path.join("run.json"), settings).expect("a file");
    fs::write(path.join("episodes.jsonl"), &episodes).expect("a file");

    let read = Journal::records(path);
    if let Err(error) = &read {
        assert!(!error.to_string().is_empty());
    }
    let Some(known) = known else {
        assert!(read.is_err(), "read without settings: {text:?}");
        return;
    };
    match (Journal::open(path, &known), read) {
        (Ok((_, again)), Ok(records)) => {
            // A number that is none is no number that it could be compared with.
            assert_eq!(format!("{again:?}"), format!("{records:?}"), "{text:?}");
        }
        (Err(_), _) => {}
        (Ok(_), Err(error)) => panic!("opened, but not read: {error}: {text:?}"),
    }
    let kept = |name: &str| fs::read_to_string(path.join(name)).expect("it stays");
    assert_eq!((kept("run.json").as_str(), kept("episodes.jsonl")), (settings, episodes), "changed: {text:?}");
    assert!(fs::read_dir(path).expect("a folder").count() <= 3 && Path::new(path).is_dir(), "litter: {text:?}");
});
