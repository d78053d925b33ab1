//! What a learner sets while it trains: how far it is, which scheduled weights follow, and the parameters
//! of episodes; and what it values after their end.

use crate::episodes::{KEY, episode};
use msk::runtime::episode::{Ending, Environment, EpisodeError, EpisodeKey, Fault, VectorEnvironment};
use std::num::NonZeroUsize;

/// Takes a step at rest; gives the reward and the weight of `upright`.
fn stepped(environment: &mut Environment) -> (f64, f64) {
    environment.reset(KEY);
    environment.step(&vec![-1.0; environment.engine().action_size()][..]).unwrap();
    (environment.reward().total(), environment.reward().term("upright").unwrap().weight)
}

#[test]
fn scheduled_weights_follow_the_progress_of_a_training() {
    let mut scheduled = episode(&[("2 upright", "10 -> 2 over 20 % .. 60 % upright")]);
    let mut plain = episode(&[]);
    // Without a training the last weight holds, to the bit.
    assert_eq!((scheduled.progress(), stepped(&mut scheduled)), (1.0, stepped(&mut plain)));
    for (progress, weight) in [(0.0, 10.0), (0.2, 10.0), (0.3, 8.0), (0.4, 6.0), (0.6, 2.0), (1.0, 2.0)] {
        scheduled.set_progress(progress).unwrap();
        plain.set_weight(0, weight);
        let (found, expected) = (stepped(&mut scheduled), stepped(&mut plain));
        assert!((found.1 - weight).abs() < 1e-14, "{found:?} at {progress}");
        assert!((found.0 - expected.0).abs() < 1e-13, "{found:?}, {expected:?}");
        assert_eq!(scheduled.context().weights, scheduled.weights());
    }
}

#[test]
fn the_last_weight_is_the_one_that_is_set() {
    let mut scheduled = episode(&[("2 upright", "10 -> 2 over 40 % upright")]);
    scheduled.set_progress(0.2).unwrap();
    assert_eq!((scheduled.weights()[0], scheduled.last_weights()[0]), (6.0, 2.0));
    scheduled.set_weight(0, 4.0);
    assert_eq!((scheduled.weights()[0], scheduled.last_weights()[0]), (7.0, 4.0));
    // Settings, and no part of a snapshot.
    let snapshot = scheduled.snapshot();
    scheduled.set_progress(1.0).unwrap();
    scheduled.restore(&snapshot);
    assert_eq!(scheduled.weights()[0], 4.0);
}

#[test]
fn the_progress_of_a_training_is_a_share_of_it() {
    let mut scheduled = episode(&[]);
    for wrong in [-0.1, 1.5, f64::NAN, f64::INFINITY] {
        let error = scheduled.set_progress(wrong).unwrap_err();
        assert!(matches!(error, EpisodeError::Progress { .. }));
        assert_eq!(error.to_string(), format!("the progress of a training is a number from 0 to 1, found {wrong}"));
    }
    assert_eq!(scheduled.progress(), 1.0);
}

#[test]
fn all_slots_of_a_vector_have_the_same_progress() {
    let mut alone = episode(&[("2 upright", "10 -> 2 over 40 % upright")]);
    let (count, one) = (NonZeroUsize::new(3).unwrap(), NonZeroUsize::MIN);
    let mut vector = VectorEnvironment::new(alone.engine().clone(), count, one).unwrap();
    vector.set_progress(0.1).unwrap();
    alone.set_progress(0.1).unwrap();
    assert_eq!((vector.progress(), vector.weights(2), vector.weights(3)), (0.1, Some(alone.weights()), None));
    assert_eq!(vector.last_weights(1), Some(&[2.0, 3.0][..]));
    vector.reset_to(&[Some(KEY); 3]);
    let action = vec![-1.0; 3 * alone.engine().action_size()];
    let rewards = vector.step(&action).unwrap().rewards.clone();
    assert_eq!(rewards, [stepped(&mut alone).0; 3]);
    assert!(vector.set_progress(2.0).is_err());
    assert_eq!(vector.progress(), 0.1);
}

