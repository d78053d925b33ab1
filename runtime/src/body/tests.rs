use super::*;
use crate::scene::ground::Ground;
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace};
use msk_program::body::{BodyDescription, LandmarkDescription};
use msk_program::task::RootPlacement;
use msk_program::vocabulary::GroupKind;

/// Two legs under a box that looks along -y; a door that is no part of the body; knees that follow the hips.
const SCENE: &str = r#"
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="trunk" pos="0 0 5">
      <freejoint/>
      <geom name="trunk" type="ellipsoid" size="0.1 0.2 0.3" mass="10"/>
      <body name="thigh_l" pos="0.1 0 -0.3">
        <joint name="hip_flex_l" type="hinge" axis="-1 0 0" limited="true" range="-0.5 2"/>
        <geom name="thigh_l" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05" mass="3"/>
        <body name="shank_l" pos="0 0 -0.4">
          <joint name="knee_l" type="hinge" axis="1 0 0"/>
          <geom name="shank_l" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.04" mass="2"/>
        </body>
      </body>
      <body name="thigh_r" pos="-0.1 0 -0.3">
        <joint name="hip_flex_r" type="hinge" axis="-1 0 0" limited="true" range="-0.5 2"/>
        <geom name="thigh_r" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05" mass="3"/>
        <body name="shank_r" pos="0 0 -0.4">
          <joint name="knee_r" type="hinge" axis="1 0 0"/>
          <geom name="shank_r" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.04" mass="2"/>
        </body>
      </body>
    </body>
    <body name="door" pos="3 0 1">
      <joint name="swing" type="hinge" axis="0 0 1"/>
      <geom name="door" type="ellipsoid" size="0.02 0.5 1" mass="20"/>
    </body>
  </worldbody>
  <equality>
    <joint joint1="knee_l" joint2="hip_flex_l" polycoef="0.1 2 0 0 0"/>
    <joint joint1="knee_r" joint2="hip_flex_r" polycoef="0.1 2 0 0 0"/>
  </equality>
</mujoco>"#;

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(|name| (*name).to_owned()).collect()
}

fn shank(name: &str, body: &str) -> LandmarkDescription {
    LandmarkDescription {
        name: name.into(),
        description: "The sole.".into(),
        body: body.into(),
        point: [0.0, 0.0, -0.44],
        forward: Axis::MinusY,
        up: Axis::PlusZ,
        segment: vec![body.into()],
    }
}

fn description() -> BodyDescription {
    BodyDescription {
        name: "legs".into(),
        root: "trunk".into(),
        root_forward: Axis::MinusY,
        root_up: Axis::PlusZ,
        landmarks: vec![shank("sole_l", "shank_l"), shank("sole_r", "shank_r")],
        joint_aliases: vec![("hip_l".into(), "hip_flex_l".into()), ("hip_r".into(), "hip_flex_r".into())],
        joint_groups: vec![("hips".into(), names(&["hip_l", "hip_flex_r"]))],
        landmark_groups: vec![("feet".into(), names(&["sole_r", "sole_l"]))],
        poses: vec![("neutral".into(), vec![]), ("kick".into(), vec![("hip_l".into(), 0.5)])],
        ..BodyDescription::default()
    }
}

fn model() -> Model {
    Model::from_mjcf(SCENE).unwrap()
}

fn problems(change: impl FnOnce(&mut BodyDescription)) -> String {
    let mut description = description();
    change(&mut description);
    Body::bind(&description, &model()).unwrap_err().to_string()
}

#[test]
fn a_body_is_what_hangs_on_its_root_and_nothing_else() {
    let model = model();
    let body = Body::bind(&description(), &model).unwrap();
    assert_eq!(body.members, 1..6);
    let joints: Vec<_> = body.joints.iter().map(|joint| (joint.name.as_str(), joint.independent)).collect();
    assert_eq!(joints, [("hip_l", true), ("knee_l", false), ("hip_r", true), ("knee_r", false)]);
    let shapes: Vec<_> = body.shapes.iter().map(|&geom| model.geoms.name[geom].as_str()).collect();
    assert_eq!(shapes, ["trunk", "thigh_l", "shank_l", "thigh_r", "shank_r"]);
    assert_eq!(body.ground.len(), 1);
}

