//! What recorded episodes promise to a learner from rewards: it learns beside them, and refuses those that do not say what was earned.

use super::*;

/// Episodes of the teacher as `msk collect` keeps them.
pub fn episodes(engine: &Engine, count: u64) -> DataSet {
    let mut environment = Environment::of(engine.clone());
    let episode = |episode: u64| {
        environment.reset(EpisodeKey { seed: 99, episode });
        let (mut observations, mut critic_observations) = (Vec::new(), Vec::new());
        let (mut actions, mut values, mut action) = (Vec::new(), Vec::new(), vec![0.0]);
        loop {
            observations.extend(environment.observation().iter().map(|value| *value as f32));
            critic_observations.extend(environment.critic_observation().iter().map(|value| *value as f32));
            if environment.ending().is_some() {
                break;
            }
            Teacher.act(&environment.context(), &mut action).unwrap();
            actions.extend_from_slice(&action);
            environment.step(&action).unwrap();
            values.extend_from_slice(&environment.report().terms);
        }
        let terminated = environment.ending().is_some_and(|ending| !ending.bootstraps(engine.task()));
        RecordedEpisode { observations, actions, outcome: Some(RecordedOutcome { critic_observations, values, terminated }) }
    };
    DataSet::new("recorded", ActsOn::Task, (0..count).map(episode).collect())
}

fn with(engine: &Engine, settings: &Settings, data: Vec<DataSet>) -> Result<Training, TrainError> {
    let lessons = Lessons { data, ..Lessons::default() };
    Training::with(engine, settings, &lessons, (1, 2_000), NonZeroUsize::MIN)
}

fn hasty(algorithm: Algorithm) -> Settings {
    let mut settings = Settings { evaluation_episodes: 20, ..small(algorithm) };
    (settings.sac.start, settings.sac.updates, settings.sac.batch) = (100, 0.5, 64);
    settings
}

#[test]
fn recorded_episodes_show_where_a_rare_reward_is() {
    // There is nothing to be had but within a tenth of a radian.
    let engine = engine(&[("exp(-4 rad", "exp(-100 rad")]);
    for seed in [1, 2] {
        let returns = |data: Vec<DataSet>| {
            let lessons = Lessons { data, ..Lessons::default() };
            let mut training =
                Training::with(&engine, &hasty(Algorithm::Sac), &lessons, (seed, 3_000), NonZeroUsize::MIN).unwrap();
            while !training.is_over() {
                training.round().unwrap();
            }
            let agent = training.agent();
            training.evaluate(&agent, &STOP).unwrap().unwrap()
        };
        let (alone, beside) = (returns(Vec::new()), returns(vec![episodes(&engine, 10)]));
        assert!(
            beside.total > alone.total + 15.0 && beside.success == 1.0,
            "{alone:?} alone, {beside:?} beside recorded episodes"
        );
    }
}

#[test]
fn a_checkpoint_continues_beside_the_same_episodes_to_the_same_bits() {
    let engine = engine(&[]);
    let begin = || with(&engine, &hasty(Algorithm::Dynsyn), vec![episodes(&engine, 2)]).unwrap();
    let mut undisturbed = begin();
    undisturbed.round().unwrap();
    let state = checkpoint(&mut undisturbed);
    undisturbed.round().unwrap();
    let mut continued = begin();
    continued.restore(&[], &state).unwrap();
    continued.round().unwrap();
    assert_eq!(checkpoint(&mut continued), checkpoint(&mut undisturbed));
    let other = with(&engine, &hasty(Algorithm::Dynsyn), vec![episodes(&engine, 3)]).unwrap();
    assert_ne!(other.identity().lessons, undisturbed.identity().lessons);
}

#[test]
fn episodes_from_which_it_cannot_learn_are_refused() {
    let engine = engine(&[]);
    let refuse = |settings: &Settings, set: DataSet| with(&engine, settings, vec![set]).err().unwrap().to_string();
    let (sac, set) = (small(Algorithm::Sac), episodes(&engine, 2));
    for algorithm in [Algorithm::Ppo, Algorithm::Mpo] {
        let message = refuse(&small(algorithm), set.clone());
        assert!(message.contains("learns from what it plays itself: --data is for sac, simba, dynsyn, and clone"), "{message}");
    }
    let changed = |change: &dyn Fn(&mut RecordedEpisode)| {
        let mut set = set.clone();
        change(&mut set.episodes[1]);
        refuse(&sac, set)
    };
    let message = changed(&|episode| episode.outcome = None);
    assert!(
        message.ends_with("does not say what its actions came to: it can be imitated only, by the algorithm `clone`"),
        "{message}"
    );
    let message = changed(&|episode| episode.observations.truncate(1));
    assert!(message.ends_with("there is not one observation more than actions"), "{message}");
    let message = changed(&|episode| episode.outcome.as_mut().unwrap().values.clear());
    assert!(message.ends_with("other critic observations or terms than the task"), "{message}");
    let little = Settings { replay_memory: 1e-6, ..sac.clone() };
    let message = refuse(&little, set.clone());
    assert!(message.contains("transitions, and there is memory for") && message.ends_with("raise `replay_memory`"), "{message}");
    let empty = DataSet { episodes: Vec::new(), ..set.clone() };
    assert!(refuse(&sac, empty).ends_with("has no episodes"));
}
