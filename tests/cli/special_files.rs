//! Pipes, devices and the files of `/proc` in place of files: refused at once by everything that reads.

#![cfg(unix)]

use super::project::{Done, LEAN, Project};
use std::time::{Duration, Instant};

/// Runs the program; one that waits for a pipe fails the test instead of hanging it.
fn msk(project: &Project, arguments: &[&str]) -> Done {
    let mut child = project.command(arguments).spawn().unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(120) {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{arguments:?} waits");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Done::from(child.wait_with_output().unwrap())
}

fn refused(project: &Project, arguments: &[&str], found: &str) {
    let done = msk(project, arguments);
    assert_ne!(done.code, Some(0), "{arguments:?}: {done:?}");
    assert!(!done.err.contains("panicked"), "{arguments:?}: {done:?}");
    assert!(format!("{}{}", done.out, done.err).contains(found), "{arguments:?}: no `{found}` in {done:?}");
}

fn pipe(project: &Project, name: &str) {
    assert!(std::process::Command::new("mkfifo").arg(project.path(name)).status().unwrap().success());
}

#[test]
fn a_pipe_is_waited_for_by_no_command() {
    let project = Project::lean();
    for name in ["pipe.msk", "pipe.toml", "pipe.json", "pipe.npy", "pipe.xml", "pipe.snapshot"] {
        pipe(&project, name);
    }
    project.write("uses.msk", &format!("use \"pipe.msk\"\n{LEAN}"));
    for arguments in [
        &["check", "pipe.msk"][..],
        &["check", "uses.msk"],
        &["eval", "pipe.msk", "--policy", "zero", "--out", "out"],
        &["run", "pipe.msk", "--policy", "zero"],
        &["explain", "pipe.msk"],
        &["fmt", "pipe.msk"],
        &["test", "pipe.msk"],
        &["snapshot", "pipe.msk"],
        &["diff", "lean.msk", "pipe.msk"],
        &["diff", "lean.msk", "pipe.snapshot"],
        &["weights", "list", "pipe.msk"],
        &["weights", "set", "pipe.msk", "pose=11"],
        &["run", "lean.msk", "--policy", "zero", "--weights", "pipe.toml"],
        &["tune", "lean.msk", "--reasoner", "pipe.toml"],
        &["draw", "--state", "pipe.json", "--out", "out.svg"],
        &["motion", "check", "pipe.msk"],
        &["physics", "forward", "--state", "pipe.json"],
        &["physics", "forward", "--model", "pipe.xml"],
        &["physics", "import", "--model", "pipe.xml", "--out", "out.xml"],
        &["physics", "rollout", "--ctrl", "pipe.npy", "--out", "out.npz"],
    ] {
        refused(&project, arguments, "a named pipe");
    }
}

#[test]
fn a_pipe_that_nobody_reads_is_not_written_to() {
    let project = Project::lean();
    for name in ["pipe.npz", "pipe.html", "pipe.svg"] {
        pipe(&project, name);
    }
    refused(&project, &["run", "lean", "--policy", "zero", "--trace", "pipe.npz"], "cannot write `pipe.npz`");
    refused(&project, &["run", "lean", "--policy", "zero", "--html", "pipe.html"], "cannot write `pipe.html`");
    refused(&project, &["draw", "--out", "pipe.svg"], "cannot write `pipe.svg`");
}

#[test]
fn no_text_uses_a_device_or_what_the_system_makes_up() {
    let project = Project::empty();
    for (path, found) in
        [("/dev/zero", "a device"), ("/proc/self/environ", "a file whose size differs from its metadata"), ("/proc", "a folder")]
    {
        if !std::path::Path::new(path).exists() {
            continue;
        }
        project.write("task.msk", &format!("use \"{path}\"\n{LEAN}"));
        refused(&project, &["check", "task.msk"], found);
        refused(&project, &["run", "task.msk", "--policy", "zero"], found);
    }
}

#[test]
fn a_socket_is_refused() {
    let project = Project::empty();
    let _listener = std::os::unix::net::UnixListener::bind(project.path("socket.msk")).unwrap();
    refused(&project, &["check", "socket.msk"], "cannot read `socket.msk`");
}
