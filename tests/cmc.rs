//! The whole chain on the real task: text, compiler, body, physics, policy, success.

use msk_compiler::compile;
use msk_evaluate::{self as evaluate, EpisodeRecord, Trial};
use msk_runtime::{
    episode::{Environment, EpisodeKey},
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
    Trial::new(task, body)
}

/// The first episode of seed 0.
fn play(trial: &Trial, policy: &str) -> EpisodeRecord {
    let mut policy = policy::create(policy).unwrap();
    let key = EpisodeKey { seed: 0, episode: 0 };
    let never = AtomicBool::new(false);
    evaluate::play(trial, &mut trial.episode().unwrap(), key, policy.as_mut(), &never, || {}).unwrap().unwrap()
}

#[test]
fn cmc_stands_for_the_whole_task_and_rest_falls() {
    let trial = trial("stand");
    for policy in ["cmc", "cmc smooth"] {
        let standing = play(&trial, policy);
        assert!(standing.success, "{standing:?}");
        assert_eq!((standing.policy.as_str(), standing.steps), (policy, trial.task.horizon));
        // Of 50 per step at most.
        let reward = standing.total / f64::from(standing.steps);
        assert!(reward > 46.0, "{policy}, {reward} per step: {standing:?}");
    }

    let falling = play(&trial, "zero");
    assert!(!falling.success && falling.steps < 200, "{falling:?}");
}

/// How far hips, knees and ankles are from where the reference has them, and how far they would be in the initial pose:
/// rad, root mean square.
fn errors(episode: &Environment, begun: f64) -> [f64; 2] {
    let context = episode.context();
    let (followed, time) = context.task.followed(context.progress).unwrap();
    let legs = ["hip_flexion", "knee_angle", "ankle_angle"];
    let named = |name: &str| legs.iter().any(|leg| name.starts_with(leg));
    let columns = context.body.joints.iter().filter(|joint| joint.independent && named(&joint.name));
    let errors: Vec<[f64; 2]> = columns
        .map(|joint| {
            let column = followed.motion.joint(&joint.name).unwrap();
            let wanted = followed.motion.value(column, time);
            [context.state.position[joint.position] - wanted, followed.motion.value(column, begun) - wanted]
        })
        .collect();
    assert_eq!(errors.len(), 6);
    [0, 1].map(|which| (errors.iter().map(|pair| pair[which].powi(2)).sum::<f64>() / 6.0).sqrt())
}

#[test]
fn cmc_follows_the_reference_of_the_task() {
    let trial = trial("walk");
    let mut policy = policy::create("cmc").unwrap();
    let mut episode = trial.episode().unwrap();
    policy.reset(&episode.context()).unwrap();
    let (_, begun) = episode.task().followed(episode.context().progress).unwrap();
    let mut action = vec![0.0; episode.context().body.muscles.len()];
    let mut sums = [0.0; 2];
    for _ in 0..40 {
        policy.act(&episode.context(), &mut action).unwrap();
        episode.step(&action).unwrap();
        let errors = errors(&episode, begun);
        sums = [sums[0] + errors[0], sums[1] + errors[1]];
    }
    assert!(sums[0] < 0.5 * sums[1], "off by {} rad, {} in the pose of the beginning", sums[0] / 40.0, sums[1] / 40.0);
}

/// Takes so many control steps under the demonstration, and tells where the root is after each, m.
fn demonstrate(episode: &mut Environment, steps: usize) -> Vec<[f64; 3]> {
    let mut policy = policy::create("demonstration").unwrap();
    policy.reset(&episode.context()).unwrap();
    let mut action = vec![0.0; episode.context().body.muscles.len()];
    let take = |_| {
        policy.act(&episode.context(), &mut action).unwrap();
        episode.step(&action).unwrap();
        root(episode)
    };
    (0..steps).map(take).collect()
}

fn root(episode: &Environment) -> [f64; 3] {
    let context = episode.context();
    let place = context.body.root.free.unwrap().0;
    [0, 1, 2].map(|axis| context.state.position[place + axis])
}

#[test]
fn the_demonstration_follows_the_script_of_the_tests() {
    let mut episode = trial("squat").episode().unwrap();
    demonstrate(&mut episode, 100);
    // The script bends hips and knees by 86 degrees within two seconds.
    let context = episode.context();
    for (name, half) in [("hip_flexion_r", 43.0), ("knee_angle_l", 43.0)] {
        let joint = context.body.joints.iter().find(|joint| joint.name == name).unwrap();
        let angle = context.state.position[joint.position].to_degrees();
        assert!((angle - half).abs() < 15.0, "{name}: {angle} deg at half of the way");
    }
}

#[test]
fn physics_goes_on_past_the_ends_of_a_task() {
    let trial = trial("reach");
    let mut policy = policy::create("zero").unwrap();
    let mut episode = trial.episode().unwrap();
    let found = evaluate::play_to_horizon(&mut episode, EpisodeKey::default(), policy.as_mut(), &mut |_| {}).unwrap();
    assert!(found.first.as_ref().is_some_and(|(steps, _)| *steps < 200), "{found:?}");
    assert_eq!((found.steps, &found.fault), (trial.task.horizon, &None));
    assert!(found.deepest < 0.02 && found.fastest < 6.0, "{found:?}");
}

#[test]
fn a_body_whose_hands_are_welded_to_a_bar_pulls_itself_up_and_hangs_still() {
    let mut episode = trial("chin_up").episode().unwrap();
    let begun = root(&episode);
    let way = demonstrate(&mut episode, 400);
    let risen = way[49][2] - begun[2];
    assert!(risen > 0.4, "by {risen} m in a second");
    // Muscles are at their limit. When its height came first, it swung further and further, by half a metre in the end.
    let late = || way[200..].iter().map(|place| place[0]);
    let swing = late().fold(f64::NEG_INFINITY, f64::max) - late().fold(f64::INFINITY, f64::min);
    assert!(swing < 0.12, "by {swing} m");
}
