//! A store under one program: versions, history, links, and what a program that died leaves behind.

use msk_compiler::weights::Change;
use msk_storage::StorageError;
use msk_tuning::store::{OUTSIDE, Outcome, Store, StoreError, Version};
use std::fs;
use std::path::{Path, PathBuf};

struct Room {
    folder: tempfile::TempDir,
    path: PathBuf,
    store: Store,
}

impl Room {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("weights.toml");
        Self { store: Store::open(&path).unwrap(), folder, path }
    }

    fn put(&self, text: &str) -> Version {
        put(&self.store, text)
    }

    /// Who made the versions, and their texts.
    fn history(&self) -> Vec<(String, String)> {
        self.store.history().unwrap().into_iter().map(|entry| (entry.by, entry.text)).collect()
    }

    fn texts(&self) -> Vec<String> {
        self.history().into_iter().map(|(_, text)| text).collect()
    }

    fn log(&self) -> PathBuf {
        self.folder.path().join(".msk/weights.toml.history.jsonl")
    }

    /// As if the program had died before it wrote the last line of the history.
    fn forget_the_last_line(&self) {
        let lines = fs::read_to_string(self.log()).unwrap();
        let kept: Vec<&str> = lines.split_inclusive('\n').collect();
        fs::write(self.log(), kept[..kept.len() - 1].concat()).unwrap();
    }
}

fn put(store: &Store, text: &str) -> Version {
    let outcome: Result<_, StoreError> = store.change("test", |_| Ok((text.into(), ())));
    match outcome.unwrap() {
        Outcome::Changed(version, ()) | Outcome::Same(version, ()) => version,
    }
}

#[test]
fn every_version_is_in_the_history_with_its_text() {
    let room = Room::new();
    assert_eq!(room.store.read().unwrap(), None);
    assert!(room.history().is_empty());
    let versions = ["a = 1\n", "a = 2\n", "a = 1\n"].map(|text| room.put(text));
    assert_eq!(room.store.read().unwrap().unwrap(), versions[2]);
    assert_eq!(versions[0], versions[2], "a version is what the file holds");
    let history = room.store.history().unwrap();
    let entries: Vec<_> =
        history.iter().map(|entry| (entry.before.as_deref(), entry.version.as_str(), entry.text.as_str())).collect();
    let hash = |index: usize| versions[index].hash.as_str();
    let (first, second) = ((None, hash(0), "a = 1\n"), (Some(hash(0)), hash(1), "a = 2\n"));
    assert_eq!(entries, [first, second, (Some(hash(1)), hash(0), "a = 1\n")]);
}

#[test]
fn a_change_that_changes_nothing_is_no_version() {
    let room = Room::new();
    room.put("a = 1\n");
    let same = room.store.change::<_, StoreError>("test", |now| Ok((now.text.clone(), 7)));
    assert!(matches!(same.unwrap(), Outcome::Same(_, 7)));
    assert_eq!(room.texts(), ["a = 1\n"]);
}

