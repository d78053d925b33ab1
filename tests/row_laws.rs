//! What must hold for constraints of every kind independently of MuJoCo.

use crate::support;

use msk_physics::model::{JointKind, Model, rotation};
use msk_physics::{
    State, Workspace,
    constraint::{Constraints, RowKind},
    forward, inertia, step,
};
use nalgebra::Vector3;
use proptest::prelude::*;
use support::{SplitMix, repository};

fn models() -> Vec<(String, Model)> {
    let mut paths: Vec<_> =
        std::fs::read_dir(repository("tests/oracle/row_models")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let name = |path: &std::path::Path| path.file_stem().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), Model::from_file(path).unwrap())).collect()
}

/// A state near the reference configuration, with everything in motion.
fn nearby(model: &Model, random: &mut SplitMix) -> State<f64> {
    let mut state = State::new(model);
    for joint in 0..model.joints.kind.len() {
        let (width, reach) = match model.joints.kind[joint] {
            JointKind::Free => (7, 0.02),
            JointKind::Ball => (4, 0.3),
            JointKind::Hinge | JointKind::Slide => (1, 0.3),
        };
        for coordinate in &mut state.position[model.joints.position_address[joint]..][..width] {
            *coordinate += random.between(-reach, reach);
        }
    }
    state.velocity.fill_with(|| random.between(-1.0, 1.0));
    state.applied_force.fill_with(|| random.between(-5.0, 5.0));
    state
}

/// The deformation y = J a - a_ref + R f of every row. With K the set that a force f may come from, f in K and y in its dual
/// are at right angles: the conditions of Karush, Kuhn and Tucker of the problem that MuJoCo's manual poses.
fn deformations(model: &Model, workspace: &Workspace<f64>) -> Vec<f64> {
    let constraints = &workspace.lanes[0].constraints;
    let rows = &constraints.rows;
    let deformation = |row: usize| {
        let jacobian = constraints.jacobian_row(model, row);
        let acceleration: f64 = jacobian.iter().zip(&workspace.acceleration).map(|(j, a)| j * a).sum();
        acceleration - rows.reference[row] + rows.force[row] * rows.regularization[row]
    };
    (0..rows.len()).map(deformation).collect()
}

/// Checks the conditions on the rows from `row` on that belong together, and returns how many they are.
fn check_rows(what: &str, model: &Model, constraints: &Constraints, deformation: &[f64], row: usize, slack: [f64; 2]) -> usize {
    let rows = &constraints.rows;
    let [force_slack, slack] = slack;
    let (force, kind) = (rows.force[row], rows.kind[row]);
    if constraints.row_type(row) != 7 {
        assert!(force >= rows.lower[row] && force <= rows.upper[row], "{what}: {kind:?} pulls with {force}");
        // Positive deformation where the force is at its lower end, negative at its upper end, none between.
        let allowed =
            (force <= rows.lower[row] && deformation[row] > 0.0) || (force >= rows.upper[row] && deformation[row] < 0.0);
        assert!(allowed || deformation[row].abs() <= slack, "{what}: {kind:?} deforms at {} under {force}", deformation[row]);
        return 1;
    }
    let RowKind::Contact(contact) = kind else { panic!("{what}: a cone that is no contact") };
    let candidate = &constraints.plan.candidates[constraints.contacts[contact].candidate];
    let count = candidate.dimension;
    let norm = |value: &dyn Fn(usize) -> f64| (1..count).map(|j| value(j).powi(2)).sum::<f64>().sqrt();
    let sideways = norm(&|j| rows.force[row + j] / candidate.friction[j - 1]);
    assert!(force >= 0.0 && sideways <= force * (1.0 + 1e-9) + force_slack, "{what}: {sideways} outside the cone of {force}");
    let dual = norm(&|j| deformation[row + j] * candidate.friction[j - 1]);
    assert!(dual <= deformation[row] + slack, "{what}: deformation {dual} outside the dual cone of {}", deformation[row]);
    let work: f64 = (0..count).map(|j| rows.force[row + j] * deformation[row + j]).sum();
    let size: f64 = (0..count).map(|j| rows.force[row + j].abs()).sum();
    assert!(work.abs() <= slack * (1.0 + size), "{what}: force and deformation do work {work}");
    assert_eq!(model.options.cone, msk_physics::model::Cone::Elliptic);
    count
}

