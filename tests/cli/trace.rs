//! Traces of episodes, what is made of them, and perturbation sweeps.

use super::project::{Project, journal};
use crate::support::repository;
use serde_json::Value;

#[test]
fn a_trace_is_plotted_and_exported() {
    let project = Project::lean();
    project.msk(&["run", "lean", "--policy", "random", "--trace", "lean.npz"]).succeeded();
    let done = project.msk(&["trace", "plot", "lean.npz", "activations/soleus_*", "terms", "positions/knee_angle_l"]).succeeded();
    for part in ["<svg", "soleus_l", "soleus_r", "terms", "positions [rad]", "lean, random, seed 0, episode 0"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    let usual = project.msk(&["trace", "plot", "lean.npz", "--out", "lean.svg"]).succeeded();
    assert!(usual.out.is_empty() && project.read("lean.svg").contains("ground reactions"));
    let done = project.msk(&["trace", "export", "lean.npz", "--out", "opensim"]).succeeded();
    assert_eq!(done.out.lines().count(), 5, "{}", done.out);
    let coordinates = project.read("opensim/lean_coordinates.mot");
    assert!(coordinates.contains("inDegrees=yes") && coordinates.contains("pelvis_tilt") && coordinates.contains("knee_angle_l"));
    // A row for each state between the header and the end.
    let rows = coordinates.lines().count() - 7;
    assert_eq!(coordinates.lines().find_map(|line| line.strip_prefix("nRows=")), Some(rows.to_string().as_str()));
}

#[cfg(unix)]
#[test]
fn an_export_follows_no_link() {
    let project = Project::lean();
    project.msk(&["run", "lean", "--policy", "random", "--trace", "lean.npz"]).succeeded();
    project.write("victim", "mine");
    std::os::unix::fs::symlink(project.path("victim"), project.path("lean_activations.sto")).unwrap();
    project.msk(&["trace", "export", "lean.npz"]).failed(1, &["lean_activations.sto", "a symbolic link"]);
    assert_eq!(project.read("victim"), "mine");
}

#[test]
fn what_is_no_trace_is_refused() {
    let project = Project::lean();
    project.write("no.npz", "PK");
    project.msk(&["trace", "plot", "no.npz"]).failed(1, &["`no.npz` is not a trace", "hint: a trace is what"]);
    project.msk(&["trace", "export", "none.npz"]).failed(1, &["cannot read `none.npz`"]);
    project.msk(&["run", "lean", "--trace", "x.npz", "--trace-columns", "muscle"]).failed(2, &["no quantity `muscle`"]);
    project.msk(&["run", "lean", "--policy", "zero", "--trace", "few.npz", "--trace-columns", "rewards"]).succeeded();
    project.msk(&["trace", "plot", "few.npz", "terms"]).failed(1, &["the trace has no terms", "it has rewards"]);
    project
        .msk(&["trace", "plot", "few.npz", "rewards/x"])
        .failed(1, &["no column of rewards is called `x`", "there are reward"]);
    project.msk(&["trace", "export", "few.npz"]).failed(1, &["has nothing that OpenSim has a file for"]);
}

#[test]
fn activations_are_compared_with_envelopes_of_people() {
    let project = Project::lean();
    project.msk(&["run", "lean", "--policy", "zero", "--trace", "lean.npz"]).succeeded();
    project.msk(&["trace", "emg", "lean.npz"]).failed(2, &["there is no `--reference`", "no recordings of people are included"]);
    project.write("human.csv", "percent,soleus_r,Tibialis\n0,0.1,0.2\n30,0.3,0.1\n60,0.9,0.3\n100,0.1,0.2\n");
    let emg = |more: &[&str]| project.msk(&[&["trace", "emg", "lean.npz", "--reference", "human.csv"], more].concat());
    emg(&[]).failed(1, &["there is no whole gait cycle of `soleus_r`"]);
    emg(&["--map", "tibant_r=Tibia"]).failed(1, &["`human.csv` has no column `Tibia`; it has percent, soleus_r, Tibialis"]);
    emg(&["--map", "tibialis=Tibialis"]).failed(1, &["the body has no muscle `tibialis`"]);
    emg(&["--map", "tibialis"]).failed(2, &["expected MUSCLE=COLUMN"]);
    project.write("human.txt", "");
    project.msk(&["trace", "emg", "lean.npz", "--reference", "human.txt"]).failed(1, &["`human.txt` has an unknown format"]);
}

/// A participant in the layout of Gait120, as `tests/oracle/recordings.py` writes one.
#[test]
fn a_published_data_set_becomes_a_table_of_envelopes() {
    let project = Project::lean();
    let file = |name: &str| std::fs::read(repository(&format!("runtime/evaluate/src/recordings/{name}"))).unwrap();
    for (participant, name, bytes) in [
        ("S001", "ProcessedData.mat", file("gait120/processed.mat")),
        ("S002", "ConvertedData.mat", file("gait120/converted.mat")),
        ("S003", "ProcessedData.mat", b"MATLAB 7.3".to_vec()),
    ] {
        let folder = project.path(&format!("data/Gait120_001_to_010/{participant}/EMG"));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    let done = project.msk(&["trace", "envelopes", "data", "--out", "walking.csv"]).succeeded();
    assert!(done.err.contains("6 cycles of 2 participants"), "{}", done.err);
    assert!(
        done.err.contains("S003/EMG/ProcessedData.mat` is a MAT file of version 7.3") && done.err.contains("left out"),
        "{}",
        done.err
    );
    let table = project.read("walking.csv");
    assert!(table.starts_with("percent,VastusLateralis,GastrocnemuisMedialis\n0,3,3\n"), "{table}");
    assert_eq!(table.lines().count(), 102);
    // Its columns are muscles of the right leg without being told.
    project.msk(&["run", "lean", "--policy", "zero", "--trace", "lean.npz"]).succeeded();
    project.msk(&["trace", "emg", "lean.npz", "--reference", "walking.csv"]).failed(1, &["no whole gait cycle of `vaslat_r`"]);
    let envelopes = |more: &[&str]| project.msk(&[&["trace", "envelopes", "data"], more].concat());
    envelopes(&["--condition", "StairAscent"])
        .failed(1, &["no file of `data` has a gait cycle", "hint: no recordings of people are included"]);
    envelopes(&["--condition", "3ms"]).failed(2, &["Gait120 has no movement `3ms`", "LevelWalking, StairAscent"]);
    project.write("none/file", "");
    project.msk(&["trace", "envelopes", "none"]).failed(1, &["no data set that is known", "https://osf.io/7qbxc"]);
    project.write("runners/Sub_01_3ms.c3d", "");
    project.msk(&["trace", "envelopes", "runners"]).failed(1, &["no `Excel file with EMG channels.xlsx`", "hint:"]);
    std::fs::write(project.path("runners/Excel file with EMG channels.xlsx"), file("van_hooren/channels.xlsx")).unwrap();
    project
        .msk(&["trace", "envelopes", "runners"])
        .failed(1, &["Sub_01_3ms.c3d` has no mark of a C3D file", "no file of `runners`"]);
    project.msk(&["trace", "envelopes", "runners", "--condition", "5ms"]).failed(2, &["of the condition `5ms`", "there are 3ms"]);
}

#[test]
fn an_evaluation_keeps_traces_that_do_not_depend_on_threads() {
    let project = Project::lean();
    let eval = |out: &str, more: &[&str]| {
        let command = ["eval", "tasks.msk", "--policy", "random", "--episodes", "3", "--out", out];
        project.msk(&[&command, more].concat()).succeeded()
    };
    eval("one", &["--trace=activations,terms", "--trace-episodes", "2", "--threads", "1"]);
    // The second run makes the traces of episodes that are there already.
    eval("two", &["--threads", "3"]);
    eval("two", &["--trace=activations,terms", "--trace-episodes", "2"]);
    for episode in ["lean-0000.npz", "lean-0001.npz"] {
        let bytes = |out: &str| std::fs::read(project.path(&format!("{out}/traces/{episode}"))).unwrap();
        assert_eq!(bytes("one"), bytes("two"));
    }
    assert!(!project.path("one/traces/lean-0002.npz").exists());
    assert_eq!(journal(&project.read("one/episodes.jsonl")), journal(&project.read("two/episodes.jsonl")));
}

#[test]
fn every_episode_has_its_standard_metrics() {
    let project = Project::lean();
    project.msk(&["eval", "tasks.msk", "--policy", "random", "--episodes", "2", "--out", "out"]).succeeded();
    let summary: Value = serde_json::from_str(&project.read("out/summary.json")).unwrap();
    let value = |name: &str| {
        let all = summary["tasks"][0]["standard"].as_array().unwrap();
        all.iter().find(|metric| metric["name"] == name).unwrap()["value"]["mean"].as_f64().unwrap()
    };
    assert!((0.0..0.5).contains(&value("activation_cost")), "{}", value("activation_cost"));
    assert!((0.0..12.0).contains(&value("joint_smoothness")) && value("metabolic_power") > 0.5);
    assert!((0.1..5.0).contains(&value("peak_ground_reaction")) && value("peak_joint_reaction") > 0.1);
    assert_eq!(summary["tasks"][0]["recruitment"].as_array().unwrap().len(), 20);
    let shares: f64 =
        summary["tasks"][0]["recruitment"].as_array().unwrap().iter().map(|family| family["share"].as_f64().unwrap()).sum();
    assert!((shares - 1.0).abs() < 1e-9, "{shares}");
    let report = project.read("out/report.md");
    assert!(report.contains("## Standard metrics") && report.contains("## Recruitment"), "{report}");
}

#[test]
fn a_sweep_is_resumed_and_has_the_same_bits_on_any_number_of_threads() {
    let project = Project::lean();
    let sweep = |out: &str, more: &[&str]| {
        let command = ["eval", "tasks.msk", "--policy", "random", "--episodes", "2", "--out", out];
        project.msk(&[&command, more].concat())
    };
    let done = sweep("one", &["--sweep", "action,latency", "--threads", "1"]).succeeded();
    for part in ["Robustness of `random`", "## Action", "0.05", "## Latency", "## Areas", "| lean"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    sweep("two", &["--sweep", "action", "--threads", "3"]).succeeded();
    let again = sweep("two", &["--sweep", "action,latency", "--threads", "3"]).succeeded();
    assert!(again.err.contains("resuming `two/action-0.05`"), "{}", again.err);
    assert_eq!(project.read("one/sweep.json"), project.read("two/sweep.json"));
    for point in ["unperturbed", "action-0.2", "latency-4"] {
        let lines = |out: &str| journal(&project.read(format!("{out}/{point}/episodes.jsonl")));
        assert_eq!(lines("one"), lines("two"), "{point}");
    }
    let returns = |point: &str| {
        let text = project.read(format!("one/{point}/episodes.jsonl"));
        text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["return"].to_string()).collect::<Vec<_>>()
    };
    assert!(returns("unperturbed") != returns("action-0.05") && returns("unperturbed") != returns("latency-1"));
    sweep("two", &["--sweep", "action", "--policy", "zero"]).failed(2, &["a sweep is of one policy"]);
    sweep("two", &["--sweep", "wind"]).failed(2, &["invalid value 'wind'"]);
}

#[test]
fn every_axis_perturbs_and_observations_are_normalised() {
    let project = Project::lean();
    let done = project.msk(&[
        "eval",
        "tasks.msk",
        "--policy",
        "random",
        "--episodes",
        "1",
        "--out",
        "out",
        "--sweep",
        "observation,gain,push,friction,mass",
    ]);
    done.succeeded();
    let normalization: Value = serde_json::from_str(&project.read("out/unperturbed/normalization-lean.json")).unwrap();
    assert_eq!(normalization["mean"].as_array().unwrap().len(), 1);
    let settings: Value = serde_json::from_str(&project.read("out/observation-0.02/run.json")).unwrap();
    let words = settings["tasks"][0]["perturbation"].as_str().unwrap();
    assert!(words.starts_with("observation 0.02, normalized by "), "{words}");
    let total = |point: &str| {
        let text = project.read(format!("out/{point}/episodes.jsonl"));
        serde_json::from_str::<Value>(text.lines().next().unwrap()).unwrap()["return"].to_string()
    };
    let clean = total("unperturbed");
    // A random policy does not look at its observation.
    assert_eq!(total("observation-0.1"), clean);
    for point in ["gain-0.2", "mass-0.2"] {
        assert_ne!(total(point), clean, "{point}");
    }
}
