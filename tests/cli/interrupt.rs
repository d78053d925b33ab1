//! Ctrl-C: the present episodes are given up, the ended ones are kept.
#![cfg(unix)]

use crate::project::{Done, LEAN, Project, journal};
use std::process::Command;
use std::time::{Duration, Instant};

#[test]
fn an_interrupted_run_leaves_a_valid_journal_that_can_be_continued() {
    let project = Project::empty();
    project.write("lean.msk", LEAN);
    let arguments = ["eval", "lean.msk", "--policy", "zero", "--episodes", "2000", "--threads", "2", "--out", "out"];
    let child = project.command(&arguments).spawn().unwrap();
    let start = Instant::now();
    while std::fs::read_to_string(project.path("out/episodes.jsonl")).map_or(0, |text| text.lines().count()) < 3 {
        assert!(start.elapsed() < Duration::from_secs(60), "no episode has ended");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let done = Done::from(child.wait_with_output().unwrap());
    assert_eq!(done.code, Some(130), "{done:?}");
    assert!(done.err.contains("interrupted after") && done.err.contains("--out"), "{}", done.err);
    assert!(done.out.contains("lean, ") && done.out.contains(" so far"), "{}", done.out);

    let text = project.read("out/episodes.jsonl");
    let lines = journal(&text);
    assert!((3..2000).contains(&lines.len()) && text.ends_with('\n'));
    let summary: serde_json::Value = serde_json::from_str(&project.read("out/summary.json")).unwrap();
    assert_eq!(summary["tasks"][0]["episodes"], lines.len());
}
