//! Steps per second of CPU time of many episodes at once, and microseconds per stage and episode.
//!
//! `cargo run --release -p msk-physics --example together -- [model.xml] [falling|standing|crawling] [seconds] [episodes] [baseline|wide|widest]`
//!
//! The protocols are those of the example `speed`; every episode has its own excitations and begins again at its own time, so that
//! neighbours are never in step.

mod protocol;

use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{Batch, STAGES};
use protocol::{Protocol, Random, cpu_seconds, initial_state, instructions};
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.into());
    let model = Arc::new(Model::from_file(argument(0, "bodies/models/human416.xml"))?);
    let protocol = Protocol::named(&argument(1, "falling"));
    let seconds: f64 = argument(2, "2").parse()?;
    let episodes: usize = argument(3, "8").parse()?;
    let instructions = instructions(&argument(4, "widest"));
    let mut batch = Batch::new(&model, episodes).with_instructions(instructions);
    let origin = initial_state(&model, protocol)?;
    let duration = protocol.duration();
    for episode in 0..episodes {
        batch.set(episode, &origin)?;
    }
    let mut random = Random(1);
    let mut control = vec![0.0; model.actuators.name.len()];
    // The first time an episode begins again sets it apart from the others.
    let mut limits: Vec<f64> = (0..episodes).map(|episode| duration * (episode + 1) as f64 / episodes as f64).collect();
    let (mut steps, mut faults, mut stages) = (0, 0, [0.0; STAGES.len()]);
    let (begin, deadline) = (cpu_seconds(), Instant::now());
    while deadline.elapsed().as_secs_f64() < seconds {
        for (episode, limit) in limits.iter_mut().enumerate() {
            faults += usize::from(batch.fault(episode).is_some());
            if batch.fault(episode).is_some() || batch.time(episode) >= Some(*limit) {
                batch.set(episode, &origin)?;
                *limit = duration;
            }
            control.fill_with(|| random.unit());
            batch.set_control(episode, &control)?;
        }
        for _ in 0..10 {
            let (mut clock, mut stage) = (Instant::now(), 0);
            batch.step_by_stage(&mut || {
                let now = Instant::now();
                stages[stage % STAGES.len()] += (now - clock).as_secs_f64();
                stage += 1;
                clock = now;
            });
            steps += episodes;
        }
    }
    let elapsed = cpu_seconds() - begin;
    let count = (steps as f64).at_least(1.0);
    let times: Vec<String> =
        STAGES.iter().zip(stages).map(|(name, time)| format!("\"{name}\": {:.1}", time * 1e6 / count)).collect();
    println!(
        "{{\"steps\": {steps}, \"steps_per_second\": {:.0}, \"faults\": {faults}, \"us_per_stage\": {{{}}}}}",
        steps as f64 / elapsed.at_least(1e-9),
        times.join(", ")
    );
    Ok(())
}
