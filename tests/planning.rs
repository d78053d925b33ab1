//! The policy that plans: it does what the reward asks for, knows no future, and has the same bits on any number of threads.

use super::episodes::episode;
use msk::plan::{Method, Planner, Preset, Settings, SpaceChoice, Targets};
use msk::runtime::action::Action;
use msk::runtime::episode::{Ending, Environment, Episode, EpisodeKey};
use msk::runtime::policy::{self, ActsOn, Policy};
use std::sync::atomic::AtomicBool;

const KEY: EpisodeKey = EpisodeKey { seed: 3, episode: 1 };

/// A body at rest that is rewarded by `reward`, for as long as tests need.
fn rewarded(reward: &str, parts: &[(&str, &str)]) -> Environment {
    let mut all = vec![
        (", velocity [0.2 m/s, 0, 0]", ""),
        ("noise joints normal(0, 0.03 rad)", ""),
        ("noise velocities normal(0, 0.3 rad/s)", ""),
        ("horizon 12 steps", "horizon 200 steps"),
        ("2 upright = torso.up.z\n        3 change = 1 s/m * rate(pelvis.height)", reward),
    ];
    all.extend_from_slice(parts);
    let mut environment = episode(&all);
    environment.reset(KEY);
    environment
}

/// As little as shows what planning does.
fn quick() -> Settings {
    Settings { look: 0.0, horizon: 0.2, tail: 0.0, samples: 8, first_rounds: 1, replan: 4, ..Settings::of(Preset::Fast) }
}

/// Steps with a policy; gives the actions.
fn play(environment: &mut Environment, policy: &mut dyn Policy, steps: usize) -> Vec<Vec<f64>> {
    policy.reset(&environment.context()).unwrap();
    let mut action = environment.engine().action(policy.acts_on());
    let mut actions = Vec::new();
    for _ in 0..steps {
        if environment.ending().is_some() {
            break;
        }
        policy.act(&environment.context(), &mut action.entries).unwrap();
        actions.push(action.entries.clone());
        environment.step(&action).unwrap();
    }
    actions
}

fn planned(environment: &mut Environment, settings: &Settings, steps: usize) -> Vec<Vec<f64>> {
    let never = AtomicBool::new(false);
    play(environment, &mut Planner::new("plan", settings.clone(), &never), steps)
}

const BENT: &str = "1 bent = exp(-4 rad^-2 * (elbow_flexion_r.q - 1 rad)^2)";

#[test]
fn a_plan_does_what_the_reward_asks_for() {
    let mut environment = rewarded(BENT, &[]);
    let targets = Targets { joints: vec!["elbows".into()], arm_range: 1.2, ..Targets::default() };
    // Wide enough to get there in half a second whatever is drawn.
    let settings = Settings { targets, samples: 16, horizon: 0.3, noise: 0.5, ..quick() };
    planned(&mut environment, &settings, 80);
    let bent = environment.episode().total();
    environment.reset(KEY);
    play(&mut environment, policy::create("cmc").unwrap().as_mut(), 80);
    let still = environment.episode().total();
    assert!(bent > 3.0 * still && bent > 30.0, "{bent} with a plan, {still} without");
}

#[test]
fn a_planner_walks_where_that_earns_most() {
    let low = ("early when step > 100", "low when pelvis.height < 0.7 m");
    let mut environment = rewarded("1 onward = clip(com.velocity.x / 1 m/s, 0, 1)", &[low]);
    let settings = Settings { look: 2.0, horizon: 0.3, replan: 25, ..quick() };
    planned(&mut environment, &settings, 190);
    let earned = environment.episode().total();
    assert!(environment.ending().is_none() && earned > 30.0, "{earned} of 190 at 1 m/s: {:?}", environment.ending());
}

