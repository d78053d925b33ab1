//! `msk weights`.

use super::project::{LEAN, Project};
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
    done.failed(1, &["nothing was changed", "did you mean `effort`?", "lean.alive cannot be -5"]);
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

#[test]
fn reset_restores_digits_as_they_were_written() {
    let project = Project::empty();
    let text = LEAN.replace("10    pose", "10.0  pose").replace("-1    effort", "-1.50 effort");
    project.write("lean.msk", &text);
    project.msk(&["weights", "set", "lean.msk", "pose=12", "effort=-2"]).succeeded();
    project.msk(&["weights", "scale", "lean.msk", "0.5"]).succeeded();
    project.msk(&["weights", "reset", "lean.msk", "effort"]).succeeded();
    assert!(project.read("lean.msk").contains("-1.50 effort") && project.read("lean.msk").contains("6  pose"));
    project.msk(&["weights", "reset", "lean.msk"]).succeeded();
    assert_eq!(project.read("lean.msk"), text);
}

#[test]
fn a_weight_written_alone_keeps_the_range_of_the_task_that_it_extends() {
    let project = Project::empty();
    project.write("lean.msk", &LEAN.replace("10    pose", "10 (5..20)   pose"));
    project.write("more.msk", "use \"lean.msk\"\n\ntask more extends lean {\n    reward { 12 pose }\n}\n");
    project.msk(&["weights", "set", "more.msk", "pose=21"]).failed(1, &["more.pose cannot be 21", "5..20"]);
    project.msk(&["weights", "set", "more.msk", "pose=20"]).succeeded();
    assert!(project.read("more.msk").contains("{ 20 pose }"));
}

const OVERLAY: &str = "# tuned\n[lean]\npose = 11.5  # more\n";

#[test]
fn the_command_line_wins_over_the_weights_file_and_it_over_the_source() {
    let project = Project::lean();
    project.write("weights.toml", OVERLAY);
    let done = project.msk(&["explain", "lean.msk", "--weights", "weights.toml", "--weight", "alive=6"]).succeeded();
    for part in [
        "11.5 pose   (weight from weights.toml; 10 in the source)",
        "6 alive   (weight from the command line; 5 in",
        "-1 effort\n",
    ] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    let done = project.msk(&["explain", "lean", "--weights", "weights.toml", "--weight", "lean.pose=9"]).succeeded();
    assert!(done.out.contains("9 pose   (weight from the command line; 10 in the source)"), "{}", done.out);
}

#[test]
fn results_say_which_weights_paid_and_where_they_came_from() {
    let project = Project::lean();
    project.write("weights.toml", OVERLAY);
    let eval = ["eval", "lean.msk", "--policy", "zero", "--episodes", "2", "--weights", "weights.toml", "--weight", "alive=6"];
    project.msk(&[&eval[..], &["--out", "out"]].concat()).succeeded();
    let run: Value = serde_json::from_str(&project.read("out/run.json")).unwrap();
    let task = &run["tasks"][0];
    assert_eq!(task["weights"], serde_json::json!([["pose", 11.5], ["alive", 6.0], ["effort", -1.0]]));
    assert_eq!(task["overlaid"], serde_json::json!([["pose", "weights.toml"], ["alive", "the command line"]]));
    let record: Value = serde_json::from_str(project.read("out/episodes.jsonl").lines().next().unwrap()).unwrap();
    let ratio = record["terms"]["pose"].as_f64().unwrap() / record["values"]["pose"].as_f64().unwrap();
    assert!((ratio - 11.5).abs() < 1e-9, "{ratio}");
    // Other weights are another run.
    project.write("weights.toml", &OVERLAY.replace("11.5", "11"));
    let done = project.msk(&[&eval[..], &["--out", "out"]].concat());
    done.failed(1, &["the weight of `pose` in task `lean` is 11.5, not 11"]);
}

