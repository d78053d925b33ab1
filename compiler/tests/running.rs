//! What a compiled task does from step to step, over frames made by hand.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // A test that panics has failed, which is its work.
#![allow(clippy::disallowed_methods, reason = "what is expected need not agree between machines to the bit")]

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::Middle;
use msk_compiler::frame::Sensor;
use msk_compiler::task::{CompiledTask, StepReport, TaskState};
use std::sync::Arc;
use support::compiling::{compile_text, complete};

/// The one task of a few statements; what they do not declare is added.
fn task(statements: &str) -> Arc<CompiledTask> {
    let compilation = compile_text(&complete(statements), &[]).unwrap_or_else(|report| panic!("{report}"));
    compilation.tasks[0].clone()
}

/// Runs a task over frames that hold `measure(step, sensor, lane)`.
struct Episode<'a> {
    task: &'a CompiledTask,
    measure: &'a dyn Fn(u32, Sensor, usize) -> f64,
    frame: Vec<f64>,
    state: TaskState,
    report: StepReport,
}

impl<'a> Episode<'a> {
    fn start(task: &'a CompiledTask, measure: &'a dyn Fn(u32, Sensor, usize) -> f64) -> Self {
        let mut episode = Self {
            task,
            measure,
            frame: vec![0.0; task.frame.size()],
            state: TaskState::default(),
            report: StepReport::default(),
        };
        episode.fill(0);
        task.reset(&episode.frame, &mut Middle, &mut episode.state).unwrap();
        episode
    }

    fn fill(&mut self, step: u32) {
        for &(sensor, offset) in self.task.frame.entries() {
            for lane in 0..sensor.size() {
                self.frame[offset + lane] = (self.measure)(step, sensor, lane);
            }
        }
    }

    fn step(&mut self) -> &StepReport {
        self.fill(self.state.step + 1);
        let weights = self.task.weights();
        self.task.step(&self.frame, &weights, &mut Middle, &mut self.state, &mut self.report).unwrap();
        &self.report
    }

    fn observe(&self) -> Vec<f64> {
        let mut out = vec![f64::NAN; self.task.observation_size()];
        self.task.observe(&self.frame, &self.state, &mut out);
        out
    }
}

/// The value of an observed formula at every step while the centre of mass is at the given heights.
fn over_heights(formula: &str, heights: &[f64]) -> Vec<f64> {
    let task = task(&format!("observe {{\nx = {formula}\n}}"));
    let measure = |step: u32, sensor: Sensor, lane: usize| match (sensor, lane) {
        (Sensor::ComPosition, 2) => heights[step as usize],
        (Sensor::Time, _) => 0.01 * f64::from(step),
        _ => 0.0,
    };
    let mut episode = Episode::start(&task, &measure);
    let mut values = vec![episode.observe()[0]];
    for _ in 1..heights.len() {
        episode.step();
        values.push(episode.observe()[0]);
    }
    values
}

