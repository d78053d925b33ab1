//! The protocols of the examples `speed`, `together` and `operations`, and how their time is measured.
#![allow(dead_code, reason = "each of them uses a part")]

use msk_physics::model::{JointKind, Model};
use msk_physics::scalar::Real;
use msk_physics::{Fault, Instructions, State, Workspace, motion};

/// The instructions that an argument names.
pub fn instructions(name: &str) -> Instructions {
    match name {
        "baseline" => Instructions::Baseline,
        "wide" => Instructions::Wide,
        _ => Instructions::Widest,
    }
}

/// How long an episode lasts, s.
pub fn duration(standing: bool) -> f64 {
    if standing { 0.2 } else { 1.5 }
}

/// CPU time of this process, s; where the system does not tell, time that has passed.
pub fn cpu_seconds() -> f64 {
    let times = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = times.and_then(|times| times.split(' ').next()?.parse::<f64>().ok());
    let elapsed = || std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0.0, |time| time.as_secs_f64());
    nanoseconds.map_or_else(elapsed, |time| time * 1e-9)
}

/// The reference configuration; standing: lowered until something touches.
pub fn initial_state(model: &Model, standing: bool) -> Result<State<f64>, Fault> {
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

/// Mean and 95th percentile as JSON.
pub fn spread(mut values: Vec<usize>) -> String {
    values.sort_unstable();
    let mean = values.iter().sum::<usize>() as f64 / (values.len() as f64).at_least(1.0);
    let high = values.get(values.len() * 95 / 100).copied().unwrap_or_default();
    format!("{{\"mean\": {mean:.2}, \"p95\": {high}}}")
}

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// Uniform on [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2_f64.powi(64)
    }
}