#[test]
fn a_planner_walks_in_the_own_space_of_a_task_that_has_a_pace() {
    let pace = ("control 100 Hz", "control 100 Hz\n    act cmc { pace [1 m/s, 20 cm/s, 0.5 rad/s] }");
    let low = ("early when step > 100", "low when pelvis.height < 0.7 m");
    let mut environment = rewarded("1 onward = clip(com.velocity.x / 1 m/s, 0, 1)", &[pace, low]);
    planned(&mut environment, &Settings { replan: 25, ..quick() }, 150);
    // It has stood in the beginning, and shifts its weight before the first step.
    let earned = environment.episode().total();
    assert!(environment.ending().is_none() && earned > 10.0, "{earned} of 150 at 1 m/s: {:?}", environment.ending());
}

#[test]
fn a_planner_stops_walking_where_the_demonstration_earns_more() {
    let parts = [
        ("horizon 200 steps", "horizon 300 steps"),
        ("early when step > 100", "low when pelvis.height < 0.4 m"),
        (
            "success survived",
            r#"success survived
    test "down" {
        at 1 s
        at 1.8 s pose neutral { hip_flexion_{l,r} = 60 deg, knee_angle_{l,r} = 65 deg, ankle_angle_{l,r} = 20 deg, root.pitch = 15 deg, root.at = [0.3 m, 0 m] }
        expect success
    }"#,
        ),
    ];
    let reward =
        "1 both = if step < 100 then clip(com.velocity.x / 1 m/s, 0, 1) else clip((0.85 m - pelvis.height) / 0.1 m, 0, 1)";
    let earned = |look_again: f64| {
        let mut environment = rewarded(reward, &parts);
        // It sees the reward of walking alone when the episode begins.
        let settings = Settings { look: 1.0, look_again, horizon: 0.3, samples: 4, replan: 25, ..quick() };
        planned(&mut environment, &settings, 290);
        environment.episode().total()
    };
    let (sinks, walks) = (earned(0.25), earned(0.0));
    assert!(sinks > walks + 20.0, "{sinks} where it is asked anew, {walks} where it is not");
}

#[test]
fn a_planner_that_avoids_success_earns_without_it() {
    let parts = [("horizon 200 steps", "horizon 60 steps"), ("success survived", "success elbow_flexion_r.q > 0.5 rad")];
    let mut environment = rewarded(BENT, &parts);
    let targets = Targets { joints: vec!["elbows".into()], arm_range: 1.2, ..Targets::default() };
    let settings = Settings { targets, samples: 16, horizon: 0.3, noise: 0.5, ..quick() };
    let mut ends = |settings: &Settings| {
        environment.reset(KEY);
        planned(&mut environment, settings, 60);
        (environment.success(), environment.episode().total())
    };
    let (succeeds, _) = ends(&settings);
    let (avoids, earned) = ends(&Settings { avoid_success: true, ..settings.clone() });
    assert!(succeeds && !avoids && earned > 5.0, "{earned}");
}

#[test]
fn a_seed_of_its_own_changes_what_a_planner_draws() {
    let seeded = |seed: u64| planned(&mut rewarded(BENT, &[]), &Settings { seed, ..quick() }, 6);
    assert!(seeded(0) == planned(&mut rewarded(BENT, &[]), &quick(), 6));
    assert!(seeded(1) != seeded(0) && seeded(1) != seeded(2));
}

#[test]
fn every_method_and_space_plans_and_no_number_of_threads_changes_a_bit() {
    let choices = [
        ("control 100 Hz", SpaceChoice::Targets, Method::Cem, ActsOn::Muscles),
        ("control 100 Hz", SpaceChoice::Synergies, Method::Mppi, ActsOn::Muscles),
        ("control 100 Hz", SpaceChoice::Muscles, Method::Predictive, ActsOn::Muscles),
        ("control 100 Hz\n    act cmc { joints [legs], range 0.5 rad }", SpaceChoice::Auto, Method::Cem, ActsOn::Task),
        (
            "control 100 Hz\n    act synergies { of [calves, [recfem_l, vaslat_l]], sides }",
            SpaceChoice::Task,
            Method::Mppi,
            ActsOn::Task,
        ),
        ("control 100 Hz\n    act torque { joints [knees], range 50 N*m }", SpaceChoice::Auto, Method::Predictive, ActsOn::Task),
        ("control 100 Hz\n    act torque { joints [knees], range 50 N*m }", SpaceChoice::Targets, Method::Cem, ActsOn::Muscles),
    ];
    for (control, space, method, acts_on) in choices {
        let settings = Settings { space, method, samples: 12, horizon: 0.06, ..quick() };
        let found = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut environment = rewarded(BENT, &[("control 100 Hz", control)]);
                let actions = planned(&mut environment, &settings, 6);
                (actions, environment.snapshot())
            })
        });
        assert!(found[0] == found[1], "{control}, {space:?}");
        let environment = rewarded(BENT, &[("control 100 Hz", control)]);
        let size = acts_on.size(environment.task(), environment.context().body);
        assert!(found[0].0.iter().all(|action| action.len() == size), "{control}, {space:?}");
    }
}

