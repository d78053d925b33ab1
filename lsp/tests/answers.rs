//! What the language server answers about a text.

#[allow(dead_code, reason = "the other tests use the rest")]
use crate::support;

use serde_json::{Value, json};
use support::{Client, marked, task, uri, within};

const A: &str = "/project/a.msk";
const LIBRARY: &str = "/project/lib/posture.msk";
const POSTURE: &str = "/// How far the trunk leans.\nfn lean(part) = 1 - part.up.z\n\nconst reach = 0.4 m\n";

fn open(text: &str) -> Client {
    let mut client = Client::ready(&[(LIBRARY, POSTURE)]);
    client.open(A, text);
    client
}

/// The hover text at the mark.
fn hover(text: &str) -> String {
    let (text, place) = marked(text);
    let mut client = open(&text);
    let shown = client.ask_at("textDocument/hover", A, place).unwrap();
    client.end();
    shown["contents"]["value"].as_str().unwrap_or("").to_owned()
}

#[test]
fn a_hover_tells_type_range_and_what_a_thing_is() {
    let reward = |formula: &str| hover(&task(&format!("    reward {{ 1 tall = {formula} }}")));
    let joint = reward("knee_angle_r|.q / 1 rad");
    assert!(joint.contains("the joint `knee_angle_r`") && joint.contains("Range 0.0000 .. 120"), "{joint}");
    let signal = reward("knee_angle_r.q| / 1 rad");
    assert!(signal.contains("`q`: number, rad or m") && signal.contains("an angle (rad)"), "{signal}");
    assert!(signal.contains("0 .. 2.09"), "{signal}");
    let function = reward("ex|p(-com.speed / 1 m/s)");
    assert!(function.contains("`exp(x)`") && function.contains("exponential function"), "{function}");
    let landmark = reward("pel|vis.height / 1 m");
    assert!(landmark.contains("the landmark `pelvis`") && landmark.contains("Height in the standing pose"), "{landmark}");
    assert!(reward("com.speed / 1 m|/s").contains("metre"), "a unit");
}

#[test]
fn a_hover_tells_documentation_and_weights() {
    let text = task("    /// How far it leans.\n    let lean = 1 - torso.up.z\n    reward { 3 a = le|an\n 1 b = exp(-lean) }");
    let shown = hover(&text);
    assert!(shown.contains("a dimensionless number") && shown.contains("How far it leans."), "{shown}");
    let shown = hover(&task("    reward {\n        3 up|right = torso.up.z\n        1 b = pelvis.up.z\n    }"));
    assert!(shown.contains("Weight 3, 75 % of all, per control step."), "{shown}");
    let shown = hover(&task("    scene {\n ground\n bo|x seat { size [1 m, 1 m, 1 m] }\n }\n    reward { 1 b = pelvis.up.z }"));
    assert!(shown.contains("a box: full extents"), "{shown}");
}

/// What may be written at the mark.
fn completed(text: &str) -> Vec<String> {
    let (text, place) = marked(text);
    let mut client = open(&text);
    let items = client.ask_at("textDocument/completion", A, place).unwrap();
    client.end();
    items.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap().to_owned()).collect()
}

fn offers(found: &[String], wanted: &[&str], unwanted: &[&str]) {
    for word in wanted {
        assert!(found.iter().any(|label| label == word), "{word} is not in {found:?}");
    }
    for word in unwanted {
        assert!(!found.iter().any(|label| label == word), "{word} is in {found:?}");
    }
}

#[test]
fn what_may_follow_a_dot_depends_on_what_stands_before_it() {
    let reward = |formula: &str| completed(&task(&format!("    reward {{\n        1 tall = {formula}\n    }}")));
    offers(&reward("pelvis.|"), &["height", "angular_velocity"], &["q", "activation", "z"]);
    offers(&reward("pelvis.he| / 1 m"), &["height"], &["q"]);
    offers(&reward("exp(-norm(independent.|"), &["q", "qd", "neutral"], &["height"]);
    offers(&reward("soleus_r.|"), &["activation", "tension"], &["height"]);
    offers(&reward("com.velocity.|"), &["x", "y", "z", "xy"], &["forward"]);
    offers(&reward("(com.velocity in heading(pelvis)).|"), &["forward", "left", "up"], &["x"]);
    let scene = "    scene {\n        ground\n        box seat { size [1 m, 1 m, 1 m], at [2 m, 0, 0.5 m]\n            point edge { at [0, 0, 0] } }\n    }\n    reward {\n        1 a = seat.|\n    }";
    offers(&completed(&task(scene)), &["edge", "top", "position"], &["q"]);
    assert!(reward("0.5.|").is_empty());
}

