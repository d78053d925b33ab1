//! What an episode promises: how it begins, what chance does to it, how it ends, and that it continues bit for bit.

use msk::compiler::compile;
use msk::compiler::files::{LoadError, Loader};
use msk::physics;
use msk::physics::model::{JointKind, Model};
use msk::runtime::episode::{
    Ending, Engine, Environment, Episode, EpisodeError, EpisodeKey, Fault, Scratch, Stream, VectorEnvironment,
};
use msk::runtime::library::{BodyLibrary, BoundBody};
use msk::runtime::policy;
use msk::runtime::scene::ground::Ground;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// One file, whatever its path.
struct Text(String);

impl Loader for Text {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if path == Path::new("task.msk") { Ok(self.0.clone()) } else { Err(LoadError::Missing(path.into())) }
    }

    fn load_bytes(&self, path: &Path, _limit: u64) -> Result<Vec<u8>, LoadError> {
        let networks = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/networks");
        std::fs::read(networks.join(path)).map_err(|_| LoadError::Missing(path.into()))
    }
}

/// A task on the human body; `parts` replaces a line of the usual one by another.
pub fn episode(parts: &[(&str, &str)]) -> Environment {
    let mut text = "
task balance {
    body    human
    control 100 Hz
    horizon 12 steps
    init {
        pose neutral
        root { height on ground, velocity [0.2 m/s, 0, 0] }
        noise joints normal(0, 0.03 rad)
        noise velocities normal(0, 0.3 rad/s)
    }
    observe { com.acceleration; prev(pelvis.height); independent.q }
    reward {
        2 upright = torso.up.z
        3 change = 1 s/m * rate(pelvis.height)
    }
    terminate { early when step > 100 }
    success survived
}
"
    .to_string();
    for (from, to) in parts {
        assert!(text.contains(from), "the task has no `{from}`");
        text = text.replace(from, to);
    }
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    let bodies = BODIES.get_or_init(BodyLibrary::default);
    let compilation = compile(Path::new("task.msk"), &Text(text), bodies).unwrap_or_else(|report| panic!("{report}"));
    let task = compilation.tasks[0].clone();
    let BoundBody { model, body, .. } = bodies.stage(&task.body, &task.scene).unwrap();
    Environment::new(model, body, task).unwrap()
}

pub const KEY: EpisodeKey = EpisodeKey { seed: 4, episode: 2 };

/// Steps with the policy `random` until the end, or as often as given.
pub fn advance(episode: &mut Environment, steps: usize) {
    let mut policy = policy::create("random").unwrap();
    let mut action = vec![0.0; episode.context().body.muscles.len()];
    for _ in 0..steps {
        policy.act(&episode.context(), &mut action).unwrap();
        episode.step(&action).unwrap();
    }
}

/// The episode, written and read.
pub fn read_again(episode: &Episode) -> Episode {
    serde_json::from_str(&serde_json::to_string(episode).unwrap()).unwrap()
}

#[test]
fn an_episode_that_was_written_and_read_continues_bit_for_bit() {
    let mut first = episode(&[]);
    first.reset(KEY);
    advance(&mut first, 5);
    let read = read_again(first.episode());
    assert_eq!(&read, first.episode());
    let mut second = episode(&[]);
    assert!(second.engine().accepts(&read));
    second.restore(&read);
    advance(&mut first, 7);
    advance(&mut second, 7);
    assert_eq!(second.episode(), first.episode());
}

#[test]
fn only_episodes_of_the_task_are_accepted() {
    let first = episode(&[]);
    assert!(first.engine().accepts(first.episode()));
    assert!(!first.engine().accepts(&first.engine().episode()), "one that was never reset");
    assert!(!first.engine().accepts(episode(&[("torso.up.z", "pelvis.up.z")]).episode()), "another task");
    for (list, entry) in [("record", "1.0"), ("frame", "1.0"), ("observation", "1.0"), ("position", "1.0"), ("totals", "1.0")] {
        let text = serde_json::to_string(first.episode()).unwrap();
        let longer = text.replacen(&format!("\"{list}\":["), &format!("\"{list}\":[{entry},"), 1);
        assert_ne!(longer, text);
        assert!(!first.engine().accepts(&serde_json::from_str(&longer).unwrap()), "{list}");
    }
}

