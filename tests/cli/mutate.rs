//! `msk mutate`.

use super::project::{LEAN, Project};
use serde_json::Value;

/// The lean task with a test of its end.
fn tested() -> Project {
    let project = Project::empty();
    let end = LEAN.rfind('}').unwrap();
    let test = "test \"sinks\" { moment low { pose neutral { root.height = 0.3 m } }; expect ended by sunk at low }";
    project.write("tested.msk", &format!("{}{test}\n}}\n", &LEAN[..end]));
    project
}

#[test]
fn survivors_and_the_table_are_printed() {
    let project = tested();
    let done = project.msk(&["mutate", "tested.msk"]).succeeded();
    for part in [
        "tested.msk:19: weight: `10` -> `20` in `10    pose   = exp(-norm(independent.q - independent.neutral) / 1 rad)`\n",
        " mutants survived\n\n| mutation | all | killed by checks | by lints | by tests | survived |\n",
        "| comparison | 1 | 0 | ",
        "| all | ",
    ] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    assert_eq!(project.msk(&["mutate", "tested.msk"]).out, done.out);
    // Most mutants of a task with one test survive.
    let strict = project.msk(&["mutate", "tested.msk", "--max-survivors", "10"]);
    assert_eq!((strict.code, strict.out), (Some(1), done.out));
}

#[test]
fn scene_initial_state_and_observation_have_a_table_and_a_bound_of_their_own() {
    let project = tested();
    let meaning = project.msk(&["mutate", "tested.msk"]).succeeded().out;
    let all = project.msk(&["mutate", "tested.msk", "--include-scene"]).succeeded().out;
    assert!(
        !meaning.contains("observation") && all.contains(" mutants of scene, initial state and observation survived\n"),
        "{all}"
    );
    let (_, tables) = meaning.split_once("\n\n").unwrap();
    assert!(all.contains(tables), "{all}");
    assert!(all.contains("\n| mutated | all | killed by checks | by lints | by tests | survived |\n"), "{all}");
    let bounded = |most| project.msk(&["mutate", "tested.msk", "--include-scene", "--max-scene-survivors", most]);
    assert_eq!((bounded("100").code, bounded("10").code), (Some(0), Some(1)));
    project.msk(&["mutate", "tested.msk", "--max-scene-survivors", "10"]).failed(2, &["--include-scene"]);
}

#[test]
fn every_mutant_is_a_line_for_machines() {
    let project = tested();
    let out = project.msk(&["mutate", "tested.msk", "--task", "lean", "--format", "json"]).succeeded().out;
    let lines: Vec<Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let flipped = lines.iter().find(|line| line["class"] == "comparison").unwrap();
    assert_eq!((&flipped["from"], &flipped["to"], &flipped["line"]), (&"<".into(), &">".into(), &24.into()));
    assert_eq!((&flipped["task"], &flipped["file"]), (&"lean".into(), &"tested.msk".into()));
    let known = ["killed", "survived", "equivalent"];
    assert!(lines.iter().all(|line| known.contains(&line["outcome"].as_str().unwrap())), "{out}");
    assert!(lines.iter().all(|line| (line["outcome"] == "killed") == line["killed_by"].is_string()), "{out}");
    assert!(lines.iter().any(|line| line["killed_by"] == "checks" && line["by"].as_str().unwrap().starts_with('E')), "{out}");
}

#[test]
fn what_cannot_be_mutated_is_rejected() {
    let project = tested();
    project.msk(&["mutate", "tested.msk", "--task", "walk"]).failed(1, &["there is no task `walk`", "there are: lean"]);
    project.msk(&["mutate", "none.msk"]).failed(1, &["none.msk"]);
}

#[test]
fn former_options_are_answered_with_the_present_ones() {
    let project = tested();
    project.msk(&["mutate", "tested.msk", "--most", "1"]).failed(2, &["'--most'", "`--most` is now `--max-survivors`"]);
    let surroundings = project.msk(&["mutate", "tested.msk", "--surroundings"]);
    surroundings.failed(2, &["`--surroundings` is now `--include-scene`"]);
    project.msk(&["run", "lean", "--past-ends"]).failed(2, &["`--past-ends` is now `--ignore-terminations`"]);
}
