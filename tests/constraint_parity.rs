//! The constrained half of a step gives MuJoCo 4.0.0's numbers: `tests/oracle/constraint.py` made the golden ones.

use crate::support;

use msk_physics::model::{JointKind, Model};
use msk_physics::{State, Workspace, collision::Contact, forward, step};
use nalgebra::Vector3;
use serde_json::Value;
use support::{SplitMix, golden, numbers, repository};

/// How far a quantity may be from MuJoCo's.
#[derive(Clone, Copy)]
enum Tolerance {
    /// In its own unit.
    Absolute(f64),
    /// Of the largest entry of the same quantity in the same state, or of one unit.
    Relative(f64),
}

/// A stored quantity, its tolerance, that where MuJoCo's iterative convex collider took part, and where it is found.
type Quantity = (&'static str, Tolerance, Tolerance, fn(&Model, &Workspace<f64>) -> Vec<f64>);
use Tolerance::{Absolute, Relative};

const QUANTITIES: [Quantity; 7] = [
    ("position", Absolute(1e-9), Absolute(1e-9), |_, w| w.lanes[0].constraints.rows.position.clone()),
    ("velocity", Absolute(1e-9), Absolute(1e-4), |_, w| w.lanes[0].constraints.rows.velocity.clone()),
    ("reference", Relative(1e-9), Relative(1e-5), |_, w| w.lanes[0].constraints.rows.reference.clone()),
    ("logweight", Absolute(1e-9), Absolute(1e-8), |_, w| {
        w.lanes[0].constraints.rows.weight.iter().map(|weight| weight.ln()).collect()
    }),
    ("jacobian", Absolute(1e-9), Absolute(1e-4), |m, w| {
        let constraints = &w.lanes[0].constraints;
        (0..constraints.rows.len()).flat_map(|row| constraints.jacobian_row(m, row)).collect()
    }),
    ("force", Relative(1e-6), Relative(2e-5), |_, w| w.lanes[0].constraints.rows.force.clone()),
    ("qacc", Relative(1e-6), Relative(2e-5), |m, w| {
        let inertia = m.dofs.row.iter().map(|row| w.inertia.matrix[row.end - 1]);
        w.acceleration.iter().zip(inertia).map(|(acceleration, inertia)| acceleration * inertia.sqrt()).collect()
    }),
];

/// The random state that `draw` of `tests/oracle/constraint.py` makes, number for number.
fn draw(model: &Model, random: &mut SplitMix, violated: bool) -> State<f64> {
    let mut state = State::new(model);
    let reach = if violated { 0.05 } else { -0.05 };
    let muscles = !model.actuators.name.is_empty();
    for joint in 0..model.joints.kind.len() {
        let address = model.joints.position_address[joint];
        let kind = model.joints.kind[joint];
        let width = match kind {
            JointKind::Free => 7,
            JointKind::Ball => 4,
            JointKind::Hinge | JointKind::Slide => {
                let [low, high] = model.joints.range[joint].unwrap_or([-0.1, 0.1]);
                state.position[address] = low + (high - low) * random.between(-reach, 1.0 + reach);
                continue;
            }
        };
        state.position[address..address + width].fill_with(|| random.between(-1.0, 1.0));
        if kind == JointKind::Free && !muscles {
            state.position[address..address + 3].iter_mut().for_each(|coordinate| *coordinate *= 0.12);
        }
    }
    for coupling in 0..model.couplings.joint.len() {
        let address = |joint: usize| model.joints.position_address[joint];
        let leader = model.couplings.leader[coupling];
        let x = leader.map_or(0.0, |leader| state.position[address(leader)] - model.reference_position[address(leader)]);
        let [a0, a1, a2, a3, a4] = model.couplings.polynomial[coupling];
        let dependent = address(model.couplings.joint[coupling]);
        let wanted = a0 + x * (a1 + x * (a2 + x * (a3 + x * a4)));
        state.position[dependent] = model.reference_position[dependent] + wanted + random.between(-1e-3, 1e-3);
    }
    state.velocity.fill_with(|| random.between(-1.5, 1.5));
    state.activation.fill_with(|| random.unit());
    state.control.fill_with(|| random.unit());
    let warm = random.unit() < 0.5;
    state.warm_start.fill_with(|| if warm { random.between(-20.0, 20.0) } else { 0.0 });
    state
}

fn folded(values: &[f64], group: usize) -> Vec<f64> {
    if group == 0 {
        return values.to_vec();
    }
    let weighted = |(index, value): (usize, &f64)| value * ((index * 7919 % 101 + 1) as f64 / 101.0);
    let weighted: Vec<f64> = values.iter().enumerate().map(weighted).collect();
    weighted.chunks(group).map(|chunk| chunk.iter().sum()).collect()
}

/// Distance and, more loosely where the convex collider found it, place and frame of a contact.
fn compare_contact(what: &str, actual: &Contact, expected: &Value) {
    let geoms: Vec<usize> = numbers(&expected["geoms"]).iter().map(|geom| *geom as usize).collect();
    assert_eq!(actual.geoms[..], geoms[..], "{what}: geoms");
    let convex = expected["convex"].as_bool().expect("a flag");
    let distance = expected["distance"].as_f64().expect("a distance");
    let position = Vector3::from_column_slice(&numbers(&expected["position"]));
    let frame = nalgebra::Matrix3::from_row_slice(&numbers(&expected["frame"]));
    let errors = [(actual.distance - distance).abs(), (actual.position - position).amax(), (actual.frame - frame).amax()];
    let allowed = if convex { [1e-8, 1e-4, 1e-3] } else { [1e-8; 3] };
    for ((error, allowed), name) in errors.iter().zip(allowed).zip(["distance", "position", "frame"]) {
        assert!(*error <= allowed, "{what}, {geoms:?}: {name} is {error:e} away");
    }
}

/// Compares all states of one golden file.
fn compare(model: &Model, name: &str) {
    let golden = golden(&format!("constraint_{name}"));
    let mut random = SplitMix(golden["seed"].as_u64().expect("a seed"));
    let mut workspace = Workspace::new(model);
    let mut worst = QUANTITIES.map(|(name, ..)| (name, [0.0f64; 2]));
    for (number, expected) in golden["states"].as_array().expect("states").iter().enumerate() {
        let mut state = draw(model, &mut random, number % 2 == 0);
        if let Some(height) = expected["height"].as_f64() {
            // Where the body is on the ground, the other side draws how deep it stands.
            if number / 2 % 2 == 0 {
                random.unit();
            }
            state.position[2] = height;
        }
        forward(model, &state, &mut workspace).unwrap();
        let constraints = &workspace.lanes[0].constraints;
        let what = format!("{name}, state {number}");
        let contacts = expected["contacts"].as_array().expect("contacts");
        assert_eq!(constraints.contacts.len(), contacts.len(), "{what}: contacts");
        for (actual, expected) in constraints.contacts.iter().zip(contacts) {
            compare_contact(&what, actual, expected);
        }
        assert_eq!(constraints.rows.len() as u64, expected["rows"].as_u64().unwrap(), "{what}: rows");
        let convex = expected["convex"].as_bool().expect("a flag");
        for ((quantity, exact, loose, value), (_, worst)) in QUANTITIES.iter().zip(&mut worst) {
            let group = golden["groups"][quantity].as_u64().unwrap_or(0) as usize;
            let (expected, values) = (numbers(&expected[quantity]), value(model, &workspace));
            let largest = values.iter().fold(1.0f64, |largest, value| largest.max(value.abs()));
            let allowed = match if convex { loose } else { exact } {
                Absolute(allowed) => *allowed,
                Relative(allowed) => allowed * largest,
            };
            let actual = folded(&values, group);
            assert_eq!(actual.len(), expected.len(), "{what}: size of {quantity}");
            for (index, (actual, expected)) in actual.iter().zip(&expected).enumerate() {
                let error = (actual - expected).abs();
                assert!(error <= allowed, "{what}: {quantity}[{index}] is {actual:e}, MuJoCo's {expected:e}: {error:e} apart");
                let share = if allowed > 0.0 { error / allowed } else { 0.0 };
                worst[usize::from(convex)] = worst[usize::from(convex)].max(share);
            }
        }
    }
    println!("{name}: worst errors in units of their tolerances (closed form, convex collider): {worst:?}");
}

fn human() -> Model {
    Model::from_file(repository("bodies/models/human416.xml")).expect("the body loads")
}

fn small_model(name: &str) -> Model {
    let path = repository("tests/oracle/contact_models").join(format!("{name}.xml"));
    Model::from_file(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn shapes_touch_in_every_pair_dimension_and_mix() {
    compare(&small_model("shapes"), "shapes");
}

#[test]
fn spheres_and_capsules_touch_exactly() {
    compare(&small_model("heap"), "heap");
}

#[test]
fn parallel_capsules_touch_at_one_or_two_points() {
    compare(&small_model("parallel"), "parallel");
}

#[test]
fn joints_are_limited_and_coupled() {
    compare(&small_model("limits"), "limits");
}

#[test]
fn the_full_body_at_200_states() {
    compare(&human(), "human416");
}

#[test]
fn constants_at_the_reference_configuration() {
    let model = human();
    let constants = &golden("constraint_human416")["constants"];
    let actual = [
        ("body_invweight0", model.bodies.inverse_weight.concat()),
        ("dof_invweight0", model.dofs.inverse_weight),
        ("tendon_length0", model.tendons.reference_length),
        ("actuator_acc0", model.actuators.acceleration_scale),
    ];
    for (name, values) in actual {
        for (index, (value, expected)) in values.iter().zip(numbers(&constants[name])).enumerate() {
            // One muscle has no moment arm but rounding.
            assert!(
                (value - expected).abs() <= 1e-10 * expected.abs() + 1e-14,
                "{name}[{index}] is {value:e}, MuJoCo's {expected:e}"
            );
        }
    }
}

/// Starts where the golden rollout started and returns how far the end is from MuJoCo's.
fn rollout(model: &Model, golden: &Value, flight: bool, steps: usize) -> f64 {
    let mut random = SplitMix(golden["seed"].as_str().and_then(|seed| seed.parse().ok()).expect("a seed"));
    let mut state = draw(model, &mut random, false);
    state.position[2] = golden["height"].as_f64().expect("a height");
    if flight {
        state.velocity.iter_mut().for_each(|velocity| *velocity *= 0.1);
        state.activation.iter_mut().for_each(|activation| *activation *= 0.05);
        state.control.iter_mut().for_each(|excitation| *excitation *= 0.05);
    }
    let mut workspace = Workspace::new(model);
    for _ in 0..steps {
        step(model, &mut state, &mut workspace).unwrap();
    }
    let expected = numbers(&golden["qpos"]);
    state.position.iter().zip(expected).map(|(q, expected)| (q - expected).abs()).fold(0.0, f64::max)
}

/// Masses, strengths and frictions of `vary` in `tests/oracle/constraint.py`.
fn vary(state: &mut State<f64>, random: &mut SplitMix) {
    state.mass_scale.fill_with(|| random.between(0.5, 1.5));
    state.strength.fill_with(|| random.between(0.5, 1.5));
    state.friction.fill_with(|| random.between(0.2, 2.0));
}

/// What a state changes of its body is what MuJoCo gives with a model that was changed so.
#[test]
fn fifty_milliseconds_of_bodies_of_their_own_end_where_mujocos_do() {
    let model = human();
    let mut workspace = Workspace::new(&model);
    for golden in golden("constraint_varied")["rollouts"].as_array().expect("rollouts") {
        let mut random = SplitMix(golden["seed"].as_str().and_then(|seed| seed.parse().ok()).expect("a seed"));
        let mut state = draw(&model, &mut random, false);
        vary(&mut state, &mut random);
        state.position[2] = golden["height"].as_f64().expect("a height");
        for _ in 0..50 {
            step(&model, &mut state, &mut workspace).unwrap();
        }
        let distance = |found: &[f64], golden: &Value| {
            found.iter().zip(numbers(golden)).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max)
        };
        let error = distance(&state.position, &golden["qpos"]);
        assert!(error <= 1e-6, "{error:e} apart after 50 ms");
    }
}

#[test]
fn a_second_of_flight_ends_where_mujocos_does() {
    let model = human();
    for flight in golden("constraint_rollouts")["flight"].as_array().expect("rollouts") {
        let error = rollout(&model, flight, true, 1000);
        assert!(error <= 1e-8, "{error:e} apart after a second");
    }
}

#[test]
fn fifty_milliseconds_on_the_ground_end_where_mujocos_do() {
    let model = human();
    for ground in golden("constraint_rollouts")["ground"].as_array().expect("rollouts") {
        let error = rollout(&model, ground, false, 50);
        assert!(error <= 1e-6, "{error:e} apart after 50 ms");
    }
}