#[test]
fn an_episode_continues_from_a_snapshot_bit_for_bit() {
    let mut first = episode(&[]);
    first.reset(KEY);
    advance(&mut first, 5);
    let middle = first.snapshot();
    advance(&mut first, 7);

    // In another episode, after other things have happened there.
    let mut second = episode(&[]);
    advance(&mut second, 3);
    second.restore(&middle);
    assert_eq!(second.snapshot(), middle);
    advance(&mut second, 7);
    assert_eq!(second.snapshot(), first.snapshot());
    assert_ne!(first.snapshot(), middle);

    // And in the same one, backwards.
    first.restore(&middle);
    advance(&mut first, 7);
    assert_eq!(second.snapshot(), first.snapshot());
}

#[test]
fn a_control_step_is_ten_physics_steps_under_one_excitation() {
    let mut episode = episode(&[]);
    episode.reset(KEY);
    advance(&mut episode, 2);
    let mut state = episode.state().clone();
    advance(&mut episode, 1);
    state.control.clone_from(&episode.state().control);
    let model = episode.context().model;
    let mut workspace = physics::Workspace::new(model);
    for _ in 0..10 {
        physics::step(model, &mut state, &mut workspace).unwrap();
    }
    assert_eq!(state, *episode.state());
    physics::forward(model, &state, &mut workspace).unwrap();
    assert_eq!(workspace.acceleration, episode.context().workspace.acceleration, "the snapshot is of the new state");
}

#[test]
fn an_episode_depends_on_its_seed_and_index_alone() {
    let mut used = episode(&[]);
    used.reset(EpisodeKey { seed: 9, episode: 9 });
    advance(&mut used, 4);
    used.reset(KEY);
    let mut fresh = episode(&[]);
    fresh.reset(KEY);
    assert_eq!(used.snapshot(), fresh.snapshot());
    let mut other = episode(&[]);
    other.reset(EpisodeKey { episode: 3, ..KEY });
    assert_ne!(other.state(), fresh.state());
}

#[test]
fn it_begins_on_the_ground_within_limits_with_couplings_solved() {
    for index in 0..20 {
        let mut episode = episode(&[]);
        episode.reset(EpisodeKey { seed: 1, episode: index });
        let (context, state) = (episode.context(), episode.state());
        let ground = Ground { model: context.model, kinematics: &context.workspace.kinematics, shapes: &context.body.ground };
        let clearance = ground.clearance(&context.body.shapes);
        assert!(clearance.abs() < 1e-12, "the lowest shape begins {clearance} m above the ground");
        for joint in &context.body.joints {
            let value = state.position[joint.position];
            let within = joint.range.is_none_or(|[low, high]| (low - 1e-12..=high + 1e-12).contains(&value));
            assert!(within || !joint.independent, "{} begins at {value}, outside {:?}", joint.name, joint.range);
        }
        let (mut position, mut velocity) = (state.position.clone(), state.velocity.clone());
        context.body.solve_couplings(context.model, &mut position);
        context.body.solve_coupled_velocities(context.model, &position, &mut velocity);
        assert_eq!((&position, &velocity), (&state.position, &state.velocity));
    }
}

