//! What of a model does not change over an episode, as the page needs it: the tree, shapes, muscles with their paths.

use crate::shapes::{self, Shape, Surface};
use msk_physics::model::{GeomKind, JointKind, Model, PathPoint};
use msk_runtime::body::Body;
use msk_runtime::body::sensors::Snapshot;
use nalgebra::Vector3;
use serde::Serialize;

/// A model. Lengths in m, quaternions w x y z.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Anatomy {
    pub bodies: Vec<Part>,
    pub shapes: Vec<Shape>,
    pub meshes: Vec<Surface>,
    pub muscles: Vec<Muscle>,
    pub families: Vec<String>,
    pub wraps: Vec<Wrap>,
    /// Names of hinges and slides with their places among the coordinates, and whether they turn.
    pub joints: Vec<(String, usize, bool)>,
    pub landmarks: Vec<Landmark>,
    /// The body that everything hangs on.
    pub root: usize,
    /// Weight of the body, N.
    pub weight: f64,
    /// Whether the level z = 0 is to stand on.
    pub ground: bool,
}

/// A named place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Landmark {
    pub name: String,
    pub body: usize,
    pub point: [f64; 3],
    /// Its anatomical axis upwards.
    pub up: [f64; 3],
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Part {
    pub name: String,
    pub parent: usize,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    pub joints: Vec<Joint>,
    /// Whether it is a part of the body and not of the scene.
    pub own: bool,
    /// Whether a bone leads to it from its parent: it, or what hangs on it, has a shape.
    pub bone: bool,
    /// Its place among the bodies that are placed from outside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub placed: Option<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Joint {
    pub kind: &'static str,
    /// First coordinate.
    pub at: usize,
    pub axis: [f64; 3],
    pub anchor: [f64; 3],
    /// Coordinate at which the joint moves nothing.
    pub reference: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Muscle {
    pub name: String,
    /// Index among the families.
    pub family: usize,
    /// Peak isometric force of the healthy muscle, N.
    pub force: f64,
    /// Active force over that of the healthy muscle.
    pub strength: f64,
    /// Optimal length of the fibre and slack length of the tendon, m.
    pub optimal: f64,
    pub slack: f64,
    pub path: Vec<Waypoint>,
}

/// A point of a path, written as an array, a number, or nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum Waypoint {
    /// A body and a place in its frame.
    Site(usize, f64, f64, f64),
    /// A wrapping surface that may bend the path.
    Wrap(usize),
    /// A new branch begins.
    Branch,
}

/// A wrapping surface on the path of one muscle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Wrap {
    #[serde(skip)]
    pub geom: usize,
    pub body: usize,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    pub radius: f64,
    pub sphere: bool,
}

impl Anatomy {
    /// Describes what `snapshot` shows; `strengths` are those of the muscles' condition, one per muscle.
    pub fn of(snapshot: &Snapshot<'_>, strengths: &[f64]) -> Self {
        let &Snapshot { body, model, workspace, .. } = snapshot;
        let (shapes, meshes) = shapes::of(model, body, &workspace.kinematics.overrides);
        let mut wraps = Vec::new();
        let families = families(body);
        let muscles = (0..body.muscles.len()).map(|index| muscle(snapshot, index, strengths, &families, &mut wraps)).collect();
        let plane = |geom: &usize| model.geoms.kind[*geom] == GeomKind::Plane;
        Self {
            bodies: parts(model, body),
            shapes,
            meshes,
            muscles,
            families,
            wraps,
            joints: body
                .joints
                .iter()
                .map(|joint| (joint.name.clone(), joint.position, joint.kind == JointKind::Hinge))
                .collect(),
            landmarks: body.landmarks.iter().map(landmark).collect(),
            root: body.root.body,
            weight: round(body.mass * model.options.gravity.norm()),
            ground: body.objects.is_empty() || body.ground.iter().any(plane),
        }
    }
}

fn landmark(landmark: &msk_runtime::body::Landmark) -> Landmark {
    Landmark {
        name: landmark.name.clone(),
        body: landmark.body,
        point: vector(&landmark.point),
        up: vector(&landmark.axes.column(2).into_owned()),
    }
}

