//! What files and folders promise, seen from outside; what they promise when calls fail is in `faults.rs`.

use msk_storage::{Entry, Folder, Kind, Log, StorageError, read_file, read_text_file, write_file};
use std::fs;
use std::path::Path;

const LIMIT: u64 = 1000;

fn folder() -> (tempfile::TempDir, Folder) {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::open(place.path()).unwrap();
    (place, folder)
}

fn path(text: &str) -> &Path {
    Path::new(text)
}

#[test]
fn a_file_is_read_within_its_limit() {
    let (place, folder) = folder();
    fs::write(place.path().join("a"), [b'x'; 1000]).unwrap();
    assert_eq!(folder.read(path("a"), LIMIT).unwrap().unwrap().len(), 1000);
    assert!(matches!(folder.read(path("a"), LIMIT - 1), Err(StorageError::TooLarge { limit: 999, .. })));
    assert_eq!(folder.read(path("b"), LIMIT).unwrap(), None);
    assert_eq!(read_file(&place.path().join("a"), LIMIT).unwrap().len(), 1000);
    fs::write(place.path().join("a"), [0xff]).unwrap();
    assert!(matches!(read_text_file(&place.path().join("a"), LIMIT), Err(StorageError::NotText { .. })));
    assert!(matches!(folder.read_text(path("a"), LIMIT), Err(StorageError::NotText { .. })));
}

#[test]
fn a_folder_is_created_once() {
    let (place, _) = folder();
    let new = place.path().join("run");
    Folder::create_new(&new).unwrap().replace(path("a"), b"one").unwrap();
    // The folder of another process is not taken for one's own, nor what a link leads to.
    assert!(Folder::create_new(&new).is_err());
    assert_eq!(fs::read(new.join("a")).unwrap(), b"one");
    #[cfg(unix)]
    {
        let link = place.path().join("link");
        std::os::unix::fs::symlink(place.path().join("nowhere"), &link).unwrap();
        assert!(Folder::create_new(&link).is_err());
        assert!(!place.path().join("nowhere").exists());
    }
}

#[test]
fn a_file_is_replaced_and_nothing_is_left_beside_it() {
    let (place, folder) = folder();
    folder.replace(path("a"), b"one").unwrap();
    folder.replace(path("a"), b"two").unwrap();
    assert_eq!(fs::read(place.path().join("a")).unwrap(), b"two");
    assert_eq!(folder.entries(path("")).unwrap(), [Entry { name: "a".into(), kind: Kind::File }]);
}

#[test]
fn a_file_is_created_only_where_there_is_none() {
    let (place, folder) = folder();
    folder.create_file(path("a"), b"one").unwrap();
    let error = folder.create_file(path("a"), b"two").unwrap_err();
    assert_eq!(error.kind(), Some(std::io::ErrorKind::AlreadyExists), "{error}");
    assert_eq!(fs::read(place.path().join("a")).unwrap(), b"one");
}

#[test]
fn paths_stay_in_the_folder_whether_or_not_something_lies_outside() {
    let (place, outer) = folder();
    fs::create_dir(place.path().join("inner")).unwrap();
    fs::write(place.path().join("secret"), "s").unwrap();
    let inner = outer.subfolder(path("inner")).unwrap();
    let absolute = place.path().join("secret");
    for outside in [path("../secret"), path("../absent"), path("../absent/deeper"), &absolute, path("/absent")] {
        let read = inner.read(outside, LIMIT);
        assert!(matches!(read, Err(StorageError::Outside { .. })), "{outside:?}: {read:?}");
        let written = inner.replace(outside, b"x");
        assert!(matches!(written, Err(StorageError::Outside { .. })), "{outside:?}: {written:?}");
        assert!(matches!(inner.entries(outside), Err(StorageError::Outside { .. })), "{outside:?}");
        assert!(matches!(inner.subfolder(outside), Err(StorageError::Outside { .. })), "{outside:?}");
    }
    assert_eq!(fs::read(&absolute).unwrap(), b"s");
}