#[test]
fn noise_moves_independent_hinges_and_nothing_else() {
    let mut quiet = episode(&[("normal(0, 0.03 rad)", "normal(0, 0 rad)"), ("normal(0, 0.3 rad/s)", "normal(0, 0 rad/s)")]);
    let mut noisy = episode(&[]);
    quiet.reset(KEY);
    noisy.reset(KEY);
    let root = quiet.context().body.root.free.unwrap();
    let orientation = root.0 + 3..root.0 + 7;
    assert_eq!(noisy.state().position[orientation.clone()], quiet.state().position[orientation]);
    assert_eq!(noisy.state().velocity[root.1..root.1 + 3], [0.2, 0.0, 0.0]);
    assert_eq!(noisy.state().velocity[root.1 + 3..root.1 + 6], [0.0; 3]);
    let body = quiet.context().body;
    let (mut hinges, mut squares) = (0.0, 0.0);
    for joint in body.joints.iter().filter(|joint| joint.independent) {
        let difference = noisy.state().position[joint.position] - quiet.state().position[joint.position];
        let moves = joint.kind == JointKind::Hinge;
        assert_eq!(difference != 0.0, moves, "{}", joint.name);
        assert_eq!(noisy.state().velocity[joint.dof] != 0.0, moves, "{}", joint.name);
        hinges += f64::from(u8::from(moves));
        squares += difference * difference;
    }
    // Root mean square over some 60 hinges: within a third of the deviation that the task asks for.
    assert!((f64::sqrt(squares / hinges) / 0.03 - 1.0).abs() < 0.33, "{}", f64::sqrt(squares / hinges));
}

#[test]
fn one_source_of_chance_does_not_shift_another() {
    let mut both = episode(&[]);
    let mut joints_only = episode(&[("        noise velocities normal(0, 0.3 rad/s)\n", "")]);
    both.reset(KEY);
    joints_only.reset(KEY);
    assert_eq!(both.state().position, joints_only.state().position);
    assert_ne!(both.state().velocity, joints_only.state().velocity);
}

#[test]
fn the_horizon_truncates_and_a_termination_terminates() {
    let mut whole = episode(&[]);
    advance(&mut whole, 12);
    assert_eq!((whole.ending(), whole.success(), whole.steps()), (Some(&Ending::Truncated), true, 12));

    let mut cut = episode(&[("early when step > 100", "early when step > 4; late when step > 3; never when step > 99")]);
    advance(&mut cut, 4);
    assert_eq!((cut.ending(), cut.success(), cut.steps()), (Some(&Ending::Terminated(vec![1])), false, 4));

    // Falling in the very last step is falling.
    let mut last = episode(&[("early when step > 100", "early when step > 11; late when step >= 12")]);
    advance(&mut last, 12);
    assert_eq!(last.ending(), Some(&Ending::Terminated(vec![0, 1])));
}

#[test]
fn an_ended_episode_takes_no_step_until_it_is_reset() {
    let mut episode = episode(&[("horizon 12", "horizon 1")]);
    advance(&mut episode, 1);
    let end = episode.snapshot();
    let action = vec![0.0; 416];
    assert_eq!(episode.step(&action).unwrap_err(), EpisodeError::Ended);
    assert_eq!(episode.snapshot(), end);
    episode.reset(KEY);
    assert!(episode.step(&action).is_ok());
}

#[test]
fn actions_are_clipped_and_their_number_is_checked() {
    let mut clipped = episode(&[]);
    let mut wild = episode(&[]);
    clipped.step(&[1.0; 416]).unwrap();
    wild.step(&[7.5; 416]).unwrap();
    assert_eq!(clipped.snapshot(), wild.snapshot());
    assert_eq!(wild.state().control, [1.0; 416]);
    assert_eq!(wild.step(&[0.0; 415]).unwrap_err(), EpisodeError::ActionSize { expected: 416, found: 415 });
}

#[test]
fn an_action_that_is_no_number_is_a_fault_of_that_episode() {
    let mut episode = episode(&[]);
    advance(&mut episode, 2);
    let before = episode.state().clone();
    let mut action = vec![0.0; 416];
    action[7] = f64::NAN;
    episode.step(&action).unwrap();
    let muscle = episode.context().body.muscles[7].name.clone();
    let Some(Ending::Fault(fault)) = episode.ending() else { panic!("{:?}", episode.ending()) };
    assert!(matches!(fault, Fault::Action { entry, step: 3, .. } if *entry == muscle), "{fault}");
    assert_eq!((episode.steps(), episode.success(), episode.report().reward), (2, false, 0.0));
    assert_eq!(*episode.state(), before, "the state before the fault is kept");
}

