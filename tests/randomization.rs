//! Domain randomization: what is drawn of body and scene acts in the physics, for the whole episode, and for that episode alone.

use super::episodes::episode;
use msk::physics;
use msk::runtime::body::Body;
use msk::runtime::episode::{Ending, Environment, EpisodeKey, Fault};
use nalgebra::Vector2;

/// Of all that may be drawn something.
pub const DRAWN: &[(&str, &str)] = &[
    (
        "    init {\n        pose neutral\n        root { height on ground, velocity [0.2 m/s, 0, 0] }",
        "    random grade = uniform(-8 deg .. 8 deg)
    random load  = uniform(1 kg .. 20 kg)
    random grip  = uniform(0.1 .. 1)
    random there = uniform(0.5 m .. 1 m, -0.3 m .. 0.3 m)
    random bend  = uniform(10 deg .. 40 deg)
    random weak  = uniform(0.2 .. 0.6)
    random tall  = uniform(0.8 m .. 1.2 m)
    random rise  = uniform(8 cm .. 16 cm)
    random wave  = uniform(1 cm .. 4 cm)
    random tight = uniform(0.5 .. 2)
    scene {
        slope hill { length 6 m, width 6 m, angle grade, at [-3 m, 0, 0], friction grip }
        box pack on torso { size [15 cm, 30 cm, 40 cm], at [-20 cm, 0, 0], mass load, solid false }
        box post { size [10 cm, 10 cm, tall], at [there[0], there[1], 1 m], orientation 5 * grade }
        stairs flight { count 3, rise rise, run 3 * rise, width 1 m, at [5 m, 0, 0] }
        heights waves { size [2 m, 1 m], samples [21, 3], height wave * (1 + x / 1 m), at [0, 5 m, 0] }
        sphere ball { radius 0.1 * tall, mass 2 kg, free, at [0, -5 m, 0.27 m] }
        box belt { size [1 m, 1 m, 0.1 m], at [0, -5 m, 0.1 m], moves [0.1 m * tight * sin(90 deg/s * t), 0, 0], turns 20 deg/s * t }
        body door {
            at [0, -3 m, 0.1 m]
            hinge swing { axis [0, 0, 1], damping 1 N*m*s/rad * tight, stiffness 4 N*m/rad * tight }
            box leaf { size [4 cm, 1 m, 1 m], at [0, 0.5 m, 0.5 m], mass 5 kg }
        }
    }
    init {
        pose neutral { knee_angle_r = bend }
        root { height on ground, velocity [0.2 m/s, 0, 0] }
        strength calves  weak
        strength muscles uniform(0.9 .. 1.1)
        mass     robot   uniform(0.8 .. 1.25)
        damping  knee_angle_r tight
        damping  joints uniform(0.9 .. 1.1)",
    ),
    (
        "observe {",
        "observe { post = post.position; pack.mass; hill.angle; ground = ground_height(pelvis); load; grade; bend; there; grip; weak; tall; rise; wave; tight; size = post.size; flight.length; ball.radius;",
    ),
];

fn key(episode: u64) -> EpisodeKey {
    EpisodeKey { seed: 8, episode }
}

/// The numbers of a channel.
fn seen(environment: &Environment, channel: &str) -> Vec<f64> {
    let channels = &environment.engine().task().channels;
    let channel = channels.iter().find(|known| known.name == channel).unwrap_or_else(|| panic!("no channel `{channel}`"));
    environment.observation()[channel.offset..channel.offset + channel.size].to_vec()
}

fn object(body: &Body, name: &str) -> usize {
    let scene = body.landmarks.iter().filter(|landmark| landmark.of_scene);
    scene.clone().position(|landmark| landmark.name == name).unwrap()
}

#[test]
fn what_is_drawn_is_what_acts() {
    let mut environment = episode(DRAWN);
    let mut loads = Vec::new();
    for index in 0..4 {
        environment.reset(key(index));
        assert_eq!(environment.ending(), None);
        let context = environment.context();
        let (body, model, state) = (context.body, context.model, context.state);
        let kinematics = &context.workspace.kinematics;
        let one = |channel: &str| seen(&environment, channel)[0];

        let pack = body.objects[object(body, "pack")].body;
        assert!((kinematics.mass[pack] - one("load")).abs() < 1e-12);
        assert_eq!(one("pack.mass"), one("load"));
        loads.push(one("load"));

        let hill = &body.objects[object(body, "hill")];
        assert!(hill.shapes.iter().all(|&shape| state.friction[shape] == one("grip")));
        // The slope begins three metres behind, and the ground under the pelvis is that of its plane.
        let height = libm::tan(one("grade")) * (3.0 + context.snapshot().body.landmark_position(kinematics, pelvis(body)).x);
        assert!((one("ground") - height).abs() < 1e-9, "{} at {}", one("ground"), one("grade"));
        assert_eq!(one("hill.angle"), one("grade"));

        let there = seen(&environment, "there");
        assert_eq!(seen(&environment, "post"), [there[0], there[1], 1.0]);

        let knee = body.joints.iter().find(|joint| joint.name == "knee_angle_r").unwrap();
        assert!((state.position[knee.position] - one("bend")).abs() < 0.2, "noise apart");

        let calves = &body.groups.iter().find(|group| group.name == "calves").unwrap().members;
        for (muscle, &strength) in state.strength.iter().enumerate() {
            let share = if calves.contains(&muscle) { one("weak") } else { 1.0 };
            assert!((0.9 * share..=1.1 * share).contains(&strength), "{strength}");
        }
        let all = |channel: &str| seen(&environment, channel);
        let post_shape = context.state.overrides.shape(0, body.objects[object(body, "post")].shapes[0]).unwrap();
        assert_eq!(post_shape.size.as_slice(), [0.05, 0.05, 0.5 * one("tall")]);
        assert_eq!(all("size"), [0.1, 0.1, one("tall")]);
        assert_eq!([one("flight.length"), one("ball.radius")], [3.0 * (3.0 * one("rise")), 0.1 * one("tall")]);
        let ground = |x: f64, y: f64| context.snapshot().ground().height(Vector2::new(x, y));
        for step in 0..3 {
            let (place, top) = (5.0 + (f64::from(step) + 0.5) * 3.0 * one("rise"), f64::from(step + 1) * one("rise"));
            assert!((ground(place, 0.0) - top).abs() < 1e-12, "{} {top}", ground(place, 0.0));
        }
        assert!((ground(0.5, 5.0) - 1.5 * one("wave")).abs() < 1e-9 && (ground(2.0, 5.2) - 3.0 * one("wave")).abs() < 1e-9);

        let swing = body.joints.iter().find(|joint| joint.name == "door.swing").unwrap();
        assert_eq!([state.damping[swing.dof], state.stiffness[swing.index]], [one("tight"), 4.0 * one("tight")]);
        let damping = |name: &str| {
            let joint = body.joints.iter().find(|joint| joint.name == name).unwrap();
            state.damping[joint.dof] / model.dofs.damping[joint.dof]
        };
        assert!((0.9..=1.1).contains(&damping("knee_angle_l")), "{}", damping("knee_angle_l"));
        assert!((0.9..=1.1).contains(&(damping("knee_angle_r") / one("tight"))), "{}", damping("knee_angle_r"));

        let own: Vec<f64> = body.own().map(|segment| state.mass_scale[segment]).collect();
        assert!(own.iter().all(|scale| (0.8..=1.25).contains(scale)) && own.iter().any(|scale| *scale != own[0]));
        assert_eq!(
            model.bodies.mass.iter().zip(&state.mass_scale).map(|(mass, scale)| mass * scale).collect::<Vec<_>>(),
            kinematics.mass
        );
    }
    assert!(loads.windows(2).all(|pair| pair[0] != pair[1]), "{loads:?}");
}

fn pelvis(body: &Body) -> usize {
    body.landmarks.iter().position(|landmark| landmark.name == "pelvis").unwrap()
}

/// The active force of a weak muscle in MuJoCo's formula: gain times strength.
#[test]
fn a_weak_muscle_pulls_less_and_its_passive_force_stays() {
    let mut healthy = episode(&[]);
    let mut weak = episode(&[("pose neutral", "pose neutral\n        strength muscles 0.25")]);
    healthy.reset(key(1));
    weak.reset(key(1));
    let (healthy, weak) = (healthy.context(), weak.context());
    assert_eq!(healthy.state.position, weak.state.position);
    let (before, after) = (&healthy.workspace.actuation, &weak.workspace.actuation);
    assert_eq!(before.gain.iter().map(|gain| gain * 0.25).collect::<Vec<_>>(), after.gain);
    assert_eq!(before.bias, after.bias);
}

#[test]
fn a_heavier_load_presses_harder_on_the_ground() {
    // A box at rest on the ground.
    let force = |mass: &str| {
        let scene = format!(
            "scene {{ ground; box cube {{ size [0.2 m, 0.2 m, 0.2 m], free, at [2 m, 0, 0.1 m], mass {mass} }} }}\n    init {{"
        );
        let random = format!("random load = uniform(3 kg .. 3.000001 kg)\n    {scene}");
        let observed = "observe { force = contact_force(cube, ground); load;";
        let mut environment = episode(&[("init {", &random), ("observe {", observed), ("horizon 12 steps", "horizon 100 steps")]);
        environment.reset(key(0));
        let action = vec![-1.0; environment.engine().action_size()];
        (0..60).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
        seen(&environment, "force")[2]
    };
    let (known, drawn, heavy) = (force("3 kg"), force("load"), force("3 * load"));
    assert!(
        (known - 3.0 * 9.81).abs() < 0.3 && (drawn - known).abs() < 0.3 && (heavy - 9.0 * 9.81).abs() < 0.9,
        "{known} {drawn} {heavy}"
    );
}

/// The larger of two constant frictions counts; a drawn one decides.
#[test]
fn a_drawn_friction_decides_a_contact_alone() {
    let way = |friction: &str| {
        let scene = format!(
            "random grip = uniform(0.05 .. 0.0500001)\n    scene {{ ground {{ friction {friction} }}; box cube {{ size [0.2 m, 0.2 m, 0.2 m], free, at [2 m, 0, 0.1 m], mass 3 kg }} }}\n    init {{\n        cube {{ velocity [1 m/s, 0, 0] }}"
        );
        let parts = [
            ("init {", scene.as_str()),
            ("observe {", "observe { place = cube.position; grip;"),
            ("horizon 12 steps", "horizon 100 steps"),
        ];
        let mut environment = episode(&parts);
        environment.reset(key(0));
        let action = vec![-1.0; environment.engine().action_size()];
        (0..40).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
        seen(&environment, "place")[0] - 2.0
    };
    // v² / 2 μ g with the cube's own friction 1, and v t - μ g t² / 2 with the drawn one.
    assert!((way("0.05") - 0.051).abs() < 0.01, "{}", way("0.05"));
    assert!((way("grip") - 0.361).abs() < 0.01, "{}", way("slip"));
}

#[test]
fn a_thing_that_is_placed_stands_in_the_way() {
    // A ball rolls against a wall whose place is drawn.
    let parts = [
        (
            "init {",
            "random far = uniform(2.4 m .. 2.6 m)
    scene { ground; box wall { size [0.1 m, 1 m, 1 m], at [far, 0, 0.5 m] }; sphere ball { radius 10 cm, mass 1 kg, free, at [2 m, 0, 0.1 m] } }
    init {
        ball { velocity [2 m/s, 0, 0] }",
        ),
        ("observe {", "observe { place = ball.position; hit = touching(ball, wall); far;"),
        ("horizon 12 steps", "horizon 100 steps"),
    ];
    let mut environment = episode(&parts);
    for index in 0..3 {
        environment.reset(key(index));
        let (far, action) = (seen(&environment, "far")[0], vec![-1.0; environment.engine().action_size()]);
        let (mut hits, mut farthest) = (0, 0.0_f64);
        for _ in 0..50 {
            environment.step(&action).unwrap();
            hits += usize::from(seen(&environment, "hit")[0] > 0.5);
            farthest = farthest.max(seen(&environment, "place")[0]);
        }
        assert!(hits > 0 && (farthest - (far - 0.15)).abs() < 0.02, "{hits} {farthest} {far}");
    }
}

#[test]
fn an_episode_of_a_randomized_task_continues_from_what_was_written() {
    let mut environment = episode(DRAWN);
    environment.reset(key(2));
    let action = vec![0.1; environment.engine().action_size()];
    (0..3).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
    let text = serde_json::to_string(&environment.snapshot()).unwrap();
    (0..5).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
    let expected = environment.snapshot();
    environment.reset(key(3));
    environment.restore(&serde_json::from_str(&text).unwrap());
    (0..5).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
    assert!(environment.snapshot() == expected);
}

#[test]
fn a_draw_of_a_test_that_no_scene_can_have_is_a_fault() {
    let mut environment = episode(DRAWN);
    let load = environment.engine().task().randoms.iter().position(|random| random.name == "load").unwrap();
    environment.reset_given(key(0), &[(load, vec![-1.0])]);
    let Some(Ending::Fault(fault @ Fault::Variation { value: -1.0, .. })) = environment.ending() else {
        panic!("{:?}", environment.ending());
    };
    assert_eq!(fault.to_string(), "the mass of `pack` of this episode is -1; expected a number above 0");
}

/// What is drawn from next to nothing acts as what is written.
#[test]
fn a_size_that_is_drawn_acts_as_one_that_is_written() {
    let last = |tall: &str, stiff: &str| {
        let scene = format!(
            "random tall = uniform(0.4 m .. 0.400000000001 m)
    random stiff = uniform(6 .. 6.00000000001)
    scene {{
        ground
        box table {{ size [1 m, 1 m, {tall}], at [2 m, 0, 0.2 m] }}
        box cube {{ size [0.1 m, 0.2 m, {tall} / 2], mass 2 kg, free, at [2 m, 0.5 m, 0.55 m], orientation [20 deg, 0, 0] }}
        heights bed {{ size [1 m, 1 m], samples [5, 5], height {tall} - 0.1 m * x * y / 1 m^2, at [4 m, 0, 0] }}
        sphere ball {{ radius {tall} / 4, mass 1 kg, free, at [4.6 m, 0.1 m, 0.6 m] }}
        body door {{
            at [6 m, 0, 0]
            hinge swing {{ axis [0, 0, 1], damping 0.1 N*m*s/rad * {stiff}, stiffness 1 N*m/rad * {stiff} }}
            box leaf {{ size [0.1 m, 1 m, {tall}], at [0, 0.5 m, 1 m], mass 3 kg }}
        }}
    }}
    init {{
        door {{ swing 40 deg }}"
        );
        let observed = "observe { cube = cube.position; turned = cube.angular_velocity; ball = ball.position; swing = door.swing.q; tall; stiff;";
        let mut environment = episode(&[("init {", &scene), ("observe {", observed), ("horizon 12 steps", "horizon 100 steps")]);
        environment.reset(key(0));
        let action = vec![-1.0; environment.engine().action_size()];
        (0..50).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
        ["cube", "turned", "ball", "swing"].map(|channel| seen(&environment, channel)).concat()
    };
    let (written, drawn) = (last("0.4 m", "6"), last("tall", "stiff"));
    for (written, drawn) in written.iter().zip(&drawn) {
        assert!((written - drawn).abs() < 1e-5, "{written} {drawn}");
    }
    assert!(written[2] < 0.52 && written[8] < 0.55, "the cube lies on the table, the ball in the bed: {written:?}");
}

#[test]
fn a_size_that_no_shape_can_have_is_a_fault_of_that_episode() {
    let mut environment = episode(DRAWN);
    let randoms = &environment.engine().task().randoms;
    let place = |name: &str| randoms.iter().position(|random| random.name == name).unwrap();
    let faults = [
        ("tall", -1.0, "`size.z` of `post` of this episode is -1; expected a number above 0"),
        ("rise", 0.0, "`rise` of `flight` of this episode is 0; expected a number other than 0"),
        (
            "tight",
            -0.5,
            "the factor of the damping of `knee_angle_r` of this episode is -0.5; expected a number that is not negative",
        ),
    ];
    let faults = faults.map(|(name, value, text)| (place(name), value, text));
    for (random, value, text) in faults {
        environment.reset_given(key(0), &[(random, vec![value])]);
        let Some(Ending::Fault(fault)) = environment.ending() else { panic!("{:?}", environment.ending()) };
        assert_eq!(fault.to_string(), text);
        environment.reset(key(1));
        assert_eq!(environment.ending(), None, "the next episode goes on");
    }
}

#[test]
fn a_factor_of_a_stiffness_that_is_not_there_is_refused() {
    use msk::runtime::episode::EpisodeError;
    let environment = episode(&[]);
    let engine = environment.engine();
    let mut task = (**engine.task()).clone();
    let scaling = msk::compiler::init::Scaling { members: vec![0], factor: 2.0, each: None };
    task.init.variation.stiffnesses.push(scaling);
    let refused = msk::runtime::episode::Engine::new(engine.model().clone(), engine.body().clone(), task.into());
    let Err(EpisodeError::NothingToScale { what: "stiffness", joint }) = refused else { panic!() };
    assert_eq!(joint, engine.body().joints[0].name);
}

/// The simulator by itself: the acceleration of a falling body does not depend on its mass, that of a pushed one does.
#[test]
fn masses_of_a_state_scale_inertia_and_weight() {
    use msk::physics::model::Model;
    use msk::physics::{State, Workspace};
    let text =
        r#"<mujoco><worldbody><body pos="0 0 1"><freejoint/><geom type="box" size="0.1 0.2 0.3"/></body></worldbody></mujoco>"#;
    let model = Model::from_mjcf(text).unwrap();
    let mut workspace = Workspace::new(&model);
    let mut acceleration = |scale: f64| {
        let mut state = State::new(&model);
        state.mass_scale[1] = scale;
        state.applied_force[0] = 10.0;
        state.applied_force[4] = 0.3;
        physics::forward(&model, &state, &mut workspace).unwrap();
        workspace.acceleration.clone()
    };
    let (light, heavy) = (acceleration(1.0), acceleration(4.0));
    assert_eq!(light[2], heavy[2]);
    assert!((light[0] - 4.0 * heavy[0]).abs() < 1e-12 && (light[4] - 4.0 * heavy[4]).abs() < 1e-12);
}

/// A body that is stimulated in full burns more than one at rest, in proportion to the masses of its muscles.
#[test]
fn metabolic_power_is_measured_for_every_muscle() {
    let observed =
        "observe { power = muscles.metabolic_power; total = sum(muscles.metabolic_power); strength = soleus_r.strength;";
    let mut environment = episode(&[("observe {", observed), ("pose neutral", "pose neutral\n        strength soleus_r 0.5")]);
    environment.reset(key(0));
    let total = |environment: &Environment| seen(environment, "total")[0];
    let rest = total(&environment);
    // Some 30 kg of muscle at 1 W/kg.
    assert!((10.0..60.0).contains(&rest), "{rest} W at rest");
    assert_eq!(seen(&environment, "strength"), [0.5]);
    let action = vec![1.0; environment.engine().action_size()];
    (0..10).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
    let power = seen(&environment, "power");
    assert!(power.iter().all(|power| *power >= 0.0) && total(&environment) > 50.0 * rest, "{} W", total(&environment));
}
