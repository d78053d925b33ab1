//! Laws of mechanics that every model obeys independently of MuJoCo: energy, momentum, inertia, virtual work, numbering.

use crate::support;

use msk_physics::model::{Integrator, Model};
use msk_physics::{self as physics, State, Workspace, actuation, forces, forward, integrate, point_jacobian};
use nalgebra::{DMatrix, Matrix3, Vector3};
use std::sync::OnceLock;
use support::{SplitMix, draw, repository};

/// A free body that carries a ball, a hinge and a slide with springs; nothing damps and nothing touches.
const CHAIN: &str = r#"<mujoco><option timestep="0.002"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
    <body pos="0 0 2"><freejoint name="root"/><geom type="box" size="0.1 0.2 0.3" mass="2"/>
      <body pos="0.3 0 0.1"><joint name="ball" type="ball"/><geom type="ellipsoid" size="0.3 0.1 0.05" pos="0.2 0 0" mass="1"/>
        <body pos="0.4 0 0"><joint name="hinge" axis="0 1 0.3" stiffness="5" springref="0.3" armature="0.01"/>
          <geom type="box" size="0.05 0.1 0.2" pos="0 0 -0.2" mass="0.5"/>
          <body pos="0 0 -0.4"><joint name="slide" type="slide" axis="1 0 0" stiffness="40"/>
            <geom type="box" size="0.05 0.04 0.03" mass="0.3"/></body>
        </body>
      </body>
    </body></worldbody></mujoco>"#;

fn human() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| Model::from_file(repository("bodies/models/human416.xml")).expect("the body loads"))
}

/// Linear momentum, and angular momentum about the centre of mass, of all bodies.
fn momentum(model: &Model, workspace: &Workspace<f64>) -> [Vector3<f64>; 2] {
    let (kinematics, bodies) = (&workspace.kinematics, &model.bodies);
    let part = |body: usize| {
        let [spin, linear] = workspace.velocities.body[body];
        let position = kinematics.inertial_position[body];
        let reference = kinematics.subtree_com[bodies.root[body]];
        let velocity = linear + spin.cross(&(position - reference));
        let axes: Matrix3<f64> = kinematics.inertial_rotation[body];
        let turning = axes * bodies.inertia[body].component_mul(&(axes.transpose() * spin));
        [velocity * bodies.mass[body], turning + (position - kinematics.subtree_com[0]).cross(&velocity) * bodies.mass[body]]
    };
    (1..bodies.parent.len()).map(part).fold([Vector3::zeros(); 2], |[p, l], [q, m]| [p + q, l + m])
}

/// The largest deviations of energy and momenta from their first values over a fifth of a second, and their scale.
fn drift(model: &Model, seed: u64) -> [f64; 3] {
    let mut random = SplitMix(seed);
    let mut state = State::new(model);
    state.velocity.fill_with(|| random.between(-2.0, 2.0));
    let (mut workspace, mut scratch) = (Workspace::new(model), vec![0.0; model.nv]);
    let mut first = None;
    let mut drift = [0.0_f64; 3];
    let steps = (0.2 / model.options.timestep).round() as usize;
    for _ in 0..=steps {
        forward(model, &state, &mut workspace).unwrap();
        let [potential, kinetic] = forces::energy(model, &state, &workspace.kinematics, &workspace.inertia, &mut scratch);
        let [linear, angular] = momentum(model, &workspace);
        // Gravity pulls at the momentum.
        let linear = linear - model.options.gravity * model.bodies.subtree_mass[0] * state.time;
        let (energy, linear_0, angular_0) = *first.get_or_insert((potential + kinetic, linear, angular));
        let now = [(potential + kinetic - energy).abs(), (linear - linear_0).norm(), (angular - angular_0).norm()];
        (0..3).for_each(|which| drift[which] = drift[which].max(now[which]));
        integrate(model, &mut state, &mut workspace).unwrap();
    }
    drift
}

/// What drifts without friction and contact is the error of the step: it shrinks with the integrator's order.
#[test]
fn energy_and_momentum_are_kept_to_the_order_of_the_integrator() {
    let orders = [(Integrator::Euler, 1.0), (Integrator::Implicit, 1.0), (Integrator::RungeKutta, 4.0)];
    for (integrator, order) in orders {
        let drift_at = |timestep: f64| {
            let mut model = Model::from_mjcf(CHAIN).unwrap();
            (model.options.integrator, model.options.timestep) = (integrator, timestep);
            drift(&model, 7)
        };
        let [coarse, fine] = [2e-3, 1e-3].map(drift_at);
        for (what, (coarse, fine)) in ["energy", "momentum", "angular momentum"].iter().zip(coarse.iter().zip(fine)) {
            // What is kept exactly has no order.
            let exact = *coarse < 1e-11;
            let found = (coarse / fine).log2();
            assert!(
                exact || (order - 0.25..order + 1.5).contains(&found),
                "{integrator:?}: {what} {coarse:e} is of order {found}"
            );
        }
    }
}

