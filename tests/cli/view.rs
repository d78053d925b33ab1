//! `msk view`: a run in a browser, while it goes on and afterwards.
#![cfg(unix)]

use super::project::{Done, Project};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// A running `msk view`.
struct Shown {
    child: Option<Child>,
    host: String,
    token: String,
}

impl Shown {
    fn of(project: &Project, arguments: &[&str]) -> Self {
        let mut child = project.command(&[&["view"], arguments].concat()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        Self::at(child, line.trim())
    }

    /// `msk run --live`, which keeps its output for the report.
    fn live(project: &Project, arguments: &[&str]) -> Self {
        let mut child = project.command(&[&["run"], arguments, &["--live"]].concat()).spawn().unwrap();
        // Byte by byte: what follows the line stays for the output.
        let (stderr, mut line, mut byte) = (child.stderr.as_mut().unwrap(), Vec::new(), [0]);
        while stderr.read(&mut byte).unwrap() == 1 && byte != *b"\n" {
            line.push(byte[0]);
        }
        let line = String::from_utf8(line).unwrap();
        Self::at(child, line.strip_prefix("Open ").unwrap().split(' ').next().unwrap())
    }

    fn at(child: Child, address: &str) -> Self {
        let place = address.strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{address:?}"));
        let (port, token) = place.strip_suffix('/').unwrap().split_once('/').unwrap();
        assert_eq!(token.len(), 32);
        Self { child: Some(child), host: format!("127.0.0.1:{port}"), token: token.to_owned() }
    }

    /// Status and content of a path behind the token.
    fn get(&self, path: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        write!(stream, "GET /{}/{path} HTTP/1.1\r\nHost: {}\r\n\r\n", self.token, self.host).unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
    }

    fn state(&self) -> Value {
        let (status, text) = self.get("state.json");
        assert_eq!(status, 200, "{text}");
        serde_json::from_str(&text).unwrap()
    }

    fn interrupt(mut self) -> Done {
        let child = self.child.take().unwrap();
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        Done::from(child.wait_with_output().unwrap())
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        if let Some(mut child) = self.child.take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[test]
fn a_finished_evaluation_is_shown_until_it_is_interrupted() {
    let project = Project::lean();
    project.msk(&["eval", "tasks.msk", "--policy", "random", "--weight", "pose=7", "--out", "out"]).succeeded();
    let shown = Shown::of(&project, &["out"]);
    let (status, page) = shown.get("");
    assert!(status == 200 && page.starts_with("<!doctype html>"));
    let state = shown.state();
    assert_eq!((&state["kind"], &state["title"], &state["over"]), (&"evaluation".into(), &"random".into(), &true.into()));
    let task = &state["tasks"][0];
    assert_eq!((&task["name"], &task["episodes"], &task["of"]), (&"lean".into(), &3.into(), &3.into()));
    let returns: Vec<f64> = state["episodes"].as_array().unwrap().iter().map(|row| row["return"].as_f64().unwrap()).collect();
    assert!((returns.iter().sum::<f64>() / 3.0 - task["return"].as_f64().unwrap()).abs() < 1e-9);
    let terms: f64 = task["terms"].as_array().unwrap().iter().map(|term| term["value"].as_f64().unwrap()).sum();
    assert!(terms > 0.0, "{task}");

    let (status, episode) = shown.get("episode/2");
    assert!(status == 200 && episode.contains("<title>lean, random</title>"));
    // Played with the weights of the run, it is what was recorded.
    assert_eq!(shown.get("episode/2").1, episode);
    assert!(!episode.contains("otherwise"));
    for (path, status) in [("episode/3", 404), ("episode/x", 404), ("episode/../run.json", 404), ("run.json", 404)] {
        assert_eq!(shown.get(path).0, status, "{path}");
    }
    project.write("lean.msk", &project.read("lean.msk").replace("- 2 cm", "- 3 cm"));
    let (status, why) = shown.get("episode/1");
    assert!(status == 422 && why.contains("it has been changed since"), "{why}");
    let done = shown.interrupt();
    assert_eq!(done.code, Some(130), "{done:?}");
}

#[test]
fn results_that_are_shown_start_no_program_and_open_no_file() {
    let project = Project::lean();
    project.msk(&["run", "lean", "--policy", "zero", "--actions", "zero.npy"]).succeeded();
    project.msk(&["eval", "lean.msk", "--policy", "replay zero.npy", "--episodes", "1", "--out", "out"]).succeeded();
    let shown = Shown::of(&project, &["out"]);
    let (status, why) = shown.get("episode/0");
    assert!(status == 422 && why.contains("only built-in policies are played from results"), "{why}");
    shown.interrupt();

    project.write("agent.sh", ACTS);
    project.msk(&["eval", "lean.msk", "--policy", "process sh agent.sh", "--episodes", "1", "--out", "program"]).succeeded();
    std::fs::remove_file(project.path("started")).unwrap();
    let shown = Shown::of(&project, &["program"]);
    let (status, why) = shown.get("episode/0");
    assert!(status == 422 && why.contains("the policy `process sh agent.sh`"), "{why}");
    shown.interrupt();
    assert!(!project.path("started").exists());
}

/// A program for `sh` that leaves a file when it is started, and rests.
const ACTS: &str = r#"touch started
while read -r line; do
    case "$line" in
        '{"task"'*) echo '{"ready": true}' ;;
        *) printf '{"action": ['; printf '%.0s-1,' $(seq 415); echo '-1]}' ;;
    esac
done
"#;

#[test]
fn the_page_follows_a_run_and_ends_with_it() {
    let project = Project::lean();
    let run = ["eval", "lean.msk", "--policy", "zero", "--episodes", "150", "--threads", "1", "--out", "out"];
    let evaluation = project.command(&run).spawn().unwrap();
    let begin = Instant::now();
    while !project.path("out/run.json").exists() {
        assert!(begin.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(10));
    }
    let mut shown = Shown::of(&project, &["out", "--tasks", "lean.msk"]);
    // A reader that takes nothing stands beside.
    let mut stalled = TcpStream::connect(&shown.host).unwrap();
    write!(stalled, "GET /{}/ HTTP/1.1\r\nHost: {}\r\n\r\n", shown.token, shown.host).unwrap();
    let first = shown.state();
    Done::from(evaluation.wait_with_output().unwrap()).succeeded();
    std::thread::sleep(Duration::from_millis(700));
    let last = shown.state();
    assert!(first["tasks"][0]["episodes"].as_u64() <= last["tasks"][0]["episodes"].as_u64());
    assert_eq!((&last["over"], &last["tasks"][0]["episodes"]), (&true.into(), &150.into()));
    let ended = shown.child.take().unwrap().wait_with_output().unwrap();
    if first["over"] == false {
        assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    }
}

#[test]
fn a_training_has_its_curve_and_its_agent() {
    let project = super::train::project();
    Done::from(super::train::train(&project, "4000", "out").output().unwrap()).succeeded();
    let shown = Shown::of(&project, &["out", "--tasks", "pendulum.msk"]);
    let state = shown.state();
    assert_eq!((&state["kind"], &state["over"], &state["steps"]), (&"training".into(), &true.into(), &4000.into()));
    assert!(state["curve"].as_array().unwrap().len() > 2 && state["evaluations"].as_array().unwrap().len() >= 2, "{state}");
    let (status, episode) = shown.get("episode/2");
    assert!(status == 200 && episode.contains("<title>hold, agent "), "{episode:.200}");
    assert_eq!(shown.interrupt().code, Some(130));
}

#[test]
fn an_episode_is_shown_while_it_is_played_and_until_it_has_been_fetched() {
    let project = Project::lean();
    let mut shown = Shown::live(&project, &["lean", "--policy", "random"]);
    assert!(shown.get("").1.starts_with("<!doctype html>"));
    let begin = Instant::now();
    let state = loop {
        let state = shown.state();
        assert_eq!((&state["kind"], &state["title"]), (&"episode".into(), &"lean, random".into()));
        if state["over"] == true {
            break state;
        }
        assert!(begin.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(10));
    };
    let terms = state["terms"].as_array().unwrap();
    let sum: f64 = terms.iter().map(|term| term["value"].as_f64().unwrap()).sum();
    assert_eq!(state["return"].as_f64(), Some(sum));
    assert_eq!(state["recorded"], state["step"]);
    assert!(!state["curve"].as_array().unwrap().is_empty());
    assert_eq!(shown.get("state").0, 404);
    let (status, page) = shown.get("episode/whole");
    assert!(status == 200 && page.contains("<title>lean, random</title>"));
    // Its reader has it all, so the program ends by itself; its output is the report alone.
    let done = Done::from(shown.child.take().unwrap().wait_with_output().unwrap()).succeeded();
    assert!(done.out.starts_with("lean, policy random, seed 0, episode 0:"), "{done:?}");
}

#[test]
fn a_shown_episode_without_a_reader_ends_with_an_interruption() {
    let project = Project::lean();
    let shown = Shown::live(&project, &["lean", "--policy", "zero", "--html", "lean.html"]);
    while shown.state()["over"] == false {
        std::thread::sleep(Duration::from_millis(10));
    }
    // What was asked for is written, and nothing failed.
    let done = shown.interrupt();
    assert_eq!(done.code, Some(0), "{done:?}");
    assert!(project.read("lean.html").contains("<title>lean, zero</title>"));
}

#[test]
fn a_folder_without_a_run_is_refused() {
    let project = Project::lean();
    std::fs::create_dir(project.path("empty")).unwrap();
    project.msk(&["view", "empty"]).failed(1, &["`empty` holds no run", "msk eval"]);
    project.msk(&["view", "nowhere"]).failed(1, &["cannot read the folder `nowhere`"]);
    project.write("bad/run.json", "{");
    project.msk(&["view", "bad"]).failed(1, &["is damaged"]);
    project.msk(&["view", "bad", "--port", "99999"]).failed(2, &["99999"]);
}
