//! `msk explain`.

use super::project::Project;
use serde_json::Value;

#[test]
fn a_task_is_reported_as_text_data_tables_and_page() {
    let project = Project::lean();
    let done = project.msk(&["explain", "lean"]).succeeded();
    assert!(done.out.contains("Initial state: on the ground") && done.out.contains("at reset the reward is"), "{}", done.out);

    let done = project.msk(&["explain", "lean", "--format", "json"]).succeeded();
    let accounts: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!((&accounts[0]["form"], &accounts[0]["name"]), (&Value::from(1), &Value::from("lean")));
    assert_eq!(accounts[0]["phases"][0]["terms"][1]["formula"]["latex"], r"\mathbb{I}(\lnot \mathit{terminated})");
    assert!(accounts[0]["phases"][0]["terms"][0]["at_reset"].as_f64().unwrap() > 0.5);

    let done = project.msk(&["explain", "lean.msk@lean", "--format", "latex"]).succeeded();
    assert!(done.out.starts_with("\\documentclass") && done.out.ends_with("\\end{document}\n"));

    project.msk(&["explain", "--format", "html", "--out", "page.html"]).succeeded();
    let page = project.read("page.html");
    assert!(page.contains("<math>") && page.contains("id=\"lean\"") && !page.contains("http"), "{page}");
}

#[test]
fn an_unknown_task_is_refused_with_those_that_there_are() {
    let project = Project::lean();
    project.msk(&["explain", "lean.msk@leen"]).failed(1, &["there is no task `leen`", "there are: lean"]);
}
