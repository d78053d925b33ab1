//! What must hold for the constrained half of a step independently of MuJoCo.

use crate::support;

use msk_physics::model::Model;
use msk_physics::{Fault, Input, State, Workspace, forward, inertia, step};
use proptest::prelude::*;
use std::sync::OnceLock;
use support::{SplitMix, draw, repository};

fn human() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| Model::from_file(repository("bodies/models/human416.xml")).expect("the body loads"))
}

/// A tendon with both ends on one body cannot be moved: neither limit nor friction makes a row of it, as in MuJoCo.
#[test]
fn a_tendon_that_nothing_moves_is_not_constrained() {
    let model = |far: &str| {
        Model::from_mjcf(&format!(
            r#"<mujoco><compiler autolimits="true"/><worldbody>
                <body name="a"><joint name="j" axis="0 1 0"/><geom size="0.1"/><site name="near"/><site name="far" pos="0.3 0 0"/>
                    <body name="b" pos="0.2 0 0.5"><joint axis="0 1 0"/><geom name="around" size="0.05"/><site name="other" pos="0.1 0 0"/></body>
                </body></worldbody>
                <tendon><spatial range="0.5 1" frictionloss="1"><site site="near"/><geom geom="around"/><site site="{far}"/></spatial>
                </tendon></mujoco>"#
        ))
        .unwrap()
    };
    for (far, rows) in [("far", 0), ("other", 1)] {
        let model = model(far);
        let mut workspace = Workspace::new(&model);
        let mut state = State::new(&model);
        state.position[0] = 0.4;
        forward(&model, &state, &mut workspace).unwrap();
        assert_eq!(workspace.lanes[0].constraints.rows.len(), rows, "{far}");
    }
}

/// A random state with the pelvis near the ground, so that some of the body is in it.
fn on_the_ground(seed: u64) -> State<f64> {
    let mut random = SplitMix(seed);
    let mut state = draw(human(), &mut random);
    state.position[2] = random.between(0.1, 0.9);
    state
}

fn bits(state: &State<f64>) -> Vec<u64> {
    let numbers = state.position.iter().chain(&state.velocity).chain(&state.activation).chain(&state.warm_start);
    numbers.map(|number| number.to_bits()).collect()
}

fn run(state: &mut State<f64>, workspace: &mut Workspace<f64>, steps: usize) {
    for _ in 0..steps {
        step(human(), state, workspace).unwrap();
    }
}

/// A body standing up to its knees in nothing: muscles at random, from the reference configuration onto the ground.
fn falling(seed: u64) -> State<f64> {
    let mut state = State::new(human());
    let mut random = SplitMix(seed);
    state.control.fill_with(|| random.unit());
    state
}

#[test]
fn the_same_start_gives_the_same_bits() {
    let [mut first, mut second] = [falling(3), falling(3)];
    run(&mut first, &mut Workspace::new(human()), 300);
    // A workspace that has seen other states, contacts and patterns must not show.
    let mut used = Workspace::new(human());
    for seed in 0..5 {
        forward(human(), &on_the_ground(seed), &mut used).unwrap();
    }
    run(&mut second, &mut used, 300);
    assert_eq!(bits(&first), bits(&second));
}

#[test]
fn a_snapshot_continues_with_the_same_bits() {
    let mut workspace = Workspace::new(human());
    let mut state = falling(4);
    run(&mut state, &mut workspace, 150);
    let snapshot = state.clone();
    run(&mut state, &mut workspace, 150);
    let mut restored = snapshot;
    run(&mut restored, &mut Workspace::new(human()), 150);
    assert_eq!(bits(&state), bits(&restored));
}

#[test]
fn the_whole_body_falls_and_comes_to_lie() {
    let mut state = State::new(human());
    let mut workspace = Workspace::new(human());
    run(&mut state, &mut workspace, 3000);
    let mass = human().bodies.subtree_mass[0];
    let lift: f64 =
        workspace.lanes[0].constraints.contacts.iter().filter(|contact| contact.geoms[0] == 0).map(|c| c.force[0]).sum();
    assert!(state.position[2] > 0.0 && state.position[2] < 0.5, "the pelvis is {} m high", state.position[2]);
    assert!((lift / (mass * 9.81) - 1.0).abs() < 0.2, "the ground carries {lift} N of {} N", mass * 9.81);
}

#[test]
fn what_is_not_finite_is_named_and_the_state_kept() {
    let model = human();
    let mut workspace = Workspace::new(model);
    let mut state = State::new(model);
    state.control[7] = f64::NAN;
    let before = bits(&state);
    let fault = step(model, &mut state, &mut workspace).unwrap_err();
    assert!(
        matches!(&fault, Fault::Input { input: Input::Excitation, muscle, .. } if *muscle == model.actuators.name[7]),
        "{fault}"
    );
    assert_eq!(bits(&state), before);

    state.control[7] = 0.0;
    state.velocity[20] = f64::INFINITY;
    let joint = model.joints.name[model.dofs.joint[20]].clone();
    let fault = step(model, &mut state, &mut workspace).unwrap_err();
    assert!(matches!(&fault, Fault::Diverged { joint: named, .. } if *named == joint), "{fault}");

    state.velocity[20] = 0.0;
    state.applied_force[20] = 1e300;
    let fault = step(model, &mut state, &mut workspace).unwrap_err();
    assert!(fault.to_string().starts_with("at 0 s the acceleration"), "{fault}");
    state.applied_force[20] = 0.0;
    // The workspace is none the worse for it.
    step(model, &mut state, &mut workspace).unwrap();
    assert!(state.velocity.iter().all(|velocity| velocity.is_finite()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Newton's law and each row's own law hold together: M a = force + J'f, f = clip(-(J a - a_ref) / R).
    #[test]
    fn the_solution_satisfies_its_equations(seed in any::<u64>()) {
        let model = human();
        let state = on_the_ground(seed);
        let mut workspace = Workspace::new(model);
        forward(model, &state, &mut workspace).unwrap();
        let constraints = &workspace.lanes[0].constraints;
        let rows = &constraints.rows;
        let mut left = vec![0.0; model.nv];
        inertia::multiply(model, &workspace.inertia.matrix, &workspace.acceleration, &mut left);
        let mut right = workspace.forces.smooth.clone();
        let mut scale: f64 = right.iter().fold(1.0, |largest: f64, force| largest.max(force.abs()));
        for row in 0..rows.len() {
            let jacobian = constraints.jacobian_row(model, row);
            let acceleration: f64 = jacobian.iter().zip(&workspace.acceleration).map(|(j, a)| j * a).sum();
            let force = (-(acceleration - rows.reference[row]) * rows.weight[row]).clamp(rows.lower[row], rows.upper[row]);
            prop_assert!((force - rows.force[row]).abs() <= 1e-7 * (1.0 + force.abs() + rows.weight[row] * acceleration.abs()));
            right.iter_mut().zip(&jacobian).for_each(|(sum, j)| *sum += j * rows.force[row]);
            scale = scale.max(rows.force[row].abs());
        }
        for (dof, (left, right)) in left.iter().zip(&right).enumerate() {
            prop_assert!((left - right).abs() <= 1e-9 * scale, "dof {dof}: {left} against {right}");
        }
    }
}
