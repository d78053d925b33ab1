//! Elastic tendons of the whole body: they hold still at reset, stay sound under any excitation, and become rigid when stiff.

use crate::support;

use msk_physics::model::{ElasticTendons, FibreCurves, Model};
use msk_physics::{self as physics, State, Workspace, forward, step};
use std::sync::OnceLock;
use support::{SplitMix, draw, repository};

fn human() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| Model::from_file(repository("bodies/models/human416.xml")).expect("the body loads"))
}

fn elastic(change: impl FnOnce(&mut ElasticTendons)) -> Model {
    let mut settings = ElasticTendons::default();
    change(&mut settings);
    human().clone().with_elastic_tendons(settings).unwrap()
}

/// Peak isometric force of each muscle, N.
fn peaks(model: &Model) -> Vec<f64> {
    let muscles = Workspace::<f64>::new(model).actuation;
    (0..model.actuators.name.len()).map(|muscle| muscles.peak_force(muscle)).collect()
}

#[test]
fn two_seconds_of_random_excitation_at_one_millisecond_stay_sound() {
    let model = elastic(|_| ());
    let peaks = peaks(&model);
    let mut random = SplitMix(11);
    let mut state = State::new(&model);
    let mut workspace = Workspace::new(&model);
    let mut strongest: f64 = 0.0;
    for count in 0..2000 {
        if count % 10 == 0 {
            state.control.fill_with(|| random.unit());
        }
        step(&model, &mut state, &mut workspace).unwrap();
        for (muscle, peak) in peaks.iter().enumerate() {
            let pull = -workspace.actuation.force[muscle] / peak;
            assert!((0.0..8.0).contains(&pull), "{} pulls {pull} peak forces at {count} ms", model.actuators.name[muscle]);
            strongest = strongest.max(pull);
            assert!(state.fibre_length[muscle] > 0.0);
        }
    }
    assert_eq!(state.fibre_length.len(), 416);
    assert!(strongest > 1.0, "some muscle is stretched while it pulls: {strongest}");
    assert!(state.position[2] > 0.0 && state.position[2] < 1.2, "the pelvis is {} m high", state.position[2]);
}

/// Nothing has moved at reset, so fibres are in balance with their tendons, and a second pass over the same state finds the same.
#[test]
fn fibres_begin_in_balance_and_a_forward_pass_repeats_itself() {
    let model = elastic(|_| ());
    let mut random = SplitMix(3);
    let mut workspace = Workspace::new(&model);
    for _ in 0..5 {
        let mut state = draw(&model, &mut random);
        state.velocity.fill(0.0);
        physics::smooth(&model, &state, &mut workspace);
        let first = workspace.actuation.clone();
        // Held still, no fibre moves, and no force changes.
        let fibres = first.fibres.as_ref().unwrap();
        state.fibre_length.clone_from(&fibres.length);
        state.fibre_velocity.clone_from(&fibres.velocity);
        physics::smooth(&model, &state, &mut workspace);
        let repeated = workspace.actuation.force.clone();
        for (muscle, peak) in peaks(&model).iter().enumerate() {
            let change = (workspace.actuation.force[muscle] - first.force[muscle]).abs() / peak;
            assert!(change < 1e-6, "{} changes by {change} peak forces", model.actuators.name[muscle]);
        }
        physics::smooth(&model, &state, &mut workspace);
        assert_eq!(repeated, workspace.actuation.force);
    }
}

