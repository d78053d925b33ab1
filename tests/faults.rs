//! What goes wrong in a step is an event with a name: the state stays as it was, and other episodes are unaffected.

use crate::support;

use msk_physics::model::{Integrator, Model};
use msk_physics::{Fault, State, Workspace, step};
use proptest::prelude::*;
use support::{SplitMix, draw, repository};

/// Shapes that rest on the ground, a joint between limits that no position satisfies, and couplings that contradict it.
const CONTRADICTION: &str = r#"<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 0.2"><freejoint name="ball"/><geom size="0.1"/></body>
    <body name="capsule" pos="0 1 0.1"><freejoint name="capsule"/><geom type="capsule" size="0.1 0.2"/></body>
    <body name="arm" pos="0 0 2">
      <joint name="arm" axis="0 1 0" range="10 20"/>
      <geom type="capsule" size="0.05 0.2"/>
      <body name="hand" pos="0 0 -0.4"><joint name="hand" axis="0 1 0" range="-20 -10"/><geom size="0.05"/></body>
    </body>
  </worldbody>
  <equality>
    <joint joint1="arm" polycoef="1 0 0 0 0"/>
    <joint joint1="arm" polycoef="-1 0 0 0 0"/>
    <joint joint1="arm" joint2="hand" polycoef="0 1000 0 0 0"/>
  </equality>
</mujoco>"#;

const INTEGRATORS: [Integrator; 3] = [Integrator::Euler, Integrator::Implicit, Integrator::RungeKutta];

fn models() -> Vec<Model> {
    let read = |name: &str| Model::from_file(repository("tests/oracle/models/actuation").join(name)).unwrap();
    let files = ["tendons.xml", "ball_free.xml", "keyframes.xml", "motors.xml"];
    files.into_iter().map(read).chain([Model::from_mjcf(CONTRADICTION).unwrap()]).collect()
}

/// Every number of a state.
fn numbers(state: &mut State<f64>) -> Vec<&mut f64> {
    let mut all: Vec<&mut f64> = Vec::new();
    all.extend(&mut state.position);
    all.extend(&mut state.velocity);
    all.extend(&mut state.activation);
    all.extend(&mut state.control);
    all.extend(&mut state.applied_force);
    all.extend(state.body_force.iter_mut().flatten().flatten());
    all.extend(state.mocap_position.iter_mut().flatten());
    all.extend(state.mocap_orientation.iter_mut().flatten());
    all.extend(&mut state.warm_start);
    all
}

fn bits(state: &State<f64>) -> Vec<u64> {
    let mut copy = state.clone();
    let mut bits = vec![state.time.to_bits()];
    bits.extend(numbers(&mut copy).into_iter().map(|value| value.to_bits()));
    bits
}

/// Positions, velocities and activations are finite and of a size that means something.
fn assert_sound(state: &State<f64>) {
    let dynamic = [state.position.as_slice(), &state.velocity, &state.activation].concat();
    assert!(dynamic.iter().all(|value| value.abs() <= 1e10), "{dynamic:?}");
}

