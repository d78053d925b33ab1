//! Heights, gaps and sectors against brute force.

use crate::scene::convex::{gap, support_point};
use crate::scene::ground::{ABYSS, Ground};
use crate::scene::radar::Radar;
use crate::scene::terrain;
use crate::scene::{NewGeom, SceneBuilder};
use msk_physics::collision::{Placed, SupportShape, ray};
use msk_physics::model::{GeomKind, HeightField, Model};
use msk_physics::scalar::Real;
use msk_physics::{State, Workspace, kinematics};
use msk_program::scene::Terrain;
use nalgebra::{Rotation3, Vector2, Vector3};
use proptest::prelude::*;

const KINDS: [GeomKind; 5] = [GeomKind::Sphere, GeomKind::Capsule, GeomKind::Ellipsoid, GeomKind::Cylinder, GeomKind::Box];

/// A model of these shapes, all fixed to the world.
fn model(geoms: impl IntoIterator<Item = NewGeom>) -> Model {
    let empty = Model::from_mjcf("<mujoco/>").unwrap();
    let mut builder = SceneBuilder::new(&empty);
    for geom in geoms {
        builder.geom(0, geom);
    }
    builder.build().unwrap().model
}

fn placed(model: &Model) -> Workspace<f64> {
    let mut workspace = Workspace::new(model);
    kinematics::update(model, &State::new(model), &mut workspace.kinematics);
    workspace
}

fn turn([roll, pitch, yaw]: [f64; 3]) -> [f64; 4] {
    msk_physics::model::rotation::from_matrix(Rotation3::from_euler_angles(roll, pitch, yaw).matrix())
}

fn solid(kind: usize, size: [f64; 3], position: [f64; 3], angles: [f64; 3]) -> NewGeom {
    NewGeom { kind: KINDS[kind], size: size.into(), position: position.into(), orientation: turn(angles), ..NewGeom::default() }
}

fn at(x: f64, y: f64) -> Vector2<f64> {
    Vector2::new(x, y)
}

#[test]
fn stairs_rise_step_by_step_and_end_in_an_abyss() {
    let flight = Terrain::Stairs { count: 10, rise: 0.15, run: 0.5, width: 4.0 };
    let model = model(terrain::shapes("flight", &flight));
    let workspace = placed(&model);
    let shapes: Vec<usize> = (0..10).collect();
    let ground = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &shapes };
    for step in 0..10 {
        let footing = ground.footing(at(0.5 * f64::from(step) + 0.1, -1.9)).unwrap();
        assert!((footing.height - 0.15 * f64::from(step + 1)).abs() < 1e-14, "step {step}: {}", footing.height);
        assert_eq!(footing.normal, Vector3::z());
    }
    assert_eq!(ground.height(at(-0.1, 0.0)), ABYSS);
    assert_eq!((ground.height(at(5.1, 0.0)), ground.footing(at(2.0, 2.1))), (ABYSS, None));
}

#[test]
fn stairs_that_go_down_have_their_first_tread_below_their_place() {
    let model = model(terrain::shapes("flight", &Terrain::Stairs { count: 3, rise: -0.2, run: 0.3, width: 1.0 }));
    let workspace = placed(&model);
    let ground = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &[0, 1, 2] };
    let heights = [0.1, 0.4, 0.7].map(|x| ground.height(at(x, 0.0)));
    assert!(heights.iter().zip([-0.2, -0.4, -0.6]).all(|(found, expected)| (found - expected).abs() < 1e-14), "{heights:?}");
}

#[test]
fn a_slope_rises_from_its_edge_and_one_that_goes_down_falls() {
    for angle in [0.2, -0.3] {
        let model = model(terrain::shapes("ramp", &Terrain::Slope { length: 3.0, width: 2.0, angle }));
        let workspace = placed(&model);
        let ground = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &[0] };
        for x in [0.01, 1.0, 2.99] {
            let footing = ground.footing(at(x, 0.9)).unwrap();
            assert!((footing.height - x * angle.tan()).abs() < 1e-12, "{x}: {}", footing.height);
            assert!((footing.normal - Vector3::new(-angle.sin(), 0.0, angle.cos())).norm() < 1e-12);
        }
    }
}