#[test]
fn a_change_that_fails_leaves_everything_as_it_was() {
    let room = Room::new();
    room.put("a = 1\n");
    // Even what an editor did is not noted yet.
    fs::write(&room.path, "a = 2\n").unwrap();
    let log = fs::read(room.log()).unwrap();
    let refused: Result<Outcome<()>, StoreError> = room.store.change("test", |_| Err(StoreError::Name { path: "x".into() }));
    assert!(refused.is_err());
    assert_eq!((fs::read_to_string(&room.path).unwrap().as_str(), fs::read(room.log()).unwrap()), ("a = 2\n", log));
    let huge: Result<Outcome<()>, StoreError> = room.store.change("test", |_| Ok((" ".repeat((1 << 20) + 1), ())));
    assert!(matches!(huge, Err(StoreError::Storage(StorageError::TooLarge { .. }))), "what could not be read is not written");
    assert_eq!((fs::read_to_string(&room.path).unwrap().as_str(), room.texts()), ("a = 2\n", vec!["a = 1\n".to_owned()]));
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_written_stays_and_its_change_is_not_in_the_history() {
    use std::os::unix::fs::PermissionsExt;
    let room = Room::new();
    room.put("a = 1\n");
    fs::set_permissions(&room.path, fs::Permissions::from_mode(0o444)).unwrap();
    let error = room.store.change::<(), StoreError>("test", |_| Ok(("a = 2\n".into(), ()))).unwrap_err();
    assert!(error.to_string().contains("read-only"), "{error}");
    assert_eq!((fs::read_to_string(&room.path).unwrap().as_str(), room.texts()), ("a = 1\n", vec!["a = 1\n".to_owned()]));
    // Nor does it come into it when somebody changes the file by hand.
    fs::set_permissions(&room.path, fs::Permissions::from_mode(0o640)).unwrap();
    fs::write(&room.path, "a = 3\n").unwrap();
    room.put("a = 4\n");
    assert_eq!(room.texts(), ["a = 1\n", "a = 3\n", "a = 4\n"]);
    assert_eq!(fs::metadata(&room.path).unwrap().permissions().mode() & 0o777, 0o640);
}

#[test]
fn what_an_editor_changed_is_noted_by_the_next_change() {
    let room = Room::new();
    room.put("a = 1\n");
    room.put("a = 2\n");
    // Even back to the version before: it was not this store that did it.
    fs::write(&room.path, "a = 1\n").unwrap();
    room.put("a = 3\n");
    let history = room.history();
    assert_eq!(history[2], (OUTSIDE.to_owned(), "a = 1\n".to_owned()));
    assert_eq!(history[3], ("test".to_owned(), "a = 3\n".to_owned()));
    // And a change back to what it was before the editor.
    fs::write(&room.path, "a = 4\n").unwrap();
    room.put("a = 3\n");
    assert_eq!(room.texts()[3..], ["a = 3\n", "a = 4\n", "a = 3\n"]);
    let entries = room.store.history().unwrap();
    for (before, after) in entries.iter().zip(&entries[1..]) {
        assert_eq!(after.before.as_ref(), Some(&before.version), "each follows on the one before");
    }
}

#[test]
fn a_file_that_was_there_first_and_one_that_was_removed() {
    let room = Room::new();
    fs::write(&room.path, "a = 0\n").unwrap();
    room.put("a = 1\n");
    fs::remove_file(&room.path).unwrap();
    room.put("a = 2\n");
    let entries: Vec<_> = room.store.history().unwrap().into_iter().map(|entry| (entry.text, entry.before.is_some())).collect();
    assert_eq!(entries, [("a = 0\n".into(), false), ("a = 1\n".into(), true), ("a = 2\n".into(), false)]);
}

#[test]
fn a_change_whose_program_died_before_the_file_was_replaced_was_not_made() {
    for edited in [None, Some("a = 9\n")] {
        let room = Room::new();
        room.put("a = 1\n");
        if let Some(edited) = edited {
            fs::write(&room.path, edited).unwrap();
        }
        let before = fs::read_to_string(&room.path).unwrap();
        room.put("a = 2\n");
        fs::write(&room.path, &before).unwrap();
        room.forget_the_last_line();
        assert_eq!(room.texts(), ["a = 1\n"]);
        let seen = room.store.change::<_, StoreError>("test", |now| Ok(("a = 3\n".into(), now.text.clone()))).unwrap();
        assert!(matches!(seen, Outcome::Changed(_, text) if text == before), "the file counts");
        let expected: Vec<&str> = ["a = 1\n"].into_iter().chain(edited).chain(["a = 3\n"]).collect();
        assert_eq!(room.texts(), expected);
    }
}

#[test]
fn a_change_whose_program_died_after_the_file_was_replaced_was_made() {
    let room = Room::new();
    room.put("a = 1\n");
    room.put("a = 2\n");
    room.forget_the_last_line();
    assert_eq!(room.texts(), ["a = 1\n", "a = 2\n"]);
    room.put("a = 3\n");
    assert_eq!(room.texts(), ["a = 1\n", "a = 2\n", "a = 3\n"]);
}

#[test]
fn what_a_person_put_there_after_a_program_died_stays() {
    let room = Room::new();
    room.put("a = 1\n");
    room.put("a = 2\n");
    room.forget_the_last_line();
    for by_hand in ["a = 1\n", "a = 7\n"] {
        fs::write(&room.path, by_hand).unwrap();
        let seen = room.store.change::<_, StoreError>("test", |now| Ok((now.text.clone(), now.text.clone()))).unwrap();
        assert!(matches!(seen, Outcome::Same(_, text) if text == by_hand));
        assert_eq!(fs::read_to_string(&room.path).unwrap(), by_hand);
    }
}

#[test]
fn a_line_of_the_history_that_was_cut_short_had_changed_nothing() {
    let room = Room::new();
    room.put("a = 1\n");
    let whole = fs::read_to_string(room.log()).unwrap();
    let torn = whole.clone() + &whole[..30];
    fs::write(room.log(), &torn).unwrap();
    assert_eq!(room.texts(), ["a = 1\n"]);
    // It is cut off when the next line is written, and not before.
    let refused: Result<Outcome<()>, StoreError> = room.store.change("test", |_| Err(StoreError::Name { path: "x".into() }));
    assert!(refused.is_err());
    assert_eq!(fs::read_to_string(room.log()).unwrap(), torn);
    room.put("a = 3\n");
    assert_eq!(room.texts(), ["a = 1\n", "a = 3\n"]);
}

#[test]
fn a_damaged_history_is_reported_and_left_alone() {
    let room = Room::new();
    room.put("a = 1\n");
    let whole = fs::read_to_string(room.log()).unwrap();
    let cases =
        ["nonsense\n".to_owned(), whole.replace("a = 1", "a = 7"), format!("{whole}{{\"end\":\"made\",\"version\":\"0\"}}\n")];
    for text in cases {
        fs::write(room.log(), &text).unwrap();
        let error = room.store.change::<(), StoreError>("test", |_| Ok(("a = 2\n".into(), ()))).unwrap_err();
        assert!(error.to_string().contains("is damaged, its end"), "{error}");
        assert_eq!((fs::read_to_string(&room.path).unwrap(), fs::read_to_string(room.log()).unwrap()), ("a = 1\n".into(), text));
        assert!(room.store.history().unwrap_err().to_string().contains("is damaged, line "));
    }
}

#[test]
fn long_lines_of_the_history_are_read_whole_from_its_end() {
    let room = Room::new();
    let texts: Vec<String> = (1..6).map(|index| format!("# {}\n", "x".repeat(index * 5000))).collect();
    for text in &texts {
        room.put(text);
    }
    assert_eq!(room.texts(), texts);
}

#[test]
fn a_file_that_is_no_text_or_huge_is_refused() {
    let room = Room::new();
    fs::write(&room.path, [0xff, 0xfe]).unwrap();
    assert!(matches!(room.store.read(), Err(StoreError::Storage(StorageError::NotText { .. }))));
    fs::write(&room.path, vec![b' '; (1 << 20) + 1]).unwrap();
    assert!(matches!(room.store.read(), Err(StoreError::Storage(StorageError::TooLarge { .. }))));
    assert!(matches!(Store::open(Path::new("/")), Err(StoreError::Storage(_) | StoreError::Name { .. })));
}

#[cfg(unix)]
#[test]
fn a_link_to_the_file_is_followed() {
    let room = Room::new();
    room.put("a = 1\n");
    let link = room.folder.path().join("link.toml");
    std::os::unix::fs::symlink(&room.path, &link).unwrap();
    put(&Store::open(&link).unwrap(), "a = 2\n");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&room.path).unwrap(), "a = 2\n");
}