#[test]
fn every_solution_is_the_optimum() {
    let mut random = SplitMix(77);
    for (name, model) in models().into_iter().filter(|(_, model)| model.options.no_slip_iterations == 0) {
        let mut workspace = Workspace::new(&model);
        for number in 0..20 {
            let state = nearby(&model, &mut random);
            forward(&model, &state, &mut workspace).unwrap();
            let what = format!("{name}, state {number}");
            let constraints = &workspace.lanes[0].constraints;
            let rows = &constraints.rows;
            let mut balance = vec![0.0; model.nv];
            inertia::multiply(&model, &workspace.inertia.matrix, &workspace.acceleration, &mut balance);
            for (dof, sum) in balance.iter_mut().enumerate() {
                *sum -= workspace.forces.smooth[dof];
            }
            for row in 0..rows.len() {
                let jacobian = constraints.jacobian_row(&model, row);
                balance.iter_mut().zip(&jacobian).for_each(|(sum, j)| *sum -= j * rows.force[row]);
            }
            let largest = rows.force.iter().chain(&workspace.forces.smooth).fold(1.0f64, |most, force| most.max(force.abs()));
            for sum in balance {
                assert!(sum.abs() <= 1e-7 * largest, "{what}: forces do not balance by {sum} of {largest}");
            }
            let deformation = deformations(&model, &workspace);
            let fastest = rows.reference.iter().chain(&workspace.acceleration).fold(1.0f64, |most, a| most.max(a.abs()));
            let mut row = 0;
            while row < rows.len() {
                row += check_rows(&what, &model, constraints, &deformation, row, [1e-9 * largest, 1e-7 * fastest]);
            }
        }
    }
}

/// Friction without slip is the optimum of its own problem: a force that is not at its bounds leaves no residual J a - a_ref along
/// itself, whatever its regularisation; one at its bounds is pushed against them.
#[test]
fn friction_without_slip_leaves_no_residual() {
    let mut random = SplitMix(78);
    for (name, mut model) in models().into_iter().filter(|(_, model)| model.options.no_slip_iterations > 0) {
        (model.options.no_slip_iterations, model.options.no_slip_tolerance) = (10_000, 0.0);
        let mut workspace = Workspace::new(&model);
        let mut checked = 0;
        for number in 0..20 {
            let state = nearby(&model, &mut random);
            forward(&model, &state, &mut workspace).unwrap();
            let constraints = &workspace.lanes[0].constraints;
            let (rows, deformation) = (&constraints.rows, deformations(&model, &workspace));
            let residual = |row: usize| deformation[row] - rows.force[row] * rows.regularization[row];
            let slack = 1e-6 * (0..rows.len()).fold(1.0f64, |most, row| most.max(residual(row).abs()));
            let mut row = 0;
            while row < rows.len() {
                let what = format!("{name}, state {number}, {:?}", rows.kind[row]);
                let force = |row: usize| rows.force[row];
                row += match (rows.kind[row], constraints.row_type(row)) {
                    (RowKind::DofFriction(_) | RowKind::TendonFriction(_), _) => {
                        let pushed =
                            if residual(row) > 0.0 { force(row) <= rows.lower[row] } else { force(row) >= rows.upper[row] };
                        assert!(pushed || residual(row).abs() <= slack, "{what}: {} remains", residual(row));
                        checked += 1;
                        1
                    }
                    // Two edges of a pyramid: along the difference, as long as neither is zero.
                    (RowKind::Contact(_), 6) => {
                        let slope = residual(row) - residual(row + 1);
                        let pushed = if slope > 0.0 { force(row) <= 0.0 } else { force(row + 1) <= 0.0 };
                        assert!(pushed || slope.abs() <= slack, "{what}: {slope} remains");
                        checked += 1;
                        2
                    }
                    // A cone: against the friction where that is as large as may be.
                    (RowKind::Contact(contact), 7) => {
                        let candidate = &constraints.plan.candidates[constraints.contacts[contact].candidate];
                        let count = candidate.dimension;
                        let part = |j: usize| {
                            [force(row + j) / candidate.friction[j - 1], residual(row + j) * candidate.friction[j - 1]]
                        };
                        let norm = |side: usize| (1..count).map(|j| part(j)[side].powi(2)).sum::<f64>().sqrt();
                        let (sideways, remains) = (norm(0), norm(1));
                        assert!(
                            sideways <= force(row) * (1.0 + 1e-9) + 1e-9,
                            "{what}: {sideways} outside the ellipse of {}",
                            force(row)
                        );
                        let against: f64 = -(1..count).map(|j| part(j)[0] * part(j)[1]).sum::<f64>();
                        let bound = sideways >= force(row) * (1.0 - 1e-6);
                        let aligned = bound && (against - sideways * remains).abs() <= slack * (1.0 + sideways);
                        assert!(aligned || remains <= slack, "{what}: {remains} remains under {sideways} of {}", force(row));
                        checked += 1;
                        count
                    }
                    _ => 1,
                };
            }
        }
        assert!(checked > 20, "{name}: only {checked} forces of friction");
    }
}