#[test]
fn a_term_that_is_no_number_is_a_fault_that_names_it() {
    let mut episode = episode(&[("2 upright = torso.up.z", "2 upright = exp(20000 * step)")]);
    advance(&mut episode, 1);
    let Some(Ending::Fault(fault)) = episode.ending() else { panic!("{:?}", episode.ending()) };
    assert!(fault.to_string().contains("`upright`") && fault.to_string().contains("step 1"), "{fault}");
    assert_eq!((episode.steps(), episode.success()), (0, false));
}

#[test]
fn a_return_beyond_all_numbers_is_a_fault_of_that_episode() {
    // Each reward is finite, and the sum of two is not.
    let mut episode = episode(&[("2 upright = torso.up.z", "2 upright = 5e307 * clip(torso.up.z, 0.9, 1)")]);
    advance(&mut episode, 1);
    let first = episode.episode().total();
    assert!(episode.ending().is_none() && first > 8e307, "{first}");
    advance(&mut episode, 1);
    let Some(Ending::Fault(fault)) = episode.ending() else { panic!("{:?}", episode.ending()) };
    assert!(
        fault.to_string().starts_with("the return is inf after the reward") && fault.to_string().contains("step 2"),
        "{fault}"
    );
    assert_eq!((episode.steps(), episode.episode().total()), (1, first), "the step is not counted");
}

#[test]
fn a_channel_that_is_no_number_is_a_fault_that_names_it() {
    let mut episode = episode(&[("observe { com", "observe { wild = exp(20000 * step); com")]);
    advance(&mut episode, 1);
    let Some(Ending::Fault(fault)) = episode.ending() else { panic!("{:?}", episode.ending()) };
    assert_eq!(fault.to_string(), "the channel `wild` of the observation is inf at step 1");
    assert_eq!((episode.steps(), episode.episode().total()), (0, 0.0));
}

#[test]
fn physics_that_diverges_is_a_fault_that_names_joint_and_time() {
    // Faster than anything that the simulator takes for a number that means something.
    let mut episode = episode(&[("velocity [0.2 m/s, 0, 0]", "velocity [1e12 m/s, 0, 0]")]);
    let Some(Ending::Fault(fault)) = episode.ending() else { panic!("{:?}", episode.ending()) };
    assert!(fault.to_string().contains("joint") && fault.to_string().contains("at 0 s"), "{fault}");
    assert_eq!(episode.step(&[0.0; 416]).unwrap_err(), EpisodeError::Ended);
}

#[test]
fn the_reward_can_be_read_by_terms_and_reweighted_without_compiling() {
    let mut episode = episode(&[]);
    advance(&mut episode, 1);
    let upright = episode.reward().term("upright").unwrap();
    assert!(upright.value > 0.9 && upright.contribution() == 2.0 * upright.value);
    let change = episode.reward().term("change").unwrap();
    assert_eq!(episode.reward().total(), upright.contribution() + change.contribution());
    assert_eq!(episode.reward().term("upside"), None);
    let before = episode.snapshot();
    episode.reset(KEY);
    episode.set_weight(0, 20.0);
    advance(&mut episode, 1);
    assert_eq!(episode.reward().term("upright").unwrap().weight, 20.0);
    episode.restore(&before);
    assert_eq!(episode.weights()[0], 20.0, "weights are settings and no part of a snapshot");
}

#[test]
fn zero_is_rest() {
    let mut episode = episode(&[]);
    let mut action = vec![0.5; 416];
    policy::create("zero").unwrap().act(&episode.context(), &mut action).unwrap();
    episode.step(&action).unwrap();
    assert_eq!(episode.state().control, [0.0; 416]);
}

#[test]
fn new_weights_in_between_change_the_pay_and_not_the_motion() {
    let [mut plain, mut changed] = [episode(&[]), episode(&[])];
    plain.reset(KEY);
    changed.reset(KEY);
    advance(&mut plain, 4);
    advance(&mut changed, 4);
    changed.set_weight(0, 7.5);
    let middle = changed.snapshot();
    advance(&mut plain, 5);
    advance(&mut changed, 5);
    assert_eq!(plain.state(), changed.state());
    assert_ne!(plain.reward().total(), changed.reward().total());

    let (end, total) = (changed.snapshot(), changed.reward().total());
    changed.restore(&middle);
    advance(&mut changed, 5);
    assert_eq!(changed.snapshot(), end);
    assert_eq!(changed.reward().total().to_bits(), total.to_bits());
}

