//! Bodies in scenes move as MuJoCo 4.0.0 moves them: `tests/oracle/scenes.py` made the golden numbers from files, here the same
//! scenes are built from their descriptions.

use crate::support;

use msk_compiler::body::{Axis, BodyDescription, LandmarkDescription};
use msk_compiler::scene::{Connection, Motion, Object, ObjectJoint, ObjectJointKind, Parent, SceneDescription, Shape, Surface};
use msk_physics::model::Model;
use msk_physics::{State, Workspace, forward};
use msk_runtime::body::Body;
use msk_runtime::scene::stage;
use support::{golden, numbers, repository};

fn landmark(name: &str, body: &str, point: [f64; 3]) -> LandmarkDescription {
    LandmarkDescription {
        name: name.into(),
        description: String::new(),
        body: body.into(),
        point,
        forward: Axis::PlusX,
        up: Axis::PlusZ,
        segment: vec![],
    }
}

fn porter() -> (Model, Body) {
    let model = Model::from_file(repository("tests/oracle/models/scene_body.xml")).unwrap();
    let description = BodyDescription {
        name: "porter".into(),
        root: "trunk".into(),
        root_forward: Axis::PlusX,
        root_up: Axis::PlusZ,
        landmarks: vec![
            landmark("back", "trunk", [-0.2, 0.0, 0.05]),
            landmark("hand_l", "arm_l", [0.5, 0.0, 0.0]),
            landmark("hand_r", "arm_r", [0.5, 0.0, 0.0]),
        ],
        poses: vec![("neutral".into(), vec![])],
        ..BodyDescription::default()
    };
    let body = Body::bind(&description, &model).unwrap();
    (model, body)
}

fn object(name: &str, parent: Parent, position: [f64; 3], shape: Option<(Shape, f64)>) -> Object {
    Object {
        name: name.into(),
        description: String::new(),
        parent,
        position,
        orientation: [1.0, 0.0, 0.0, 0.0],
        motion: Motion::Fixed,
        mass: shape.as_ref().map_or(0.0, |(_, mass)| *mass),
        shape: shape.map(|(shape, _)| shape),
        surface: Surface::default(),
    }
}

fn hinge(name: &str, axis: [f64; 3], anchor: [f64; 3], damping: f64) -> ObjectJoint {
    ObjectJoint {
        name: name.into(),
        kind: ObjectJointKind::Hinge,
        axis,
        anchor,
        range: None,
        damping,
        stiffness: 0.0,
        friction_loss: 0.0,
    }
}

/// A quarter turn about x.
const ALONG_Y: [f64; 4] = [core::f64::consts::FRAC_1_SQRT_2, core::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0];

fn rough(friction: [f64; 3]) -> Surface {
    Surface { friction, ..Surface::default() }
}

fn door() -> SceneDescription {
    let swing = ObjectJoint { range: Some([0.0, 1.5]), stiffness: 0.2, ..hinge("door.swing", [0.0, 0.0, -1.0], [0.0; 3], 0.05) };
    let frame = Object { motion: Motion::Joints(vec![swing]), ..object("door", Parent::World, [0.5, -0.4, 0.1], None) };
    let leaf = Some((Shape::Ellipsoid([0.04, 0.5, 1.0]), 19.4));
    let handle = Object {
        orientation: ALONG_Y,
        surface: rough([0.7, 0.01, 0.0001]),
        ..object("door.handle", Parent::Object(0), [-0.08, 0.8, 0.9], Some((Shape::Capsule(0.03, 0.2), 0.5)))
    };
    around(vec![frame, object("door.leaf", Parent::Object(0), [0.0, 0.4, 1.0], leaf), handle])
}

fn ball_and_board() -> SceneDescription {
    let board = object("board", Parent::World, [0.0, 0.0, 0.05], Some((Shape::Ellipsoid([0.4, 0.6, 0.05]), 0.0)));
    let ball = Object {
        motion: Motion::Free,
        surface: rough([0.8, 0.02, 0.001]),
        ..object("ball", Parent::World, [0.6, 0.0, 1.2], Some((Shape::Sphere(0.11), 0.4)))
    };
    let pole = object("pole", Parent::World, [0.3, 0.5, 1.0], Some((Shape::Capsule(0.05, 2.0), 0.0)));
    around(vec![board, ball, pole])
}