#[test]
fn a_planner_that_has_played_other_episodes_plans_the_same() {
    let never = AtomicBool::new(false);
    let mut used = Planner::new("plan", quick(), &never);
    let mut environment = rewarded(BENT, &[]);
    play(&mut environment, &mut used, 6);
    environment.reset(EpisodeKey { seed: 3, episode: 2 });
    let after = play(&mut environment, &mut used, 6);
    environment.reset(EpisodeKey { seed: 3, episode: 2 });
    assert!(after == planned(&mut environment, &quick(), 6));
    environment.reset(KEY);
    assert!(after != planned(&mut environment, &quick(), 6), "episodes have chance of their own");
}

#[test]
fn a_plan_knows_no_push_that_has_not_begun() {
    // It begins in the step after 8.
    let push = "disturb torso { force [400 N, 0, 0], at 0.08 s, for 0.1 s }\n    observe";
    let mut calm = rewarded(BENT, &[]);
    let mut pushed = rewarded(BENT, &[("observe", push)]);
    let [without, with] = [&mut calm, &mut pushed].map(|environment| planned(environment, &quick(), 16));
    let same = without.iter().zip(&with).take_while(|(a, b)| a == b).count();
    // The first action that sees the push is the tenth: it answers to what nine steps have come to.
    assert_eq!(same, 9);
    assert!(calm.state().velocity != pushed.state().velocity);
}

#[test]
fn imagined_chance_is_not_that_of_the_episode() {
    let text = [("observe {", "random luck = uniform(-0.5 .. 0.5) redraw when step > 0\n    observe {")];
    let environment = rewarded("1 guess = luck", &text);
    let engine = environment.engine().clone();
    let mut scratch = engine.scratch();
    let present = environment.snapshot();
    let rest = engine.action(ActsOn::Task);
    let mut go_on = |mut episode: Episode| {
        for _ in 0..3 {
            engine.step(&mut episode, &rest, &[1.0], &mut scratch).unwrap();
        }
        episode
    };
    let real = go_on(present.clone());
    let imagined = ["a", "b"].map(|name| {
        let mut episode = present.clone();
        engine.imagine(&present, name, &mut episode);
        go_on(episode)
    });
    assert!(imagined.iter().all(|imagined| imagined.state() == real.state()), "what is no chance is the same");
    let totals = [real.total(), imagined[0].total(), imagined[1].total()];
    assert!(totals[0] != totals[1] && totals[0] != totals[2] && totals[1] != totals[2], "{totals:?}");
}

#[test]
fn falling_is_dearer_than_whatever_it_earns() {
    // Sinking earns a lot, until the episode ends at once.
    let reward = "100 sink = exp(-10 m^-1 * pelvis.height)";
    let mut environment = rewarded(reward, &[("early when step > 100", "low when pelvis.height < 0.85 m")]);
    planned(&mut environment, &quick(), 40);
    assert_eq!(environment.ending(), None, "after {} steps", environment.steps());
    play_zero(&mut environment);
    assert!(matches!(environment.ending(), Some(Ending::Terminated(_))));
}

fn play_zero(environment: &mut Environment) {
    environment.reset(KEY);
    play(environment, policy::create("zero").unwrap().as_mut(), 200);
}

