//! Tests inside files: what scripts show, what is read of it, how a failure is reported.

use msk::compiler::task::CompiledTask;
use msk::compiler::{Compilation, compile};
use msk::evaluate::testing::{self, Measure, Stage, TestReport};
use msk::runtime::library::{BodyLibrary, FileLoader, WithText};
use std::path::Path;
use std::sync::{Arc, OnceLock};

fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

fn compiled_text(text: String) -> Compilation {
    let loader = WithText { path: "example.msk".into(), text, others: &FileLoader };
    compile(Path::new("example.msk"), &loader, bodies()).unwrap_or_else(|report| panic!("{report}"))
}

fn compiled(statements: &str) -> Compilation {
    // A test about channels brings its own.
    let observe = "observe { pelvis.height; cube.position - pelvis.position }";
    let observe = if statements.contains("observe {") { "" } else { observe };
    let text = format!(
        "task example {{
            body human; control 100 Hz; horizon 300 steps
            scene {{ ground; box cube {{ size [10 cm, 10 cm, 10 cm], mass 1 kg, free, at [1 m, 0, 1 m] }} }}
            init {{ pose neutral; noise joints normal(0, 0.05 rad) }}
            {observe}
            reward {{ 2 tall = pelvis.height / 1 m; -1 effort = mean(muscles.activation^2); 4 low = ever(pelvis.height < 0.6 m) }}
            terminate {{ fallen when pelvis.height < 0.3 m }}
            success survived and ever(pelvis.height < 0.6 m)
            {statements}
        }}"
    );
    compiled_text(text)
}

fn task(statements: &str) -> Arc<CompiledTask> {
    compiled(statements).tasks[0].clone()
}

/// The reports of all tests.
pub fn played(statements: &str) -> Vec<TestReport> {
    let task = task(statements);
    let tests = task.tests.clone().unwrap();
    let body = bodies().stage(&task.body, &task.scene).unwrap();
    let jobs: Vec<_> = (0..tests.tests.len()).map(|place| (tests.as_ref(), body.clone(), place)).collect();
    testing::run_all(&jobs, None).unwrap()
}

/// All hold.
pub fn holds(statements: &str) {
    for report in played(statements) {
        assert!(report.passed(), "{report:#?}");
    }
}

/// The message of the only expectation that does not hold.
fn failure_of(statements: &str) -> String {
    let reports = played(statements);
    let failures: Vec<_> = reports.iter().flat_map(|report| &report.failures).collect();
    let [failure] = failures.as_slice() else { panic!("{failures:#?}") };
    format!("expected {}, found {}", failure.expected, failure.found)
}

#[test]
fn a_situation_is_shown_as_it_is_written() {
    holds(
        "test \"placed\" {
            moment a {
                pose squatting { root.height = 0.5 m, root.at = [1 m, -2 m], root.heading = 90 deg, cube.at = [0, 1 m, 2 m] }
            }
            expect abs(pelvis.height - 0.5 m) < 1 mm at a
            expect abs(pelvis.position.x - 1 m) < 1 mm and abs(pelvis.position.y + 2 m) < 1 mm at a
            expect abs(pelvis.yaw - 90 deg) < 0.1 deg at a
            expect abs(cube.height - 2 m) < 1 mm and cube.speed < 1 mm/s at a
            expect abs(knee_angle_r.q - 80 deg) < 30 deg and com.speed < 1 mm/s at a
        }",
    );
}

#[test]
fn the_ground_carries_whatever_pose_is_shown() {
    holds(
        "test \"on the ground\" {
            at 0.5 s pose squatting as low
            at 0.75 s { root.lift = 20 cm } as high
            at 1 s { root.lift = 0 m } as back
            until 1 s
            expect abs(min(sole_{l,r}.clearance)) < 1 mm at low
            expect abs(min(sole_{l,r}.clearance) - 20 cm) < 1 mm at high
            expect abs(min(sole_{l,r}.clearance)) < 1 mm at back
            expect touching(sole_l, ground) at low
            expect not touching(sole_l, ground) at high
        }",
    );
}

