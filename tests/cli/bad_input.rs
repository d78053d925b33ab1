//! Whatever comes in: one clear message, a non-zero exit, no panic, and nothing lost.

use super::project::{LEAN, Project};

/// The commands that read a task file.
const READERS: [&[&str]; 3] =
    [&["eval", "FILE", "--policy", "zero", "--out", "out"], &["run", "FILE", "--policy", "zero"], &["explain", "FILE"]];

fn every_reader_fails(project: &Project, file: &str, parts: &[&str]) {
    for arguments in READERS {
        let arguments: Vec<&str> = arguments.iter().map(|&word| if word == "FILE" { file } else { word }).collect();
        project.msk(&arguments).failed(1, parts);
    }
    let check = project.msk(&["check", file]);
    assert_eq!(check.code, Some(1), "{check:?}");
    for part in parts {
        assert!(check.out.contains(part), "no `{part}` in {}", check.out);
    }
    assert!(!project.path("out").exists(), "nothing is written for a task that cannot run");
}

#[test]
fn a_missing_file() {
    every_reader_fails(&Project::empty(), "none.msk", &["none.msk", "there is no file"]);
}

#[test]
fn a_folder_in_place_of_a_file() {
    let project = Project::empty();
    project.write("tasks.msk/inner", "");
    every_reader_fails(&project, "tasks.msk", &["tasks.msk"]);
}

#[test]
fn a_file_that_is_no_text() {
    let project = Project::empty();
    std::fs::write(project.path("noise.msk"), [0xff, 0x00, 0xfe, 0x12]).unwrap();
    every_reader_fails(&project, "noise.msk", &["noise.msk", "UTF-8"]);
}

#[test]
fn broken_syntax() {
    let project = Project::empty();
    project.write("broken.msk", &LEAN.replace("exp(-norm(", "exp(-norm(("));
    every_reader_fails(&project, "broken.msk", &["error[E01", "broken.msk:19"]);
}

#[test]
fn unknown_names() {
    let project = Project::empty();
    project.write("names.msk", &LEAN.replace("pelvis.height", "pelvos.height"));
    every_reader_fails(&project, "names.msk", &["error[E02", "pelvos", "pelvis"]);
}

#[test]
fn a_wrong_unit() {
    let project = Project::empty();
    project.write("units.msk", &LEAN.replace("/ 1 rad", "/ 1 m"));
    every_reader_fails(&project, "units.msk", &["error[E03", "units.msk:19"]);
}

#[test]
fn an_unknown_body() {
    let project = Project::empty();
    project.write("bodies.msk", &LEAN.replace("body     human", "body     humon"));
    every_reader_fails(&project, "bodies.msk", &["humon"]);
}

/// A body of one's own, bound to a model of the given text.
fn with_model(model: &str) -> Project {
    let project = Project::empty();
    project.write("lean.msk", &LEAN.replace("body     human", "body     puppet"));
    let body = "body puppet {\n    model \"puppet.xml\"\n    root \"torso\" { forward x, up z }\n    pose neutral { }\n}\n";
    project.write("bodies/puppet.msk", body);
    project.write("bodies/puppet.xml", model);
    project
}

#[test]
fn a_model_that_is_no_xml() {
    every_reader_fails(&with_model("not a model"), "lean.msk", &["puppet"]);
}

#[test]
fn a_model_nested_without_end() {
    let deep = format!("<mujoco><worldbody>{}", "<body>".repeat(100_000));
    every_reader_fails(&with_model(&deep), "lean.msk", &["puppet"]);
}

#[test]
fn a_model_that_includes_itself() {
    every_reader_fails(&with_model("<mujoco><include file=\"puppet.xml\"/></mujoco>"), "lean.msk", &["puppet"]);
}

#[test]
fn a_model_with_numbers_that_mean_nothing() {
    let model = "<mujoco><worldbody><body name=\"torso\"><freejoint/><geom size=\"1e999\"/></body></worldbody></mujoco>";
    every_reader_fails(&with_model(model), "lean.msk", &["puppet"]);
}

#[test]
fn a_missing_model() {
    let project = with_model("");
    std::fs::remove_file(project.path("bodies/puppet.xml")).unwrap();
    every_reader_fails(&project, "lean.msk", &["puppet.xml"]);
}

#[test]
fn a_folder_for_results_that_cannot_be_made() {
    let project = Project::lean();
    project.write("file", "");
    let arguments = ["eval", "tasks.msk", "--policy", "zero", "--out", "file/results"];
    project.msk(&arguments).failed(1, &["cannot keep results in `file/results`", "because:", "hint:"]);
    project.write("results", "in the way of the usual folder");
    project.msk(&["eval", "tasks.msk", "--policy", "zero"]).failed(1, &["cannot keep results in `results", "hint:"]);
}

#[test]
fn an_unknown_policy() {
    let project = Project::lean();
    project.msk(&["eval", "tasks.msk", "--policy", "perfect"]).failed(1, &["no policy `perfect`", "zero", "random"]);
    assert!(!project.path("results").exists());
}

#[test]
fn wrong_use_of_the_command_line() {
    let project = Project::lean();
    for arguments in [
        &["eval", "tasks.msk", "--episodes", "0"][..],
        &["eval", "tasks.msk", "--episodes", "many"],
        &["eval", "tasks.msk", "--threads", "0"],
        &["eval", "tasks.msk", "--threads", "1000000"],
        &["eval", "tasks.msk", "--seed", "-1"],
        &["eval", "tasks.msk", "--task"],
        &["dance"],
        &["check"],
    ] {
        project.msk(arguments).failed(2, &[]);
    }
}

#[test]
fn an_episode_of_which_too_much_would_be_kept_is_refused_before_it_begins() {
    let project = Project::empty();
    project.write("long.msk", &LEAN.replace("horizon  20 steps", "horizon  100000000 steps"));
    let commands: [&[&str]; 6] = [
        &["run", "long.msk", "--policy", "zero", "--trace", "long.npz"],
        &["run", "long.msk", "--policy", "zero", "--actions", "long.npy"],
        &["run", "long.msk", "--policy", "zero", "--html", "long.html"],
        &["eval", "long.msk", "--policy", "zero", "--episodes", "1", "--trace", "--out", "out"],
        &["collect", "long.msk", "--policy", "zero", "--episodes", "1", "--out", "data"],
        &["session", "init", "long.msk", "try", "--hold", "10", "--decisions", "100000"],
    ];
    for command in commands {
        project.msk(command).failed(1, &["an episode of `lean` may have 100000000 control steps", "at most 4 GiB"]);
    }
    // What keeps nothing of a step may last as long as it likes.
    project.msk(&["run", "long.msk", "--policy", "zero"]).succeeded();
}
