//! `msk session`: direct control.

use super::project::Project;
use serde_json::Value;

/// The names of the entries of an action, and the number of the decision.
fn visible(project: &Project, decision: usize) -> Value {
    serde_json::from_str(&project.read(format!("try/decision-{decision:03}.json"))).unwrap()
}

#[test]
fn a_session_takes_actions_and_goes_the_same_way_each_time() {
    let project = Project::lean();
    let begun = project.msk(&["session", "init", "lean", "try", "--hold", "0.05", "--decisions", "3"]).succeeded();
    assert!(
        begun.out.contains("lean: 0 of 3 decisions") && begun.out.contains("waits for the answer to decision-000.json"),
        "{}",
        begun.out
    );
    let first = visible(&project, 0);
    assert_eq!((&first["decision"], &first["time"], &first["hold"]), (&0.into(), &0.0.into(), &0.05.into()));
    assert_eq!((&first["observation"][0]["name"], &first["observation"][0]["unit"]), (&"pelvis.height".into(), &"m".into()));
    let entries = first["action"].as_array().unwrap().len();
    let action = |value: f64| format!("{:?}", vec![value; entries]);
    project.write("rest.json", &action(-1.0));
    project.write("far.json", &action(1.5));
    let before = project.read("try/session.json");
    project
        .msk(&["session", "submit", "try", "far.json"])
        .failed(1, &["`far.json` is rejected: entry 0 (from 0)", "is 1.5", "nothing was changed"]);
    assert_eq!(project.read("try/session.json"), before);
    let done = project.msk(&["session", "submit", "try", "rest.json"]).succeeded();
    assert!(done.out.contains("1 of 3 decisions, 5 control steps"), "{}", done.out);
    assert_eq!(visible(&project, 1)["time"], 0.05);
    // A recorded hash that was changed is noticed.
    let session = project.read("try/session.json");
    let hash = serde_json::from_str::<Value>(&session).unwrap()["decisions"][0]["hash"].as_str().unwrap().to_owned();
    project.write("try/session.json", &session.replace(&hash, "0123456789abcdef"));
    project.msk(&["session", "submit", "try", "rest.json"]).failed(1, &["decision 0 comes to another state"]);
    project.write("try/session.json", &session);
    project.msk(&["session", "submit", "try", "rest.json"]).succeeded();
    let last = project.msk(&["session", "submit", "try", "rest.json"]).succeeded();
    assert!(last.out.contains("stopped: "), "{}", last.out);
    project.msk(&["session", "submit", "try", "rest.json"]).failed(1, &["the session has stopped"]);
    let trace = project.msk(&["trace", "plot", "try/private/trace.npz", "rewards"]).succeeded();
    assert!(trace.out.contains("session"), "{}", trace.out);
}

#[test]
fn the_text_of_a_session_steers_no_terminal() {
    let project = Project::lean();
    project.msk(&["session", "init", "lean", "try"]).succeeded();
    let session = project.read("try/session.json");
    project.write("try/session.json", &session.replacen("\"lean\"", "\"le\\u001b[2Jan\"", 1));
    let done = project.msk(&["session", "status", "try"]);
    assert!(!done.out.contains('\u{1b}') && !done.err.contains('\u{1b}'), "{done:?}");
    assert!(format!("{}{}", done.out, done.err).contains("\\u001b[2J"), "{done:?}");
}

#[test]
fn another_task_is_another_session() {
    let project = Project::lean();
    project.msk(&["session", "init", "lean", "try"]).succeeded();
    let entries = visible(&project, 0)["action"].as_array().unwrap().len();
    project.write("rest.json", &format!("{:?}", vec![-1.0; entries]));
    let text = project.read("lean.msk");
    project.write("lean.msk", &text.replace("5    alive", "6    alive").replace("2 cm", "3 cm"));
    project.msk(&["session", "submit", "try", "rest.json"]).failed(1, &["the task has changed since the session began"]);
    project.write("none/file", "");
    project.msk(&["session", "status", "none"]).failed(1, &["`none` has no session", "msk session init"]);
}

#[test]
fn the_distance_from_the_reference_motion_is_measured_and_compared() {
    let project = Project::lean();
    let walk = concat!(env!("CARGO_MANIFEST_DIR"), "/tasks/locomotion/walk.msk");
    project.msk(&["session", "init", walk, "try", "--hold", "0.05", "--decisions", "2"]).succeeded();
    let entries = visible(&project, 0)["action"].as_array().unwrap().len();
    project.write("rest.json", &format!("{:?}", vec![-1.0; entries]));
    project.msk(&["session", "submit", "try", "rest.json"]).succeeded();
    let done = project.msk(&["session", "tracking", "try", "--reference", "cmc"]).succeeded();
    assert!(done.out.starts_with("tracking error ") && done.out.contains("of `cmc`: "), "{}", done.out);
    assert!(done.out.contains("10 control steps") && done.out.contains("diverged"), "{}", done.out);
    // The body stands where the reference begins, so errors are small at first.
    let error: f64 = done.out.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!(error > 0.0 && error < 0.2, "{}", done.out);
    // A report has what was found, until the session goes on.
    project.msk(&["report", "try"]).succeeded();
    let cells =
        |file: &str| project.read(file).lines().find(|line| line.contains(",walk,")).map(str::to_owned).unwrap_or_default();
    assert!(cells("report/report.csv").starts_with("Direct control,try,walk,1,0.05,"), "{}", project.read("report/report.csv"));
    assert!(
        cells("report/paper.csv").contains(",walk,0.05,N/A,") && cells("report/paper.csv").ends_with(",waits"),
        "{}",
        cells("report/paper.csv")
    );
    project.msk(&["session", "submit", "try", "rest.json"]).succeeded();
    project.msk(&["report", "try"]).succeeded();
    assert!(
        cells("report/paper.csv").contains(",walk,0.10,--,") && cells("report/paper.csv").ends_with(",decisions"),
        "{}",
        cells("report/paper.csv")
    );
    project.msk(&["session", "init", "lean", "other"]).succeeded();
    project.msk(&["session", "tracking", "other"]).failed(1, &["follows no reference motion", "hint:"]);
}
