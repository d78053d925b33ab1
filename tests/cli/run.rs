//! `msk run`: one episode.

use super::project::{LEAN, Project};
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
    let run: Value = serde_json::from_str(&run.out).unwrap();
    project.msk(&["eval", "tasks.msk", "--policy", "random", "--out", "out"]).succeeded();
    let lines = project.read("out/episodes.jsonl");
    let records = lines.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let mut evaluated = records.into_iter().find(|record| record["episode"] == 2).unwrap();
    for entry in ["run", "checksum"] {
        assert!(evaluated.as_object_mut().unwrap().remove(entry).is_some(), "{entry}");
    }
    assert_eq!(run, evaluated);
}

#[test]
fn a_sequence_that_runs_out_of_time_says_which_until_never_held() {
    let project = Project::empty();
    // At rest the body sinks by less than that within the time of the first phase.
    project.write("lean.msk", &LEAN.replace("- 2 cm", "- 50 cm"));
    let sequence = "use \"lean.msk\"\n\ntask low extends lean { horizon 30 steps }\n\n\
        sequence both {\n    phase lean until pelvis.height > 1.5 m\n    phase low\n    success survived\n\
        test \"waits\" { pose neutral; at 0.4 s pose neutral; expect ended by sunk }\n}\n";
    project.write("both.msk", sequence);
    let never = "in `lean` until `pelvis.height > 1.5 m`";
    let run = project.msk(&["run", "both.msk@both", "--policy", "zero"]).succeeded();
    assert!(run.out.contains(&format!("reached the horizon {never}, which never held, after 20 steps")), "{}", run.out);
    let eval =
        project.msk(&["eval", "both.msk", "--task", "both", "--policy", "zero", "--episodes", "2", "--out", "out"]).succeeded();
    assert!(eval.out.contains("horizon in `lean` until"), "{}", eval.out);
    assert!(project.read("out/report.md").contains(&format!("horizon {never}")), "{}", project.read("out/report.md"));
    let test = project.msk(&["test", "both.msk"]);
    assert!(test.out.contains(&format!("the episode reached the horizon at 0.20 s {never}, which never held")), "{}", test.out);
    assert_eq!(test.code, Some(1));
    // A last phase waits for nothing.
    project.write("both.msk", &sequence.replace("> 1.5 m", "> 0.5 m"));
    let run = project.msk(&["run", "both.msk@both", "--policy", "zero"]).succeeded();
    assert!(!run.out.contains("never held"), "{}", run.out);
}

#[test]
fn an_end_is_reported_by_its_name() {
    let project = Project::empty();
    project.write("fall.msk", &LEAN.replace("horizon  20", "horizon  200"));
    let done = project.msk(&["run", "fall.msk", "--policy", "zero"]).succeeded();
    assert!(done.out.contains("ended by sunk after") && done.out.contains("no success"), "{}", done.out);
}

#[test]
fn a_file_with_several_tasks_is_not_one_task() {
    let project = Project::lean();
    project.write("two.msk", &format!("{LEAN}\n{}", LEAN.replace("task lean", "task loll")));
    project.msk(&["run", "two.msk", "--policy", "zero"]).failed(1, &["`two.msk` contains 2 tasks: lean, loll"]);
}

#[test]
fn an_episode_is_a_page_and_the_same_one_every_time() {
    let project = Project::lean();
    for page in ["first.html", "second.html"] {
        project.msk(&["run", "lean", "--policy", "random", "--seed", "3", "--html", page]).succeeded();
    }
    let page = project.read("first.html");
    assert_eq!(page, project.read("second.html"));
    assert!(page.starts_with("<!doctype html>") && page.contains("<title>lean, random</title>"));
    project.msk(&["run", "lean", "--ignore-terminations", "--policy", "zero", "--html", "on.html"]).succeeded();
    assert_ne!(page, project.read("on.html"));
    let refused = project.msk(&["run", "lean", "--policy", "zero", "--html", "nowhere/page.html"]);
    refused.failed(1, &["cannot write `nowhere/page.html`"]);
}

#[test]
fn the_state_at_the_end_can_be_drawn() {
    let project = Project::lean();
    project.msk(&["run", "lean", "--policy", "random", "--state", "end.json"]).succeeded();
    project.msk(&["draw", "--state", "end.json", "--out", "end.svg"]).succeeded();
    assert!(project.read("end.svg").starts_with("<svg"));
    let refused = project.msk(&["run", "lean", "--policy", "zero", "--state", "nowhere/end.json"]);
    refused.failed(1, &["cannot write `nowhere/end.json`"]);
}
