//! What an action asks for in each action space, and that it asks for the same alone, beside others and from a snapshot.

use super::episodes::episode;
use msk::runtime::action::{ActionBuffer, ActsOn, ControlMemory, REST, excitation};
use msk::runtime::episode::{Ending, Environment, EpisodeKey, Fault};
use msk::runtime::policy;

const KEY: EpisodeKey = EpisodeKey { seed: 4, episode: 2 };

/// Episodes of the usual task with an action space.
fn acting(act: &str) -> Environment {
    acting_and(act, &[])
}

fn acting_and(act: &str, parts: &[(&str, &str)]) -> Environment {
    let control = format!("control 100 Hz\n    {act}");
    let mut all = vec![("control 100 Hz", control.as_str())];
    all.extend_from_slice(parts);
    let mut environment = episode(&all);
    environment.reset(KEY);
    environment
}

/// A pose that is the same in every episode, at rest.
const STILL: [(&str, &str); 4] = [
    (", velocity [0.2 m/s, 0, 0]", ""),
    ("noise joints normal(0, 0.03 rad)", ""),
    ("noise velocities normal(0, 0.3 rad/s)", ""),
    ("horizon 12 steps", "horizon 200 steps"),
];

fn muscle(environment: &Environment, name: &str) -> usize {
    environment.context().body.muscles.iter().position(|muscle| muscle.name == name).unwrap()
}

fn excited(environment: &Environment, action: f64) -> f64 {
    excitation(environment.context().body.excitation, action)
}

/// Steps with the policy, in the entries that it has.
fn play(environment: &mut Environment, name: &str, steps: usize) {
    let mut policy = policy::create(name).unwrap();
    policy.reset(&environment.context()).unwrap();
    let mut action = environment.engine().action(policy.acts_on());
    for _ in 0..steps {
        policy.act(&environment.context(), &mut action.entries).unwrap();
        environment.step(&action).unwrap();
    }
}

#[test]
fn muscles_that_are_not_controlled_rest() {
    let mut environment = acting("act muscles { of [soleus_{l,r}, recfem_r], scale 0.5 }");
    assert_eq!(environment.task().action.names(&environment.task().vocabulary), ["soleus_l", "soleus_r", "recfem_r"]);
    environment.step(&[1.0, 0.2, -3.0]).unwrap();
    let control = environment.state().control.clone();
    for (name, action) in [("soleus_l", 0.5), ("soleus_r", 0.1), ("recfem_r", -0.5), ("recfem_l", REST)] {
        assert_eq!(control[muscle(&environment, name)], excited(&environment, action), "{name}");
    }
    let others = control.iter().filter(|control| **control == excited(&environment, REST)).count();
    assert_eq!(others, 416 - 3);
}

#[test]
fn muscles_of_a_synergy_share_its_action() {
    let mut environment = acting("act synergies { of [calves, [recfem_l, vaslat_l]], sides }");
    let names = environment.task().action.names(&environment.task().vocabulary);
    assert_eq!(names, ["calves_l", "calves_r", "synergy_2_l"]);
    environment.step(&[0.25, -0.5, 0.75]).unwrap();
    let control = environment.state().control.clone();
    for (name, action) in [("soleus_l", 0.25), ("gaslat_l", 0.25), ("soleus_r", -0.5), ("recfem_l", 0.75), ("recfem_r", REST)] {
        assert_eq!(control[muscle(&environment, name)], excited(&environment, action), "{name}");
    }
}

#[test]
fn muscles_come_to_the_activations_that_they_are_asked_for() {
    let mut environment = acting_and("act muscles { of [soleus_{l,r}, recfem_r], activations }", &STILL);
    let activation = |environment: &Environment, name: &str| {
        let context = environment.context();
        let slot = context.model.actuators.muscles().nth(muscle(environment, name)).unwrap().1.activation;
        environment.state().activation[slot]
    };
    // Within reach of a control step of 10 ms; then down by more than muscles relax in it, and up by more than they contract.
    environment.step(&[-0.6, -0.9, REST]).unwrap();
    for (name, wanted) in [("soleus_l", 0.2), ("soleus_r", 0.05), ("recfem_r", 0.0), ("recfem_l", 0.0)] {
        assert!((activation(&environment, name) - wanted).abs() < 1e-6, "{name}");
    }
    environment.step(&[-0.64, -0.9, REST]).unwrap();
    for (name, wanted) in [("soleus_l", 0.18), ("soleus_r", 0.05)] {
        assert!((activation(&environment, name) - wanted).abs() < 1e-6, "{name}");
    }
    environment.step(&[REST, 1.0, REST]).unwrap();
    let control = |environment: &Environment, name: &str| environment.state().control[muscle(environment, name)];
    assert_eq!([control(&environment, "soleus_l"), control(&environment, "soleus_r")], [0.0, 1.0]);
    assert!(0.1 < activation(&environment, "soleus_l") && activation(&environment, "soleus_r") < 0.8);
}