#[test]
fn a_height_field_is_as_high_as_its_samples_and_flat_between_three_of_them() {
    let heights: Vec<f64> = (0..35).map(|index| 0.1 * f64::from(index * index % 7) - 0.2).collect();
    let field = Terrain::Heights { size: [3.0, 2.0], samples: [7, 5], heights: heights.clone() };
    let model = model(terrain::shapes("hills", &field));
    let workspace = placed(&model);
    let ground = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &[0] };
    for row in 0..5_usize {
        for column in 0..7_usize {
            let inwards = |index: usize, last: usize| {
                if index == 0 {
                    1e-9
                } else if index == last {
                    -1e-9
                } else {
                    0.0
                }
            };
            let (x, y) = (column as f64 * 0.5 + inwards(column, 6), row as f64 * 0.5 - 1.0 + inwards(row, 4));
            let height = ground.height(at(x, y));
            assert!((height - heights[row * 7 + column]).abs() < 1e-8, "{column}, {row}: {height}");
        }
    }
    // Along a grid line heights are interpolated.
    let middle = ground.height(at(0.75, -0.5));
    assert!((middle - 0.5 * (heights[8] + heights[9])).abs() < 1e-12);
}

#[test]
fn a_ball_beside_an_edge_clears_it_by_its_roundness() {
    let edge = NewGeom { kind: GeomKind::Box, size: Vector3::new(1.0, 1.0, 0.5), ..NewGeom::default() };
    let ball = |x: f64| NewGeom { size: Vector3::new(0.2, 0.0, 0.0), position: Vector3::new(x, 0.0, 1.0), ..NewGeom::default() };
    let beside = |x: f64| 0.5 - (0.04 - (x - 1.0) * (x - 1.0)).sqrt();
    let cases = [(0.3, 0.3), (1.0, 0.3), (1.12, beside(1.12)), (1.2 - 1e-6, beside(1.2 - 1e-6)), (1.3, f64::INFINITY)];
    for (x, expected) in cases {
        let model = model([edge.clone(), ball(x)]);
        let workspace = placed(&model);
        let ground = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &[0] };
        let found = ground.clearance(&[1]);
        assert!(found == expected || (found - expected).abs() < 1e-10, "{x}: {found} is not {expected}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn a_gap_is_the_least_height_over_the_ground(
        kinds in [0..5_usize, 0..5_usize], sizes in prop::array::uniform2(prop::array::uniform3(0.1..0.5_f64)),
        angles in prop::array::uniform2(prop::array::uniform3(-3.0..3.0_f64)), shift in prop::array::uniform3(-0.4..0.4_f64),
    ) {
        let [x, y, z] = shift;
        let model = model([solid(kinds[0], sizes[0], [x, y, z + 1.0], angles[0]), solid(kinds[1], sizes[1], [0.0; 3], angles[1])]);
        let workspace = placed(&model);
        let [upper, lower] = [0, 1].map(|geom| Placed::of(&model, &workspace.kinematics, 0, geom));
        let ground = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &[1] };
        let found = gap(&SupportShape::new(&upper, Vector3::zeros()).unwrap(), &SupportShape::new(&lower, Vector3::zeros()).unwrap());
        prop_assert_eq!(found.is_some(), ground.clearance(&[0]).is_finite());
        // The height over the ground is convex where it is defined: a grid finds the valley, finer ones its bottom. Where shapes overlap in a
        // strip, the first places are far from it, so grids shrink slowly.
        let (mut least, mut middle, mut half) = (f64::INFINITY, at(x, y), 1.0);
        for _ in 0..12 {
            let centre = middle;
            for cell in 0..60 * 60 {
                let place = centre + (at(f64::from(cell % 60), f64::from(cell / 60)) / 29.5 - at(1.0, 1.0)) * half;
                let Some(footing) = ground.footing(place) else { continue };
                let below = Vector3::new(place.x, place.y, -9.0);
                let Some((rise, _)) = ray::meet(&upper, below, Vector3::z()) else { continue };
                if rise - 9.0 - footing.height < least {
                    (least, middle) = (rise - 9.0 - footing.height, place);
                }
            }
            half *= 0.4;
        }
        match found {
            // Shapes that overlap by less than a cell may be missed.
            None => prop_assert!(least.is_infinite(), "there is a gap of {least}"),
            Some(found) => {
                prop_assert!(found <= least + 1e-9, "{} is above {}", found, least);
                prop_assert!(least.is_infinite() || least - found < 0.01, "{} is below {}", found, least);
                prop_assert!((found - ground.clearance(&[0])).abs() < 1e-9, "{} is not {}", ground.clearance(&[0]), found);
            }
        }
    }

    #[test]
    fn clearance_over_hills_is_continuous_and_the_least_height(
        kind in 0..5_usize, size in prop::array::uniform3(0.05..0.3_f64), angles in prop::array::uniform3(-3.0..3.0_f64),
        place in [0.5..2.5_f64, -0.5..0.5_f64], samples in prop::collection::vec(0.0..1.0_f64, 63),
    ) {
        let radius = [1.5, 1.0];
        let field = NewGeom {
            kind: GeomKind::HeightField,
            position: Vector3::new(1.5, 0.0, 0.0),
            heights: Some(HeightField { name: "hills".into(), rows: 7, columns: 9, radius, elevation: 0.4, base: 0.1, samples }),
            ..NewGeom::default()
        };
        let over = |[x, y]: [f64; 2]| {
            let model = model([field.clone(), solid(kind, size, [x, y, 1.0], angles)]);
            let workspace = placed(&model);
            let ground = Ground { model: &model, kinematics: &workspace.kinematics, shapes: &[0] };
            let upper = Placed::of(&model, &workspace.kinematics, 0, 1);
            let mut least = f64::INFINITY;
            for cell in 0..40 * 40 {
                let place = at(f64::from(cell % 40), f64::from(cell / 40)) / 39.0 * 1.2 + at(x - 0.6, y - 0.6);
                let below = Vector3::new(place.x, place.y, -9.0);
                let Some((rise, _)) = ray::meet(&upper, below, Vector3::z()) else { continue };
                least = least.at_most(rise - 9.0 - ground.height(place));
            }
            (ground.clearance(&[1]), least)
        };
        let (found, least) = over(place);
        prop_assert!(found <= least + 1e-9 && least - found < 0.15, "{} is not {}", found, least);
        // Triangles are no steeper than 0.4 m over a quarter of a metre, and shapes do not jump either.
        let (near, _) = over([place[0] + 1e-7, place[1]]);
        prop_assert!((near - found).abs() < 1e-6, "{} then {}", found, near);
    }

    #[test]
    fn a_radar_sees_the_nearest_point_in_each_sector(
        kind in 0..5_usize, size in prop::array::uniform3(0.05..0.5_f64), angles in prop::array::uniform3(-3.0..3.0_f64),
        place in [-1.5..1.5_f64, -1.5..1.5_f64], course in -3.0..3.0_f64, over in 0.5..6.2_f64, count in 1..9_usize,
    ) {
        let model = model([solid(kind, size, [place[0], place[1], 0.3], angles)]);
        let workspace = placed(&model);
        let shape = Placed::of(&model, &workspace.kinematics, 0, 0);
        let solid = SupportShape::new(&shape, Vector3::zeros()).unwrap();
        let heading = at(course.cos(), course.sin());
        let radar = Radar { eye: at(0.1, -0.2), heading, over, range: 2.5 };
        let mut found = vec![0.0; count];
        radar.see(&solid, &mut found);
        // An eye inside sees itself; one nearer to the rim than two centimetres looks between samples that are a millimetre apart.
        prop_assume!(found.iter().all(|nearness| *nearness < 1.0 - 0.02 / 2.5));
        let mut expected = vec![0.0_f64; count];
        let rim = |index: u32| {
            // No direction is square to a straight side: such a side has no one farthest point.
            let angle = (f64::from(index % 720) + 0.37) * core::f64::consts::TAU / 720.0;
            support_point(&solid, &Vector3::new(angle.cos(), angle.sin(), 0.0)).xy() - radar.eye
        };
        for index in 0..720 {
            let [here, there] = [rim(index), rim(index + 1)];
            let parts = ((there - here).norm() / 1e-3).ceil();
            for share in 0..parts as u32 {
                let seen = here + (there - here) * (f64::from(share) / parts);
                let bearing = heading.perp(&seen).atan2(heading.dot(&seen));
                let sector = (0.5 - bearing / over) * count as f64;
                if (0.0..count as f64).contains(&sector) {
                    let nearness = &mut expected[sector as usize];
                    *nearness = nearness.at_least(1.0 - seen.norm() / 2.5);
                }
            }
        }
        for (sector, (found, expected)) in found.iter().zip(&expected).enumerate() {
            // Of what it sees the sampling sees no more, and hardly less; at a sector's edge it may see nothing yet.
            prop_assert!(*found >= expected - 1e-4, "sector {}: {} misses {}", sector, found, expected);
            prop_assert!(found - expected < 0.08 || *expected == 0.0, "sector {}: {} instead of {}", sector, found, expected);
        }
    }
}
