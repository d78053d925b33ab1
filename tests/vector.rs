//! What many episodes side by side promise: arrays, ends, the three modes of resetting, and the bits of each episode by itself.

use super::episodes::episode;
use msk::runtime::episode::{AutoresetMode, Ending, Engine, EpisodeKey, Fault, Stream, VectorEnvironment, VectorStep};
use std::num::NonZeroUsize;

const SEED: u64 = 9;
const SLOTS: usize = 3;

/// Episodes that end as a failure after two steps.
fn short(autoreset: AutoresetMode) -> VectorEnvironment {
    environment(&[("early when step > 100", "early when step > 1")], autoreset, 1)
}

fn environment(parts: &[(&str, &str)], autoreset: AutoresetMode, threads: usize) -> VectorEnvironment {
    let [slots, threads] = [SLOTS, threads].map(|number| NonZeroUsize::new(number).unwrap());
    let engine = episode(parts).engine().clone();
    let mut environment = VectorEnvironment::new(engine, slots, threads).unwrap().with_autoreset(autoreset);
    environment.reset(SEED);
    environment
}

fn key(episode: usize) -> EpisodeKey {
    EpisodeKey { seed: SEED, episode: episode as u64 }
}

fn keys(environment: &VectorEnvironment) -> Vec<EpisodeKey> {
    environment.episodes().map(|episode| episode.key()).collect()
}

fn still(environment: &VectorEnvironment) -> Vec<f64> {
    vec![-0.5; SLOTS * environment.engine().body().muscles.len()]
}

/// The observations of slots whose episodes `first`, `first + 1`, ... have just begun.
fn initial_observations(first: usize) -> Vec<f64> {
    let mut alone = episode(&[]);
    let begin = |index: usize| {
        alone.reset(key(first + index));
        alone.observation().to_vec()
    };
    (0..SLOTS).flat_map(begin).collect()
}

#[test]
fn a_reset_gives_the_first_observations() {
    let mut environment = short(AutoresetMode::Disabled);
    assert_eq!(environment.last().observations, initial_observations(0));
    let step = environment.reset(SEED);
    assert_eq!(step.observations, initial_observations(0));
    assert_eq!((step.rewards.clone(), step.ended.clone()), (vec![0.0; SLOTS], vec![false; SLOTS]));
}

#[test]
fn in_the_same_step_the_next_episode_follows_and_the_last_observation_is_kept() {
    let mut environment = short(AutoresetMode::SameStep);
    let actions = still(&environment);
    let first = environment.step(&actions).unwrap().clone();
    assert_eq!((first.ended, first.ends), (vec![false; SLOTS], vec![]));
    let before: Vec<f64> = environment.episodes().map(|episode| episode.total()).collect();
    let second = environment.step(&actions).unwrap().clone();
    assert_eq!(second.terminated, [true; SLOTS]);
    assert_eq!((second.ended, second.truncated), (vec![true; SLOTS], vec![false; SLOTS]));
    assert_eq!(second.observations, initial_observations(3));
    assert_eq!(keys(&environment), [key(3), key(4), key(5)]);
    assert!(second.final_observations != second.observations && second.final_observations.iter().all(|value| value.is_finite()));
    for (slot, end) in second.ends.iter().enumerate() {
        assert_eq!((end.slot, end.key, end.steps, &end.ending), (slot, key(slot), 2, &Ending::Terminated(vec![0])));
        assert_eq!(end.total, before[slot] + second.rewards[slot]);
        let by_terms: f64 = end.totals.iter().sum();
        assert!((by_terms - end.total).abs() < 1e-9 && end.totals.len() == 2);
        assert!(!end.success);
        assert_eq!(end.terms.len(), 2);
    }
    // The next episodes begin with nothing earned.
    assert!(environment.episodes().all(|episode| episode.total() == 0.0 && episode.steps() == 0));
}

#[test]
fn in_the_next_step_the_action_is_ignored_and_the_next_episode_begins() {
    let mut environment = short(AutoresetMode::NextStep);
    let actions = still(&environment);
    environment.step(&actions).unwrap();
    let end = environment.step(&actions).unwrap().clone();
    assert_eq!((end.terminated, end.ends.len()), (vec![true; SLOTS], SLOTS));
    assert_eq!(end.observations, end.final_observations);
    let begun = environment.step(&actions).unwrap().clone();
    assert_eq!((begun.rewards, begun.terminated), (vec![0.0; SLOTS], vec![false; SLOTS]));
    assert_eq!((begun.ended, begun.ends.len()), (vec![false; SLOTS], 0));
    assert_eq!(begun.observations, initial_observations(3));
    environment.step(&actions).unwrap();
    assert!(environment.episodes().all(|episode| episode.steps() == 1));
}

