//! Conversations of a real client with the server.

use crate::support::Talk;

use msk_tuning::store::Store;
use rmcp::model::{ReadResourceRequestParams, ResourceContents};
use serde_json::{Value, json};
use std::fs;

const LEAN: &str = "task lean {
    body     human
    control  100 Hz
    horizon  5 steps
    init { pose neutral; root { height on ground } }
    observe { pelvis.height }
    reward {
        10 (5..30)  pose  = exp(-norm(independent.q - independent.neutral) / 1 rad)  // the posture
         5          alive = not terminated
    }
    terminate { sunk when pelvis.height < 0.5 m }
    success survived
}
";

/// A conversation about a project of one task.
async fn begin() -> Talk {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tasks.msk"), LEAN).unwrap();
    Talk::within(folder, ".").await
}

#[tokio::test]
async fn an_agent_finds_its_way_from_tasks_to_written_weights() {
    let talk = begin().await;
    let names: Vec<String> = talk.client.list_all_tools().await.unwrap().into_iter().map(|tool| tool.name.to_string()).collect();
    for tool in [
        "list_tasks",
        "list_terms",
        "explain",
        "check",
        "propose_weights",
        "apply_weights",
        "evaluate",
        "diff",
        "session_init",
        "session_submit",
        "session_status",
        "read_results",
    ] {
        assert!(names.iter().any(|name| name == tool), "no {tool} in {names:?}");
    }
    let tasks = talk.ask("list_tasks", json!({})).await;
    assert_eq!((&tasks["tasks"][0]["task"], &tasks["tasks"][0]["terms"]), (&json!("lean"), &json!(2)));
    let terms = talk.ask("list_terms", json!({ "task": "lean" })).await;
    let pose = &terms["terms"][0];
    assert_eq!((&pose["weight"], &pose["weight_may_be"], &pose["value_range"][1]), (&json!(10.0), &json!("5..30"), &json!(1.0)));
    let explained = talk.ask("explain", json!({ "task": "lean" })).await;
    assert!(explained["text"].as_str().unwrap().contains("at reset"));

    let proposed = talk.ask("propose_weights", json!({ "task": "lean", "weights": { "pose": 20, "alive": -3 } })).await;
    assert_eq!(proposed["apply"], json!({ "pose": 12.0, "alive": 4.0 }));
    let wish = json!({ "file": "tasks.msk", "weights": { "pose": 12, "alive": 4 } });
    let dry = talk.ask("apply_weights", wish.clone()).await;
    assert_eq!((&dry["written"], dry["changes"].as_array().unwrap().len()), (&json!(false), 2));
    assert_eq!(talk.read("tasks.msk"), LEAN);
    let mut wet = wish;
    wet["dry_run"] = false.into();
    talk.ask("apply_weights", wet).await;
    assert_eq!(
        talk.read("tasks.msk"),
        LEAN.replace("10 (5..30)", "12 (5..30)").replace(" 5          alive", " 4          alive")
    );
    // In the history from which `msk weights reset` goes back.
    let first = Store::open(&talk.path("tasks.msk")).unwrap().first_changes().unwrap();
    assert_eq!(first.iter().map(|change| change.was.as_str()).collect::<Vec<_>>(), ["10", "5"]);
    talk.client.cancel().await.unwrap();
}

