//! `msk eval --shard` and `msk merge`: parts of an evaluation become what one machine would have written.

use super::eval::half_shown;
use super::project::{Done, Project};

/// What has the same bytes wherever it is played.
const SAME: [&str; 4] = ["run.json", "episodes.jsonl", "summary.json", "report.md"];

fn eval(project: &Project, out: &str, more: &[&str]) -> Done {
    let usual = ["eval", "tasks.msk", "--policy", "random", "--episodes", "5", "--out", out];
    project.msk(&[&usual, more].concat())
}

/// Shards in the folders `one`, `two` and `three`.
fn play_shards(project: &Project) {
    for (number, out) in (1..).zip(["one", "two", "three"]) {
        let done = eval(project, out, &["--shard", &format!("{number}/3")]).succeeded();
        assert!(
            done.err.lines().next().is_some_and(|heading| heading.contains(&format!(", shard {number}/3, seed"))),
            "{}",
            done.err
        );
    }
}

fn merge(project: &Project, shards: &[&str], out: &str) -> Done {
    project.msk(&[&["merge"], shards, &["--out", out]].concat())
}

#[test]
fn merged_shards_have_the_bytes_of_one_machine() {
    // One of the two tasks is skipped by the policy; the other one has a trace of its first episodes.
    for policy in ["random", "demonstration"] {
        let project = half_shown();
        let command = |out: &str, shard: &[&str]| {
            let usual = ["eval", "tasks.msk", "--policy", policy, "--episodes", "5", "--trace", "--out", out];
            project.msk(&[&usual, shard].concat()).succeeded()
        };
        command("whole", &[]);
        for (number, out) in (1..).zip(["one", "two", "three"]) {
            command(out, &["--shard", &format!("{number}/3")]);
        }
        let done = merge(&project, &["three", "one", "two"], "merged").succeeded();
        for file in SAME {
            assert_eq!(project.read(format!("merged/{file}")), project.read(format!("whole/{file}")), "{policy}: {file}");
        }
        let lines = |file: &str| project.read(file).lines().count();
        assert_eq!(lines("merged/wall_times.jsonl"), lines("whole/wall_times.jsonl"));
        let traces = |folder: &str| -> Vec<_> {
            let entries = std::fs::read_dir(project.path(folder)).unwrap();
            let mut traces: Vec<_> = entries
                .map(|entry| entry.unwrap())
                .map(|entry| (entry.file_name(), std::fs::read(entry.path()).unwrap()))
                .collect();
            traces.sort();
            traces
        };
        assert!(!traces("whole/traces").is_empty() && traces("merged/traces") == traces("whole/traces"));
        assert!(done.out.contains(&format!("{} episodes from 3 shards", lines("whole/episodes.jsonl"))), "{}", done.out);
        // It is the whole run: nothing is left to be played.
        let again = command("merged", &[]);
        assert!(again.err.contains("resuming `merged`"), "{}", again.err);
        assert_eq!(project.read("merged/episodes.jsonl"), project.read("whole/episodes.jsonl"));
    }
}

#[test]
fn shards_may_overlap_and_are_not_mixed() {
    let project = Project::lean();
    eval(&project, "whole", &[]).succeeded();
    play_shards(&project);
    merge(&project, &["one", "two", "three", "one"], "twice").succeeded();
    merge(&project, &["two", "whole"], "overlapping").succeeded();
    for merged in ["twice", "overlapping"] {
        assert_eq!(project.read(format!("{merged}/episodes.jsonl")), project.read("whole/episodes.jsonl"));
    }
    eval(&project, "one", &["--shard", "2/3"]).failed(1, &["`one` contains another run: its shard is 1/3, not 2/3", "hint:"]);
    eval(&project, "one", &[]).failed(1, &["`one` contains another run: its shard is 1/3, not none"]);
    let done = project.msk(&["eval", "tasks.msk", "--policy", "random", "--shard", "2/3"]).succeeded();
    assert!(done.out.contains("Results: results/lean-random-shard-2-of-3-1"), "{}", done.out);
}

#[test]
fn a_shard_without_an_episode_is_refused() {
    let project = Project::lean();
    eval(&project, "none", &["--shard", "1000/1000000"]).failed(2, &["shard 1000/1000000 has none of the episodes", "hint:"]);
    assert!(!project.path("none").exists());
}

#[cfg(unix)]
#[test]
fn no_trace_is_left_out_silently() {
    let project = Project::lean();
    for (shard, out) in [("1/3", "one"), ("2/3", "two"), ("3/3", "three")] {
        eval(&project, out, &["--shard", shard, "--trace=rewards"]).succeeded();
    }
    let elsewhere = project.path("elsewhere");
    std::fs::rename(project.path("two/traces"), &elsewhere).unwrap();
    std::os::unix::fs::symlink(&elsewhere, project.path("two/traces")).unwrap();
    merge(&project, &["one", "two", "three"], "merged").failed(1, &["two", "leads out of the folder"]);
}

#[test]
fn what_is_not_one_run_is_not_merged() {
    let project = Project::lean();
    play_shards(&project);
    let refused = |shards: &[&str], parts: &[&str]| {
        merge(&project, shards, "merged").failed(1, &[parts, &["hint:"]].concat());
        assert!(!project.path("merged").exists());
    };
    refused(
        &["one", "three"],
        &["2 of 5 episodes are missing, such as episode 1 of `lean`", "its `--shard` and `--out` resumes"],
    );
    eval(&project, "other", &["--shard", "2/3", "--seed", "6"]).succeeded();
    refused(&["one", "other"], &["`other` contains another run than `one`: its seed is 6, not 5"]);
    refused(&["one", "nowhere"], &["cannot keep results in `nowhere`"]);
    std::fs::create_dir(project.path("empty")).unwrap();
    refused(&["one", "empty"], &["`empty` contains no results: it has no `run.json`"]);
    project.msk(&["merge", "one", "two", "three"]).failed(2, &["--out <DIR>"]);
    merge(&project, &["one", "two", "three"], "two").failed(1, &["cannot make the folder `two`"]);
    for shard in ["0/3", "4/3", "third"] {
        eval(&project, "bad", &["--shard", shard])
            .failed(2, &["expected NUMBER/COUNT with a number from 1 to the count, as in 2/5"]);
    }

    let summary = project.read("two/summary.json");
    std::fs::remove_file(project.path("two/summary.json")).unwrap();
    refused(&["one", "two", "three"], &["`two` has no `summary.json` that can be read: there is no such file"]);
    project.write("two/summary.json", "{");
    refused(&["one", "two", "three"], &["`two` has no `summary.json` that can be read"]);
    project.write("two/summary.json", &summary);

    let lines = project.read("one/episodes.jsonl");
    let reversed: Vec<&str> = lines.lines().rev().collect();
    project.write("one/episodes.jsonl", &(reversed.join("\n") + "\n"));
    refused(&["one", "two", "three"], &["`one` contains episode 0 of `lean` behind later ones"]);
    project.write("one/episodes.jsonl", &lines.replacen("\"success\":", "\"success\": ", 1));
    refused(&["one", "two", "three"], &["one/episodes.jsonl`, line 1, was modified"]);
}
