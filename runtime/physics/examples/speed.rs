//! Steps per second of CPU time and microseconds per stage, one episode at a time.
//!
//! `cargo run --release -p msk-physics --example speed -- [model.xml] [falling|standing] [seconds] [baseline|wide|widest]`
//!
//! Muscles are excited at random anew every ten milliseconds. CPU time is counted where the system tells it (Linux), so other
//! programs on the machine do not count; `benches/ratio.py --program` compares with MuJoCo.

mod protocol;

use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{STAGES, Workspace, step_by_stage};
use protocol::{Random, cpu_seconds, duration, initial_state, instructions};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.into());
    let model = Model::from_file(argument(0, "bodies/models/human416.xml"))?;
    let standing = argument(1, "falling") == "standing";
    let seconds: f64 = argument(2, "2").parse()?;
    let instructions = instructions(&argument(3, "widest"));
    let mut workspace = Workspace::new(&model).with_instructions(instructions);
    let origin = initial_state(&model, standing)?;
    let duration = duration(standing);
    let mut state = origin.clone();
    let mut random = Random(1);
    let (mut steps, mut iterations, mut stages) = (0, 0, [0.0; STAGES.len()]);
    let (begin, deadline) = (cpu_seconds(), Instant::now());
    while deadline.elapsed().as_secs_f64() < seconds {
        if state.time >= duration {
            state.clone_from(&origin);
        }
        state.control.fill_with(|| random.unit());
        for _ in 0..10 {
            let (mut clock, mut stage) = (Instant::now(), stages.iter_mut());
            step_by_stage(&model, &mut state, &mut workspace, &mut || {
                let now = Instant::now();
                if let Some(time) = stage.next() {
                    *time += (now - clock).as_secs_f64();
                }
                clock = now;
            })?;
            steps += 1;
            iterations += workspace.lanes[0].newton.iterations;
        }
    }
    let elapsed = cpu_seconds() - begin;
    let count = f64::from(steps).at_least(1.0);
    let times: Vec<String> =
        STAGES.iter().zip(stages).map(|(name, time)| format!("\"{name}\": {:.1}", time * 1e6 / count)).collect();
    println!(
        "{{\"steps\": {steps}, \"steps_per_second\": {:.0}, \"iterations\": {:.2}, \"us_per_stage\": {{{}}}}}",
        f64::from(steps) / elapsed.at_least(1e-9),
        iterations as f64 / count,
        times.join(", ")
    );
    Ok(())
}
