use super::*;
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace};
use msk_program::body::{Axis, BodyDescription};
use msk_program::task::RootPlacement;
use msk_runtime::bodies;
use msk_runtime::body::Body;
use std::path::Path;

/// The full body with its knees bent, its muscles at different activations.
fn crouching() -> (Model, Body, State<f64>, Workspace<f64>) {
    let model = bodies::model(&Path::new(bodies::ROOT).join("bodies/models/human416.xml")).unwrap();
    let bend = |joint: &str, angle: f64| ["l", "r"].map(|side| (format!("{joint}_{side}"), angle));
    let crouch = [bend("hip_flexion", 0.8), bend("knee_angle", 1.2), bend("ankle_angle", 0.4), bend("shoulder_elv", 0.5)];
    let description = BodyDescription {
        name: "human".into(),
        root: "Full Body".into(),
        root_forward: Axis::MinusY,
        root_up: Axis::PlusZ,
        poses: vec![("neutral".into(), crouch.concat())],
        ..BodyDescription::default()
    };
    let body = Body::bind(&description, &model).unwrap();
    let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
    body.place(&model, &RootPlacement::default(), body.neutral(), &mut state, &mut workspace);
    for (index, activation) in state.activation.iter_mut().enumerate() {
        *activation = index as f64 / 416.0;
    }
    physics::smooth(&model, &state, &mut workspace);
    (model, body, state, workspace)
}

fn picture(views: &[View], caption: &str) -> String {
    let (model, body, state, workspace) = crouching();
    let snapshot = Snapshot { body: &body, model: &model, state: &state, workspace: &workspace };
    svg(&snapshot, &Options { views: views.to_vec(), caption: caption.into(), ..Options::default() })
}

#[test]
fn every_muscle_is_drawn_in_every_view() {
    let picture = picture(&[View::Side, View::Front], "");
    assert_eq!(picture.matches(r#"class="muscle""#).count(), 2 * 416);
}

#[test]
fn the_picture_is_well_formed_small_and_the_same_every_time() {
    let first = picture(&[View::Side, View::Front], "a < b & c");
    let document = roxmltree::Document::parse(&first).unwrap();
    let title = document.descendants().find(|node| node.has_tag_name("title")).unwrap();
    assert_eq!(title.text(), Some("a < b & c"));
    assert!(first.len() < 400_000, "{} bytes", first.len());
    assert_eq!(first, picture(&[View::Side, View::Front], "a < b & c"));
}

#[test]
fn a_body_has_a_trunk_a_head_and_four_limbs() {
    let picture = picture(&[View::Front], "");
    assert_eq!(picture.matches(r#"class="edge""#).count(), 6);
}

#[test]
fn drawn_paths_are_as_long_as_the_tendons_they_show() {
    let (model, body, state, workspace) = crouching();
    let snapshot = Snapshot { body: &body, model: &model, state: &state, workspace: &workspace };
    for (index, muscle) in body.muscles.iter().enumerate() {
        let drawn: f64 =
            muscles::lines(&snapshot, index).iter().flat_map(|line| line.windows(2).map(|pair| (pair[1] - pair[0]).norm())).sum();
        let length = workspace.tendons.length[model.actuators.muscle(index).unwrap().tendon];
        // Chords of arcs of 0.35 rad are half a percent shorter than the arcs.
        assert!(drawn <= length + 1e-9 && drawn > 0.994 * length, "{}: {drawn} m drawn, {length} m long", muscle.name);
    }
}
