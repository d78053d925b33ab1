//! Any weights file beside any history: the history is read or refused; a change after one that was read is made and is its last entry;
//! a change that is refused has not happened.
//!
//! The text before a zero byte is the file, the lines behind it are its history, each with the right version of its text, or else nothing
//! but that would be looked at; a line behind `!` stays as it is.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msk_tuning::store::{Outcome, Store, StoreError, Version};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use tempfile::TempDir;

/// The folder of the file, on disk.
fn folder() -> &'static TempDir {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::create_dir(folder.path().join(".msk")).expect("a folder");
        folder
    })
}

/// The line with the version of its text.
fn versioned(line: &str) -> String {
    if let Some(raw) = line.strip_prefix('!') {
        return raw.to_owned();
    }
    let Ok(Value::Object(mut begun)) = serde_json::from_str(line) else { return line.to_owned() };
    if let Some(text) = begun.get("text").and_then(Value::as_str) {
        begun.insert("version".into(), Version::of(text).hash.into());
    }
    format!("{}\n", Value::Object(begun))
}

fn bytes(path: &Path) -> Option<Vec<u8>> {
    fs::read(path).ok()
}

fuzz_target!(|text: &str| {
    let (file, lines) = text.split_once('\0').unwrap_or((text, ""));
    let path = folder().path().join("weights.toml");
    let beside = folder().path().join(".msk/weights.toml.history.jsonl");
    fs::write(&path, file).expect("a file");
    let history: String = lines.split_inclusive('\n').map(versioned).collect();
    fs::write(&beside, &history).expect("a file");

    let store = Store::open(&path).expect("a folder");
    let before = store.history();
    let next = format!("{file}# more\n");
    let changed = store.change("fuzz", |present| Ok::<_, StoreError>((format!("{}# more\n", present.text), ())));
    match changed {
        Ok(outcome) => {
            assert!(matches!(&outcome, Outcome::Changed(version, ()) if version.text == next), "{text:?}");
            assert_eq!(bytes(&path), Some(next.clone().into_bytes()), "{text:?}");
            if let Ok(before) = before {
                let after = store.history().unwrap_or_else(|error| panic!("{error} after a change: {text:?}"));
                assert!(after.len() > before.len() && after.starts_with(&before), "lost: {text:?}");
                assert!(after.last().is_some_and(|entry| entry.text == next && entry.by == "fuzz"), "{text:?}");
            }
        }
        Err(error) => {
            assert!(before.is_err(), "{error}, though the history was read: {text:?}");
            assert_eq!(bytes(&path), Some(file.as_bytes().to_vec()), "changed, though refused: {text:?}");
            assert_eq!(bytes(&beside), Some(history.into_bytes()), "changed, though refused: {text:?}");
        }
    }
});