/// What a folder from somebody else may hold beside a file: nothing of it leads outside.
#[cfg(unix)]
#[test]
fn links_beside_the_file_are_refused_and_lead_nowhere() {
    use std::os::unix::fs::symlink;
    let elsewhere = tempfile::tempdir().unwrap();
    let victim = elsewhere.path().join("victim");
    let private = |name: &str| Path::new(".msk").join(name);
    let cases = [
        (private("weights.toml.lock"), victim.clone(), true),
        (private("weights.toml.history.jsonl"), victim.clone(), true),
        (private("weights.toml.history.jsonl"), elsewhere.path().join("new"), true),
        (private("weights.toml.lock"), elsewhere.path().join("new"), true),
        (PathBuf::from(".msk"), elsewhere.path().to_path_buf(), true),
        (PathBuf::from(".msk"), elsewhere.path().join("new"), true),
        // Names that earlier versions used.
        (private("weights.toml.new"), victim.clone(), false),
        (private("weights.jsonl"), victim.clone(), false),
    ];
    for (link, target, refused) in cases {
        let room = Room::new();
        fs::write(&victim, "precious\n").unwrap();
        fs::write(&room.path, "a = 1\n").unwrap();
        let link = room.folder.path().join(link);
        fs::create_dir_all(link.parent().unwrap()).unwrap();
        symlink(&target, &link).unwrap();
        let result = room.store.change::<(), StoreError>("test", |_| Ok(("a = 2\n".into(), ())));
        if refused {
            let error = result.unwrap_err();
            assert!(matches!(&error, StoreError::Storage(StorageError::Link { .. })), "{error}");
            assert!(error.to_string().contains(link.to_str().unwrap()), "{error}");
            assert_eq!(fs::read_to_string(&room.path).unwrap(), "a = 1\n");
        } else {
            result.unwrap();
            assert_eq!(fs::read_to_string(&room.path).unwrap(), "a = 2\n");
        }
        assert_eq!(fs::read_to_string(&victim).unwrap(), "precious\n", "{}", link.display());
        let names: Vec<_> = fs::read_dir(elsewhere.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["victim"], "{}", link.display());
    }
}

