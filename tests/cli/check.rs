//! `msk check` and `msk explain`.

use crate::project::{LEAN, Project};
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
    assert!(probed.out.contains("warning[W0513 unfulfilled_allow]: nothing here causes `starts_inside`"), "{}", probed.out);
    let unprobed = project.msk(&["check", "--no-probe", "lean.msk"]).succeeded();
    assert!(unprobed.out.contains("nothing to remark"), "{}", unprobed.out);
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
    assert!(probed.out.contains("warning[W0530 starts_inside]") && probed.out.contains("mm inside"), "{}", probed.out);
    let unprobed = project.msk(&["check", "--no-probe", "deep.msk"]).succeeded();
    assert!(unprobed.out.contains("nothing to remark"), "{}", unprobed.out);
}
