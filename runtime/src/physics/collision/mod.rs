//! Which shapes touch, where and how.
//!
//! 1. [`Plan::new`] decides once per model which pairs of geoms can ever meet (MuJoCo's filters: contact bits, welded and
//!    neighbouring bodies, exclusions, explicit pairs), in MuJoCo's order, and mixes their contact parameters;
//! 2. [`Plan::detect`] tests the bounding spheres of each pair and calls the collider of those that are close.
//!
//! A human body on a plane has about 160 such pairs, so testing all of them costs less than keeping any tree of volumes up
//! to date. Which pair collides is ragged from episode to episode, so this stage works on one episode in `f64`; episodes
//! that share SIMD lanes elsewhere pass through it one by one.

mod convex;
pub mod distance;
mod ellipsoid;
mod height_field;
mod parameters;
pub mod place;
pub mod ray;
mod shapes;

pub use convex::Scratch;
pub(crate) use convex::solid::{Core, Solid};
pub use parameters::{Candidate, unsupported_pairs};
pub use place::{Asset, Placed};

use crate::model::{GeomKind, Model};
use nalgebra::{Matrix3, Vector3};

/// What a collider finds.
#[derive(Debug, Clone, Copy)]
struct Touch {
    distance: f64,
    position: Vector3<f64>,
    frame: Matrix3<f64>,
}

/// A contact between two geoms.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Index of the pair in [`Plan::candidates`].
    pub candidate: usize,
    /// The two geoms; the normal points from the first to the second.
    pub geoms: [usize; 2],
    /// Half way between the two surfaces, world frame, m.
    pub position: Vector3<f64>,
    /// Rows: normal, two tangents.
    pub frame: Matrix3<f64>,
    /// Distance of the surfaces, negative when they overlap, m.
    pub distance: f64,
    /// Force (N) and torque (N m) on the second geom in the contact frame; filled by the solver.
    pub force: [f64; 6],
}

/// Memory of the search for contacts, kept between steps.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    found: Vec<Touch>,
    scratch: Scratch,
}

/// The pairs of geoms that can meet in a model.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    /// Pairs in MuJoCo's order: by body pair, then as declared.
    pub candidates: Vec<Candidate>,
    /// Dofs that move one body of a pair against the other, ascending; [`Candidate::columns`] points into it.
    pub(super) columns: Vec<usize>,
    /// For each column: whether the dof moves the pair's second body (1) or its first (-1).
    pub(super) sides: Vec<f64>,
}

impl Plan {
    /// Dofs that move one body of a candidate against the other.
    pub(super) fn columns_of(&self, candidate: usize) -> &[usize] {
        &self.columns[self.candidates[candidate].columns.clone()]
    }

    /// Finds the contacts of the geoms with the given world positions and rotations and writes them to `contacts`, in the
    /// order of the candidates.
    pub fn detect(
        &self,
        model: &Model,
        position: impl Fn(usize) -> Vector3<f64>,
        rotation: impl Fn(usize) -> Matrix3<f64>,
        contacts: &mut Vec<Contact>,
        memory: &mut Memory,
    ) {
        contacts.clear();
        let Memory { found, scratch } = memory;
        for (index, candidate) in self.candidates.iter().enumerate() {
            let [first, second] = candidate.geoms;
            let between = position(second) - position(first);
            let far = if candidate.kinds[0] == GeomKind::Plane {
                between.dot(&rotation(first).column(2)) > candidate.bound
            } else {
                between.norm_squared() > candidate.bound * candidate.bound
            };
            if far {
                continue;
            }
            let place = |geom: usize| Placed::new(model, geom, position(geom), rotation(geom));
            collide(candidate, &place(first), &place(second), scratch, found);
            contacts.extend(found.drain(..).map(|touch: Touch| Contact {
                candidate: index,
                geoms: candidate.geoms,
                position: touch.position,
                frame: touch.frame,
                distance: touch.distance,
                force: [0.0; 6],
            }));
        }
    }
}

/// Calls the collider for a pair of kinds, the first not after the second in [`GeomKind`]'s order.
fn collide(candidate: &Candidate, first: &Placed<'_>, second: &Placed<'_>, scratch: &mut Scratch, found: &mut Vec<Touch>) {
    use GeomKind::{Capsule, Ellipsoid, HeightField, Plane, Sphere};
    let reach = candidate.margin + candidate.gap;
    let collider = match candidate.kinds {
        [Plane, Sphere] => shapes::plane_sphere,
        [Plane, Capsule] => shapes::plane_capsule,
        [Plane, Ellipsoid] => shapes::plane_ellipsoid,
        [Sphere, Sphere] => shapes::sphere_sphere,
        [Sphere, Capsule] => shapes::sphere_capsule,
        [Capsule, Capsule] => shapes::capsule_capsule,
        [Sphere | Capsule | Ellipsoid, Ellipsoid] => ellipsoid::collide,
        [HeightField, _] => return height_field::collide(first, second, reach, scratch, found),
        // The plan holds supported pairs only; `unsupported_pairs` names the others when a model is read.
        _ => return,
    };
    collider(first, second, reach, found);
}

/// Whether two kinds, in either order, have a collider.
fn has_collider(first: GeomKind, second: GeomKind) -> bool {
    use GeomKind::{Box, Cylinder, HeightField, Mesh, Plane};
    let unsupported = |kind| matches!(kind, HeightField | Cylinder | Box | Mesh);
    !(unsupported(first) || unsupported(second) || (first == Plane && second == Plane))
}

/// A contact frame with rows normal, tangent, tangent: the first tangent near `along` if given, else near y, or z where the
/// normal is close to y.
fn frame_of(normal: Vector3<f64>, along: Option<Vector3<f64>>) -> Matrix3<f64> {
    let default = if normal.y.abs() < 0.5 { Vector3::y() } else { Vector3::z() };
    let across = |hint: Vector3<f64>| hint - normal * normal.dot(&hint);
    let tangent = across(along.unwrap_or(default));
    let tangent = tangent.try_normalize(1e-15).unwrap_or_else(|| across(default).normalize());
    Matrix3::from_rows(&[normal.transpose(), tangent.transpose(), normal.cross(&tangent).transpose()])
}
