//! `msk eval`: results, their sameness, and how they are kept.

use crate::project::{Project, journal};
use serde_json::Value;

fn eval(project: &Project, out: &str, more: &[&str]) -> crate::project::Done {
    project.msk(&[&["eval", "tasks.msk", "--policy", "random", "--out", out], more].concat())
}

#[test]
fn a_suite_is_evaluated_by_its_own_protocol() {
    let project = Project::lean();
    let done = eval(&project, "out", &[]).succeeded();
    assert!(done.out.contains("Policy `random`, 3 episodes per task, seed 5"), "{}", done.out);
    for column in ["success [95 %]", "return", "steps", "ended by", "value per step", "share"] {
        assert!(done.out.contains(column), "no `{column}` in {}", done.out);
    }
    assert!(done.out.lines().all(|line| line.chars().count() <= 100), "{}", done.out);
    assert!(done.out.starts_with(&project.read("out/report.md")), "the report on disk is the one that was printed");
}

#[test]
fn every_episode_leaves_a_record_whose_terms_add_up_to_the_return() {
    let project = Project::lean();
    eval(&project, "out", &[]).succeeded();
    let records: Vec<Value> =
        project.read("out/episodes.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(records.len(), 3);
    for record in records {
        assert_eq!((&record["task"], &record["policy"], &record["seed"]), (&"lean".into(), &"random".into(), &5.into()));
        let terms = record["terms"].as_object().unwrap();
        assert_eq!(terms.len(), 3);
        let (sum, total) = (terms.values().map(|pay| pay.as_f64().unwrap()).sum::<f64>(), record["return"].as_f64().unwrap());
        assert!((sum - total).abs() < 1e-9 * total.abs(), "{record}");
        let steps = record["steps"].as_u64().unwrap();
        let ended_early = !record["terminated_by"].as_array().unwrap().is_empty();
        assert!(steps > 0 && (ended_early || steps == 20), "{record}");
        assert_eq!(record["truncated"], !ended_early);
        assert_eq!(record["success"], !ended_early);
        assert_eq!(record["fault"], Value::Null);
        assert!(record["task_hash"].as_str().unwrap().len() >= 16 && record["model_hash"].as_str().unwrap().len() >= 16);
    }
}

#[test]
fn results_have_the_same_bits_on_one_thread_and_on_four() {
    let project = Project::lean();
    eval(&project, "one", &["--threads", "1", "--episodes", "6"]).succeeded();
    eval(&project, "four", &["--threads", "4", "--episodes", "6"]).succeeded();
    let lines = journal(&project.read("one/episodes.jsonl"));
    assert_eq!(lines.len(), 6);
    assert_eq!(lines, journal(&project.read("four/episodes.jsonl")));
    assert_eq!(project.read("one/summary.json"), project.read("four/summary.json"));
    assert_eq!(project.read("one/report.md"), project.read("four/report.md"));
    assert_eq!(project.read("one/run.json"), project.read("four/run.json"));
}

#[test]
fn episodes_differ_from_each_other_and_from_those_of_other_seeds() {
    let project = Project::lean();
    eval(&project, "five", &[]).succeeded();
    eval(&project, "six", &["--seed", "6"]).succeeded();
    let returns = |file: &str| -> Vec<String> {
        let record = |line: &str| serde_json::from_str::<Value>(line).unwrap()["return"].to_string();
        project.read(file).lines().map(record).collect()
    };
    let mut all = [returns("five/episodes.jsonl"), returns("six/episodes.jsonl")].concat();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), 6);
}

