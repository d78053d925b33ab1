//! Sensors and key frames of a model in a scene.

use super::*;
use msk_physics::model::{GeomKind, JointKind};
use msk_physics::sensors::readings;
use nalgebra::Vector3;

const MODEL: &str = r#"<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="arm" pos="0 0 1">
      <joint name="shoulder" axis="0 1 0"/>
      <geom name="arm" type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
      <site name="hand" pos="0.3 0 0"/>
      <body name="finger" pos="0.3 0 0"><joint name="knuckle" type="ball"/><geom name="finger" size="0.02" pos="0 0 0.05"/></body>
    </body>
    <body name="cart" pos="0 1 1"><joint name="rail" type="slide" axis="1 0 0"/><geom name="cart" size="0.1"/><site name="flag"/></body>
    <body name="goal" mocap="true" pos="3 0 0"/>
  </worldbody>
  <actuator><position name="reach" joint="shoulder" kp="20"/></actuator>
  <sensor>
    <jointpos joint="rail"/>
    <ballquat joint="knuckle"/>
    <framepos objtype="site" objname="flag" reftype="geom" refname="finger"/>
    <framelinvel objtype="xbody" objname="cart"/>
    <gyro site="hand"/>
    <subtreecom body="arm"/>
    <actuatorfrc actuator="reach"/>
  </sensor>
  <keyframe>
    <key name="start"/>
    <key name="up" time="0.5" qpos="0.7 0.6 0.8 0 0 0.4" qvel="0.1 0.2 0.3 0.4 0.5" ctrl="0.3" mpos="2 1 0"/>
  </keyframe>
</mujoco>"#;

#[test]
fn sensors_and_key_frames_mean_the_same_in_a_scene() {
    let base = Model::from_mjcf(MODEL).unwrap();
    let mut builder = SceneBuilder::new(&base);
    // A pendulum between the model's own bodies, and a ball after them.
    let pendulum = builder.body(NewBody { name: "pendulum".into(), parent: 0, ..NewBody::default() });
    builder.joint(pendulum, NewJoint { name: "swing".into(), kind: JointKind::Hinge, axis: Vector3::y(), ..NewJoint::default() });
    let sphere = |name: &str| NewGeom {
        name: name.into(),
        kind: GeomKind::Sphere,
        size: Vector3::new(0.05, 0.0, 0.0),
        mass: 1.0,
        position: Vector3::new(0.0, 0.0, 3.0),
        contact_type: 0,
        contact_affinity: 0,
        ..NewGeom::default()
    };
    builder.geom(pendulum, sphere("bob"));
    let ring = builder.body(NewBody { name: "ring".into(), parent: 1, ..NewBody::default() });
    builder.joint(ring, NewJoint { name: "spin".into(), kind: JointKind::Ball, ..NewJoint::default() });
    builder.geom(ring, NewGeom { mass: 1e-9, position: Vector3::zeros(), ..sphere("ring") });
    let staged = builder.build().unwrap().model;
    assert!(Model::from_mjcf(&staged.to_mjcf()).unwrap() == staged, "{}", staged.to_mjcf());

    assert_eq!(staged.keyframes.iter().map(|frame| frame.name.as_str()).collect::<Vec<_>>(), ["start", "up"]);
    for (alone, among) in base.keyframes.iter().zip(&staged.keyframes) {
        let read = |model: &Model, frame: &msk_physics::model::Keyframe| {
            let (state, mut workspace) = (frame.state(model), Workspace::new(model));
            forward(model, &state, &mut workspace).unwrap();
            (state.time, state.control.clone(), state.mocap_position.clone(), readings(model, &state, &workspace))
        };
        let (alone, among) = (read(&base, alone), read(&staged, among));
        assert_eq!((alone.0, alone.1, alone.2), (among.0, among.1, among.2));
        for (alone, among) in alone.3.iter().zip(&among.3) {
            assert!((alone - among).abs() < 1e-8, "{alone} alone, {among} in the scene");
        }
    }
}