/// A speed and a load that episodes may have of their own, and a constant.
const OPEN: &[(&str, &str)] = &[
    (
        "    init {\n        pose neutral\n        root { height on ground, velocity [0.2 m/s, 0, 0] }",
        "    params {
        speed = 0.5 m/s (0.1..2 m/s) per episode
        load  = 5 kg (1..20 kg) per episode
        laps  = 2 (1..4) per episode
        lean  = 5 deg (0..20 deg)
    }
    random there = uniform(0.5 m .. speed * 1 s + 1 m)
    scene { ground; box pack on torso { size [15 cm, 30 cm, 40 cm], at [-20 cm, 0, 0], mass load, solid false } }
    init {
        pose neutral { lumbar_extension = lean }
        root { height on ground, velocity [speed, 0, 0] }",
    ),
    ("observe {", "observe { speed; pack.mass; laps; there;"),
];

/// The first numbers of the observation: speed, mass, count, and what is drawn.
fn seen(environment: &Environment) -> [f64; 4] {
    core::array::from_fn(|index| environment.observation()[index])
}

#[test]
fn parameters_change_from_episode_to_episode_without_compiling() {
    let mut environment = episode(OPEN);
    environment.reset(KEY);
    let [speed, mass, count, there] = seen(&environment);
    assert_eq!([speed, mass, count], [0.5, 5.0, 2.0], "as in the text");
    assert_eq!(environment.parameters()[..3], [0.5, 5.0, 2.0]);
    environment.set_parameter("speed", 1.5).unwrap();
    environment.set_parameter("load", 12.0).unwrap();
    assert_eq!(seen(&environment), [speed, mass, count, there], "from the next reset on");
    environment.reset(KEY);
    let [fast, heavy, same, farther] = seen(&environment);
    assert_eq!([fast, heavy, same], [1.5, 12.0, 2.0]);
    assert_eq!(environment.episode().parameters()[..3], [1.5, 12.0, 2.0]);
    // The same random number, of a wider range.
    assert!(((farther - 0.5) / 2.0 - (there - 0.5)).abs() < 1e-12, "{there} {farther}");
    assert!(environment.state().velocity[0] > 1.0);
    // They hold until others are set, and an episode is the same with them, whatever was played before.
    let begun = environment.snapshot();
    environment.set_parameter("speed", 0.2).unwrap();
    environment.reset(EpisodeKey { seed: 1, episode: 1 });
    environment.set_parameter("speed", 1.5).unwrap();
    environment.reset(KEY);
    assert!(environment.snapshot() == begun);
}

#[test]
fn a_task_compiled_with_a_value_plays_as_one_that_is_given_it() {
    let mut given = episode(OPEN);
    let text = OPEN[0].1.replace("speed = 0.5 m/s", "speed = 1.5 m/s").replace("load  = 5 kg", "load  = 12 kg");
    let mut compiled = episode(&[(OPEN[0].0, text.as_str()), OPEN[1]]);
    given.set_parameter("speed", 1.5).unwrap();
    given.set_parameter("load", 12.0).unwrap();
    let action = vec![-0.8; given.engine().action_size()];
    let [first, second] = [&mut given, &mut compiled].map(|environment| {
        environment.reset(KEY);
        (0..5).for_each(|_| environment.step(&action[..]).map(|_| ()).unwrap());
        (environment.state().clone(), environment.observation().to_vec(), environment.reward().total())
    });
    assert!(first == second);
}

#[test]
fn what_an_episode_cannot_have_is_refused_with_its_reason() {
    let mut environment = episode(OPEN);
    let mut refused = |name: &str, value: f64| environment.set_parameter(name, value).unwrap_err().to_string();
    assert_eq!(refused("sped", 1.0), "the task `balance` has no parameter `sped`; did you mean `speed`?");
    assert_eq!(refused("mass", 1.0), "the task `balance` has no parameter `mass`; per episode it has speed, load, laps");
    assert_eq!(
        refused("lean", 0.1),
        "the parameter `lean` is a constant of the compiled task: compile the task again with another value, or declare it `per episode`"
    );
    assert_eq!(refused("speed", 3.0), "the parameter `speed` is 3; expected a number from 0.1 to 2, in SI units");
    assert_eq!(refused("load", f64::NAN), "the parameter `load` is NaN; expected a number from 1 to 20, in SI units");
    assert_eq!(refused("laps", 2.5), "the parameter `laps` is 2.5; expected a whole number from 1 to 4, in SI units");
    let none = episode(&[]).set_parameter("speed", 1.0).unwrap_err().to_string();
    assert_eq!(none, "the task `balance` has no parameter `speed`; no parameter of it is declared `per episode`");
    // Values that come from elsewhere end the episode, and no other.
    let engine = environment.engine().clone();
    let (mut played, mut scratch) = (engine.episode(), engine.scratch());
    for (values, wrong) in [(vec![1.0], "1 values of parameters"), (vec![0.5, 30.0, 2.0, 0.0], "`load` is 30")] {
        engine.reset_with(KEY, &values, &mut played, &mut scratch);
        let Some(Ending::Fault(fault @ Fault::Parameter(_))) = played.ending() else { panic!("{:?}", played.ending()) };
        assert!(fault.to_string().contains(wrong), "{fault}");
    }
    engine.reset(KEY, &mut played, &mut scratch);
    assert_eq!(played.ending(), None);
}

