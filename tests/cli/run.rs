//! `msk run`: one episode.

use crate::project::{LEAN, Project};
use serde_json::Value;

#[test]
fn a_task_is_found_by_name_or_by_path() {
    let project = Project::lean();
    let by_name = project.msk(&["run", "lean", "--policy", "zero", "--seed", "1"]).succeeded();
    let by_path = project.msk(&["run", "lean.msk", "--policy", "zero", "--seed", "1"]).succeeded();
    assert_eq!(by_name.out, by_path.out);
    for part in ["lean, policy zero, seed 1", "steps", "pose", "alive", "effort", "share", "return"] {
        assert!(by_name.out.contains(part), "no `{part}` in {}", by_name.out);
    }
}

#[test]
fn an_episode_is_the_same_whether_it_is_run_or_evaluated() {
    let project = Project::lean();
    let run = project.msk(&["run", "lean", "--policy", "random", "--seed", "5", "--episode", "2", "--json"]).succeeded();
    let mut run: Value = serde_json::from_str(&run.out).unwrap();
    project.msk(&["eval", "tasks.msk", "--policy", "random", "--out", "out"]).succeeded();
    let lines = project.read("out/episodes.jsonl");
    let records = lines.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let mut evaluated = records.into_iter().find(|record| record["episode"] == 2).unwrap();
    run["wall_time"] = Value::Null;
    evaluated["wall_time"] = Value::Null;
    for entry in ["run", "checksum"] {
        assert!(evaluated.as_object_mut().unwrap().remove(entry).is_some(), "{entry}");
    }
    assert_eq!(run, evaluated);
}

#[test]
fn an_end_is_told_by_its_name() {
    let project = Project::empty();
    project.write("fall.msk", &LEAN.replace("horizon  20", "horizon  200"));
    let done = project.msk(&["run", "fall.msk", "--policy", "zero"]).succeeded();
    assert!(done.out.contains("ended by sunk after") && done.out.contains("no success"), "{}", done.out);
}

#[test]
fn a_file_with_several_tasks_is_not_one_task() {
    let project = Project::lean();
    project.write("two.msk", &format!("{LEAN}\n{}", LEAN.replace("task lean", "task loll")));
    project.msk(&["run", "two.msk", "--policy", "zero"]).failed(1, &["`two.msk` holds 2 tasks: lean, loll"]);
}

#[test]
fn the_state_at_the_end_can_be_drawn() {
    let project = Project::lean();
    project.msk(&["run", "lean", "--policy", "random", "--state", "end.json"]).succeeded();
    project.msk(&["draw", "--state", "end.json", "--out", "end.svg"]).succeeded();
    assert!(project.read("end.svg").starts_with("<svg"));
    let refused = project.msk(&["run", "lean", "--policy", "zero", "--state", "nowhere/end.json"]);
    refused.failed(1, &["`nowhere/end.json` cannot be written"]);
}
