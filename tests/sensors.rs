//! What a task can measure equals what MuJoCo 4.0.0 measures: `tests/oracle/sensors.py` made the golden numbers.

use crate::support;

use msk_compiler::body::{Axis, BodyDescription, LandmarkDescription};
use msk_compiler::frame::{FrameLayout, Sensor};
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace};
use msk_runtime::body::Body;
use msk_runtime::body::sensors::{Control, Memory, Snapshot, fill};
use serde_json::Value;
use support::{golden, numbers, repository};

/// The landmarks of the golden file on the full body.
fn description(case: &Value) -> BodyDescription {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let landmark = |value: &Value| LandmarkDescription {
        name: text(&value["name"]),
        description: String::new(),
        body: text(&value["body"]),
        point: numbers(&value["point"]).try_into().unwrap(),
        forward: Axis::PlusX,
        up: Axis::PlusY,
        segment: value["segment"].as_array().unwrap().iter().map(text).collect(),
    };
    BodyDescription {
        name: "human".into(),
        root: "Full Body".into(),
        root_forward: Axis::MinusY,
        root_up: Axis::PlusZ,
        landmarks: case["landmarks"].as_array().unwrap().iter().map(landmark).collect(),
        poses: vec![("neutral".into(), vec![])],
        ..BodyDescription::default()
    }
}

/// One state of the golden file, measured.
struct Case {
    expected: Value,
    model: Model,
    body: Body,
    state: State<f64>,
    workspace: Workspace<f64>,
}

fn cases() -> Vec<Case> {
    let golden = golden("sensors");
    let model = Model::from_file(repository("bodies/models/human416.xml")).unwrap();
    let cases = golden["cases"].as_array().unwrap().clone();
    let case = |expected: Value| {
        let body = Body::bind(&description(&expected), &model).unwrap();
        let mut state = State::new(&model);
        state.position = numbers(&expected["position"]);
        state.velocity = numbers(&expected["velocity"]);
        state.activation = numbers(&expected["activation"]);
        state.control = numbers(&expected["control"]);
        let mut workspace = Workspace::new(&model);
        physics::forward(&model, &state, &mut workspace).unwrap();
        Case { expected, model: model.clone(), body, state, workspace }
    };
    cases.into_iter().map(case).collect()
}

impl Case {
    fn measure(&self, sensor: Sensor) -> Vec<f64> {
        self.measure_after(sensor, 0.0, &mut Memory::default())
    }

    fn measure_after(&self, sensor: Sensor, elapsed: f64, memory: &mut Memory) -> Vec<f64> {
        let mut layout = FrameLayout::default();
        layout.slot(sensor);
        let mut frame = vec![f64::NAN; layout.size()];
        let action = vec![0.25; self.body.muscles.len()];
        let (body, model, state, workspace) = (&self.body, &self.model, &self.state, &self.workspace);
        let snapshot = Snapshot { body, model, state, workspace };
        fill(&layout, &snapshot, &Control { action: &action, entries: &[], time: 1.5, elapsed }, memory, &mut frame);
        frame
    }
}

/// Asserts that every entry is within `tolerance` of MuJoCo's.
fn assert_near(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance, "{what}[{index}]: {a} is not {b}, they differ by {:e}", (a - b).abs());
    }
}

#[test]
fn landmarks_are_where_they_are_and_move_as_they_move() {
    for case in cases() {
        for (index, expected) in case.expected["landmarks"].as_array().unwrap().iter().enumerate() {
            let quantities = [
                ("position", Sensor::LandmarkPosition(index)),
                ("velocity", Sensor::LandmarkVelocity(index)),
                ("axes", Sensor::LandmarkAxes(index)),
                ("angular_velocity", Sensor::LandmarkAngularVelocity(index)),
            ];
            for (name, sensor) in quantities {
                let what = format!("{} {name}", expected["name"]);
                assert_near(&what, &case.measure(sensor), &numbers(&expected[name]), 1e-12);
            }
        }
    }
}

#[test]
fn clearance_is_the_height_of_the_segments_lowest_point() {
    for case in cases() {
        for (index, expected) in case.expected["landmarks"].as_array().unwrap().iter().enumerate() {
            let clearance = expected["clearance"].as_f64().unwrap();
            assert_near("clearance", &case.measure(Sensor::LandmarkClearance(index)), &[clearance], 1e-12);
        }
    }
}

#[test]
fn the_ground_pushes_the_segments_that_touch_it() {
    let mut touching = 0;
    for case in cases() {
        for (index, expected) in case.expected["landmarks"].as_array().unwrap().iter().enumerate() {
            let touches = expected["ground_contact"].as_f64().unwrap();
            assert_eq!(case.measure(Sensor::GroundContact(index)), [touches], "{}", expected["name"]);
            // Relative to the largest force, about 800 N.
            let force = case.measure(Sensor::GroundForce(index));
            assert_near("ground force", &force, &numbers(&expected["ground_force"]), 1e-6);
            touching += usize::from(touches > 0.0);
        }
    }
    assert!(touching >= 2, "the golden states have feet on the ground");
}

