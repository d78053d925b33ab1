//! Terrain as shapes: stairs and slopes of boxes, height fields.
//!
//! Terrain begins at the origin of its object and extends along x, centred in y.

use super::elements::NewGeom;
use msk_physics::model::{GeomKind, HeightField, rotation};
use msk_physics::scalar::Real;
use msk_program::scene::Terrain;
use nalgebra::Vector3;

/// Thickness of a slope, m: a body that falls on it is pushed out upwards, not through.
const SLOPE_THICKNESS: f64 = 0.2;

/// The shapes of `terrain`, named after the object: `flight[0]`, `flight[1]`, ...
pub fn shapes(name: &str, terrain: &Terrain) -> Vec<NewGeom> {
    match terrain {
        Terrain::Stairs { count, rise, run, width } => stairs(name, *count, *rise, *run, *width),
        Terrain::Slope { length, width, angle } => vec![slope(name, *length, *width, *angle)],
        Terrain::Heights { size, samples, heights } => vec![field(name, *size, *samples, heights)],
    }
}

/// Depth of the solid under the lowest tread of a flight that goes down, m.
const STAIRS_BASE: f64 = 0.2;

/// One column per step, from the foot of the flight to its tread.
fn stairs(name: &str, count: u32, rise: f64, run: f64, width: f64) -> Vec<NewGeom> {
    let bottom = if rise < 0.0 { f64::from(count) * rise - STAIRS_BASE } else { 0.0 };
    let step = |index: u32| {
        let top = f64::from(index + 1) * rise;
        let middle = (f64::from(index) + 0.5) * run;
        NewGeom {
            name: format!("{name}[{index}]"),
            kind: GeomKind::Box,
            size: Vector3::new(0.5 * run, 0.5 * width, 0.5 * (top - bottom)),
            position: Vector3::new(middle, 0.0, 0.5 * (top + bottom)),
            ..NewGeom::default()
        }
    };
    (0..count).map(step).collect()
}

/// A box whose upper face is the slope; its near edge is the origin.
fn slope(name: &str, length: f64, width: f64, angle: f64) -> NewGeom {
    let (sin, cos) = libm::sincos(angle);
    let normal = Vector3::new(-sin, 0.0, cos);
    let middle = Vector3::new(0.5 * length, 0.0, 0.5 * length * sin / cos);
    NewGeom {
        name: format!("{name}[0]"),
        kind: GeomKind::Box,
        size: Vector3::new(0.5 * length / cos, 0.5 * width, 0.5 * SLOPE_THICKNESS),
        position: middle - normal * (0.5 * SLOPE_THICKNESS),
        // Positive inclination rises along x, which is a turn about -y.
        orientation: rotation::about(-Vector3::y(), angle),
        ..NewGeom::default()
    }
}

/// Depth of the solid under the lowest point of a height field, m.
const FIELD_BASE: f64 = 0.5;

/// A height field: its samples run from 0 at the lowest of the heights to 1 at the highest.
fn field(name: &str, [length, width]: [f64; 2], [columns, rows]: [usize; 2], heights: &[f64]) -> NewGeom {
    let low = heights.iter().copied().fold(f64::INFINITY, Real::at_most);
    let high = heights.iter().copied().fold(f64::NEG_INFINITY, Real::at_least);
    // A level field needs some elevation to be a field at all.
    let elevation = if high > low { high - low } else { 1.0 };
    NewGeom {
        name: format!("{name}[0]"),
        kind: GeomKind::HeightField,
        position: Vector3::new(0.5 * length, 0.0, if low.is_finite() { low } else { 0.0 }),
        heights: Some(HeightField {
            name: name.to_owned(),
            rows,
            columns,
            radius: [0.5 * length, 0.5 * width],
            elevation,
            base: FIELD_BASE,
            samples: heights.iter().map(|height| (height - low) / elevation).collect(),
        }),
        ..NewGeom::default()
    }
}