#[test]
fn activations_that_a_controller_leads_to_lead_to_the_same_states() {
    let mut controlled = acting_and("act muscles", &STILL);
    let mut asked = acting_and("act muscles { activations }", &STILL);
    let mut policy = policy::create("cmc").unwrap();
    policy.reset(&controlled.context()).unwrap();
    let mut muscles = controlled.engine().action(ActsOn::Muscles);
    let mut memory = ControlMemory::default();
    for step in 0..20 {
        policy.act(&controlled.context(), &mut muscles.entries).unwrap();
        let mut entries = muscles.entries.clone();
        memory.predict(&controlled.context(), &mut entries);
        controlled.step(&muscles).unwrap();
        asked.step(&entries).unwrap();
        let differences =
            controlled.state().activation.iter().zip(&asked.state().activation).map(|(one, other)| (one - other).abs());
        let most = differences.fold(0.0, f64::max);
        assert!(most < 1e-6, "{most} at step {step}");
    }
}

#[test]
fn an_action_takes_effect_after_the_latency() {
    let mut environment = acting("act muscles { of [soleus_r], latency 2 steps }");
    let soleus = muscle(&environment, "soleus_r");
    let mut seen = Vec::new();
    for action in [0.5, 0.0, -0.5, 0.25] {
        environment.step(&[action]).unwrap();
        seen.push(environment.state().control[soleus]);
    }
    let expected = [REST, REST, 0.5, 0.0].map(|action| excited(&environment, action));
    assert_eq!(seen, expected);
}

#[test]
fn a_filter_answers_as_its_differential_equation_does() {
    let mut environment = acting("act muscles { of [soleus_r], filter 30 ms }");
    let soleus = muscle(&environment, "soleus_r");
    for step in 1..=9 {
        environment.step(&[1.0]).unwrap();
        // y = 1 + (y₀ - 1) exp(-t / τ) from y₀ = -1.
        let exact = 1.0 - 2.0 * f64::exp(-f64::from(step) * 0.01 / 0.03);
        let expected = excited(&environment, exact);
        assert!((environment.state().control[soleus] - expected).abs() < 1e-12, "step {step}");
    }
}

#[test]
fn the_observation_reads_the_entries_of_the_last_action() {
    let act = "act muscles { of [soleus_{l,r}], latency 1 steps }";
    let observed = ("observe { com.acceleration; prev(pelvis.height); independent.q }", "observe { action; soleus_l.action }");
    let mut environment = acting_and(act, &[observed]);
    assert_eq!(environment.observation(), [REST, REST, REST]);
    environment.step(&[0.5, 7.0]).unwrap();
    assert_eq!(environment.observation(), [0.5, 1.0, REST], "entries as given, the muscle as it is reached");
    environment.step(&[0.0, 0.0]).unwrap();
    assert_eq!(environment.observation(), [0.0, 0.0, 0.5]);
}

#[test]
fn offsets_of_zero_are_computed_muscle_control_itself() {
    let mut plain = episode(&[]);
    plain.reset(KEY);
    play(&mut plain, "cmc", 10);
    for act in ["act cmc { joints [legs], range 0.5 rad, com 10 cm, root 20 deg }", "act muscles { residual cmc, scale 0.5 }"] {
        let mut environment = acting(act);
        let zero = environment.engine().action(ActsOn::Task);
        assert!(zero.entries.iter().all(|entry| *entry == 0.0));
        for _ in 0..10 {
            environment.step(&zero).unwrap();
        }
        assert_eq!(environment.state(), plain.state(), "{act}");
    }
}