/// A draw, its redraw, an end that is no failure, a metric and another body, in one.
const CHANCE: [(&str, &str); 3] = [
    (
        "    body    human\n",
        "    body    human with muscles.peak_force *= 2, knee_angle_r.damping = 3 N*m*s/rad\n    random goal = uniform(0 m .. 1 m, 0 m .. 2 m) redraw when step == 3\n    random other = normal(0, 1)\n",
    ),
    ("observe { com", "observe { goal; other; com"),
    (
        "terminate {",
        "metrics { goal; tall = running_max(com.height) }\n    finish { done when step >= 9; also when step >= 9 }\n    terminate {",
    ),
];

#[test]
fn randoms_have_streams_of_their_own_and_continue_from_a_snapshot() {
    let mut first = episode(&CHANCE);
    first.reset(KEY);
    let begun: Vec<f64> = first.observation()[..3].to_vec();
    assert!((0.0..1.0).contains(&begun[0]) && (0.0..2.0).contains(&begun[1]));
    advance(&mut first, 2);
    assert_eq!(first.observation()[..3], begun);
    let snapshot = first.snapshot();
    advance(&mut first, 1);
    assert_ne!(first.observation()[..2], begun[..2]);
    assert_eq!(first.observation()[2], begun[2]);
    let mut second = episode(&CHANCE);
    second.restore(&snapshot);
    advance(&mut second, 1);
    assert_eq!(second.snapshot(), first.snapshot());
    // Another random beside it shifts nothing; another episode is another draw.
    let alone = ("    random other = normal(0, 1)\n", "");
    let fewer = [CHANCE[0], CHANCE[1], CHANCE[2], alone, ("other; ", "")];
    let mut third = episode(&fewer);
    third.reset(KEY);
    assert_eq!(third.observation()[..2], begun[..2]);
    third.reset(EpisodeKey { episode: 3, ..KEY });
    assert_ne!(third.observation()[..2], begun[..2]);
}

#[test]
fn a_finish_is_no_failure_and_all_reasons_are_reported() {
    let mut episode = episode(&CHANCE);
    episode.reset(KEY);
    advance(&mut episode, 9);
    assert_eq!(episode.ending(), Some(&Ending::Finished(vec![0, 1])));
    let metrics = &episode.report().metrics;
    assert_eq!((metrics.len(), metrics[..2] == episode.observation()[..2]), (3, true));
    assert!(metrics[2] > 0.7);
}

#[test]
fn a_task_changes_its_own_body_only() {
    let (changed, plain) = (episode(&CHANCE), episode(&[]));
    let of = |episode: &Environment| {
        let context = episode.context();
        let knee = context.body.joints.iter().find(|joint| joint.name == "knee_angle_r").unwrap();
        (
            context.body.muscles[0].peak_force,
            context.model.actuators.muscle(0).unwrap().active[2],
            context.model.dofs.damping[knee.dof],
        )
    };
    let (before, after) = (of(&plain), of(&changed));
    assert_eq!((after.0, after.2), (2.0 * before.0, 3.0));
    assert_eq!(after.1, after.0);
}

#[test]
fn a_draw_that_never_fits_is_a_fault_of_that_episode() {
    let never = ("    control", "    random goal = uniform(0.5..1) where goal > 2\n    control");
    let mut episode = episode(&[never, ("observe { com", "observe { goal; com")]);
    episode.reset(KEY);
    let Some(Ending::Fault(fault @ Fault::Draw(_))) = episode.ending() else { panic!("{:?}", episode.ending()) };
    assert!(fault.to_string().starts_with("none of 64 draws of `goal` at step 0 satisfies `goal > 2`"), "{fault}");
}