#[test]
fn without_resets_an_ended_episode_stays_as_it_is_until_it_is_chosen() {
    let mut environment = short(AutoresetMode::Disabled);
    let actions = still(&environment);
    environment.step(&actions).unwrap();
    let end = environment.step(&actions).unwrap().clone();
    let after = environment.step(&actions).unwrap().clone();
    assert_eq!((end.ended, end.terminated.clone()), (vec![true; SLOTS], vec![true; SLOTS]));
    assert_eq!((after.ended, after.terminated), (vec![false; SLOTS], end.terminated));
    assert_eq!((after.observations, after.rewards), (end.observations, vec![0.0; SLOTS]));
    let chosen = environment.reset_where(&[false, true, false]).clone();
    assert_eq!(chosen.terminated, [true, false, true]);
    assert_eq!(keys(&environment), [key(0), key(4), key(2)]);
}

#[test]
fn chosen_episodes_can_be_played_again() {
    let mut environment = short(AutoresetMode::Disabled);
    let width = environment.last().observations.len() / SLOTS;
    let step = environment.reset_to(&[None, Some(key(40))]).clone();
    assert_eq!(keys(&environment), [key(0), key(40), key(2)]);
    assert_eq!(step.observations[width..2 * width], initial_observations(40)[..width]);
    environment.reset_where(&[true, true, true]);
    assert_eq!(keys(&environment), [key(3), key(43), key(5)]);
}

#[test]
fn slots_with_seeds_of_their_own_play_their_episodes_one_after_the_other() {
    let mut environment = short(AutoresetMode::Disabled).with_stride(1);
    let of = |seed: u64, episode: u64| EpisodeKey { seed, episode };
    environment.reset_to(&[Some(of(5, 0)), Some(of(6, 0)), Some(of(7, 0))]);
    environment.reset_where(&[true, true, false]);
    assert_eq!(keys(&environment), [of(5, 1), of(6, 1), of(7, 0)]);
    environment.set_next_key(0, of(8, 4));
    assert_eq!(environment.next_keys().collect::<Vec<_>>(), [of(8, 4), of(6, 2), of(7, 1)]);
}

#[test]
fn workers_that_are_started_anew_go_on_with_the_same_bits() {
    let [mut one, mut other] = [1, 2].map(|threads| environment(&[], AutoresetMode::SameStep, threads));
    let actions = still(&one);
    other.restart_workers().unwrap();
    assert_eq!(one.step(&actions).unwrap(), other.step(&actions).unwrap());
}

#[test]
fn the_horizon_and_a_fault_truncate() {
    let mut environment = environment(&[("horizon 12 steps", "horizon 2 steps")], AutoresetMode::SameStep, 1);
    let mut actions = still(&environment);
    let muscles = environment.engine().body().muscles.len();
    actions[muscles] = f64::NAN;
    let step = environment.step(&actions).unwrap().clone();
    assert_eq!((step.truncated, step.terminated), (vec![false, true, false], vec![false; SLOTS]));
    assert!(matches!(step.ends.as_slice(), [end] if end.slot == 1 && matches!(end.ending, Ending::Fault(Fault::Action { .. }))));
    assert_eq!((step.rewards[1], step.ends[0].steps, step.ends[0].total), (0.0, 0, 0.0));
    // The others go on, and the faulted slot has its next episode.
    assert_eq!(keys(&environment), [key(0), key(4), key(2)]);
    let actions = still(&environment);
    let step = environment.step(&actions).unwrap();
    assert_eq!(step.truncated, [true, false, true]);
    assert!(step.ends.iter().all(|end| end.ending == Ending::Truncated && end.success));
}

#[test]
fn arrays_and_ends_have_the_same_bits_on_any_number_of_threads() {
    let play = |threads: usize| -> Vec<VectorStep> {
        let parts = [("early when step > 100", "early when com.velocity.z < 0 m/s"), ("horizon 12 steps", "horizon 5 steps")];
        let mut environment = environment(&parts, AutoresetMode::SameStep, threads);
        let mut noise = Stream::new(key(0), "actions");
        let size = still(&environment).len();
        let step = |_| {
            let actions: Vec<f64> = (0..size).map(|_| noise.normal()).collect();
            environment.step(&actions).unwrap().clone()
        };
        (0..16).map(step).collect()
    };
    let one = play(1);
    let ends = || one.iter().flat_map(|step| &step.ends);
    assert!(ends().count() > SLOTS, "episodes end, and others follow");
    assert!(ends().any(|end| end.ending == Ending::Truncated) && ends().any(|end| end.ending != Ending::Truncated));
    assert_eq!(play(2), one);
    assert_eq!(play(8), one);
}