#[test]
fn entries_of_a_pace_are_the_policy_of_that_gait() {
    let mut plain = episode(&[]);
    plain.reset(KEY);
    play(&mut plain, "gait 0.8 0 -0.5", 10);
    let mut environment = acting("act cmc { pace [1.6 m/s, 20 cm/s, 1 rad/s] }");
    assert_eq!(environment.task().action.names(&environment.task().vocabulary), ["walk.forward", "walk.left", "walk.turn"]);
    let mut faster = acting("act cmc { pace [0.5 m/s, 20 cm/s, 1 rad/s], speed 0.8 m/s }");
    for _ in 0..10 {
        environment.step(&[0.5, 0.0, -0.5]).unwrap();
        faster.step(&[0.0, 0.0, -0.5]).unwrap();
    }
    assert_eq!(environment.state(), plain.state());
    assert_eq!(faster.state(), plain.state(), "with a speed of its own");
}

/// A test that shows how the task succeeds.
const SHOWN: (&str, &str) =
    ("success survived", "success survived\n test \"down\" { at 0.1 s { knee_angle_{l,r} = 30 deg }\n expect success }");

#[test]
fn a_gait_changes_over_to_the_demonstration_for_good() {
    let [walking, shown] = ["gait 0.8", "demonstration"].map(|policy| {
        let mut plain = episode(&[SHOWN]);
        plain.reset(KEY);
        play(&mut plain, policy, 10);
        plain
    });
    let act = "act cmc { pace [50 cm/s, 20 cm/s, 1 rad/s], speed 80 cm/s, along demonstration }";
    let mut environment = acting_and(act, &[SHOWN]);
    assert_eq!(environment.task().action.names(&environment.task().vocabulary)[3], "demonstration");
    for _ in 0..10 {
        environment.step(&[0.0, 0.0, 0.0, 0.5]).unwrap();
    }
    assert_eq!(environment.state(), walking.state(), "it walks until the entry is above 0.5");
    environment.reset(KEY);
    environment.step(&[0.0, 0.0, 0.0, 0.6]).unwrap();
    for _ in 0..9 {
        environment.step(&[1.0, 0.0, 0.0, -1.0]).unwrap();
    }
    assert_eq!(environment.state(), shown.state(), "from 0 s of the script without a `start`");
    // What it shows takes 0.1 s, and its end is held.
    let [from_end, later] = ["0.1 s", "1 s"].map(|start| {
        let mut environment = acting_and(&act.replace(" }", &format!(", start {start} }}")), &[SHOWN]);
        environment.step(&[0.0, 0.0, 0.0, 1.0]).unwrap();
        environment.state().clone()
    });
    assert_eq!(from_end, later);
    environment.reset(KEY);
    environment.step(&[0.0, 0.0, 0.0, 1.0]).unwrap();
    assert_ne!(environment.state(), &later);
}

#[test]
fn a_gait_without_a_demonstration_to_change_over_to_says_so_at_the_reset() {
    let environment = acting("act cmc { pace [50 cm/s, 20 cm/s, 1 rad/s], along demonstration }");
    let ending = environment.ending();
    assert!(matches!(ending, Some(Ending::Fault(Fault::Control(_)))), "{ending:?}");
}

#[test]
fn along_the_demonstration_zero_is_the_policy_of_that_name() {
    let mut plain = episode(&[SHOWN]);
    plain.reset(KEY);
    play(&mut plain, "demonstration", 10);
    let mut environment = acting_and("act cmc { along demonstration, joints knees, range 20 deg }", &[SHOWN]);
    for _ in 0..10 {
        environment.step(&[0.0, 0.0]).unwrap();
    }
    assert_eq!(environment.state(), plain.state());
}

#[test]
fn hands_reach_where_entries_have_them() {
    let mut environment = acting_and("act cmc { reach 30 cm }", &STILL);
    let palm = |environment: &Environment| {
        let context = environment.context();
        let (body, kinematics) = (context.body, &context.workspace.kinematics);
        let palm = body.landmarks.iter().position(|landmark| landmark.name == "palm_r").unwrap();
        body.landmark_position(kinematics, palm) - kinematics.body_position[body.root.body]
    };
    let names = environment.task().action.names(&environment.task().vocabulary);
    let of = |name: &str| names.iter().position(|own| own == name).unwrap();
    let mut action = vec![0.0; names.len()];
    action[of("palm_r.forward")] = 1.0;
    let before = palm(&environment);
    for _ in 0..60 {
        environment.step(&action).unwrap();
    }
    let way = palm(&environment) - before;
    assert!(way.x > 0.15 && way.y.abs() < 0.1 && way.z.abs() < 0.1, "{way}");
}