#[test]
fn a_log_takes_whole_lines() {
    let (place, folder) = folder();
    let mut log = folder.log("log").unwrap();
    log.append(b"one").unwrap();
    log.append(b"two").unwrap();
    assert!(log.append(b"not\none").is_err());
    assert_eq!(log.read(LIMIT).unwrap(), b"one\ntwo\n");
    assert_eq!(fs::read(place.path().join("log")).unwrap(), b"one\ntwo\n");
}

#[test]
fn a_torn_line_gives_way_to_the_next_one() {
    let (place, folder) = folder();
    let file = place.path().join("log");
    for torn in ["a line that was cut short".repeat(400), "x".into(), String::new()] {
        for whole in ["", "one\n", "one\ntwo\n"] {
            fs::write(&file, format!("{whole}{torn}")).unwrap();
            let mut log = folder.log("log").unwrap();
            assert_eq!(log.read(20_000).unwrap(), whole.as_bytes());
            assert_eq!(fs::read_to_string(&file).unwrap(), format!("{whole}{torn}"), "reading changed the file");
            log.append(b"next").unwrap();
            assert_eq!(fs::read_to_string(&file).unwrap(), format!("{whole}next\n"));
        }
    }
    assert_eq!(Log::whole_lines(b"a\nb"), b"a\n");
}

#[test]
fn two_logs_of_one_file_do_not_overwrite_each_other() {
    let (_place, folder) = folder();
    let (mut first, mut second) = (folder.log("log").unwrap(), folder.log("log").unwrap());
    first.append(b"1").unwrap();
    second.append(b"2").unwrap();
    first.append(b"3").unwrap();
    assert_eq!(second.read(LIMIT).unwrap(), b"1\n2\n3\n");
}

#[test]
fn one_holds_the_lock_until_it_is_dropped() {
    let (_place, folder) = folder();
    let held = folder.lock(path("lock")).unwrap();
    assert!(folder.try_lock(path("lock")).unwrap().is_none());
    drop(held);
    assert!(folder.try_lock(path("lock")).unwrap().is_some());
}

