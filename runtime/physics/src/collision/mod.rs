//! Which shapes touch, where and how.
//!
//! 1. [`Plan::new`] decides once per model which pairs of geoms can ever meet (MuJoCo's filters: contact bits, welded and
//!    neighbouring bodies, exclusions, explicit pairs), in MuJoCo's order, and mixes their contact parameters;
//! 2. [`NearPairs`] passes over resting shapes far from a moving one, and tests in all lanes whether the other pairs can be near;
//! 3. `Plan::detect` calls the collider of those that are close.
//!
//! A human body on a plane has about 160 such pairs, so testing all of them costs less than keeping any tree of volumes up
//! to date; a scene adds resting shapes by the hundred, which are sorted once. Planes against all but meshes, and spheres and capsules
//! against each other and ellipsoids, have colliders that find the contacts of a pair in all lanes at once (`touch`); the others work on
//! one episode in `f64`, and episodes that share SIMD lanes elsewhere pass through them one by one.

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
mod touch;

pub use convex::Scratch;
pub use convex::support::{Core, SupportShape};
pub use near::NearPairs;
pub use parameters::{CollisionPair, Sliding};
pub use place::{Asset, Placed};

use crate::{
    batch::PerLane,
    kinematics::Kinematics,
    model::{GeomKind, Model},
    scalar::Real,
};
use nalgebra::{Matrix3, Vector3};
use touch::{Pair, Touch, frame_of};

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
#[derive(Debug, Clone)]
pub(crate) struct Memory<T: Real> {
    touches: Vec<Touch<T>>,
    found: Vec<ContactPoint>,
    scratch: Scratch,
}

impl<T: Real> Memory<T> {
    pub fn new() -> Self {
        Self { touches: Vec::with_capacity(MOST_TOUCHES), found: Vec::new(), scratch: Scratch::default() }
    }
}

/// What a collider of all lanes finds at most: a box has eight corners.
const MOST_TOUCHES: usize = 8;

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

    /// Finds the contacts of the pairs that are `near` where the kinematics put them, and writes those of each lane to its list, in the
    /// order of the candidates. A lane without a list is left out.
    #[inline(always)]
    pub(crate) fn detect<T: Real>(
        &self,
        model: &Model,
        (kinematics, near): (&Kinematics<T>, &NearPairs<T>),
        contacts: &mut PerLane<&mut Vec<Contact>>,
        memory: &mut Memory<T>,
    ) {
        contacts.iter_mut().flatten().for_each(|own| own.clear());
        let living = T::mask(|lane| contacts[lane].is_some());
        for (index, lanes) in near.pairs() {
            let lanes = T::and(lanes, living);
            if !T::any(lanes) {
                continue;
            }
            let candidate = &self.candidates[index];
            let [first, second] = candidate.geoms;
            let shapes = [Placed::of_all(model, kinematics, first), Placed::of_all(model, kinematics, second)];
            let pair = Pair { shapes, reach: T::splat(candidate.reach()), lanes };
            if collide(candidate.kinds, &pair, &mut memory.scratch, &mut memory.touches) {
                share(index, candidate, contacts, &mut memory.touches);
            } else {
                self.detect_alone(model, kinematics, (index, lanes), contacts, memory);
            }
        }
    }

    /// Finds the contacts of a pair lane by lane.
    #[inline(never)]
    fn detect_alone<T: Real>(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        (index, lanes): (usize, T::Mask),
        contacts: &mut PerLane<&mut Vec<Contact>>,
        memory: &mut Memory<T>,
    ) {
        let candidate = &self.candidates[index];
        let Memory { found, scratch, .. } = memory;
        for (lane, own) in contacts.iter_mut().enumerate().take(T::LANES).filter(|(lane, _)| T::holds(lanes, *lane)) {
            let Some(own) = own else { continue };
            let [first, second] = candidate.geoms.map(|geom| Placed::of(model, kinematics, lane, geom));
            collide_alone(candidate, &first, &second, scratch, found);
            own.extend(found.drain(..).map(|point| Contact::of(index, candidate, point)));
        }
    }
}