/// The stiffer the tendons, the nearer the forces to those of rigid ones: at random states, and after 50 ms of motion.
#[test]
fn stiff_tendons_are_rigid_ones() {
    let rigid = human();
    let peaks = peaks(rigid);
    let errors: Vec<[f64; 2]> = [1e-3, 2.5e-4, 6.25e-5]
        .into_iter()
        .map(|strain| {
            // The rigid muscles have no damping of fibres: it goes with the stretch.
            let model = elastic(|s| (s.curves, s.strain, s.damping) = (FibreCurves::Model, strain, 10.0 * strain));
            let (mut soft, mut hard) = (Workspace::new(&model), Workspace::new(rigid));
            let (mut random, mut sum, mut count) = (SplitMix(5), 0.0, 0.0);
            for _ in 0..5 {
                let state = draw(rigid, &mut random);
                physics::smooth(rigid, &state, &mut hard);
                let unlaid = State { fibre_length: vec![0.0; 416], fibre_velocity: vec![0.0; 416], ..state };
                physics::smooth(&model, &unlaid, &mut soft);
                for (muscle, peak) in peaks.iter().enumerate() {
                    // A rigid tendon can push and be overstretched without end; compare where the path is in its range.
                    let [low, high] = rigid.actuators.length_range[muscle];
                    if (low..high).contains(&hard.actuation.length[muscle]) {
                        sum += (soft.actuation.force[muscle] - hard.actuation.force[muscle]).abs() / peak;
                        count += 1.0;
                    }
                }
            }
            [sum / count, distance_after_motion(rigid, &model)]
        })
        .collect();
    // A quarter of the compliance: a quarter of the error of force. The motion approaches the same more slowly, until what is
    // left is the error of the step: a fibre's rate is that over the last step, a rigid muscle's that at its end.
    for pair in errors.windows(2) {
        let [force, motion] = [0, 1].map(|which| pair[0][which] / pair[1][which]);
        assert!(force > 3.8 && motion > 2.5, "errors of force and motion: {errors:?}");
    }
}

/// How far apart the coordinates are after 50 ms from the reference configuration under the same excitation.
fn distance_after_motion(rigid: &Model, soft: &Model) -> f64 {
    let end = |model: &Model| {
        let mut state = State::new(model);
        let mut workspace = Workspace::new(model);
        state.control.fill(0.2);
        for _ in 0..50 {
            step(model, &mut state, &mut workspace).unwrap();
        }
        state.position
    };
    end(rigid).iter().zip(end(soft)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The statement of `docs/elastic-tendons.md` about the body: a muscle whose range leaves less tendon than a tenth of its path
/// stretches by that tenth.
#[test]
fn the_range_of_many_muscles_of_the_trunk_leaves_no_tendon() {
    let model = human();
    let (actuation, settings) = (Workspace::<f64>::new(model).actuation, ElasticTendons::default());
    let short = |muscle: &usize| {
        let (_, slack) = actuation.lengths(*muscle);
        settings.stretching_length(slack, model.actuators.length_range[*muscle]) > slack
    };
    let short: Vec<usize> = (0..416).filter(short).collect();
    let without = short.iter().filter(|&&muscle| actuation.lengths(muscle).1 <= 0.0).count();
    assert_eq!([short.len(), short.iter().filter(|&&muscle| muscle < 210).count(), without], [176, 156, 160]);
}

#[test]
fn a_snapshot_with_fibres_continues_with_the_same_bits() {
    let model = elastic(|_| ());
    let mut state = State::new(&model);
    state.control.fill(0.3);
    let run = |state: &mut State<f64>, workspace: &mut Workspace<f64>| {
        (0..40).for_each(|_| step(&model, state, workspace).unwrap());
    };
    let mut workspace = Workspace::new(&model);
    run(&mut state, &mut workspace);
    let mut restored = state.clone();
    run(&mut state, &mut workspace);
    run(&mut restored, &mut Workspace::new(&model));
    assert_eq!(state, restored);
}

#[test]
fn a_fibre_that_is_not_finite_is_named() {
    let model = elastic(|_| ());
    let mut state = State::new(&model);
    state.fibre_length[9] = f64::NAN;
    let fault = forward(&model, &state, &mut Workspace::new(&model)).unwrap_err();
    let text = fault.to_string();
    assert!(text.contains("fibre length") && text.contains(&model.actuators.name[9]), "{text}");
}