/// A box on a slope that is less steep than its friction creeps down where friction gives way, and stays without slip.
#[test]
fn nothing_creeps_without_slip() {
    let moved = |cone: &str, iterations: usize| {
        let text = format!(
            r#"<mujoco><option cone="{cone}" noslip_iterations="{iterations}" noslip_tolerance="0" gravity="3.5 0 -9"/><worldbody>
            <geom type="plane" size="0 0 1" friction="0.8"/>
            <body pos="0 0 0.0999"><freejoint/><geom type="box" size="0.1 0.1 0.1" friction="0.8"/></body></worldbody></mujoco>"#
        );
        let model = Model::from_mjcf(&text).unwrap();
        let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
        for number in 0..1000 {
            step(&model, &mut state, &mut workspace).unwrap();
            if number == 499 {
                state.position[0] = 0.0;
            }
        }
        state.position[0].abs()
    };
    // On pyramids the box rocks a little in place of resting, as in MuJoCo (2.2e-4 m there too).
    for (cone, share) in [("pyramidal", 0.2), ("elliptic", 1e-9)] {
        let [creep, rest] = [moved(cone, 0), moved(cone, 100)];
        assert!(creep > 5e-4 && rest < share * creep, "{cone}: {creep} m and {rest} m in a second");
    }
}

/// Two free bodies that touch, are tied by a tendon with friction, welded and connected: nothing comes from outside.
const PAIR: &str = r#"<mujoco><option cone="elliptic" gravity="0 0 0"/><worldbody>
    <body name="a"><freejoint/><geom type="capsule" size="0.1 0.2" condim="6"/><site name="a" pos="0.05 0 0.1"/></body>
    <body name="b" pos="0.19 0.02 0"><freejoint/><geom type="sphere" size="0.1" condim="6"/><site name="b" pos="0 0.05 0"/></body>
    </worldbody><tendon><spatial name="t" frictionloss="3" range="0 0.1"><site site="a"/><site site="b"/></spatial></tendon>
    <equality><weld body1="a" body2="b" torquescale="0.2"/><connect site1="a" site2="b"/><tendon tendon1="t"/></equality></mujoco>"#;

#[test]
fn every_action_has_its_reaction() {
    let model = Model::from_mjcf(PAIR).unwrap();
    let mut workspace = Workspace::new(&model);
    let mut random = SplitMix(5);
    for number in 0..50 {
        let mut state = nearby(&model, &mut random);
        // Each kind of constraint alone, and all together.
        for (equality, active) in state.active.iter_mut().enumerate() {
            *active = f64::from(u8::from(number % 4 == 3 || number % 4 == equality));
        }
        forward(&model, &state, &mut workspace).unwrap();
        let (mut force, mut torque, mut size) = (Vector3::zeros(), Vector3::zeros(), 1.0f64);
        for body in [1, 2] {
            let generalised = &workspace.constraint_force[model.bodies.dofs[body].clone()];
            let push = Vector3::from_column_slice(&generalised[..3]);
            let turn = workspace.kinematics.body_rotation[body] * Vector3::from_column_slice(&generalised[3..]);
            size = size.max(push.norm()).max(turn.norm());
            force += push;
            torque += workspace.kinematics.body_position[body].cross(&push) + turn;
        }
        assert!(force.norm() <= 1e-12 * size, "state {number}: forces add up to {force}");
        // A connection and a weld push at two points, which are apart while they are violated: a couple remains, that of
        // the push along the gap, as in MuJoCo. Contacts and tendons leave none.
        if number % 4 == 2 {
            assert!(torque.norm() <= 1e-12 * size, "state {number}: torques add up to {torque}");
        }
    }
}

