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
fn unseen_changes_and_the_table_are_told() {
    let project = tested();
    let done = project.msk(&["mutate", "tested.msk"]).succeeded();
    for part in [
        "tested.msk:19: weight: `10` -> `20` in `10    pose   = exp(-norm(independent.q - independent.neutral) / 1 rad)`\n",
        " changes unseen\n\n| change | all | checks | lints | tests | unseen |\n",
        "| comparison | 1 | 0 | ",
        "| all | ",
    ] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    assert_eq!(project.msk(&["mutate", "tested.msk"]).out, done.out);
    // Most changes of a task with one test go unseen.
    let strict = project.msk(&["mutate", "tested.msk", "--most", "10"]);
    assert_eq!((strict.code, strict.out), (Some(1), done.out));
}

#[test]
fn scenes_beginnings_and_channels_are_a_table_of_their_own_for_those_who_ask() {
    let project = tested();
    let meaning = project.msk(&["mutate", "tested.msk"]).succeeded().out;
    let all = project.msk(&["mutate", "tested.msk", "--surroundings"]).succeeded().out;
    assert!(!meaning.contains("surroundings") && all.contains(" changes of its surroundings unseen\n"), "{all}");
    let (_, tables) = meaning.split_once("\n\n").unwrap();
    assert!(all.contains(tables), "{all}");
    assert!(all.contains("\n| surroundings | all | checks | lints | tests | unseen |\n"), "{all}");
}

#[test]
fn every_change_is_a_line_for_machines() {
    let project = tested();
    let out = project.msk(&["mutate", "tested.msk", "--task", "lean", "--format", "json"]).succeeded().out;
    let lines: Vec<Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let flipped = lines.iter().find(|line| line["class"] == "comparison").unwrap();
    assert_eq!((&flipped["from"], &flipped["to"], &flipped["line"]), (&"<".into(), &">".into(), &24.into()));
    assert_eq!((&flipped["task"], &flipped["file"]), (&"lean".into(), &"tested.msk".into()));
    let known = ["checks", "lints", "tests", "unseen", "same"];
    assert!(lines.iter().all(|line| known.contains(&line["noticed"].as_str().unwrap())), "{out}");
    assert!(lines.iter().any(|line| line["noticed"] == "checks" && line["by"].as_str().unwrap().starts_with('E')), "{out}");
}

#[test]
fn what_cannot_be_changed_is_refused() {
    let project = tested();
    project.msk(&["mutate", "tested.msk", "--task", "walk"]).failed(1, &["there is no task `walk`", "there are: lean"]);
    project.msk(&["mutate", "none.msk"]).failed(1, &["none.msk"]);
}
