//! What a policy and a critic see: channels that are scaled, clipped, noisy, delayed and remembered.

use crate::episodes::{KEY, advance, episode, read_again};
use msk::runtime::episode::{Environment, VectorEnvironment};
use std::num::NonZeroUsize;

/// The usual task with other channels.
fn observing(channels: &str) -> Environment {
    let observe = format!("observe {{ {channels} }}");
    let still = [(", velocity [0.2 m/s, 0, 0]", ""), ("noise velocities normal(0, 0.3 rad/s)", "")];
    let mut parts = vec![("observe { com.acceleration; prev(pelvis.height); independent.q }", observe.as_str())];
    parts.extend_from_slice(&still);
    let mut environment = episode(&parts);
    environment.reset(KEY);
    environment
}

/// The observations of the reset and of some steps.
fn seen(environment: &mut Environment, steps: usize) -> Vec<Vec<f64>> {
    let mut rows = vec![environment.observation().to_vec()];
    for _ in 0..steps {
        advance(environment, 1);
        rows.push(environment.observation().to_vec());
    }
    rows
}

#[test]
fn a_channel_is_scaled_clipped_delayed_and_remembered_in_the_order_of_its_settings() {
    let mut environment = observing(
        "pelvis.height; a = pelvis.height scale 2 m clip 0.4 .. 0.45; b = pelvis.height delay 2 steps; c = pelvis.height history 3; d = pelvis.height delay 1 steps history 2",
    );
    let rows = seen(&mut environment, 5);
    let height = |step: usize, ago: usize| rows[step.saturating_sub(ago)][0];
    for (step, row) in rows.iter().enumerate() {
        let expected = [
            height(step, 0),
            (height(step, 0) / 2.0).clamp(0.4, 0.45),
            height(step, 2),
            height(step, 0),
            height(step, 1),
            height(step, 2),
            height(step, 1),
            height(step, 2),
        ];
        assert_eq!(*row, expected, "step {step}");
    }
}

#[test]
fn noise_of_a_channel_is_drawn_anew_at_every_step_from_a_stream_of_its_own() {
    let channels =
        "pelvis.height; a = pelvis.height noise normal(0, 1 cm); b = pelvis.height noise uniform(1 cm .. 3 cm) delay 1 steps";
    let mut environment = observing(channels);
    let rows = seen(&mut environment, 10);
    let normal: Vec<f64> = rows.iter().map(|row| row[1] - row[0]).collect();
    assert!(normal.iter().all(|noise| *noise != 0.0 && noise.abs() < 0.05), "{normal:?}");
    assert!(normal.windows(2).all(|pair| pair[0] != pair[1]), "{normal:?}");
    // What was seen a step ago, with the noise that it had then; the first value stands for those before it.
    let uniform: Vec<f64> = rows.iter().zip(&rows[1..]).map(|(before, row)| row[2] - before[0]).collect();
    assert!(uniform.iter().all(|noise| (0.01..0.03).contains(noise)), "{uniform:?}");
    assert!(uniform.windows(2).all(|pair| pair[0] != pair[1]), "{uniform:?}");

    // Another channel does not change what is drawn for this one.
    let mut alone = observing("pelvis.height; a = pelvis.height noise normal(0, 1 cm)");
    let again = seen(&mut alone, 10);
    assert!(again.iter().zip(&rows).all(|(row, other)| row[1] == other[1]));
    assert_eq!(environment.task().randoms.iter().map(|random| random.name.as_str()).collect::<Vec<_>>(), ["a.noise", "b.noise"]);
    assert_eq!(environment.task().randoms[0].source, "normal(0, 1 cm)");
}

#[test]
fn settings_behind_an_observation_apply_to_each_of_its_channels() {
    let observation = "observation place { pelvis.height; com.height scale 2 m }\ntask balance {";
    let observe = "observe { low = pelvis.height; middle = com.height; place delay 1 steps }";
    let parts = [("task balance {", observation), ("observe { com.acceleration; prev(pelvis.height); independent.q }", observe)];
    let mut environment = episode(&parts);
    environment.reset(KEY);
    let rows = seen(&mut environment, 3);
    for step in 1..rows.len() {
        assert_eq!(rows[step][2..], [rows[step - 1][0], rows[step - 1][1] / 2.0], "step {step}");
    }
}

#[test]
fn an_episode_with_noise_and_delays_continues_from_a_snapshot() {
    let channels = "a = pelvis.height noise normal(0, 1 cm) delay 2 steps history 2";
    let mut environment = observing(channels);
    advance(&mut environment, 3);
    let kept = environment.snapshot();
    let expected = seen(&mut environment, 4);
    let mut other = observing(channels);
    other.restore(&kept);
    assert_eq!(seen(&mut other, 4), expected);
}

/// Policies and observations are as without it.
#[test]
fn a_critic_sees_more_beside_the_observation() {
    let critic = "critic { height = pelvis.height; com.velocity; fixed = 3 }\n    observe {";
    let (mut plain, mut environment) = (episode(&[]), episode(&[("observe {", critic)]));
    assert_eq!(environment.engine().task().critic_size(), 5);
    assert!(plain.critic_observation().is_empty());
    for environment in [&mut plain, &mut environment] {
        environment.reset(KEY);
        advance(environment, 3);
    }
    assert_eq!(plain.observation(), environment.observation());
    let seen = environment.critic_observation();
    let height = environment.context().state.position[2];
    assert!((seen[0] - height).abs() < 0.2 && seen[4] == 3.0, "{seen:?} at {height}");
    let read = read_again(&environment.snapshot());
    assert_eq!(read.critic_observation(), seen);
    assert!(environment.engine().accepts(&read));

    let count = NonZeroUsize::new(3).unwrap();
    let mut vector = VectorEnvironment::new(environment.engine().clone(), count, NonZeroUsize::MIN).unwrap();
    let step = vector.reset_to(&[None, Some(KEY), None]).clone();
    let mut alone = Environment::of(environment.engine().clone());
    alone.reset(KEY);
    assert_eq!(step.critic_observations[5..10], *alone.critic_observation());
}