/// A hand that holds a load, and lets go.
const HAND: &str = r#"<mujoco><worldbody>
    <body name="hand" pos="0 0 1"><joint name="lift" type="slide" axis="0 0 1" stiffness="2000" damping="100"/>
      <geom type="sphere" size="0.05" contype="0" conaffinity="0" mass="1"/></body>
    <body name="load" pos="0.1 0 1"><freejoint/><geom type="sphere" size="0.05" contype="0" conaffinity="0" mass="0.5"/></body>
    </worldbody><equality><weld name="grip" body1="hand" body2="load" solref="0.01 1"/></equality></mujoco>"#;

#[test]
fn a_released_weld_lets_go_and_can_hold_again() {
    let model = Model::from_mjcf(HAND).unwrap();
    let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
    let run = |state: &mut State<f64>, workspace: &mut Workspace<f64>, seconds: f64| {
        let end = state.time + seconds;
        while state.time < end - 1e-9 {
            step(&model, state, workspace).unwrap();
        }
    };
    run(&mut state, &mut workspace, 1.0);
    let load = model.joints.position_address[1] + 2;
    let held = state.position[load];
    assert!((held - 1.0).abs() < 0.02 && state.velocity.iter().all(|v| v.abs() < 1e-2), "held at {held}: {:?}", state.velocity);
    state.active[0] = 0.0;
    forward(&model, &state, &mut workspace).unwrap();
    assert!(workspace.lanes[0].constraints.rows.is_empty());
    run(&mut state, &mut workspace, 0.5);
    let fallen = held - state.position[load];
    assert!((fallen - 0.5 * 9.81 * 0.25).abs() < 0.01, "fell {fallen} m in half a second");
    state.active[0] = 1.0;
    run(&mut state, &mut workspace, 2.0);
    assert!((state.position[load] - held).abs() < 0.02, "held again at {}", state.position[load]);
}

#[test]
fn every_model_survives_writing() {
    for (name, model) in models() {
        let written = model.to_mjcf();
        let again = Model::from_mjcf(&written).unwrap_or_else(|error| panic!("{name}: {error}\n{written}"));
        assert!(again == model, "{name} changed:\n{written}");
    }
}

/// Numbers that softness may have, and some that it should not.
fn figure() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(1.0), Just(1e-12), Just(1e12), Just(-1e12), Just(-1e-9), -1000.0..1000.0, (1e-6..1.0f64),]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Whatever stiffness, impedance and mass: a step ends with numbers, or with a fault that names where it failed.
    #[test]
    fn the_solver_always_ends(
        reference in prop::array::uniform4(figure()),
        impedance in prop::array::uniform5(figure()),
        masses in prop::array::uniform2(-13i32..9),
        elliptic in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let [a, b, c, d] = reference;
        let [i, j, k, l, m] = impedance;
        let [light, heavy] = masses.map(|exponent| 10f64.powi(exponent));
        let cone = if elliptic { "elliptic" } else { "pyramidal" };
        // Two welds that want the same body in two places, a knot of tendons, a joint locked twice.
        let text = format!(r#"<mujoco><option cone="{cone}" impratio="100"><flag refsafe="disable"/></option><worldbody>
            <geom type="plane" size="0 0 1" solref="{c} {d}" condim="6"/>
            <body name="a" pos="0 0 0.05"><freejoint/><geom size="0.1" mass="{light}" solimp="{i} {j} {k} {l} {m}" condim="4"/></body>
            <body name="b" pos="0 0 0.2"><joint name="h" type="slide" axis="0 0 1" frictionloss="1e9" range="-1e-9 1e-9"/>
              <geom size="0.1" mass="{heavy}"/></body></worldbody>
            <tendon><fixed name="t" range="0.1 0.2" frictionloss="1e-9"><joint joint="h" coef="1e5"/></fixed></tendon>
            <equality><weld body1="a" relpose="0 0 1 1 0 0 0" solref="{a} {b}" solimp="{i} {j} {k} {l} {m}"/>
            <weld body1="a" relpose="5 0 -1 0 1 0 0" solref="{c} {d}"/><weld body1="a" body2="b" torquescale="1e6"/>
            <joint joint1="h" polycoef="3 0 0 0 0" solref="{a} {b}"/><joint joint1="h" polycoef="-3 0 0 0 0"/></equality></mujoco>"#);
        let Ok(model) = Model::from_mjcf(&text) else { return Err(TestCaseError::reject("no model")) };
        let mut workspace = Workspace::new(&model);
        let mut state = nearby(&model, &mut SplitMix(seed));
        for _ in 0..5 {
            if step(&model, &mut state, &mut workspace).is_err() {
                break;
            }
            let finite = state.position.iter().chain(&state.velocity).chain(&workspace.acceleration).all(|value| value.is_finite());
            prop_assert!(finite, "{text}");
        }
        prop_assert!(workspace.lanes[0].newton.iterations <= model.options.iterations);
    }
}

