//! Actions that last for several control steps.

use super::{STOP, engine, small, training};
use msk_runtime::episode::{Environment, EpisodeKey};
use msk_train::{Algorithm, Settings, source};
use std::sync::atomic::AtomicBool;
use tempfile::tempdir;

/// The 60 control steps of an episode are no multiple of it.
const REPEAT: usize = 7;

fn repeating(algorithm: Algorithm) -> Settings {
    Settings { action_repeat: REPEAT, ..small(algorithm) }
}

#[test]
fn an_agent_repeats_its_actions_wherever_it_acts() {
    let engine = engine(&[]);
    let mut trained = training(&engine, &repeating(Algorithm::Ppo), 1);
    trained.round().unwrap();
    let agent = trained.agent();
    let folder = tempdir().unwrap();
    agent.save(folder.path()).unwrap();

    let (stop, mut environment) = (AtomicBool::new(false), Environment::of(engine.clone()));
    let source = source(&format!("agent {}", folder.path().display())).unwrap().unwrap();
    let (mut policy, mut total) = (source.open(&stop).unwrap(), 0.0);
    let evaluation = trained.evaluate(&agent, &STOP).unwrap().unwrap();
    for episode in 0..evaluation.episodes as u64 {
        // The seed of evaluations.
        environment.reset(EpisodeKey { seed: 7 ^ 0x6576_616C, episode });
        policy.reset(&environment.context()).unwrap();
        let mut actions = Vec::new();
        while environment.ending().is_none() {
            let mut action = [0.0];
            policy.act(&environment.context(), &mut action).unwrap();
            actions.push(action[0]);
            environment.step(&action).unwrap();
        }
        assert!(actions.chunks(REPEAT).all(|chosen| chosen.iter().all(|action| *action == chosen[0])), "{actions:?}");
        assert!(actions.chunks(REPEAT).zip(actions.chunks(REPEAT).skip(1)).any(|(one, next)| one[0] != next[0]));
        total += environment.episode().total();
    }
    assert_eq!(total / evaluation.episodes as f64, evaluation.total, "evaluations repeat, too");
}

#[test]
fn steps_are_control_steps_and_every_episode_begins_with_an_action_of_its_own() {
    let engine = engine(&[("over when swing.q > 2 rad", "over when swing.q > 2000 rad")]);
    for (algorithm, actions) in [(Algorithm::Ppo, 40), (Algorithm::Sac, 128), (Algorithm::Mpo, 128)] {
        let mut training = training(&engine, &repeating(algorithm), 1);
        let round = training.round().unwrap();
        assert_eq!(round.step, (actions * REPEAT * 3) as u64, "{algorithm:?}");
        // What is left of an action at the end of an episode is not played.
        let horizon = u64::from(engine.task().horizon);
        let whole = horizon.div_ceil(REPEAT as u64) as usize;
        assert_eq!(round.ends.len(), actions / whole * 3, "{algorithm:?}");
        assert!(round.ends.iter().all(|end| u64::from(end.steps) == horizon), "{algorithm:?}");
    }
}

#[test]
fn rewards_of_an_action_are_summed_up() {
    let engine = engine(&[]);
    let round = |repeat: usize| {
        let settings = Settings { action_repeat: repeat, normalize_rewards: false, ..small(Algorithm::Sac) };
        let mut training = training(&engine, &settings, 1);
        while training.step() < 2_000 {
            training.round().unwrap();
        }
        training.round().unwrap().losses.into_iter().find(|(name, _)| *name == "critics").unwrap().1
    };
    // Errors of values of sums over ten steps are much greater than those of single steps.
    assert!(round(10) > 5.0 * round(1), "{} {}", round(10), round(1));
}

#[test]
fn imitation_answers_every_control_step() {
    let message = Settings::read("algorithm = \"clone\"\naction_repeat = 2").unwrap_err().to_string();
    assert_eq!(message, "line 2: `action_repeat` is 2; expected 1, because a teacher answers every control step");
}