#[test]
fn policies_that_act_on_muscles_do_so_in_every_action_space() {
    let mut plain = episode(&[]);
    plain.reset(KEY);
    play(&mut plain, "cmc", 5);
    for act in [
        "act synergies { of [calves] }",
        "act torque { joints [knees], range 50 N*m }",
        "act muscles { scale 0.1, latency 3 steps }",
    ] {
        let mut environment = acting(act);
        play(&mut environment, "cmc", 5);
        assert_eq!(environment.state(), plain.state(), "{act}");
    }
}

#[test]
fn a_residual_is_added_and_clipped() {
    let mut base = episode(&[]);
    base.reset(KEY);
    play(&mut base, "cmc", 1);
    let mut environment = acting("act muscles { of [soleus_r, soleus_l], residual cmc }");
    environment.step(&[0.25, 1.0]).unwrap();
    let (right, left) = (muscle(&base, "soleus_r"), muscle(&base, "soleus_l"));
    let inverse = |control: f64| {
        // The excitation rises with the action: bisection.
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excited(&base, middle) < control { low = middle } else { high = middle }
        }
        low
    };
    let before = inverse(base.state().control[right]);
    assert!((inverse(environment.state().control[right]) - (before + 0.25).min(1.0)).abs() < 1e-9);
    let before = inverse(base.state().control[left]);
    assert!((inverse(environment.state().control[left]) - (before + 1.0).min(1.0)).abs() < 1e-9);
    let other = muscle(&base, "recfem_r");
    assert_eq!(environment.state().control[other], base.state().control[other]);
}

#[test]
fn targets_of_computed_muscle_control_move_the_body() {
    let names = ["knee_angle_l", "knee_angle_r", "com.forward", "com.left", "com.up", "root.forward", "root.left", "root.up"];
    let act = "act cmc { joints [knees], range 0.6 rad, com 5 cm, root 20 deg }";
    let moved_by = |entries: &[(usize, f64)]| {
        let mut environment = acting_and(act, &STILL);
        assert_eq!(environment.task().action.names(&environment.task().vocabulary), names);
        let mut action = vec![0.0; names.len()];
        entries.iter().for_each(|&(entry, value)| action[entry] = value);
        for _ in 0..60 {
            environment.step(&action).unwrap();
        }
        let context = environment.context();
        let (body, state) = (context.body, context.state);
        let joint = |name: &str| state.position[body.joints.iter().find(|joint| joint.name == name).unwrap().position];
        let com = context.workspace.kinematics.subtree_com[body.root.body];
        ([com.x, com.y, com.z], joint("knee_angle_r"))
    };
    let (com, knee) = moved_by(&[]);
    let (bent_com, bent) = moved_by(&[(1, 1.0)]);
    assert!(bent - knee > 0.1, "the knee bends by {} rad", bent - knee);
    assert!((bent_com[1] - com[1]).abs() < 0.1);
    // The heading is along x at reset.
    for (entry, axis) in [(2, 0), (3, 1)] {
        let ([ahead, back], at) = ([1.0, -1.0].map(|value| moved_by(&[(entry, value)]).0), com[axis]);
        assert!(
            ahead[axis] - at > 0.01 && at - back[axis] > 0.01,
            "{}: {} m, {} m",
            names[entry],
            ahead[axis] - at,
            back[axis] - at
        );
    }
    // Straight legs carry the body at one height: they have to bend for another.
    let [level, lower] = [0.0, -1.0].map(|down| moved_by(&[(0, 1.0), (1, 1.0), (4, down)]).0[2]);
    assert!(level - lower > 0.005, "lower by {} m", level - lower);
}

#[test]
fn torques_turn_joints_without_muscles() {
    let act = "act torque { joints [elbow_flexion_r], range 20 N*m }";
    let turned = |action: f64| {
        let mut environment = acting_and(act, &STILL);
        for _ in 0..10 {
            environment.step(&[action]).unwrap();
        }
        let context = environment.context();
        let joint = context.body.joints.iter().find(|joint| joint.name == "elbow_flexion_r").unwrap();
        let rest = excited(&environment, REST);
        assert!(environment.state().control.iter().all(|control| *control == rest));
        assert_eq!(environment.state().applied_force[joint.dof], 20.0 * action);
        context.state.velocity[joint.dof]
    };
    let [up, still] = [0.5, 0.0].map(turned);
    assert!(up - still > 1.0, "{up} rad/s with the torque, {still} rad/s without");
}