#[test]
fn the_slots_of_a_vector_have_parameters_of_their_own() {
    let mut alone = episode(OPEN);
    let (count, one) = (NonZeroUsize::new(3).unwrap(), NonZeroUsize::MIN);
    let mut vector = VectorEnvironment::new(alone.engine().clone(), count, one).unwrap();
    let speeds = [0.3, 0.9, 1.8];
    for (slot, speed) in speeds.into_iter().enumerate() {
        vector.set_parameter(slot, "speed", speed).unwrap();
        assert_eq!(vector.parameters(slot).unwrap()[0], speed);
    }
    vector.reset_to(&[Some(KEY); 3]);
    let action = vec![-0.8; 3 * alone.engine().action_size()];
    let step = (0..4).map(|_| vector.step(&action).unwrap().clone()).last().unwrap();
    for (slot, speed) in speeds.into_iter().enumerate() {
        alone.set_parameter("speed", speed).unwrap();
        alone.reset(KEY);
        (0..4).for_each(|_| alone.step(&action[..alone.engine().action_size()]).map(|_| ()).unwrap());
        let width = alone.observation().len();
        assert_eq!(step.observations[width * slot..width * (slot + 1)], *alone.observation());
    }
}

#[test]
fn an_episode_goes_on_with_its_parameters_after_it_was_written() {
    let mut environment = episode(OPEN);
    environment.set_parameter("load", 12.0).unwrap();
    environment.reset(KEY);
    let text = serde_json::to_string(&environment.snapshot()).unwrap();
    let mut other = episode(OPEN);
    let read = serde_json::from_str(&text).unwrap();
    assert!(other.engine().accepts(&read));
    other.restore(&read);
    let action = vec![-0.8; environment.engine().action_size()];
    for environment in [&mut environment, &mut other] {
        (0..4).for_each(|_| environment.step(&action[..]).map(|_| ()).unwrap());
    }
    assert!(environment.snapshot() == other.snapshot());
    let wrong = serde_json::from_str(&text.replace("12.0", "120.0")).unwrap();
    assert!(!other.engine().accepts(&wrong), "a parameter outside of its range");
}

/// Ends after some steps, by reasons of which some bootstrap.
fn finishing(reasons: &str) -> Environment {
    episode(&[("    success survived", &format!("    finish {{ {reasons} }}\n    success survived"))])
}

#[test]
fn a_learner_bootstraps_where_the_task_says_so() {
    let ends = [
        ("done when step >= 2", [true, false]),
        ("done bootstrap when step >= 2", [false, true]),
        ("done bootstrap when step >= 2; far bootstrap when step == 2", [false, true]),
        // One of the reasons that hold at once ends all value.
        ("done bootstrap when step >= 2; over when step >= 2", [true, false]),
        ("done bootstrap when step >= 2; over when step >= 3", [false, true]),
        // The horizon.
        ("never when step >= 50", [false, true]),
    ];
    for (reasons, expected) in ends {
        let mut alone = finishing(reasons);
        let action = vec![-1.0; alone.engine().action_size()];
        alone.reset(KEY);
        while alone.ending().is_none() {
            alone.step(&action[..]).unwrap();
        }
        assert_eq!(alone.ending().map(|ending| ending.bootstraps(alone.task())), Some(expected[1]), "{reasons}");
        let mut vector = VectorEnvironment::new(alone.engine().clone(), NonZeroUsize::MIN, NonZeroUsize::MIN).unwrap();
        vector.reset_to(&[Some(KEY)]);
        while !vector.step(&action).unwrap().ended[0] {}
        assert_eq!([vector.last().terminated[0], vector.last().truncated[0]], expected, "{reasons}");
    }
}
