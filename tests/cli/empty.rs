//! A run of nothing is no success: files, filters and suites that come to no task or test fail with the reason.

use super::project::{LEAN, Project};

#[test]
fn a_file_that_declares_nothing() {
    let project = Project::lean();
    project.write("empty.msk", "// nothing yet\n");
    let done = project.msk(&["check", "empty.msk", "lean.msk"]).failed(1, &["`empty.msk` declares nothing", "task NAME"]);
    assert!(done.out.contains("lean.msk: 1 task"), "the other file is checked all the same: {}", done.out);
    for arguments in [&["eval", "empty.msk", "--out", "out"][..], &["test", "empty.msk"], &["explain", "empty.msk"]] {
        project.msk(arguments).failed(1, &["task"]);
    }
    assert!(!project.path("out").exists());
}

#[test]
fn a_library_is_checked_as_one() {
    let project = Project::empty();
    project.write("lib.msk", "fn half(x) = x / 2\n");
    let done = project.msk(&["check", "lib.msk"]).succeeded();
    assert_eq!(done.out, "lib.msk: a library without tasks: no errors, no warnings\n");
    project.write("lib.msk", "fn half(x) = x / 2\nfn half(y) = y / 2\n");
    let done = project.msk(&["check", "lib.msk"]);
    assert!(done.code == Some(1) && done.out.contains("`half` is declared twice"), "{done:?}");
}

#[test]
fn a_task_that_is_not_there() {
    let project = Project::lean();
    project.msk(&["eval", "--task", "laen", "--out", "out"]).failed(1, &["there is no task `laen`", "lean"]);
    project.msk(&["mutate", "lean.msk", "--task", "laen"]).failed(1, &["there is no task `laen`", "lean"]);
    assert!(!project.path("out").exists());
}

#[test]
fn a_suite_that_names_what_is_not_there() {
    let project = Project::lean();
    for (suite, message) in [
        ("suite w { family f { laen } }", "undefined task `laen`"),
        ("suite w { family f { } }", "the family `f` lists no task"),
        ("suite w { }", "the suite `w` lists no task"),
    ] {
        project.write("suite.msk", &format!("use \"lean.msk\"\n{suite}\n"));
        project.msk(&["eval", "suite.msk", "--policy", "zero", "--out", "out"]).failed(1, &[message]);
        // A suite that is used by another file is held to the same.
        project.write("outer.msk", "use \"suite.msk\"\nuse \"lean.msk\"\nconst x = 1\n");
        let done = project.msk(&["check", "outer.msk"]);
        assert!(done.code == Some(1) && done.out.contains(message), "{done:?}");
    }
}

#[test]
fn a_folder_without_texts_and_a_file_without_weights() {
    let project = Project::empty();
    project.msk(&["fmt", "--check"]).failed(1, &["there is no `.msk` file in `.`"]);
    project.write("lib.msk", "fn half(x) = x / 2\n");
    for command in ["list", "scale", "reset"] {
        let mut arguments = vec!["weights", command, "lib.msk"];
        arguments.extend((command == "scale").then_some("2"));
        project.msk(&arguments).failed(1, &["`lib.msk` contains no weights"]);
    }
}

#[test]
fn a_table_that_is_cut_behind_its_headings() {
    let project = Project::lean();
    let task = LEAN.replace("    init {", "    reference gait = motion \"walk.csv\"\n\n    init {");
    project.write("lean.msk", &task.replace("pose neutral", "pose gait"));
    project.write("walk.csv", "# name: walk\n# source: made up\n# cycle: yes\n# duration: 1 s\nphase, hip_flexion_r [deg]\n");
    for command in ["check", "test"] {
        let done = project.msk(&[command, "tasks.msk"]);
        assert_eq!(done.code, Some(1), "{done:?}");
        assert!(format!("{}{}", done.out, done.err).contains("a cycle has at least four rows, found 0"), "{done:?}");
    }
}

#[test]
fn a_rollout_without_a_step_is_refused() {
    let project = Project::lean();
    project.msk(&["run", "lean", "--policy", "zero", "--actions", "zero.npy"]).succeeded();
    let rollout = ["physics", "rollout", "--ctrl", "zero.npy", "--steps", "0", "--out", "out.npz"];
    project.msk(&rollout).failed(1, &["there is no step to take: zero.npy has 17 rows", "hint:"]);
    assert!(!project.path("out.npz").exists());
}
