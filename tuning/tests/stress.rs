//! Sixteen writers and sixteen readers of two files in one folder, as programs that are killed at random.
//!
//! This test binary is also the program of the writers and readers: it starts itself again with a role in its environment.

#![cfg(unix)]

use msk_tuning::store::{OUTSIDE, Outcome, Store, StoreError, Version};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const ROLE: &str = "MSK_STRESS_ROLE";
const FOLDER: &str = "MSK_STRESS_FOLDER";
const FILES: [&str; 2] = ["weights.toml", "other.toml"];

/// A text that shows when a part of it is missing or of another version: every line carries the same number.
fn text(number: u64) -> String {
    let mut text = format!("[stand]\npose = {number}\n");
    for line in 0..400 {
        text += &format!("# line {line} of version {number}\n");
    }
    text + &format!("# end {number}\n")
}

/// The number of a whole text; anything else is half a file.
fn number(version: &Version) -> u64 {
    let line = version.text.lines().nth(1).unwrap_or_else(|| panic!("torn: {} bytes", version.text.len()));
    let number = line.strip_prefix("pose = ").and_then(|digits| digits.parse().ok());
    let number = number.unwrap_or_else(|| panic!("torn: {line}"));
    assert_eq!(version.text, text(number), "torn");
    number
}

/// The program of a writer or reader: it works until it is killed, and notes every version that it made or saw.
#[test]
fn role() {
    let (Ok(role), Ok(folder)) = (std::env::var(ROLE), std::env::var(FOLDER)) else { return };
    let folder = Path::new(&folder);
    let stores = FILES.map(|file| Store::open(&folder.join(file)).unwrap());
    let note = folder.join(format!("{role}-{}.txt", std::process::id()));
    let mut note = OpenOptions::new().create(true).append(true).open(note).unwrap();
    // An orphan ends by itself.
    let start = Instant::now();
    for turn in 0.. {
        if start.elapsed() > Duration::from_secs(120) {
            break;
        }
        let (file, store) = (FILES[turn % 2], &stores[turn % 2]);
        let version = if role == "write" {
            let outcome = store.change::<(), StoreError>("writer", |now| Ok((text(number(now) + 1), ())));
            match outcome.unwrap() {
                Outcome::Changed(version, ()) | Outcome::Same(version, ()) => version,
            }
        } else {
            store.read().unwrap().unwrap()
        };
        let number = number(&version);
        note.write_all(format!("{file} {} {number}\n", version.hash).as_bytes()).unwrap();
        if role == "read" {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

fn start(role: &str, folder: &Path) -> Child {
    let mut command = Command::new(std::env::current_exe().unwrap());
    // The test programs name a test by the modules that hold it.
    let role_test = module_path!().split_once("::").map_or("role".to_owned(), |(_, module)| format!("{module}::role"));
    command.args(["--exact", &role_test, "--nocapture"]).env(ROLE, role).env(FOLDER, folder);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Ends a program in the middle of whatever it does; it must not have failed before.
fn kill(mut child: Child) {
    assert!(child.try_wait().unwrap().is_none(), "{}", String::from_utf8_lossy(&child.wait_with_output().unwrap().stderr));
    child.kill().unwrap();
    child.wait().unwrap();
}

struct Figures {
    killed: usize,
    versions: usize,
    reads: usize,
}

fn stress(each: usize, length: Duration) -> Figures {
    let folder = tempfile::tempdir().unwrap();
    let stores = FILES.map(|file| Store::open(&folder.path().join(file)).unwrap());
    for store in &stores {
        store.change::<(), StoreError>("begin", |_| Ok((text(0), ()))).unwrap();
    }
    let role = |index: usize| if index < each { "write" } else { "read" };
    let mut children: Vec<Child> = (0..2 * each).map(|index| start(role(index), folder.path())).collect();
    let (begin, mut chance, mut killed) = (Instant::now(), 42_u64, 0);
    while begin.elapsed() < length {
        chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        std::thread::sleep(Duration::from_millis(20 + (chance >> 33) % 60));
        let index = (chance >> 40) as usize % children.len();
        kill(std::mem::replace(&mut children[index], start(role(index), folder.path())));
        killed += 1;
    }
    children.into_iter().for_each(kill);

    let known: BTreeSet<String> = FILES.iter().zip(&stores).flat_map(|(file, store)| versions(file, store)).collect();
    let reads = check_notes(folder.path(), &known);
    Figures { killed, versions: known.len(), reads }
}

/// The versions of a file, as the notes name them. Each was made by a writer and follows on the one before.
fn versions(file: &str, store: &Store) -> Vec<String> {
    // One more change follows on whatever the last writer left.
    store.change::<(), StoreError>("end", |now| Ok((text(number(now) + 1), ()))).unwrap();
    let history = store.history().unwrap();
    for (index, entry) in history.iter().enumerate() {
        assert_ne!(entry.by, OUTSIDE, "every version was made by a writer");
        assert_eq!(entry.text, text(index as u64), "version {index} follows on the one before: no change is lost");
        assert_eq!(entry.version, Version::of(entry.text.clone()).hash);
        assert_eq!(entry.before, (index > 0).then(|| history[index - 1].version.clone()));
    }
    assert_eq!(store.read().unwrap().unwrap().hash, history.last().unwrap().version);
    history.iter().enumerate().map(|(index, entry)| format!("{file} {} {index}", entry.version)).collect()
}

/// Every version that a writer made or a reader saw is known, and no reader went back. Gives how many were seen.
fn check_notes(folder: &Path, known: &BTreeSet<String>) -> usize {
    let (mut written, mut reads) = (BTreeSet::new(), 0);
    for note in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = note.file_name().unwrap().to_string_lossy().into_owned();
        if !name.ends_with(".txt") {
            continue;
        }
        let (notes, mut newest) = (fs::read_to_string(&note).unwrap(), BTreeMap::new());
        for line in notes.split_inclusive('\n').filter(|line| line.ends_with('\n')).map(str::trim_end) {
            assert!(known.contains(line), "{name} knows the version {line}, the history does not");
            let [file, _, number] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
            let number: u64 = number.parse().unwrap();
            let before = newest.insert(file, number).unwrap_or(0);
            assert!(before <= number, "{name} went back from {before} to {number}");
            if name.starts_with("write") {
                assert!(written.insert(line.to_owned()), "two writers made {line}");
            } else {
                reads += 1;
            }
        }
    }
    assert!(!written.is_empty() && reads > 0, "nobody came to work");
    reads
}

#[test]
fn no_read_is_torn_and_no_version_is_lost() {
    stress(16, Duration::from_secs(4));
}

/// `cargo test -p msk-tuning --test suite stress -- --ignored --nocapture`
#[test]
#[ignore = "a minute"]
fn no_read_is_torn_and_no_version_is_lost_in_a_minute() {
    let Figures { killed, versions, reads } = stress(16, Duration::from_secs(60));
    println!("16 writers, 16 readers, two files, 60 s: {killed} killed, {versions} versions, {reads} reads");
}
