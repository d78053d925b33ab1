//! A small task, records of made-up episodes, and a request.

#![allow(dead_code, reason = "every test file uses a part of it")]

use msk_compiler::compile;
use msk_evaluate::{EpisodeRecord, Trial};
use msk_runtime::library::{BodyLibrary, FileLoader};
use msk_tuning::reasoner::Request;
use msk_tuning::statistics::Statistics;
use std::path::Path;

/// Ten steps of the human body. `still` teaches nothing, `wave` never contributes.
pub const LEAN: &str = r#"//! A short task.

/// Lean a little.
task lean {
    family   stabilization
    body     human
    control  100 Hz
    horizon  10 steps

    init {
        pose neutral
        root { height on ground }
        noise joints     normal(0, 0.02 rad)
        noise velocities normal(0, 0.2 rad/s)
    }

    observe { pelvis.height }

    reward {
         10 (5..30)   pose   = exp(-norm(independent.q - independent.neutral) / 1 rad)
          5           alive  = not terminated
         -1           effort = mean(muscles.activation^2)
          2 (fixed)   wave   = pelvis.height > 3 m
    }

    metrics { pelvis.height }

    terminate { sunk when pelvis.height < neutral(pelvis.height) - 2 cm }

    success survived
}
"#;

/// The task, compiled and bound.
pub fn trial(folder: &Path) -> Trial {
    let path = folder.join("lean.msk");
    std::fs::write(&path, LEAN).unwrap();
    let bodies = BodyLibrary::default();
    let compilation = compile(&path, &FileLoader, &bodies).unwrap_or_else(|report| panic!("{report}"));
    let task = compilation.tasks[0].clone();
    let body = bodies.stage(&task.body, &task.scene).unwrap();
    Trial::new(task, body)
}

/// An episode of `steps` steps in which each term had the same value at every step.
pub fn record(trial: &Trial, episode: u64, steps: u32, success: bool, values: [f64; 4]) -> EpisodeRecord {
    let names = ["pose", "alive", "effort", "wave"];
    let weights = [10.0, 5.0, -1.0, 2.0];
    // Written by hand: the terms of a record stand in the task's order.
    let sums = |factor: &dyn Fn(usize) -> f64| -> String {
        let sums: Vec<String> = (0..4).map(|at| format!("\"{}\":{:?}", names[at], factor(at) * f64::from(steps))).collect();
        format!("{{{}}}", sums.join(","))
    };
    let line = format!(
        r#"{{"task":"lean","policy":"zero","seed":0,"episode":{episode},"success":{success},"terminated_by":{},"truncated":{success},
        "fault":null,"steps":{steps},"return":1.0,"terms":{},"values":{},"squares":{},"dead":{},"saturated":{},
        "metrics":{{"pelvis.height":0.9}},"last_metrics":{{"pelvis.height":0.8}},"task_hash":"{}","model_hash":"{}","wall_time":0.0}}"#,
        if success { "[]" } else { "[\"sunk\"]" },
        sums(&|at| weights[at] * values[at]),
        sums(&|at| values[at]),
        sums(&|at| values[at] * values[at]),
        sums(&|at| f64::from(u8::from(values[at] == 0.0))),
        sums(&|at| f64::from(u8::from(values[at] == 1.0))),
        trial.task.hash,
        trial.body.hash(),
    );
    serde_json::from_str(&line).unwrap()
}

/// A question about episodes, half of which failed.
pub fn request(trial: &Trial, records: &[EpisodeRecord]) -> Request {
    let in_scope = [true, true, true, false];
    Request {
        task: trial.task.name.clone(),
        summary: trial.task.summary.clone(),
        horizon: trial.task.horizon,
        formulas: trial.task.terms.iter().map(|term| (term.name.clone(), term.source.clone())).collect(),
        round: 1,
        objective: "episodes last".into(),
        step: 0.2,
        norm: None,
        statistics: Statistics::of(&trial.task, &trial.task.weights(), &in_scope, records),
        history: Vec::new(),
    }
}

/// Four episodes: with more of `pose` they succeed.
pub fn episodes(trial: &Trial) -> Vec<EpisodeRecord> {
    vec![
        record(trial, 0, 20, true, [0.4, 1.0, 0.1, 0.0]),
        record(trial, 1, 10, false, [0.2, 1.0, 0.1, 0.0]),
        record(trial, 2, 20, true, [0.4, 1.0, 0.1, 0.0]),
        record(trial, 3, 10, false, [0.2, 1.0, 0.1, 0.0]),
    ]
}