/// Families in the order of their first muscles.
fn families(body: &Body) -> Vec<String> {
    let mut families: Vec<String> = Vec::new();
    for muscle in &body.muscles {
        if !families.contains(&muscle.family) {
            families.push(muscle.family.clone());
        }
    }
    families
}

fn parts(model: &Model, body: &Body) -> Vec<Part> {
    let bodies = &model.bodies;
    let mut carries = vec![false; bodies.parent.len()];
    for &geom in &body.shapes {
        let mut at = model.geoms.body[geom];
        while at > 0 && !std::mem::replace(&mut carries[at], true) {
            at = bodies.parent[at];
        }
    }
    let mut placed = 0..;
    let part = |index: usize| Part {
        name: bodies.name[index].clone(),
        parent: bodies.parent[index],
        position: vector(&bodies.position[index]),
        orientation: bodies.orientation[index].map(round),
        joints: bodies.joints[index].clone().map(|joint| self::joint(model, joint)).collect(),
        own: body.owns(index),
        bone: body.owns(index) && index != body.root.body && carries[index],
        placed: bodies.mocap[index].then(|| placed.next()).flatten(),
    };
    (0..bodies.parent.len()).map(part).collect()
}

fn joint(model: &Model, index: usize) -> Joint {
    let joints = &model.joints;
    let at = joints.position_address[index];
    Joint {
        kind: match joints.kind[index] {
            JointKind::Free => "free",
            JointKind::Ball => "ball",
            JointKind::Slide => "slide",
            JointKind::Hinge => "hinge",
        },
        at,
        axis: vector(&joints.axis[index]),
        anchor: vector(&joints.anchor[index]),
        reference: round(model.reference_position[at]),
    }
}

fn muscle(snapshot: &Snapshot<'_>, index: usize, strengths: &[f64], families: &[String], wraps: &mut Vec<Wrap>) -> Muscle {
    let &Snapshot { body, model, workspace, state } = snapshot;
    let strength = strengths.get(index).copied().unwrap_or(1.0);
    let (optimal, slack) = workspace.actuation.lengths(index);
    let own = &body.muscles[index];
    // The model of a weak body has weak muscles.
    let healthy = if strength > 0.0 { workspace.actuation.peak_force(index) / strength } else { own.peak_force };
    let tendon = model.actuators.muscle(index).map(|muscle| muscle.tendon);
    let points = tendon.map_or(&[][..], |tendon| &model.tendons.path_points[model.tendons.path[tendon].clone()]);
    let waypoint = |point: &PathPoint| match *point {
        PathPoint::Site(site) => {
            let [x, y, z] = vector(&model.sites.position[site]);
            Some(Waypoint::Site(model.sites.body[site], x, y, z))
        }
        PathPoint::Wrap { geom, .. } => {
            wraps.push(wrap(model, geom));
            Some(Waypoint::Wrap(wraps.len() - 1))
        }
        PathPoint::Pulley(_) => Some(Waypoint::Branch),
        PathPoint::Joint { .. } => None,
    };
    Muscle {
        name: own.name.clone(),
        family: families.iter().position(|family| *family == own.family).unwrap_or(0),
        force: round(healthy),
        strength: round(strength * state.strength[index]),
        optimal: round(optimal),
        slack: round(slack),
        path: points.iter().filter_map(waypoint).collect(),
    }
}

fn wrap(model: &Model, geom: usize) -> Wrap {
    let geoms = &model.geoms;
    Wrap {
        geom,
        body: geoms.body[geom],
        position: vector(&geoms.position[geom]),
        orientation: geoms.orientation[geom].map(round),
        radius: round(geoms.size[geom].x),
        sphere: geoms.kind[geom] == GeomKind::Sphere,
    }
}

/// Six digits behind the point: a micrometre, and finer than any turn that can be seen.
pub(crate) fn round(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

pub(crate) fn vector(value: &Vector3<f64>) -> [f64; 3] {
    [round(value.x), round(value.y), round(value.z)]
}
