//! `msk physics forward`, `rollout` and `import` from outside: what they print and write, and what they refuse.

use crate::support;

use msk::evaluate::npz::NpzReader;
use msk_physics::model::Model;
use msk_physics::{State, Workspace, forward, step};
use npyz::{NpyFile, WriterBuilder};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use support::{numbers, repository};
use tempfile::TempDir;

fn msk(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_msk")).arg("physics").args(arguments).output().unwrap()
}

/// Runs a command that must fail with one clear message.
fn refused(arguments: &[&str], expected: &str) {
    let output = msk(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{arguments:?} succeeds");
    assert!(message.starts_with("error: ") && message.contains(expected), "expected `{expected}` in `{message}`");
    assert!(output.stdout.is_empty());
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn muscles() -> PathBuf {
    repository("tests/oracle/models/muscles.xml")
}

/// A folder with a state file.
fn state_file(contents: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.json");
    fs::write(&path, contents).unwrap();
    (folder, path)
}

fn write_controls(path: &Path, shape: [u64; 2], values: &[f64]) {
    let file = fs::File::create(path).unwrap();
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd().unwrap();
    writer.extend(values.iter()).unwrap();
    writer.finish().unwrap();
}

#[test]
fn forward_prints_what_the_library_computes() {
    let model = Model::from_file(muscles()).unwrap();
    let mut state = State::<f64>::new(&model);
    state.velocity.fill(0.5);
    state.activation.fill(0.25);
    let (_folder, path) = state_file(&format!("{{\"qvel\": {:?}, \"act\": {:?}}}", state.velocity, state.activation));
    let output = msk(&["forward", "--model", text(&muscles()), "--state", text(&path), "--moment-arms"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();

    let mut workspace = Workspace::new(&model);
    forward(&model, &state, &mut workspace).unwrap();
    // Bit for bit: the printed numbers read back to the same.
    assert_eq!(numbers(&report["qacc"]), workspace.acceleration);
    assert_eq!(numbers(&report["ten_length"]), workspace.tendons.length);
    assert_eq!(numbers(&report["actuator_force"]), workspace.actuation.force);
    assert_eq!(numbers(&report["xquat"]), workspace.kinematics.body_orientation.concat());
    let muscles = model.actuators.name.len();
    assert_eq!(numbers(&report["actuator_moment"]).len(), muscles * model.nv);
    assert_eq!(numbers(&report["M"]).len(), model.nv * model.nv);
    assert_eq!(report["names"]["actuator"].as_array().unwrap().len(), muscles);
    assert_eq!(report.get("efc_J"), None, "large quantities come only on request");
}

#[test]
fn forward_without_a_model_takes_the_built_in_human() {
    let report: Value = serde_json::from_slice(&msk(&["forward"]).stdout).unwrap();
    assert_eq!((report["model"]["nq"].as_u64(), report["model"]["nu"].as_u64()), (Some(129), Some(416)));
    assert_eq!(numbers(&report["qpos"])[..3], [-0.025, 0.1, 1.0]);
}

#[test]
fn rollout_writes_the_states_that_stepping_gives() {
    let model = Model::from_file(muscles()).unwrap();
    let width = model.actuators.name.len();
    let controls: Vec<f64> = (0..20 * width).map(|index| (index % 7) as f64 / 7.0).collect();
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("u.npy"), folder.path().join("traj.npz"));
    write_controls(&input, [20, width as u64], &controls);
    let (model_path, steps) = (muscles(), "15");
    let paths = ["--model", text(&model_path), "--ctrl", text(&input), "--out", text(&output), "--steps", steps];
    let outcome = msk(&[&["rollout"], &paths[..]].concat());
    assert!(outcome.status.success(), "{}", String::from_utf8_lossy(&outcome.stderr));

    let (mut state, mut workspace) = (State::<f64>::new(&model), Workspace::new(&model));
    let mut positions = Vec::new();
    for row in controls.chunks(width).take(15) {
        state.control.copy_from_slice(row);
        step(&model, &mut state, &mut workspace).unwrap();
        positions.extend(state.position.clone());
    }
    let bytes = fs::read(&output).unwrap();
    let mut archive = NpzReader::new(&bytes).unwrap();
    let entry = archive.entry("qpos.npy", u64::MAX).unwrap();
    let written = NpyFile::new(&entry[..]).unwrap();
    assert_eq!(written.shape(), [15, model.nq as u64]);
    assert_eq!(written.into_vec::<f64>().unwrap(), positions);
    let entry = archive.entry("act.npy", u64::MAX).unwrap();
    let activation = NpyFile::new(&entry[..]).unwrap().into_vec::<f64>().unwrap();
    assert_eq!(activation[14 * width..], state.activation);
}

#[test]
fn states_that_do_not_fit_are_refused() {
    let forward = |contents: &str, expected: &str| {
        let (_folder, path) = state_file(contents);
        refused(&["forward", "--model", text(&muscles()), "--state", text(&path)], expected);
    };
    forward("{\"qpos\": [1, 2]}", "`qpos` has 2 numbers; the model needs");
    forward("{\"position\": []}", "unknown field `position`");
    forward("{\"qpos\": [1e999]}", "is not a state");
    forward("[", "is not a state");
    forward("", "is not a state");
    refused(&["forward", "--state", "no such file.json"], "cannot read no such file.json");
    refused(&["forward", "--model", "no such file.xml"], "cannot read no such file.xml");
}

#[test]
fn a_state_that_flies_apart_is_refused_by_name() {
    let model = Model::from_file(muscles()).unwrap();
    let (_folder, path) = state_file(&format!("{{\"qvel\": {:?}}}", vec![1e12; model.nv]));
    refused(&["forward", "--model", text(&muscles()), "--state", text(&path)], &model.joints.name[0]);
}

#[test]
fn excitations_that_do_not_fit_are_refused() {
    let width = Model::from_file(muscles()).unwrap().actuators.name.len() as u64;
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("u.npy"), folder.path().join("traj.npz"));
    let (model, input_text, output_text) = (muscles(), text(&input), text(&output));
    let paths = ["rollout", "--model", text(&model), "--ctrl", input_text, "--out"];
    let rollout = |rest: &[&str], expected: &str| refused(&[&paths[..], rest].concat(), expected);
    rollout(&[output_text], "cannot read");
    fs::write(&input, b"no array").unwrap();
    rollout(&[output_text], "is not a NumPy array");
    // The number of its elements does not fit into 64 bits.
    let shape = "{'descr': '<f8', 'fortran_order': False, 'shape': (1099511627776, 1099511627776), }\n";
    fs::write(&input, [b"\x93NUMPY\x01\0", &(shape.len() as u16).to_le_bytes()[..], shape.as_bytes()].concat()).unwrap();
    rollout(&[output_text], "must hold rows of");
    write_controls(&input, [2, width + 1], &vec![0.0; 2 * (width + 1) as usize]);
    rollout(&[output_text], "must hold rows of");
    write_controls(&input, [2, width], &vec![0.0; 2 * width as usize]);
    rollout(&[output_text, "--steps", "3"], "has 2 rows; 3 steps need one each");
    rollout(&["no such folder/t.npz"], "cannot write `no such folder/t.npz`");
}

#[test]
fn import_writes_a_file_that_imports_to_itself() {
    let folder = tempfile::tempdir().unwrap();
    let flat = |source: &Path, name: &str| {
        let out = folder.path().join(name);
        let outcome = msk(&["import", "--model", text(source), "--out", text(&out)]);
        assert!(outcome.status.success(), "{}", String::from_utf8_lossy(&outcome.stderr));
        out
    };
    let first = flat(&repository("tests/oracle/models/mjcf/inertias.xml"), "flat.xml");
    fs::create_dir(folder.path().join("again")).unwrap();
    let second = flat(&first, "again/flat.xml");
    let body = |path: &Path| fs::read_to_string(path).unwrap().split_once("-->").unwrap().1.to_owned();
    assert_eq!(body(&first), body(&second));
    assert!(!body(&first).contains("<mesh") && !body(&first).contains("type=\"mesh\""), "meshes are gone");
    refused(&["import", "--model", text(&first), "--out", "no such folder/x.xml"], "cannot write");
}

#[test]
fn a_key_frame_is_a_place_to_start_from() {
    let model = repository("tests/oracle/models/actuation/keyframes.xml");
    let output = msk(&["forward", "--model", text(&model), "--keyframe", "moved"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((report["time"].as_f64(), report["model"]["na"].as_u64()), (Some(1.5), Some(2)));
    assert_eq!((numbers(&report["act"]), numbers(&report["ctrl"])), (vec![0.4, -2.0], vec![1.0, -3.0, 0.5]));
    refused(&["forward", "--model", text(&model), "--keyframe", "x"], "no keyframe `x`: it has `rest`, `moved`, `placed`");
    refused(&["forward", "--model", text(&muscles()), "--keyframe", "x"], "no keyframe `x`: it has none");

    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("u.npy"), folder.path().join("traj.npz"));
    write_controls(&input, [2, 3], &[0.0; 6]);
    let paths = ["--model", text(&model), "--ctrl", text(&input), "--out", text(&output), "--keyframe", "moved"];
    assert!(msk(&[&["rollout"], &paths[..]].concat()).status.success());
    let bytes = fs::read(&output).unwrap();
    let mut archive = NpzReader::new(&bytes).unwrap();
    let mut entry = |name: &str| archive.entry(name, u64::MAX).unwrap();
    assert_eq!(NpyFile::new(&entry("time.npy")[..]).unwrap().into_vec::<f64>().unwrap(), [1.502, 1.504]);
    assert_eq!(NpyFile::new(&entry("act.npy")[..]).unwrap().shape(), [2, 2]);
}
