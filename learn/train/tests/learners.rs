//! What trainings promise: the same bits at any number of threads and after any interruption, agents that say what they fit, numbers
//! that stay finite, and that something is learned.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod agents;
mod recorded;
mod repeats;
mod synergies;

use msk_compiler::compile;
use msk_network::{Processor, Tape};
use msk_runtime::action::ActsOn;
use msk_runtime::episode::{Engine, Environment, EpisodeKey};
use msk_runtime::library::{BodyLibrary, FileLoader};
use msk_runtime::policy::{Policy, PolicyContext, PolicyError, PolicyMaker, PolicySource};
use msk_train::session::{Ended, Observer, Progress, Session};
use msk_train::{
    Agent, Algorithm, DataSet, Evaluation, Lessons, Precision, Preset, Provenance, RecordedEpisode, RecordedOutcome, ReplaySize,
    Round, Settings, TrainError, Training,
};
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tempfile::tempdir;

static STOP: AtomicBool = AtomicBool::new(false);

/// The task of `pendulum.msk` with replacements.
fn engine(parts: &[(&str, &str)]) -> Engine {
    engine_of("pendulum", parts)
}

/// The task of a body beside this file, with replacements.
fn engine_of(name: &str, parts: &[(&str, &str)]) -> Engine {
    let folder = tempdir().unwrap();
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let [task, model] = ["msk", "xml"].map(|kind| format!("{name}.{kind}"));
    let mut text = fs::read_to_string(here.join(&task)).unwrap();
    for (from, to) in parts {
        assert!(text.contains(from), "the task has no `{from}`");
        text = text.replace(from, to);
    }
    let file = folder.path().join(&task);
    fs::write(&file, text).unwrap();
    fs::copy(here.join(&model), folder.path().join(&model)).unwrap();
    let bodies = BodyLibrary::default();
    let task = compile(&file, &FileLoader, &bodies).unwrap_or_else(|report| panic!("{report}")).tasks[0].clone();
    let stage = bodies.stage(&task.body, &task.scene).unwrap();
    Engine::new(stage.model, stage.body, task).unwrap()
}

fn small(algorithm: Algorithm) -> Settings {
    let mut settings = Settings::of(algorithm, Preset::Fast);
    settings.episodes = 3;
    settings.hidden = vec![16, 16];
    settings.critic_hidden = Vec::new();
    settings.noise_correlation = 0.5;
    // One of them acts in every second control step.
    settings.action_repeat = if algorithm == Algorithm::Sac { 2 } else { 1 };
    settings.dynsyn.groups = 4;
    settings.dynsyn.rollout = 200;
    settings.ppo.horizon = 40;
    settings.ppo.minibatch = 32;
    settings.ppo.epochs = 2;
    settings.sac.batch = 16;
    settings.sac.start = 300;
    settings.sac.replay = 500;
    settings.sac.updates = 0.05;
    settings.mpo.batch = 16;
    settings.mpo.start = 300;
    settings.mpo.replay = 500;
    settings.mpo.updates = 0.05;
    settings.mpo.block = 4;
    // One of them remembers in 16 bits.
    settings.replay_precision = if algorithm == Algorithm::Mpo { Precision::Compact } else { Precision::Single };
    settings.dep.probability = 0.05;
    settings.clone.batch = 16;
    settings.clone.updates = 0.05;
    settings.clone.memory = 400;
    settings.evaluation_episodes = 2;
    settings
}

/// Knows how to hold the pendulum: the torque against gravity at 0.5 rad, a spring and a damper.
#[derive(Debug)]
struct Teacher;

impl Policy for Teacher {
    fn name(&self) -> &str {
        "teacher"
    }
    fn reset(&mut self, _: &PolicyContext<'_>) -> Result<(), PolicyError> {
        Ok(())
    }
    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let [angle, rate] = [context.observation[0], context.observation[1]];
        action[0] = (1.18 + 8.0 * (0.5 - angle) - 1.5 * rate) / 3.0;
        Ok(())
    }
}

impl PolicyMaker for Teacher {
    fn open<'a>(&self, _: &'a AtomicBool) -> Result<Box<dyn Policy + 'a>, PolicyError> {
        Ok(Box::new(Teacher))
    }
}

fn taught() -> Lessons {
    Lessons { teacher: Some(PolicySource::made("teacher".into(), Arc::new(Teacher))), ..Lessons::default() }
}

