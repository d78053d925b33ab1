//! What remains when any one system call fails, or when the program dies before any of them.

use msk_storage::{FailAt, Failure, Folder};
use std::fs;
use std::path::Path;
use std::sync::Arc;

const FAILURES: [Failure; 3] = [Failure::StorageFull, Failure::Device, Failure::Crash];
const LIMIT: u64 = 1000;

/// Lets each call fail in each way, in a folder made anew by `prepare`. `attempt` is what the calls belong to; `check` looks
/// at what remains, knowing whether the attempt came back as a success.
fn for_every_call(prepare: impl Fn(&Folder), attempt: impl Fn(&Folder) -> bool, check: impl Fn(&Folder, bool, Failure)) {
    let calls = {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        prepare(&folder);
        let faults = Arc::new(FailAt::never());
        assert!(attempt(&folder.with_faults(faults.clone())));
        faults.calls()
    };
    assert!(calls > 2, "only {calls} calls are made: faults cannot show much");
    for failure in FAILURES {
        for call in 0..calls {
            let place = tempfile::tempdir().unwrap();
            let folder = Folder::open(place.path()).unwrap();
            prepare(&folder);
            let faults = Arc::new(FailAt::new(call, failure));
            let succeeded = attempt(&folder.clone().with_faults(faults.clone()));
            assert!(faults.has_failed(), "call {call} was not made");
            check(&folder, succeeded, failure);
        }
    }
}

#[test]
fn a_replaced_file_is_the_former_or_the_new_one() {
    let name = Path::new("a");
    for_every_call(
        |folder| folder.replace(name, b"former").unwrap(),
        |folder| folder.replace(name, b"new and longer").is_ok(),
        |folder, succeeded, _| {
            let text = folder.read_text(name, LIMIT).unwrap().unwrap();
            assert!(text == "former" || text == "new and longer", "{text}");
            assert!(!succeeded, "a fault was hidden");
            assert_eq!(folder.entries(Path::new("")).unwrap().len(), 1, "litter");
        },
    );
}

#[test]
fn a_created_file_is_whole_or_not_there_unless_the_program_died() {
    let name = Path::new("a");
    for_every_call(
        |_| {},
        |folder| folder.create_file(name, b"text").is_ok(),
        |folder, succeeded, failure| {
            assert!(!succeeded, "a fault was hidden");
            if failure != Failure::Crash {
                assert_eq!(folder.read(name, LIMIT).unwrap(), None);
            }
        },
    );
}

#[test]
fn a_log_has_the_line_or_is_what_it_was() {
    for_every_call(
        |folder| folder.log("log").unwrap().append(b"first").unwrap(),
        |folder| folder.log("log").is_ok_and(|mut log| log.append(b"second").is_ok()),
        |folder, succeeded, failure| {
            assert!(!succeeded, "a fault was hidden");
            let mut log = folder.log("log").unwrap();
            let lines = log.read(LIMIT).unwrap();
            if failure == Failure::Crash {
                assert!(lines == b"first\n" || lines == b"first\nsecond\n");
            } else {
                assert_eq!(lines, b"first\n", "a line that was not promised is there");
            }
            log.append(b"third").unwrap();
            assert!(log.read(LIMIT).unwrap().ends_with(b"\nthird\n"));
        },
    );
}

#[test]
fn a_log_goes_on_after_a_full_disk() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::open(place.path()).unwrap();
    let calls = Arc::new(FailAt::never());
    folder.clone().with_faults(calls.clone()).log("other").unwrap().append(b"x").unwrap();
    for call in 1..calls.calls() {
        let mut log = folder.clone().with_faults(Arc::new(FailAt::new(call, Failure::StorageFull))).log("log").unwrap();
        log.append(b"lost").unwrap_err();
        log.append(b"kept").unwrap();
        assert_eq!(log.read(LIMIT).unwrap(), b"kept\n");
        fs::remove_file(place.path().join("log")).unwrap();
    }
}

#[test]
fn a_log_whose_end_cannot_be_repaired_takes_no_further_line() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::open(place.path()).unwrap();
    folder.log("log").unwrap().append(b"first").unwrap();
    // Opening is call 0, writing call 1; a crash fails the repair, too.
    let mut log = folder.clone().with_faults(Arc::new(FailAt::new(1, Failure::Crash))).log("log").unwrap();
    log.append(b"second").unwrap_err();
    assert!(log.append(b"third").unwrap_err().to_string().contains("is closed: an append failed"));
    assert_eq!(fs::read_to_string(place.path().join("log")).unwrap(), "first\nsec");
    let mut log = folder.log("log").unwrap();
    log.append(b"fourth").unwrap();
    assert_eq!(log.read(LIMIT).unwrap(), b"first\nfourth\n");
}
