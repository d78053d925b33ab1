//! `msk check` and `msk explain`.

use super::project::{LEAN, Project};
use serde_json::Value;

#[test]
fn a_sound_file_passes() {
    let project = Project::lean();
    let done = project.msk(&["check", "tasks.msk", "lean.msk"]).succeeded();
    assert_eq!(done.out.lines().filter(|line| line.contains("1 task")).count(), 2, "{}", done.out);
}

#[test]
fn all_errors_of_all_files_come_in_one_run() {
    let project = Project::lean();
    project.write("names.msk", &LEAN.replace("pelvis.height", "pelviss.height").replace("pose neutral", "pose nuetral"));
    project.write("units.msk", &LEAN.replace("/ 1 rad", ""));
    let done = project.msk(&["check", "names.msk", "lean.msk", "units.msk"]);
    assert_eq!(done.code, Some(1));
    for part in ["pelviss", "nuetral", "names.msk:", "units.msk:"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    assert!(done.out.contains("lean.msk: 1 task"), "{}", done.out);
}

#[test]
fn json_has_codes_places_and_edits() {
    let project = Project::empty();
    project.write("units.msk", &LEAN.replace("/ 1 rad", ""));
    let done = project.msk(&["check", "--format", "json", "units.msk"]);
    assert_eq!(done.code, Some(1));
    let report: Value = serde_json::from_str(&done.out).unwrap();
    let diagnostic = &report["diagnostics"][0];
    assert!(diagnostic["code"].as_str().unwrap().starts_with('E'), "{report}");
    assert_eq!(diagnostic["labels"][0]["place"]["file"], "units.msk");
    assert_eq!(diagnostic["labels"][0]["place"]["start"]["line"], 19);
}

#[test]
fn an_allow_of_what_only_the_model_shows_is_judged_where_the_model_is_looked_at() {
    let project = Project::lean();
    project.write(
        "lean.msk",
        &LEAN.replace("family   stabilization", "family   stabilization\n    allow starts_inside \"on purpose\""),
    );
    let probed = project.msk(&["check", "lean.msk"]).succeeded();
    assert!(
        probed.out.contains("warning[W0513 unfulfilled_allow]: `starts_inside` has no warning here to allow"),
        "{}",
        probed.out
    );
    let unprobed = project.msk(&["check", "--no-probe", "lean.msk"]).succeeded();
    assert!(unprobed.out.contains("no errors, no warnings"), "{}", unprobed.out);
}

/// A task with a warning that compiling finds (W0505), and one that takes the body (W0530).
fn warned() -> Project {
    let project = Project::lean();
    let deep = LEAN.replace("height on ground", "height 0.85 m").replace("task lean", "task deep");
    project.write("deep.msk", &deep.replace("reward {", "reward {\n        1 slow = -com.speed / 1 m/s"));
    project
}

#[test]
fn a_warning_that_is_denied_is_an_error_and_says_by_what() {
    let project = warned();
    project.msk(&["check", "--no-play", "deep.msk"]).succeeded();
    let denied = project.msk(&["check", "--no-play", "--deny", "warnings", "deep.msk"]);
    assert_eq!(denied.code, Some(1), "{}", denied.out);
    for part in ["error[W0505 hidden_sign]", "error[W0530 starts_inside]", "a warning, denied by `--deny warnings`"] {
        assert!(denied.out.contains(part), "no `{part}` in {}", denied.out);
    }
    let json = project.msk(&["check", "--no-play", "--format", "json", "--deny", "hidden-sign", "deep.msk"]);
    let report: Value = serde_json::from_str(&json.out).unwrap();
    let diagnostics = report["diagnostics"].as_array().unwrap();
    let by_lint = |lint: &str| diagnostics.iter().find(|diagnostic| diagnostic["lint"] == lint).unwrap();
    assert_eq!((json.code, &by_lint("hidden_sign")["severity"]), (Some(1), &Value::from("error")));
    assert_eq!(by_lint("hidden_sign")["denied_by"], "--deny hidden-sign");
    assert_eq!(by_lint("starts_inside")["severity"], "warning");
}

#[test]
fn test_and_eval_deny_and_allow_what_compiling_finds() {
    let project = warned();
    for command in [["test", "deep.msk"], ["eval", "deep.msk"]] {
        let denied = project.msk(&[command[0], "--deny", "hidden_sign", command[1]]);
        assert_eq!(denied.code, Some(1), "{}", denied.err);
        assert!(denied.err.contains("error[W0505 hidden_sign]"), "{}", denied.err);
        assert!(denied.out.is_empty() && !project.path("results").exists(), "nothing is played: {}", denied.out);
    }
    let allowed = project.msk(&["test", "--allow", "hidden_sign", "deep.msk"]);
    assert!(!allowed.err.contains("W0505"), "{}", allowed.err);
    assert!(project.msk(&["test", "deep.msk"]).err.contains("warning[W0505 hidden_sign]"));
}

#[test]
fn the_last_level_of_a_lint_holds_whatever_option_sets_it() {
    let project = warned();
    let codes = |options: &[&str]| {
        let done = project.msk(&[&["check", "--no-play"], options, &["--allow", "holds_at_reset", "deep.msk"]].concat());
        let heads: Vec<String> =
            done.out.lines().filter_map(|line| line.split_once(']')).map(|(head, _)| head.to_owned()).collect();
        (done.code, heads.into_iter().filter(|head| head.contains("[W")).collect::<Vec<_>>())
    };
    let (sign, inside) = ("[W0505 hidden_sign", "[W0530 starts_inside");
    let expected = |sign_as: &str, inside_as: &str| -> Vec<String> {
        let both = [(inside_as, inside), (sign_as, sign)];
        both.iter().filter(|(word, _)| !word.is_empty()).map(|(word, head)| format!("{word}{head}")).collect()
    };
    assert_eq!(codes(&["--deny", "warnings", "--allow", "starts_inside"]), (Some(1), expected("error", "")));
    assert_eq!(codes(&["--allow", "starts_inside", "--deny", "warnings"]), (Some(1), expected("error", "error")));
    assert_eq!(codes(&["--deny", "warnings", "--warn", "W0505", "--allow", "w0530"]), (Some(0), expected("warning", "")));
    assert_eq!(codes(&["--allow", "warnings"]), (Some(0), expected("", "")));
}

#[test]
fn a_task_is_played_at_rest_unless_it_shall_not_be() {
    let project = Project::lean();
    // Twenty steps are over before anybody falls.
    project.write("idle.msk", &LEAN.replace("task lean", "task idle").replace("- 2 cm", "- 50 cm"));
    let played = project.msk(&["check", "idle.msk"]).succeeded();
    assert!(played.out.contains("warning[W0538 rest_succeeds]: doing nothing succeeds"), "{}", played.out);
    for option in ["--no-play", "--no-probe"] {
        let unplayed = project.msk(&["check", option, "idle.msk"]).succeeded();
        assert!(!unplayed.out.contains("W0538"), "{option}: {}", unplayed.out);
    }
}

#[test]
fn a_level_of_no_lint_is_a_wrong_command_line() {
    let project = warned();
    project
        .msk(&["check", "--deny", "hiden_sign", "deep.msk"])
        .failed(2, &["there is no lint `hiden_sign`; did you mean `hidden_sign`?"]);
    project.msk(&["check", "--allow", "everything", "deep.msk"]).failed(2, &["msk help lints"]);
}

#[test]
fn an_explanation_tells_terms_weights_and_values_at_reset() {
    let project = Project::lean();
    let done = project.msk(&["explain", "lean"]).succeeded();
    for part in ["lean", "stabilization", "pose", "alive", "effort", "sunk", "pelvis.height", "hash"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    assert!(done.out.contains("at reset"), "{}", done.out);
}

#[test]
fn fixes_that_are_surely_meant_are_applied() {
    let project = Project::lean();
    project.write("lean.msk", &LEAN.replace("- 2 cm", "\u{2212} 2cm").replace("0.02 rad", "0.02rad"));
    let done = project.msk(&["check", "--fix", "lean.msk"]).succeeded();
    assert!(done.err.contains("fixes applied"), "{}", done.err);
    assert_eq!(project.read("lean.msk"), LEAN);
    // What needs a decision stays as it is.
    project.write("lean.msk", &LEAN.replace("pelvis.height }", "pelvi.height }"));
    assert_eq!(project.msk(&["check", "--fix", "lean.msk"]).code, Some(1));
    assert!(project.read("lean.msk").contains("pelvi.height"));
}

#[test]
fn tasks_are_begun_on_their_bodies_unless_they_shall_not_be() {
    let project = Project::lean();
    project.write("deep.msk", &LEAN.replace("height on ground", "height 0.85 m").replace("task lean", "task deep"));
    let probed = project.msk(&["check", "deep.msk"]).succeeded();
    assert!(probed.out.contains("warning[W0530 starts_inside]") && probed.out.contains("penetrates"), "{}", probed.out);
    let unprobed = project.msk(&["check", "--no-probe", "deep.msk"]).succeeded();
    assert!(unprobed.out.contains("no errors, no warnings"), "{}", unprobed.out);
}