/// What an algorithm learns from.
fn lessons(algorithm: Algorithm) -> Lessons {
    if algorithm == Algorithm::Clone { taught() } else { Lessons::default() }
}

fn training(engine: &Engine, settings: &Settings, threads: usize) -> Training {
    let lessons = lessons(settings.algorithm);
    Training::with(engine, settings, &lessons, (7, 2000), NonZeroUsize::new(threads).unwrap()).unwrap()
}

/// The state after so many rounds, checkpoints and continuations after each of them included if asked for.
fn played(engine: &Engine, settings: &Settings, threads: usize, rounds: usize, breaks: bool) -> Vec<u8> {
    let mut present = training(engine, settings, threads);
    for _ in 0..rounds {
        present.round().unwrap();
        if breaks {
            let state = checkpoint(&mut present);
            present = training(engine, settings, threads);
            present.restore(&[], &state).unwrap();
        }
    }
    checkpoint(&mut present)
}

/// A tape for actors.
fn tape() -> Tape {
    Tape::new(Arc::new(Processor::new(NonZeroUsize::MIN).unwrap()))
}

/// What an agent does somewhere.
fn action(agent: &Agent) -> f64 {
    let mut action = [f64::NAN];
    agent.actor().act(&mut tape(), &[0.3, -0.2], &mut action);
    action[0]
}

fn checkpoint(training: &mut Training) -> Vec<u8> {
    let mut bytes = Vec::new();
    training.checkpoint(&mut bytes);
    bytes
}

#[test]
fn a_training_has_the_same_bits_on_any_number_of_threads_and_after_any_break() {
    let engine = engine(&[]);
    for (_, algorithm) in Algorithm::NAMED {
        let settings = small(algorithm);
        let one = played(&engine, &settings, 1, 4, false);
        assert!(one == played(&engine, &settings, 2, 4, false), "{algorithm:?} on two threads");
        assert!(one == played(&engine, &settings, 3, 4, false), "{algorithm:?} on three threads");
        assert!(one == played(&engine, &settings, 1, 4, true), "{algorithm:?} with breaks");
        assert!(one != played(&engine, &settings, 1, 3, false));
    }
}

#[test]
fn another_seed_gives_another_training() {
    let engine = engine(&[]);
    let settings = small(Algorithm::Ppo);
    let agents = [7, 8].map(|seed| {
        let mut training = Training::new(&engine, &settings, (seed, 2000), NonZeroUsize::MIN).unwrap();
        training.round().unwrap();
        training.agent().actor().clone()
    });
    assert!(agents[0] != agents[1]);
}

#[test]
fn checkpoints_that_do_not_fit_are_refused() {
    let engine = engine(&[]);
    let settings = small(Algorithm::Ppo);
    let bytes = played(&engine, &settings, 1, 1, false);
    let refuse = |settings: &Settings, bytes: &[u8]| training(&engine, settings, 1).restore(&[], bytes).unwrap_err();
    let mut damaged = bytes.clone();
    damaged[100] ^= 1;
    assert_eq!(refuse(&settings, &damaged), "it is damaged");
    assert_eq!(refuse(&settings, &bytes[..20]), "it is too short");
    // What stands before it is damaged with it.
    let mut behind = vec![1, 2, 3];
    training(&engine, &settings, 1).checkpoint(&mut behind);
    let resume = |before: &[u8]| training(&engine, &settings, 1).restore(before, &behind[3..]);
    assert_eq!(resume(&[1, 2, 3]), Ok(()));
    assert_eq!(resume(&[1, 2, 2]), Err("it is damaged".to_owned()));
    let narrow = Settings { hidden: vec![8], ..settings.clone() };
    assert_eq!(refuse(&narrow, &bytes), parameters_message());
    assert_eq!(refuse(&small(Algorithm::Sac), &bytes), "it is of another algorithm");
    let wide = Settings { episodes: 4, ..settings.clone() };
    assert_eq!(refuse(&wide, &bytes), "it has 3 episodes side by side, expected 4");
}

/// Two perceptrons of two hidden layers, one of which sees a critic channel beside the two others, and a deviation; against one layer of 8.
fn parameters_message() -> String {
    let of = |inputs: usize, hidden: &[usize]| {
        let sizes: Vec<usize> = [inputs].into_iter().chain(hidden.iter().copied()).chain([1]).collect();
        sizes.windows(2).map(|pair| pair[0] * pair[1] + pair[1]).sum::<usize>()
    };
    let all = |hidden: &[usize]| of(2, hidden) + of(3, hidden) + 1;
    format!("it has {} parameters, expected {}", all(&[16, 16]), all(&[8]))
}