#[test]
fn all_that_is_wrong_with_a_weights_file_is_reported_at_its_place() {
    let project = Project::lean();
    project.write("weights.toml", "pose = 1\n[lean]\npsoe = 3\nalive = -5\neffort = \"low\"\n[laen]\npose = 1\n");
    let done = project.msk(&["run", "lean", "--weights", "weights.toml"]);
    done.failed(1, &["error[E0461]", "weights.toml:1:1", "`pose` is outside of any task", "weights.toml:5:10", "not a text"]);
    project.write("weights.toml", "[lean]\npsoe = 3\nalive = -5\n[laen]\npose = 1\n");
    let done = project.msk(&["run", "lean", "--weights", "weights.toml"]);
    done.failed(
        1,
        &[
            "error[E0463]",
            "weights.toml:2:1",
            "did you mean `pose`?",
            "error[E0464]",
            "weights.toml:3:9",
            "lean.alive cannot be -5: it is 5 and must stay above 0",
            "error[E0462]",
            "weights.toml:4:2",
            "did you mean `lean`?",
        ],
    );
    project.write("weights.toml", "[lean]\npose: 3\n");
    project.msk(&["eval", "lean.msk", "--weights", "weights.toml", "--live"]).failed(1, &["error[E0460]", "weights.toml:2:"]);
    project.msk(&["run", "lean", "--weights", "none.toml"]).failed(1, &["none.toml"]);
    project.msk(&["run", "lean", "--weight", "psoe=3"]).failed(1, &["did you mean `pose`"]);
    project.msk(&["eval", "lean.msk", "--live"]).failed(2, &["--weights"]);
}

#[test]
fn a_weights_file_is_written_baked_and_extracted_and_loses_nothing() {
    let project = Project::lean();
    project.write("weights.toml", OVERLAY);
    let set = ["weights", "set", "lean.msk", "alive=6", "--into", "weights.toml"];
    project.msk(&[&set[..], &["--dry-run"]].concat()).succeeded();
    assert_eq!(project.read("weights.toml"), OVERLAY);
    let done = project.msk(&set).succeeded();
    assert!(done.out.contains("lean.alive: 5 -> 6"), "{}", done.out);
    assert_eq!(project.read("weights.toml"), format!("{OVERLAY}alive = 6\n"));
    project.msk(&["weights", "set", "lean.msk", "alive=-6", "--into", "weights.toml"]).failed(1, &["must stay above 0"]);
    assert_eq!(project.read("lean.msk"), LEAN);

    let refused = project.msk(&["weights", "apply", "tasks.msk", "--weights", "weights.toml"]);
    refused.failed(1, &["is not declared in `tasks.msk`", "the file that declares it: lean.msk"]);
    project.msk(&["weights", "apply", "lean.msk", "--weights", "weights.toml"]).succeeded();
    assert_eq!(project.read("lean.msk"), LEAN.replace("10    pose", "11.5    pose").replace(" 5    alive", " 6    alive"));
    project.msk(&["weights", "reset", "lean.msk"]).succeeded();
    assert_eq!(project.read("lean.msk"), LEAN);

    let done = project.msk(&["weights", "extract", "lean.msk", "--weights", "weights.toml", "--json"]).succeeded();
    let report: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(report["changes"].as_array().unwrap().len(), 3, "{report}");
    assert_eq!(project.read("weights.toml"), "# tuned\n[lean]\npose = 10  # more\nalive = 5\neffort = -1\n");
}