#[test]
fn single_precision_stays_finite() {
    let step = VectorStep { observations: vec![0.5, 1e300, -1e300, f64::NAN], ..VectorStep::default() };
    let mut narrow = [0.0; 4];
    step.observations_f32(&mut narrow);
    assert_eq!(narrow[..3], [0.5, f32::MAX, f32::MIN]);
    assert!(narrow[3].is_nan());
}

#[test]
fn an_episode_of_another_task_stays_as_it_is() {
    let mut environment = short(AutoresetMode::Disabled);
    let other = episode(&[("torso.up.z", "pelvis.up.z")]);
    environment.restore(1, other.episode());
    let actions = still(&environment);
    environment.step(&actions).unwrap();
    let steps: Vec<u32> = environment.episodes().map(|episode| episode.steps()).collect();
    assert_eq!(steps, [1, 0, 1]);
    assert_eq!(environment.episodes().nth(1), Some(other.episode()));
}

/// Three tasks with rows of the same lengths: the usual one, one with other rewards and an early end, one with a box in its scene.
fn different() -> Vec<Engine> {
    let parts: [&[(&str, &str)]; 3] = [
        &[],
        &[("2 upright = torso.up.z", "20 -> 4 over 50 % upright = torso.up.z"), ("early when step > 100", "early when step > 3")],
        &[("    init {", "    scene { ground; box post { size [10 cm, 10 cm, 1 m], at [1 m, 0, 0.5 m] } }\n    init {")],
    ];
    parts.map(|parts| episode(parts).engine().clone()).to_vec()
}

#[test]
fn a_mix_of_tasks_has_the_bits_of_each_alone() {
    let engines = different();
    let counts = [5, 2, 4];
    let parts = || engines.iter().cloned().zip(counts.map(|count| NonZeroUsize::new(count).unwrap())).collect::<Vec<_>>();
    let owner: Vec<usize> = counts.iter().enumerate().flat_map(|(engine, &count)| vec![engine; count]).collect();
    let slots = owner.len();
    let mut stream = Stream::new(key(0), "actions");
    let width = engines[0].action_size();
    let actions: Vec<Vec<f64>> = (0..6).map(|_| (0..slots * width).map(|_| 2.0 * stream.uniform() - 1.0).collect()).collect();
    let play = |mut vector: VectorEnvironment| {
        vector.set_progress(0.25).unwrap();
        vector.reset(SEED);
        actions.iter().map(|actions| vector.step(actions).unwrap().clone()).collect::<Vec<VectorStep>>()
    };
    let mixed = |threads: usize| {
        let threads = NonZeroUsize::new(threads).unwrap();
        VectorEnvironment::mixed(parts(), threads).unwrap().with_autoreset(AutoresetMode::SameStep)
    };
    let steps = play(mixed(1));
    assert!(steps == play(mixed(3)));
    let vector = mixed(2);
    for (slot, &engine) in owner.iter().enumerate() {
        assert!(vector.engine_of(slot).is_some_and(|own| own.is(&engines[engine])));
        let mut alone = VectorEnvironment::new(engines[engine].clone(), NonZeroUsize::MIN, NonZeroUsize::MIN)
            .unwrap()
            .with_autoreset(AutoresetMode::SameStep)
            .with_stride(slots as u64);
        alone.set_progress(0.25).unwrap();
        alone.reset_to(&[Some(key(slot))]);
        for (step, actions) in steps.iter().zip(&actions) {
            let own = alone.step(&actions[width * slot..width * (slot + 1)]).unwrap();
            let row = own.observations.len();
            assert_eq!(step.observations[row * slot..row * (slot + 1)], own.observations[..]);
            assert_eq!((step.rewards[slot], step.ended[slot]), (own.rewards[0], own.ended[0]));
            assert_eq!((step.terminated[slot], step.truncated[slot]), (own.terminated[0], own.truncated[0]));
        }
    }
    let ended: Vec<usize> = steps.iter().flat_map(|step| step.ends.iter().map(|end| end.slot)).collect();
    assert_eq!(ended, [5, 6], "those of the second task");
    assert!(vector.engine_of(slots).is_none());
}

#[test]
fn tasks_with_rows_of_different_lengths_do_not_mix() {
    let wide = episode(&[("observe {", "observe { pelvis.height;")]).engine().clone();
    let parts = |engines: Vec<Engine>| engines.into_iter().map(|engine| (engine, NonZeroUsize::MIN)).collect::<Vec<_>>();
    let error = |engines| VectorEnvironment::mixed(parts(engines), NonZeroUsize::MIN).err().unwrap().to_string();
    let plain = episode(&[]).engine().clone();
    let size = plain.task().observation_size();
    assert_eq!(
        error(vec![plain, wide]),
        format!(
            "the tasks of a mix have equally many values of the observation: `balance` has {size}, `balance` has {}",
            size + 1
        )
    );
    assert_eq!(error(Vec::new()), "a mix has at least one task");
}
