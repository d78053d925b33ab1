//! Muscles as tubes along their paths: a belly, whose volume follows from force and fibre length, between thin tendons.

use super::{Rgb, Vector, single};
use crate::anatomy::Muscle;
use crate::wraps::turns_forward;
use msk_physics::model::{GeomKind, PathPoint};
use msk_physics::tendons::{PathVertex, VertexKind, path};
use msk_runtime::body::sensors::Snapshot;
use nalgebra::{Unit, Vector3};
use std::f64::consts::{PI, TAU};

/// Rings of a tube.
pub(super) const RINGS: usize = 17;
/// Stress of a fully active muscle, N/m²: cross sections follow from forces.
const STRESS: f64 = 6e5;
/// Angle between points of an arc, rad.
const ARC_STEP: f64 = 0.3;

/// A branch of a muscle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tube {
    pub line: Vec<Vector>,
    pub belly: Belly,
    pub colour: Rgb,
}

/// Radii of belly and tendon, m, and which share of the path the belly takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Belly {
    pub radius: f32,
    pub tendon: f32,
    pub share: f32,
}

/// A ring of a tube: its centre, its radius, a normal, and how much of it is belly, 0 to 1.
pub(super) struct Ring {
    pub place: Vector,
    pub radius: f32,
    pub normal: Vector,
    pub tangent: Vector,
    pub belly: f32,
}

impl Belly {
    /// Of a muscle with so long a path (m) in so many branches, whose force is `force` times its peak.
    pub fn of(muscle: &Muscle, length: f64, branches: usize, force: f64) -> Self {
        let length = length.max(1e-3);
        let section = muscle.force.max(1.0) / STRESS / branches.max(1) as f64;
        let fibre = (length - muscle.slack).max(0.5 * muscle.optimal);
        // Fibres of a pennate muscle are short and start one beside the other, so its belly is longer than they are.
        let share = (fibre / length).clamp(0.6, 0.9);
        // The volume stays: what shortens swells; a spindle of this profile has about 0.6 of the volume of its cylinder.
        let radius = (section * muscle.optimal / (PI * 0.6 * share * length)).sqrt();
        let swelling = 1.0 + 0.12 * force.clamp(0.0, 1.5);
        let belly = (radius * swelling * muscle.strength.max(0.15).sqrt()).max(0.0018);
        let radius_of_belly = belly.min(0.1 * length).min(0.03);
        let tendon = (0.001 + 0.12 * radius).min(0.0035);
        Self { radius: radius_of_belly as f32, tendon: tendon as f32, share: share as f32 }
    }

    /// The belly at a share of the path, 0 to 1: a spindle, slightly towards the beginning.
    fn profile(&self, along: f32) -> f32 {
        let inside = (along - 0.46 * (1.0 - self.share)) / self.share;
        match inside > 0.0 && inside < 1.0 {
            true => libm::pow(libm::sin(PI * f64::from(inside)), 0.9) as f32,
            false => 0.0,
        }
    }
}

impl Tube {
    /// Rings at equal distances along the line; none for a line without a length.
    pub fn rings(&self) -> Vec<Ring> {
        let total: f32 = self.line.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
        let mut segments = self.line.windows(2).filter(|ends| ends[0] != ends[1]).map(|ends| [ends[0], ends[1]]).peekable();
        let Some(mut segment) = segments.next() else { return Vec::new() };
        let (mut passed, mut normal) = (0.0, Vector::zeros());
        let rings = (0..RINGS).map(|index| {
            let along = index as f32 / (RINGS - 1) as f32;
            let mut size = (segment[1] - segment[0]).norm();
            while passed + size < along * total {
                let Some(next) = segments.next() else { break };
                passed += size;
                segment = next;
                size = (segment[1] - segment[0]).norm();
            }
            let tangent = (segment[1] - segment[0]) / size;
            let place = segment[0] + tangent * (along * total - passed).clamp(0.0, size);
            // A normal that turns as little as possible from ring to ring keeps tubes from twisting.
            let across = normal - tangent * tangent.dot(&normal);
            normal = across.try_normalize(1e-3).unwrap_or_else(|| {
                let other = if tangent.x.abs() < 0.8 { Vector::x() } else { Vector::y() };
                tangent.cross(&other).normalize()
            });
            let profile = self.belly.profile(along);
            let radius = self.belly.tendon + (self.belly.radius - self.belly.tendon).max(0.0) * profile;
            Ring { place, radius, normal, tangent, belly: (2.2 * profile).min(1.0) }
        });
        rings.collect()
    }
}

/// The branches of a muscle's path in the world.
pub(super) fn branches(snapshot: &Snapshot<'_>, muscle: usize) -> Vec<Vec<Vector>> {
    let Some(tendon) = snapshot.model.actuators.muscle(muscle).map(|muscle| muscle.tendon) else { return Vec::new() };
    // A path over joints has no place.
    let points = &snapshot.model.tendons.path_points[snapshot.model.tendons.path[tendon].clone()];
    if points.iter().any(|point| matches!(point, PathPoint::Joint { .. })) {
        return Vec::new();
    }
    let mut branches: Vec<Vec<Vector>> = Vec::new();
    let mut before: Option<PathVertex<f64>> = None;
    for vertex in path(snapshot.model, &snapshot.workspace.kinematics, tendon) {
        if matches!(vertex.kind, VertexKind::Start(_)) || branches.is_empty() {
            branches.push(Vec::new());
        }
        if let (Some(line), VertexKind::Leave(geom), Some(touch)) = (branches.last_mut(), vertex.kind, &before) {
            line.extend(arc(snapshot, geom, &touch.position, &vertex));
        }
        if let Some(line) = branches.last_mut() {
            line.push(single(&vertex.position));
        }
        before = Some(vertex);
    }
    branches.retain(|line| line.len() > 1);
    branches
}

/// Points between those where a path touches and leaves a surface.
fn arc(snapshot: &Snapshot<'_>, geom: usize, touch: &Vector3<f64>, leave: &PathVertex<f64>) -> Vec<Vector> {
    let kinematics = &snapshot.workspace.kinematics;
    let (centre, rotation) = (kinematics.geom_position[geom], kinematics.geom_rotation[geom]);
    let [from, to] = [touch, &leave.position].map(|place| rotation.transpose() * (place - centre));
    let sphere = snapshot.model.geoms.kind[geom] == GeomKind::Sphere;
    let (axis, shorter, climb) = match sphere {
        true => (from.cross(&to), libm::atan2(from.cross(&to).norm(), from.dot(&to)), 0.0),
        false => (Vector3::z(), (libm::atan2(to.y, to.x) - libm::atan2(from.y, from.x)).rem_euclid(TAU), to.z - from.z),
    };
    let Some(axis) = Unit::try_new(axis, 1e-12) else { return Vec::new() };
    let angle = if turns_forward(sphere, from, to, leave.length) { shorter } else { shorter - TAU };
    let steps = (angle.abs() / ARC_STEP).ceil().clamp(1.0, 24.0) as u32;
    let point = |step: u32| {
        let share = f64::from(step) / f64::from(steps);
        let (s, c) = libm::sincos(angle * share);
        // Rodrigues' rotation about a unit axis.
        let turned = from * c + axis.cross(&from) * s + axis.into_inner() * (axis.dot(&from) * (1.0 - c));
        single(&(centre + rotation * (turned + axis.into_inner() * (climb * share))))
    };
    (1..steps).map(point).collect()
}