#[test]
fn velocities_are_those_of_the_motion() {
    holds(
        "test \"there in two seconds\" {
            pose neutral { root.height = 1 m }
            at 2 s { root.at = [2 m, 0 m] }
            until 2 s
            expect 1.49 m/s < running_max(pelvis.velocity.x) < 1.51 m/s
        }",
    );
    holds(
        "test \"at one second\" {
            at 1 s pose neutral { root.heading = 60 deg, cube.at = [1 m, 0, 2 m] } as middle
            at 2 s { root.heading = 120 deg, cube.at = [1 m, 0, 3 m] }
            until 2 s
            expect 55 deg/s < pelvis.angular_velocity.z < 65 deg/s at middle
            expect 0.95 m/s < cube.velocity.z < 1.05 m/s at middle
            expect cube.speed < 0.05 m/s
        }",
    );
}

#[test]
fn places_are_met_all_the_way() {
    holds(
        "let off = norm(sole_l.position - [0.2 m, 0.1 m, 0])
         test \"a foot stays\" {
            root { align sole_l to [0.2 m, 0.1 m, 0] }
            at 1 s pose squatting
            until 1 s
            expect running_max(off) < 0.1 mm
            expect pelvis.height < 0.8 m
        }",
    );
}

#[test]
fn an_episode_is_played_to_its_end() {
    holds(
        "test \"held to the horizon\" {
            at 1 s pose squatting { root.height = 0.5 m }
            at 2 s pose neutral { root.height = ground }
            expect success and survived and step == 300
        }
        test \"a fall ends it\" {
            at 1 s pose neutral { root.height = 0.2 m }
            expect ended by fallen and terminated and not survived
        }
        cheat \"standing\" { pose neutral }",
    );
}

#[test]
fn contributions_are_read_by_term_and_summed() {
    holds(
        "test \"pay\" {
            moment rest { pose neutral { root.height = 1 m } }
            moment tense { pose neutral { root.height = 1 m, activation = 0.5 } }
            expect 1.999 < reward.tall < 2.001 at rest
            expect -0.251 < reward.effort < -0.249 at tense
            expect reward at tense < reward at rest
            expect 1.999 < return < 2.001 at rest
        }
        test \"over time\" {
            pose neutral { root.height = 1 m }
            until 1 s
            expect 199.9 < return.tall < 200.1
        }",
    );
}

#[test]
fn chance_is_given_or_that_of_the_first_episode() {
    holds(
        "random place: length = uniform(0.1 m .. 0.5 m)
         metrics { place }
         test \"given\" { given place = 0.33 m; until 0.01 s; expect 0.329 m < place < 0.331 m }
         test \"drawn\" { until 0.01 s; expect 0.1 m <= place <= 0.5 m }",
    );
}

#[test]
fn physics_takes_over() {
    holds(
        "test \"who does nothing sinks\" { run zero for 1 s; expect pelvis.height < 0.9 m }
         test \"a dropped cube falls\" {
            cube { at [1 m, 0, 2 m] }
            run zero for 0.2 s
            expect -2.1 m/s < cube.velocity.z < -1.8 m/s
         }
         test \"thrown\" {
            cube { at [1 m, 0, 2 m], velocity [0, 0, 1 m/s] }
            run zero for 0.01 s
            expect 0.8 m/s < cube.velocity.z < 1 m/s
         }",
    );
}

#[test]
fn what_does_not_hold_is_reported_with_its_numbers() {
    assert_eq!(
        failure_of("test \"x\" { moment a { pose neutral { root.height = 1 m } }; expect pelvis.height at a < 0.5 m }"),
        "expected pelvis.height at a < 0.5 m, found pelvis.height at a = 1 m"
    );
    assert_eq!(
        failure_of("test \"x\" { pose neutral; expect success }"),
        "expected success, found the episode reached the horizon at 3.00 s"
    );
    assert_eq!(
        failure_of(
            "test \"x\" { at 1 s pose neutral { root.height = 0.2 m }; at 2 s as late; expect pelvis.height at late < 1 m }"
        ),
        "expected pelvis.height at late < 1 m, found 2.00 s was not reached: the episode ended by fallen at 0.78 s"
    );
    assert_eq!(
        failure_of("cheat \"x\" { at 1 s pose squatting { root.height = 0.5 m } }"),
        "expected not success, found the episode reached the horizon at 3.00 s"
    );
    assert_eq!(
        failure_of("test \"x\" { run nobody for 1 s; expect survived }"),
        "expected that it runs, found there is no policy `nobody`; choose one of: zero, random, cmc, cmc smooth, demonstration, demonstration smooth, gait, gait smooth"
    );
}