#[test]
fn support_and_muscles_are_measured() {
    let watched = "observe { centre_of_pressure; support_margin; moment_arm(soleus_r, ankle_angle_r); soleus_r.fibre_length; soleus_r.tendon_length; soleus_r.length; contact_force(feet, ground).z; body_weight; com";
    let mut episode = episode(&[("observe { com", watched), ("velocity [0.2 m/s, 0, 0]", "velocity [0, 0, 0]")]);
    episode.reset(KEY);
    let seen = episode.observation().to_vec();
    let [x, y, z, margin, arm, fibre, tendon, length, force, weight]: [f64; 10] = seen[..10].try_into().unwrap();
    assert!(z.abs() < 0.02 && x.abs() < 0.3 && y.abs() < 0.3, "{seen:?}");
    // The body is put down until its lowest point touches: the hull of so few contacts lies within a foot's length of `com`.
    assert!((-0.3..0.15).contains(&margin), "{margin}");
    // The calf drives the foot down.
    assert!((-0.08..-0.02).contains(&arm), "{arm}");
    assert!((fibre + tendon - length).abs() < 1e-9 && fibre > 0.0 && tendon > 0.0);
    assert!(force >= 0.0 && (weight - 84.26998825710956 * 9.81).abs() < 1e-9);
}

#[test]
fn many_episodes_have_the_bits_of_each_by_itself_on_any_number_of_threads() {
    const EPISODES: usize = 5;
    let mut alone = episode(&[]);
    let muscles = alone.engine().body().muscles.len();
    let mut noise = Stream::new(KEY, "actions");
    let steps: Vec<Vec<f64>> = (0..3).map(|_| (0..EPISODES * muscles).map(|_| noise.normal()).collect()).collect();
    let mut expected = Vec::new();
    for index in 0..EPISODES {
        alone.reset(EpisodeKey { seed: 9, episode: index as u64 });
        for actions in &steps {
            alone.step(&actions[muscles * index..muscles * (index + 1)]).unwrap();
        }
        expected.push(alone.snapshot());
    }
    for threads in [1, 2, 8] {
        let [count, threads] = [EPISODES, threads].map(|number| NonZeroUsize::new(number).unwrap());
        let mut many = VectorEnvironment::new(alone.engine().clone(), count, threads).unwrap();
        many.reset(9);
        for actions in &steps {
            many.step(actions).unwrap();
        }
        assert!(many.episodes().eq(&expected), "{threads} threads");

        // The next episode of one slot leaves the others alone.
        many.reset_where(&[false, true]);
        let begun: Vec<EpisodeKey> = many.episodes().map(|episode| episode.key()).collect();
        let expected_key = |index: usize| EpisodeKey { seed: 9, episode: if index == 1 { 6 } else { index as u64 } };
        assert_eq!(begun, (0..EPISODES).map(expected_key).collect::<Vec<_>>());
        assert!(many.episodes().zip(&expected).enumerate().all(|(index, (one, other))| (one == other) == (index != 1)));
    }
}

#[test]
fn many_episodes_refuse_actions_of_the_wrong_length_and_leave_ended_ones_alone() {
    let engine = episode(&[("early when step > 100", "early when step > 1")]).engine().clone();
    let muscles = engine.body().muscles.len();
    let two = NonZeroUsize::new(2).unwrap();
    let mut many = VectorEnvironment::new(engine, two, NonZeroUsize::MIN).unwrap();
    let error = many.step(&vec![0.0; muscles]).unwrap_err();
    assert_eq!(error, EpisodeError::ActionSize { expected: 2 * muscles, found: muscles });
    assert!(many.episodes().all(|episode| episode.steps() == 0));
    for _ in 0..4 {
        many.step(&vec![0.0; 2 * muscles]).unwrap();
    }
    assert!(many.episodes().all(|episode| episode.steps() == 2 && episode.ending().is_some()));
}

