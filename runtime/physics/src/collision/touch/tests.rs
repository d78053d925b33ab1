//! Lanes get the bits that their episodes get alone.

use super::super::{ContactPoint, Placed, Scratch, collide, place::Asset};
use super::{Pair, Touch};
use crate::{
    lanes::{Lanes, WIDTH},
    model::GeomKind,
    scalar::Real,
};
use GeomKind::{Box, Capsule, Cylinder, Ellipsoid, HeightField, Mesh, Plane, Sphere};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;

const KINDS: [GeomKind; 8] = [Plane, HeightField, Sphere, Capsule, Ellipsoid, Cylinder, Box, Mesh];

/// All pairs of kinds whose contacts are found in all lanes at once.
fn pairs() -> Vec<[GeomKind; 2]> {
    let all = KINDS.into_iter().flat_map(|first| KINDS.map(|second| [first, second]));
    let pose = Pose { position: Vector3::zeros(), rotation: Matrix3::identity(), size: Vector3::from_element(0.1) };
    let known = |kinds: &[GeomKind; 2]| {
        let shapes = kinds.map(|kind| placed(kind, &pose));
        collide(*kinds, &Pair { shapes, reach: 0.0, lanes: true }, &mut Scratch::default(), &mut Vec::new())
    };
    all.filter(known).collect()
}

/// Where a shape is, and its size.
#[derive(Debug, Clone, Copy)]
struct Pose {
    position: Vector3<f64>,
    rotation: Matrix3<f64>,
    size: Vector3<f64>,
}

/// Numbers near zero, among them those at which branches meet.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -0.5..0.5f64,
        2 => prop::sample::select(vec![0.0, -0.0, 0.1, -0.1, 0.2, 0.25, -0.3]),
        1 => (-2..3_i32).prop_map(|count| f64::from(count) * 1e-15),
        1 => -1e-9..1e-9f64,
    ]
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![6 => 0.01..0.4f64, 2 => prop::sample::select(vec![0.05, 0.1, 0.2, 0.25]), 1 => Just(1e-9)]
}

/// Any rotation, or one that turns axes into axes.
fn rotation() -> impl Strategy<Value = Matrix3<f64>> {
    let part = || prop_oneof![3 => -1.0..1.0f64, 2 => prop::sample::select(vec![0.0, 1.0, -1.0])];
    [part(), part(), part(), part()].prop_map(|[w, x, y, z]| {
        let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6);
        rotation.map_or_else(Matrix3::identity, |rotation| rotation.to_rotation_matrix().into_inner())
    })
}

fn pose() -> impl Strategy<Value = Pose> {
    let vector = [coordinate(), coordinate(), coordinate()].prop_map(Vector3::from);
    let size = [length(), length(), length()].prop_map(Vector3::from);
    (vector, rotation(), size).prop_map(|(position, rotation, size)| Pose { position, rotation, size })
}

/// What is special about two shapes.
#[derive(Debug, Clone, Copy)]
enum Special {
    Nothing,
    Parallel,
    Opposite,
    NearlyParallel,
    InOnePlace,
    AlongTheAxis,
    /// The second lies above the first so far that their surfaces meet where both are round.
    Touching,
    Alike,
}

/// Two shapes in a lane.
fn placed_pair() -> impl Strategy<Value = [Pose; 2]> {
    use Special::{Alike, AlongTheAxis, InOnePlace, NearlyParallel, Nothing, Opposite, Parallel, Touching};
    let special = prop::sample::select(vec![
        Nothing,
        Nothing,
        Nothing,
        Nothing,
        Parallel,
        Opposite,
        NearlyParallel,
        InOnePlace,
        AlongTheAxis,
        Touching,
        Alike,
    ]);
    (pose(), pose(), special, coordinate()).prop_map(|(first, mut second, special, by)| {
        let axis = first.rotation.column(2).into_owned();
        match special {
            Nothing => {}
            Parallel => second.rotation = first.rotation,
            Opposite => {
                let turned = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
                second.rotation = first.rotation * turned;
            }
            NearlyParallel => {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1e-8 * by).to_rotation_matrix();
                second.rotation = first.rotation * turn.into_inner();
            }
            InOnePlace => second.position = first.position,
            AlongTheAxis => {
                second.position = first.position + axis * by;
                second.rotation = first.rotation;
            }
            Touching => {
                second.position = first.position + first.rotation.column(0) * (first.size.x + second.size.x);
                second.rotation = first.rotation;
            }
            Alike => second = Pose { position: second.position, ..first },
        }
        [first, second]
    })
}

fn placed(kind: GeomKind, pose: &Pose) -> Placed<'static> {
    Placed { kind, position: pose.position, rotation: pose.rotation, size: pose.size, asset: Asset::None }
}

/// The shapes of all lanes.
fn in_lanes(kind: GeomKind, poses: &[Pose]) -> Placed<'static, Lanes> {
    let zero = Lanes::splat(0.0);
    let (position, rotation) = (Vector3::from_element(zero), Matrix3::from_element(zero));
    let mut all = Placed { kind, position, rotation, size: position, asset: Asset::None };
    for (lane, pose) in poses.iter().enumerate() {
        all.position.iter_mut().zip(&pose.position).for_each(|(to, from)| to.set_lane(lane, *from));
        all.rotation.iter_mut().zip(&pose.rotation).for_each(|(to, from)| to.set_lane(lane, *from));
        all.size.iter_mut().zip(&pose.size).for_each(|(to, from)| to.set_lane(lane, *from));
    }
    all
}

fn bits(point: &ContactPoint) -> Vec<u64> {
    let numbers = point.position.iter().chain(&point.frame).chain([&point.distance]);
    numbers.map(|number| if number.is_nan() { u64::MAX } else { number.to_bits() }).collect()
}

/// What each lane has of the contacts.
fn of_lane<T: Real>(found: &[Touch<T>], lane: usize) -> Vec<ContactPoint> {
    found.iter().filter_map(|touch| touch.in_lane(lane)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn lanes_find_the_contacts_that_each_finds_alone(
        kinds in prop::sample::select(pairs()),
        poses in prop::collection::vec(placed_pair(), WIDTH),
        asked in prop::collection::vec(prop::bool::weighted(0.8), WIDTH),
        reach in prop::sample::select(vec![0.0, 0.001, 0.05, 1.0]),
    ) {
        let (mut scratch, mut together, mut alone) = (Scratch::default(), Vec::new(), Vec::new());
        let [firsts, seconds] = [0, 1].map(|shape| poses.iter().map(|pair| pair[shape]).collect::<Vec<_>>());
        let shapes = [in_lanes(kinds[0], &firsts), in_lanes(kinds[1], &seconds)];
        let pair = Pair { shapes, reach: Lanes::splat(reach), lanes: Lanes::mask(|lane| asked[lane]) };
        collide(kinds, &pair, &mut scratch, &mut together);
        for (lane, poses) in poses.iter().enumerate() {
            let shapes = [placed(kinds[0], &poses[0]), placed(kinds[1], &poses[1])];
            alone.clear();
            if asked[lane] {
                collide(kinds, &Pair { shapes, reach, lanes: true }, &mut scratch, &mut alone);
            }
            let (found, expected) = (of_lane(&together, lane), of_lane(&alone, 0));
            prop_assert_eq!(
                found.iter().map(bits).collect::<Vec<_>>(), expected.iter().map(bits).collect::<Vec<_>>(),
                "{:?} in lane {}: {:?}, alone {:?}", kinds, lane, found, expected
            );
        }
    }
}

#[test]
fn planes_and_round_shapes_are_found_in_lanes() {
    assert_eq!(pairs().len(), 10);
}