struct Silent;

impl Observer for Silent {
    fn round(&mut self, _: &Round, _: &Progress) {}
    fn evaluated(&mut self, _: u64, _: &Evaluation) {}
}

/// A file of an agent's folder.
fn agent_file(folder: &Path, file: &str) -> Vec<u8> {
    fs::read(folder.join("best-by-return").join(file)).unwrap()
}

/// Lines of a curve without what differs between two runs of the same training.
fn curve(folder: &Path) -> Vec<serde_json::Value> {
    let text = fs::read_to_string(folder.join("curve.jsonl")).unwrap();
    let line = |line: &str| {
        let mut line: serde_json::Value = serde_json::from_str(line).unwrap();
        line.as_object_mut().unwrap().remove("seconds");
        line
    };
    text.lines().map(line).collect()
}

/// Stops a session after some rounds.
struct StopAfter<'a>(usize, &'a AtomicBool);

impl Observer for StopAfter<'_> {
    fn round(&mut self, _: &Round, _: &Progress) {
        self.0 -= 1;
        self.1.store(self.0 == 0, std::sync::atomic::Ordering::Relaxed);
    }
    fn evaluated(&mut self, _: u64, _: &Evaluation) {}
}

fn session_settings(algorithm: Algorithm) -> Settings {
    Settings { evaluate_every: 500, checkpoint_every: 300, ..small(algorithm) }
}

fn open(folder: &Path, engine: &Engine, settings: &Settings) -> Session {
    Session::open(folder, training(engine, settings, 1)).unwrap().0
}

#[test]
fn a_session_that_is_stopped_or_killed_at_any_round_ends_as_an_undisturbed_one() {
    let engine = engine(&[]);
    for (_, algorithm) in Algorithm::NAMED {
        let settings = session_settings(algorithm);
        let whole = tempdir().unwrap();
        assert_eq!(open(whole.path(), &engine, &settings).run(&STOP, &mut Silent).unwrap(), Ended::Whole);
        for rounds in [1, 2, 3, 5] {
            let parts = tempdir().unwrap();
            let stop = AtomicBool::new(false);
            let mut session = open(parts.path(), &engine, &settings);
            let ended = session.run(&stop, &mut StopAfter(rounds, &stop)).unwrap();
            drop(session);
            if ended == Ended::Interrupted {
                // Killed in its next rounds: nothing is written but what was before.
                let killed = copy(parts.path());
                let stop = AtomicBool::new(false);
                open(killed.path(), &engine, &settings).run(&stop, &mut StopAfter(2, &stop)).unwrap();
                fs::copy(killed.path().join("curve.jsonl"), parts.path().join("curve.jsonl")).unwrap();
            }
            assert_eq!(open(parts.path(), &engine, &settings).run(&STOP, &mut Silent).unwrap(), Ended::Whole);
            assert!(curve(parts.path()) == curve(whole.path()), "{algorithm:?} after {rounds} rounds");
            for file in ["policy.safetensors", "agent.toml"] {
                assert!(agent_file(parts.path(), file) == agent_file(whole.path(), file), "{algorithm:?}, {rounds}, {file}");
            }
        }
    }
}

fn copy(folder: &Path) -> tempfile::TempDir {
    let other = tempdir().unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        if entry.path().is_file() {
            fs::copy(entry.path(), other.path().join(entry.file_name())).unwrap();
        }
    }
    other
}