/// Steps until a fault; fails if a fault changes the state or a step ends in an unsound one.
fn run(model: &Model, state: &mut State<f64>, workspace: &mut Workspace<f64>, steps: usize) -> Option<Fault> {
    for _ in 0..steps {
        let before = bits(state);
        if let Err(fault) = step(model, state, workspace) {
            assert_eq!(bits(state), before, "the state changes though the step fails: {fault}");
            return Some(fault);
        }
        assert_sound(state);
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Any number of any state may be anything: the step succeeds soundly, or it fails and leaves the state; and the memory that
    /// it worked in gives another episode the bits that new memory gives.
    #[test]
    fn any_number_may_be_anything(
        model in 0..5_usize,
        integrator in 0..3_usize,
        seed in any::<u64>(),
        place in any::<prop::sample::Index>(),
        value in prop::sample::select(vec![
            f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -1e300, 1e155, -1e11, 1e10, -9.9e9, 1e7, -1e4, 1e-320, 0.0,
        ]),
    ) {
        let mut model = models().swap_remove(model);
        model.options.integrator = INTEGRATORS[integrator];
        let mut workspace = Workspace::new(&model);
        let sound = draw(&model, &mut SplitMix(seed));
        let mut state = sound.clone();
        let mut slots = numbers(&mut state);
        let index = place.index(slots.len());
        *slots[index] = value;
        run(&model, &mut state, &mut workspace, 5);

        let (mut used, mut fresh) = (sound.clone(), sound);
        let faults = [run(&model, &mut used, &mut workspace, 3), run(&model, &mut fresh, &mut Workspace::new(&model), 3)];
        prop_assert_eq!(bits(&used), bits(&fresh));
        prop_assert_eq!(&faults[0], &faults[1]);
    }

    /// Figures that no body has: what explodes does so by name, before the state is spoilt.
    #[test]
    fn any_figure_of_a_model_may_be_absurd(
        model in 0..5_usize,
        integrator in 0..3_usize,
        seed in any::<u64>(),
        figure in 0..7_usize,
        value in prop::sample::select(vec![0.0, 1e-300, 1e-12, 1e6, 1e12, 1e30, -1e6]),
    ) {
        let mut model = models().swap_remove(model);
        model.options.integrator = INTEGRATORS[integrator];
        match figure {
            0 => model.joints.stiffness.fill(value),
            1 => model.dofs.damping.fill(value),
            2 => model.tendons.stiffness.fill(value),
            3 => model.bodies.mass.fill(value),
            4 => model.bodies.inertia.iter_mut().for_each(|inertia| inertia.fill(value)),
            5 => model.options.timestep = value.abs().max(1e-9),
            _ => model.options.gravity.fill(value),
        }
        let mut state = draw(&model, &mut SplitMix(seed));
        run(&model, &mut state, &mut Workspace::new(&model), 40);
    }
}

/// Once a step as long as eleven days ended with activations of 1e15.
#[test]
fn an_activation_that_leaves_all_measure_is_named() {
    let mut model = models().swap_remove(0);
    model.options.timestep = 1e6;
    for integrator in INTEGRATORS {
        model.options.integrator = integrator;
        for seed in 0..20 {
            let mut state = draw(&model, &mut SplitMix(seed));
            run(&model, &mut state, &mut Workspace::new(&model), 40).expect("a fault");
        }
    }
}

#[test]
fn a_massless_body_is_named_with_its_joint_and_the_time() {
    let mut model = models().remove(3);
    let body = model.bodies.name.iter().position(|name| name == "lower").unwrap();
    model.bodies.mass[body] = 0.0;
    model.bodies.inertia[body].fill(0.0);
    model.dofs.armature.fill(0.0);
    for integrator in INTEGRATORS {
        model.options.integrator = integrator;
        let mut state = State::new(&model);
        state.time = 0.25;
        let fault = run(&model, &mut state, &mut Workspace::new(&model), 1).expect("a fault").to_string();
        assert!(fault.starts_with("at 0.25 s the ") && fault.contains("(body `lower`)"), "{fault}");
    }
}

#[test]
fn a_spring_too_stiff_for_the_step_ends_in_a_fault_at_its_joint() {
    let mut model = models().remove(3);
    let joint = model.joints.name.iter().position(|name| name == "push").unwrap();
    model.joints.stiffness[joint] = 1e7;
    for integrator in INTEGRATORS {
        model.options.integrator = integrator;
        let mut state = State::new(&model);
        state.position[model.joints.position_address[joint]] = 0.01;
        let fault = run(&model, &mut state, &mut Workspace::new(&model), 1000).expect("a fault");
        assert!(matches!(&fault, Fault::Diverged { time, .. } if *time > 0.0), "{fault}");
        assert!(state.time > 0.0 && state.time < 2.0);
    }
}

#[test]
fn what_is_placed_from_outside_must_be_somewhere() {
    let model = models().remove(2);
    let mut state = State::new(&model);
    state.mocap_position[0].y = f64::NAN;
    let fault = run(&model, &mut state, &mut Workspace::new(&model), 1).expect("a fault");
    assert_eq!(fault.to_string(), "at 0 s the pose given to body `hand` is not finite");
}

#[test]
fn constraints_that_contradict_each_other_compromise() {
    for integrator in INTEGRATORS {
        let mut model = Model::from_mjcf(CONTRADICTION).unwrap();
        model.options.integrator = integrator;
        let mut state = State::new(&model);
        assert_eq!(run(&model, &mut state, &mut Workspace::new(&model), 500), None);
    }
}

#[test]
fn one_episodes_fault_is_not_anothers() {
    let model = models().remove(0);
    let mut workspace = Workspace::new(&model);
    let (mut good, mut bad) = (State::new(&model), State::new(&model));
    let (mut alone, mut own) = (State::new(&model), Workspace::new(&model));
    for round in 0..50 {
        bad.control[0] = if round % 7 == 3 { f64::NAN } else { 0.5 };
        bad.applied_force[1] = if round % 11 == 5 { 1e200 } else { 0.0 };
        let fault = run(&model, &mut bad, &mut workspace, 1);
        assert_eq!(fault.is_some(), round % 7 == 3 || round % 11 == 5);
        assert_eq!(run(&model, &mut good, &mut workspace, 1), None);
        assert_eq!(run(&model, &mut alone, &mut own, 1), None);
        assert_eq!(bits(&good), bits(&alone));
    }
}
