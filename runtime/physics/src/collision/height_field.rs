//! Height fields against convex shapes: one prism of the solid below each triangle of the surface.

use super::{
    ContactPoint,
    convex::{
        self, Scratch, Separation,
        support::{Core, SupportShape},
    },
    distance::Gap,
    frame_of,
    place::{Asset, Placed},
};
use crate::model::HeightField;
use crate::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// Contacts of one pair at most, MuJoCo's `mjMAXCONPAIR`.
const MOST_CONTACTS: usize = 50;

/// A height field against a convex shape.
pub(super) fn collide(field: &Placed<'_>, shape: &Placed<'_>, reach: f64, scratch: &mut Scratch, found: &mut Vec<ContactPoint>) {
    let start = found.len();
    each_prism(field, shape, reach, scratch, |separation, _| {
        let position = (separation.points[0] + separation.points[1]) * 0.5;
        found.push(ContactPoint { distance: separation.distance, position, frame: frame_of(separation.normal, None) });
        found.len() - start < MOST_CONTACTS
    });
    for touch in &mut found[start..] {
        touch.position = field.rotation * touch.position + field.position;
        touch.frame = frame_of(field.rotation * touch.frame.row(0).transpose(), None);
    }
}

/// The distance of a height field and a convex shape.
pub(super) fn distance(field: &Placed<'_>, shape: &Placed<'_>, range: f64, scratch: &mut Scratch) -> Option<Gap> {
    let mut best: Option<Separation> = None;
    each_prism(field, shape, range, scratch, |separation, limit| {
        if separation.distance < *limit || best.is_none() {
            *limit = separation.distance.at_least(0.0);
            best = Some(separation);
        }
        true
    });
    let world = |point: Vector3<f64>| field.rotation * point + field.position;
    best.map(|best| Gap { distance: best.distance, points: best.points.map(world) })
}

/// Hands out how each prism within `reach` of the shape stands to it, in the field's axes, until `take` has enough. `take` may
/// lower the reach.
fn each_prism(
    field: &Placed<'_>,
    shape: &Placed<'_>,
    reach: f64,
    scratch: &mut Scratch,
    mut take: impl FnMut(Separation, &mut f64) -> bool,
) {
    let Asset::HeightField(data) = field.asset else { return };
    // The shape in the field's axes.
    let local = Placed { position: field.local(shape.position), rotation: field.rotation.tr_mul(&shape.rotation), ..*shape };
    let Some(solid) = SupportShape::new(&local, Vector3::zeros()) else { return };
    let extreme = |axis: usize, sense: f64| {
        let direction = Vector3::ith(axis, sense);
        solid.support_point(direction)[axis] + sense * (solid.radius + reach)
    };
    let [low, high] = [-1.0, 1.0].map(|sense| Vector3::new(extreme(0, sense), extreme(1, sense), extreme(2, sense)));
    let [x, y] = data.radius;
    if low.x > x || high.x < -x || low.y > y || high.y < -y || low.z > data.elevation || high.z < -data.base {
        return;
    }
    let cells = |low: f64, high: f64, radius: f64, count: usize| {
        let place = |value: f64| (value / radius + 1.0) * 0.5 * (count - 1) as f64;
        (place(low).floor().at_least(0.0) as usize)..(place(high).ceil().at_least(0.0) as usize).min(count - 1)
    };
    let columns = cells(low.x, high.x, x, data.columns);
    let mut limit = reach;
    for row in cells(low.y, high.y, y, data.rows) {
        for column in columns.clone() {
            for prism in prisms(data, row, column) {
                if prism[3..].iter().all(|corner| corner.z < low.z) {
                    continue;
                }
                let column = SupportShape {
                    core: Core::Prism(&prism),
                    position: Vector3::zeros(),
                    rotation: Matrix3::identity(),
                    radius: 0.0,
                };
                if let Some(separation) = convex::separate(&column, &solid, limit, scratch)
                    && !take(separation, &mut limit)
                {
                    return;
                }
            }
        }
    }
}

/// The two prisms of a cell, in MuJoCo's order; the first three corners of each are its foot.
fn prisms(field: &HeightField, row: usize, column: usize) -> [[Vector3<f64>; 6]; 2] {
    let near = [field.point(row, column), field.point(row, column + 1)];
    let far = [field.point(row + 1, column), field.point(row + 1, column + 1)];
    [[far[0], near[0], far[1]], [near[0], far[1], near[1]]].map(|top| {
        let foot = top.map(|corner| Vector3::new(corner.x, corner.y, -field.base));
        [foot[0], foot[1], foot[2], top[0], top[1], top[2]]
    })
}
