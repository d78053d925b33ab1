//! Silhouettes: the collision shapes of each limb as one outline.

use super::camera::Camera;
use super::outline::Shape;
use super::panel::{Item, Panel};
use super::path::Path;
use msk_physics::collision::{Asset, Placed};
use msk_physics::model::{GeomKind, Model};
use msk_runtime::body::sensors::Snapshot;
use msk_runtime::body::shape::support;

/// Parts lighter than this share of the body are no limbs of their own.
const SMALLEST_LIMB: f64 = 0.02;

/// What is nearer to the viewer than the middle of the body by more than this stands before it, m.
const BEFORE: f64 = 0.25;

/// Distance from the nearest tone to the farthest, m.
const DEPTH_OF_TONES: f64 = 0.5;

/// Adds the body's silhouettes: one item per limb, behind everything that lies in it.
pub(super) fn add(snapshot: &Snapshot<'_>, camera: &Camera, panel: &mut Panel) {
    let limbs = limbs(snapshot.model, snapshot.body.members.clone());
    let com = snapshot.workspace.kinematics.subtree_com[snapshot.body.root.body];
    let count = limbs.iter().max().map_or(0, |last| last + 1);
    for limb in 0..count {
        let (mut path, mut depth) = (Path::default(), f64::NEG_INFINITY);
        let (mut middle, mut shapes) = (0.0, 0.0_f64);
        for &geom in &snapshot.body.shapes {
            let geoms = &snapshot.model.geoms;
            if limbs[geoms.body[geom] - snapshot.body.members.start] != limb {
                continue;
            }
            let shape = shape(snapshot, geom);
            shape.outline(camera, &mut path);
            let away = shape.rotation.transpose() * camera.away();
            middle += camera.depth(shape.centre);
            shapes += 1.0;
            depth = depth.max(camera.depth(shape.centre) + support(shape.kind, shape.size, away));
        }
        let offset = middle / shapes.max(1.0) - camera.depth(com);
        panel.add(Item::Silhouette { depth, path, near: 0.6 - offset / DEPTH_OF_TONES });
    }
}

/// Adds the shapes of the scene, what the body carries among them, other than level ground: what is solid, and every object.
pub(super) fn add_scenery(snapshot: &Snapshot<'_>, camera: &Camera, panel: &mut Panel) {
    let geoms = &snapshot.model.geoms;
    let nearest = camera.depth(snapshot.workspace.kinematics.subtree_com[snapshot.body.root.body]) - BEFORE;
    for geom in 0..geoms.body.len() {
        let solid = geoms.contact_type[geom] != 0 || geoms.contact_affinity[geom] != 0;
        let shown = solid || snapshot.body.objects.iter().any(|object| object.body == geoms.body[geom]);
        if !shown || geoms.kind[geom] == GeomKind::Plane || snapshot.body.owns(geoms.body[geom]) {
            continue;
        }
        let shape = shape(snapshot, geom);
        let mut path = Path::default();
        match Placed::of(snapshot.model, &snapshot.workspace.kinematics, 0, geom).asset {
            Asset::HeightField(field) => shape.relief(field, camera, &mut path),
            _ => shape.outline(camera, &mut path),
        }
        let depth = camera.depth(shape.centre);
        panel.add(Item::Scenery { depth, path, before: depth < nearest });
    }
}

fn shape<'a>(snapshot: &Snapshot<'a>, geom: usize) -> Shape<'a> {
    let (geoms, kinematics) = (&snapshot.model.geoms, &snapshot.workspace.kinematics);
    Shape {
        kind: geoms.kind[geom],
        size: Placed::of(snapshot.model, kinematics, 0, geom).size,
        centre: kinematics.geom_position[geom],
        rotation: kinematics.geom_rotation[geom],
        mesh: geoms.asset[geom].filter(|_| geoms.kind[geom] == GeomKind::Mesh).map(|asset| &snapshot.model.meshes[asset]),
    }
}

/// The limb of each member: 0 is the trunk, from which limbs branch off where the tree parts into heavy branches. A branch
/// that parts again (the shoulder girdle, the pelvis) still counts as trunk.
pub(super) fn limbs(model: &Model, members: core::ops::Range<usize>) -> Vec<usize> {
    let bodies = &model.bodies;
    let threshold = SMALLEST_LIMB * bodies.subtree_mass[members.start];
    let heavy = |body: usize| bodies.subtree_mass[body] >= threshold;
    let children = |parent: usize| members.clone().filter(move |&body| body > parent && bodies.parent[body] == parent);
    let parts = |body: usize| children(body).filter(|&child| heavy(child)).count() > 1;
    // From the leaves to the root: whether anything at or below a body parts.
    let mut inner = vec![false; members.len()];
    for body in members.clone().rev() {
        inner[body - members.start] = parts(body) || children(body).any(|child| inner[child - members.start]);
    }
    let mut limb = vec![0; members.len()];
    let mut count = 1;
    for body in members.clone().skip(1) {
        let (index, parent) = (body - members.start, bodies.parent[body] - members.start);
        let branches = !inner[index] && inner[parent] && heavy(body);
        limb[index] = if branches { count } else { limb[parent] };
        count += usize::from(branches);
    }
    limb
}