#[test]
fn the_folder_of_a_file_that_the_user_names() {
    let (place, _) = folder();
    let named = place.path().join("t.msk");
    let (folder, name) = Folder::of_file(&named).unwrap();
    folder.replace(&name, b"text").unwrap();
    assert_eq!(fs::read(&named).unwrap(), b"text");
    assert!(matches!(Folder::of_file(path("/")), Err(StorageError::NoName { .. })));
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};

    #[test]
    fn a_file_that_the_user_names_is_replaced_also_behind_a_link_and_a_pipe_is_not_waited_for() {
        let (place, _) = folder();
        let [named, link, pipe] = ["named", "link", "pipe"].map(|name| place.path().join(name));
        symlink(&named, &link).unwrap();
        write_file(&named, b"one").unwrap();
        write_file(&link, b"two").unwrap();
        assert_eq!(fs::read(&named).unwrap(), b"two");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        write_file(path("/dev/null"), b"gone").unwrap();
        assert!(write_file(place.path(), b"a folder").is_err());

        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let error = write_file(&pipe, b"nobody reads").unwrap_err();
        assert!(error.to_string().contains("cannot write") && error.to_string().contains("pipe"), "{error}");
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        // More than a pipe holds: the writer waits for its reader, and all of it arrives.
        let bytes = vec![7; 1 << 20];
        while write_file(&pipe, &bytes).is_err() {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        assert_eq!(reader.join().unwrap(), bytes);
    }
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn links_inside_are_read_and_links_out_are_not() {
        let (place, outer) = folder();
        let inner = place.path().join("inner");
        fs::create_dir(&inner).unwrap();
        fs::write(place.path().join("secret"), "s").unwrap();
        fs::write(inner.join("file"), "f").unwrap();
        symlink("file", inner.join("near")).unwrap();
        symlink("../secret", inner.join("out")).unwrap();
        symlink(place.path().join("secret"), inner.join("absolute")).unwrap();
        symlink("../absent", inner.join("dangling")).unwrap();
        let inner = outer.subfolder(path("inner")).unwrap();
        assert_eq!(inner.read(path("near"), LIMIT).unwrap().unwrap(), b"f");
        assert!(matches!(inner.read_private(path("near"), LIMIT), Err(StorageError::Link { .. })));
        for name in ["out", "absolute", "dangling"] {
            assert!(matches!(inner.read(path(name), LIMIT), Err(StorageError::Outside { .. })), "{name}");
            assert!(matches!(inner.replace(path(name), b"x"), Err(StorageError::Link { .. })), "{name}");
            assert!(matches!(inner.log(name), Err(StorageError::Link { .. })), "{name}");
            assert!(matches!(inner.lock(path(name)), Err(StorageError::Link { .. })), "{name}");
            assert!(matches!(inner.private_subfolder(name), Err(StorageError::Link { .. })), "{name}");
        }
        assert_eq!(fs::read(place.path().join("secret")).unwrap(), b"s");
        assert!(!place.path().join("absent").exists());
    }

    #[test]
    fn a_private_folder_is_not_a_link_even_to_a_folder_inside() {
        let (place, folder) = folder();
        fs::create_dir(place.path().join("other")).unwrap();
        symlink("other", place.path().join(".msk")).unwrap();
        assert!(matches!(folder.private_subfolder(".msk"), Err(StorageError::Link { .. })));
        fs::remove_file(place.path().join(".msk")).unwrap();
        assert!(folder.existing_private_subfolder(".msk").unwrap().is_none());
        folder.private_subfolder(".msk").unwrap().replace(path("a"), b"").unwrap();
        assert!(folder.existing_private_subfolder(".msk").unwrap().is_some());
    }

    #[test]
    fn pipes_devices_sockets_and_what_only_looks_like_a_file_are_refused_without_waiting() {
        let (place, folder) = folder();
        let pipe = place.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let _socket = std::os::unix::net::UnixListener::bind(place.path().join("socket")).unwrap();
        fs::create_dir(place.path().join("folder")).unwrap();
        for (name, found) in [("pipe", "a named pipe"), ("socket", "a socket"), ("folder", "a folder")] {
            let error = folder.read(path(name), LIMIT).unwrap_err().to_string();
            assert!(error.contains(found), "{error}");
        }
        assert!(read_file(&pipe, LIMIT).unwrap_err().to_string().contains("a named pipe"));
        assert!(read_file(path("/dev/zero"), LIMIT).unwrap_err().to_string().contains("a device"));
        assert!(matches!(folder.log("pipe"), Err(StorageError::NotRegular { .. })));
        assert!(matches!(folder.replace(path("pipe"), b""), Err(StorageError::NotRegular { .. })));
        #[cfg(target_os = "linux")]
        for secret in ["/proc/self/environ", "/proc/self/cmdline", "/proc/version"] {
            assert!(matches!(read_file(path(secret), 1 << 20), Err(StorageError::NotRegular { .. })), "{secret}");
        }
    }

    #[test]
    fn owner_and_mode_are_kept_and_read_only_files_too() {
        let (place, folder) = folder();
        let file = place.path().join("a");
        folder.replace(path("a"), b"one").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        // Only a privileged user can give files away.
        let given_away = std::os::unix::fs::chown(&file, Some(1234), Some(1234)).is_ok();
        folder.replace(path("a"), b"two").unwrap();
        let after = fs::metadata(&file).unwrap();
        assert_eq!(after.mode() & 0o7777, 0o640);
        assert!(!given_away || (after.uid(), after.gid()) == (1234, 1234));
        fs::set_permissions(&file, fs::Permissions::from_mode(0o444)).unwrap();
        assert!(matches!(folder.replace(path("a"), b"three"), Err(StorageError::ReadOnly { .. })));
        assert_eq!(fs::read(&file).unwrap(), b"two");
    }

    #[test]
    fn a_folder_exchanged_for_a_link_while_files_are_written_leads_nowhere() {
        let (place, folder) = folder();
        let outside = tempfile::tempdir().unwrap();
        let (inner, aside) = (place.path().join("inner"), place.path().join("aside"));
        fs::create_dir(&inner).unwrap();
        let done = AtomicBool::new(false);
        let (mut written, mut refused) = (0, 0);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    fs::rename(&inner, &aside).unwrap();
                    symlink(outside.path(), &inner).unwrap();
                    std::thread::yield_now();
                    fs::remove_file(&inner).unwrap();
                    fs::rename(&aside, &inner).unwrap();
                    std::thread::sleep(std::time::Duration::from_micros(50));
                }
            });
            // Until both sides have won the race often enough to show something, within bounds.
            for _ in 0..1_000_000 {
                match folder.replace(path("inner/a"), b"x") {
                    Ok(()) => written += 1,
                    Err(_) => refused += 1,
                }
                if written > 50 && refused > 50 {
                    break;
                }
            }
            done.store(true, Ordering::Relaxed);
        });
        assert!(written > 0 && refused > 0, "written {written}, refused {refused}: the race shows nothing");
        assert_eq!(fs::read_dir(outside.path()).unwrap().count(), 0);
    }
}