#[test]
fn the_vocabulary_tells_the_compiler_what_exists() {
    let model = model();
    let vocabulary = Body::bind(&description(), &model).unwrap().vocabulary(&model);
    assert_eq!(vocabulary.body, "legs");
    assert!((vocabulary.mass - 20.0).abs() < 1e-12, "the door is no part of the body");
    let sole = &vocabulary.landmarks[0];
    assert_eq!((sole.name.as_str(), sole.mass, sole.has_segment), ("sole_l", 2.0, true));
    // Knees follow their hips at 0.1 rad, so the soles swing back and up a little, and the trunk stands lower.
    assert!(sole.neutral_position[2].abs() < 1e-3);
    assert_eq!(vocabulary.joints[0].range, Some([-0.5, 2.0]));
    assert_eq!(vocabulary.joints[1].neutral, 0.1);
    let groups: Vec<_> = vocabulary.groups.iter().map(|group| (group.kind, group.members.as_slice())).collect();
    assert_eq!(groups, [(GroupKind::Joints, [0, 2].as_slice()), (GroupKind::Landmarks, [1, 0].as_slice())]);
}

#[test]
fn coupled_joints_follow_their_couplings_in_every_pose() {
    let model = model();
    let body = Body::bind(&description(), &model).unwrap();
    assert_eq!(body.pose("kick").unwrap(), [0.5, 0.1 + 2.0 * 0.5, 0.0, 0.1]);
}

#[test]
fn couplings_are_solved_leaders_first_and_count_from_the_reference() {
    let chain = r#"<mujoco><compiler angle="radian"/><worldbody><body name="trunk"><freejoint/><geom size="0.1"/>
        <body><joint name="a" ref="0.25"/><geom size="0.1"/><body><joint name="b"/><geom size="0.1"/>
        <body><joint name="c" ref="1"/><geom size="0.1"/></body></body></body></body></worldbody>
        <equality><joint joint1="c" joint2="b" polycoef="0 0 3 0 0"/><joint joint1="b" joint2="a" polycoef="0 2 0 0 0"/>
        </equality></mujoco>"#;
    let description = BodyDescription {
        root: "trunk".into(),
        root_up: Axis::PlusZ,
        poses: vec![("neutral".into(), vec![("a".into(), 0.75)])],
        ..BodyDescription::default()
    };
    let body = Body::bind(&description, &Model::from_mjcf(chain).unwrap()).unwrap();
    // b = 2 (0.75 - 0.25), c = 1 + 3 b².
    assert_eq!(body.neutral(), [0.75, 1.0, 4.0]);

    let circle = chain.replace(r#"joint1="b" joint2="a""#, r#"joint1="b" joint2="c""#);
    let error = Body::bind(&description, &Model::from_mjcf(&circle).unwrap()).unwrap_err().to_string();
    assert!(error.contains("couplings of these joints are cyclic: c, b"), "{error}");
}

#[test]
fn everything_that_does_not_fit_is_reported_at_once() {
    let report = problems(|description| {
        description.landmarks[0].body = "shank_left".into();
        description.landmarks[1].segment.push("shank_rr".into());
        description.landmarks.push(shank("knob", "door"));
        description.landmarks.push(LandmarkDescription { up: Axis::PlusY, ..shank("sole_r", "shank_r") });
        description.joint_aliases.push(("door".into(), "swings".into()));
        description.joint_groups[0].1.push("ankle".into());
        description.families = vec![("Calves".into(), names(&["soleus"]))];
        description.poses = vec![("kick".into(), vec![("hip_l".into(), 7.0), ("knee_l".into(), 0.0)])];
    });
    assert_eq!(
        report,
        "body `legs` does not match its model:
  - the name `sole_r` is used for two landmarks
  - landmark `sole_l` names the body `shank_left`, which does not exist; did you mean `shank_l`?
  - landmark `sole_r` names the shape `shank_rr`, which does not exist; did you mean `shank_r`?
  - landmark `knob` is on `door`, which is not a descendant of the root
  - landmark `sole_r`: forward and up must be different axes
  - the alias `door` names the joint `swings`, which does not exist; did you mean `swing`?
  - family \"Calves\" names the muscle `soleus`, which does not exist
  - group `hips` names the joint `ankle`, which does not exist
  - there is no pose `neutral`
  - pose `kick` sets `hip_l` to 401.1 deg, outside of its range -28.65 .. 114.6 deg
  - pose `kick` sets `knee_l`, which is coupled to another joint"
    );
}

#[test]
fn a_root_that_is_missing_or_bent_is_an_error() {
    assert!(problems(|description| description.root = "trunks".into()).contains("did you mean `trunk`?"));
    // Everything else that is wrong is reported with it.
    let two = problems(|description| {
        description.root = "trunks".into();
        description.poses.clear();
    });
    assert!(two.contains("the root names the body `trunks`") && two.contains("there is no pose `neutral`"), "{two}");
    assert!(problems(|description| description.root_up = Axis::PlusY).contains("the root: forward and up"));
}

/// The body placed in a pose, with its frames.
fn placed(pose: &str, placement: &RootPlacement) -> (Model, Body, State<f64>, Workspace<f64>) {
    let model = model();
    let body = Body::bind(&description(), &model).unwrap();
    let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
    body.place(&model, placement, body.pose(pose).unwrap(), &mut state, &mut workspace);
    physics::kinematics::update(&model, &state, &mut workspace.kinematics);
    (model, body, state, workspace)
}

#[test]
fn a_body_stands_where_its_lowest_shape_touches_the_ground() {
    for pose in ["neutral", "kick"] {
        let (model, body, _, workspace) = placed(pose, &RootPlacement::default());
        let lowest = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &body.ground }.clearance(&body.shapes);
        assert!(lowest.abs() < 1e-12, "{pose}: {lowest}");
    }
}