#[test]
fn a_training_with_more_steps_goes_on_beyond_its_end() {
    let engine = engine(&[]);
    let session = |folder: &Path, settings: &Settings, steps: u64| {
        let one = NonZeroUsize::MIN;
        Session::open(folder, Training::new(&engine, settings, (7, steps), one).unwrap()).map(|(session, _)| session)
    };
    let rounds = |folder: &Path| curve(folder).into_iter().filter(|line| line.get("evaluation").is_none()).collect::<Vec<_>>();
    for algorithm in [Algorithm::Sac, Algorithm::Mpo] {
        let settings = Settings { evaluate_every: 1000, ..session_settings(algorithm) };
        let [whole, parts] = [tempdir().unwrap(), tempdir().unwrap()];
        session(whole.path(), &settings, 2000).unwrap().run(&STOP, &mut Silent).unwrap();
        for steps in [700, 2000] {
            assert_eq!(session(parts.path(), &settings, steps).unwrap().run(&STOP, &mut Silent).unwrap(), Ended::Whole);
        }
        assert!(rounds(parts.path()) == rounds(whole.path()), "{algorithm:?}");
        let last = |folder: &Path| fs::read(folder.join("last/policy.safetensors")).unwrap();
        assert!(last(parts.path()) == last(whole.path()), "{algorithm:?}");
        // One more, at the first end.
        assert_eq!(curve(parts.path()).len(), curve(whole.path()).len() + 1);
        let fewer = session(parts.path(), &settings, 900).err().unwrap().to_string();
        assert!(fewer.contains("its number of steps is 2000, not 900"), "{fewer}");
    }
    // Its rates have fallen to 0 by the end.
    let (folder, settings) = (tempdir().unwrap(), session_settings(Algorithm::Ppo));
    drop(session(folder.path(), &settings, 900).unwrap());
    let refused = session(folder.path(), &settings, 2000).err().unwrap().to_string();
    assert!(refused.contains("a training of 900 steps, which `anneal` of `[ppo]` has fitted to their number"), "{refused}");
}

#[test]
fn a_folder_of_another_training_is_refused() {
    let engine = engine(&[]);
    let folder = tempdir().unwrap();
    drop(open(folder.path(), &engine, &small(Algorithm::Ppo)));
    let refused = Session::open(folder.path(), training(&engine, &small(Algorithm::Sac), 1));
    let message = refused.err().unwrap().to_string();
    assert!(message.contains("holds another training: its set of settings is algorithm = \"ppo\""), "{message}");
    // Another condition of the muscles, of which task and names of the body say nothing.
    let condition = "weakness 0.3".to_owned();
    let weak = training(&engine, &small(Algorithm::Ppo), 1).with_provenance(Provenance { condition, ..Provenance::default() });
    let message = Session::open(folder.path(), weak).err().unwrap().to_string();
    assert!(message.contains("its condition of the muscles is not recorded, not weakness 0.3"), "{message}");
    let first = open(folder.path(), &engine, &small(Algorithm::Ppo));
    assert_eq!(first.training().step(), 0);
    let second = Session::open(folder.path(), training(&engine, &small(Algorithm::Ppo), 1));
    let message = second.err().unwrap().to_string();
    assert!(message.starts_with("another process trains in `"), "{message}");
}

#[test]
fn a_replay_buffer_keeps_what_fits_into_its_memory() {
    let engine = engine(&[]);
    let mut settings = small(Algorithm::Sac);
    settings.sac.replay = 200_000_000;
    let size = |settings: &Settings| Training::new(&engine, settings, (1, 100), NonZeroUsize::MIN).unwrap().replay().unwrap();
    assert_eq!(size(&settings), ReplaySize { kept: 119_304_647, wanted: 200_000_000, bytes: 36 });
    settings.replay_precision = Precision::Compact;
    assert_eq!(size(&settings), ReplaySize { kept: 195_225_786, wanted: 200_000_000, bytes: 22 });
    assert!(Training::new(&engine, &small(Algorithm::Ppo), (1, 100), NonZeroUsize::MIN).unwrap().replay().is_none());
}

/// The finding: transitions kept the reward of the weights under which they were played, whatever became of the weights.
#[test]
fn what_is_remembered_is_rewarded_by_the_weights_in_force() {
    let engine = engine(&[]);
    for algorithm in [Algorithm::Sac, Algorithm::Mpo] {
        let mut settings = small(algorithm);
        // Nothing is learned from in the first round.
        (settings.sac.start, settings.mpo.start) = (400, 400);
        let learned = |weights: [f64; 2]| {
            let mut training = training(&engine, &settings, 1);
            for weight in weights {
                training.set_weights(&[weight]);
                training.round().unwrap();
            }
            training.agent().digest()
        };
        assert_eq!(learned([5.0, 1.0]), learned([1.0, 1.0]), "{algorithm:?}");
        assert_ne!(learned([1.0, 5.0]), learned([1.0, 1.0]), "{algorithm:?}");
    }
}

#[test]
fn numbers_that_are_not_finite_stop_a_training() {
    let engine = engine(&[("1 near = exp(", "1e9 near = 1e12 * exp(")]);
    let settings = Settings { normalize_rewards: false, ..small(Algorithm::Ppo) };
    let error = training(&engine, &settings, 1).round().err().unwrap();
    let message = error.to_string();
    assert!(matches!(error, TrainError::NotFinite { step: 0, .. }), "{message}");
    assert!(message.starts_with("after 0 steps the loss of PPO is not finite"), "{message}");
}

