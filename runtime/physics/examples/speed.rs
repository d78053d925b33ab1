//! Steps per second of CPU time and microseconds per stage, one episode at a time.
//!
//! `cargo run --release -p msk-physics --example speed -- [model.xml] [falling|standing] [seconds] [baseline|wide|widest]`
//!
//! Muscles are excited at random anew every ten milliseconds. CPU time is counted where the system tells it (Linux), so other
//! programs on the machine do not count; `benches/ratio.py --program` compares with MuJoCo.

use msk_physics::model::{JointKind, Model};
use msk_physics::scalar::Real;
use msk_physics::{Fault, Instructions, STAGES, State, Workspace, motion, step_by_stage};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.into());
    let model = Model::from_file(argument(0, "bodies/models/human416.xml"))?;
    let standing = argument(1, "falling") == "standing";
    let seconds: f64 = argument(2, "2").parse()?;
    let instructions = match argument(3, "widest").as_str() {
        "baseline" => Instructions::Baseline,
        "wide" => Instructions::Wide,
        _ => Instructions::Widest,
    };
    let mut workspace = Workspace::new(&model).with_instructions(instructions);
    let origin = initial_state(&model, standing, &mut workspace)?;
    let duration = if standing { 0.2 } else { 1.5 };
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

/// CPU time of this process, s; where the system does not tell, time that has passed.
fn cpu_seconds() -> f64 {
    let times = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = times.and_then(|times| times.split(' ').next()?.parse::<f64>().ok());
    let elapsed = || std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0.0, |time| time.as_secs_f64());
    nanoseconds.map_or_else(elapsed, |time| time * 1e-9)
}

/// The reference configuration; standing: lowered until something touches.
fn initial_state(model: &Model, standing: bool, workspace: &mut Workspace<f64>) -> Result<State<f64>, Fault> {
    let mut state = State::new(model);
    let free = model.joints.kind.iter().position(|kind| *kind == JointKind::Free).filter(|_| standing);
    let Some(height) = free.map(|joint| model.joints.position_address[joint] + 2) else { return Ok(state) };
    let start = state.position[height];
    let (mut low, mut high) = (-3.0, 3.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        state.position[height] = start + middle;
        motion(model, &state, workspace)?;
        let touches = workspace.lanes[0].constraints.contacts.iter().any(|contact| contact.distance < 0.0);
        if touches { low = middle } else { high = middle }
    }
    Ok(state)
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2_f64.powi(64)
    }
}