#[test]
fn operators_remember_as_the_reference_says() {
    const HEIGHTS: [f64; 6] = [1.0, 3.0, 2.0, 5.0, 5.0, 0.0];
    let above = "com.height > 2.5 m";
    for (formula, expected) in [
        ("prev(com.height)".to_owned(), [1.0, 1.0, 3.0, 2.0, 5.0, 5.0]),
        ("delay(com.height, 2 steps)".to_owned(), [1.0, 1.0, 1.0, 3.0, 2.0, 5.0]),
        ("initial(com.height)".to_owned(), [1.0; 6]),
        ("running_max(com.height)".to_owned(), [1.0, 3.0, 3.0, 5.0, 5.0, 5.0]),
        ("running_min(com.height)".to_owned(), [1.0, 1.0, 1.0, 1.0, 1.0, 0.0]),
        (format!("count({above})"), [0.0, 1.0, 1.0, 2.0, 3.0, 3.0]),
        (format!("rising({above})"), [0.0, 1.0, 0.0, 1.0, 0.0, 0.0]),
        (format!("falling({above})"), [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        (format!("once({above})"), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]),
        (format!("ever({above})"), [0.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        ("always(com.height > 0.5 m)".to_owned(), [1.0, 1.0, 1.0, 1.0, 1.0, 0.0]),
        (format!("held({above}, 2 steps)"), [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
        (format!("timer({above}) / 1 ms"), [0.0, 10.0, 0.0, 10.0, 20.0, 0.0]),
        (format!("since({above}) / 1 ms"), [f64::INFINITY, 0.0, 10.0, 0.0, 0.0, 10.0]),
        ("hysteresis(com.height, 1.5 m, 2.5 m)".to_owned(), [0.0, 1.0, 1.0, 1.0, 1.0, 0.0]),
        (format!("sample_hold(com.height, {above})"), [1.0, 3.0, 3.0, 5.0, 5.0, 5.0]),
        ("step".to_owned(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]),
    ] {
        assert_eq!(over_heights(&formula, &HEIGHTS), expected, "{formula}");
    }
    for (formula, expected) in [
        ("rate(com.height)", [0.0, 200.0, -100.0, 300.0, 0.0, -500.0]),
        ("integral(com.height)", [0.0, 0.03, 0.05, 0.1, 0.15, 0.15]),
        ("t", [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]),
    ] {
        for (found, expected) in over_heights(formula, &HEIGHTS).into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{formula}: {found} is not {expected}");
        }
    }
}

#[test]
fn a_low_pass_reaches_two_thirds_after_its_time_constant() {
    let heights: Vec<f64> = std::iter::once(0.0).chain([1.0; 10]).collect();
    let smoothed = over_heights("smooth(com.height, 0.1 s)", &heights);
    assert!((smoothed[10] - (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
}

#[test]
fn operators_nest_in_the_order_of_time() {
    let squat = "ever(com.height > 0.90 m and ever(com.height < 0.75 m))";
    assert_eq!(over_heights(squat, &[1.0, 0.7, 0.8, 0.95]), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(over_heights(squat, &[1.0, 0.95, 0.8, 0.7]), [0.0; 4]);
}

#[test]
fn states_are_read_before_their_update_in_formulas_and_after_it_in_observations() {
    let task = task(
        "state passed: int = 0 becomes passed + 1 when com.height > 1 m\n\
         observe {\npassed\nbefore = prev(passed)\n}\nreward {\n1 count = passed\n}",
    );
    let measure = |step: u32, sensor: Sensor, lane: usize| match (sensor, lane) {
        (Sensor::ComPosition, 2) => {
            if step == 2 {
                0.5
            } else {
                1.5
            }
        }
        _ => 0.0,
    };
    let mut episode = Episode::start(&task, &measure);
    assert_eq!(episode.observe(), [0.0, 0.0]);
    let mut seen = Vec::new();
    for _ in 0..3 {
        let reward = episode.step().terms[0];
        seen.push((reward, episode.observe()[0]));
    }
    assert_eq!(seen, [(0.0, 1.0), (1.0, 1.0), (1.0, 2.0)]);
}

#[test]
fn ends_are_distinguished() {
    let task = task(
        "horizon 4 steps\nterminate after 1 steps {\nfallen when com.height < 0.8 m\nhigh when com.height > 2 m\n}\n\
         reward {\n5 alive = not terminated\n-100 fell = ended by fallen\n}\nsuccess survived",
    );
    let run = |heights: [f64; 5]| {
        let measure = |step: u32, sensor: Sensor, lane: usize| match (sensor, lane) {
            (Sensor::ComPosition, 2) => heights[step as usize],
            _ => 0.0,
        };
        let mut episode = Episode::start(&task, &measure);
        (1..=4).map(|_| episode.step().clone()).collect::<Vec<_>>()
    };
    let stood = run([1.0; 5]);
    assert!(stood.iter().all(|step| step.reward == 5.0 && step.terminations == [false, false]));
    assert_eq!(stood.iter().map(|step| step.success).collect::<Vec<_>>(), [false, false, false, true]);
    let fell = run([1.0, 0.5, 1.0, 0.5, 3.0]);
    let reasons: Vec<_> = fell.iter().map(|step| step.terminations.clone()).collect();
    // The first step is a grace.
    assert_eq!(reasons, [[false, false], [false, false], [true, false], [false, true]]);
    assert_eq!(fell.iter().map(|step| step.reward).collect::<Vec<_>>(), [5.0, 5.0, -100.0, 0.0]);
    assert!(fell.iter().all(|step| !step.success));
}

#[test]
fn a_term_that_is_no_number_is_an_event_and_never_a_zero() {
    let task = task("reward {\n1 steep = log(com.height / 1 m)\n1 one = torso.up.z\n}");
    let frame = vec![0.0; task.frame.size()];
    let (mut state, mut report) = (TaskState::default(), StepReport::default());
    task.reset(&frame, &mut Middle, &mut state).unwrap();
    let event = task.step(&frame, &[1.0, 1.0], &mut Middle, &mut state, &mut report).unwrap_err();
    assert_eq!(event.to_string(), "term `steep` is -inf at step 1: log(com.height / 1 m)");
    let nan = vec![f64::NAN; task.frame.size()];
    assert!(task.step(&nan, &[1.0, 1.0], &mut Middle, &mut state, &mut report).unwrap_err().to_string().contains("NaN"));
}

#[test]
fn a_copy_of_the_state_goes_on_with_the_same_bits() {
    let task = task("observe {\nsmooth(com.height, 0.05 s)\ndelay(com.velocity, 3 steps)\nsince(com.height > 1 m)\n}");
    let measure = |step: u32, _: Sensor, lane: usize| (f64::from(step) * 0.7 + lane as f64).sin();
    let mut episode = Episode::start(&task, &measure);
    (0..10).for_each(|_| {
        episode.step();
    });
    let kept = episode.state.clone();
    let went_on: Vec<Vec<f64>> = (0..10)
        .map(|_| {
            episode.step();
            episode.observe()
        })
        .collect();
    episode.state = kept;
    for expected in went_on {
        episode.step();
        assert_eq!(episode.observe(), expected);
    }
}

#[test]
fn vectors_are_counted_in_the_axes_that_are_named() {
    let task = task(
        "observe {\nlocal = (head.position in pelvis)\nlevel = (com.velocity in heading(pelvis))\npelvis.yaw\npelvis.pitch\n\
         pelvis.roll\npelvis.orientation\n}",
    );
    // The pelvis stands at (1, 2, 1), turned left by a quarter and then pitched nose down by 30 degrees.
    let (half, root) = (0.5, 0.75_f64.sqrt());
    let axes = [0.0, root, -half, -1.0, 0.0, 0.0, 0.0, half, root];
    let pelvis = task.frame.entries().iter().find_map(|(sensor, _)| match sensor {
        Sensor::LandmarkAxes(index) => Some(*index),
        _ => None,
    });
    let measure = |_: u32, sensor: Sensor, lane: usize| match sensor {
        Sensor::LandmarkAxes(_) => axes[lane],
        Sensor::LandmarkPosition(index) if Some(index) == pelvis => [1.0, 2.0, 1.0][lane],
        // Up from the pelvis along its own axis.
        Sensor::LandmarkPosition(_) => [1.0, 2.0 + half, 1.0 + root][lane],
        Sensor::ComVelocity => [0.0, 3.0, 0.25][lane],
        _ => 0.0,
    };
    let found = Episode::start(&task, &measure).observe();
    let quarter = std::f64::consts::FRAC_PI_2;
    // Half angles of 45 and 15 degrees.
    let (c, s) = ((quarter / 2.0).cos(), (quarter / 2.0).sin());
    let (d, u) = ((quarter / 6.0).cos(), (quarter / 6.0).sin());
    let expected = [0.0, 0.0, 1.0, 3.0, 0.0, 0.25, quarter, quarter / 3.0, 0.0, c * d, -s * u, c * u, s * d];
    for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < 1e-12, "value {place}: {found} is not {expected}");
    }
}

#[test]
fn values_of_the_standing_pose_fold_while_compiling() {
    let task = task("observe {\nneutral(pelvis.height)\nneutral(norm(com.velocity)) + neutral(torso.up.z) * 1 m/s\n}");
    assert_eq!(task.frame.size(), 12, "only the reward's pelvis and the success's torso are measured");
    let observed = Episode::start(&task, &|_, _, _| 0.0).observe();
    let pelvis = support::compiling::vocabulary().landmarks.into_iter().find(|landmark| landmark.name == "pelvis").unwrap();
    assert_eq!(observed[0], pelvis.neutral_position[2]);
    assert!((0.9..=1.0).contains(&observed[1]));
}

#[test]
fn the_hash_is_that_of_the_meaning() {
    let hash = |text: &str| task(text).hash.clone();
    let plain =
        hash("let low = com.height < 0.9 m\nlet tall = com.height / 1 m\nterminate {\nsunk when low\n}\nreward {\n1 a = tall\n}");
    let other_words = hash(
        "reward {\n    1   a = high // how tall\n}\nlet high = com.height / 1 m\nlet deep = com.height < 90 cm\n\
         terminate { sunk when deep }",
    );
    assert_eq!(plain, other_words);
    let other_weight = hash("let low = com.height < 0.9 m\nterminate {\nsunk when low\n}\nreward {\n2 a = com.height / 1 m\n}");
    assert_ne!(plain, other_weight);
    assert_eq!(plain.len(), 64);
}

#[test]
fn what_terms_have_in_common_is_computed_once() {
    let operations = |statements: &str| task(statements).operations();
    let one = operations("reward {\n1 a = exp(-com.speed / 1 m/s)\n}\nobserve {\npelvis.height\n}");
    let three =
        operations("reward {\n1 a = exp(-com.speed / 1 m/s)\n2 b = com.speed / 1 m/s\n}\nobserve {\npelvis.height\ncom.speed\n}");
    assert_eq!(one, three);
}

#[test]
fn the_standing_task_means_this() {
    let stand = include_str!("../../tasks/stabilization/stand.msk").replace("../lib/", "lib/");
    let compilation = compile_text(&stand, &[]).unwrap_or_else(|report| panic!("{report}"));
    insta::assert_snapshot!("stand", compilation.tasks[0].snapshot().to_string());
    let explained = msk_compiler::explain::text(&compilation.tasks[0], &msk_compiler::explain::Options::default());
    insta::assert_snapshot!("stand_explained", explained);
}

#[test]
fn deep_and_large_texts_are_refused_without_harm_to_a_small_stack() {
    let nested_lets: String = (1..4000).map(|n| format!("let a{n} = a{} + 1\n", n - 1)).rev().collect();
    let doubling: String = (1..60).map(|n| format!("fn f{n}(x) = f{p}(x) + f{p}(x)\n", p = n - 1)).collect();
    let brackets = format!("{}com.height{}", "(".repeat(60), ")".repeat(60));
    let wide: String = (0..100).map(|n| format!("let w{n} = wide * {n}\n")).collect();
    let calls = format!("{}com.height{}", "initial(".repeat(60), ")".repeat(60));
    let choices = format!("{}com.height{}", "(if step > 3 then 1 m else ".repeat(60), ")".repeat(60));
    let lists = format!("{}com.height{}", "[".repeat(60), "]".repeat(60));
    let sums = vec!["com.height"; 200].join(" + ");
    let whole = |functions: &str, statements: &str| format!("{functions}{}", complete(statements));
    let texts = [
        (whole("", &format!("{nested_lets}let a0 = com.height / 1 m\nreward {{\n1 x = a3999\n}}")), Some("E0410")),
        (whole(&format!("fn f0(x) = x\n{doubling}"), "reward {\n1 x = f59(torso.up.z)\n}"), Some("E0410")),
        (whole("", &format!("reward {{\n1 x = {brackets} / 1 m\n}}")), None),
        (whole("", &format!("reward {{\n1 x = {calls} / 1 m\n}}")), None),
        (whole("", &format!("reward {{\n1 x = {choices} / 1 m\n}}")), None),
        (whole("", &format!("reward {{\n1 x = mean({lists}) / 1 m\n}}")), None),
        (whole("", &format!("reward {{\n1 x = ({sums}) / 1 m\n}}")), None),
        (whole("", "reward {\n1 x = mean([i for i in 0..100000000])\n}"), Some("E0410")),
        (whole("", &format!("let wide = [i + t / 1 s for i in 0..20000]\n{wide}reward {{\n1 x = mean(w99)\n}}")), Some("E0410")),
        (whole("", "reward {\n1 x = mean(delay(muscles.activation, 90000 steps))\n}"), Some("E0410")),
    ];
    let checked = std::thread::Builder::new().stack_size(1 << 20).spawn(move || {
        for (text, expected) in texts {
            let found = compile_text(&text, &[]).err().map(|report| report.diagnostics[0].code.id);
            assert_eq!(found, expected, "{}", &text[..200.min(text.len())]);
        }
    });
    checked.unwrap().join().unwrap();
}

#[test]
fn a_list_is_read_at_a_place_known_only_at_run_time() {
    let place = "argmax([com.height, 3 m])";
    assert_eq!(over_heights(&format!("[7, 8][{place}]"), &[1.0, 5.0, 2.0, 4.0]), [8.0, 7.0, 8.0, 7.0]);
    assert_eq!(over_heights("[5, 6, 7][mod(step, 3)]", &[0.0; 5]), [5.0, 6.0, 7.0, 5.0, 6.0]);
}

#[test]
fn turns_go_the_short_way_and_between_orientations() {
    assert_eq!(over_heights("angle_difference(170 deg, -170 deg) / 1 deg", &[0.0])[0].round(), 20.0);
    let task = task("observe {\nx = angle_difference(pelvis.orientation, torso.orientation) / 1 rad\n}");
    let angles = [0.0_f64, 0.3, 1.5, 3.0, std::f64::consts::PI];
    for angle in angles {
        let measure = |_: u32, sensor: Sensor, lane: usize| {
            let (sin, cos) = angle.sin_cos();
            let turned = [cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0];
            let level = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
            let first = task.frame.entries().iter().find(|(sensor, _)| matches!(sensor, Sensor::LandmarkAxes(_)));
            if first.is_some_and(|(first, _)| sensor == *first) { level[lane] } else { turned[lane % 9] }
        };
        let found = Episode::start(&task, &measure).observe()[0];
        assert!((found - angle).abs() < 1e-7, "{angle}: {found}");
    }
}