#[test]
fn tests_do_not_change_the_task() {
    let (plain, tested) = (task(""), task("test \"x\" { pose squatting; expect ever(knee_angle_r.q > 1 rad) }"));
    assert_eq!(plain.hash, tested.hash);
    assert_eq!(plain.frame, tested.frame);
    assert_eq!(plain.metrics, tested.metrics);
}

#[test]
fn a_test_is_the_same_played_twice() {
    let task = task("test \"x\" { at 0.3 s pose squatting; run random for 0.2 s; expect pelvis.height < 0 m }");
    let body = bodies().stage(&task.body, &task.scene).unwrap();
    let mut stage = Stage::new(task.tests.as_ref().unwrap(), &body).unwrap();
    let first = stage.play(0);
    assert!(!first.passed());
    assert_eq!(stage.play(0), first);
}

/// A demonstration of the example: down, and up again.
const DEMONSTRATION: &str = "test \"down and up\" {
    at 0.5 s pose squatting { root.height = 0.5 m }
    at 1 s pose neutral { root.height = ground }
    expect success
}";

/// The measures by which the last test, a cheat, earns too much.
fn too_much(tests: &str) -> Vec<String> {
    let reports = played(tests);
    let failures = &reports.last().unwrap().failures;
    failures.iter().map(|failure| failure.expected.clone()).collect()
}

#[test]
fn an_exploit_that_earns_less_than_the_demonstration_passes() {
    let reports = played(&format!("{DEMONSTRATION} cheat \"standing\" {{ pose neutral }}"));
    let report = &reports[1];
    assert!(report.passed(), "{report:#?}");
    let ranking = report.ranking.as_ref().unwrap();
    let shown = ranking.demonstration.as_ref().unwrap();
    assert_eq!(shown.title, "down and up");
    assert!(shown.returns.success && !ranking.returns.success);
    assert_eq!((shown.returns.steps, ranking.returns.steps), (300, 300));
    // Two thirds of three seconds below 0.6 m or after it, and some 0.95 m of height in all others.
    for measure in Measure::ALL {
        assert!(ranking.returns.by(measure) < shown.returns.by(measure), "{measure:?}");
    }
    let standing = ranking.returns.by(Measure::Return);
    assert!((standing - 300.0 * ranking.returns.by(Measure::PerStep)).abs() < 1e-9);
    assert!((standing - 2.0 * 0.94 * 300.0).abs() < 15.0, "{standing}");
    // The same reward in every step: discounted and not, a step earns the same.
    let (plain, discounted) = (ranking.returns.by(Measure::PerStep), ranking.returns.by(Measure::DiscountedPerStep));
    assert!((plain - discounted).abs() < 1e-9, "{plain} {discounted}");
    // A sum of 0.99^n over 300 steps is 95.096.
    assert!((ranking.returns.by(Measure::Discounted) - 95.096 * plain).abs() < 0.01);
}

#[test]
fn an_exploit_that_earns_more_fails_by_every_measure_and_reports_its_terms() {
    let tests = format!("{DEMONSTRATION} cheat \"hovering\" {{ root {{ height 4 m }} }}");
    let demonstration = "of the demonstration \"down and up\"";
    assert_eq!(
        too_much(&tests),
        ["return", "per step", "return, discount 0.99", "per step, discount 0.99"]
            .map(|measure| format!("{measure} below that {demonstration}"))
    );
    let reports = played(&tests);
    let failure = &reports[1].failures[0];
    assert!(failure.found.starts_with("2400 against 1") && failure.found.contains(": `tall` earns "), "{}", failure.found);
    assert!(!failure.found.contains("low"), "{}", failure.found);
    let [exploit, demonstration] = failure.sides.as_slice() else { panic!("{failure:#?}") };
    assert!(exploit.value > demonstration.value);
}

#[test]
fn after_an_early_end_nothing_is_earned() {
    // 8 in a step is more than the demonstration ever earns, and 5 steps of it are less than 300 of those.
    let tests = format!(
        "{DEMONSTRATION} cheat \"up and down at once\" {{ root {{ height 4 m }}; at 0.04 s; at 0.05 s {{ root.height = 0.2 m }} }}"
    );
    let per_step = ["per step", "per step, discount 0.99"];
    assert_eq!(too_much(&tests), per_step.map(|measure| format!("{measure} below that of the demonstration \"down and up\"")));
    let reports = played(&tests);
    let returns = &reports[1].ranking.as_ref().unwrap().returns;
    assert_eq!((returns.steps, returns.ended_by.as_str()), (5, "fallen"));
}