#[test]
fn names_statements_units_and_fields_are_offered_where_they_belong() {
    offers(&completed("|"), &["task", "use", "fn"], &["reward"]);
    offers(&completed(&task("    te|")), &["terminate", "reward", "scene"], &["height"]);
    let names =
        completed(&format!("use \"lib/posture.msk\"\n{}", task("    let mine = 1\n    reward {\n        1 a = |\n    }")));
    offers(&names, &["mine", "lean", "reach", "pelvis", "knee_angle_r", "com", "exp", "held", "t", "independent"], &["reward"]);
    offers(&completed(&task("    reward {\n        1 a = exp(-10 |")), &["m", "deg", "steps"], &["pelvis"]);
    offers(&completed(&task("    scene {\n        |\n    }")), &["box", "stairs", "weld"], &["reward"]);
    offers(&completed(&task("    scene {\n        box seat { | }\n    }")), &["size", "mass", "walkable"], &["rise"]);
    offers(&completed("task t {\n    body human\n    init { pose | }\n}"), &["neutral"], &["height"]);
    offers(&completed("task t {\n    body human\n    init { pose neutral { kn|"), &["knee_angle_r"], &["pelvis"]);
    offers(&completed(&task("    terminate { low when com.height < 0.5 m }\n    let x = ended by |")), &["low"], &["pelvis"]);
    offers(&completed(&task("    let v = com.velocity in |")), &["pelvis", "heading", "world"], &["exp"]);
    offers(&completed(&task("    allow |")), &["dead_term", "unused"], &[]);
    assert!(completed("// a comm|ent").is_empty());
}

#[test]
fn definitions_are_found_in_other_files() {
    let (text, place) = marked(&format!("use \"lib/posture.msk\"\n{}", task("    reward { 1 a = le|an(torso) }")));
    let mut client = open(&text);
    let found = client.ask_at("textDocument/definition", A, place).unwrap();
    assert_eq!(found[0]["uri"], uri(LIBRARY));
    assert_eq!(within(POSTURE, &found[0]["range"]), "lean");
    let used = client.ask_at("textDocument/definition", A, lsp_types::Position::new(0, 8)).unwrap();
    assert_eq!(used[0]["uri"], uri(LIBRARY));
    client.end();
}

#[test]
fn definitions_of_parts_phases_reasons_and_loop_variables_are_found() {
    let cases = [
        (
            "    scene { ground; body door { hinge swing { axis [0, 0, 1] }, box leaf { size [1 m, 1 m, 1 m], mass 1 kg, at [3 m, 0, 1 m] } } }\n    reward { 1 a = door.le|af.up.z }",
            "leaf",
        ),
        ("    terminate { low when com.height < 0.5 m }\n    reward { 1 a = ended by l|ow }", "low"),
        ("    reward { 1 a = sum([1 / (n| + 1) for n in 0..3]) * torso.up.z }", "n"),
        ("    params { pace = 1 m/s (0..2 m/s) }\n    reward { 1 a = com.speed / pa|ce }", "pace"),
    ];
    for (statements, name) in cases {
        let (text, place) = marked(&task(statements));
        let mut client = open(&text);
        let found = client.ask_at("textDocument/definition", A, place).unwrap();
        assert_eq!(within(&text, &found[0]["range"]), name, "{statements}");
        assert_ne!(found[0]["range"]["start"], serde_json::to_value(place).unwrap());
        client.end();
    }
}

/// The texts after renaming what stands at the mark, or why it is refused.
fn renamed(text: &str, new_name: &str) -> Result<Vec<(String, usize)>, String> {
    let (text, place) = marked(text);
    let mut client = open(&text);
    let params = json!({ "textDocument": { "uri": uri(A) }, "position": place, "newName": new_name });
    let answer = client.ask("textDocument/rename", params).map_err(|(_, message)| message);
    client.end();
    let changes = answer?["changes"].as_object().unwrap().clone();
    Ok(changes.iter().map(|(uri, edits)| (uri.clone(), edits.as_array().unwrap().len())).collect())
}

#[test]
fn names_are_renamed_in_all_files() {
    let user = format!("use \"lib/posture.msk\"\n{}", task("    reward { 1 a = le|an(torso)\n 2 b = lean(pelvis) }"));
    assert_eq!(renamed(&user, "tilt_of"), Ok(vec![(uri(A), 2), (uri(LIBRARY), 1)]));
    let own = task(
        "    state n: int = 0 becomes n + 1 when com.height < 0.9 m\n    observe { n|\n x = n }\n    reward { 1 a = torso.up.z }",
    );
    assert_eq!(renamed(&own, "sunk"), Ok(vec![(uri(A), 4)]));
    let inherited =
        format!("{}task other extends example {{\n    reward {{ 2 ta|ll }}\n}}\n", task("    reward { 1 tall = torso.up.z }"));
    assert_eq!(renamed(&inherited, "upright"), Ok(vec![(uri(A), 2)]));
}

