//! Every system call that changes something fails once, or is the last one of its program: what is found afterwards is the state
//! before or the state after, and a session goes on to the bytes of one that nothing disturbed.

use crate::support;

use msk_evaluate::{EpisodeRecord, Trial};
use msk_runtime::policy::PolicySource;
use msk_storage::{FailAt, Failure, Folder};
use msk_tuning::reasoner::RuleBook;
use msk_tuning::session::{Ended, KeptRules, Objective, OnFailure, Round, Session, SessionError, Settings, Watcher};
use msk_tuning::store::{OUTSIDE, Outcome, Store, StoreError};
use std::collections::BTreeMap;
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use support::trial;

const NAME: &str = "weights.toml";
const FAILURES: [Failure; 3] = [Failure::StorageFull, Failure::Device, Failure::Crash];

fn store(folder: &Folder) -> Store {
    Store::new(folder, Path::new(NAME)).unwrap()
}

fn put(store: &Store, text: &str) -> Result<(), StoreError> {
    store.change::<(), StoreError>("test", |_| Ok((text.into(), ()))).map(|outcome| {
        assert!(matches!(outcome, Outcome::Changed(..)));
    })
}

fn texts(store: &Store) -> Vec<String> {
    store.history().unwrap().into_iter().map(|entry| entry.text).collect()
}

/// Every name in a folder and in `.msk` in it.
fn names(folder: &Path) -> Vec<String> {
    let list = |folder: &Path| fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = list(folder).chain(list(&folder.join(".msk"))).map(|name| name.into_string().unwrap()).collect();
    names.sort();
    names
}

/// Changes a file with each call failing in turn, from a beginning that `prepare` makes.
fn every_call(prepare: fn(&Store, &Path)) {
    for failure in FAILURES {
        for at in 0.. {
            let here = tempfile::tempdir().unwrap();
            let sound = Folder::open(here.path()).unwrap();
            prepare(&store(&sound), &here.path().join(NAME));
            let before = (store(&sound).read().unwrap().map(|version| version.text), texts(&store(&sound)));
            let faults = Arc::new(FailAt::new(at, failure));
            let result = put(&store(&sound.clone().with_faults(faults.clone())), "a = 8\n");
            let case = format!("{failure:?} at call {at}: {result:?}");
            if !faults.has_failed() {
                assert!(result.is_ok() && at > 5, "{case}");
                break;
            }
            // The next program finds the file and its history.
            let next = store(&sound);
            let present = next.read().unwrap().map(|version| version.text);
            let made = present.as_deref() == Some("a = 8\n");
            if !made {
                assert_eq!((present, texts(&next)), before, "{case}");
            }
            match result {
                Ok(()) => assert!(made, "{case}"),
                Err(error) => {
                    assert!(!made || failure == Failure::Crash, "{case}: what failed has not happened");
                    assert!(error.to_string().contains(here.path().to_str().unwrap()), "{case} names no place");
                }
            }
            put(&next, "a = 9\n").unwrap();
            let mut expected = before.1.clone();
            // What an editor had left there is noted by the first change that is made.
            expected.extend(before.0.clone().filter(|text| before.1.last() != Some(text)));
            expected.extend(made.then(|| "a = 8\n".to_owned()));
            expected.push("a = 9\n".to_owned());
            assert_eq!(texts(&next), expected, "{case}");
            let found = names(here.path());
            assert_eq!(found, [".msk", NAME, "weights.toml.history.jsonl", "weights.toml.lock"], "{case}: litter");
        }
    }
}

#[test]
fn the_first_change_happens_or_does_not() {
    every_call(|_, _| {});
}

#[test]
fn a_further_change_happens_or_does_not() {
    every_call(|store, _| put(store, "a = 1\n").unwrap());
}

#[test]
fn a_change_after_an_editors_happens_or_does_not() {
    every_call(|store, path| {
        put(store, "a = 1\n").unwrap();
        put(store, "a = 2\n").unwrap();
        fs::write(path, "a = 1\n").unwrap();
    });
}

#[test]
fn a_change_after_a_program_that_died_happens_or_does_not() {
    every_call(|store, path| {
        put(store, "a = 1\n").unwrap();
        put(store, "a = 2\n").unwrap();
        let log = path.with_file_name(".msk").join("weights.toml.history.jsonl");
        let lines = fs::read_to_string(&log).unwrap();
        let kept = lines.trim_end().rfind('\n').unwrap() + 1;
        // Half of the line that records that it was made.
        fs::write(&log, &lines[..kept + 7]).unwrap();
    });
}