#[test]
fn a_cheat_is_held_to_the_horizon_whenever_it_is_looked_at() {
    let slow = "cheat \"not yet\" { at 2 s pose squatting { root.height = 0.5 m }; until 1 s; expect pelvis.height > 0.7 m }";
    assert_eq!(
        failure_of(&format!("{DEMONSTRATION} {slow}")),
        "expected no success, held to the horizon, found it succeeds after 300 steps: it is a demonstration, use `test`"
    );
    let reports = played(&format!("{DEMONSTRATION} cheat \"a moment\" {{ until 0.1 s }}"));
    assert_eq!(reports[1].ranking.as_ref().unwrap().returns.steps, 300);
}

#[test]
fn the_demonstration_is_the_first_test_that_succeeds_to_the_horizon() {
    let rest = "cheat \"standing\" { pose neutral }";
    let title = |tests: &str| {
        let reports = played(&format!("{tests} {rest}"));
        let ranking = reports.last().unwrap().ranking.clone().unwrap();
        ranking.demonstration.map(|shown| shown.title)
    };
    assert_eq!(title(""), None);
    let passing = "test \"not at its end\" { at 1 s pose squatting as low; expect not success at low }";
    assert_eq!(title(passing), None);
    let other = DEMONSTRATION.replace("down and up", "another");
    assert_eq!(title(&format!("{passing} {DEMONSTRATION} {other}")).as_deref(), Some("down and up"));
    assert_eq!(title(&format!("{other} {DEMONSTRATION}")).as_deref(), Some("another"));
    // Told to be over before it falls, it falls when it is held.
    let falls = DEMONSTRATION
        .replace("expect success", "at 2.9 s { root.height = 0.2 m }; expect success")
        .replace("down and up", "falls");
    assert_eq!(title(&format!("{falls} {other}")).as_deref(), Some("another"));
}

/// The only test of a sequence of two phases, the second of which wants a squat.
fn in_sequence(statements: &str) -> TestReport {
    let text = format!(
        "task up {{
            body human; control 100 Hz; horizon 100 steps
            scene {{ ground }}
            init {{ pose neutral }}
            observe {{ pelvis.height }}
            reward {{ 1 tall = pelvis.height / 1 m }}
            terminate {{ fallen when pelvis.height < 0.3 m }}
            success pelvis.height > 0.9 m
        }}
        task low extends up {{
            horizon 200 steps
            reward {{ remove tall; 2 deep = 1 - pelvis.height / 1 m }}
            success ever(pelvis.height < 0.8 m)
        }}
        sequence both {{
            random wait: time = uniform(0.2 s .. 0.8 s)
            phase up until t > wait
            phase low
            success up.success and low.success
            {statements}
        }}"
    );
    let compilation = compiled_text(text);
    let task = compilation.tasks.iter().find(|task| task.name == "both").unwrap();
    let tests = task.tests.clone().unwrap();
    let mut stage = Stage::new(&tests, &bodies().stage(&task.body, &task.scene).unwrap()).unwrap();
    stage.play(0)
}

#[test]
fn a_test_of_a_sequence_goes_through_its_phases() {
    let report = in_sequence(
        "test \"stands, then squats\" {
            given wait = 0.5 s
            at 0.4 s pose neutral as standing
            at 0.51 s pose neutral as last_of_up
            at 0.52 s pose neutral as first_of_low
            at 1.5 s pose squatting as down
            at 2 s { root.height = 0.2 m }
            expect up.present and not low.present and not success at standing
            expect up.present at last_of_up
            expect low.present and up.success and not success and t < 0.02 s at first_of_low
            expect low.present and success at down
            expect 0.9 < reward.tall < 1 at standing
            expect reward.deep at first_of_low < reward.deep at down
            expect ended by fallen and low.present
        }",
    );
    assert!(report.passed(), "{report:#?}");
    // A test that finds nothing proves nothing unless the same machinery finds something.
    assert!(in_sequence("cheat \"standing\" { pose neutral }").passed());
    let caught = in_sequence("cheat \"squatting\" { at 2 s pose squatting }");
    assert_eq!(caught.failures[0].expected, "not success");
}

#[test]
fn what_another_phase_has_is_reported_as_such() {
    let report = in_sequence(
        "test \"too late\" {
            given wait = 0.5 s
            at 0.4 s pose neutral as early
            until 1 s
            expect reward.deep at early < 1
            expect reward.tall > 0
        }",
    );
    let found: Vec<&str> = report.failures.iter().map(|failure| failure.found.as_str()).collect();
    assert_eq!(
        found,
        ["at 0.40 s the phase is `up`; this is defined in `low`", "at its end the phase is `low`; this is defined in `up`"]
    );
}

