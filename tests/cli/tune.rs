//! `msk tune`.

use super::project::{LEAN, Project};
use serde_json::Value;

fn tune(project: &Project, more: &[&str]) -> super::project::Done {
    let arguments = ["tune", "lean", "--policy", "random", "--rehearse", "--interval", "25", "--rounds", "2", "--out", "out"];
    project.msk(&[&arguments[..], more].concat())
}

#[test]
fn weights_are_tuned_within_the_rules_and_the_source_stays() {
    let project = Project::lean();
    let done = tune(&project, &["--threads", "2"]).succeeded();
    assert!(done.out.contains("round 1: score") && done.out.contains("Best: round"), "{}", done.out);
    assert_eq!(project.read("lean.msk"), LEAN);
    let rounds: Vec<Value> = project.read("out/rounds.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(rounds.len(), 2);
    assert!(rounds[0]["prompt"].as_str().unwrap().contains("Answer with data only"));
    for (before, after) in rounds[0]["weights"].as_array().unwrap().iter().zip(rounds[0]["applied"].as_array().unwrap()) {
        let [before, after] = [before, after].map(|weight| weight[1].as_f64().unwrap());
        assert!((after - before).abs() <= 0.2 * before.abs() + 1e-12 && after.signum() == before.signum());
    }
    // What it found can be used, and baked into the source.
    project.msk(&["explain", "lean", "--weights", "out/best.toml"]).succeeded();
    // All is there already; a larger budget goes on from there.
    let log = project.read("out/rounds.jsonl");
    let done = tune(&project, &[]).succeeded();
    assert!(done.err.contains("2 of 2 rounds exist"), "{}", done.err);
    assert_eq!(project.read("out/rounds.jsonl"), log);
    tune(&project, &["--seed", "9"]).failed(1, &["contains another"]);
}

#[cfg(unix)]
#[test]
fn a_program_may_be_the_reasoner_and_its_failure_stops_the_session_if_that_is_wished() {
    let project = Project::lean();
    project.write("reasoner.toml", "kind = \"process\"\ncommand = [\"sh\", \"-c\", \"echo '{\\\"pose\\\": 11}'\"]\n");
    let done = tune(&project, &["--reasoner", "reasoner.toml"]).succeeded();
    assert!(done.out.contains("pose 10 -> 11"), "{}", done.out);
    project.write("broken.toml", "kind = \"process\"\ncommand = [\"false\"]\n");
    let arguments =
        ["tune", "lean", "--policy", "zero", "--rehearse", "--interval", "5", "--out", "other", "--reasoner", "broken.toml"];
    project.msk(&[&arguments[..], &["--on-failure", "stop"]].concat()).failed(1, &["it ended with code 1"]);
    assert_eq!(project.read("other/rounds.jsonl").lines().count(), 1);
}

#[test]
fn what_makes_no_sense_is_reported() {
    let project = Project::lean();
    tune(&project, &["--objective", "sway"]).failed(1, &["has no metric `sway`", "success or survival"]);
    tune(&project, &["--reasoner", "none.toml"]).failed(1, &["none.toml"]);
    tune(&project, &["--outside", "psoe"]).failed(1, &["did you mean `pose`"]);
    tune(&project, &["--interval", "0"]).failed(2, &["--interval"]);
    project.write(
        "http.toml",
        "kind = \"http\"\nurl = \"https://example.org/v1\"\nmodel = \"m\"\nkey_variable = \"MSK_NO_SUCH_KEY\"\n",
    );
    tune(&project, &["--reasoner", "http.toml"]).failed(1, &["environment variable `MSK_NO_SUCH_KEY`"]);
}

#[test]
fn a_policy_that_does_not_react_to_weights_is_refused() {
    let project = Project::lean();
    for policy in ["cmc", "zero", "demonstration"] {
        let refused = project.msk(&["tune", "lean", "--policy", policy, "--out", "out"]);
        refused.failed(1, &[&format!("`{policy}` does the same whatever the weights are"), "`--policy plan`", "--rehearse"]);
    }
}

/// What is asked for decides what is done: with the weights of a round the body does what these reward.
#[test]
fn a_plan_is_tuned() {
    let project = Project::lean();
    let quick = "samples = 4\nhorizon = 0.05\ntail = 0.0\nfirst_rounds = 1\nreplan = 5\n";
    project.write("quick.toml", quick);
    let arguments = ["tune", "lean", "--policy", "plan quick.toml", "--interval", "20", "--rounds", "2", "--out", "out"];
    let done = project.msk(&arguments).succeeded();
    assert!(done.out.contains("round 2: score"), "{}", done.out);
    let log = project.read("out/rounds.jsonl");
    // Again from the beginning: the same statistics.
    let again = Project::lean();
    again.write("quick.toml", quick);
    again.msk(&arguments).succeeded();
    let statistics = |log: &str| {
        let rounds = log.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        rounds.map(|round| round["statistics"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(statistics(&again.read("out/rounds.jsonl")), statistics(&log));
}

/// The finding: a key that an endpoint gave back as the name of a weight stood in the log and on the terminal.
#[test]
fn a_key_that_an_endpoint_repeats_is_shown_nowhere() {
    use std::io::{BufRead, BufReader, Read, Write};
    const KEY: &str = "sk-very-secret";
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let project = Project::lean();
    let url = format!("http://{}/v1", listener.local_addr().unwrap());
    project.write(
        "http.toml",
        &format!("kind = \"http\"\nurl = \"{url}\"\nmodel = \"m\"\nkey_variable = \"MSK_TEST_KEY\"\nattempts = 1\n"),
    );
    let server = std::thread::spawn(move || {
        let contents = [
            format!("{{\"weights\": {{\"{KEY}\": 1}}}}"),
            format!("{{\"weights\": {{\"pose\": 11}}, \"reason\": \"{}{KEY}\"}}", "x".repeat(1995)),
        ];
        for content in contents {
            let (stream, _) = listener.accept().unwrap();
            let mut reader = BufReader::new(stream);
            let (mut length, mut line) = (0, String::new());
            while reader.read_line(&mut line).unwrap() > 2 {
                if let Some(value) = line.to_lowercase().strip_prefix("content-length:") {
                    length = value.trim().parse().unwrap();
                }
                line.clear();
            }
            reader.read_exact(&mut vec![0; length]).unwrap();
            let body =
                serde_json::json!({ "model": KEY, "choices": [{ "message": { "content": content } }], KEY: KEY }).to_string();
            let head = format!("HTTP/1.1 200 OK\r\ncontent-length: {}\r\nconnection: close\r\n\r\n", body.len());
            reader.get_mut().write_all((head + &body).as_bytes()).unwrap();
        }
    });
    let arguments = ["tune", "lean", "--policy", "zero", "--rehearse", "--interval", "5", "--rounds", "3", "--out", "out"];
    let mut command = project.command(&[&arguments[..], &["--reasoner", "http.toml"]].concat());
    let done = super::project::Done::from(command.env("MSK_TEST_KEY", KEY).output().unwrap()).succeeded();
    server.join().unwrap();
    let log = project.read("out/rounds.jsonl");
    assert!(log.contains("there is no term `(key)`") && log.contains("xx(key)"), "{log}");
    assert!(done.out.contains("there is no term `(key)`") && done.out.contains("pose 10 -> 11"), "{}", done.out);
    for text in [log, done.out, done.err] {
        assert!(!text.contains("sk-v"), "{text}");
    }
}

/// The pendulum with a second term, and settings of a small learner that checks in often.
fn learner_project() -> Project {
    let project = super::train::project();
    let text = project.read("pendulum.msk").replace("        1 near", "        -0.01 effort = sum(action^2)\n        1 near");
    project.write("pendulum.msk", &text);
    project
}

fn tune_learner(project: &Project, out: &str) -> std::process::Command {
    let policy = ["tune", "pendulum.msk", "--policy", "learner learner.toml", "--learn", "3000", "--interval", "200"];
    project.command(&[&policy[..], &["--rounds", "4", "--threads", "1", "--out", out]].concat())
}

/// The rounds of a session but for their times.
fn rounds(project: &Project, out: &str) -> Vec<Value> {
    let read = |line: &str| {
        let mut round = serde_json::from_str::<Value>(line).unwrap();
        round.as_object_mut().unwrap().remove("time");
        round
    };
    project.read(format!("{out}/rounds.jsonl")).lines().map(read).collect()
}

/// What is rewarded decides what is learned, round by round; and a session that is killed learns what an undisturbed one does.
#[test]
fn a_learner_is_tuned_and_a_killed_session_ends_as_an_undisturbed_one() {
    let project = learner_project();
    let done = super::project::Done::from(tune_learner(&project, "whole").output().unwrap()).succeeded();
    assert!(done.out.contains("round 4: score"), "{}", done.out);
    let whole = rounds(&project, "whole");
    assert_ne!(whole[0]["weights"], whole[3]["weights"]);
    assert_ne!(whole[0]["statistics"]["return"], whole[3]["statistics"]["return"]);
    project.msk(&["run", "pendulum.msk", "--policy", "agent whole/training/best-by-objective"]).succeeded();

    let mut child = tune_learner(&project, "parts").spawn().unwrap();
    let start = std::time::Instant::now();
    while std::fs::read_to_string(project.path("parts/rounds.jsonl")).map_or(0, |text| text.lines().count()) < 2 {
        assert!(start.elapsed() < std::time::Duration::from_secs(60), "no round has ended");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    super::project::Done::from(tune_learner(&project, "parts").output().unwrap()).succeeded();
    assert_eq!(rounds(&project, "parts"), whole);
    for agent in ["best-by-objective", "last"] {
        let bytes =
            |folder: &str| std::fs::read(project.path(folder).join("training").join(agent).join("policy.safetensors")).unwrap();
        assert!(bytes("parts") == bytes("whole"), "{agent}");
    }
    project.msk(&["tune", "pendulum.msk", "--policy", "learner clone"]).failed(1, &["whatever the weights are", "ppo, sac"]);
    project.msk(&["tune", "pendulum.msk", "--policy", "learner nothing.toml"]).failed(1, &["nothing.toml"]);
}