#[test]
fn a_run_that_was_cut_short_is_continued_to_the_same_results() {
    let project = Project::lean();
    eval(&project, "whole", &["--threads", "1"]).succeeded();
    eval(&project, "cut", &["--threads", "1"]).succeeded();
    let lines = project.read("cut/episodes.jsonl");
    // One episode and a half: as if the machine had lost its power.
    let first = lines.find('\n').unwrap() + 1;
    project.write("cut/episodes.jsonl", &lines[..first + 30]);
    let done = eval(&project, "cut", &["--threads", "1"]).succeeded();
    assert!(done.err.contains("1 of 3 episodes"), "{}", done.err);
    let again = project.read("cut/episodes.jsonl");
    assert!(again.starts_with(&lines[..first]), "what was there stays as it was");
    assert_eq!(journal(&again), journal(&project.read("whole/episodes.jsonl")));
    assert_eq!(project.read("cut/summary.json"), project.read("whole/summary.json"));
}

#[test]
fn a_finished_run_is_not_run_again() {
    let project = Project::lean();
    eval(&project, "out", &[]).succeeded();
    let lines = project.read("out/episodes.jsonl");
    let done = eval(&project, "out", &[]).succeeded();
    assert!(done.err.contains("3 of 3 episodes"), "{}", done.err);
    assert_eq!(project.read("out/episodes.jsonl"), lines);
}

#[test]
fn results_of_another_run_are_never_overwritten() {
    let project = Project::lean();
    eval(&project, "out", &[]).succeeded();
    let lines = project.read("out/episodes.jsonl");
    eval(&project, "out", &["--seed", "6"]).failed(1, &["holds another run", "seed is 5, not 6", "hint:"]);
    project.write("lean.msk", &crate::project::LEAN.replace("10    pose", "11    pose"));
    eval(&project, "out", &[]).failed(1, &["holds another run", "task `lean` has changed", "hint:"]);
    assert_eq!(project.read("out/episodes.jsonl"), lines);
}

#[test]
fn without_a_folder_every_run_gets_a_new_one() {
    let project = Project::lean();
    for number in 1..=2 {
        let done = project.msk(&["eval", "lean.msk", "--policy", "zero", "--episodes", "1"]).succeeded();
        assert!(done.out.contains(&format!("lean-zero-{number}")), "{}", done.out);
        assert!(project.path(&format!("results/lean-zero-{number}/summary.json")).exists());
    }
}

#[test]
fn one_task_of_a_suite_may_be_chosen() {
    let project = Project::lean();
    eval(&project, "out", &["--task", "lean", "--episodes", "1"]).succeeded();
    eval(&project, "other", &["--task", "leap"]).failed(1, &["no task `leap`", "lean"]);
}

#[test]
fn a_task_in_two_families_runs_once() {
    let project = Project::lean();
    project.write("tasks.msk", "use \"lean.msk\"\nsuite twice {\n    family one { lean }\n    family two { lean }\n}\n");
    eval(&project, "out", &["--episodes", "2"]).succeeded();
    assert_eq!(project.read("out/episodes.jsonl").lines().count(), 2);
}

#[test]
fn an_episode_that_cannot_go_on_is_a_result_and_the_others_go_on() {
    let project = Project::lean();
    // Faster than anything that the simulator takes for a number that means something.
    let root = "root { height on ground, velocity [1e12 m/s, 0, 0] }";
    let fault = crate::project::LEAN.replace("root { height on ground }", root).replace("task lean", "task flung");
    project.write("flung.msk", &fault);
    let suite = "use \"lean.msk\"\nuse \"flung.msk\"\nsuite both { family one { flung, lean } }\n";
    project.write("tasks.msk", suite);
    for policy in ["posture", "random"] {
        let arguments = ["eval", "tasks.msk", "--policy", policy, "--episodes", "2", "--out", policy];
        let done = project.msk(&arguments).succeeded();
        assert!(done.out.contains("Fault in `flung`, episode 1: at 0 s"), "{}", done.out);
        let lines = project.read(format!("{policy}/episodes.jsonl"));
        let records = lines.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        let (faults, sound): (Vec<_>, Vec<_>) = records.partition(|record| record["task"] == "flung");
        assert!(faults.len() == 2 && faults.iter().all(|record| record["fault"].is_string() && record["success"] == false));
        assert!(sound.len() == 2 && sound.iter().all(|record| record["fault"] == Value::Null && record["steps"] != 0));
    }
}