#[test]
fn a_planner_gives_up_when_it_is_to_stop() {
    let stop = AtomicBool::new(true);
    let environment = rewarded(BENT, &[]);
    let mut planner = Planner::new("plan", quick(), &stop);
    planner.reset(&environment.context()).unwrap();
    let mut action = environment.engine().action(planner.acts_on());
    assert_eq!(planner.act(&environment.context(), &mut action.entries), Err(policy::PolicyError::Interrupted));
}

#[test]
fn settings_that_a_body_or_a_task_cannot_have_are_refused() {
    let never = AtomicBool::new(false);
    let environment = rewarded(BENT, &[]);
    let refused = |settings: Settings| {
        let error = Planner::new("plan", settings, &never).reset(&environment.context()).err();
        error.map(|error| error.to_string()).unwrap_or_default()
    };
    let wings = Targets { joints: vec!["wings".into()], ..Targets::default() };
    let message = refused(Settings { targets: wings, ..quick() });
    assert!(message.contains("no joint or group of joints `wings`; its groups are lumbar, hips"), "{message}");
    let nothing =
        Targets { joint_range: 0.0, arm_range: 0.0, center_of_mass: 0.0, root: 0.0, priority_factor: 1.0, ..Targets::default() };
    assert!(refused(Settings { targets: nothing, ..quick() }).contains("no target is left"));
    let message = refused(Settings { horizon: 0.001, ..quick() });
    assert!(message.contains("its horizon of 0.001 s is shorter than a control step of 0.01 s"), "{message}");
}

#[test]
fn settings_are_read_and_mistakes_are_shown_with_their_places() {
    let read = |text: &str| Settings::read(text).map_err(|error| error.to_string());
    assert_eq!(read(""), Ok(Settings::of(Preset::Fast)));
    assert_eq!(read("preset = \"good\""), Ok(Settings::of(Preset::Good)));
    let changed = read("preset = \"best\"\nsamples = 9\n[targets]\njoints = [\"legs\"]").unwrap();
    let targets = Targets { joints: vec!["legs".into()], ..Settings::of(Preset::Best).targets };
    assert_eq!(changed, Settings { samples: 9, targets, ..Settings::of(Preset::Best) });
    for (text, expected) in [
        ("horizont = 1", &["line 1", "unknown field `horizont`", "`horizon`"][..]),
        ("samples = \"many\"", &["line 1", "invalid type"]),
        ("\nsamples = 0", &["line 2: `samples` is 0; expected a whole number from 4 to 4096"]),
        ("samples = 100000000", &["`samples` is 100000000"]),
        ("horizon = nan", &["line 1: `horizon` is NaN; expected a number from 0.01 to 10 s"]),
        ("noise = inf", &["`noise` is inf"]),
        ("rounds = -1", &["line 1", "invalid value"]),
        ("[targets]\nroot = 9", &["line 2: `root` is 9"]),
        ("preset = \"slow\"", &["unknown variant `slow`, expected one of `fast`, `good`, `best`"]),
        ("elites = 0", &["`elites` is 0; expected a whole number from 1 to 4096"]),
    ] {
        let message = read(text).unwrap_err();
        assert!(expected.iter().all(|part| message.contains(part)), "{text}: {message}");
    }
}

#[test]
fn what_is_imagined_exactly_is_what_happens() {
    // A plan that asks for nothing is `cmc`: played without its randoms, the copy goes on like the episode.
    let mut environment = rewarded(BENT, &[]);
    let engine = environment.engine().imagining(1).unwrap();
    let mut imagined = engine.episode();
    engine.imagine(environment.episode(), "exact", &mut imagined);
    let mut scratch = engine.scratch();
    for action in play(&mut environment, policy::create("cmc").unwrap().as_mut(), 10) {
        let action = Action { acts_on: ActsOn::Muscles, entries: &action };
        engine.step(&mut imagined, action, &[1.0], &mut scratch).unwrap();
    }
    assert!(imagined.state() == environment.state());
    assert_eq!(imagined.total(), environment.episode().total());
}
