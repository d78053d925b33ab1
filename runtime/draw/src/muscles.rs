//! Muscles: their paths over the skeleton with all wraps, coloured by activation, as thick as they are strong.

use super::camera::Camera;
use super::panel::{Item, Panel};
use super::path::Path;
use msk_physics::model::GeomKind;
use msk_physics::tendons::{PathVertex, VertexKind, path};
use msk_runtime::body::sensors::Snapshot;
use nalgebra::{Rotation3, Unit, Vector3};

/// Width of the belly of a muscle of 1 N, mm: cross sections are proportional to forces, so widths to their square roots.
const WIDTH_PER_ROOT_NEWTON: f64 = 0.13;
/// Thinnest belly, mm.
const THINNEST: f64 = 1.3;
/// Thinnest line, mm.
const SLIMMEST: f64 = 0.8;
/// A muscle swells from its tendons in steps: between which shares of the path, and how wide against the belly.
const SPINDLE: [([f64; 2], f64); 3] = [([0.0, 1.0], 0.28), ([0.13, 0.87], 0.62), ([0.26, 0.70], 1.0)];
/// Arcs are drawn in steps of about this angle, rad.
const ARC_STEP: f64 = 0.35;

/// Adds all muscles.
pub(super) fn add(snapshot: &Snapshot<'_>, camera: &Camera, panel: &mut Panel) {
    for (index, muscle) in snapshot.body.muscles.iter().enumerate() {
        for points in lines(snapshot, index) {
            let sum: Vector3<f64> = points.iter().sum();
            let width = (WIDTH_PER_ROOT_NEWTON * muscle.peak_force.max(0.0).sqrt()).max(THINNEST);
            let spindle = SPINDLE.map(|(shares, share)| {
                let mut path = Path::default();
                path.polyline(&part(&points, shares).iter().map(|&point| camera.project(point)).collect::<Vec<_>>());
                (path, (share * width).max(SLIMMEST))
            });
            panel.add(Item::Muscle {
                depth: camera.depth(sum / points.len() as f64),
                spindle,
                activation: snapshot.state.activation[index],
            });
        }
    }
}

/// The branches of a muscle's path as lines of points, with arcs resolved.
pub(super) fn lines(snapshot: &Snapshot<'_>, muscle: usize) -> Vec<Vec<Vector3<f64>>> {
    let mut lines: Vec<Vec<Vector3<f64>>> = Vec::new();
    let Some(muscle) = snapshot.model.actuators.muscle(muscle) else { return lines };
    for vertex in &path(snapshot.model, &snapshot.workspace.kinematics, muscle.tendon) {
        match (vertex.kind, lines.last_mut()) {
            (VertexKind::Leave(geom), Some(line)) => {
                if let Some(&touch) = line.last() {
                    line.extend(arc(snapshot, geom, touch, vertex));
                }
                line.push(vertex.position);
            }
            (VertexKind::Start(_), _) | (_, None) => lines.push(vec![vertex.position]),
            (_, Some(line)) => line.push(vertex.position),
        }
    }
    lines
}

/// Points on an arc between where a path touches a sphere or cylinder and where it leaves: a turn about the shape's axis (for
/// a sphere, the normal of the plane of the arc) with a steady climb along it, of the length of the vertex.
fn arc(snapshot: &Snapshot<'_>, geom: usize, touch: Vector3<f64>, leave: &PathVertex<f64>) -> Vec<Vector3<f64>> {
    let (geoms, kinematics) = (&snapshot.model.geoms, &snapshot.workspace.kinematics);
    let centre = kinematics.geom_position[geom];
    let (from, to) = (touch - centre, leave.position - centre);
    let axis = match geoms.kind[geom] {
        GeomKind::Sphere => from.cross(&to),
        _ => kinematics.geom_rotation[geom].column(2).into_owned(),
    };
    let Some(axis) = Unit::try_new(axis, 1e-12) else { return Vec::new() };
    let climb = axis.dot(&(to - from));
    let spoke = from - axis.into_inner() * axis.dot(&from);
    let turn = (leave.length * leave.length - climb * climb).max(0.0).sqrt() / spoke.norm().max(1e-9);
    let at = |share: f64, turn: f64| {
        centre + Rotation3::from_axis_angle(&axis, share * turn) * from + axis.into_inner() * (share * climb)
    };
    let misses = |turn: f64| (at(1.0, turn) - leave.position).norm();
    let turn = if misses(turn) <= misses(-turn) { turn } else { -turn };
    let steps = (turn.abs() / ARC_STEP).ceil().clamp(1.0, 24.0) as u32;
    (1..steps).map(|step| at(f64::from(step) / f64::from(steps), turn)).collect()
}

/// The part of a line between two shares of its length.
fn part(points: &[Vector3<f64>], [from, to]: [f64; 2]) -> Vec<Vector3<f64>> {
    let total: f64 = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let (from, to) = (from * total, to * total);
    let mut inner = Vec::new();
    let mut passed = 0.0;
    for pair in points.windows(2) {
        let length = (pair[1] - pair[0]).norm();
        let at = |position: f64| pair[0].lerp(&pair[1], ((position - passed) / length.max(1e-12)).clamp(0.0, 1.0));
        if passed + length > from && passed < to {
            if inner.is_empty() {
                inner.push(at(from));
            }
            inner.push(at(to));
        }
        passed += length;
    }
    inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_belly_is_the_middle_of_the_path() {
        let corner = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]].map(Vector3::from);
        assert_eq!(part(&corner, [0.25, 0.75]), [[0.5, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.5, 0.0]].map(Vector3::from));
        assert_eq!(part(&corner, [0.6, 1.0]).len(), 2);
    }
}
