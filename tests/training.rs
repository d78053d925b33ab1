//! What a learner sets while it trains: how far it is, which scheduled weights follow.

use crate::episodes::episode;
use msk::runtime::episode::{Environment, EpisodeError, EpisodeKey, VectorEnvironment};
use std::num::NonZeroUsize;

const KEY: EpisodeKey = EpisodeKey { seed: 4, episode: 2 };

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
