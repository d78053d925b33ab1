//! Where the paths of muscles touch their wrapping surfaces.

use crate::anatomy::Wrap;
use crate::track::quantise;
use msk_physics::model::{GeomKind, PathPoint};
use msk_physics::tendons::{PathVertex, VertexKind, path};
use msk_runtime::body::sensors::Snapshot;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Numbers per surface: how the path goes around it, and in its frame where it arrives and leaves.
pub(crate) const WIDTH: usize = 7;
/// Quantum of places, m.
pub(crate) const QUANTUM: f64 = 1e-4;

/// Brings the rows of all surfaces up to date, muscle by muscle in the order of [`Anatomy`](crate::anatomy::Anatomy). A surface that
/// is not touched keeps its last places, which then cost nothing.
pub(crate) fn update(snapshot: &Snapshot<'_>, wraps: &[Wrap], rows: &mut [i32]) {
    let model = snapshot.model;
    let mut rows = wraps.iter().zip(rows.chunks_mut(WIDTH));
    for index in 0..snapshot.body.muscles.len() {
        let Some(muscle) = model.actuators.muscle(index) else { continue };
        let vertices = path(model, &snapshot.workspace.kinematics, muscle.tendon);
        let mut vertices = vertices.iter().peekable();
        let mut pending = None;
        for point in &model.tendons.path_points[model.tendons.path[muscle.tendon].clone()] {
            match point {
                PathPoint::Wrap { .. } => {
                    pending = rows.next();
                    if let Some((_, row)) = &mut pending {
                        row[0] = 0;
                    }
                }
                PathPoint::Site(_) => {
                    let touch = vertices.next_if(|vertex| matches!(vertex.kind, VertexKind::Touch(_)));
                    let leave = touch.and_then(|_| vertices.next());
                    if let (Some((wrap, row)), Some(touch), Some(leave)) = (pending.take(), touch, leave) {
                        write(snapshot, wrap, touch, leave, row);
                    }
                    vertices.next();
                }
                PathPoint::Pulley(_) | PathPoint::Joint { .. } => {}
            }
        }
    }
}

fn write(snapshot: &Snapshot<'_>, wrap: &Wrap, touch: &PathVertex<f64>, leave: &PathVertex<f64>, row: &mut [i32]) {
    let kinematics = &snapshot.workspace.kinematics;
    let (centre, rotation) = (kinematics.geom_position[wrap.geom], kinematics.geom_rotation[wrap.geom]);
    let [from, to] = [touch, leave].map(|vertex| rotation.transpose() * (vertex.position - centre));
    let sphere = snapshot.model.geoms.kind[wrap.geom] == GeomKind::Sphere;
    row[0] = if turns_forward(sphere, from, to, leave.length) { 1 } else { 2 };
    for (place, value) in row[1..].iter_mut().zip(from.iter().chain(&to)) {
        *place = quantise(*value, QUANTUM);
    }
}

/// Whether an arc of that length leads around the axis of the surface counterclockwise (around a sphere: the shorter way).
pub(crate) fn turns_forward(sphere: bool, from: Vector3<f64>, to: Vector3<f64>, length: f64) -> bool {
    let (turned, angle) = match sphere {
        true => (length / from.norm().max(1e-9), libm::atan2(from.cross(&to).norm(), from.dot(&to))),
        false => {
            let climb = to.z - from.z;
            let angle = (libm::atan2(to.y, to.x) - libm::atan2(from.y, from.x)).rem_euclid(TAU);
            ((length * length - climb * climb).max(0.0).sqrt() / from.xy().norm().max(1e-9), angle)
        }
    };
    (turned - angle).abs() <= (turned - (TAU - angle)).abs()
}
