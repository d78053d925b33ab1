//! What a body does among objects: tasks with scenes, from their text to the numbers they read.

use msk::compiler::compile;
use msk::compiler::files::{LoadError, Loader};
use msk::runtime::episode::{Environment, EpisodeKey};
use msk::runtime::library::BodyLibrary;
use nalgebra::Vector3;
use std::path::Path;
use std::sync::OnceLock;

struct Text(String);

impl Loader for Text {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if path == Path::new("task.msk") { Ok(self.0.clone()) } else { Err(LoadError::Missing(path.into())) }
    }
}

/// A task whose scene, initial state and observations are these.
fn episode(scene: &str, init: &str, observe: &str, more: &str) -> Environment {
    let text = format!(
        "task among_things {{
    body    human
    control 100 Hz
    horizon 200 steps
    scene {{ {scene} }}
    init {{ pose neutral
        {init} }}
    observe {{ {observe} }}
    reward {{ 1 upright = torso.up.z }}
    terminate {{ never when t > 100 s }}
    {more}
    success survived
}}
"
    );
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    let bodies = BODIES.get_or_init(BodyLibrary::default);
    let compilation = compile(Path::new("task.msk"), &Text(text), bodies).unwrap_or_else(|report| panic!("{report}"));
    let task = compilation.tasks[0].clone();
    let bound = bodies.stage(&task.body, &task.scene).unwrap();
    Environment::new(bound.model, bound.body, task).unwrap()
}

fn advance(episode: &mut Environment, steps: usize) {
    let action = vec![-1.0; episode.context().body.muscles.len()];
    for _ in 0..steps {
        episode.step(&action).unwrap();
        assert!(!matches!(episode.ending(), Some(msk::runtime::episode::Ending::Fault(_))), "{:?}", episode.ending());
    }
}

/// The three numbers of a channel.
fn vector(episode: &Environment, channel: &str) -> Vector3<f64> {
    let channel = episode.task().channels.iter().find(|known| known.name == channel).expect("the channel is observed");
    Vector3::from_column_slice(&episode.observation()[channel.offset..channel.offset + 3])
}

fn number(episode: &Environment, channel: &str) -> f64 {
    let channel = episode.task().channels.iter().find(|known| known.name == channel).expect("the channel is observed");
    episode.observation()[channel.offset]
}

const BALL: &str = "ground; sphere ball { radius 11 cm, mass 0.4 kg, free, at [3 m, 0, 1.2 m] }";

#[test]
fn a_ball_flies_as_it_was_thrown() {
    let mut episode =
        episode(BALL, "ball { velocity [-4 m/s, 0, 1 m/s], spin [0, 2 rad/s, 0] }", "ball.position; ball.angular_velocity", "");
    assert_eq!(vector(&episode, "ball.position"), Vector3::new(3.0, 0.0, 1.2));
    advance(&mut episode, 20);
    // After n steps of h the semi-implicit rule has fallen g h² n (n + 1) / 2.
    let fallen = 9.81 * 1e-6 * 200.0 * 201.0 / 2.0;
    let expected = Vector3::new(3.0 - 0.8, 0.0, 1.2 + 0.2 - fallen);
    assert!((vector(&episode, "ball.position") - expected).norm() < 1e-9, "{}", vector(&episode, "ball.position"));
    assert!((vector(&episode, "ball.angular_velocity") - Vector3::new(0.0, 2.0, 0.0)).norm() < 1e-9);
}

#[test]
fn a_resting_ball_presses_on_the_ground_with_its_weight() {
    let observe = "ball_touches = touching(ball, ground); push = contact_force(ball, ground); points = contact_count(ball, ground)
        room = surface_distance(ball, ground); slide = slip(ball, ground); ball.clearance; apart = surface_distance(sole_l, ball)";
    let mut episode = episode(BALL, "ball { at [3 m, 0, 0.1099 m] }", observe, "");
    advance(&mut episode, 100);
    assert_eq!((number(&episode, "ball_touches"), number(&episode, "points")), (1.0, 1.0));
    let push = vector(&episode, "push");
    assert!((push - Vector3::new(0.0, 0.0, 0.4 * 9.81)).norm() < 1e-3, "{push}");
    assert!(number(&episode, "slide") < 1e-9 && number(&episode, "room").abs() < 1e-3);
    assert!((number(&episode, "room") - number(&episode, "ball.clearance")).abs() < 1e-12);
    assert!(number(&episode, "apart") > 1.0);
}

#[test]
fn hands_hold_a_bar_where_they_stand_until_they_let_go() {
    let scene = "body bar { at [0.5 m, 0, 1.5 m], free
            capsule shaft { along [0, 1, 0], length 1.2 m, radius 1 cm, mass 5 kg } }
        weld palm_l to bar here release when t > 0.1 s
        weld palm_r to bar here release when t > 0.1 s";
    let offset = |episode: &Environment| {
        let [palm, bar] = ["palm_l.position", "bar.position"].map(|channel| vector(episode, channel));
        (palm - bar).norm()
    };
    let mut episode = episode(scene, "root { height 2 m }", "palm_l.position; bar.position", "");
    let report = episode.inspect_start(EpisodeKey::default()).unwrap();
    assert!(report.residuals.is_empty(), "{report:?}");
    let begun = offset(&episode);
    advance(&mut episode, 10);
    assert!((offset(&episode) - begun).abs() < 0.01, "{begun} m became {} m", offset(&episode));
    assert!(episode.state().active.iter().rev().take(2).all(|active| *active == 1.0));
    advance(&mut episode, 2);
    assert!(episode.state().active.iter().rev().take(2).all(|active| *active == 0.0), "released");
    // A snapshot of a released weld goes on alike.
    let middle = episode.snapshot();
    advance(&mut episode, 8);
    let end = episode.snapshot();
    episode.restore(&middle);
    advance(&mut episode, 8);
    assert!(episode.snapshot() == end);
}

