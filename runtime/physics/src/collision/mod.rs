//! Which shapes touch, where and how.
//!
//! 1. [`Plan::new`] decides once per model which pairs of geoms can ever meet (MuJoCo's filters: contact bits, welded and
//!    neighbouring bodies, exclusions, explicit pairs), in MuJoCo's order, and mixes their contact parameters;
//! 2. [`NearPairs`] passes over resting shapes far from a moving one, and tests in all lanes whether the other pairs can be near;
//! 3. [`Plan::detect`] calls the collider of those that are close.
//!
//! A human body on a plane has about 160 such pairs, so testing all of them costs less than keeping any tree of volumes up
//! to date; a scene adds resting shapes by the hundred, which are sorted once. Which pair collides is ragged from episode to episode, so
//! the last works on one episode in `f64`; episodes that share SIMD lanes elsewhere pass through it one by one.

mod box_box;
mod broad;
mod capsule_box;
mod convex;
pub mod distance;
mod ellipsoid;
mod height_field;
mod near;
mod parameters;
pub mod place;
mod plane;
mod polygon;
pub mod ray;
mod round;
mod shapes;

pub use convex::Scratch;
pub use convex::support::{Core, SupportShape};
pub use near::NearPairs;
pub use parameters::{CollisionPair, Sliding};
pub use place::{Asset, Placed};

use crate::{
    kinematics::Kinematics,
    model::{GeomKind, Model},
    scalar::Real,
};
use nalgebra::{Matrix3, Vector3};

/// What a collider finds.
#[derive(Debug, Clone, Copy)]
struct ContactPoint {
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
    found: Vec<ContactPoint>,
    scratch: Scratch,
}

/// The pairs of geoms that can meet in a model.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    /// Pairs in MuJoCo's order: by body pair, then as declared.
    pub candidates: Vec<CollisionPair>,
    /// Dofs that move one body of a pair against the other, ascending; [`CollisionPair::columns`] points into it.
    pub(super) columns: Vec<usize>,
    broad: broad::Broad,
    /// For each column: whether the dof moves the pair's second body (1) or its first (-1).
    pub(super) sides: Vec<f64>,
}

impl Plan {
    /// Dofs that move one body of a candidate against the other.
    pub(super) fn columns_of(&self, candidate: usize) -> &[usize] {
        &self.columns[self.candidates[candidate].columns.clone()]
    }

    /// Finds the contacts of the pairs that are `near` where the kinematics of the episode in `lane` put them, and writes them to
    /// `contacts`, in the order of the candidates.
    pub fn detect<T: Real>(
        &self,
        model: &Model,
        (kinematics, near): (&Kinematics<T>, &NearPairs<T>),
        lane: usize,
        contacts: &mut Vec<Contact>,
        memory: &mut Memory,
    ) {
        contacts.clear();
        let Memory { found, scratch } = memory;
        for index in near.in_lane(lane) {
            let candidate = &self.candidates[index];
            let [first, second] = candidate.geoms;
            let place = |geom: usize| Placed::of(model, kinematics, lane, geom);
            collide(candidate, &place(first), &place(second), scratch, found);
            contacts.extend(found.drain(..).map(|point: ContactPoint| Contact {
                candidate: index,
                geoms: candidate.geoms,
                position: point.position,
                frame: point.frame,
                distance: point.distance,
                force: [0.0; 6],
            }));
        }
    }
}

/// Calls the collider for a pair of kinds, the first not after the second in [`GeomKind`]'s order.
fn collide(
    candidate: &CollisionPair,
    first: &Placed<'_>,
    second: &Placed<'_>,
    scratch: &mut Scratch,
    found: &mut Vec<ContactPoint>,
) {
    use GeomKind::{Box, Capsule, Cylinder, Ellipsoid, HeightField, Mesh, Plane, Sphere};
    let reach = candidate.margin + candidate.gap;
    let closed_form = match candidate.kinds {
        [Plane, Sphere] => plane::sphere,
        [Plane, Capsule] => plane::capsule,
        [Plane, Ellipsoid] => plane::ellipsoid,
        [Plane, Cylinder] => plane::cylinder,
        [Plane, Box] => plane::cuboid,
        [Plane, Mesh] => plane::mesh,
        [Sphere, Sphere] => shapes::sphere_sphere,
        [Sphere, Capsule] => shapes::sphere_capsule,
        [Sphere, Cylinder] => round::sphere_cylinder,
        [Sphere, Box] => round::sphere_box,
        [Capsule, Capsule] => shapes::capsule_capsule,
        [Capsule, Box] => capsule_box::collide,
        [Sphere | Capsule | Ellipsoid, Ellipsoid] => return ellipsoid::collide(first, second, reach, scratch, found),
        [Box, Box] => return box_box::collide(first, second, reach, &mut scratch.polygon, found),
        [HeightField, _] => return height_field::collide(first, second, reach, scratch, found),
        _ => {
            let origin = first.position;
            if let (Some(first), Some(second)) = (SupportShape::new(first, origin), SupportShape::new(second, origin)) {
                convex::manifold::collide([&first, &second], origin, reach, scratch, found);
            }
            return;
        }
    };
    closed_form(first, second, reach, found);
}

/// Whether two kinds, in either order, can meet: all but two of plane and height field.
fn can_meet(first: GeomKind, second: GeomKind) -> bool {
    use GeomKind::{HeightField, Plane};
    !(matches!(first, Plane | HeightField) && matches!(second, Plane | HeightField))
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