/// What a project from somebody else may hold: none of it lets a change out of the project.
#[cfg(unix)]
#[tokio::test]
async fn links_beside_a_file_lead_no_change_elsewhere() {
    use std::os::unix::fs::symlink;
    let into_source = json!({ "file": "tasks.msk", "weights": { "pose": 12 }, "dry_run": false });
    let into_overlay = json!({ "file": "tasks.msk", "overlay": "w.toml", "weights": { "pose": 12 }, "dry_run": false });
    let cases = [
        (&into_source, ".msk/tasks.msk.lock", true),
        (&into_source, ".msk/tasks.msk.history.jsonl", true),
        (&into_source, ".msk", true),
        // Names that earlier versions used.
        (&into_source, ".msk/tasks.msk.new", false),
        (&into_source, ".msk/weights.jsonl", false),
        (&into_overlay, ".msk/w.toml.lock", true),
        (&into_overlay, ".msk/w.toml.history.jsonl", true),
        (&into_overlay, ".msk", true),
        (&into_overlay, ".msk/w.toml.new", false),
    ];
    let talk = begin().await;
    for (wish, link, refused) in cases {
        let elsewhere = tempfile::tempdir().unwrap();
        let victim = elsewhere.path().join(".bashrc");
        fs::write(&victim, "precious\n").unwrap();
        fs::write(talk.path("tasks.msk"), LEAN).unwrap();
        let _ = fs::remove_file(talk.path("w.toml"));
        let link = talk.path(link);
        fs::create_dir_all(link.parent().unwrap()).unwrap();
        symlink(if link.ends_with(".msk") { elsewhere.path() } else { &victim }, &link).unwrap();
        let (answer, error) = talk.call("apply_weights", wish.clone()).await;
        assert_eq!(error, refused, "{}: {answer}", link.display());
        assert_eq!(answer.to_string().contains("is a symbolic link"), refused, "{answer}");
        assert_eq!(fs::read_to_string(&victim).unwrap(), "precious\n", "{}", link.display());
        assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 1, "{}", link.display());
        let aside = talk.path(".msk");
        if fs::symlink_metadata(&aside).unwrap().is_symlink() { fs::remove_file(aside) } else { fs::remove_dir_all(aside) }
            .unwrap();
    }
}

#[tokio::test]
async fn a_weights_file_is_written_beside_the_source_and_compared() {
    let talk = begin().await;
    let wish = json!({ "file": "tasks.msk", "overlay": "weights.toml", "weights": { "lean.pose": 11.5 }, "dry_run": false });
    let answer = talk.ask("apply_weights", wish).await;
    assert_eq!(answer["changes"], json!([{ "task": "lean", "term": "pose", "from": 10.0, "to": 11.5 }]));
    assert_eq!(talk.read("weights.toml"), "[lean]\npose = 11.5\n");
    assert_eq!(talk.read("tasks.msk"), LEAN);
    let terms = talk.ask("list_terms", json!({ "task": "lean", "overlay": "weights.toml" })).await;
    assert_eq!((&terms["terms"][0]["weight"], &terms["terms"][0]["weight_from"]), (&json!(11.5), &json!("weights.toml")));
    let diff = talk.ask("diff", json!({ "task": "lean", "other_overlay": "weights.toml" })).await;
    let change = &diff["changes"][0];
    assert_eq!(
        (&change["section"], &change["name"], &change["fields"][0]["field"]),
        (&json!("term"), &json!("pose"), &json!("weight"))
    );
    assert!(diff["text"].as_str().unwrap().contains("11.5"), "{diff}");
    assert_eq!(diff["same"], false);
    assert_eq!(talk.ask("diff", json!({ "task": "lean" })).await["same"], true);
}

#[tokio::test]
async fn errors_are_reported_so_that_they_can_be_fixed() {
    let talk = begin().await;
    assert!(talk.refused("list_terms", json!({ "task": "laen" })).await.contains("there is no task `laen`"));
    let wish = |weights: Value| json!({ "file": "tasks.msk", "weights": weights, "dry_run": false });
    assert!(talk.refused("apply_weights", wish(json!({ "psoe": 11 }))).await.contains("did you mean `pose`?"));
    assert!(talk.refused("apply_weights", wish(json!({ "pose": 31 }))).await.contains("may be 5..30"));
    assert!(talk.refused("apply_weights", wish(json!({ "pose": 12, "alive": -5 }))).await.contains("must stay above 0"));
    assert_eq!(talk.read("tasks.msk"), LEAN, "all or nothing");
    let checked = talk.ask("check", json!({ "text": LEAN.replace("pelvis.height < 0.5 m", "pelvis.heigth < 0.5 m") })).await;
    assert_eq!(checked["ok"], false);
    assert!(checked["diagnostics"][0]["code"].as_str().unwrap().starts_with('E'), "{checked}");
    assert!(checked["rendered"].as_str().unwrap().contains("draft.msk"), "{checked}");
    let checked = talk.ask("check", json!({ "text": LEAN })).await;
    assert_eq!((&checked["ok"], &checked["tasks"]), (&json!(true), &json!(["lean"])));
    fs::write(talk.path("weights.toml"), "[lean]\npose = 99\n").unwrap();
    let refusal = talk.refused("explain", json!({ "task": "lean", "overlay": "weights.toml" })).await;
    assert!(refusal.contains("E0464") && refusal.contains("weights.toml"), "{refusal}");
}