#[test]
fn the_last_lines_of_a_log_are_read_from_its_end() {
    let here = tempfile::tempdir().unwrap();
    let folder = Folder::open(here.path()).unwrap();
    let mut log = folder.log("log").unwrap();
    assert!(log.last_lines(2, 10).unwrap().is_empty());
    let lines: Vec<String> = [1, 5000, 0, 4096, 9000, 3].map(|length| "x".repeat(length)).to_vec();
    for line in &lines {
        log.append(line.as_bytes()).unwrap();
    }
    let mut file = std::fs::OpenOptions::new().append(true).open(here.path().join("log")).unwrap();
    std::io::Write::write_all(&mut file, b"torn").unwrap();
    for count in 0..8 {
        let expected: String = lines[lines.len().saturating_sub(count)..].iter().map(|line| format!("{line}\n")).collect();
        assert_eq!(folder.log("log").unwrap().last_lines(count, 1 << 20).unwrap(), expected.as_bytes(), "{count}");
        let limit = (expected.len() as u64).saturating_sub(1);
        let short = folder.log("log").unwrap().last_lines(count, limit);
        assert_eq!(matches!(short, Err(StorageError::TooLarge { .. })), count > 0, "{count}");
    }
}

#[test]
fn lines_are_read_one_after_the_other_up_to_the_last_whole_one() {
    let (place, folder) = folder();
    assert!(folder.lines(path("log"), LIMIT).unwrap().is_none());
    fs::write(place.path().join("log"), "one\n\nthree\nfo").unwrap();
    let lines = |limit| folder.lines(path("log"), limit).unwrap().unwrap();
    let read: Vec<Vec<u8>> = lines(5).map(Result::unwrap).collect();
    assert_eq!(read, [&b"one"[..], b"", b"three"]);
    let mut short = lines(4).skip(2);
    assert!(matches!(short.next(), Some(Err(StorageError::TooLarge { limit: 4, .. }))));
    assert!(short.next().is_none(), "an error is the last");
    fs::create_dir(place.path().join("folder")).unwrap();
    assert!(matches!(folder.lines(path("folder"), LIMIT), Err(StorageError::NotRegular { .. })));
    assert!(matches!(folder.lines(path("../log"), LIMIT), Err(StorageError::Outside { .. })));
}

#[test]
fn several_lines_are_appended_at_once_and_files_are_removed() {
    let (place, folder) = folder();
    let mut log = folder.log("log").unwrap();
    log.append_lines(&[b"one", b"two"]).unwrap();
    log.append_unsynced(b"three").unwrap();
    assert!(log.append_lines(&[b"four", b"fi\nve"]).is_err());
    assert_eq!(fs::read_to_string(place.path().join("log")).unwrap(), "one\ntwo\nthree\n");
    folder.remove(path("log")).unwrap();
    folder.remove(path("log")).unwrap();
    assert_eq!(folder.entries(path("")).unwrap(), []);
    assert!(matches!(folder.remove(path("../log")), Err(StorageError::Outside { .. })));
}