#[test]
fn frames_given_and_derived_agree() {
    let model = Model::from_mjcf(PAIR).unwrap();
    let msk_physics::model::Equality::Weld { attachment, .. } = &model.equalities.kind[0] else { panic!("not a weld") };
    // Both frames are where they are at the reference configuration.
    let place = |side: usize| {
        let body = attachment.bodies[side];
        let bodies = &model.bodies;
        bodies.position[body] + rotation::rotate(bodies.orientation[body], attachment.position[side])
    };
    assert!((place(0) - place(1)).norm() < 1e-15);
}

#[test]
fn whichever_solver_is_asked_for_the_optimum_is_the_same() {
    let with = |solver: &str| Model::from_mjcf(&PAIR.replace("<option ", &format!("<option solver=\"{solver}\" ")));
    let newton = with("Newton").unwrap();
    assert!(with("CG").unwrap() == newton && with("PGS").unwrap() == newton);
    let error = with("SOR").unwrap_err().to_string();
    assert!(error.contains("`solver` expects one of PGS, CG, Newton, found `SOR`"), "{error}");
}

#[test]
fn what_cannot_be_held_together_is_refused_with_the_reason() {
    let refused = |equality: &str, expected: &str| {
        let start = PAIR.find("<weld").unwrap();
        let text = format!("{}{equality}</equality></mujoco>", &PAIR[..start]);
        let error = Model::from_mjcf(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "{equality}: {error}");
    };
    refused(r#"<weld body2="b"/>"#, "`weld` needs `body1` (and perhaps `body2`), or both `site1` and `site2`");
    refused(r#"<weld body1="x"/>"#, "names the body `x`, which does not exist");
    refused(r#"<weld body1="a" body2="a"/>"#, "needs two different bodies");
    refused(r#"<weld site1="a"/>"#, "needs the attribute `site2`");
    refused(r#"<weld site1="a" site2="b" body1="a"/>"#, "`body1` has no place beside them");
    refused(r#"<connect body1="a"/>"#, "needs the attribute `anchor`");
    refused(r#"<tendon tendon1="t" tendon2="t"/>"#, "a tendon cannot be coupled to itself");
    refused(r#"<tendon tendon2="t"/>"#, "needs the attribute `tendon1`");
    refused(r#"<connect body1="a" anchor="0 0 0" active="maybe"/>"#, "`active` expects one of false, true");
    let fixed = |entries: &str| {
        let text = format!(
            "<mujoco><worldbody><body><joint name=\"h\"/><geom size=\"1\"/></body><body><freejoint name=\"f\"/><geom \
             size=\"1\"/></body></worldbody><tendon><fixed>{entries}</fixed></tendon></mujoco>"
        );
        Model::from_mjcf(&text).unwrap_err().to_string()
    };
    assert!(fixed("").contains("needs at least one joint"));
    assert!(fixed(r#"<joint joint="h"/>"#).contains("needs the attribute `coef`"));
    assert!(fixed(r#"<joint joint="f" coef="1"/>"#).contains("must be a hinge or slide joint"));
    assert!(fixed(r#"<joint joint="h" coef="1"/><joint joint="h" coef="2"/>"#).contains("in this tendon twice"));
}
