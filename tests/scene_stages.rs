//! A sitting body on a chair, before stairs, among cubes and poles, on a slope and on waves: built from descriptions, written
//! as MJCF, and stage by stage the same in MuJoCo 4.0.0, which read what was written.
//!
//! `MSK_UPDATE=1 cargo test --test parity scene_stages written` writes `tests/oracle/scene_models/*.xml`, from which
//! `tests/oracle/rows.py` makes the golden numbers.

use crate::support;

use msk_compiler::body::{Axis, BodyDescription};
use msk_compiler::scene::{Motion, Object, Parent, SceneDescription, Shape, Surface, Terrain};
use msk_physics::Workspace;
use msk_physics::model::Model;
use msk_runtime::body::Body;
use msk_runtime::scene::stage;
use support::{golden, repository, rows};

/// A thing in the world, with its shape.
fn object(name: &str, position: [f64; 3], shape: Shape) -> Object {
    Object {
        name: name.into(),
        description: String::new(),
        parent: Parent::World,
        position,
        orientation: [1.0, 0.0, 0.0, 0.0],
        motion: Motion::Fixed,
        shape: Some(shape),
        mass: 0.0,
        surface: Surface::default(),
    }
}

fn free(name: &str, position: [f64; 3], shape: Shape, mass: f64) -> Object {
    Object { motion: Motion::Free, mass, ..object(name, position, shape) }
}

/// Thighs on the seat, feet on the ground, the back a few millimetres before the backrest.
fn chair() -> Vec<Object> {
    let mut seat = object("seat", [0.05, 0.0, 0.475], Shape::Box([0.45, 0.5, 0.05]));
    seat.surface.friction = [2.0, 0.1, 0.1];
    let legs = [[-0.15, -0.2], [-0.15, 0.2], [0.25, -0.2], [0.25, 0.2]].into_iter().enumerate();
    let leg = |(index, [x, y]): (usize, [f64; 2])| object(&format!("leg_{index}"), [x, y, 0.225], Shape::Box([0.04, 0.04, 0.45]));
    let back = object("back", [-0.145, 0.0, 0.85], Shape::Box([0.05, 0.5, 0.7]));
    [seat, back].into_iter().chain(legs.map(leg)).collect()
}

/// Feet on the first tread, toes before the next riser.
fn stairs() -> Vec<Object> {
    let flight = Terrain::Stairs { count: 4, rise: 0.175, run: 0.265, width: 1.2 };
    vec![object("flight", [0.35, 0.0, -0.17], Shape::Terrain(flight))]
}

/// Two cubes on each other between the feet, one in the lap.
fn cube() -> Vec<Object> {
    let cube = Shape::Box([0.1; 3]);
    vec![
        free("lower", [0.45, 0.0, 0.05], cube.clone(), 0.5),
        free("upper", [0.45, 0.01, 0.15], cube, 0.3),
        free("lap", [0.25, 0.0, 0.688], Shape::Box([0.2, 0.3, 0.1]), 1.0),
    ]
}

/// Poles beside both arms and before the chest.
fn poles() -> Vec<Object> {
    vec![
        object("left", [0.3, 0.285, 1.0], Shape::Cylinder(0.05, 2.0)),
        object("right", [0.3, -0.285, 1.0], Shape::Capsule(0.05, 1.9)),
        object("ahead", [0.165, 0.0, 1.0], Shape::Cylinder(0.05, 2.0)),
    ]
}

/// Feet on a slope.
fn slope() -> Vec<Object> {
    let slope = Terrain::Slope { length: 1.0, width: 1.0, angle: 0.1 };
    vec![object("slope", [0.2, 0.0, -0.02], Shape::Terrain(slope))]
}

