//! `msk test`.

use super::project::{LEAN, Project};
use serde_json::Value;

/// The lean task with tests.
fn tested(tests: &str) -> Project {
    let project = Project::empty();
    let end = LEAN.rfind('}').unwrap();
    project.write("tested.msk", &format!("{}{tests}\n}}\n", &LEAN[..end]));
    project
}

#[test]
fn tests_are_reported_one_by_one() {
    let project = tested(
        "test \"high\" { pose neutral; expect pelvis.height > 0.5 m }\ncheat \"short\" { at 0.1 s { root.height = 0.2 m } }",
    );
    let done = project.msk(&["test", "tested.msk"]).succeeded();
    for part in ["ok    high", "ok    cheat short", "2 passed, 0 failed"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    let one = project.msk(&["test", "tested.msk", "--filter", "short"]).succeeded();
    assert!(one.out.contains("1 passed") && !one.out.contains("high"), "{}", one.out);
}

#[test]
fn the_ranking_stands_under_the_tests() {
    let fall = "cheat \"a fall\" { at 0.1 s { root.height = 0.2 m } }";
    let project = tested(&format!("test \"upright\" {{ pose neutral; expect success }}\n{fall}"));
    let done = project.msk(&["test", "tested.msk"]).succeeded();
    let lines: Vec<&str> = done.out.lines().map(str::trim).collect();
    let head = lines.iter().position(|line| line.starts_with("script ")).unwrap_or_else(|| panic!("no table in {}", done.out));
    assert!(lines[head].ends_with("ended by") && lines[head].contains("per step, discount 0.99"), "{}", done.out);
    assert!(lines[head + 1].starts_with("demonstration: upright") && lines[head + 1].ends_with("20  horizon"), "{}", done.out);
    assert!(lines[head + 2].starts_with("a fall"), "{}", done.out);
    let json = project.msk(&["test", "tested.msk", "--filter", "a fall", "--format", "json"]).succeeded().out;
    let report: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(report["demonstration"]["test"], Value::from("upright"));
    assert!(report["returns"]["return"].as_f64().unwrap() < report["demonstration"]["returns"]["return"].as_f64().unwrap());
    assert_eq!(report["returns"]["terms"][0]["name"], Value::from("pose"));

    let alone = tested(fall).msk(&["test", "tested.msk"]).succeeded();
    assert!(
        alone.out.contains("no test expects `success` at its end: the returns of the cheats are not compared"),
        "{}",
        alone.out
    );
}

#[test]
fn a_test_of_a_policy_is_played_with_the_policy_that_is_named() {
    let tests = "test \"still\" { run policy for 0.1 s; expect mean(muscles.excitation) < 0.01 }
        test \"goes on\" { at 0.05 s pose neutral; run policy for 0.1 s; expect mean(muscles.excitation) < 0.01 }
        test \"high\" { pose neutral; expect pelvis.height > 0.5 m }";
    let project = tested(tests);
    let done = project.msk(&["test", "tested.msk"]).succeeded();
    assert!(done.out.contains("1 passed, 0 failed, 2 left out: `--policy` names the policy that they test"), "{}", done.out);
    let done = project.msk(&["test", "tested.msk", "--policy", "zero"]).succeeded();
    assert!(done.out.contains("3 passed, 0 failed\n"), "{}", done.out);
    let done = project.msk(&["test", "tested.msk", "--policy", "random"]);
    assert_eq!(done.code, Some(1));
    assert!(done.out.contains("FAIL  still") && done.out.contains("1 passed, 2 failed"), "{}", done.out);
    // A policy from outside, and one that fails.
    project.write("agent.sh", "printf '{\"ready\": true}\\n'; exit 3\n");
    let done = project.msk(&["test", "tested.msk", "--policy", "process sh agent.sh", "--filter", "still"]);
    assert_eq!(done.code, Some(1));
    assert!(done.out.contains("in `lean`, episode 0, step 0: it ended with code 3"), "{}", done.out);
    let alone = tested("test \"still\" { run policy for 0.1 s; expect survived }").msk(&["test", "tested.msk"]);
    alone.failed(1, &["the tests run the policy that is tested, and none is named", "msk test --policy cmc"]);
    project.msk(&["test", "tested.msk", "--policy", "zerro"]).failed(1, &["there is no policy `zerro`"]);
}

#[test]
fn what_does_not_hold_is_reported_and_fails() {
    let project = tested("test \"low\" { moment there { pose neutral }; expect pelvis.height at there < 0.5 m }");
    let done = project.msk(&["test", "tested.msk"]);
    assert_eq!(done.code, Some(1));
    for part in
        ["FAIL  low", "expected pelvis.height at there < 0.5 m", "found pelvis.height at there = 0.9", "0 passed, 1 failed"]
    {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    let json = project.msk(&["test", "tested.msk", "--format", "json"]).out;
    let report: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&report["test"], &report["passed"]), (&Value::from("low"), &Value::from(false)));
    assert!(report["failures"][0]["sides"][0]["value"].as_f64().unwrap() > 0.9, "{report}");
}

#[test]
fn a_file_without_tests_says_so() {
    Project::lean().msk(&["test", "lean.msk"]).failed(1, &["there is no test to run", "lean"]);
}

#[test]
fn a_filter_that_fits_nothing_fails() {
    let project = tested("test \"high\" { pose neutral; expect pelvis.height > 0.5 m }");
    project.msk(&["test", "tested.msk", "--filter", "hihg"]).failed(1, &["no test contains `hihg`", "lean"]);
    project.msk(&["test", "tested.msk", "--filter", "hihg", "--format", "json"]).failed(1, &["no test contains `hihg`"]);
}

#[test]
fn titles_that_differ_in_punctuation_have_pages_of_their_own() {
    let project = tested(
        "test \"low!\" { pose neutral; expect pelvis.height < 0.5 m }\ntest \"low?\" { pose neutral; expect pelvis.height < 0.4 m }",
    );
    project.msk(&["test", "tested.msk", "--html", "failed"]);
    assert!(project.read("failed/lean-low.html").contains("<title>lean: low!</title>"));
    assert!(project.read("failed/lean-low-2.html").contains("<title>lean: low?</title>"));
}

#[test]
fn a_test_that_fails_becomes_a_page_and_one_that_passes_does_not() {
    let project = tested(
        "test \"low\" { pose neutral; expect pelvis.height < 0.5 m }\ntest \"high\" { pose neutral; expect pelvis.height > 0.5 m }",
    );
    let done = project.msk(&["test", "tested.msk", "--html", "failed"]);
    assert_eq!(done.code, Some(1));
    let page = project.read("failed/lean-low.html");
    assert!(page.contains("<title>lean: low</title>"));
    assert!(!project.path("failed/lean-high.html").exists());
    project.msk(&["test", "tested.msk", "--filter", "high", "--html", "passed"]).succeeded();
    assert!(!project.path("passed").exists());
}