#[test]
fn a_weld_that_does_not_fit_is_reported_with_its_numbers() {
    let scene = "ground; body bar { at [0.5 m, 0, 1.5 m], free
            capsule shaft { along [0, 1, 0], length 1.2 m, radius 1 cm, mass 5 kg } }
        weld palm_l to bar";
    let episode = episode(scene, "", "palm_l.position; bar.position", "");
    let report = episode.inspect_start(EpisodeKey::default()).unwrap();
    let [residual] = report.residuals.as_slice() else { panic!("{report:?}") };
    let expected = (vector(&episode, "palm_l.position") - vector(&episode, "bar.position")).norm();
    assert!((residual.distance - expected).abs() < 1e-9 && residual.turn > 0.1, "{residual:?}");
}

#[test]
fn a_penetration_at_reset_is_reported_with_its_depth() {
    let scene = "ground; sphere stone { radius 20 cm, mass 2 kg, free, at [3 m, 0, 15 cm] }";
    let report = episode(scene, "", "stone.position", "").inspect_start(EpisodeKey::default()).unwrap();
    let [penetration] = report.penetrations.as_slice() else { panic!("{report:?}") };
    assert_eq!(penetration.shapes, ["floor", "stone"]);
    assert!((penetration.depth - 0.05).abs() < 1e-12);
}

#[test]
fn a_push_changes_the_momentum_by_force_times_time() {
    let fall = |more: &str| episode("", "root { height 5 m }", "com.velocity", more);
    let velocity = |mut episode: Environment, steps: usize| {
        advance(&mut episode, steps);
        vector(&episode, "com.velocity")
    };
    let free = velocity(fall(""), 10);
    let disturbed = velocity(fall("disturb pelvis { force [50 N, 20 N, 0], at 0.02 s, for 0.05 s }"), 10);
    let pushed = {
        let mut episode = fall("");
        advance(&mut episode, 2);
        let pelvis = episode.context().body.landmarks.iter().position(|landmark| landmark.name == "pelvis").unwrap();
        episode.push(pelvis, [[50.0, 20.0, 0.0], [0.0; 3]], 5);
        let middle = episode.snapshot();
        advance(&mut episode, 8);
        let first = episode.snapshot();
        episode.restore(&middle);
        advance(&mut episode, 8);
        assert!(episode.snapshot() == first, "a push is part of the snapshot");
        vector(&episode, "com.velocity")
    };
    assert_eq!(disturbed, pushed, "the task's push and an evaluation's are the same");
    let mass = fall("").context().body.mass;
    let gained = (disturbed - free) * mass;
    // Joint damping is internal: only the push changes the momentum, but for what the integrator's damping takes.
    assert!((gained - Vector3::new(2.5, 1.0, 0.0)).norm() < 0.02, "{gained}");
}

#[test]
fn settling_lets_things_come_to_rest_before_the_time_begins() {
    let init = "ball { at [3 m, 0, 0.1099 m] }\n settle 200 ms with activation 0.2";
    let settled = episode(BALL, init, "ball.velocity; muscles.activation; clock = t", "");
    assert!(vector(&settled, "ball.velocity").norm() < 1e-2);
    assert_eq!((number(&settled, "clock"), settled.steps(), settled.state().time), (0.0, 0, 0.0));
    assert!(settled.state().activation.iter().all(|activation| (activation - 0.2).abs() < 1e-12));
    let at_rest = episode(BALL, &format!("{init} at rest"), "ball.velocity", "");
    assert!(at_rest.state().velocity.iter().all(|velocity| *velocity == 0.0));
}

#[test]
fn a_root_goes_where_its_hands_shall_be() {
    let scene = "body bar { at [0.4 m, 0, 2.3 m]
            capsule shaft { along [0, 1, 0], length 1.2 m, radius 2 cm }
            point grip_l { at [0, 0.3 m, 0] }
            point grip_r { at [0, -0.3 m, 0] } }";
    let init = "root { align palm_l to bar.grip_l, align palm_r to bar.grip_r }";
    let episode = episode(scene, init, "palm_l.position; palm_r.position", "");
    let middle = (vector(&episode, "palm_l.position") + vector(&episode, "palm_r.position")) / 2.0;
    assert!((middle - Vector3::new(0.4, 0.0, 2.3)).norm() < 1e-9, "{middle}");
}

#[test]
fn a_body_stands_on_what_is_walkable_under_it() {
    let scene = "ground; ellipsoid stone { size [2 m, 2 m, 0.4 m], at [0, 0, 0.1 m], walkable }";
    let episode = episode(scene, "", "sole_l.clearance; under = ground_height(pelvis)", "");
    let lowest = episode.context().body.landmarks.iter().filter(|landmark| landmark.name.starts_with("sole"));
    assert_eq!(lowest.count(), 2);
    assert!((-1e-9..0.02).contains(&number(&episode, "sole_l.clearance")), "{}", number(&episode, "sole_l.clearance"));
    assert!((number(&episode, "under") - 0.3).abs() < 0.01, "{}", number(&episode, "under"));
    let report = episode.inspect_start(EpisodeKey::default()).unwrap();
    assert!(report.penetrations.is_empty(), "{report:?}");
}
