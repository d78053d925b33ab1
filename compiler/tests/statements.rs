//! What statements beside reward and observation do from step to step: chance, parameters, ends, metrics, sequences.

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::compile::Setting;
use msk_compiler::frame::Sensor;
use msk_compiler::task::{CompiledTask, StepReport, TaskState};
use msk_compiler::{Draws, Middle, compile_with};
use std::path::Path;
use std::sync::Arc;
use support::ENTRY;
use support::compiling::{Bodies, compile_text, complete, texts};

fn task(statements: &str) -> Arc<CompiledTask> {
    let compilation = compile_text(&complete(statements), &[]).unwrap_or_else(|report| panic!("{report}"));
    compilation.tasks[0].clone()
}

/// A frame in which the centre of mass is at a height.
fn frame_at(task: &CompiledTask, height: f64) -> Vec<f64> {
    let mut frame = vec![0.0; task.frame.size()];
    for &(sensor, offset) in task.frame.entries() {
        if sensor == Sensor::ComPosition {
            frame[offset + 2] = height;
        }
    }
    frame
}

/// Runs over heights; gives the report and the observation after each, that of the reset first.
fn run(task: &CompiledTask, heights: &[f64], draws: &mut dyn Draws) -> Vec<(StepReport, Vec<f64>)> {
    let (mut state, mut report) = (TaskState::default(), StepReport::default());
    let mut seen = vec![f64::NAN; task.observation_size()];
    let frame = frame_at(task, heights[0]);
    task.begin(draws, &mut state).unwrap();
    task.reset(&frame, draws, &mut state).unwrap();
    task.report(&frame, &task.weights(), &state, &mut report);
    task.observe(&frame, &state, &mut seen);
    let mut steps = vec![(report.clone(), seen.clone())];
    for &height in &heights[1..] {
        let frame = frame_at(task, height);
        task.step(&frame, &task.weights(), draws, &mut state, &mut report).unwrap();
        task.observe(&frame, &state, &mut seen);
        steps.push((report.clone(), seen.clone()));
    }
    steps
}

/// Gives numbers in turn, whatever the stream, and counts them.
struct Script(Vec<f64>, usize);

impl Draws for Script {
    fn uniform(&mut self, _: usize) -> f64 {
        self.1 += 1;
        self.0[(self.1 - 1) % self.0.len()]
    }

    fn normal(&mut self, random: usize) -> f64 {
        self.uniform(random)
    }
}

#[test]
fn a_random_is_drawn_until_it_fits_and_anew_at_a_redraw() {
    let task = task(
        "random goal = uniform(1 m .. 3 m) where goal > 2 m redraw when com.height > goal\n\
         observe {\ngoal\n}\nreward {\n1 a = goal / 1 m\n}",
    );
    assert_eq!(task.randoms[0].accept, "goal > 2 m");
    // 1.5 m is refused, 2.5 m is taken; reached at step 2: 1 m is refused, 2.8 m taken.
    let mut script = Script(vec![0.25, 0.75, 0.0, 0.9], 0);
    let steps = run(&task, &[0.0, 2.4, 2.6, 2.6], &mut script);
    let seen: Vec<f64> = steps.iter().map(|(_, seen)| seen[0]).collect();
    assert_eq!(seen, [2.5, 2.5, 2.8, 2.8]);
    // Formulas read it before the redraw, observations after.
    let rewards: Vec<f64> = steps.iter().map(|(report, _)| report.terms[0]).collect();
    assert_eq!(rewards[1..], [2.5, 2.5, 2.8]);
    assert_eq!(script.1, 4);
}

#[test]
fn a_draw_that_never_fits_is_an_error_with_its_numbers() {
    let task = task("random goal = uniform(1 m .. 3 m) where goal > 5 m\nobserve {\ngoal\n}");
    let mut state = TaskState::default();
    let fault = task.begin(&mut Middle, &mut state).unwrap_err();
    assert_eq!(fault.to_string(), "none of 64 draws of `goal` at step 0 satisfies `goal > 5 m`; the last was 2");
}

#[test]
fn distributions_are_those_of_the_reference() {
    let task = task(
        "random number = uniform(2 m .. 4 m)\nrandom whole = uniform(1..4)\nrandom around = normal(1 m, 0.5 m)\n\
         random place = uniform(0 m .. 1 m, 0 m .. 2 m, 0 m .. 3 m)\nrandom one = choice(5 m, 7 m)\n\
         random vector = choice([1, 2, 3], [4, 5, 6])\n\
         observe {\nnumber\nwhole\naround\nplace - com.position\none\nvector\n}",
    );
    let steps = run(&task, &[0.0], &mut Script(vec![0.75], 0));
    assert_eq!(steps[0].1, [3.5, 3.0, 1.375, 0.75, 1.5, 2.25, 7.0, 4.0, 5.0, 6.0]);
}

