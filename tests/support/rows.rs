//! What the comparisons of constraint rows share: states, quantities and a rollout, number for number those of
//! `tests/oracle/rows.py`.

use super::{SplitMix, numbers};
use msk_physics::model::{JointKind, Model};
use msk_physics::{State, Workspace, forward, step};
use serde_json::Value;

/// The random state that `draw` of `tests/oracle/rows.py` makes, number for number.
fn draw(model: &Model, random: &mut SplitMix, number: usize) -> State<f64> {
    let mut state = State::new(model);
    for joint in 0..model.joints.kind.len() {
        let address = model.joints.position_address[joint];
        let reach: &[f64] = match model.joints.kind[joint] {
            JointKind::Free => &[0.01, 0.01, 0.01, 0.1, 0.1, 0.1, 0.1],
            JointKind::Ball => &[0.3; 4],
            JointKind::Hinge | JointKind::Slide => &[0.3],
        };
        for (coordinate, width) in state.position[address..].iter_mut().zip(reach) {
            *coordinate += random.between(-width, *width);
        }
    }
    state.velocity.fill_with(|| random.between(-1.5, 1.5));
    state.activation.fill_with(|| random.unit());
    state.control.fill_with(|| random.unit());
    state.applied_force.fill_with(|| random.between(-3.0, 3.0));
    if number % 3 == 2 {
        state.active.fill_with(|| f64::from(u8::from(random.unit() < 0.5)));
    }
    let warm = random.unit() < 0.5;
    state.warm_start.fill_with(|| if warm { random.between(-20.0, 20.0) } else { 0.0 });
    state
}

/// What is compared: name, tolerance relative to the largest entry of the same state or to one unit.
fn quantities(model: &Model, workspace: &Workspace<f64>) -> [(&'static str, f64, Vec<f64>); 11] {
    let constraints = &workspace.lanes[0].constraints;
    let rows = &constraints.rows;
    let weighted = |row: usize| {
        let dense = constraints.jacobian_row(model, row);
        let weight = |index: usize| ((row * model.nv + index) * 7919 % 101 + 1) as f64 / 101.0;
        dense.iter().enumerate().map(|(index, value)| value * weight(index)).sum()
    };
    let inertia = model.dofs.row.iter().map(|row| workspace.inertia.matrix[row.end - 1]);
    [
        ("type", 0.0, (0..rows.len()).map(|row| f64::from(constraints.row_type(row))).collect()),
        ("position", 1e-9, rows.position.clone()),
        ("margin", 1e-12, rows.margin.clone()),
        ("jacobian", 1e-9, (0..rows.len()).map(weighted).collect()),
        ("velocity", 1e-9, rows.velocity.clone()),
        ("reference", 1e-9, rows.reference.clone()),
        ("logweight", 1e-9, rows.weight.iter().map(|weight| weight.ln()).collect()),
        ("force", 1e-6, rows.force.clone()),
        ("qacc", 1e-6, workspace.acceleration.iter().zip(inertia).map(|(a, inertia)| a * inertia.sqrt()).collect()),
        ("passive", 1e-10, workspace.forces.passive.clone()),
        ("ten_length", 1e-12, workspace.tendons.length.clone()),
    ]
}

/// Compares a model with its golden numbers at all states, then after a rollout, and prints the worst errors. `more` are
/// further quantities of a state: name, tolerance, values. `slack` loosens all, where MuJoCo iterates.
pub fn compare(
    name: &str,
    model: &Model,
    golden: &Value,
    rollout_tolerance: f64,
    slack: f64,
    more: impl Fn(&Workspace<f64>) -> Vec<(&'static str, f64, Vec<f64>)>,
) {
    let constants = [("tendon_invweight0", &model.tendons.inverse_weight), ("tendon_length0", &model.tendons.reference_length)];
    for (constant, values) in constants {
        let expected = numbers(&golden["constants"][constant]);
        check(&format!("{name}: {constant}"), values, &expected, 1e-10);
    }
    let mut random = SplitMix(golden["seed"].as_u64().expect("a seed"));
    let mut workspace = Workspace::new(model);
    let mut worst: Vec<(&str, f64)> = Vec::new();
    for (number, expected) in golden["states"].as_array().expect("states").iter().enumerate() {
        let state = draw(model, &mut random, number);
        forward(model, &state, &mut workspace).unwrap();
        let mut compared = more(&workspace);
        compared.extend(quantities(model, &workspace));
        for (index, (quantity, tolerance, values)) in compared.into_iter().enumerate() {
            let expected = numbers(&expected[quantity]);
            let error = check(&format!("{name}, state {number}: {quantity}"), &values, &expected, tolerance * slack);
            match worst.get_mut(index) {
                Some((_, worst)) => *worst = worst.max(error),
                None => worst.push((quantity, error)),
            }
        }
    }
    let end = rollout(model, &mut random);
    let expected = &golden["end"];
    let places = check(&format!("{name}, rollout: qpos"), &end.position, &numbers(&expected["qpos"]), rollout_tolerance);
    let speeds = check(&format!("{name}, rollout: qvel"), &end.velocity, &numbers(&expected["qvel"]), rollout_tolerance);
    println!("{name}: worst errors {worst:?}; after the rollout {places:e} and {speeds:e}");
}

/// A tenth of a second from the next random state; half way all equalities change over.
fn rollout(model: &Model, random: &mut SplitMix) -> State<f64> {
    const STEPS: usize = 50;
    let (mut state, mut workspace) = (draw(model, random, 0), Workspace::new(model));
    for number in 0..STEPS {
        if number == STEPS / 2 {
            state.active.iter_mut().for_each(|active| *active = 1.0 - *active);
        }
        step(model, &mut state, &mut workspace).unwrap();
    }
    state
}

/// Compares two lists and returns the largest error relative to the largest entry.
fn check(what: &str, values: &[f64], expected: &[f64], tolerance: f64) -> f64 {
    assert_eq!(values.len(), expected.len(), "{what}: {values:?} against {expected:?}");
    let largest = expected.iter().fold(1.0f64, |largest, value| largest.max(value.abs()));
    let mut worst = 0.0f64;
    for (index, (value, expected)) in values.iter().zip(expected).enumerate() {
        let error = (value - expected).abs() / largest;
        assert!(error <= tolerance, "{what}[{index}] is {value:e}, MuJoCo's {expected:e}: {error:e} of the largest apart");
        worst = worst.max(error);
    }
    worst
}