/// Muscles, springs, dampers, couplings and limits act within the body: on the dofs of the free root they do nothing, so that
/// a body in the air falls by its weight alone and keeps its spin.
#[test]
fn inner_forces_move_neither_the_centre_nor_the_spin_of_the_whole_body() {
    let model = human();
    let (mut random, mut workspace) = (SplitMix(21), Workspace::new(model));
    for _ in 0..5 {
        let mut state = draw(model, &mut random);
        state.position[2] = 5.0;
        state.applied_force.fill(0.0);
        state.body_force.fill([Vector3::zeros(); 2]);
        forward(model, &state, &mut workspace).unwrap();
        let inner = [&workspace.forces.actuator, &workspace.forces.passive, &workspace.constraint_force];
        for forces in inner {
            let largest = forces.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
            assert!(largest > 1.0);
            for force in &forces[..6] {
                assert!(force.abs() <= 1e-12 * largest, "{force} of {largest}");
            }
        }
    }
    // A tenth of a second with muscles at random.
    let mut state = State::new(model);
    state.position[2] = 5.0;
    state.control.fill_with(|| random.unit());
    forward(model, &state, &mut workspace).unwrap();
    let [before, _] = momentum(model, &workspace);
    let mut spin: f64 = 0.0;
    for _ in 0..100 {
        physics::step(model, &mut state, &mut workspace).unwrap();
        spin = spin.max(workspace.velocities.body.iter().map(|velocity| velocity[0].norm()).fold(0.0, f64::max));
    }
    forward(model, &state, &mut workspace).unwrap();
    let [after, angular] = momentum(model, &workspace);
    let mass = model.bodies.subtree_mass[0];
    let gained = (after - before) / mass - model.options.gravity * state.time;
    assert!(spin > 5.0, "the body moves: {spin} rad/s");
    assert!(gained.norm() < 0.02, "the centre gains {gained:?} m/s beyond its fall");
    assert!(angular.norm() < 0.5, "the body gains a spin of {angular:?} kg m²/s");
}

fn dense_mass(model: &Model, workspace: &Workspace<f64>) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(model.nv, model.nv);
    for (row, range) in model.dofs.row.iter().enumerate() {
        for (column, value) in model.dofs.column[range.clone()].iter().zip(&workspace.inertia.matrix[range.clone()]) {
            (dense[(row, *column)], dense[(*column, row)]) = (*value, *value);
        }
    }
    dense
}

/// M = sum over bodies of m Jv'Jv + Jw' R I R' Jw, plus the rotors; and it is positive definite.
#[test]
fn the_mass_matrix_is_the_sum_over_bodies_and_positive_definite() {
    let model = human();
    let (mut random, mut workspace) = (SplitMix(4), Workspace::new(model));
    for _ in 0..3 {
        physics::smooth(model, &draw(model, &mut random), &mut workspace);
        let kinematics = &workspace.kinematics;
        let mut sum = DMatrix::from_diagonal(&model.dofs.armature.clone().into());
        let (mut translation, mut rotation) = (vec![Vector3::zeros(); model.nv], vec![Vector3::zeros(); model.nv]);
        for body in 1..model.bodies.parent.len() {
            let centre = kinematics.inertial_position[body];
            point_jacobian(model, kinematics, body, &centre, &mut translation, &mut rotation);
            let axes: Matrix3<f64> = kinematics.inertial_rotation[body];
            let inertia = axes * Matrix3::from_diagonal(&model.bodies.inertia[body]) * axes.transpose();
            let moving: Vec<usize> =
                (0..model.nv).filter(|&dof| translation[dof] != Vector3::zeros() || rotation[dof] != Vector3::zeros()).collect();
            for &row in &moving {
                for &column in &moving {
                    let linear = model.bodies.mass[body] * translation[row].dot(&translation[column]);
                    sum[(row, column)] += linear + rotation[row].dot(&(inertia * rotation[column]));
                }
            }
        }
        let mass = dense_mass(model, &workspace);
        for row in 0..model.nv {
            for column in 0..model.nv {
                let scale = (mass[(row, row)] * mass[(column, column)]).sqrt();
                assert!((mass[(row, column)] - sum[(row, column)]).abs() <= 1e-11 * scale, "entry {row}, {column}");
            }
        }
        assert!(mass.cholesky().is_some());
    }
}

