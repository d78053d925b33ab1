//! `msk draw` from outside.

use std::process::{Command, Output};

fn draw(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_msk")).arg("draw").args(arguments).output().unwrap()
}

fn picture(arguments: &[&str]) -> String {
    let output = draw(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn complaint(arguments: &[&str]) -> String {
    let output = draw(arguments);
    assert!(!output.status.success() && output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn the_built_in_human_is_drawn_in_its_poses() {
    let standing = picture(&[]);
    assert!(standing.starts_with("<svg") && standing.contains("<title>human, neutral</title>"));
    assert_ne!(standing, picture(&["--pose", "squatting"]));
    assert_eq!(standing, picture(&["--pose", "neutral"]), "the same picture, byte for byte");
}

#[test]
fn one_view_shows_half_of_both() {
    let muscles = |arguments: &[&str]| picture(arguments).matches(r#"class="muscle""#).count();
    assert_eq!([muscles(&["--view", "side"]), muscles(&["--view", "front"]), muscles(&[])], [416, 416, 832]);
}

#[test]
fn a_state_shows_activations_and_the_forces_of_the_ground() {
    let folder = tempfile::tempdir().unwrap();
    let (state, out) = (folder.path().join("pressed.json"), folder.path().join("pressed.svg"));
    // Standing straight, 2 mm into the ground, all muscles fully active.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut position = vec![0.0; 129];
    position[..7].copy_from_slice(&[0.0, 0.0, 0.9448, half, 0.0, 0.0, half]);
    std::fs::write(&state, format!(r#"{{"qpos":{position:?},"act":{:?}}}"#, vec![1.0; 416])).unwrap();
    let output = draw(&["--state", state.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(output.status.success() && output.stdout.is_empty());
    let picture = std::fs::read_to_string(out).unwrap();
    assert!(picture.contains("<title>human, pressed</title>"));
    assert!(picture.contains(r##"stroke="#c60e1a""##) && !picture.contains(r##"class="muscle" stroke="#7a9ecc""##));
    assert!(picture.matches(r#"class="force""#).count() >= 4, "one arrow per foot and view");
}

#[test]
fn what_cannot_be_drawn_is_reported_in_one_message() {
    assert!(complaint(&["--body", "nobody"]).starts_with("error: there is no body `nobody`"));
    assert!(complaint(&["--pose", "lotus"]).contains("it has: neutral"));
    assert!(complaint(&["--activation", "2"]).contains("is not a number from 0 to 1"));
    assert!(complaint(&["--state", "missing.json"]).starts_with("error: cannot read missing.json"));
    assert!(complaint(&["--out", "missing/folder/human.svg"]).starts_with("error: cannot write `missing/folder/human.svg`"));
}

#[test]
fn a_task_is_drawn_as_it_begins_with_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("chair.msk");
    let chair = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/chair.msk")).unwrap();
    std::fs::write(&file, chair.replace("../tasks/lib", concat!(env!("CARGO_MANIFEST_DIR"), "/tasks/lib"))).unwrap();
    let plain = picture(&["--task", file.to_str().unwrap(), "--plain", "--view", "side"]);
    assert!(plain.matches(r#"class="scenery""#).count() >= 1 && plain.matches(r#"class="muscle""#).count() == 0);
    assert!(plain.len() < 60_000, "{} bytes", plain.len());
    let whole = picture(&["--task", file.to_str().unwrap(), "--view", "side"]);
    assert_eq!(whole.matches(r#"class="muscle""#).count(), 416);
    assert!(complaint(&["--task", "nothing.msk"]).contains("nothing.msk"));
}

#[test]
fn several_draws_of_a_task_stand_beside_each_other_with_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("load.msk");
    let text = "task load {
        body human; control 100 Hz; horizon 10 steps
        random load = uniform(1 kg .. 9 kg)
        random bend = uniform(0 deg .. 90 deg)
        scene { ground; box pack on torso { size [15 cm, 30 cm, 40 cm], at [-20 cm, 0, 0], mass load, solid false } }
        init { pose neutral { knee_angle_r = bend } }
        observe { pelvis.height }
        reward { 1 tall = pelvis.height / 1 m }
        terminate { fallen when pelvis.height < 0.3 m }
        success survived
    }";
    std::fs::write(&file, text).unwrap();
    let drawn = picture(&["--task", file.to_str().unwrap(), "--plain", "--view", "side", "--draws", "4"]);
    let document = roxmltree::Document::parse(&drawn).unwrap();
    let lines = |name: &str| -> Vec<&str> {
        let texts = document.descendants().filter(|node| node.has_tag_name("text")).filter_map(|node| node.text());
        texts.filter(|text| text.starts_with(name)).collect()
    };
    for (name, unit) in [("pack.mass ", "kg"), ("knee_angle_r ", "deg")] {
        let found = lines(name);
        assert!(found.len() == 4 && found.iter().all(|line| line.ends_with(unit)), "{found:?}");
        assert!(found[1..].iter().all(|line| *line != found[0]), "{found:?}");
    }
    // Definitions of one view do not hide those of the others.
    let mut ids: Vec<&str> = document.descendants().filter_map(|node| node.attribute("id")).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}
