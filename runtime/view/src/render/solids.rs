//! Triangles of unit shapes: ball (sphere, ellipsoid, capsule), box, cylinder, bone, arrow.

use super::Vector;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::LazyLock;

/// A unit shape. Seen from outside, corners of its triangles turn counterclockwise.
#[derive(Debug, Clone, Default)]
pub(super) struct Solid {
    pub corners: Vec<Corner>,
    pub triangles: Vec<[u32; 3]>,
    /// Whether only its outside is seen.
    pub closed: bool,
}

/// A corner of a unit shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub place: Vector,
    pub normal: Vector,
    /// The half of a ball that it belongs to, -1 or 1, which a capsule draws apart.
    pub cap: f32,
}

pub(super) static BALL: LazyLock<Solid> = LazyLock::new(|| ball(7, 24));
/// For fingers and toes, which are many and small.
pub(super) static SMALL_BALL: LazyLock<Solid> = LazyLock::new(|| ball(5, 14));
pub(super) static BOX: LazyLock<Solid> = LazyLock::new(cuboid);
pub(super) static CYLINDER: LazyLock<Solid> = LazyLock::new(|| {
    let outline = [
        (0.0, -1.0, 0.0, -1.0),
        (1.0, -1.0, 0.0, -1.0),
        (1.0, -1.0, 1.0, 0.0),
        (1.0, 1.0, 1.0, 0.0),
        (1.0, 1.0, 0.0, 1.0),
        (0.0, 1.0, 0.0, 1.0),
    ];
    lathe(&outline.map(|(radius, z, outwards, upwards)| Profile { radius, z, outwards, upwards, cap: 0.0 }), 48)
});
pub(super) static BONE: LazyLock<Solid> = LazyLock::new(|| bone(12));
/// From z = 0 to 1.
pub(super) static ARROW: LazyLock<Solid> = LazyLock::new(|| {
    let outline = [
        (0.0, 0.0, 0.0, -1.0),
        (0.4, 0.0, 0.0, -1.0),
        (0.4, 0.0, 1.0, 0.0),
        (0.4, 0.82, 1.0, 0.0),
        (0.4, 0.82, 0.0, -1.0),
        (1.0, 0.82, 0.0, -1.0),
        (1.0, 0.82, 0.9, 0.4),
        (0.0, 1.0, 0.9, 0.4),
    ];
    lathe(&outline.map(|(radius, z, outwards, upwards)| Profile { radius, z, outwards, upwards, cap: 0.0 }), 24)
});

/// A ring of a surface of revolution about z: radius, height, and the normal outwards and upwards.
#[derive(Debug, Clone, Copy)]
struct Profile {
    radius: f64,
    z: f64,
    outwards: f64,
    upwards: f64,
    cap: f64,
}

/// A surface of revolution about z, whose outline leads from below to above.
fn lathe(outline: &[Profile], sides: u32) -> Solid {
    let ring = |profile: &Profile| {
        let Profile { radius, z, outwards, upwards, cap } = *profile;
        (0..sides).map(move |side| {
            let (s, c) = libm::sincos(TAU * f64::from(side) / f64::from(sides));
            let vector = |across: f64, along: f64| Vector::new((across * c) as f32, (across * s) as f32, along as f32);
            Corner { place: vector(radius, z), normal: vector(outwards, upwards), cap: cap as f32 }
        })
    };
    let corners = outline.iter().flat_map(ring).collect();
    let rows = 0..u32::try_from(outline.len()).unwrap_or(0).saturating_sub(1);
    let cell = |row: u32, side: u32| {
        let next = (side + 1) % sides;
        let [a, b, c, d] = [row * sides + side, row * sides + next, (row + 1) * sides + side, (row + 1) * sides + next];
        [[a, b, c], [b, d, c]]
    };
    let triangles = rows.flat_map(|row| (0..sides).flat_map(move |side| cell(row, side))).collect();
    Solid { corners, triangles, closed: true }
}

fn ball(rows: u32, sides: u32) -> Solid {
    let half = |from: f64, cap: f64| {
        (0..=rows).map(move |row| {
            let (s, c) = libm::sincos(from + FRAC_PI_2 * f64::from(row) / f64::from(rows));
            Profile { radius: c, z: s, outwards: c, upwards: s, cap }
        })
    };
    lathe(&half(-FRAC_PI_2, -1.0).chain(half(0.0, 1.0)).collect::<Vec<_>>(), sides)
}

/// A shaft between two heads, from z = 0 to 1, as thick as 1 at the heads.
fn bone(sides: u32) -> Solid {
    const ROWS: u32 = 18;
    let head = |z: f64, at: f64| libm::exp(-((z - at) / 0.085) * ((z - at) / 0.085));
    let radius = |z: f64| {
        let [lower, upper] = [head(z, 0.04), head(z, 0.96)];
        0.38 + 0.62 * if lower > upper { lower } else { upper }
    };
    let end = |z: f64, upwards: f64| Profile { radius: 0.0, z, outwards: 0.0, upwards, cap: 0.0 };
    let ring = |row: u32| {
        let z = f64::from(row) / f64::from(ROWS);
        let slope = (radius(z + 0.01) - radius(z - 0.01)) / 0.02;
        Profile { radius: radius(z), z, outwards: 1.0, upwards: -0.12 * slope, cap: 0.0 }
    };
    let outline: Vec<Profile> = std::iter::once(end(-0.03, -1.0)).chain((0..=ROWS).map(ring)).chain([end(1.03, 1.0)]).collect();
    lathe(&outline, sides)
}

fn cuboid() -> Solid {
    let mut solid = Solid { closed: true, ..Solid::default() };
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            let first = solid.corners.len() as u32;
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let (mut place, mut normal) = (Vector::zeros(), Vector::zeros());
                // Turned so that each face is seen from outside.
                (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (sign, sign * u, v);
                normal[axis] = sign;
                solid.corners.push(Corner { place, normal, cap: 0.0 });
            }
            solid.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|triangle| triangle.map(|corner| first + corner)));
        }
    }
    solid
}

/// A surface of an asset, each triangle with its own normal; corners are tenths of a millimetre.
pub(super) fn facets(corners: &[i32], triangles: &[usize]) -> Solid {
    let place = |index: usize| Vector::from_fn(|axis, _| corners.get(3 * index + axis).map_or(0.0, |part| *part as f32 * 1e-4));
    let mut solid = Solid::default();
    for triangle in triangles.chunks_exact(3) {
        let places = [0, 1, 2].map(|corner| place(triangle[corner]));
        let normal = (places[1] - places[0]).cross(&(places[2] - places[0]));
        let Some(normal) = normal.try_normalize(0.0) else { continue };
        let first = solid.corners.len() as u32;
        solid.corners.extend(places.map(|place| Corner { place, normal, cap: 0.0 }));
        solid.triangles.push([first, first + 1, first + 2]);
    }
    solid
}