#[test]
fn a_motion_is_played_as_its_table_says() {
    holds(
        "reference gait = motion \"motions/walk.csv\" start 0.3
         let error = norm(gait.q - gait.joints.q)
         let way = pelvis.position - initial(pelvis.position)
         metrics { error }
         test \"as the reference\" {
            at 0.5 s play gait for 1 s
            until 1.5 s
            expect error < 0.001 deg
            expect norm(pelvis.velocity - gait.velocity) < 0.1 m/s
         }
        ",
    );
    // One turn takes the root some 1.3 m further: to the left if it faces there.
    holds(
        "let way = pelvis.position - initial(pelvis.position)
         test \"ahead\" { play motion \"motions/walk.csv\"; until 1.1 s; expect 1.28 m < way.x < 1.4 m and abs(way.y) < 1 cm }
         test \"to the left\" {
            play motion \"motions/walk.csv\" start 50 % for 1.1 s { root.heading = 90 deg, elbow_flexion_r = 70 deg } as after
            at 2 s { root.at = [0 m, 0 m] }
            expect 1.28 m < way.y < 1.4 m and abs(way.x) < 2 cm at after
            expect abs(elbow_flexion_r.q - 70 deg) < 0.001 deg at after
            expect abs(elbow_flexion_l.q - 21 deg) < 2 deg at after
         }
         test \"to its end\" {
            play motion \"motions/sit.csv\" as seated
            at 2.9 s pose neutral { root.height = ground }
            until 2.9 s
            expect pelvis.height at seated < 0.6 m
            expect pelvis.height > 0.8 m
         }",
    );
}

#[test]
fn a_reset_shows_the_initial_state_as_the_task_draws_it() {
    let random = "random aside = uniform(-0.2 m .. 0.2 m)
        observe { off = aside }";
    holds(&format!(
        "{random}
        test \"reset\" {{
            moment posed {{ until 0.01 s }}
            moment begun {{ reset }}
            moment drawn {{ reset 40 times }}
            expect std(knee_angle_l.q at drawn) > 0.01 rad
            expect abs(knee_angle_l.q) <= 0 rad at posed
            expect step == 0 and not terminated and reward.tall > 1 at begun
            expect -0.2 m < min(aside at drawn) < -0.15 m
            expect 0.15 m < max(aside at drawn) < 0.2 m
            expect -0.1 m < mean(aside at drawn) < 0.1 m
            expect abs(aside) < 0.2 m at drawn
        }}"
    ));
    // What holds in most episodes must hold in each.
    let each =
        failure_of(&format!("{random} test \"each\" {{ moment drawn {{ reset 40 times }}; expect aside at drawn < 0.1 m }}"));
    assert!(
        each.starts_with("expected aside at drawn < 0.1 m, found episode ") && each.contains(": aside at drawn = 0."),
        "{each}"
    );
    let over = failure_of(&format!(
        "{random} test \"over\" {{ moment drawn {{ reset 40 times }}; expect max(aside at drawn) < 0.1 m }}"
    ));
    assert!(over.contains("found max(aside at drawn) = 0.1"), "{over}");
}

#[test]
fn a_given_value_holds_for_resets_and_runs() {
    holds(
        "random aside = uniform(-0.2 m .. 0.2 m)
        observe { off = aside }
        test \"given\" {
            given aside = 0.15 m
            moment begun { reset 3 times }
            run zero for 0.02 s
            expect 0.149 m < aside < 0.151 m at begun
            expect 0.149 m < aside < 0.151 m
        }",
    );
}

#[test]
fn a_channel_is_read_as_the_policy_sees_it() {
    // A state that grows at every step is observed after its update, and read in formulas before it.
    holds(
        "state taken: int = 0 becomes taken + 1
        let gap = cube.position - pelvis.position
        observe { taken; gap = (gap in heading(pelvis)); facing = torso.orientation }
        test \"channels\" {
            moment still { until 0.03 s }
            moment turned { pose neutral { root.heading = 90 deg } }
            expect observation.taken == 3 and taken == 2 at still
            expect observation.gap.forward > 0.9 m at still
            expect observation.gap.left < -0.9 m and observation.facing.up.z > 0.9 at turned
        }",
    );
}