fn change(text: &Version, term: &str) -> (String, Vec<Change>) {
    let from = f64::from(u32::try_from(text.text.lines().count()).unwrap());
    let change = Change { task: "stand".into(), term: term.into(), from, to: from + 1.0, was: format!("{from}") };
    (format!("{}{term}\n", text.text), vec![change])
}

/// The finding: one history for all files of a folder, under a lock for each, lost 139 of 1,762 acknowledged changes.
#[test]
fn many_writers_of_two_files_in_one_folder_lose_nothing() {
    const WRITERS: usize = 8;
    const EACH: usize = 12;
    let folder = tempfile::tempdir().unwrap();
    let files = ["a.msk", "b.msk"].map(|name| folder.path().join(name));
    std::thread::scope(|scope| {
        for writer in 0..WRITERS {
            let files = &files;
            scope.spawn(move || {
                for step in 0..EACH {
                    let store = Store::open(&files[(writer + step) % 2]).unwrap();
                    store.edit::<StoreError>("test", |now| Ok(change(now, &format!("w{writer}s{step}")))).unwrap();
                }
            });
        }
    });
    for path in &files {
        let store = Store::open(path).unwrap();
        let lines = fs::read_to_string(path).unwrap();
        let history = store.history().unwrap();
        assert_eq!((lines.lines().count(), history.len()), (WRITERS * EACH / 2, WRITERS * EACH / 2));
        assert_eq!(history.last().unwrap().text, lines);
        let first = store.first_changes().unwrap();
        assert_eq!(first.iter().map(|change| change.term.as_str()).collect::<Vec<_>>(), lines.lines().collect::<Vec<_>>());
    }
}

#[test]
fn going_back_restores_what_the_first_change_of_a_weight_found() {
    let room = Room::new();
    for term in ["pose", "alive", "pose"] {
        room.store.edit::<StoreError>("test", |now| Ok(change(now, term))).unwrap();
    }
    room.put("a = 1\n");
    let first = room.store.first_changes().unwrap();
    let changes: Vec<_> = first.iter().map(|change| (change.term.as_str(), change.was.as_str())).collect();
    assert_eq!(changes, [("pose", "0"), ("alive", "1")]);
}
