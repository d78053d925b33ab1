//! A store under one program: versions, history, and what a program that died leaves behind.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use msk_tuning::store::{OUTSIDE, Outcome, Store, StoreError, Version};
use std::fs;
use std::path::PathBuf;

fn store() -> (tempfile::TempDir, PathBuf, Store) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("weights.toml");
    let store = Store::new(&path);
    (folder, path, store)
}

fn put(store: &Store, text: &str) -> Version {
    let outcome: Result<_, StoreError> = store.change("test", |_| Ok((text.into(), ())));
    match outcome.unwrap() {
        Outcome::Changed(version, ()) | Outcome::Same(version, ()) => version,
    }
}

#[test]
fn every_version_is_in_the_history_with_its_text() {
    let (_folder, _, store) = store();
    assert_eq!(store.read().unwrap(), None);
    let versions = ["a = 1\n", "a = 2\n", "a = 1\n"].map(|text| put(&store, text));
    assert_eq!(store.read().unwrap().unwrap(), versions[2]);
    assert_eq!(versions[0], versions[2], "a version is what the file holds");
    let history = store.history().unwrap();
    let told: Vec<_> =
        history.iter().map(|entry| (entry.before.as_deref(), entry.version.as_str(), entry.text.as_str())).collect();
    let hash = |index: usize| versions[index].hash.as_str();
    let (first, second) = ((None, hash(0), "a = 1\n"), (Some(hash(0)), hash(1), "a = 2\n"));
    assert_eq!(told, [first, second, (Some(hash(1)), hash(0), "a = 1\n")]);
}

#[test]
fn a_change_that_changes_nothing_is_no_version() {
    let (_folder, _, store) = store();
    put(&store, "a = 1\n");
    assert!(matches!(store.change::<_, StoreError>("test", |now| Ok((now.text.clone(), 7))).unwrap(), Outcome::Same(_, 7)));
    assert_eq!(store.history().unwrap().len(), 1);
}

#[test]
fn a_change_that_fails_leaves_everything_as_it_was() {
    let (_folder, path, store) = store();
    put(&store, "a = 1\n");
    let refused: Result<Outcome<()>, StoreError> = store.change("test", |_| Err(StoreError::NoText { path: path.clone() }));
    assert!(refused.is_err());
    assert_eq!((fs::read_to_string(&path).unwrap().as_str(), store.history().unwrap().len()), ("a = 1\n", 1));
}

#[test]
fn what_an_editor_changed_is_noted_by_the_next_change() {
    let (_folder, path, store) = store();
    put(&store, "a = 1\n");
    put(&store, "a = 2\n");
    // Even back to the version before: it was not this store that did it.
    fs::write(&path, "a = 1\n").unwrap();
    put(&store, "a = 3\n");
    let by: Vec<_> = store.history().unwrap().into_iter().map(|entry| (entry.by, entry.text)).collect();
    assert_eq!(by[2], (OUTSIDE.to_owned(), "a = 1\n".to_owned()));
    assert_eq!(by[3], ("test".to_owned(), "a = 3\n".to_owned()));
}

#[test]
fn what_a_program_had_begun_when_it_died_is_finished() {
    let (folder, path, store) = store();
    put(&store, "a = 1\n");
    put(&store, "a = 2\n");
    // As if the program had died after writing the history and before replacing the file.
    fs::write(&path, "a = 1\n").unwrap();
    fs::write(folder.path().join(".msk/weights.toml.new"), "a = 2\n").unwrap();
    let seen = store.change::<_, StoreError>("test", |now| Ok(("a = 3\n".into(), now.text.clone()))).unwrap();
    assert!(matches!(seen, Outcome::Changed(_, text) if text == "a = 2\n"));
    assert_eq!(store.history().unwrap().len(), 3);
}

#[test]
fn a_line_of_the_history_that_was_cut_short_had_changed_nothing() {
    let (folder, _, store) = store();
    put(&store, "a = 1\n");
    let path = folder.path().join(".msk/weights.toml.history.jsonl");
    let whole = fs::read_to_string(&path).unwrap();
    fs::write(&path, whole.clone() + &whole[..30]).unwrap();
    fs::write(folder.path().join(".msk/weights.toml.new"), "a = 2\n").unwrap();
    assert_eq!(store.history().unwrap().len(), 1);
    put(&store, "a = 3\n");
    let texts: Vec<_> = store.history().unwrap().into_iter().map(|entry| entry.text).collect();
    assert_eq!(texts, ["a = 1\n", "a = 3\n"]);
}

#[test]
fn a_damaged_history_is_told_and_left_alone() {
    let (folder, path, store) = store();
    put(&store, "a = 1\n");
    let history = folder.path().join(".msk/weights.toml.history.jsonl");
    fs::write(&history, "nonsense\n").unwrap();
    let error = store.change::<(), StoreError>("test", |_| Ok(("a = 2\n".into(), ()))).unwrap_err();
    assert!(error.to_string().contains("is damaged, its last line"), "{error}");
    assert_eq!(fs::read_to_string(path).unwrap(), "a = 1\n");
    assert!(store.history().unwrap_err().to_string().contains("line 1"));
}

#[test]
fn long_lines_of_the_history_are_read_whole_from_its_end() {
    let (_folder, _, store) = store();
    let texts: Vec<String> = (1..6).map(|index| format!("# {}\n", "x".repeat(index * 5000))).collect();
    for text in &texts {
        put(&store, text);
    }
    let history: Vec<_> = store.history().unwrap().into_iter().map(|entry| entry.text).collect();
    assert_eq!(history, texts);
}

#[test]
fn a_file_that_is_no_text_or_huge_is_refused() {
    let (_folder, path, store) = store();
    fs::write(&path, [0xff, 0xfe]).unwrap();
    assert!(matches!(store.read(), Err(StoreError::NoText { .. })));
    fs::write(&path, vec![b' '; (1 << 20) + 1]).unwrap();
    assert!(matches!(store.read(), Err(StoreError::NoText { .. })));
}

#[cfg(unix)]
#[test]
fn a_link_is_followed() {
    let (folder, path, store) = store();
    put(&store, "a = 1\n");
    let link = folder.path().join("link.toml");
    std::os::unix::fs::symlink(&path, &link).unwrap();
    put(&Store::new(&link), "a = 2\n");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&path).unwrap(), "a = 2\n");
}
