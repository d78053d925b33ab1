mod ground;
mod kept;

use super::*;
use crate::bodies;
use crate::body::Body;
use msk_physics::model::Model;
use msk_physics::{State, Workspace, forward};
use msk_program::scene::{Motion, Object, ObjectJoint, ObjectJointKind, Parent, Shape, Surface};

/// An object at rest in the world.
pub(super) fn object(name: &str, shape: Option<Shape>, position: [f64; 3]) -> Object {
    Object {
        name: name.into(),
        description: String::new(),
        parent: Parent::World,
        position,
        orientation: [1.0, 0.0, 0.0, 0.0],
        motion: Motion::Fixed,
        shape,
        mass: 0.0,
        surface: Surface::default(),
    }
}

fn joint(name: &str, kind: ObjectJointKind) -> ObjectJoint {
    ObjectJoint {
        name: name.into(),
        kind,
        axis: [0.0, 0.0, -1.0],
        anchor: [0.0, 0.1, 0.0],
        range: Some([0.0, 1.5]),
        damping: 0.05,
        stiffness: 0.2,
        friction_loss: 0.0,
    }
}

/// A door that swings, a ball that flies, a load on the trunk and a shelf, of shapes that need no others' colliders.
fn scene() -> SceneDescription {
    let door = Object {
        motion: Motion::Joints(vec![joint("door.swing", ObjectJointKind::Hinge)]),
        ..object("door", None, [1.0, 0.5, 0.0])
    };
    let leaf = Object {
        parent: Parent::Object(0),
        mass: 19.0,
        orientation: [0.6, 0.0, 0.8, 0.0],
        ..object("door.leaf", Some(Shape::Capsule(0.1, 1.2)), [0.0, 0.5, 1.0])
    };
    let ball = Object { motion: Motion::Free, mass: 0.4, ..object("ball", Some(Shape::Sphere(0.11)), [2.0, 0.0, 1.0]) };
    let load = Object {
        parent: Parent::Landmark("chest".into()),
        mass: 20.0,
        ..object("load", Some(Shape::Ellipsoid([0.1, 0.6, 0.1])), [0.3, 0.0, 0.1])
    };
    let shelf = Object {
        surface: Surface { friction: [0.7, 0.01, 0.001], decides: false, solid: true, walkable: true },
        ..object("shelf", Some(Shape::Ellipsoid([0.5, 0.5, 0.1])), [-2.0, 0.0, 0.2])
    };
    SceneDescription {
        ground: Some(Surface { walkable: true, ..Surface::default() }),
        objects: vec![door, leaf, ball, load, shelf],
        connections: vec![],
        groups: vec![("things".into(), vec![2, 4])],
    }
}

pub(super) fn human() -> (Model, Body) {
    let library = crate::library::BodyLibrary::default();
    let file = bodies::builtin("human").unwrap();
    let compilation = msk_compiler::compile(&file.path, &crate::library::FileLoader, &library).unwrap();
    let bound = library.bind(&compilation.bodies[0]).unwrap();
    ((*bound.model).clone(), (*bound.body).clone())
}

#[test]
fn a_scene_is_the_model_that_its_file_gives() {
    let (model, body) = human();
    let (staged, _) = stage(&model, &body, &scene()).unwrap();
    let read = Model::from_mjcf(&staged.to_mjcf()).unwrap();
    // Whole models do not print well: the parts are compared first.
    assert_eq!(staged.bodies, read.bodies);
    assert_eq!(staged.joints, read.joints);
    assert_eq!(staged.dofs, read.dofs);
    assert_eq!(staged.geoms, read.geoms);
    assert!(staged == read);
}

#[test]
fn an_empty_scene_changes_nothing() {
    let (model, body) = human();
    let ground = SceneDescription { ground: Some(Surface::default()), ..SceneDescription::default() };
    let (staged, bound) = stage(&model, &body, &ground).unwrap();
    assert!(staged == model && bound == body);
    let (bare, bound) = stage(&model, &body, &SceneDescription::default()).unwrap();
    assert!(bound.ground.is_empty() && bare.geoms.contact_type[body.ground[0]] == 0, "without `ground` there is none");
}