#[test]
fn randoms_that_read_signals_wait_for_the_first_snapshot() {
    let task = task(
        "random early = uniform(0 m .. 1 m)\nrandom after = uniform(0 m .. com.height)\nlet both = early + after\n\
         state held_: length = both becomes held_\nobserve {\nearly\nafter\nheld_\n}"
            .replace("held_", "kept")
            .as_str(),
    );
    let steps = run(&task, &[4.0, 8.0], &mut Middle);
    assert_eq!(steps[0].1, [0.5, 2.0, 2.5]);
    assert_eq!(steps[1].1, [0.5, 2.0, 2.5]);
}

#[test]
fn a_task_goes_on_from_a_copy_with_the_same_draws() {
    let task = task("random goal = uniform(1 m .. 3 m) redraw when step > 1\nobserve {\ngoal\n}");
    let mut script = Script(vec![0.1, 0.2, 0.3, 0.4], 0);
    let steps = run(&task, &[0.0; 5], &mut script);
    let seen: Vec<f64> = steps.iter().map(|(_, seen)| (seen[0] * 10.0).round()).collect();
    assert_eq!(seen, [12.0, 12.0, 14.0, 16.0, 18.0]);
}

#[test]
fn failures_finishes_and_the_horizon_are_distinguished() {
    let task = task(
        "horizon 4 steps\nterminate after 1 steps {\nlow when com.height < 1 m\n}\nfinish {\nhigh when com.height > 2 m\n}\n\
         metrics {\nbest = running_max(com.height)\nfinished\nended by high\ncom.position\n}\n\
         reward per second {\n100 rate = com.height / 1 m\n}\nobserve {\ntruncated\nended\nsurvived\n}",
    );
    assert_eq!((task.terminations.as_slice(), task.finishes.as_slice()), (&["low".to_owned()][..], &["high".to_owned()][..]));
    let steps = run(&task, &[1.5, 0.5, 3.0, 0.5, 1.5], &mut Middle);
    let ends: Vec<_> = steps.iter().map(|(report, _)| (report.terminations[0], report.finishes[0], report.truncated)).collect();
    // The grace of one step saves the first fall.
    assert_eq!(ends[1..], [(false, false, false), (false, true, false), (true, false, false), (false, false, true)]);
    assert_eq!(steps[2].0.metrics, [3.0, 1.0, 1.0, 0.0, 0.0, 3.0]);
    assert_eq!(steps[4].0.metrics[0], 3.0);
    assert!((steps[4].0.reward - 1.5).abs() < 1e-12);
    let seen: Vec<&[f64]> = steps.iter().map(|(_, seen)| seen.as_slice()).collect();
    assert_eq!(seen[2..], [&[0.0, 1.0, 0.0][..], &[0.0, 1.0, 0.0], &[1.0, 1.0, 1.0]]);
    let task = complete("terminate {\nlow when com.height < 1 m\n}\nreward {\n-1 fell = ended by low\n}");
    assert!(compile_text(&task, &[]).is_ok());
}

/// The value that a parameter has after settings, or the error about them.
fn set(settings: &[(&str, &str)]) -> Result<f64, String> {
    let text =
        complete("params {\npace: speed = 130 cm/s (0.5..2 m/s)\n}\nreward {\n1 a = pace / 1 m/s * exp(-com.speed / pace)\n}");
    let settings: Vec<Setting> =
        settings.iter().map(|(name, value)| Setting { name: (*name).into(), value: (*value).into() }).collect();
    let compilation = compile_with(Path::new(ENTRY), &texts(&text, &[]), &Bodies, &settings);
    compilation.map(|compilation| compilation.tasks[0].parameters[0].value).map_err(|report| format!("{report}"))
}

#[test]
fn parameters_are_set_from_outside_within_their_range() {
    assert_eq!(set(&[]), Ok(1.3));
    assert_eq!(set(&[("pace", "1.5 m/s")]), Ok(1.5));
    // A number without unit has the unit in which the parameter is written.
    assert_eq!(set(&[("pace", "150")]), Ok(1.5));
    assert_eq!(set(&[("example.pace", "0.6 m/s"), ("pace", "80")]), Ok(0.8));
    for (name, value, wanted) in [
        ("pace", "5 m/s", "is out of range"),
        ("pace", "1 m", "has another unit"),
        ("pase", "1 m/s", "did you mean `pace`?"),
        ("other.pace", "1 m/s", "no task has a parameter `other.pace`"),
        ("pace", "", "error"),
        ("pace", "1 m/s }", "error"),
    ] {
        let error = set(&[(name, value)]).unwrap_err();
        assert!(error.contains(wanted) && error.contains("--set"), "{name}={value}: {error}");
    }
}

#[test]
fn another_value_of_a_parameter_is_another_task() {
    let text = complete("params {\npace = 1 m/s\n}\nreward {\n1 a = exp(-com.speed / pace)\n}");
    let hash = |value: &str| {
        let settings = [Setting { name: "pace".into(), value: value.into() }];
        compile_with(Path::new(ENTRY), &texts(&text, &[]), &Bodies, &settings).unwrap().tasks[0].hash.clone()
    };
    assert_ne!(hash("1"), hash("2"));
    assert_eq!(hash("1"), hash("100 cm/s"));
}

