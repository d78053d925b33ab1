//! A trajectory is a function of its initial state and its inputs, to the last bit: whatever ran beside it, wherever it was cut.

use crate::support;

use msk_physics::model::{Integrator, Model};
use msk_physics::{Instructions, State, Workspace, step};
use msk_runtime::bodies;
use nalgebra::Vector3;
use proptest::prelude::*;
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::OnceLock;
use support::SplitMix;

/// SHA-256 of time, positions, velocities, activations and the solver's start after one second of the 416-muscle body under
/// random excitation, falling from its reference configuration, little-endian.
///
/// Additions, multiplications, divisions and square roots are exact by IEEE 754; sines and the like come from the crate `libm`
/// (0.2, a port of musl's), compiled from source on every machine. So the hash is the same everywhere, and changes only with the
/// physics or the order of its operations: a change of either on purpose puts the new hash here, once the comparisons with
/// MuJoCo pass.
const SECOND: &str = "f28eca00f44c1ff567718fb8ea8fb93f7b9e35cc715ef42d6a15e1a11f2cce7f";

fn human() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| bodies::model(&Path::new(bodies::ROOT).join("bodies/models/human416.xml")).unwrap())
}

/// Sets the excitations of a step: new random ones every ten, a function of the seed and the step alone.
fn excite(state: &mut State<f64>, seed: u64, number: usize) {
    let mut random = SplitMix(seed ^ (number as u64 / 10).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    state.control.fill_with(|| random.unit());
}

/// Takes the steps of a range; a push acts on one body from step 15 to step 30.
fn run(model: &Model, state: &mut State<f64>, workspace: &mut Workspace<f64>, seed: u64, steps: core::ops::Range<usize>) {
    for number in steps {
        excite(state, seed, number);
        match number {
            15 => state.body_force[5] = [Vector3::new(40.0, -25.0, 10.0), Vector3::new(0.0, 3.0, 1.0)],
            30 => state.body_force[5] = [Vector3::zeros(), Vector3::zeros()],
            _ => {}
        }
        step(model, state, workspace).unwrap();
    }
}

fn bytes(state: &State<f64>) -> Vec<u8> {
    let parts = [&[state.time], state.position.as_slice(), &state.velocity, &state.activation, &state.warm_start];
    parts.concat().iter().flat_map(|value| value.to_le_bytes()).collect()
}

#[test]
fn a_second_of_the_body_has_always_the_same_bits() {
    let model = human();
    for instructions in [Instructions::Widest, Instructions::Wide, Instructions::Baseline] {
        let (mut state, mut workspace) = (State::new(model), Workspace::new(model).with_instructions(instructions));
        for number in 0..1000 {
            excite(&mut state, 2024, number);
            step(model, &mut state, &mut workspace).unwrap();
        }
        let hash: String = Sha256::digest(bytes(&state)).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hash, SECOND, "{instructions:?}");
    }
}

#[test]
fn one_thread_and_four_give_the_same_bits() {
    const EPISODES: u64 = 8;
    let model = human();
    let play = |workspace: &mut Workspace<f64>, seed: u64| {
        let mut state = State::new(model);
        run(model, &mut state, workspace, seed, 0..60);
        bytes(&state)
    };
    let mut workspace = Workspace::new(model);
    let serial: Vec<_> = (0..EPISODES).map(|seed| play(&mut workspace, seed)).collect();
    let workers: Vec<_> = std::thread::scope(|scope| {
        let worker = |first: u64| {
            // Every worker keeps its memory over its episodes and takes them from the last to the first.
            let mut workspace = Workspace::new(model);
            let mine: Vec<u64> = (0..EPISODES).rev().filter(|seed| seed % 4 == first).collect();
            mine.into_iter().map(|seed| (seed, play(&mut workspace, seed))).collect::<Vec<_>>()
        };
        let handles: Vec<_> = (0..4).map(|first| scope.spawn(move || worker(first))).collect();
        handles.into_iter().flat_map(|handle| handle.join().unwrap()).collect()
    });
    assert_eq!(workers.len(), serial.len());
    for (seed, parallel) in workers {
        assert!(parallel == serial[seed as usize], "episode {seed} differs");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Cut anywhere, before, in and after a push, and continued in memory that something else has used.
    #[test]
    fn a_snapshot_at_any_step_continues_with_the_same_bits(
        cut in 0..40_usize,
        integrator in prop::sample::select(vec![Integrator::Euler, Integrator::Implicit, Integrator::RungeKutta]),
        seed in any::<u64>(),
    ) {
        let mut model = human().clone();
        model.options.integrator = integrator;
        let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
        run(&model, &mut state, &mut workspace, seed, 0..cut);
        let snapshot = state.clone();
        run(&model, &mut state, &mut workspace, seed, cut..40);

        let mut other = State::new(&model);
        other.position[2] += 1.0;
        run(&model, &mut other, &mut workspace, !seed, 0..3);
        let mut restored = snapshot;
        run(&model, &mut restored, &mut workspace, seed, cut..40);
        prop_assert!(bytes(&state) == bytes(&restored), "differs when cut at step {}", cut);
    }
}