#[test]
fn every_algorithm_learns_to_hold_a_pendulum() {
    let engine = engine(&[]);
    let mut ppo = small(Algorithm::Ppo);
    ppo.ppo.epochs = 10;
    ppo.ppo.learning_rate = 1e-3;
    let mut sac = small(Algorithm::Sac);
    (sac.sac.replay, sac.sac.updates, sac.sac.batch) = (10_000, 0.5, 64);
    let mut mpo = small(Algorithm::Mpo);
    (mpo.mpo.replay, mpo.mpo.updates, mpo.mpo.batch, mpo.mpo.epsilon_mean) = (10_000, 0.5, 64, 1e-2);
    (mpo.mpo.actor_rate, mpo.mpo.critic_rate) = (1e-3, 1e-3);
    let mut clone = small(Algorithm::Clone);
    (clone.clone.updates, clone.clone.memory) = (0.3, 10_000);
    let [simba, dynsyn] = [Algorithm::Simba, Algorithm::Dynsyn].map(|algorithm| {
        let mut settings = small(algorithm);
        (settings.sac.replay, settings.sac.updates, settings.sac.batch) = (10_000, 0.5, 64);
        settings
    });
    for (settings, steps) in [(ppo, 20_000), (sac, 8_000), (simba, 8_000), (dynsyn, 8_000), (mpo, 8_000), (clone, 4_000)] {
        let settings = Settings { evaluation_episodes: 20, ..settings };
        let lessons = lessons(settings.algorithm);
        let mut training = Training::with(&engine, &settings, &lessons, (1, steps), NonZeroUsize::MIN).unwrap();
        let agent = training.agent();
        let before = training.evaluate(&agent, &STOP).unwrap().unwrap();
        while !training.is_over() {
            training.round().unwrap();
        }
        let agent = training.agent();
        let after = training.evaluate(&agent, &STOP).unwrap().unwrap();
        // Of 60, which is not to be had: the rod begins elsewhere.
        assert!(
            after.total > 52.0 && after.total > before.total + 12.0 && after.success == 1.0,
            "{:?}: {before:?} {after:?}",
            settings.algorithm
        );
    }
}

#[test]
fn a_clone_of_recorded_episodes_acts_as_they_do_and_is_where_others_start() {
    let engine = engine(&[]);
    let lessons = Lessons { data: vec![recorded::episodes(&engine, 10)], ..Lessons::default() };
    for (squash, algorithm) in [(false, Algorithm::Ppo), (true, Algorithm::Sac)] {
        let mut settings = Settings { evaluation_episodes: 20, ..small(Algorithm::Clone) };
        (settings.clone.updates, settings.clone.squash) = (0.3, squash);
        let mut clone = Training::with(&engine, &settings, &lessons, (1, 5_000), NonZeroUsize::MIN).unwrap();
        let mut rounds = Vec::new();
        while !clone.is_over() {
            rounds.push(clone.round().unwrap());
        }
        let error = |round: &Round| round.losses.iter().find(|(name, _)| *name == "error").unwrap().1;
        assert!(error(&rounds[4]) < 0.05 * error(&rounds[0]), "{} {}", error(&rounds[0]), error(&rounds[4]));
        let agent = clone.agent();
        let cloned = clone.evaluate(&agent, &STOP).unwrap().unwrap();
        assert!(cloned.total > 52.0 && cloned.success == 1.0, "squash = {squash}: {cloned:?}");

        let start = Lessons { start: Some(Arc::new(agent)), ..Lessons::default() };
        let settings = Settings { evaluation_episodes: 20, critics_first: 200, hidden: vec![8], ..small(algorithm) };
        let mut training = Training::with(&engine, &settings, &start, (1, 2_000), NonZeroUsize::MIN).unwrap();
        assert_eq!(training.identity().settings.hidden, [16, 16], "networks are those of the agent");
        let begun = training.agent();
        let before = training.evaluate(&begun, &STOP).unwrap().unwrap();
        assert!((before.total - cloned.total).abs() < 0.1, "{algorithm:?}: {before:?} {cloned:?}");
        training.round().unwrap();
        let agent = training.agent();
        let after = training.evaluate(&agent, &STOP).unwrap().unwrap();
        assert!(after.total > 50.0, "{algorithm:?} does not forget: {after:?}");
    }
}