#[test]
fn a_body_faces_its_heading_and_stands_upright() {
    let facing = |heading: f64| {
        let (_, body, _, workspace) = placed("neutral", &RootPlacement { heading, ..RootPlacement::default() });
        workspace.kinematics.body_rotation[body.root.body] * body.root.axes
    };
    assert!((facing(0.0) - Matrix3::identity()).norm() < 1e-12, "forward is world x, left y, up z");
    let turned = facing(0.3);
    assert!((turned.column(0) - Vector3::new(0.3_f64.cos(), 0.3_f64.sin(), 0.0)).norm() < 1e-12);
    assert!((turned.column(2) - Vector3::z()).norm() < 1e-12);
}

#[test]
fn heading_pitch_and_roll_are_read_back_from_the_orientation() {
    for [heading, pitch, roll] in [[0.3, 0.0, 0.0], [-3.0, 1.2, 0.4], [2.0, -1.5, -3.0], [0.0, 0.0, 3.1]] {
        let placement = RootPlacement { heading, pitch, roll, ..RootPlacement::default() };
        let (_, body, state, _) = placed("neutral", &placement);
        let (first, _) = body.root.free.unwrap();
        let found = body.turns(core::array::from_fn(|part| state.position[first + 3 + part]));
        let missed = found.iter().zip([heading, pitch, roll]).map(|(found, set)| (found - set).abs());
        assert!(missed.fold(0.0, f64::max) < 1e-12, "{found:?}");
    }
}

#[test]
fn a_body_lies_on_its_front_or_its_side() {
    let axes = |placement: RootPlacement| {
        let (_, body, _, workspace) = placed("neutral", &placement);
        workspace.kinematics.body_rotation[body.root.body] * body.root.axes
    };
    let quarter = core::f64::consts::FRAC_PI_2;
    let prone = axes(RootPlacement { pitch: quarter, ..RootPlacement::default() });
    assert!((prone.column(0) + Vector3::z()).norm() < 1e-12, "the front is below");
    assert!((prone.column(2) - Vector3::x()).norm() < 1e-12, "the head is ahead");
    let side = axes(RootPlacement { roll: quarter, ..RootPlacement::default() });
    assert!((side.column(1) - Vector3::z()).norm() < 1e-12, "the left side is above");
    let both = axes(RootPlacement { heading: quarter, pitch: quarter, ..RootPlacement::default() });
    assert!((both.column(2) - Vector3::y()).norm() < 1e-12, "first the heading, then the pitch");
}

#[test]
fn a_given_height_position_and_velocity_are_kept() {
    let placement =
        RootPlacement { height: Some(1.5), position: [2.0, -1.0], velocity: [0.3, 0.0, 0.1], ..RootPlacement::default() };
    let (_, _, state, _) = placed("neutral", &placement);
    assert_eq!(state.position[..3], [2.0, -1.0, 1.5]);
    assert_eq!(state.velocity[..6], [0.3, 0.0, 0.1, 0.0, 0.0, 0.0]);
}