#[test]
fn an_episode_continues_from_a_snapshot_in_every_action_space() {
    for act in [
        "act muscles { of [calves], filter 40 ms, latency 3 steps }",
        "act synergies { of [calves], sides, residual cmc, latency 1 steps }",
        "act torque { joints [knees], range 50 N*m, filter 20 ms }",
        "act cmc { joints [knees], range 0.5 rad, com 10 cm, filter 20 ms }",
        "act cmc { pace [1 m/s, 20 cm/s, 0.5 rad/s], reach 60 cm, filter 20 ms }",
        "act cmc { pace [1 m/s, 20 cm/s, 0.5 rad/s], along demonstration, start 50 ms }",
    ] {
        let mut environment = acting_and(act, &[SHOWN]);
        play(&mut environment, "random", 4);
        let kept = environment.snapshot();
        play(&mut environment, "random", 4);
        let expected = environment.snapshot();
        let mut other = acting_and(act, &[SHOWN]);
        other.restore(&kept);
        assert!(other.snapshot() == kept);
        play_on(&mut other, 4);
        assert!(other.snapshot() == expected, "{act}");
    }
}

/// Goes on with the policy `random`, which depends on the step alone.
fn play_on(environment: &mut Environment, steps: usize) {
    let mut policy = policy::create("random").unwrap();
    let mut action = environment.engine().action(policy.acts_on());
    for _ in 0..steps {
        policy.act(&environment.context(), &mut action.entries).unwrap();
        environment.step(&action).unwrap();
    }
}

#[test]
fn an_entry_that_is_no_number_is_a_fault_with_its_name() {
    let mut environment = acting("act cmc { com 10 cm }");
    environment.step(&[0.0, f64::NAN, 0.0]).unwrap();
    let Some(Ending::Fault(Fault::Action { entry, step: 1, .. })) = environment.ending() else {
        panic!("{:?}", environment.ending())
    };
    assert_eq!(entry, "com.left");
}

#[test]
fn a_demonstration_that_no_test_shows_is_a_fault() {
    for act in ["act muscles { residual demonstration }", "act cmc { along demonstration, com 10 cm }"] {
        let environment = acting(act);
        let Some(Ending::Fault(fault)) = environment.ending() else { panic!("{:?}", environment.ending()) };
        assert!(fault.to_string().contains("no test of `balance` plays a script up to `expect success`"), "{fault}");
    }
}

#[test]
fn an_action_of_another_length_is_refused() {
    let mut environment = acting("act synergies { of [calves] }");
    let error = environment.step(&[0.0, 0.0]).unwrap_err().to_string();
    assert_eq!(error, "the action has 2 entries, expected 1");
    let muscles = ActionBuffer::new(ActsOn::Muscles, environment.task(), environment.engine().body());
    assert_eq!(muscles.entries, vec![REST; 416]);
    environment.step(&muscles).unwrap();
}

/// A task whose policy sees one number, as the network `half.onnx` does, which gives -0.5 for every muscle.
const ONE: (&str, &str) = ("observe { com.acceleration; prev(pelvis.height); independent.q }", "observe { pelvis.height }");

#[test]
fn an_action_is_added_to_that_of_a_network() {
    let mut environment = acting_and("act muscles { of [soleus_{l,r}], residual \"half.onnx\", scale 0.5 }", &[ONE]);
    environment.step(&[1.0, -0.4]).unwrap();
    let control = environment.state().control.clone();
    for (name, action) in [("soleus_l", 0.0), ("soleus_r", -0.7), ("recfem_l", -0.5)] {
        assert_eq!(control[muscle(&environment, name)], excited(&environment, action), "{name}");
    }
    // Asking for nothing is the network itself.
    let mut plain = acting_and("act muscles", &[ONE]);
    let mut beside = acting_and("act muscles { residual \"half.onnx\" }", &[ONE]);
    for _ in 0..5 {
        plain.step(&[-0.5; 416]).unwrap();
        beside.step(&[0.0; 416]).unwrap();
    }
    assert_eq!(plain.state(), beside.state());
}

#[test]
fn a_network_of_another_shape_is_a_fault_with_its_name() {
    let mut environment = acting_and("act muscles { residual \"actor.onnx\" }", &[ONE]);
    environment.step(&[0.0; 416]).unwrap();
    let Some(Ending::Fault(fault @ Fault::Control(_))) = environment.ending() else { panic!("{:?}", environment.ending()) };
    let expected = "the action space of the task cannot be used: the network `actor.onnx` takes 3 numbers, the observation has 1";
    assert_eq!(fault.to_string(), expected);
}
