//! Steps per second of CPU time of many episodes at once, and microseconds per stage and episode.
//!
//! `cargo run --release -p msk-physics --example together -- [model.xml] [falling|standing] [seconds] [episodes] [baseline|wide|widest]`
//!
//! The protocols are those of the example `speed`; every episode has its own excitations and begins again at its own time, so that
//! neighbours are never in step.

use msk_physics::model::{JointKind, Model};
use msk_physics::scalar::Real;
use msk_physics::{Batch, Fault, Instructions, STAGES, State, Workspace, motion};
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.into());
    let model = Arc::new(Model::from_file(argument(0, "bodies/models/human416.xml"))?);
    let standing = argument(1, "falling") == "standing";
    let seconds: f64 = argument(2, "2").parse()?;
    let episodes: usize = argument(3, "8").parse()?;
    let instructions = match argument(4, "widest").as_str() {
        "baseline" => Instructions::Baseline,
        "wide" => Instructions::Wide,
        _ => Instructions::Widest,
    };
    let mut batch = Batch::new(&model, episodes).with_instructions(instructions);
    let origin = initial_state(&model, standing)?;
    let duration = if standing { 0.2 } else { 1.5 };
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
/// CPU time of this process, s; where the system does not tell, time that has passed.
fn cpu_seconds() -> f64 {
    let times = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = times.and_then(|times| times.split(' ').next()?.parse::<f64>().ok());
    let elapsed = || std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0.0, |time| time.as_secs_f64());
    nanoseconds.map_or_else(elapsed, |time| time * 1e-9)
}

/// The reference configuration; standing: lowered until something touches.
fn initial_state(model: &Model, standing: bool) -> Result<State<f64>, Fault> {
    let (mut state, mut workspace) = (State::new(model), Workspace::new(model));
    let free = model.joints.kind.iter().position(|kind| *kind == JointKind::Free).filter(|_| standing);
    let Some(height) = free.map(|joint| model.joints.position_address[joint] + 2) else { return Ok(state) };
    let start = state.position[height];
    let (mut low, mut high) = (-3.0, 3.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        state.position[height] = start + middle;
        motion(model, &state, &mut workspace)?;
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