#[test]
fn a_running_evaluation_takes_new_weights_and_refuses_broken_ones() {
    let project = Project::lean();
    project.write("weights.toml", OVERLAY);
    let eval = ["eval", "lean.msk", "--policy", "zero", "--episodes", "400", "--threads", "2", "--out", "out"];
    let mut child = project.command(&[&eval[..], &["--weights", "weights.toml", "--live"]].concat()).spawn().unwrap();
    let errors = Lines::of(child.stderr.take().unwrap());
    // Each change is waited for where it shows: lines are written in the order of episodes, so that any number may have begun before.
    let rewarded_by = |weight: f64| {
        let text = std::fs::read_to_string(project.path("out/episodes.jsonl")).unwrap_or_default();
        let mut records = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
        records.any(|record| record["weights"]["pose"].as_f64() == Some(weight))
    };
    until("an episode is rewarded by the first weight", || rewarded_by(11.5));
    project.msk(&["weights", "set", "lean.msk", "pose=12", "--into", "weights.toml"]).succeeded();
    until("an episode is rewarded by the second weight", || rewarded_by(12.0));
    // An editor that does not know the rules, but replaces a file whole: one that is being written would be a version, too.
    let save = |text: &str| {
        project.write("fresh.toml", text);
        std::fs::rename(project.path("fresh.toml"), project.path("weights.toml")).unwrap();
    };
    save("[lean]\npose = -1\n");
    until("a weight below its range is refused", || errors.contains("E0464") && errors.contains("the weights stay at version"));
    save("[lean]\npose = 13\n");
    until("an episode is rewarded by the last weight", || rewarded_by(13.0));
    assert!(std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    child.wait().unwrap();
    let records: Vec<Value> =
        project.read("out/episodes.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let weights: Vec<f64> = records.iter().map(|record| record["weights"]["pose"].as_f64().unwrap()).collect();
    for weight in [11.5, 12.0, 13.0] {
        assert!(weights.contains(&weight), "nothing was paid by {weight}");
    }
    assert!(!weights.contains(&-1.0));
    let versions: std::collections::BTreeSet<_> = records.iter().map(|record| record["weights_version"].to_string()).collect();
    assert_eq!(versions.len(), 3);
    assert!(project.read("out/report.md").contains("Weights while it ran (episodes): "));
    // Any of them is played again from the journal alone.
    let index = weights.iter().position(|weight| *weight == 12.0).unwrap();
    let episode = records[index]["episode"].to_string();
    let again = project.msk(&["run", "lean", "--replay", "out", "--episode", &episode]).succeeded();
    assert!(again.err.contains("the same as in `out`, bit for bit"), "{}", again.err);
    project.msk(&["run", "lean", "--replay", "out", "--episode", "99999"]).failed(1, &["contains no episode 99999"]);
}

/// Waits for what a running program is to do, two minutes at most.
fn until(what: &str, mut done: impl FnMut() -> bool) {
    let start = std::time::Instant::now();
    while !done() {
        assert!(start.elapsed() < std::time::Duration::from_secs(120), "in vain: {what}");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

/// What a running program has written so far.
struct Lines(std::sync::Arc<std::sync::Mutex<String>>);

impl Lines {
    fn of(stream: impl std::io::Read + Send + 'static) -> Self {
        let text = std::sync::Arc::<std::sync::Mutex<String>>::default();
        let lines = Self(text.clone());
        std::thread::spawn(move || {
            for line in std::io::BufRead::lines(std::io::BufReader::new(stream)).map_while(Result::ok) {
                text.lock().unwrap().extend([line.as_str(), "\n"]);
            }
        });
        lines
    }

    fn contains(&self, part: &str) -> bool {
        self.0.lock().unwrap().contains(part)
    }
}

/// What a folder from somebody else may hold: none of it lets a change out of the folder.
#[cfg(unix)]
#[test]
fn links_in_a_folder_from_somebody_else_lead_nowhere() {
    use std::os::unix::fs::symlink;
    let source = ["weights", "set", "lean.msk", "pose=11"];
    let overlay = ["weights", "set", "lean.msk", "pose=11", "--into", "weights.toml"];
    let cases: [(&[&str], &str, bool); 9] = [
        (&source, ".msk/lean.msk.lock", true),
        (&source, ".msk/lean.msk.history.jsonl", true),
        (&source, ".msk", true),
        // Names that earlier versions used.
        (&source, ".msk/lean.msk.new", false),
        (&source, ".msk/weights.jsonl", false),
        (&overlay, ".msk/weights.toml.lock", true),
        (&overlay, ".msk/weights.toml.history.jsonl", true),
        (&overlay, ".msk", true),
        (&overlay, ".msk/weights.toml.new", false),
    ];
    for (command, name, refused) in cases {
        let (project, elsewhere) = (Project::lean(), tempfile::tempdir().unwrap());
        let victim = elsewhere.path().join(".bashrc");
        std::fs::write(&victim, "precious\n").unwrap();
        let link = project.path(name);
        std::fs::create_dir_all(link.parent().unwrap()).unwrap();
        symlink(if link.ends_with(".msk") { elsewhere.path() } else { &victim }, &link).unwrap();
        let done = project.msk(command);
        if refused {
            done.failed(1, &["is a symbolic link, which is not followed here", &format!("{name}`")]);
            assert!(project.read("lean.msk") == LEAN && !project.path("weights.toml").exists());
        } else {
            done.succeeded();
        }
        assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious\n", "{}", link.display());
        assert_eq!(std::fs::read_dir(elsewhere.path()).unwrap().count(), 1, "{}", link.display());
    }
}

/// The finding: two files of one folder had one history under two locks, which lost changes and could then not be read.
#[test]
fn many_programs_that_change_two_files_of_a_folder_lose_nothing() {
    let project = Project::lean();
    let other = LEAN.replace("task lean", "task other");
    project.write("other.msk", &other);
    let set = |file: &str, weight: u32| project.command(&["weights", "set", file, &format!("pose={weight}")]).spawn().unwrap();
    let running: Vec<_> = (11..17).flat_map(|weight| [set("lean.msk", weight), set("other.msk", weight)]).collect();
    for child in running {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    for (file, text) in [("lean.msk", LEAN), ("other.msk", &other)] {
        let log = project.read(format!(".msk/{file}.history.jsonl"));
        let lines: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!((lines.len(), lines.iter().filter(|line| line["end"] == "made").count()), (12, 6), "{log}");
        project.msk(&["weights", "reset", file]).succeeded();
        assert_eq!(project.read(file), text);
    }
}
