//! Steps per second of CPU time, microseconds per stage, and sizes of the constraint problem, one episode at a time.
//!
//! `cargo run --release -p msk-physics --example speed -- [model.xml] [falling|standing|crawling] [seconds] [baseline|wide|widest]`
//!
//! Muscles are excited at random anew every ten milliseconds. CPU time is counted where the system tells it (Linux), so other
//! programs on the machine do not count; `benches/ratio.py --program` compares with MuJoCo.

mod protocol;

use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{STAGES, Workspace, step_by_stage};
use protocol::{Protocol, Random, cpu_seconds, initial_state, instructions, spread};
use std::collections::BTreeMap;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.into());
    let model = Model::from_file(argument(0, "bodies/models/human416.xml"))?;
    let protocol = Protocol::named(&argument(1, "falling"));
    let seconds: f64 = argument(2, "2").parse()?;
    let instructions = instructions(&argument(3, "widest"));
    let mut workspace = Workspace::new(&model).with_instructions(instructions);
    let origin = initial_state(&model, protocol)?;
    let duration = protocol.duration();
    let mut state = origin.clone();
    let mut random = Random(1);
    let (mut steps, mut stages) = (0, [0.0; STAGES.len()]);
    let [mut iterations, mut rows, mut contacts] = [const { Vec::new() }; 3];
    // Steps and seconds by tens of rows.
    let mut by_rows = BTreeMap::<usize, (f64, f64)>::new();
    let (begin, deadline) = (cpu_seconds(), Instant::now());
    while deadline.elapsed().as_secs_f64() < seconds {
        if state.time >= duration {
            state.clone_from(&origin);
        }
        state.control.fill_with(|| random.unit());
        for _ in 0..10 {
            let began = Instant::now();
            let (mut clock, mut stage) = (began, stages.iter_mut());
            step_by_stage(&model, &mut state, &mut workspace, &mut || {
                let now = Instant::now();
                if let Some(time) = stage.next() {
                    *time += (now - clock).as_secs_f64();
                }
                clock = now;
            })?;
            steps += 1;
            let own = &workspace.lanes[0];
            iterations.push(own.newton.iterations);
            rows.push(own.constraints.rows.len());
            contacts.push(own.constraints.contacts.len());
            let (count, time) = by_rows.entry(own.constraints.rows.len() / 10 * 10).or_default();
            *count += 1.0;
            *time += began.elapsed().as_secs_f64();
        }
    }
    let elapsed = cpu_seconds() - begin;
    let count = f64::from(steps).at_least(1.0);
    let times: Vec<String> =
        STAGES.iter().zip(stages).map(|(name, time)| format!("\"{name}\": {:.1}", time * 1e6 / count)).collect();
    let by_rows = by_rows.iter().filter(|(_, (count, _))| *count >= 20.0);
    let by_rows: Vec<String> = by_rows.map(|(rows, (count, time))| format!("\"{rows}\": {:.1}", time * 1e6 / count)).collect();
    println!(
        "{{\"steps\": {steps}, \"steps_per_second\": {:.0}, \"iterations\": {}, \"rows\": {}, \"contacts\": {}, \"us_per_stage\": {{{}}}, \"us_by_rows\": {{{}}}}}",
        f64::from(steps) / elapsed.at_least(1e-9),
        spread(iterations),
        spread(rows),
        spread(contacts),
        times.join(", "),
        by_rows.join(", ")
    );
    Ok(())
}