#[test]
fn the_vocabulary_of_a_scene_is_the_compilers() {
    let (model, body) = human();
    let (staged, bound) = stage(&model, &body, &scene()).unwrap();
    let (found, expected) = (bound.vocabulary(&staged), body.vocabulary(&model).with_scene(&scene()));
    let names = |vocabulary: &msk_program::vocabulary::Vocabulary| {
        let landmarks =
            vocabulary.landmarks.iter().map(|landmark| (landmark.name.clone(), landmark.of_scene, landmark.has_segment));
        let joints = vocabulary.joints.iter().map(|joint| (joint.name.clone(), joint.of_scene, joint.range));
        (landmarks.collect::<Vec<_>>(), joints.collect::<Vec<_>>(), vocabulary.groups.clone())
    };
    assert_eq!(names(&found), names(&expected));
    assert!((found.mass - expected.mass).abs() < 1e-12, "what is carried is not counted");
    for k in 0..3 {
        assert!((found.neutral_com[k] - expected.neutral_com[k]).abs() < 1e-9);
    }
    for (found, expected) in found.landmarks.iter().zip(&expected.landmarks) {
        for k in 0..3 {
            assert!((found.neutral_position[k] - expected.neutral_position[k]).abs() < 1e-9, "{}", found.name);
        }
        for k in 0..9 {
            assert!((found.neutral_axes[k] - expected.neutral_axes[k]).abs() < 1e-9, "{}", found.name);
        }
    }
}

#[test]
fn a_scene_is_built_fast() {
    let (model, body) = human();
    let begun = std::time::Instant::now();
    let (staged, _) = stage(&model, &body, &scene()).unwrap();
    println!("a scene of {} bodies was built in {:.1} ms", staged.bodies.name.len(), 1e3 * begun.elapsed().as_secs_f64());
}

#[test]
fn a_carried_load_weighs_on_the_body_but_is_no_part_of_it() {
    let (model, body) = human();
    let (staged, bound) = stage(&model, &body, &scene()).unwrap();
    assert_eq!(bound.carried.len(), 1);
    assert!((staged.bodies.subtree_mass[bound.root.body] - bound.mass - 20.0).abs() < 1e-9);
    assert_eq!(bound.own().count(), body.own().count());
    let (mut state, mut workspace) = (State::new(&staged), Workspace::new(&staged));
    bound.place(&staged, &Default::default(), bound.neutral(), &mut state, &mut workspace);
    forward(&staged, &state, &mut workspace).unwrap();
    let (mut alone, mut own) = (State::new(&model), Workspace::new(&model));
    body.place(&model, &Default::default(), body.neutral(), &mut alone, &mut own);
    forward(&model, &alone, &mut own).unwrap();
    let found = bound.centre_of_mass(&staged, &workspace.kinematics);
    let expected = body.centre_of_mass(&model, &own.kinematics);
    assert!((found - expected).norm() < 1e-12, "{found} is not {expected}");
}

#[test]
fn what_makes_no_sense_is_reported_with_its_name() {
    let (model, body) = human();
    let error_of = |object: Object| {
        let scene = SceneDescription { objects: vec![object], ..SceneDescription::default() };
        stage(&model, &body, &scene).unwrap_err().to_string()
    };
    let ball = |position| object("ball", Some(Shape::Sphere(0.1)), position);
    let nowhere = Object { parent: Parent::Landmark("chests".into()), ..ball([0.0; 3]) };
    assert_eq!(
        error_of(nowhere),
        "object `ball` names `chests`, which is neither a landmark of the body nor an object of the scene before it"
    );
    let flat = object("ball", Some(Shape::Sphere(0.0)), [0.0; 3]);
    assert_eq!(error_of(flat), "the size of `ball` is 0; it must be positive");
    assert!(error_of(ball([f64::NAN, 0.0, 0.0])).contains("position of `ball` is NaN"));
    let light = Object { motion: Motion::Free, ..ball([0.0; 3]) };
    assert!(error_of(light).contains("has no mass"));
    let carried = Object { motion: Motion::Free, parent: Parent::Landmark("chest".into()), mass: 1.0, ..ball([0.0; 3]) };
    assert!(error_of(carried).contains("only a body that is a child of the world can be free"));
    let turned = Object { orientation: [0.0; 4], ..ball([0.0; 3]) };
    assert_eq!(error_of(turned), "object `ball`: its orientation is not a rotation");
}
