//! The whole chain on the real task: text, compiler, body, physics, policy, success.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use msk_compiler::compile;
use msk_runtime::{
    episode::EpisodeKey,
    evaluate::{self, EpisodeRecord, Trial},
    library::{BodyLibrary, FileLoader},
    policy,
};
use std::{path::Path, sync::atomic::AtomicBool};

/// The task `name` of the suite, with its body.
fn trial(name: &str) -> Trial {
    let library = BodyLibrary::default();
    let suite = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks.msk");
    let compilation = compile(&suite, &FileLoader, &library).unwrap_or_else(|report| panic!("{report:?}"));
    let task = compilation.tasks.into_iter().find(|task| task.name == name).unwrap();
    let body = library.stage(&task.body, &task.scene).unwrap();
    Trial { task, body }
}

/// The first episode of seed 0.
fn play(trial: &Trial, policy: &str) -> EpisodeRecord {
    let mut policy = policy::create(policy).unwrap();
    let key = EpisodeKey { seed: 0, episode: 0 };
    let never = AtomicBool::new(false);
    evaluate::play(trial, &mut trial.episode().unwrap(), key, policy.as_mut(), &never, || {}).unwrap().unwrap()
}

#[test]
fn posture_stands_for_the_whole_task_and_rest_falls() {
    let trial = trial("stand");
    let standing = play(&trial, "posture");
    assert!(standing.success, "{standing:?}");
    assert_eq!(standing.steps, trial.task.horizon);
    // Of 50 that could be paid per step.
    let pay = standing.total / f64::from(standing.steps);
    assert!(pay > 46.0, "{pay} per step: {standing:?}");

    let falling = play(&trial, "zero");
    assert!(!falling.success && falling.steps < 200, "{falling:?}");
}