/// Gives each lane what it has of the contacts of a pair.
fn share<T: Real>(
    index: usize,
    candidate: &CollisionPair,
    contacts: &mut PerLane<&mut Vec<Contact>>,
    touches: &mut Vec<Touch<T>>,
) {
    for touch in touches.iter() {
        for (lane, own) in contacts.iter_mut().enumerate().take(T::LANES) {
            if let (Some(own), Some(point)) = (own, touch.in_lane(lane)) {
                own.push(Contact::of(index, candidate, point));
            }
        }
    }
    touches.clear();
}

impl Contact {
    fn of(candidate: usize, pair: &CollisionPair, point: ContactPoint) -> Self {
        let ContactPoint { distance, position, frame } = point;
        Self { candidate, geoms: pair.geoms, position, frame, distance, force: [0.0; 6] }
    }
}

/// Calls the collider of all lanes for a pair of kinds, the first not after the second in [`GeomKind`]'s order, and returns whether there is
/// one: otherwise [`collide_alone`] has it.
#[inline(always)]
fn collide<T: Real>(kinds: [GeomKind; 2], pair: &Pair<'_, T>, scratch: &mut Scratch, found: &mut Vec<Touch<T>>) -> bool {
    use GeomKind::{Box, Capsule, Cylinder, Ellipsoid, Plane, Sphere};
    match kinds {
        [Plane, Sphere] => plane::sphere(pair, found),
        [Plane, Capsule] => plane::capsule(pair, found),
        [Plane, Ellipsoid] => plane::ellipsoid(pair, found),
        [Plane, Cylinder] => plane::cylinder(pair, found),
        [Plane, Box] => plane::cuboid(pair, found),
        [Sphere, Sphere] => shapes::sphere_sphere(pair, found),
        [Sphere, Capsule] => shapes::sphere_capsule(pair, found),
        [Sphere, Ellipsoid] => ellipsoid::sphere(pair, found),
        [Capsule, Capsule] => shapes::capsule_capsule(pair, found),
        [Capsule, Ellipsoid] => ellipsoid::capsule(pair, scratch, found),
        _ => return false,
    }
    true
}

/// Calls the collider of one episode for another pair of kinds, in the same order.
fn collide_alone(
    candidate: &CollisionPair,
    first: &Placed<'_>,
    second: &Placed<'_>,
    scratch: &mut Scratch,
    found: &mut Vec<ContactPoint>,
) {
    use GeomKind::{Box, Capsule, Cylinder, Ellipsoid, HeightField, Mesh, Plane, Sphere};
    let reach = candidate.reach();
    match candidate.kinds {
        [Plane, Mesh] => plane::mesh(first, second, reach, found),
        [Sphere, Cylinder] => round::sphere_cylinder(first, second, reach, found),
        [Sphere, Box] => round::sphere_box(first, second, reach, found),
        [Capsule, Box] => capsule_box::collide(first, second, reach, found),
        [Ellipsoid, Ellipsoid] => ellipsoid::collide(first, second, reach, found),
        [Box, Box] => box_box::collide(first, second, reach, &mut scratch.polygon, found),
        [HeightField, _] => height_field::collide(first, second, reach, scratch, found),
        _ => {
            let origin = first.position;
            if let (Some(first), Some(second)) = (SupportShape::new(first, origin), SupportShape::new(second, origin)) {
                convex::manifold::collide([&first, &second], origin, reach, scratch, found);
            }
        }
    }
}

/// Whether two kinds, in either order, can meet: all but two of plane and height field.
fn can_meet(first: GeomKind, second: GeomKind) -> bool {
    use GeomKind::{HeightField, Plane};
    !(matches!(first, Plane | HeightField) && matches!(second, Plane | HeightField))
}
