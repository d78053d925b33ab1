//! What lies outside of the project is neither read nor written, and no client learns whether it is there.

#![cfg(unix)]

use crate::support::Talk;

use serde_json::json;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

fn task(name: &str, body: &str) -> String {
    format!(
        "task {name} {{
    body     {body}
    control  100 Hz
    horizon  5 steps
    init {{ pose neutral; root {{ height on ground }} }}
    observe {{ {landmark}.height }}
    reward {{ 10 (1..30) alive = not terminated }}
    terminate {{ sunk when {landmark}.height < -10 m }}
    success survived
}}
",
        landmark = if body == "human" { "pelvis" } else { "com" }
    )
}

/// A folder with the project in `project`, what it must not see in `outside`, and a client of the server.
async fn begin() -> Talk {
    let folder = tempfile::tempdir().unwrap();
    for name in ["project/bodies", "outside"] {
        fs::create_dir_all(folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join("project/tasks.msk"), task("lean", "human")).unwrap();
    Talk::within(folder, "project").await
}

fn project(talk: &Talk, name: &str) -> PathBuf {
    talk.path("project").join(name)
}

fn outside(talk: &Talk, name: &str) -> PathBuf {
    talk.path("outside").join(name)
}

/// A model of one body, with something before it.
fn model(before: &str) -> String {
    format!(
        "<mujoco>{before}<worldbody><body name=\"torso\"><freejoint/><geom name=\"torso\" size=\"0.1\"/></body></worldbody></mujoco>"
    )
}

/// A way to name a file in a model, and the model that names a path so.
type Way<'a> = (&'static str, &'a dyn Fn(&str) -> String);

const PUPPET: &str = "body puppet {\n    model \"MODEL\"\n    root \"torso\" { forward x, up z }\n    pose neutral { }\n}\n";

#[tokio::test]
async fn models_include_nothing_from_outside_and_tell_nothing_of_it() {
    let talk = begin().await;
    let root = talk.folder.path().canonicalize().unwrap().display().to_string();
    let check = json!({ "text": task("own", "puppet") });
    let write = |model_name: &str, text: &str| {
        fs::write(project(&talk, "bodies/puppet.msk"), PUPPET.replace("MODEL", model_name)).unwrap();
        fs::write(project(&talk, "bodies/puppet.xml"), text).unwrap();
    };
    let include = |path: &str| model(&format!("<include file=\"{path}\"/>"));
    let mesh = |path: &str| {
        model(&format!("<asset><mesh name=\"m\" file=\"{path}\"/></asset>"))
            .replace("<freejoint/>", "<freejoint/><geom type=\"mesh\" mesh=\"m\"/>")
    };
    let heights = |path: &str| {
        model(&format!("<asset><hfield name=\"h\" size=\"1 1 1 1\" file=\"{path}\"/></asset>"))
            .replace("<worldbody>", "<worldbody><geom type=\"hfield\" hfield=\"h\"/>")
    };
    let whole: &dyn Fn(&str) -> String = &|_| model("");
    let ways: [Way<'_>; 4] = [("include", &include), ("mesh", &mesh), ("height field", &heights), ("model", whole)];
    let mut seen = 0;
    for (way, text) in ways {
        for ending in ["xml", "stl", "bin"] {
            let exists = format!("aaaa.{ending}");
            fs::write(outside(&talk, &exists), "<x><option timestep=\"0.0078125\"/></x>").unwrap();
            for (kind, folder) in
                [("absolute", format!("{root}/outside")), ("climbing", "../../outside".to_owned()), ("link", "link".to_owned())]
            {
                if kind == "link" {
                    let _ = fs::remove_file(project(&talk, "bodies/link"));
                    symlink(outside(&talk, ""), project(&talk, "bodies/link")).unwrap();
                }
                let answers =
                    [exists.as_str(), &format!("bbbb.{ending}")].map(|name| (name.to_owned(), format!("{folder}/{name}")));
                let mut shown = Vec::new();
                for (name, path) in answers {
                    write(if way == "model" { &path } else { "puppet.xml" }, &text(&path));
                    let (answer, _) = talk.call("check", check.clone()).await;
                    assert_eq!(answer["ok"], false, "{way}, {kind}: {answer}");
                    let answer = answer.to_string();
                    assert!(answer.contains("leads out of the project"), "{way}, {kind}: {answer}");
                    shown.push(answer.replace(&name, "NAME"));
                }
                assert_eq!(shown[0], shown[1], "{way}, {kind}: who asks learns whether the file exists");
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 36);
    // What lies inside is read.
    write("puppet.xml", &model("<include file=\"../inside.xml\"/>"));
    fs::write(project(&talk, "inside.xml"), "<x><option timestep=\"0.001\"/></x>").unwrap();
    assert_eq!(talk.call("check", check.clone()).await.0["ok"], true, "{}", talk.text_of("check", check.clone()).await);
}

#[tokio::test]
async fn outside_paths_get_one_answer_whether_they_exist_or_not() {
    let talk = begin().await;
    fs::write(outside(&talk, "aaaa.msk"), task("secret", "human")).unwrap();
    fs::write(outside(&talk, "aaaa.toml"), "[lean]\nalive = 11\n").unwrap();
    fs::create_dir(outside(&talk, "aaaa")).unwrap();
    fs::write(outside(&talk, "aaaa/summary.json"), "{}").unwrap();
    symlink(outside(&talk, ""), project(&talk, "folder")).unwrap();
    for name in ["aaaa", "bbbb"] {
        for ending in ["msk", "toml"] {
            symlink(outside(&talk, &format!("{name}.{ending}")), project(&talk, &format!("{name}.{ending}"))).unwrap();
        }
    }
    let absolute = outside(&talk, "").canonicalize().unwrap().display().to_string();
    for folder in ["../outside/", "a/../../outside/", "folder/", "./", &format!("{absolute}/")] {
        let ask = async |name: &str| {
            let (file, overlay) = (format!("{folder}{name}.msk"), format!("{folder}{name}.toml"));
            let mut answers = vec![
                talk.call("list_tasks", json!({ "file": file })).await,
                talk.call("check", json!({ "text": format!("use \"{file}\"\n{}", task("own", "human")) })).await,
                talk.call("explain", json!({ "task": "lean", "overlay": overlay })).await,
            ];
            for dry_run in [true, false] {
                answers.push(
                    talk.call("apply_weights", json!({ "file": file, "weights": { "alive": 12 }, "dry_run": dry_run })).await,
                );
                let wish = json!({ "file": "tasks.msk", "overlay": overlay, "weights": { "alive": 12 }, "dry_run": dry_run });
                answers.push(talk.call("apply_weights", wish).await);
            }
            if folder != "./" {
                answers.push(talk.call("read_results", json!({ "folder": format!("{folder}{name}") })).await);
            }
            answers.into_iter().map(|(answer, error)| (answer.to_string().replace(name, "NAME"), error)).collect::<Vec<_>>()
        };
        let (exists, absent) = (ask("aaaa").await, ask("bbbb").await);
        assert_eq!(exists, absent, "{folder}");
        assert!(exists.iter().all(|(answer, _)| answer.contains("leads out of the")), "{exists:?}");
    }
    assert_eq!(fs::read_to_string(outside(&talk, "aaaa.msk")).unwrap(), task("secret", "human"));
    assert_eq!(fs::read_dir(outside(&talk, "")).unwrap().count(), 3, "nothing was written there");
}

#[tokio::test]
async fn a_text_is_checked_under_every_spelling_of_its_name() {
    let talk = begin().await;
    fs::write(project(&talk, "bodies/uses.msk"), "use \"../tasks.msk\"\n").unwrap();
    let absolute = project(&talk, "tasks.msk").canonicalize().unwrap().display().to_string();
    let wrong = task("lean", "human").replace("pelvis.height <", "pelvis.heigth <");
    for file in ["tasks.msk", "./tasks.msk", "bodies/../tasks.msk", ".//./tasks.msk", &absolute] {
        let (answer, _) = talk.call("check", json!({ "text": wrong, "file": file })).await;
        assert_eq!(answer["ok"], false, "{file}: the file was checked, not the text: {answer}");
    }
    // Also where the text is reached by way of a file that uses it.
    let text = format!("use \"./bodies/uses.msk\"\n{wrong}");
    assert_eq!(talk.call("check", json!({ "text": text, "file": "./tasks.msk" })).await.0["ok"], false);
    let right = task("other", "human");
    let (answer, _) = talk.call("check", json!({ "text": right, "file": "./tasks.msk" })).await;
    assert_eq!(answer["tasks"], json!(["other"]), "{answer}");
}

/// Exchanges the folder `name` for a link to `target`, again and again.
fn exchange(name: &Path, target: &Path, stop: &AtomicBool) {
    let aside = name.with_extension("aside");
    while !stop.load(Ordering::Relaxed) {
        fs::rename(name, &aside).unwrap();
        symlink(target, name).unwrap();
        std::thread::yield_now();
        fs::remove_file(name).unwrap();
        fs::rename(&aside, name).unwrap();
        std::thread::yield_now();
    }
}

#[tokio::test]
async fn folders_that_are_exchanged_for_links_lead_nowhere() {
    let talk = begin().await;
    let inside = project(&talk, "own");
    fs::create_dir(&inside).unwrap();
    for (folder, name) in [(&inside, "lean"), (&outside(&talk, ""), "secret")] {
        fs::write(folder.join("tasks.msk"), task(name, "human")).unwrap();
        fs::write(folder.join("weights.toml"), "[lean]\nalive = 11\n").unwrap();
    }
    let before = |name: &str| fs::read(outside(&talk, name)).unwrap();
    let (tasks, weights) = (before("tasks.msk"), before("weights.toml"));
    let stop = Arc::new(AtomicBool::new(false));
    let attacker = std::thread::spawn({
        let (outside, stop) = (outside(&talk, ""), stop.clone());
        move || exchange(&inside, &outside, &stop)
    });
    let mut done = 0;
    for round in 0..30 {
        let weight = 2 + round % 20;
        let calls = [
            ("list_tasks", json!({ "file": "own/tasks.msk" })),
            ("apply_weights", json!({ "file": "own/tasks.msk", "weights": { "lean.alive": weight }, "dry_run": false })),
            ("apply_weights", json!({ "file": "own/tasks.msk", "weights": { "secret.alive": weight }, "dry_run": false })),
            (
                "apply_weights",
                json!({ "file": "tasks.msk", "overlay": "own/weights.toml", "weights": { "alive": weight }, "dry_run": false }),
            ),
        ];
        for (tool, arguments) in calls {
            let asks_for_it = arguments.to_string().contains("secret");
            let (answer, error) = talk.call(tool, arguments).await;
            assert!(asks_for_it || !answer.to_string().contains("secret"), "{tool}: {answer}");
            assert!(!asks_for_it || error, "{tool}: {answer}");
            done += usize::from(!error);
        }
    }
    stop.store(true, Ordering::Relaxed);
    attacker.join().unwrap();
    assert!(done > 0, "the folder was never found at its place");
    assert_eq!((before("tasks.msk"), before("weights.toml")), (tasks, weights));
    assert_eq!(fs::read_dir(outside(&talk, "")).unwrap().count(), 2, "nothing was written there");
}

#[tokio::test]
async fn pipes_and_devices_are_refused_without_waiting() {
    let talk = begin().await;
    for name in ["pipe.msk", "bodies/pipe.xml", "pipe.toml"] {
        assert!(std::process::Command::new("mkfifo").arg(project(&talk, name)).status().unwrap().success());
    }
    fs::write(project(&talk, "bodies/puppet.msk"), PUPPET.replace("MODEL", "pipe.xml")).unwrap();
    for (tool, arguments) in [
        ("list_tasks", json!({ "file": "pipe.msk" })),
        ("check", json!({ "text": format!("use \"pipe.msk\"\n{}", task("own", "human")) })),
        ("check", json!({ "text": task("own", "puppet") })),
        ("explain", json!({ "task": "lean", "overlay": "pipe.toml" })),
        ("apply_weights", json!({ "file": "pipe.msk", "weights": { "alive": 12 }, "dry_run": false })),
        ("apply_weights", json!({ "file": "tasks.msk", "overlay": "pipe.toml", "weights": { "alive": 12 }, "dry_run": false })),
    ] {
        let answer = talk.text_of(tool, arguments.clone()).await;
        assert!(answer.contains("a named pipe"), "{tool} {arguments}: {answer}");
    }
    let answer = talk.text_of("check", json!({ "text": "use \"/proc/self/environ\"\n" })).await;
    assert!(answer.contains("leads out of the project"), "{answer}");
}
