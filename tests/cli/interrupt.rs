//! Signals: the present episodes are given up, the ended ones are kept.
#![cfg(unix)]

use super::project::{Done, LEAN, Project, journal};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const ARGUMENTS: [&str; 10] = ["eval", "lean.msk", "--policy", "zero", "--episodes", "2000", "--threads", "2", "--out", "out"];

/// Waits until some episodes have ended, and sends a signal.
fn send(project: &Project, child: &Child, signal: &str) {
    let start = Instant::now();
    while std::fs::read_to_string(project.path("out/episodes.jsonl")).map_or(0, |text| text.lines().count()) < 3 {
        assert!(start.elapsed() < Duration::from_secs(60), "no episode has ended");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// The program as it is started where nothing is ignored, also when the tests themselves run under `nohup`.
fn listening(project: &Project) -> Command {
    let program = project.command(&ARGUMENTS);
    if !cfg!(target_os = "linux") {
        return program;
    }
    let mut command = Command::new("env");
    command.arg("--default-signal=HUP").arg(program.get_program()).args(program.get_args());
    command.current_dir(project.path("")).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

#[test]
fn an_interrupted_run_leaves_a_valid_journal_that_can_be_continued() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let project = Project::empty();
        project.write("lean.msk", LEAN);
        let child = listening(&project).spawn().unwrap();
        send(&project, &child, signal);
        let done = Done::from(child.wait_with_output().unwrap());
        assert_eq!(done.code, Some(code), "{signal}: {done:?}");
        assert!(done.err.contains("interrupted after") && done.err.contains("--out"), "{}", done.err);
        assert!(done.out.contains("lean, ") && done.out.contains(" so far"), "{}", done.out);

        let text = project.read("out/episodes.jsonl");
        let lines = journal(&text);
        assert!((3..2000).contains(&lines.len()) && text.ends_with('\n'));
        let summary: serde_json::Value = serde_json::from_str(&project.read("out/summary.json")).unwrap();
        assert_eq!(summary["tasks"][0]["episodes"], lines.len());
    }
}

#[test]
fn a_run_that_is_killed_at_any_moment_is_continued_to_the_same_bytes() {
    let project = Project::empty();
    project.write("lean.msk", LEAN);
    let arguments = ["eval", "lean.msk", "--policy", "random", "--episodes", "40", "--out"];
    project.msk(&[&arguments[..], &["whole", "--threads", "1"]].concat()).succeeded();
    let lines = || std::fs::read_to_string(project.path("out/episodes.jsonl")).map_or(0, |text| text.lines().count());
    let killed = |least: usize| {
        let mut child = project.command(&[&arguments[..], &["out", "--threads", "3"]].concat()).spawn().unwrap();
        let start = Instant::now();
        while lines() < least && child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < Duration::from_secs(60), "no episode has ended");
            std::thread::sleep(Duration::from_millis(1));
        }
        // SIGKILL: nothing is told to the program.
        child.kill().unwrap();
        child.wait().unwrap();
    };
    for least in [0, 1, 12] {
        killed(least);
    }
    project.msk(&[&arguments[..], &["out", "--threads", "2"]].concat()).succeeded();
    let names = |folder: &str| {
        let entries =
            std::fs::read_dir(project.path(folder)).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = entries.collect();
        names.sort();
        names
    };
    assert_eq!(names("out"), names("whole"));
    for name in ["run.json", "episodes.jsonl", "summary.json", "report.md"] {
        assert_eq!(project.read(format!("out/{name}")), project.read(format!("whole/{name}")), "{name}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_that_is_to_ignore_its_terminal_goes_on_when_that_closes() {
    let project = Project::empty();
    project.write("lean.msk", LEAN);
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' HUP && exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_msk")]).args(ARGUMENTS);
    let mut child = command.current_dir(project.path("")).spawn().unwrap();
    send(&project, &child, "-HUP");
    let before = project.read("out/episodes.jsonl").lines().count();
    let start = Instant::now();
    while project.read("out/episodes.jsonl").lines().count() < before + 5 {
        assert!(start.elapsed() < Duration::from_secs(60), "it has stopped");
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}
