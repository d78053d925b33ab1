//! The smooth half of a step gives MuJoCo 4.0.0's numbers: `tests/oracle/smooth.py` made the golden ones.

use crate::support;

use msk_physics::model::Model;
use msk_physics::{
    self as physics, Workspace,
    spatial::norm,
    tendons::{WrapShape, WrappingSurface, bend},
};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use support::{SplitMix, draw, golden, numbers, repository};

/// How far a quantity may be from MuJoCo's.
#[derive(Clone, Copy)]
enum Tolerance {
    /// Metres, radians or parts of a quaternion.
    Absolute(f64),
    /// Of the largest entry of the same quantity in the same state.
    Relative(f64),
}

/// Every stored quantity, its tolerance, and where it is found.
type Quantity = (&'static str, Tolerance, fn(&Model, &Workspace<f64>) -> Vec<f64>);
const QUANTITIES: [Quantity; 13] = [
    ("xpos", Tolerance::Absolute(1e-12), |_, w| flat(&w.kinematics.body_position)),
    ("xquat", Tolerance::Absolute(1e-12), |_, w| w.kinematics.body_orientation.concat()),
    ("ten_length", Tolerance::Absolute(1e-9), |_, w| w.tendons.length.clone()),
    ("ten_velocity", Tolerance::Relative(1e-9), |_, w| w.tendons.velocity.clone()),
    ("ten_J", Tolerance::Absolute(1e-9), moment_arms),
    ("actuator_force", Tolerance::Relative(1e-12), |_, w| w.actuation.force.clone()),
    ("act_dot", Tolerance::Relative(1e-12), |_, w| w.actuation.activation_rate.clone()),
    ("M", Tolerance::Absolute(1e-10), mass_matrix),
    ("qfrc_bias", Tolerance::Relative(1e-10), |m, w| scaled(m, w, &w.forces.bias, |force, root| force / root)),
    ("qfrc_passive", Tolerance::Relative(1e-10), |m, w| scaled(m, w, &w.forces.passive, |force, root| force / root)),
    ("qfrc_actuator", Tolerance::Relative(1e-10), |m, w| scaled(m, w, &w.forces.actuator, |force, root| force / root)),
    ("qfrc_smooth", Tolerance::Relative(1e-10), |m, w| scaled(m, w, &w.forces.smooth, |force, root| force / root)),
    ("qacc_smooth", Tolerance::Relative(1e-9), |m, w| {
        scaled(m, w, &w.forces.smooth_acceleration, |acceleration, root| acceleration * root)
    }),
];

fn flat(vectors: &[Vector3<f64>]) -> Vec<f64> {
    vectors.iter().flatten().copied().collect()
}

/// Square roots of the mass matrix's diagonal: the inertia that each dof feels.
fn inertia_roots(model: &Model, workspace: &Workspace<f64>) -> Vec<f64> {
    model.dofs.row.iter().map(|row| workspace.inertia.matrix[row.end - 1].sqrt()).collect()
}

/// A quantity of the joints on the scale of each dof's inertia, lest a finger's error hide behind the pelvis's size.
fn scaled(model: &Model, workspace: &Workspace<f64>, values: &[f64], scale: fn(f64, f64) -> f64) -> Vec<f64> {
    values.iter().zip(inertia_roots(model, workspace)).map(|(value, root)| scale(*value, root)).collect()
}

/// M_ij / sqrt(M_ii M_jj) below the diagonal, log M_ii on it.
fn mass_matrix(model: &Model, workspace: &Workspace<f64>) -> Vec<f64> {
    let roots = inertia_roots(model, workspace);
    let entry = |dof: usize, index: usize| {
        let column = model.dofs.column[index];
        if column == dof { 2.0 * roots[dof].ln() } else { workspace.inertia.matrix[index] / roots[dof] / roots[column] }
    };
    (0..model.nv).flat_map(|dof| model.dofs.row[dof].clone().map(move |index| (dof, index))).map(|(d, i)| entry(d, i)).collect()
}

fn moment_arms(model: &Model, workspace: &Workspace<f64>) -> Vec<f64> {
    let mut rows = vec![0.0; model.tendons.path.len() * model.nv];
    for (tendon, row) in rows.chunks_mut(model.nv).enumerate() {
        physics::moment_arms(model, &workspace.kinematics, &workspace.tendons, tendon, row);
    }
    rows
}

/// The weighted sums over `group` entries that the golden file holds instead of all entries; group 0 keeps them.
fn folded(values: &[f64], group: usize) -> Vec<f64> {
    if group == 0 {
        return values.to_vec();
    }
    let weighted = |(index, value): (usize, &f64)| value * ((index * 7919 % 101 + 1) as f64 / 101.0);
    let weighted: Vec<f64> = values.iter().enumerate().map(weighted).collect();
    weighted.chunks(group).map(|chunk| chunk.iter().sum()).collect()
}

/// Compares all states of one golden file and returns each quantity's worst error in units of its tolerance.
fn compare(model: &Model, name: &str) -> Vec<(&'static str, f64)> {
    let golden = golden(&format!("smooth_{name}"));
    let mut random = SplitMix(golden["seed"].as_u64().expect("a seed"));
    let mut workspace = Workspace::new(model);
    let mut worst = QUANTITIES.map(|(name, ..)| (name, 0.0f64)).to_vec();
    for (number, expected) in golden["states"].as_array().expect("states").iter().enumerate() {
        physics::smooth(model, &draw(model, &mut random), &mut workspace);
        for ((quantity, tolerance, value), worst) in QUANTITIES.iter().zip(&mut worst) {
            let group = golden["groups"][quantity].as_u64().unwrap_or(0) as usize;
            let (expected, values) = (numbers(&expected[quantity]), value(model, &workspace));
            let actual = folded(&values, group);
            assert_eq!(actual.len(), expected.len(), "{name}, state {number}: size of {quantity}");
            let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
            let allowed = match tolerance {
                Tolerance::Absolute(allowed) => *allowed,
                Tolerance::Relative(allowed) => allowed * largest,
            };
            for (index, (actual, expected)) in actual.iter().zip(&expected).enumerate() {
                let error = (actual - expected).abs();
                assert!(
                    error <= allowed,
                    "{name}, state {number}: {quantity}[{index}] is {actual:e}, MuJoCo's {expected:e}: {error:e} apart"
                );
                if allowed > 0.0 {
                    worst.1 = worst.1.max(error / allowed);
                }
            }
        }
    }
    worst
}

fn small_model(name: &str) -> Model {
    let path = repository("tests/oracle/models").join(format!("{name}.xml"));
    Model::from_file(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

macro_rules! parity {
    ($($name:ident),*) => {$(
        #[test]
        fn $name() {
            compare(&small_model(stringify!($name)), stringify!($name));
        }
    )*};
}

parity!(joints, muscles, pulley, tendon_springs, wrap_cylinder, wrap_inside, wrap_sphere);

#[test]
fn the_full_body_at_200_states() {
    let model = Model::from_file(repository("bodies/models/human416.xml")).expect("the body loads");
    let worst = compare(&model, "human416");
    println!("worst errors in units of their tolerances: {worst:?}");
}

/// Random obstacles and side points, a fifth of them next to the onset of contact, some with the ends in line.
#[test]
fn wraps_bend_as_mujocos() {
    for (number, case) in golden("wrap")["cases"].as_array().expect("cases").iter().enumerate() {
        let [start, end] = [0, 1].map(|end| Vector3::from_column_slice(&numbers(&case["ends"][end])));
        let bend = bend(&start, &end, &obstacle(case));
        let direct = (end - start).norm();
        let arc = case["arc"].as_f64().expect("a length");
        let expected_length = match case["points"].as_array() {
            None => direct,
            Some(_) => {
                let points = numbers(&case["points"]);
                let [first, second] = [0, 3].map(|at| Vector3::from_column_slice(&points[at..at + 3]));
                let center = obstacle(case).position;
                let aligned = (start - center).cross(&(end - center)).norm() < 1e-12;
                // Opposite end points leave the plane of a sphere open: any great circle is as short.
                if let Some(bend) = bend.as_ref().filter(|_| !aligned) {
                    let off = (bend.first - first).norm().max((bend.second - second).norm());
                    assert!(off < 1e-9, "case {number}: touches {off:e} m away");
                    assert!((bend.arc - arc).abs() < 1e-9, "case {number}: arc {} for {arc}", bend.arc);
                }
                (first - start).norm() + arc + (end - second).norm()
            }
        };
        let length = bend.map_or(direct, |bend| norm(&(bend.first - start)) + bend.arc + norm(&(end - bend.second)));
        assert!((length - expected_length).abs() < 1e-9, "case {number}: path of {length} m, MuJoCo's {expected_length} m");
    }
}

fn obstacle(case: &Value) -> WrappingSurface<f64> {
    WrappingSurface {
        shape: if case["shape"] == "sphere" { WrapShape::Sphere } else { WrapShape::Cylinder },
        position: Vector3::from_column_slice(&numbers(&case["position"])),
        rotation: Matrix3::from_row_slice(&numbers(&case["rotation"])),
        radius: case["radius"].as_f64().expect("a radius"),
        side: case["side"].as_array().map(|_| Vector3::from_column_slice(&numbers(&case["side"]))),
    }
}
