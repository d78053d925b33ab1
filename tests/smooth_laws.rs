//! Laws that the smooth physics must obey at any state, independently of MuJoCo.

use crate::support;

use msk_physics::model::Model;
use msk_physics::{
    self as physics, State, Workspace, forces, inertia,
    spatial::pair,
    tendons::{WrapShape, WrappingSurface, bend, path},
};
use nalgebra::{Matrix3, Vector3};
use support::{SplitMix, draw, repository};

const MODELS: [&str; 7] = ["joints", "muscles", "pulley", "tendon_springs", "wrap_cylinder", "wrap_inside", "wrap_sphere"];

/// Calls `law` at twenty random states of each small model.
fn everywhere(mut law: impl FnMut(&str, &Model, &State<f64>, &mut Workspace<f64>)) {
    for (number, name) in MODELS.iter().enumerate() {
        let model = Model::from_file(repository("tests/oracle/models").join(format!("{name}.xml"))).expect("the model loads");
        let mut random = SplitMix(number as u64);
        let mut workspace = Workspace::new(&model);
        for _ in 0..20 {
            let state = draw(&model, &mut random);
            physics::smooth(&model, &state, &mut workspace);
            law(name, &model, &state, &mut workspace);
        }
    }
}

fn assert_near(actual: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((actual - expected).abs() <= tolerance, "{what}: {actual:e} where {expected:e} was expected");
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn tendon_velocity_is_moment_arms_times_velocity() {
    everywhere(|name, model, state, workspace| {
        let mut row = vec![0.0; model.nv];
        for tendon in 0..model.tendons.path.len() {
            physics::moment_arms(model, &workspace.kinematics, &workspace.tendons, tendon, &mut row);
            assert_near(product(&row, &state.velocity), workspace.tendons.velocity[tendon], 1e-12, name);
        }
    });
}

#[test]
fn muscle_power_in_the_joints_is_the_power_along_the_paths() {
    everywhere(|name, _, state, workspace| {
        let at_joints = product(&workspace.forces.actuator, &state.velocity);
        let along_paths = product(&workspace.actuation.force, &workspace.actuation.velocity);
        assert_near(at_joints, along_paths, 1e-11 * (1.0 + along_paths.abs()), name);
    });
}

#[test]
fn a_path_is_as_long_as_its_parts() {
    everywhere(|name, model, _, workspace| {
        for tendon in 0..model.tendons.path.len() {
            let vertices = path(model, &workspace.kinematics, tendon);
            let sum: f64 = vertices.iter().map(|vertex| vertex.length * vertex.weight).sum();
            assert_near(sum, workspace.tendons.length[tendon], 1e-14, name);
        }
    });
}

/// The mass matrix gives the kinetic energy of all bodies (and rotors), and its factor undoes it.
#[test]
fn the_mass_matrix_is_the_sum_over_bodies() {
    everywhere(|name, model, state, workspace| {
        let mut momentum = vec![0.0; model.nv];
        inertia::multiply(model, &workspace.inertia.matrix, &state.velocity, &mut momentum);
        let bodies: f64 = (1..model.bodies.parent.len())
            .map(|body| {
                let velocity = &workspace.velocities.body[body];
                0.5 * pair(velocity, &workspace.inertia.body[body].momentum(velocity))
            })
            .sum();
        let rotors: f64 = state.velocity.iter().zip(&model.dofs.armature).map(|(v, inertia)| 0.5 * inertia * v * v).sum();
        let energy = 0.5 * product(&momentum, &state.velocity);
        assert!(energy > 0.0);
        assert_near(energy, bodies + rotors, 1e-13 * energy, name);

        inertia::solve(model, &workspace.inertia.factor, &mut momentum);
        for (solved, velocity) in momentum.iter().zip(&state.velocity) {
            assert_near(*solved, *velocity, 1e-10, name);
        }
    });
}

/// Forces within a body that floats freely neither push nor turn it as a whole.
#[test]
fn inner_forces_leave_a_floating_tree_alone() {
    let model = Model::from_file(repository("tests/oracle/models/tendon_springs.xml")).expect("the model loads");
    let mut workspace = Workspace::new(&model);
    let mut random = SplitMix(3);
    for _ in 0..20 {
        physics::smooth(&model, &draw(&model, &mut random), &mut workspace);
        let mut row = vec![0.0; model.nv];
        let within = model.tendons.name.iter().position(|name| name == "within").expect("the tendon within one tree");
        physics::moment_arms(&model, &workspace.kinematics, &workspace.tendons, within, &mut row);
        for entry in &row[..6] {
            assert_near(*entry, 0.0, 1e-14, "root dof");
        }
        assert!(row[6].abs() > 1e-6, "the elbow feels the tendon");
    }
}

/// At rest the bias is the weight: minus gravity along the Jacobian of every body's centre of mass, and of the whole's.
#[test]
fn bias_at_rest_is_the_weight() {
    everywhere(|name, model, state, workspace| {
        let mut resting = state.clone();
        resting.velocity.fill(0.0);
        physics::smooth(model, &resting, workspace);
        let (mut translation, mut rotation) = (vec![Vector3::zeros(); model.nv], vec![Vector3::zeros(); model.nv]);
        let mut weight = vec![0.0; model.nv];
        for body in 1..model.bodies.parent.len() {
            let center = workspace.kinematics.inertial_position[body];
            physics::point_jacobian(model, &workspace.kinematics, body, &center, &mut translation, &mut rotation);
            for (sum, column) in weight.iter_mut().zip(&translation) {
                *sum -= model.bodies.mass[body] * model.options.gravity.dot(column);
            }
        }
        physics::center_of_mass_jacobian(model, &workspace.kinematics, &workspace.inertia, 0, &mut translation);
        let mass: f64 = model.bodies.mass.iter().sum();
        for dof in 0..model.nv {
            assert_near(workspace.forces.bias[dof], weight[dof], 1e-12 * mass * 9.81, name);
            assert_near(-mass * model.options.gravity.dot(&translation[dof]), weight[dof], 1e-12 * mass * 9.81, name);
        }
    });
}

/// Without dampers, muscles and applied forces the acceleration keeps the energy: its rate along the motion, by a central
/// difference, vanishes.
#[test]
fn free_motion_keeps_its_energy() {
    let mut model = Model::from_file(repository("tests/oracle/models/wrap_sphere.xml")).expect("the model loads");
    model.dofs.damping.fill(0.0);
    let mut random = SplitMix(5);
    let mut workspace = Workspace::new(&model);
    for _ in 0..20 {
        let mut state = draw(&model, &mut random);
        state.applied_force.fill(0.0);
        state.body_force.fill([Vector3::zeros(); 2]);
        physics::smooth(&model, &state, &mut workspace);
        let acceleration = workspace.forces.smooth_acceleration.clone();
        let mut energy_after = |time: f64| {
            let mut moved = state.clone();
            for (dof, acceleration) in acceleration.iter().enumerate() {
                moved.position[dof] += time * (state.velocity[dof] + 0.5 * time * acceleration);
                moved.velocity[dof] += time * acceleration;
            }
            physics::smooth(&model, &moved, &mut workspace);
            let mut scratch = vec![0.0; model.nv];
            forces::energy(&model, &moved, &workspace.kinematics, &workspace.inertia, &mut scratch)
        };
        let step = 1e-5;
        let (before, after) = (energy_after(-step), energy_after(step));
        let exchanged = (after[0] - before[0]).abs();
        assert!(exchanged > 1e-5, "potential and kinetic energy are exchanged");
        assert_near((after[0] + after[1]) - (before[0] + before[1]), 0.0, 1e-6 * exchanged, "change of energy");
    }
}

/// Away from the ray opposite its side point, a wrapped path has no jumps: not at onset, not at half a turn.
#[test]
fn wrap_length_is_continuous_in_its_end() {
    let mut random = SplitMix(9);
    for case in 0..60 {
        let obstacle = WrappingSurface {
            shape: if case % 2 == 0 { WrapShape::Sphere } else { WrapShape::Cylinder },
            position: Vector3::zeros(),
            rotation: Matrix3::identity(),
            radius: 1.0,
            side: Some(Vector3::new(0.0, 1.5, 0.0)),
        };
        let start = Vector3::new(-random.between(1.2, 3.0), random.between(-0.8, 2.0), 0.0);
        let distance = random.between(1.1, 3.0);
        let length = |angle: f64| {
            let end = Vector3::new(distance * angle.cos(), distance * angle.sin(), 0.0);
            match bend(&start, &end, &obstacle) {
                Some(bend) => (bend.first - start).norm() + bend.arc + (end - bend.second).norm(),
                None => (end - start).norm(),
            }
        };
        let step = 1e-3;
        // From just short of straight below on the right to just short of it on the left, by way of the top.
        let steps = ((std::f64::consts::TAU - 0.02) / step) as usize;
        let lengths: Vec<f64> = (0..steps).map(|i| length(0.01 - std::f64::consts::FRAC_PI_2 + i as f64 * step)).collect();
        for pair in lengths.windows(2) {
            assert!((pair[1] - pair[0]).abs() <= distance * step * (1.0 + 1e-6), "case {case}: a jump of {}", pair[1] - pair[0]);
        }
    }
}