#[test]
fn an_engine_refuses_episodes_and_scratch_of_others_until_they_are_reset() {
    let engine = episode(&[]).engine().clone();
    let other = episode(&[("early when step > 100", "early when step > 1")]).engine().clone();
    let (action, weights) = (vec![0.0; engine.body().muscles.len()], engine.task().weights());
    let (mut one, mut scratch) = (engine.episode(), engine.scratch());
    let refused = |engine: &Engine, episode: &mut Episode, scratch: &mut Scratch| {
        let before = episode.clone();
        let Err(EpisodeError::Foreign { what, .. }) = engine.step(episode, &action, &weights, scratch) else {
            panic!("what belongs to another engine is refused")
        };
        assert_eq!(*episode, before);
        what
    };
    assert_eq!(refused(&engine, &mut one, &mut scratch), "episode", "it has not been reset yet");
    engine.reset(KEY, &mut one, &mut scratch);
    assert_eq!(refused(&other, &mut one, &mut scratch), "episode");

    // A model of its own, even an equal one: the scratch cannot know.
    let apart = Engine::new(Arc::new(Model::clone(engine.model())), engine.body().clone(), engine.task().clone()).unwrap();
    let mut foreign = apart.scratch();
    assert_eq!(refused(&engine, &mut one, &mut foreign), "scratch");
    engine.reset(KEY, &mut one, &mut foreign);
    engine.step(&mut one, &action, &weights, &mut foreign).unwrap();
    assert_eq!(one.steps(), 1);
}

/// The force on the torso at each step of an episode with pushes.
fn pushes(episode: &mut Environment, key: EpisodeKey, steps: usize) -> Vec<f64> {
    episode.reset(key);
    let torso = episode.context().body.landmarks.iter().find(|landmark| landmark.name == "torso").unwrap().body;
    let action = vec![0.0; episode.context().body.muscles.len()];
    let step = |_| {
        episode.step(&action).unwrap();
        episode.state().body_force[torso][0].y
    };
    (0..steps).map(step).collect()
}

#[test]
fn a_push_is_drawn_comes_again_and_keeps_its_force_while_it_acts() {
    let text = "observe { com.acceleration; prev(pelvis.height); independent.q }
    random side = uniform(20 N .. 60 N) redraw when mod(step, 2) == 0
    random moment = uniform(0.01 s .. 0.03 s)
    disturb torso { force [0 N, side, 0 N], at moment, for 2 steps, every 5 steps }";
    let mut episode = episode(&[("observe { com.acceleration; prev(pelvis.height); independent.q }", text)]);
    let mut seen = Vec::new();
    for index in 0..4 {
        let key = EpisodeKey { episode: index, ..KEY };
        let forces = pushes(&mut episode, key, 12);
        let first = forces.iter().position(|force| *force != 0.0).unwrap();
        assert!((1..=3).contains(&first), "{forces:?}");
        for (step, force) in forces.iter().enumerate() {
            let acts = step >= first && (step - first) % 5 < 2;
            assert_eq!(*force != 0.0, acts, "{step}: {forces:?}");
            assert!(!acts || (20.0..60.0).contains(force));
        }
        // It keeps its force although the random is drawn anew meanwhile; the next one has another.
        assert_eq!(forces[first], forces[first + 1]);
        assert_ne!(forces[first], forces[first + 5]);
        assert_eq!(forces, pushes(&mut episode, key, 12), "the same episode again");
        seen.push((first, forces[first].to_bits()));
    }
    seen.dedup();
    assert!(seen.len() == 4 && seen.iter().any(|(first, _)| *first != seen[0].0), "{seen:?}");
}

#[test]
fn a_snapshot_in_the_middle_of_a_push_goes_on_with_its_force() {
    let text = "observe { com.acceleration; prev(pelvis.height); independent.q }
    random side = uniform(20 N .. 60 N) redraw when mod(step, 2) == 0
    disturb torso { force [0 N, side, 0 N], at 1 steps, for 4 steps }";
    let mut first = episode(&[("observe { com.acceleration; prev(pelvis.height); independent.q }", text)]);
    first.reset(KEY);
    advance(&mut first, 3);
    let middle = first.snapshot();
    advance(&mut first, 4);
    let mut second = first.clone();
    second.reset(EpisodeKey { seed: 99, episode: 7 });
    second.restore(&middle);
    advance(&mut second, 4);
    assert_eq!(first.snapshot(), second.snapshot());
}
