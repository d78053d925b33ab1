//! A bound body moved into a scene: indices follow, objects are appended.

use super::builder::Built;
use super::objects::Placed;
use crate::body::{Body, Connection, Joint, Landmark, Object, Root, subtree};
use msk_physics::model::{JointKind, Model};
use msk_program::scene::{Parent, SceneDescription};
use msk_program::vocabulary::{Group, GroupKind};
use nalgebra::{Matrix3, Vector3};

/// The body in the model that was built.
pub(super) fn bind(body: &Body, scene: &SceneDescription, placed: &Placed<'_>, built: &Built) -> Body {
    let model = &built.model;
    let geoms = |list: &[usize]| list.iter().map(|&geom| built.geoms[geom]).collect::<Vec<usize>>();
    let root = built.bodies[body.root.body];
    let members = subtree(model, root);
    let carried: Vec<usize> =
        placed.bodies.iter().map(|&object| built.bodies[object]).filter(|object| members.contains(object)).collect();
    let mut landmarks: Vec<Landmark> = body
        .landmarks
        .iter()
        .map(|landmark| Landmark { body: built.bodies[landmark.body], segment: geoms(&landmark.segment), ..landmark.clone() })
        .collect();
    let mut joints: Vec<Joint> = body.joints.iter().map(|joint| moved(joint.clone(), built.joints[joint.index], model)).collect();
    let first = landmarks.len();
    for (index, object) in scene.objects.iter().enumerate() {
        landmarks.push(Landmark {
            name: object.name.clone(),
            description: object.description.clone(),
            body: built.bodies[placed.bodies[index]],
            point: Vector3::zeros(),
            axes: Matrix3::identity(),
            segment: geoms(&carried_shapes(scene, placed, index)),
            of_scene: true,
        });
        joints.extend(placed.joints[index].iter().filter_map(|&joint| scene_joint(scene, placed, index, joint, built)));
    }
    let groups = scene.groups.iter().map(|(name, members)| Group {
        name: name.clone(),
        kind: GroupKind::Landmarks,
        members: members.iter().map(|member| first + member).collect(),
    });
    Body {
        root: Root { body: root, free: free(model, root), ..body.root.clone() },
        mass: if carried.is_empty() { model.bodies.subtree_mass[root] } else { body.mass },
        carried: sorted(carried),
        landmarks,
        joints,
        groups: body.groups.iter().cloned().chain(groups).collect(),
        shapes: geoms(&body.shapes),
        ground: walkable(body, scene, placed, built),
        objects: placed
            .bodies
            .iter()
            .zip(&placed.geoms)
            .map(|(&body, own)| object(model, built.bodies[body], geoms(own)))
            .collect(),
        level: body
            .ground
            .iter()
            .filter(|_| scene.ground.is_some())
            .chain(&placed.ground)
            .map(|&geom| built.geoms[geom])
            .collect(),
        connections: scene
            .connections
            .iter()
            .zip(&placed.connections)
            .map(|(connection, &equality)| Connection { equality, here: connection.here })
            .collect(),
        members,
        ..body.clone()
    }
}

fn sorted(mut list: Vec<usize>) -> Vec<usize> {
    list.sort_unstable();
    list
}

/// First coordinate and first dof of the free joint of a body.
fn free(model: &Model, body: usize) -> Option<(usize, usize)> {
    let joint = model.bodies.joints[body].clone().find(|&joint| model.joints.kind[joint] == JointKind::Free)?;
    Some((model.joints.position_address[joint], model.joints.dof_address[joint]))
}

fn object(model: &Model, body: usize, shapes: Vec<usize>) -> Object {
    let placed = model.bodies.mocap[body].then(|| model.bodies.mocap[..body].iter().filter(|placed| **placed).count());
    Object { body, free: free(model, body), placed, shapes }
}

/// A joint at its new place.
fn moved(joint: Joint, index: usize, model: &Model) -> Joint {
    Joint { index, position: model.joints.position_address[index], dof: model.joints.dof_address[index], ..joint }
}

/// A hinge or slide of an object under its name in tasks.
fn scene_joint(scene: &SceneDescription, placed: &Placed<'_>, object: usize, joint: usize, built: &Built) -> Option<Joint> {
    let msk_program::scene::Motion::Joints(described) = &scene.objects[object].motion else { return None };
    let place = placed.joints[object].iter().position(|&own| own == joint)?;
    let index = built.joints[joint];
    let kind = built.model.joints.kind[index];
    if !matches!(kind, JointKind::Hinge | JointKind::Slide) {
        return None;
    }
    let joint = Joint {
        name: described.get(place)?.name.clone(),
        index,
        kind,
        position: 0,
        dof: 0,
        range: built.model.joints.range[index],
        independent: true,
        of_scene: true,
    };
    Some(moved(joint, index, &built.model))
}

/// The solid shapes of an object and of everything that it carries.
fn carried_shapes(scene: &SceneDescription, placed: &Placed<'_>, object: usize) -> Vec<usize> {
    let mut within = vec![false; scene.objects.len()];
    within[object] = true;
    // Parents stand before what they carry.
    for (index, other) in scene.objects.iter().enumerate() {
        if let Parent::Object(parent) = other.parent {
            within[index] |= within[parent];
        }
    }
    let solid = |&index: &usize| within[index] && scene.objects[index].surface.solid;
    (0..within.len()).filter(solid).flat_map(|index| placed.geoms[index].clone()).collect()
}

/// Everything to stand on: the ground, and the solids that the scene calls walkable.
fn walkable(body: &Body, scene: &SceneDescription, placed: &Placed<'_>, built: &Built) -> Vec<usize> {
    let own = body.ground.iter().filter(|_| scene.ground.is_some()).copied();
    let objects = scene.objects.iter().zip(&placed.geoms).filter(|(object, _)| object.surface.walkable && object.surface.solid);
    let all = own.chain(placed.ground).chain(objects.flat_map(|(_, geoms)| geoms.iter().copied()));
    all.map(|geom| built.geoms[geom]).collect()
}
