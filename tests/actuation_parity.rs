//! Actuators, passive elements and integrators give MuJoCo 4.0.0's numbers: `tests/oracle/actuation.py` made the golden ones.

use crate::support;

use msk_physics::model::{Bias, Dynamics, Integrator, Model};
use msk_physics::{self as physics, State, Workspace, sensors::readings};
use serde_json::Value;
use support::{SplitMix, draw, golden, numbers, repository};

/// Quantities of one forward pass, and how far each may be from MuJoCo's as a share of its largest entry.
type Quantity = (&'static str, f64, fn(&Workspace<f64>) -> &[f64]);
const QUANTITIES: [Quantity; 7] = [
    ("actuator_length", 1e-12, |w| &w.actuation.length),
    ("actuator_velocity", 1e-12, |w| &w.actuation.velocity),
    ("actuator_force", 1e-10, |w| &w.actuation.force),
    ("act_dot", 1e-10, |w| &w.actuation.activation_rate),
    ("qfrc_actuator", 1e-10, |w| &w.forces.actuator),
    ("qfrc_passive", 1e-10, |w| &w.forces.passive),
    ("qacc", 1e-9, |w| &w.acceleration),
];

/// What the compiler derives.
type Constant = (&'static str, fn(&Model) -> Vec<f64>);
const COMPILED: [Constant; 5] = [
    ("actuator_acc0", |m| m.actuators.acceleration_scale.clone()),
    ("dof_damping", |m| m.dofs.damping.clone()),
    ("dof_armature", |m| m.dofs.armature.clone()),
    ("jnt_stiffness", |m| m.joints.stiffness.clone()),
    ("actuator_biasprm", |m| m.actuators.bias.iter().flat_map(first_figures).collect()),
];

fn first_figures(bias: &Bias) -> [f64; 3] {
    match bias {
        Bias::None => [0.0; 3],
        Bias::Affine(figures) => *figures,
        Bias::Muscle([a, b, c, ..]) => [*a, *b, *c],
    }
}

fn model(name: &str) -> Model {
    let path = repository("tests/oracle/models/actuation").join(format!("{name}.xml"));
    Model::from_file(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Set points and activations of whatever is no muscle, over [-4, 4].
fn spread(model: &Model, state: &mut State<f64>) {
    for (actuator, control) in state.control.iter_mut().enumerate() {
        *control = 8.0 * *control - 4.0;
        if let Some(slot) = model.actuators.activation[actuator]
            && !matches!(model.actuators.dynamics[actuator], Dynamics::Muscle(_))
        {
            state.activation[slot] = 8.0 * state.activation[slot] - 4.0;
        }
    }
}

/// Fails where `found` is farther from `expected` than a share of the largest entry.
fn assert_close(what: &str, found: &[f64], expected: &[f64], allowed: f64) {
    assert_eq!(found.len(), expected.len(), "{what}: size");
    let largest = expected.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs();
        assert!(error <= allowed * largest, "{what}[{index}] is {found:e}, MuJoCo's {expected:e}: {error:e} apart");
    }
}

fn compare_states(name: &str, model: &Model, golden: &Value, random: &mut SplitMix) {
    let mut workspace = Workspace::new(model);
    for (number, expected) in golden["states"].as_array().expect("states").iter().enumerate() {
        let mut state = draw(model, random);
        spread(model, &mut state);
        physics::forward(model, &state, &mut workspace).expect("a sound state");
        for (quantity, allowed, found) in QUANTITIES {
            let what = format!("{name}, state {number}: {quantity}");
            assert_close(&what, found(&workspace), &numbers(&expected[quantity]), allowed);
        }
    }
}

/// One step and one second of each integrator.
fn compare_rollouts(name: &str, model: &mut Model, golden: &Value, random: &mut SplitMix) {
    let integrators = [
        ("euler", Integrator::Euler, true),
        ("explicit", Integrator::Euler, false),
        ("implicitfast", Integrator::Implicit, true),
        ("RK4", Integrator::RungeKutta, true),
    ];
    let count = golden["rollouts"]["euler"].as_array().expect("rollouts").len();
    for number in 0..count {
        let mut start = draw(model, random);
        spread(model, &mut start);
        start.velocity.iter_mut().for_each(|velocity| *velocity *= 0.5);
        start.applied_force.fill(0.0);
        start.body_force = State::<f64>::new(model).body_force;
        for (word, integrator, damping) in integrators {
            model.options.integrator = integrator;
            model.options.euler_damping = damping;
            let expected = &golden["rollouts"][word][number];
            let (mut state, mut workspace) = (start.clone(), Workspace::new(model));
            for step in 1..=500 {
                physics::step(model, &mut state, &mut workspace).expect("a sound step");
                let expected = match step {
                    1 => &expected["first"],
                    500 => &expected["last"],
                    _ => continue,
                };
                let found = [state.position.as_slice(), &state.velocity, &state.activation].concat();
                let what = format!("{name}, rollout {number}, {word}, step {step}");
                assert_close(&what, &found, &numbers(expected), if step == 1 { 1e-11 } else { 1e-8 });
            }
        }
    }
}

fn compare(name: &str) {
    let mut model = model(name);
    let golden = golden(&format!("actuation_{name}"));
    for (quantity, found) in COMPILED {
        assert_close(&format!("{name}: {quantity}"), &found(&model), &numbers(&golden["compiled"][quantity]), 1e-12);
    }
    compare_keyframes(name, &model, &golden);
    let mut random = SplitMix(golden["seed"].as_u64().expect("a seed"));
    compare_states(name, &model, &golden, &mut random);
    compare_rollouts(name, &mut model, &golden, &mut random);
}

fn compare_keyframes(name: &str, model: &Model, golden: &Value) {
    let expected = golden["keyframes"].as_array().expect("key frames");
    assert_eq!(model.keyframes.len(), expected.len());
    let mut workspace = Workspace::new(model);
    for (frame, expected) in model.keyframes.iter().zip(expected) {
        let mut state = frame.state(model);
        assert_eq!((Some(frame.name.as_str()), Some(state.time)), (expected["name"].as_str(), expected["time"].as_f64()));
        physics::forward(model, &state, &mut workspace).expect("a sound key frame");
        let found = [
            ("qpos", state.position.clone()),
            ("qvel", state.velocity.clone()),
            ("act", state.activation.clone()),
            ("ctrl", state.control.clone()),
            ("mocap_pos", state.mocap_position.iter().flatten().copied().collect()),
            ("mocap_quat", state.mocap_orientation.concat()),
            ("xpos", workspace.kinematics.body_position.iter().flatten().copied().collect()),
            ("qacc", workspace.acceleration.clone()),
        ];
        for (quantity, found) in found {
            let what = format!("{name}, key frame {}: {quantity}", frame.name);
            assert_close(&what, &found, &numbers(&expected[quantity]), 1e-10);
        }
        for _ in 0..125 {
            physics::step(model, &mut state, &mut workspace).expect("a sound step");
        }
        let found = [state.position.as_slice(), &state.velocity, &state.activation].concat();
        assert_close(&format!("{name}, after key frame {}", frame.name), &found, &numbers(&expected["later"]), 1e-8);
    }
}

macro_rules! parity {
    ($($name:ident),*) => {$(
        #[test]
        fn $name() {
            compare(stringify!($name));
        }
    )*};
}

parity!(adhesion, ball_free, gravity, keyframes, motors, sites, spin, tendons, underwater);

#[test]
fn sensors_read_what_mujocos_read() {
    let model = Model::from_file(repository("tests/oracle/models/sensors/sensors.xml")).expect("the model loads");
    let again = Model::from_mjcf(&model.to_mjcf()).expect("what is written is read");
    assert!(again == model, "it changes:\n{}", model.to_mjcf());
    let golden = golden("actuation_sensors");
    let mut random = SplitMix(golden["seed"].as_u64().expect("a seed"));
    let mut workspace = Workspace::new(&model);
    for (number, expected) in golden["states"].as_array().expect("states").iter().enumerate() {
        let mut state = draw(&model, &mut random);
        state.position[..3].copy_from_slice(&[0.0, 0.0, 0.05 + 0.2 * random.unit()]);
        state.time = number as f64;
        physics::forward(&model, &state, &mut workspace).expect("a sound state");
        let contacts = workspace.lanes[0].constraints.contacts.len() as u64;
        assert_eq!(Some(contacts), expected["contacts"].as_u64(), "state {number}: contacts");
        let (found, expected) = (readings(&model, &state, &workspace), numbers(&expected["sensordata"]));
        assert_eq!(found.len(), expected.len());
        let mut start = 0;
        for measure in &model.sensors.measure {
            let range = start..start + measure.size();
            start = range.end;
            let scale = expected[range.clone()].iter().fold(1.0f64, |largest, value| largest.max(value.abs()));
            for (found, expected) in found[range.clone()].iter().zip(&expected[range]) {
                let error = (found - expected).abs();
                assert!(error <= 1e-6 * scale, "state {number}: {measure:?} reads {found}, MuJoCo's {expected}");
            }
        }
    }
}

#[test]
fn every_model_survives_writing_and_reading() {
    for name in ["adhesion", "ball_free", "gravity", "keyframes", "motors", "sites", "spin", "tendons", "underwater"] {
        let mut model = model(name);
        for (integrator, damping) in [(Integrator::Euler, false), (Integrator::Implicit, true), (Integrator::RungeKutta, true)] {
            model.options.integrator = integrator;
            model.options.euler_damping = damping;
            let text = model.to_mjcf();
            let again = Model::from_mjcf(&text).unwrap_or_else(|error| panic!("{name}: {error}\n{text}"));
            assert!(again == model, "{name} changes:\n{text}");
        }
    }
}
