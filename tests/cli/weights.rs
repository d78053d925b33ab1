//! `msk weights`.

use crate::project::{LEAN, Project};
use serde_json::Value;

#[test]
fn weights_are_listed() {
    let project = Project::lean();
    let done = project.msk(&["weights", "list", "lean.msk"]).succeeded();
    assert_eq!(done.out, "lean.pose    10  above 0\nlean.alive    5  above 0\nlean.effort  -1  below 0\n");
    let done = project.msk(&["weights", "list", "lean.msk", "--json"]).succeeded();
    let listed: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(listed[2]["weight"], -1.0);
}

#[test]
fn a_weight_is_set_and_reset_and_every_other_byte_stays() {
    let project = Project::lean();
    let done = project.msk(&["weights", "set", "lean.msk", "pose=11.5", "effort=-0.5", "--dry-run"]).succeeded();
    assert!(done.out.contains("lean.pose: 10 -> 11.5 (+15.0 %)") && done.out.contains("dry run"), "{}", done.out);
    assert_eq!(project.read("lean.msk"), LEAN);
    let done = project.msk(&["weights", "set", "lean.msk", "pose=11.5", "effort=-0.5", "--json"]).succeeded();
    let report: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!((&report["applied"], &report["changes"][1]["to"]), (&Value::from(true), &Value::from(-0.5)));
    assert_eq!(project.read("lean.msk"), LEAN.replace("10    pose", "11.5    pose").replace("-1    effort", "-0.5    effort"));
    project.msk(&["weights", "scale", "lean.msk", "2", "pose"]).succeeded();
    assert!(project.read("lean.msk").contains("23    pose"));
    project.msk(&["weights", "reset", "lean.msk"]).succeeded();
    assert_eq!(project.read("lean.msk"), LEAN);
}

#[test]
fn what_may_not_be_is_refused_as_a_whole() {
    let project = Project::lean();
    let done = project.msk(&["weights", "set", "lean.msk", "pose=11", "efort=-0.5", "alive=-5"]);
    done.failed(1, &["nothing was changed", "did you mean `effort`?", "lean.alive may not become -5"]);
    project.msk(&["weights", "set", "lean.msk", "pose"]).failed(2, &["term=weight"]);
    assert_eq!(project.read("lean.msk"), LEAN);
}

#[test]
fn weights_are_normalized_inside_a_scope() {
    let project = Project::lean();
    project.msk(&["weights", "normalize", "lean.msk", "--norm", "30", "--outside", "effort"]).succeeded();
    let text = project.read("lean.msk");
    assert!(text.contains("20    pose") && text.contains("10    alive") && text.contains("-1    effort"), "{text}");
}