fn load() -> SceneDescription {
    let box_on_back =
        object("load", Parent::Landmark("back".into()), [0.0, 0.0, 0.2], Some((Shape::Ellipsoid([0.15, 0.2, 0.25]), 12.0)));
    let flap = Object {
        motion: Motion::Joints(vec![hinge("load.hinge", [0.0, 1.0, 0.0], [0.1, 0.0, 0.0], 0.1)]),
        ..object("load.flap", Parent::Object(0), [0.0, 0.0, 0.3], Some((Shape::Sphere(0.1), 1.0)))
    };
    around(vec![box_on_back, flap])
}

fn bar() -> SceneDescription {
    let frame = Object { motion: Motion::Free, ..object("bar", Parent::World, [0.5, 0.0, 1.4], None) };
    let shaft = Object {
        orientation: ALONG_Y,
        surface: Surface { solid: false, ..Surface::default() },
        ..object("bar.shaft", Parent::Object(0), [0.0; 3], Some((Shape::Capsule(0.02, 1.2), 8.0)))
    };
    let hold = |weld, from: &str| Connection { weld, from: from.into(), to: "bar".into(), here: false };
    SceneDescription { connections: vec![hold(true, "hand_l"), hold(false, "hand_r")], ..around(vec![frame, shaft]) }
}

fn around(objects: Vec<Object>) -> SceneDescription {
    SceneDescription { ground: Some(Surface { walkable: true, ..Surface::default() }), objects, ..SceneDescription::default() }
}

fn assert_near(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "{what}[{index}]: {a:e} is not MuJoCo's {b:e}");
    }
}

/// The built scene has MuJoCo's constants and, at random states, its rows and accelerations.
fn compare(name: &str, scene: &SceneDescription) {
    let expected = &golden("scenes")[name];
    let (model, body) = porter();
    let (mut model, _) = stage(&model, &body, scene).unwrap();
    (model.options.iterations, model.options.tolerance) = (100, 1e-10);
    // A frame of its own for the bar's shaft is one body more than in the file: only names that both have are compared.
    let names: Vec<&str> = expected["bodies"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let own = |name: &&str| model.bodies.name.iter().position(|known| known == name).unwrap();
    let bodies: Vec<usize> = names.iter().map(own).collect();
    assert!(bodies.windows(2).all(|pair| pair[0] < pair[1]), "bodies stand in MuJoCo's order");
    // What stands still has a mass in MuJoCo, here it needs none.
    let theirs = numbers(&expected["body_subtreemass"]);
    for (&body, theirs) in bodies.iter().zip(theirs).filter(|(body, _)| model.bodies.weld[**body] != 0) {
        assert_near(&model.bodies.name[body], &[model.bodies.subtree_mass[body]], &[theirs], 1e-14);
    }
    assert_near("dof_invweight0", &model.dofs.inverse_weight, &numbers(&expected["dof_invweight0"]), 1e-12);
    assert_near("qpos0", &model.reference_position, &numbers(&expected["qpos0"]), 1e-15);
    let (mut workspace, mut worst) = (Workspace::new(&model), 0.0_f64);
    for (index, case) in expected["states"].as_array().unwrap().iter().enumerate() {
        let mut state = State::new(&model);
        state.position = numbers(&case["qpos"]);
        state.velocity = numbers(&case["qvel"]);
        forward(&model, &state, &mut workspace).unwrap();
        let constraints = &workspace.lanes[0].constraints;
        let what = format!("{name}, state {index}");
        assert_eq!(constraints.contacts.len(), case["contacts"].as_array().unwrap().len(), "{what}: contacts");
        assert_eq!(constraints.rows.len() as u64, case["rows"].as_u64().unwrap(), "{what}: rows");
        // Ellipsoids meet in MuJoCo by an iterative collider, which stops at a tolerance of 1e-6.
        assert_near(&format!("{what}: efc_pos"), &constraints.rows.position, &numbers(&case["efc_pos"]), 1e-6);
        let found = &workspace.acceleration;
        let expected = numbers(&case["qacc"]);
        let scale = expected.iter().fold(1.0_f64, |scale, value| scale.max(value.abs()));
        for (dof, (a, b)) in found.iter().zip(&expected).enumerate() {
            worst = worst.max((a - b).abs() / scale);
            assert!((a - b).abs() <= 1e-4 * scale, "{what}: qacc[{dof}] is {a:e}, MuJoCo's {b:e}");
        }
    }
    println!("{name}: accelerations differ by {worst:e} of the largest at most");
}

#[test]
fn a_door_with_a_handle() {
    compare("door", &door());
}

#[test]
fn a_ball_a_board_and_a_pole() {
    compare("ball_and_board", &ball_and_board());
}

#[test]
fn a_load_on_the_back_with_a_flap() {
    compare("load", &load());
}

#[test]
fn a_bar_in_both_hands() {
    compare("bar", &bar());
}