#[test]
fn an_extending_task_is_the_task_with_other_rows() {
    let base = complete("reward {\n2 (1..5) a = com.height / 1 m\n3 b = torso.up.z\n}\nlet x = com.speed\nmetrics {\nx\n}");
    let text =
        format!("{base}\ntask child extends example {{ reward {{ 4 a; 1 b = pelvis.up.z; 5 c = head.up.z }}; horizon 7 steps }}");
    let compilation = compile_text(&text, &[]).unwrap_or_else(|report| panic!("{report}"));
    let child = &compilation.tasks[1];
    let terms: Vec<(&str, f64, &str)> = child.terms.iter().map(|t| (t.name.as_str(), t.weight, t.source.as_str())).collect();
    assert_eq!(terms, [("a", 4.0, "com.height / 1 m"), ("b", 1.0, "pelvis.up.z"), ("c", 5.0, "head.up.z")]);
    assert_eq!((child.terms[0].weight_range, child.horizon), (Some([1.0, 5.0]), 7));
    assert_eq!(child.metrics[0].name, "x");
}

const PHASES: &str = "
task rise {
    body human
    control 100 Hz
    horizon 3 steps
    random goal = uniform(0 m .. 1 m)
    init { pose neutral }
    observe { com.height; n = count(com.height > 1 m); goal; t }
    reward { 1 up = com.height / 1 m }
    metrics { step }
    terminate { fallen when com.height < 0 m }
    success com.height > 1 m
}
task sink {
    body human
    control 100 Hz
    horizon 2 steps
    init { pose neutral }
    observe { com.height; t; start = initial(com.height) }
    reward { 1 down = -com.height / 1 m }
    metrics { step }
    finish { low when com.height < 0.5 m }
    success com.height < 1 m
}
sequence both {
    random shared = uniform(0 m .. 2 m)
    observe { shared }
    metrics { episode = episode.t / 1 ms }
    phase rise until com.height > 2 m
    phase sink
    success rise.success and sink.success
}";

#[test]
fn phases_follow_each_other_with_everything_restarted() {
    let compilation = compile_text(PHASES, &[]).unwrap_or_else(|report| panic!("{report}"));
    let task = compilation.tasks.iter().find(|task| task.name == "both").unwrap();
    assert_eq!(task.horizon, 5);
    assert_eq!(task.terms.iter().map(|term| term.name.as_str()).collect::<Vec<_>>(), ["rise.up", "sink.down"]);
    assert_eq!(
        (task.terminations.as_slice(), task.finishes.as_slice()),
        (&["rise.fallen".to_owned()][..], &["sink.low".to_owned()][..])
    );
    let channels: Vec<&str> = task.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(channels, ["shared", "com.height", "n", "goal", "t", "start", "phase"]);
    assert_eq!(task.randoms.iter().map(|random| random.name.as_str()).collect::<Vec<_>>(), ["shared", "rise.goal"]);

    let steps = run(task, &[1.5, 1.5, 3.0, 0.9, 0.4], &mut Script(vec![0.25, 0.5, 0.9], 0));
    let seen: Vec<&[f64]> = steps.iter().map(|(_, seen)| seen.as_slice()).collect();
    assert_eq!(seen[0], [0.5, 1.5, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(seen[1], [0.5, 1.5, 1.0, 0.5, 0.01, 0.0, 1.0, 0.0]);
    // At step 2 the second phase begins: its time is zero, its memory starts, what the sequence drew stays.
    assert_eq!(seen[2], [0.5, 3.0, 0.0, 0.0, 0.0, 3.0, 0.0, 1.0]);
    assert_eq!(seen[3], [0.5, 0.9, 0.0, 0.0, 0.01, 3.0, 0.0, 1.0]);
    // The step that ends a phase is still its own.
    assert_eq!(steps[2].0.terms, [3.0, 0.0]);
    assert!(steps[2].0.entered && !steps[2].0.truncated && !steps[2].0.success);
    assert_eq!(steps[3].0.terms, [0.0, -0.9]);
    assert!(steps[3].0.success && !steps[3].0.truncated);
    assert_eq!(steps[4].0.finishes, [true]);
    assert!(!steps[4].0.truncated);
}

#[test]
fn a_phase_that_is_not_left_in_time_ends_the_sequence() {
    let compilation = compile_text(PHASES, &[]).unwrap_or_else(|report| panic!("{report}"));
    let task = compilation.tasks.iter().find(|task| task.name == "both").unwrap();
    let steps = run(task, &[1.5; 4], &mut Middle);
    assert!(steps[3].0.truncated && !steps[3].0.success && !steps[3].0.entered);
    // Without `until` the next phase begins when the time of this one is over.
    let timed = PHASES.replace(" until com.height > 2 m", "");
    let compilation = compile_text(&timed, &[]).unwrap_or_else(|report| panic!("{report}"));
    let task = compilation.tasks.iter().find(|task| task.name == "both").unwrap();
    let steps = run(task, &[1.5; 4], &mut Middle);
    assert!(steps[3].0.entered && !steps[3].0.truncated);
}