/// A second program dies while it settles what the first one left.
#[test]
fn two_programs_that_die_in_turn_lose_nothing() {
    let mut first = 0;
    while two_die(first) {
        first += 1;
    }
    assert!(first > 10, "{first} calls");
}

/// The first program dies at its call `first`, the second at each of its own. Whether the first one came so far.
fn two_die(first: usize) -> bool {
    for second in 0.. {
        let here = tempfile::tempdir().unwrap();
        let sound = Folder::open(here.path()).unwrap();
        put(&store(&sound), "a = 1\n").unwrap();
        let mut known = vec!["a = 1\n".to_owned()];
        let died = [(first, "a = 2\n"), (second, "a = 3\n")].map(|(at, text)| {
            let faults = Arc::new(FailAt::new(at, Failure::Crash));
            let result = put(&store(&sound.clone().with_faults(faults.clone())), text);
            let made = store(&sound).read().unwrap().unwrap().text == text;
            assert!(made || result.is_err(), "calls {first} and {second}");
            known.extend(made.then(|| text.to_owned()));
            assert_eq!(texts(&store(&sound)), known, "calls {first} and {second}");
            faults.has_failed()
        });
        assert!(store(&sound).history().unwrap().iter().all(|entry| entry.by != OUTSIDE));
        if !died[1] {
            return died[0];
        }
    }
    true
}

struct NoWatcher;

impl Watcher for NoWatcher {
    fn stepped(&self) {}
    fn ended(&self, _: &EpisodeRecord) {}
    fn round(&self, _: &Round) {}
    fn asking(&self, _: &str) {}
}

fn run(folder: &Folder, trial: &Trial) -> Result<Ended, SessionError> {
    let settings = Settings {
        policy: PolicySource::built_in("zero").unwrap(),
        seed: 3,
        interval: 5,
        rules: KeptRules { step: 0.2, norm: None },
        outside: vec![],
        objective: Objective::Survival,
        rounds: 2,
        steps: None,
        on_failure: OnFailure::Keep,
    };
    let mut session = Session::open_in(folder.clone(), settings, trial.clone(), |message| panic!("{message}"))?;
    session.run(&RuleBook, NonZeroUsize::MIN, &AtomicBool::new(false), &NoWatcher)
}

/// All files of a session without times, and the texts that its weights files had.
fn results(folder: &Path) -> BTreeMap<String, String> {
    let mut results = BTreeMap::new();
    for name in ["tune.json", "weights.toml", "best.toml", "rounds.jsonl", "episodes.jsonl"] {
        let timeless = |line: &str| {
            let mut value: serde_json::Value = serde_json::from_str(line).unwrap();
            value["time"] = 0.into();
            value["wall_time"] = 0.into();
            value.to_string()
        };
        let text = fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let text = if name.ends_with(".jsonl") { text.lines().map(timeless).collect::<Vec<_>>().join("\n") } else { text };
        results.insert(name.into(), text);
    }
    let history = Store::open(&folder.join("weights.toml")).unwrap().history().unwrap();
    results.insert("history".into(), history.into_iter().map(|entry| entry.text).collect());
    results
}

#[test]
fn a_session_that_any_call_ended_goes_on_to_the_bytes_of_an_undisturbed_one() {
    let here = tempfile::tempdir().unwrap();
    let trial = trial(here.path());
    let folder = |name: String| Folder::create(&here.path().join(name)).unwrap();
    let whole = folder("whole".into());
    let calls = Arc::new(FailAt::never());
    assert_eq!(run(&whole.clone().with_faults(calls.clone()), &trial).unwrap(), Ended::Budget);
    let whole = results(whole.path());
    assert!(calls.calls() > 30, "{} calls", calls.calls());
    for failure in FAILURES {
        for at in 0..calls.calls() {
            let case = format!("{failure:?} at call {at}");
            let disturbed = folder(format!("{failure:?}-{at}"));
            let faults = Arc::new(FailAt::new(at, failure));
            match run(&disturbed.clone().with_faults(faults.clone()), &trial) {
                // Only a second line of a history may be missing; the next change writes it.
                Ok(ended) => assert_eq!(ended, Ended::Budget, "{case}"),
                Err(error) => assert!(error.to_string().contains(disturbed.path().to_str().unwrap()), "{case}: {error}"),
            }
            assert!(faults.has_failed(), "{case}");
            assert_eq!(run(&disturbed, &trial).unwrap_or_else(|error| panic!("{case}: {error}")), Ended::Budget, "{case}");
            assert_eq!(results(disturbed.path()), whole, "{case}");
        }
    }
}
