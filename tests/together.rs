//! Episodes of tasks in the lanes of the simulator: each comes to the bits that it comes to alone.

use super::episodes::episode;
use super::randomization::DRAWN;
use msk::compiler::compile;
use msk::physics::model::ElasticTendons;
use msk::runtime::episode::{AutoresetMode, Ending, Engine, Environment, Episode, EpisodeKey, Stream, VectorEnvironment};
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::num::NonZeroUsize;
use std::path::Path;

const SEED: u64 = 3;

fn key(episode: usize) -> EpisodeKey {
    EpisodeKey { seed: SEED, episode: episode as u64 }
}

/// The actions of an episode at a step, in any lane.
fn action(episode: EpisodeKey, step: u32, into: &mut [f64]) {
    let mut chance = Stream::new(episode, "actions");
    chance.skip(u128::from(step) * into.len() as u128);
    into.fill_with(|| 2.0 * chance.uniform() - 1.0);
}

/// Plays `slots` episodes side by side for `steps` control steps; those that end give way to the next.
fn side_by_side(engine: &Engine, slots: usize, threads: usize, steps: usize) -> (Vec<Episode>, usize) {
    let [count, threads] = [slots, threads].map(|number| NonZeroUsize::new(number).unwrap());
    let mut environment = VectorEnvironment::new(engine.clone(), count, threads).unwrap().with_autoreset(AutoresetMode::SameStep);
    environment.reset(SEED);
    let width = engine.action_size();
    let (mut actions, mut ends) = (vec![0.0; slots * width], 0);
    for _ in 0..steps {
        for (episode, action_of) in environment.episodes().zip(actions.chunks_mut(width)) {
            action(episode.key(), episode.steps(), action_of);
        }
        ends += environment.step(&actions).unwrap().ends.len();
    }
    (environment.episodes().cloned().collect(), ends)
}

/// The same episode alone, up to as many steps.
fn alone(environment: &mut Environment, key: EpisodeKey, steps: u32) -> Episode {
    environment.reset(key);
    let mut taken = vec![0.0; environment.engine().action_size()];
    while environment.steps() < steps {
        action(key, environment.steps(), &mut taken);
        environment.step(&taken).unwrap();
    }
    environment.snapshot()
}

fn check(name: &str, engine: &Engine, slots: usize, threads: usize, steps: usize) -> usize {
    let (episodes, ends) = side_by_side(engine, slots, threads, steps);
    let mut environment = Environment::of(engine.clone());
    for found in &episodes {
        let expected = alone(&mut environment, found.key(), found.steps());
        assert!(*found == expected, "{name}: episode {} after {} steps", found.key().episode, found.steps());
    }
    ends
}

/// Contacts with terrain and objects, things held and let go, all of it in five lanes.
#[test]
fn an_episode_of_any_task_has_the_same_bits_in_a_lane_and_alone() {
    let bodies = BodyLibrary::default();
    for file in ["tasks.msk", "examples/door.msk", "examples/10_pushes.msk"] {
        let compilation = compile(Path::new(file), &FileLoader, &bodies).unwrap();
        for task in &compilation.tasks {
            let stage = bodies.stage(&task.body, &task.scene).unwrap();
            // The door is pushed after a fifth of a second, the trunk within one.
            let seconds = if file == "examples/door.msk" { 0.35 } else { 1.2 };
            let steps = if file == "tasks.msk" { 4 } else { (seconds * task.control_frequency) as usize };
            let engine = Engine::new(stage.model, stage.body, task.clone()).unwrap();
            check(&task.name, &engine, 5, 1, steps);
        }
    }
}

/// Controllers look at the forward pass of their own episode, also where a worker has more episodes than lanes.
#[test]
fn an_episode_of_any_action_space_has_the_same_bits_in_a_lane_and_alone() {
    for act in [
        "act muscles { of [calves], filter 40 ms, latency 2 steps }",
        "act synergies { of [calves, quadriceps], sides, residual cmc }",
        "act torque { joints [knees], range 50 N*m }",
        "act cmc { joints [legs], range 0.3 rad, com 5 cm, root 10 deg }",
    ] {
        let control = format!("control 100 Hz\n    {act}");
        let engine = episode(&[("control 100 Hz", control.as_str())]).engine().clone();
        check(act, &engine, 10, 1, 4);
        check(act, &engine, 5, 2, 14);
    }
}

/// Masses, strengths, frictions and places of their own.
#[test]
fn an_episode_of_a_randomized_task_has_the_same_bits_in_a_lane_and_alone() {
    let engine = episode(DRAWN).engine().clone();
    check("randomized", &engine, 10, 1, 4);
    check("randomized", &engine, 7, 2, 12);
}

