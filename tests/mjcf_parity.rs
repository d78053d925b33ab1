//! Reading a file gives MuJoCo 4.0.0's arrays: `tests/oracle/mjcf.py` made the golden ones and documents how they are stored.

use crate::support;

use core::ops::Range;
use msk_physics::model::{GeomKind, Model, Muscle, PathPoint, Quaternion, SolverParameters, rotation};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use support::{golden, numbers, repository};

/// Of the number itself, or of a thousandth where it is smaller: rounding of a few operations.
const TOLERANCE: f64 = 1e-12;

/// An array by its name in the golden file.
type Quantity = (&'static str, fn(&Model) -> Vec<f64>);
const QUANTITIES: [Quantity; 34] = [
    ("qpos0", |m| m.reference_position.clone()),
    ("option", options),
    ("body_tree", |m| rows(m.bodies.name.len(), |body| tree(m, body))),
    ("body_pos", |m| flat(&m.bodies.position)),
    ("body_mat", |m| matrices(&m.bodies.orientation)),
    ("body_ipos", |m| flat(&m.bodies.inertial_position)),
    ("body_tensor", |m| rows(m.bodies.name.len(), |body| tensor(m, body))),
    ("body_mass", |m| rows(m.bodies.name.len(), |body| vec![m.bodies.mass[body], m.bodies.subtree_mass[body]])),
    ("jnt_index", |m| rows(m.joints.name.len(), |joint| joint_index(m, joint))),
    ("jnt_pos", |m| flat(&m.joints.anchor)),
    ("jnt_axis", |m| flat(&m.joints.axis)),
    ("jnt_range", |m| ranges(&m.joints.range)),
    ("jnt_number", |m| rows(m.joints.name.len(), |joint| joint_numbers(m, joint))),
    ("jnt_limit", |m| rows(m.joints.name.len(), |joint| softness(&m.joints.limit_softness[joint]))),
    ("dof_index", |m| rows(m.nv, |dof| vec![m.dofs.body[dof] as f64, m.dofs.joint[dof] as f64, index(m.dofs.parent[dof])])),
    ("dof_number", |m| rows(m.nv, |dof| vec![m.dofs.armature[dof], m.dofs.damping[dof], m.dofs.friction_loss[dof]])),
    ("geom_index", |m| rows(m.geoms.name.len(), |geom| geom_index(m, geom))),
    ("geom_size", |m| flat(&m.geoms.size)),
    ("geom_pos", |m| flat(&m.geoms.position)),
    ("geom_mat", |m| matrices(&m.geoms.orientation)),
    ("geom_number", |m| rows(m.geoms.name.len(), |geom| geom_numbers(m, geom))),
    ("site_index", |m| m.sites.body.iter().map(|body| *body as f64).collect()),
    ("site_pos", |m| flat(&m.sites.position)),
    ("site_mat", |m| matrices(&m.sites.orientation)),
    ("tendon_index", |m| rows(m.tendons.name.len(), |t| vec![m.tendons.path[t].len() as f64, one(m.tendons.range[t].is_some())])),
    ("tendon_number", |m| rows(m.tendons.name.len(), |tendon| tendon_numbers(m, tendon))),
    ("wrap", |m| m.tendons.path_points.iter().flat_map(|point| path_point(m, point)).collect()),
    ("actuator_index", |m| rows(m.actuators.name.len(), |actuator| actuator_index(m, actuator))),
    ("actuator_number", |m| rows(m.actuators.name.len(), |actuator| actuator_numbers(m, actuator))),
    ("eq_index", |m| rows(m.couplings.joint.len(), |c| vec![m.couplings.joint[c] as f64, index(m.couplings.leader[c])])),
    ("eq_number", |m| rows(m.couplings.joint.len(), |coupling| coupling_numbers(m, coupling))),
    ("pair_index", |m| rows(m.pairs.geoms.len(), |pair| pair_index(m, pair))),
    ("pair_number", |m| rows(m.pairs.geoms.len(), |pair| pair_numbers(m, pair))),
    ("exclude", |m| m.exclusions.iter().flat_map(|(first, second)| [*first as f64, *second as f64]).collect()),
];

fn rows(count: usize, row: impl Fn(usize) -> Vec<f64>) -> Vec<f64> {
    (0..count).flat_map(row).collect()
}

fn flat(vectors: &[Vector3<f64>]) -> Vec<f64> {
    vectors.iter().flatten().copied().collect()
}

fn row_major(matrix: &Matrix3<f64>) -> Vec<f64> {
    matrix.transpose().iter().copied().collect()
}

fn matrices(orientations: &[Quaternion]) -> Vec<f64> {
    orientations.iter().flat_map(|q| row_major(&rotation::matrix(*q))).collect()
}

fn one(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}

fn index(index: Option<usize>) -> f64 {
    index.map_or(-1.0, |index| index as f64)
}

fn ranges(ranges: &[Option<[f64; 2]>]) -> Vec<f64> {
    ranges.iter().flat_map(|range| range.unwrap_or_default()).collect()
}

fn softness(softness: &SolverParameters) -> Vec<f64> {
    softness.reference.iter().chain(&softness.impedance).copied().collect()
}

fn options(model: &Model) -> Vec<f64> {
    let options = &model.options;
    let counts = [options.iterations as f64, options.line_search_iterations as f64];
    let rest = [options.tolerance, options.line_search_tolerance, options.impedance_ratio];
    [options.timestep].into_iter().chain(options.gravity.iter().copied()).chain(counts).chain(rest).collect()
}

fn tree(model: &Model, body: usize) -> Vec<f64> {
    let bodies = &model.bodies;
    let count = |range: &Range<usize>| range.len();
    let numbers =
        [bodies.parent[body], bodies.root[body], bodies.weld[body], count(&bodies.joints[body]), count(&bodies.dofs[body])];
    numbers.map(|number| number as f64).to_vec()
}

fn tensor(model: &Model, body: usize) -> Vec<f64> {
    let axes = rotation::matrix(model.bodies.inertial_orientation[body]);
    row_major(&(axes * Matrix3::from_diagonal(&model.bodies.inertia[body]) * axes.transpose()))
}

fn joint_index(model: &Model, joint: usize) -> Vec<f64> {
    let joints = &model.joints;
    let addresses = [joints.body[joint], joints.position_address[joint], joints.dof_address[joint]];
    let addresses = addresses.map(|address| address as f64);
    [f64::from(joints.kind[joint] as u8)].into_iter().chain(addresses).chain([one(joints.range[joint].is_some())]).collect()
}

fn joint_numbers(model: &Model, joint: usize) -> Vec<f64> {
    let joints = &model.joints;
    vec![joints.margin[joint], joints.stiffness[joint], joints.spring_reference[joint]]
}

fn geom_index(model: &Model, geom: usize) -> Vec<f64> {
    let geoms = &model.geoms;
    let kind = match geoms.kind[geom] {
        GeomKind::Plane => 0.0,
        GeomKind::Sphere => 2.0,
        GeomKind::Capsule => 3.0,
        GeomKind::Ellipsoid => 4.0,
        GeomKind::Cylinder => 5.0,
        GeomKind::Box => 6.0,
        GeomKind::HeightField => 1.0,
        GeomKind::Mesh => 7.0,
    };
    let bits = [f64::from(geoms.contact_type[geom]), f64::from(geoms.contact_affinity[geom])];
    let rest = [f64::from(geoms.contact_dimension[geom]), f64::from(geoms.priority[geom]), f64::from(geoms.group[geom])];
    [kind, geoms.body[geom] as f64].into_iter().chain(bits).chain(rest).collect()
}

fn geom_numbers(model: &Model, geom: usize) -> Vec<f64> {
    let geoms = &model.geoms;
    let mut numbers = vec![geoms.softness_mix[geom], geoms.margin[geom], geoms.gap[geom], geoms.bounding_radius[geom]];
    numbers.extend(geoms.friction[geom]);
    numbers.extend(softness(&geoms.softness[geom]));
    numbers
}

fn tendon_numbers(model: &Model, tendon: usize) -> Vec<f64> {
    let tendons = &model.tendons;
    let mut numbers = vec![tendons.stiffness[tendon], tendons.damping[tendon], tendons.margin[tendon]];
    numbers.extend(tendons.range[tendon].unwrap_or_default());
    numbers.extend(softness(&tendons.limit_softness[tendon]));
    numbers
}

/// Kind, object and parameter of a path entry as MuJoCo numbers them.
fn path_point(model: &Model, point: &PathPoint) -> [f64; 3] {
    match point {
        PathPoint::Pulley(divisor) => [2.0, -1.0, *divisor],
        PathPoint::Site(site) => [3.0, *site as f64, 0.0],
        PathPoint::Joint { joint, coefficient } => [1.0, *joint as f64, *coefficient],
        PathPoint::Wrap { geom, side } => {
            let kind = if model.geoms.kind[*geom] == GeomKind::Sphere { 4.0 } else { 5.0 };
            [kind, *geom as f64, index(*side)]
        }
    }
}

fn muscle(model: &Model, actuator: usize) -> Muscle {
    model.actuators.muscle(actuator).expect("a muscle")
}

fn actuator_index(model: &Model, actuator: usize) -> Vec<f64> {
    vec![muscle(model, actuator).tendon as f64, one(model.actuators.control_range[actuator].is_some())]
}

fn actuator_numbers(model: &Model, actuator: usize) -> Vec<f64> {
    let actuators = &model.actuators;
    let muscle = muscle(model, actuator);
    let mut numbers = vec![muscle.gear];
    numbers.extend(actuators.control_range[actuator].unwrap_or_default());
    numbers.extend(actuators.length_range[actuator]);
    numbers.extend(muscle.time_constants);
    numbers.extend(muscle.active);
    numbers.extend(muscle.passive);
    numbers
}

fn coupling_numbers(model: &Model, coupling: usize) -> Vec<f64> {
    let couplings = &model.couplings;
    couplings.polynomial[coupling].into_iter().chain(softness(&model.equalities.softness[couplings.equality[coupling]])).collect()
}

fn pair_index(model: &Model, pair: usize) -> Vec<f64> {
    let [first, second] = model.pairs.geoms[pair];
    vec![first as f64, second as f64, f64::from(model.pairs.dimension[pair])]
}

fn pair_numbers(model: &Model, pair: usize) -> Vec<f64> {
    let pairs = &model.pairs;
    let mut numbers = pairs.friction[pair].to_vec();
    numbers.extend(softness(&pairs.softness[pair]));
    numbers.extend(pairs.friction_reference[pair]);
    numbers.extend([pairs.margin[pair], pairs.gap[pair]]);
    numbers
}

/// Weighted sums over 64 consecutive entries, as the golden file holds them for large models.
fn folded(values: &[f64]) -> Vec<f64> {
    let weighted = |(index, value): (usize, &f64)| value * ((index * 7919 % 101 + 1) as f64 / 101.0);
    let weighted: Vec<f64> = values.iter().enumerate().map(weighted).collect();
    weighted.chunks(64).map(|chunk| chunk.iter().sum()).collect()
}

fn compare(model: &Model, name: &str, whole: bool) {
    let golden = &golden("mjcf")[name];
    for (quantity, read) in QUANTITIES {
        let values = read(model);
        let actual = if whole { values } else { folded(&values) };
        let expected = numbers(&golden["arrays"][quantity]);
        assert_eq!(actual.len(), expected.len(), "{name}: size of {quantity}");
        for (index, (actual, expected)) in actual.iter().zip(&expected).enumerate() {
            let error = (actual - expected).abs();
            assert!(
                error <= TOLERANCE * expected.abs().max(1e-3),
                "{name}: {quantity}[{index}] is {actual:e}, MuJoCo's {expected:e}"
            );
        }
    }
}

fn compare_names(model: &Model, name: &str) {
    let golden = &golden("mjcf")[name]["names"];
    let kinds: [(&str, &[String]); 6] = [
        ("body", &model.bodies.name),
        ("joint", &model.joints.name),
        ("site", &model.sites.name),
        ("tendon", &model.tendons.name),
        ("actuator", &model.actuators.name),
        ("equality", &model.equalities.name),
    ];
    for (kind, names) in kinds {
        let expected: Vec<&str> = golden[kind].as_array().expect("names").iter().filter_map(Value::as_str).collect();
        assert_eq!(names, expected, "{name}: names of kind {kind}");
    }
}

macro_rules! parity {
    ($($name:ident),*) => {$(
        #[test]
        fn $name() {
            let path = repository("tests/oracle/models/mjcf").join(concat!(stringify!($name), ".xml"));
            let model = Model::from_file(&path).unwrap_or_else(|error| panic!("{error}"));
            compare(&model, stringify!($name), true);
            compare_names(&model, stringify!($name));
        }
    )*};
}

parity!(frames, inertias, actuators, copies, masses);

/// Measured by ten seconds of simulation against soft limits: what the two solvers leave open of each step shows in the
/// last micrometre.
#[test]
fn length_ranges() {
    const TOLERANCE: f64 = 1e-6;
    let model = Model::from_file(repository("tests/oracle/models/mjcf/ranges.xml")).unwrap_or_else(|error| panic!("{error}"));
    let golden = &golden("mjcf")["ranges"]["arrays"]["actuator_number"];
    let count = model.actuators.name.len();
    let expected = numbers(golden);
    // After the gear and the two ends of the control range.
    let (width, place) = (expected.len() / count, 3);
    for actuator in 0..count {
        for side in 0..2 {
            let (found, wanted) = (model.actuators.length_range[actuator][side], expected[actuator * width + place + side]);
            let name = &model.actuators.name[actuator];
            assert!((found - wanted).abs() < TOLERANCE, "{name}: length {found}, MuJoCo's {wanted}");
        }
    }
}

#[test]
fn the_full_body() {
    let model = Model::from_file(repository("bodies/models/human416.xml")).unwrap_or_else(|error| panic!("{error}"));
    compare(&model, "human416", false);
}