#[tokio::test]
async fn episodes_run_within_a_budget_and_results_are_read() {
    let talk = begin().await;
    let answer = talk.ask("evaluate", json!({ "task": "lean", "policy": "zero", "episodes": 2 })).await;
    assert_eq!((&answer["episodes_done"], &answer["steps"], &answer["budget_spent"]), (&json!(2), &json!(10), &json!(false)));
    assert_eq!(answer["summary"]["tasks"][0]["terms"][0]["name"], "pose");
    let answer = talk.ask("evaluate", json!({ "task": "lean", "policy": "zero", "episodes": 50, "max_steps": 7 })).await;
    assert_eq!((&answer["episodes_done"], &answer["steps"], &answer["budget_spent"]), (&json!(1), &json!(7), &json!(true)));
    assert!(talk.refused("evaluate", json!({ "task": "lean", "policy": "genius" })).await.contains("genius"));

    assert_eq!(talk.ask("read_results", json!({})).await, json!({ "results": [] }));
    let results = talk.path("results/one");
    fs::create_dir_all(&results).unwrap();
    fs::write(results.join("summary.json"), "{\"policy\": \"zero\"}").unwrap();
    fs::write(results.join("episodes.jsonl"), "{\"episode\":0}\n{\"episode\":1}\n{\"epi").unwrap();
    assert_eq!(talk.ask("read_results", json!({})).await["results"], json!(["results/one"]));
    let unclaimed = talk.ask("read_results", json!({ "folder": "results/one" })).await;
    assert_eq!(unclaimed["content"]["policy"], "zero");
    assert!(unclaimed["note"].as_str().unwrap().starts_with("not verified: without the run.json"), "{unclaimed}");
    let missing = talk.refused("read_results", json!({ "folder": "results/one", "file": "run.json" })).await;
    assert!(missing.contains("there is no `run.json` in `results/one`: it has episodes.jsonl, summary.json"), "{missing}");
    let several = talk.refused("read_results", json!({ "folder": "results" })).await;
    assert!(several.contains("it has no file of results") && several.contains(r#""folders":["one"]"#), "{several}");
    let nowhere = talk.refused("read_results", json!({ "folder": "results/two" })).await;
    assert!(nowhere.contains("there is no folder `results/two`"), "{nowhere}");
    let lines = talk.ask("read_results", json!({ "folder": "results/one", "file": "episodes.jsonl", "last": 1 })).await;
    assert_eq!((&lines["lines"], &lines["last"]), (&json!(2), &json!([{ "episode": 1 }])));
    assert!(
        talk.refused("read_results", json!({ "folder": "results/one", "file": "../../tasks.msk" }))
            .await
            .contains("is not a file of results")
    );
}

#[tokio::test]
async fn an_agent_controls_a_body_one_decision_after_the_other() {
    let talk = begin().await;
    let asked = json!({ "task": "lean", "folder": "try", "hold": 0.02, "decisions": 2 });
    let begun = talk.ask("session_init", asked.clone()).await;
    assert_eq!(
        (&begun["decisions_taken"], &begun["stopped"], &begun["visible"]["hold"]),
        (&json!(0), &json!(null), &json!(0.02))
    );
    assert!(talk.refused("session_init", asked).await.contains("has a session already"));
    let entries = begun["visible"]["action"].as_array().unwrap().len();
    let action = |value: f64| json!({ "folder": "try", "action": vec![value; entries] });
    assert!(talk.refused("session_submit", action(1.5)).await.contains("entry 0 (from 0)"));
    assert!(talk.refused("session_submit", json!({ "folder": "try", "action": "rest" })).await.contains("found a string"));
    assert_eq!(talk.ask("session_status", json!({ "folder": "try" })).await, begun, "nothing has happened");
    let first = talk.ask("session_submit", action(-1.0)).await;
    assert_eq!((&first["decisions_taken"], &first["steps"], &first["visible"]["decision"]), (&json!(1), &json!(2), &json!(1)));
    assert_eq!(talk.ask("session_status", json!({ "folder": "try" })).await, first);
    let last = talk.ask("session_submit", action(0.5)).await;
    assert_eq!((&last["stopped"], &last["visible"]), (&json!("decisions"), &json!(null)));
    // Its task follows no motion.
    assert_eq!(talk.ask("session_status", json!({ "folder": "try" })).await["tracking"], json!(null));
    assert!(talk.refused("session_submit", action(0.0)).await.contains("the session has stopped"));
    let bad = json!({ "task": "lean", "folder": "other", "hold": 0.015 });
    assert!(talk.refused("session_init", bad).await.contains("held for a whole number of control steps"));
    assert!(talk.refused("session_status", json!({ "folder": "../try" })).await.contains("leads out of the project"));
    assert!(talk.refused("session_status", json!({ "folder": "." })).await.contains("has no session"));
}

#[tokio::test]
async fn the_reference_the_vocabulary_and_the_guide_are_resources() {
    let talk = begin().await;
    let listed = talk.client.list_all_resources().await.unwrap();
    assert_eq!(listed.len(), 3);
    for (uri, part) in
        [("msk://reference", "## 3 Numbers and units"), ("msk://vocabulary", "\"landmarks\""), ("msk://weights", "# Weights")]
    {
        assert!(listed.iter().any(|resource| resource.uri == uri));
        let read = talk.client.read_resource(ReadResourceRequestParams::new(uri)).await.unwrap();
        let ResourceContents::TextResourceContents { text, .. } = &read.contents[0] else { panic!("no text") };
        assert!(text.contains(part), "no `{part}` in {uri}");
    }
    assert!(talk.client.read_resource(ReadResourceRequestParams::new("msk://nothing")).await.is_err());
}

#[cfg(unix)]
#[tokio::test]
async fn nothing_leads_out_of_the_project() {
    let talk = begin().await;
    let outside = tempfile::tempdir().unwrap();
    let target = outside.path().join("secret.msk");
    fs::write(&target, LEAN).unwrap();
    let inside = |name: &str| talk.path(name);
    std::os::unix::fs::symlink(&target, inside("link.msk")).unwrap();
    std::os::unix::fs::symlink(outside.path(), inside("folder")).unwrap();
    std::os::unix::fs::symlink(outside.path().join("new.toml"), inside("dangling.toml")).unwrap();
    let absolute = target.display().to_string();
    for file in ["link.msk", "folder/secret.msk", "../secret.msk", "a/../../secret.msk", &absolute, "/etc/passwd"] {
        let refusal = talk.refused("apply_weights", json!({ "file": file, "weights": { "pose": 12 }, "dry_run": false })).await;
        assert!(refusal.contains("leads out of the project"), "{file}: {refusal}");
        let refusal = talk.refused("list_tasks", json!({ "file": file })).await;
        assert!(refusal.contains("leads out of the project"), "{file}: {refusal}");
    }
    for overlay in ["dangling.toml", "folder/new.toml", "../new.toml", "/tmp/new.toml", "nowhere/new.toml", "weights.msk", ""] {
        let wish = json!({ "file": "tasks.msk", "overlay": overlay, "weights": { "pose": 12 }, "dry_run": false });
        talk.refused("apply_weights", wish).await;
    }
    assert!(talk.refused("read_results", json!({ "folder": "folder" })).await.contains("leads out"));
    // A text may not use what lies outside, neither by climbing nor by a link.
    for used in ["../secret.msk", "link.msk"] {
        let text = format!("use \"{used}\"\n{}", LEAN.replace("task lean", "task other"));
        let checked = talk.ask("check", json!({ "text": text })).await;
        assert_eq!(checked["ok"], false, "{used}: {checked}");
    }
    assert_eq!(fs::read_to_string(&target).unwrap(), LEAN);
    assert_eq!(fs::read_dir(outside.path()).unwrap().count(), 1, "nothing was written there");
}
