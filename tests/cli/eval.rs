//! `msk eval`: results, their sameness, and how they are kept.

use super::project::{Project, journal};
use serde_json::Value;

fn eval(project: &Project, out: &str, more: &[&str]) -> super::project::Done {
    project.msk(&[&["eval", "tasks.msk", "--policy", "random", "--out", out], more].concat())
}

#[test]
fn a_suite_is_evaluated_by_its_own_protocol() {
    let project = Project::lean();
    let done = eval(&project, "out", &[]).succeeded();
    assert!(done.out.contains("Policy `random`, 3 episodes per task, seed 5"), "{}", done.out);
    for part in ["success [95 %]", "return", "horizon", "ended by", "played: 3 of 3 episodes", "Results: out"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    assert!(done.out.lines().all(|line| line.chars().count() <= 80), "{}", done.out);
    assert!(!done.out.contains("value / step"), "terms stand in the report: {}", done.out);
    let report = project.read("out/report.md");
    for column in ["success [95 %]", "return", "steps", "ended by", "value / step", "share"] {
        assert!(report.contains(column), "no `{column}` in {report}");
    }
    assert!(report.lines().all(|line| line.chars().count() <= 100), "{report}");
}

#[test]
fn a_suite_may_have_several_protocols() {
    let project = Project::lean();
    let protocols = "protocol quick { episodes 2, seed 5 }; protocol paper { episodes 4, seed 5 }";
    project.write("tasks.msk", &format!("use \"lean.msk\"\nsuite bench {{ family f {{ lean }}; {protocols} }}\n"));
    let heading = |out: &str, more: &[&str]| {
        let done = eval(&project, out, more).succeeded();
        done.err.lines().next().unwrap_or_default().to_owned()
    };
    assert_eq!(heading("default", &[]), "1 task, 2 episodes each (protocol quick; there is also paper), seed 5, policy random");
    assert_eq!(
        heading("paper", &["--protocol", "paper"]),
        "1 task, 4 episodes each (protocol paper; there is also quick), seed 5, policy random"
    );
    assert_eq!(heading("other", &["--protocol", "paper", "--episodes", "1"]), "1 task, 1 episode each, seed 5, policy random");
    for (out, episodes) in [("default", 2), ("paper", 4), ("other", 1)] {
        assert_eq!(project.read(format!("{out}/episodes.jsonl")).lines().count(), episodes);
    }
    eval(&project, "none", &["--protocol", "papre"]).failed(1, &["has no protocol `papre`", "protocols are quick, paper"]);
    let alone = project.msk(&["eval", "lean.msk", "--protocol", "paper"]);
    alone.failed(1, &["`lean.msk` has no protocol `paper`", "hint: a suite declares one"]);
}

/// A suite of `lean`, which has no test, and of `shown`, which has one whose script ends in success.
pub fn half_shown() -> Project {
    let project = Project::lean();
    let shown = super::project::LEAN.replace("task lean", "task shown");
    let script =
        "    test \"shows\" {\n        at 0.1 s pose neutral\n        at 0.2 s pose neutral\n        expect success\n    }\n}\n";
    project.write("shown.msk", &format!("{}{script}", &shown[..shown.rfind('}').unwrap()]));
    project.write(
        "tasks.msk",
        "use \"lean.msk\"\nuse \"shown.msk\"\nsuite bench {\n    family a { lean }\n    family b { shown }\n}\n",
    );
    project
}

#[test]
fn a_task_that_the_policy_cannot_act_on_is_skipped_with_its_reason() {
    let project = half_shown();
    let arguments = ["eval", "tasks.msk", "--policy", "demonstration", "--episodes", "2", "--out", "out"];
    let done = project.msk(&arguments).succeeded();
    let reason = "skipped: no test of `lean` plays a script up to `expect success`";
    for text in [&done.err, &project.read("out/report.md")] {
        assert!(text.contains(reason), "{text}");
    }
    assert!(done.out.contains("skipped: no test of `lean` plays a script up to"), "{}", done.out);
    assert!(done.out.contains("of 2 tasks; played: 2 of 4 episodes, 1 task skipped"), "{}", done.out);
    assert!(done.out.contains("stabilization (1 of 2)") && done.out.contains("all tasks (1 of 2)"), "{}", done.out);
    assert!(done.err.lines().any(|row| row.starts_with("shown  ") && row.contains("of 2 succeeded")), "{}", done.err);
    let summary: Value = serde_json::from_str(&project.read("out/summary.json")).unwrap();
    assert_eq!(summary["tasks"][0]["skipped"], reason.replace("skipped: ", ""));
    assert_eq!(summary["tasks"][1]["episodes"], 2);
    // It is not finished less than it can be: again, and nothing is played.
    let lines = project.read("out/episodes.jsonl");
    assert!(project.msk(&arguments).succeeded().err.contains(reason));
    assert_eq!(project.read("out/episodes.jsonl"), lines);
}

#[test]
fn a_policy_that_can_act_on_no_task_fails() {
    let project = half_shown();
    let done = project.msk(&["eval", "lean.msk", "--policy", "demonstration", "--episodes", "2", "--out", "out"]);
    assert!(done.out.contains("skipped: no test of `lean`"), "{}", done.out);
    done.failed(1, &["policy `demonstration` supports none of the tasks", "hint:"]);
}

#[test]
fn each_task_has_its_row_as_it_ends() {
    let project = half_shown();
    let done = project.msk(&["eval", "tasks.msk", "--policy", "zero", "--episodes", "2", "--threads", "1"]).succeeded();
    let rows: Vec<&str> = done.err.lines().filter(|line| line.contains("of 2 succeeded")).collect();
    assert!(rows.len() == 2 && rows[0].starts_with("lean ") && rows[1].starts_with("shown "), "{}", done.err);
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
        let (sum, total) =
            (terms.values().map(|contribution| contribution.as_f64().unwrap()).sum::<f64>(), record["return"].as_f64().unwrap());
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
    let times = project.read("four/wall_times.jsonl");
    assert!(times.lines().count() == 6 && times.starts_with("{\"episode\":0,\"task\":\"lean\",\"wall_time\":"), "{times}");
    assert!(!project.path("four/early.jsonl").exists());
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
    eval(&project, "out", &["--seed", "6"]).failed(1, &["contains another run", "seed is 5, not 6", "hint:"]);
    project.write("lean.msk", &super::project::LEAN.replace("10    pose", "11    pose"));
    eval(&project, "out", &[]).failed(1, &["contains another run", "task `lean` has changed", "hint:"]);
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
    let fault = super::project::LEAN.replace("root { height on ground }", root).replace("task lean", "task flung");
    project.write("flung.msk", &fault);
    let suite = "use \"lean.msk\"\nuse \"flung.msk\"\nsuite both { family one { flung, lean } }\n";
    project.write("tasks.msk", suite);
    for policy in ["cmc", "random"] {
        let arguments = ["eval", "tasks.msk", "--policy", policy, "--episodes", "2", "--out", policy];
        let done = project.msk(&arguments).succeeded();
        assert!(done.out.contains("Fault in `flung`, episode 0: at 0 s"), "{}", done.out);
        assert!(project.read(format!("{policy}/report.md")).contains("Fault in `flung`, episode 1: at 0 s"));
        let lines = project.read(format!("{policy}/episodes.jsonl"));
        let records = lines.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        let (faults, sound): (Vec<_>, Vec<_>) = records.partition(|record| record["task"] == "flung");
        assert!(faults.len() == 2 && faults.iter().all(|record| record["fault"].is_string() && record["success"] == false));
        assert!(sound.len() == 2 && sound.iter().all(|record| record["fault"] == Value::Null && record["steps"] != 0));
    }
}

#[test]
fn results_that_somebody_changed_are_refused_and_stay_as_they_are() {
    let project = Project::lean();
    eval(&project, "out", &[]).succeeded();
    let lines = project.read("out/episodes.jsonl");
    let settings = project.read("out/run.json");
    let refused = |more: &[&str], parts: &[&str]| {
        let before = project.read("out/episodes.jsonl");
        eval(&project, "out", more).failed(1, &[parts, &["hint:"]].concat());
        assert_eq!(project.read("out/episodes.jsonl"), before);
    };
    project.write("out/episodes.jsonl", &lines.replacen("\"success\":", "\"success\": ", 1));
    refused(&[], &["out/episodes.jsonl`, line 1, was modified", "checksum"]);
    project.msk(&["run", "lean", "--replay", "out"]).failed(1, &["line 1", "checksum"]);
    project.write("out/episodes.jsonl", &lines);

    // Two journals in one.
    eval(&project, "other", &["--seed", "6"]).succeeded();
    let foreign = project.read("other/episodes.jsonl");
    project.write("out/episodes.jsonl", &format!("{lines}{}\n", foreign.lines().next().unwrap()));
    refused(&[], &["line 4, belongs to another run", "seed is 6, not 5"]);
    project.write("out/episodes.jsonl", &lines);

    // The settings of another run over these episodes, and none.
    project.write("out/run.json", &project.read("other/run.json"));
    refused(&["--seed", "6"], &["line 1, belongs to another run", "seed is 5, not 6"]);
    std::fs::remove_file(project.path("out/run.json")).unwrap();
    refused(&["--seed", "6"], &["contains episodes but no `run.json`"]);
    project.write("out/run.json", &settings);
    eval(&project, "out", &[]).succeeded();
    assert_eq!(project.read("out/episodes.jsonl"), lines);
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_whole_lines_and_the_run_goes_on_later() {
    let project = Project::lean();
    let arguments = ["eval", "tasks.msk", "--policy", "random", "--episodes", "12", "--threads", "2"];
    project.msk(&[&arguments[..], &["--out", "whole"]].concat()).succeeded();
    let script = "ulimit -f 16 && trap '' XFSZ && exec \"$0\" \"$@\"";
    let mut command = std::process::Command::new("sh");
    command.args(["-c", script, env!("CARGO_BIN_EXE_msk")]).args(arguments).args(["--out", "out"]);
    let done = super::project::Done::from(command.current_dir(project.path("")).output().unwrap());
    done.failed(1, &["cannot keep results in `out`", "because: cannot write `out/e", "hint: free some space"]);
    let kept = project.read("out/episodes.jsonl");
    assert!(kept.is_empty() || kept.ends_with('\n') && kept.lines().count() < 12, "{kept}");
    project.msk(&[&arguments[..], &["--out", "out"]].concat()).succeeded();
    assert!(project.read("out/episodes.jsonl").starts_with(&kept));
    assert_eq!(journal(&project.read("out/episodes.jsonl")), journal(&project.read("whole/episodes.jsonl")));
    assert_eq!(project.read("out/summary.json"), project.read("whole/summary.json"));
}

#[test]
fn episodes_become_a_page_for_each_task_and_results_stay_the_same() {
    let project = Project::lean();
    eval(&project, "plain", &[]).succeeded();
    let done = eval(&project, "shown", &["--html", "best,worst"]).succeeded();
    assert!(!done.err.contains("went another way"), "{}", done.err);
    assert_eq!(journal(&project.read("plain/episodes.jsonl")), journal(&project.read("shown/episodes.jsonl")));
    let one = eval(&project, "one", &["--html", "median"]).succeeded();
    assert!(one.out.contains("Results: one"));
    let [two, one] = ["shown/lean.html", "one/lean.html"].map(|page| project.read(page));
    assert!(two.len() > one.len() && two.contains("<title>lean, random</title>"), "{} and {} bytes", two.len(), one.len());
    eval(&project, "none", &["--html", "last"]).failed(2, &["worst, median, best"]);
}