/// The pulls of all muscles, gathered along their paths, are J'f with the tendon Jacobian, and their power is that of the
/// tendons.
#[test]
fn gathered_pulls_are_the_jacobian_times_the_forces() {
    let model = human();
    let (mut random, mut workspace) = (SplitMix(6), Workspace::new(model));
    for _ in 0..3 {
        let state = draw(model, &mut random);
        physics::smooth(model, &state, &mut workspace);
        let (mut expected, mut row) = (vec![0.0; model.nv], vec![0.0; model.nv]);
        let mut power = 0.0;
        for (muscle, force) in workspace.actuation.force.iter().enumerate() {
            actuation::moment(model, &state, &workspace.kinematics, &workspace.tendons, muscle, &mut row);
            expected.iter_mut().zip(&row).for_each(|(sum, arm)| *sum += arm * force);
            power += force * workspace.actuation.velocity[muscle];
        }
        let scale = expected.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
        for (found, expected) in workspace.forces.actuator.iter().zip(&expected) {
            assert!((found - expected).abs() <= 1e-12 * scale, "{found} is not {expected}");
        }
        let at_joints: f64 = workspace.forces.actuator.iter().zip(&state.velocity).map(|(force, rate)| force * rate).sum();
        assert!(
            (at_joints - power).abs() <= 1e-11 * power.abs().max(scale),
            "{at_joints} W at the joints, {power} W along the paths"
        );
    }
}

/// Three limbs on a trunk above the ground, in any order: muscles across them, one limit and two contacts active.
fn limbs(order: [usize; 3]) -> Model {
    let limb = |which: usize| {
        let angle = which as f64 * 2.0;
        let (x, y) = (0.3 * angle.cos(), 0.3 * angle.sin());
        format!(
            r#"<body name="limb{which}" pos="{x} {y} 0"><joint name="hinge{which}" axis="0 1 {which}" range="-0.{which}1 0.5" limited="true"/>
            <geom type="capsule" size="0.03 0.2" pos="0 0 -0.2" mass="0.{which}5"/><site name="end{which}" pos="0 0 -0.3"/>
            <body name="tip{which}" pos="0 0 -0.4"><joint name="ball{which}" type="ball" damping="0.1"/>
            <geom name="foot{which}" type="sphere" size="0.06" mass="0.2"/><site name="tip{which}" pos="0.05 0 0"/></body></body>"#
        )
    };
    let bodies: String = order.map(limb).concat();
    let tendon = |which: usize| {
        format!(r#"<spatial name="t{which}"><site site="trunk"/><site site="end{which}"/><site site="tip{which}"/></spatial>"#)
    };
    let muscle = |which: usize| format!(r#"<muscle name="m{which}" tendon="t{which}" force="50" lengthrange="0.2 0.5"/>"#);
    let (tendons, muscles) = (order.map(tendon).concat(), order.map(muscle).concat());
    Model::from_mjcf(&format!(
        r#"<mujoco><option tolerance="1e-14" iterations="300"/><worldbody><geom name="ground" type="plane" size="1 1 1"/>
        <body name="trunk" pos="0 0 0.43"><freejoint name="root"/><geom type="sphere" size="0.1" mass="3"/><site name="trunk" pos="0 0 0.1"/>
        {bodies}</body></worldbody><tendon>{tendons}</tendon><actuator>{muscles}</actuator></mujoco>"#
    ))
    .unwrap()
}

/// Bodies, joints and muscles in another order move the same.
#[test]
fn numbering_does_not_matter() {
    let accelerations = |order: [usize; 3]| {
        let model = limbs(order);
        let mut state = State::new(&model);
        for joint in 0..model.joints.name.len() {
            // By name, so that both orders begin the same.
            let name = &model.joints.name[joint];
            let mut random = SplitMix(name.bytes().map(u64::from).sum());
            let first = model.joints.dof_address[joint];
            let count = if name == "root" {
                6
            } else if name.starts_with("ball") {
                3
            } else {
                1
            };
            state.velocity[first..first + count].fill_with(|| random.between(-1.0, 1.0));
            if name.starts_with("hinge") {
                state.position[model.joints.position_address[joint]] = random.between(-0.3, 0.2);
            }
        }
        state.activation.iter_mut().zip(&model.actuators.name).for_each(|(a, name)| *a = name.len() as f64 * 0.2);
        let mut workspace = Workspace::new(&model);
        forward(&model, &state, &mut workspace).unwrap();
        assert!(workspace.lanes[0].constraints.contacts.len() >= 2, "feet touch the ground");
        let mut named: Vec<(String, f64)> = (0..model.nv)
            .map(|dof| {
                let joint = model.dofs.joint[dof];
                let axis = dof - model.joints.dof_address[joint];
                (format!("{} {axis}", model.joints.name[joint]), workspace.acceleration[dof])
            })
            .collect();
        named.sort_by(|a, b| a.0.cmp(&b.0));
        named
    };
    let reference = accelerations([0, 1, 2]);
    let scale = reference.iter().fold(0.0_f64, |largest, (_, value)| largest.max(value.abs()));
    for order in [[2, 0, 1], [1, 0, 2], [2, 1, 0]] {
        for ((name, expected), (other, found)) in reference.iter().zip(accelerations(order)) {
            assert_eq!(*name, other);
            assert!((found - expected).abs() <= 1e-9 * scale, "{name}: {found} is not {expected}");
        }
    }
}