/// Feet on long waves.
fn wave() -> Vec<Object> {
    let [columns, rows] = [25, 9];
    let crest = |share: f64| 0.1 * share * (1.0 - share);
    let height = |x: usize, y: usize| crest((x % 8) as f64 / 8.0) + 0.002 * y as f64 - 0.02;
    let heights = (0..rows).flat_map(|y| (0..columns).map(move |x| height(x, y))).collect();
    let waves = Terrain::Heights { size: [1.2, 0.8], samples: [columns, rows], heights };
    vec![object("waves", [0.0, 0.0, 0.005], Shape::Terrain(waves))]
}

/// The sitting body among some objects. On waves it has round feet: MuJoCo's depth of a box in a height field is not the least.
fn built(objects: Vec<Object>) -> Model {
    let mut text = std::fs::read_to_string(repository("tests/oracle/models/scene_sitter.xml")).unwrap();
    if objects.iter().any(|object| matches!(object.shape, Some(Shape::Terrain(Terrain::Heights { .. })))) {
        let flat = r#"type="box" pos="0.05 0 -0.04" size="0.1 0.045 0.03""#;
        assert_eq!(text.matches(flat).count(), 2);
        text = text.replace(flat, r#"type="capsule" fromto="-0.02 0 -0.04 0.12 0 -0.04" size="0.03""#);
    }
    let model = Model::from_mjcf(&text).unwrap();
    let description = BodyDescription {
        name: "sitter".into(),
        root: "trunk".into(),
        root_forward: Axis::PlusX,
        root_up: Axis::PlusZ,
        poses: vec![("neutral".into(), vec![])],
        ..BodyDescription::default()
    };
    let body = Body::bind(&description, &model).unwrap();
    let ground = Some(Surface { walkable: true, ..Surface::default() });
    stage(&model, &body, &SceneDescription { ground, objects, ..SceneDescription::default() }).unwrap().0
}

fn scenes() -> [(&'static str, Model); 6] {
    [
        ("chair", built(chair())),
        ("cube", built(cube())),
        ("poles", built(poles())),
        ("slope", built(slope())),
        ("stairs", built(stairs())),
        ("wave", built(wave())),
    ]
}

#[test]
fn scenes_are_written_as_mujoco_read_them() {
    for (name, model) in scenes() {
        let path = repository("tests/oracle/scene_models").join(format!("{name}.xml"));
        if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
            std::fs::write(&path, model.to_mjcf()).unwrap();
        }
        let written = std::fs::read_to_string(&path).unwrap();
        assert!(written == model.to_mjcf(), "{name}: the scene is no longer the one of the golden numbers");
    }
}

/// Where shapes meet, and what leads there: the names of `tests/oracle/rows.py`.
fn stages(workspace: &Workspace<f64>) -> Vec<(&'static str, f64, Vec<f64>)> {
    let contacts = &workspace.lanes[0].constraints.contacts;
    let flat = |values: &dyn Fn(&msk_physics::collision::Contact) -> Vec<f64>| contacts.iter().flat_map(values).collect();
    vec![
        ("geom_xpos", 1e-12, workspace.kinematics.geom_position.iter().flatten().copied().collect()),
        ("bias", 1e-10, workspace.forces.bias.clone()),
        ("contact_geoms", 0.0, flat(&|contact| contact.geoms.map(|geom| geom as f64).to_vec())),
        ("contact_dist", 1e-8, flat(&|contact| vec![contact.distance])),
        ("contact_pos", 1e-8, flat(&|contact| contact.position.iter().copied().collect())),
        ("contact_normal", 1e-8, flat(&|contact| contact.frame.row(0).iter().copied().collect())),
    ]
}

macro_rules! stages {
    ($($name:ident: $slack:literal),*) => {
        $(mod $name {
            #[test]
            fn moves_as_in_mujoco() {
                let name = stringify!($name);
                let model = super::built(super::$name());
                super::rows::compare(name, &model, &super::golden(&format!("stages_{name}")), 1e-6, $slack, super::stages);
            }
        })*
    };
}

// Cylinders and height fields meet in MuJoCo by an iterative collider, whose contacts are good to some 1e-8 m.
stages!(chair: 1.0, cube: 1.0, poles: 1e3, slope: 1.0, stairs: 1.0, wave: 1e3);