#[test]
fn episodes_that_end_at_different_times_have_the_same_bits_on_any_number_of_threads() {
    let parts = [("early when step > 100", "early when com.velocity.z < -0.05 m/s"), ("horizon 12 steps", "horizon 9 steps")];
    let engine = episode(&parts).engine().clone();
    for (slots, threads) in [(13, 1), (16, 2), (20, 3)] {
        let ends = check("balance", &engine, slots, threads, 14);
        assert!(ends > slots, "{ends} episodes ended");
    }
}

#[test]
fn an_episode_that_is_restored_goes_on_in_its_lane() {
    let engine = episode(&[]).engine().clone();
    let (episodes, _) = side_by_side(&engine, 8, 1, 5);
    let count = NonZeroUsize::new(8).unwrap();
    let mut environment = VectorEnvironment::new(engine.clone(), count, NonZeroUsize::MIN).unwrap();
    for (slot, episode) in episodes.iter().enumerate() {
        environment.restore(slot, episode);
    }
    let width = engine.action_size();
    let mut actions = vec![0.0; 8 * width];
    for (episode, action_of) in episodes.iter().zip(actions.chunks_mut(width)) {
        action(episode.key(), episode.steps(), action_of);
    }
    environment.step(&actions).unwrap();
    let mut single = Environment::of(engine);
    for found in environment.episodes() {
        assert!(*found == alone(&mut single, found.key(), 6));
    }
}

#[test]
fn a_fault_in_one_lane_ends_its_episode_alone() {
    let engine = episode(&[]).engine().clone();
    let count = NonZeroUsize::new(8).unwrap();
    let mut environment = VectorEnvironment::new(engine.clone(), count, NonZeroUsize::MIN).unwrap();
    environment.reset(SEED);
    // The fourth turns so fast that the physics gives up.
    let mut thrown = environment.episodes().nth(3).unwrap().clone();
    let mut single = Environment::of(engine.clone());
    single.restore(&thrown);
    single.reset_to(thrown.key(), &mut |state| state.velocity.fill(5e3));
    thrown.clone_from(single.episode());
    assert_eq!(thrown.ending(), None);
    environment.restore(3, &thrown);
    let actions = vec![0.0; 8 * engine.action_size()];
    let step = environment.step(&actions).unwrap().clone();
    assert_eq!(step.ends.len(), 1, "{:?}", step.ends);
    assert!(step.ends[0].slot == 3 && matches!(step.ends[0].ending, Ending::Fault(_)));
    single.step(&vec![0.0; engine.action_size()]).unwrap();
    assert_eq!(single.episode(), environment.episodes().nth(3).unwrap());
    for slot in [0, 1, 2, 4, 5, 6, 7] {
        single.reset(key(slot));
        single.step(&vec![0.0; engine.action_size()]).unwrap();
        assert_eq!(single.episode(), environment.episodes().nth(slot).unwrap());
    }
}

#[test]
fn elastic_tendons_go_on_from_their_fibres() {
    let task = episode(&[]);
    let model = (**task.engine().model()).clone().with_elastic_tendons(ElasticTendons::default()).unwrap();
    let engine = Engine::new(model.into(), task.engine().body().clone(), task.task().clone()).unwrap();
    check("balance with elastic tendons", &engine, 12, 1, 3);
}

#[test]
fn what_joints_bear_has_the_same_bits_in_lanes() {
    let parts = [
        ("observe {", "observe { knee_angle_r.reaction_force; hip_flexion_l.reaction_torque;"),
        ("horizon 12 steps", "horizon 60 steps"),
    ];
    let environment = episode(&parts);
    check("reactions", environment.engine(), 8, 1, 50);
    // Standing on one's feet loads the knees; the ground of the task is under them.
    let (episodes, _) = side_by_side(environment.engine(), 3, 1, 40);
    let loads = episodes.iter().map(|episode| episode.observation()[..3].iter().map(|part| part * part).sum::<f64>().sqrt());
    assert!(loads.clone().all(|load| load > 10.0), "{:?}", loads.collect::<Vec<_>>());
}

/// Sensors that read parts of the forward pass that are moved out of lanes for them alone.
#[test]
fn moment_arms_have_the_same_bits_in_lanes() {
    let engine = episode(&[("observe {", "observe { moment_arm(soleus_r, ankle_angle_r);")]).engine().clone();
    check("moment arms", &engine, 8, 1, 6);
    let (episodes, _) = side_by_side(&engine, 8, 1, 3);
    assert!(episodes.iter().all(|episode| (0.01..0.1).contains(&episode.observation()[0].abs())));
}