#[test]
fn the_reaction_of_a_joint_is_what_its_segments_do_to_each_other() {
    for case in cases() {
        let expected = case.expected["joint_reaction"].as_array().unwrap();
        let found = |name: &str| expected.iter().find(|known| known["joint"] == name).unwrap();
        let largest = expected.iter().flat_map(|known| numbers(&known["force"])).map(f64::abs).fold(0.0, f64::max);
        assert!(largest > 500.0, "{largest}");
        for (index, joint) in case.body.joints.iter().enumerate() {
            let expected = found(&joint.name);
            // Relative to the largest force; accelerations are those of an iterative solver.
            let force = case.measure(Sensor::JointReactionForce(index));
            assert_near(&format!("{} force", joint.name), &force, &numbers(&expected["force"]), 1e-7 * largest);
            let torque = case.measure(Sensor::JointReactionTorque(index));
            assert_near(&format!("{} torque", joint.name), &torque, &numbers(&expected["torque"]), 1e-7 * largest);
        }
    }
}

#[test]
fn the_whole_body_is_its_own_subtree() {
    let quantities = [
        ("com_position", Sensor::ComPosition, 1e-12),
        ("com_velocity", Sensor::ComVelocity, 1e-12),
        ("angular_momentum", Sensor::AngularMomentum, 1e-10),
        ("root_position", Sensor::RootPosition, 1e-12),
        ("root_axes", Sensor::RootAxes, 1e-12),
        ("root_velocity", Sensor::RootVelocity, 1e-12),
        ("root_angular_velocity", Sensor::RootAngularVelocity, 1e-12),
    ];
    for case in cases() {
        for (name, sensor, tolerance) in quantities {
            assert_near(name, &case.measure(sensor), &numbers(&case.expected[name]), tolerance);
        }
    }
}

#[test]
fn joints_and_muscles_are_measured_by_their_own_index() {
    for case in cases() {
        let list = |name: &str| numbers(&case.expected[name]);
        let (torque, acceleration) = (list("joint_torque"), list("joint_acceleration"));
        let largest = acceleration.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        for (index, joint) in case.body.joints.iter().enumerate() {
            let expected = [list("position")[joint.position], list("velocity")[joint.dof]];
            let found = [case.measure(Sensor::JointPosition(index)), case.measure(Sensor::JointVelocity(index))].concat();
            assert_eq!(found, expected, "{}", joint.name);
            assert_near(&joint.name, &case.measure(Sensor::JointTorque(index)), &[torque[joint.dof]], 1e-9);
            let measured = case.measure(Sensor::JointAcceleration(index));
            assert_near(&joint.name, &measured, &[acceleration[joint.dof]], 1e-6 * largest);
        }
        let (length, velocity, force) = (list("muscle_length"), list("muscle_velocity"), list("muscle_force"));
        for (index, muscle) in case.body.muscles.iter().enumerate() {
            assert_near(&muscle.name, &case.measure(Sensor::MuscleLength(index)), &[length[index]], 1e-9);
            assert_near(&muscle.name, &case.measure(Sensor::MuscleVelocity(index)), &[velocity[index]], 1e-8);
            assert_near(&muscle.name, &case.measure(Sensor::MuscleForce(index)), &[force[index]], 1e-6);
            assert_eq!(case.measure(Sensor::MuscleActivation(index)), [case.state.activation[index]]);
            assert_eq!(case.measure(Sensor::MuscleExcitation(index)), [case.state.control[index]]);
        }
        assert_eq!([case.measure(Sensor::Action(3)), case.measure(Sensor::Time)].concat(), [0.25, 1.5]);
    }
}

#[test]
fn accelerations_are_the_change_of_velocity_over_the_control_step() {
    let cases = cases();
    let [first, second] = [&cases[0], &cases[1]];
    for (velocity, acceleration) in
        [(Sensor::ComVelocity, Sensor::ComAcceleration), (Sensor::LandmarkVelocity(3), Sensor::LandmarkAcceleration(3))]
    {
        let mut memory = Memory::default();
        assert_eq!(first.measure_after(acceleration, 0.0, &mut memory), [0.0; 3], "zero at reset");
        let found = second.measure_after(acceleration, 0.01, &mut memory);
        let (before, after) = (first.measure(velocity), second.measure(velocity));
        let expected: Vec<f64> = before.iter().zip(&after).map(|(before, after)| (after - before) / 0.01).collect();
        assert_near("acceleration", &found, &expected, 1e-9);
    }
}