#[test]
fn a_renaming_that_would_change_the_meaning_is_refused() {
    let text =
        |new: &str| renamed(&task("    let le|an = 1 - torso.up.z\n    let other = 2\n    reward { 1 a = lean * other }"), new);
    assert!(text("upright").is_ok());
    for (new, reason) in [
        ("other", "already defined"),
        ("pelvis", "already defined"),
        ("m", "a word of the language"),
        ("Lean", "is not a valid name"),
        ("lean_", "is not a valid name"),
        ("when", "a word of the language"),
    ] {
        let refused = text(new).unwrap_err();
        assert!(refused.contains(reason), "{new}: {refused}");
    }
    let captured = task("    let le|an = 1 - torso.up.z\n    reward { 1 a = sum([lean * k for k in 0..3]) }");
    assert!(renamed(&captured, "k").unwrap_err().contains("already defined"));
    let body = task("    reward { 1 a = pel|vis.up.z }");
    assert!(renamed(&body, "hips").unwrap_err().contains("belongs to a body"));
    let pattern = task(
        "    scene { ground\n box pole_{a,b} { size [1 m, 1 m, 1 m], at [3 m, 0, 1 m] } }\n    reward { 1 a = po|le_a.top / 1 m }",
    );
    assert!(renamed(&pattern, "post").is_err());
}

#[test]
fn fixes_of_the_compiler_are_offered_where_they_apply() {
    let text = task("    reward { 1 tall = pelvis.height }");
    let mut client = open(&text);
    assert_eq!(client.codes(A, Some(1)), ["E0302"]);
    let range = client.published[&uri(A)].diagnostics[0].range;
    let params = json!({ "textDocument": { "uri": uri(A) }, "range": range, "context": { "diagnostics": [] } });
    let actions = client.ask("textDocument/codeAction", params).unwrap();
    let edit = &actions[0]["edit"]["changes"][uri(A)][0];
    assert_eq!(edit["newText"], " / 1 m");
    let elsewhere = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 0, "character": 0 } });
    let params = json!({ "textDocument": { "uri": uri(A) }, "range": elsewhere, "context": { "diagnostics": [] } });
    assert_eq!(client.ask("textDocument/codeAction", params).unwrap(), json!([]));
    client.end();
}

#[test]
fn all_sure_fixes_are_made_at_once_where_the_client_asks_for_them() {
    let text = "const a = 0.25m\nconst b = 1/m^2\n";
    let mut client = Client::greeted(&[], json!({ "workspace": { "workspaceEdit": { "documentChanges": true } } }));
    client.open(A, text);
    let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 2, "character": 0 } });
    let context = json!({ "diagnostics": [], "only": ["source.fixAll"] });
    let params = json!({ "textDocument": { "uri": uri(A) }, "range": range, "context": context });
    let actions = client.ask("textDocument/codeAction", params).unwrap();
    let change = &actions[0]["edit"]["documentChanges"][0];
    assert_eq!(change["textDocument"]["version"], 1);
    assert_eq!(change["edits"][0]["newText"], "const a = 0.25 m\nconst b = 1 m^-2\n");
    client.end();
}

#[test]
fn weights_show_their_share() {
    let mut client = open(&task("    reward {\n        30 a = torso.up.z\n        -10 (-20..-1) b = com.speed / 1 m/s\n    }"));
    let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } });
    let hints = client.ask("textDocument/inlayHint", json!({ "textDocument": { "uri": uri(A) }, "range": range })).unwrap();
    let labels: Vec<&Value> = hints.as_array().unwrap().iter().map(|hint| &hint["label"]).collect();
    assert_eq!(labels, ["75 %", "25 %"]);
    assert_eq!(hints[0]["position"], json!({ "line": 8, "character": 10 }));
    client.end();
}

#[test]
fn the_outline_nests_terms_in_their_reward() {
    let mut client = open(&task("    reward {\n        30 a = torso.up.z\n    }\n    terminate { low when com.height < 0.1 m }"));
    let outline = client.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": uri(A) } })).unwrap();
    assert_eq!(outline[0]["name"], "example");
    let names: Vec<&str> =
        outline[0]["children"].as_array().unwrap().iter().map(|child| child["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["reward", "terminate"]);
    assert_eq!(outline[0]["children"][0]["children"][0]["name"], "a");
    client.end();
}

#[test]
fn the_outline_of_a_suite_lists_families_and_protocols() {
    let suite =
        "suite bench {\n    family standing { a, b }\n    protocol quick { episodes 5 }\n    protocol { episodes 50 }\n}\n";
    let mut client = open(suite);
    let outline = client.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": uri(A) } })).unwrap();
    let children = outline[0]["children"].as_array().unwrap();
    let names: Vec<&str> = children.iter().map(|child| child["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["standing", "quick", "protocol"]);
    assert_eq!(children[1]["selectionRange"]["start"], json!({ "line": 2, "character": 13 }));
    client.end();
}

#[test]
fn the_layout_is_that_of_the_formatter() {
    let mut client = open("const  a=1\nconst bc=2\n");
    let params = json!({ "textDocument": { "uri": uri(A) }, "options": { "tabSize": 4, "insertSpaces": true } });
    let edits = client.ask("textDocument/formatting", params).unwrap();
    assert_eq!(edits[0]["newText"], "const a  = 1\nconst bc = 2\n");
    client.end();
}