#[test]
fn an_actor_with_zero_init_acts_by_0_until_its_critics_have_learned() {
    let engine = engine(&[]);
    for algorithm in [Algorithm::Sac, Algorithm::Simba, Algorithm::Dynsyn] {
        let mut settings = Settings { critics_first: 1000, ..small(algorithm) };
        settings.sac.zero_init = true;
        let mut training = training(&engine, &settings, 1);
        let rounds = std::iter::repeat_with(|| {
            let losses = training.round().unwrap().losses;
            (training.step(), action(&training.agent()), losses.iter().any(|(name, value)| *name == "critics" && *value > 0.0))
        });
        let rounds: Vec<_> = rounds.take_while(|(step, ..)| *step < 4000).collect();
        let first = settings.sac.start as u64 * settings.action_repeat as u64 + settings.critics_first;
        assert!(rounds.iter().all(|(step, action, _)| (*action == 0.0) == (*step <= first)), "{algorithm:?}: {rounds:?}");
        assert!(rounds.iter().any(|(step, _, learned)| *step <= first && *learned), "{algorithm:?}: {rounds:?}");
    }
}

#[test]
fn lessons_that_do_not_fit_are_refused() {
    let engine = engine(&[]);
    let refuse = |algorithm: Algorithm, lessons: &Lessons| {
        let training = Training::with(&engine, &small(algorithm), lessons, (1, 100), NonZeroUsize::MIN);
        training.and_then(|mut training| training.round()).err().unwrap().to_string()
    };
    let message = refuse(Algorithm::Clone, &Lessons::default());
    assert!(message.starts_with("there is nothing to imitate: name data sets"), "{message}");
    let message = refuse(Algorithm::Ppo, &taught());
    assert!(message.starts_with("the algorithm `ppo` learns from rewards"), "{message}");
    let muscles = DataSet { acts_on: ActsOn::Muscles, ..recorded::episodes(&engine, 1) };
    let message = refuse(Algorithm::Clone, &Lessons { data: vec![muscles], ..Lessons::default() });
    assert!(message.contains("acts on muscles, and actions of the task are torque"), "{message}");
    let teacher = Lessons { teacher: Some(PolicySource::built_in("cmc").unwrap()), ..Lessons::default() };
    let message = refuse(Algorithm::Clone, &teacher);
    assert!(message.contains("cmc"), "{message}");
    let mut training = training(&engine, &small(Algorithm::Ppo), 1);
    training.round().unwrap();
    let agent = Lessons { start: Some(Arc::new(training.agent())), ..Lessons::default() };
    let message = refuse(Algorithm::Sac, &agent);
    assert!(message.ends_with("it does not squash its actions; clone with `squash = true` in `[clone]`"), "{message}");
}

#[test]
fn an_agent_as_onnx_acts_as_the_agent_does() {
    let engine = engine(&[]);
    for (name, activation) in msk_network::Activation::NAMED {
        // The two kinds of output, with and without layer norm.
        let tanh = name == "tanh";
        let algorithm = if tanh { Algorithm::Sac } else { Algorithm::Ppo };
        acts_as_onnx(&engine, &Settings { activation, layer_norm: !tanh, ..small(algorithm) });
    }
    acts_as_onnx(&engine, &small(Algorithm::Simba));
}

/// Compares an agent that has learned for a round with its ONNX file, along an episode.
fn acts_as_onnx(engine: &Engine, settings: &Settings) {
    let folder = tempdir().unwrap();
    let mut training = training(engine, settings, 1);
    training.round().unwrap();
    let path = folder.path().join("agent.onnx");
    fs::write(&path, training.agent().onnx()).unwrap();
    let mut network = PolicySource::parse(&format!("network {}", path.display())).unwrap().open(&STOP).unwrap();
    let mut environment = Environment::of(engine.clone());
    network.reset(&environment.context()).unwrap();
    let mut tape = tape();
    let (mut found, mut expected) = (vec![0.0; engine.action_size()], vec![0.0; engine.action_size()]);
    for step in 0..60 {
        network.act(&environment.context(), &mut found).unwrap();
        training.agent().actor().act(&mut tape, environment.observation(), &mut expected);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-6, "{settings:?}, {step}: {found}, expected {expected}");
        }
        environment.step(&vec![(f64::from(step) * 0.3).sin(); engine.action_size()]).unwrap();
    }
}
