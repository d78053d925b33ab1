//! The protocols of the examples `speed`, `together` and `operations`, and how their time is measured.
#![allow(dead_code, reason = "each of them uses a part")]

use msk_physics::model::{JointKind, Model, Quaternion, rotation};
use msk_physics::scalar::Real;
use msk_physics::{Fault, Instructions, State, Workspace, motion, step};

/// The instructions that an argument names.
pub fn instructions(name: &str) -> Instructions {
    match name {
        "baseline" => Instructions::Baseline,
        "wide" => Instructions::Wide,
        _ => Instructions::Widest,
    }
}

/// How an episode begins, and when the next one does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// In the air, as the model has it.
    Falling,
    /// In the reference configuration, on the ground.
    Standing,
    /// On hands, knees and feet.
    Crawling,
}

impl Protocol {
    /// The one that an argument names.
    pub fn named(name: &str) -> Self {
        match name {
            "standing" => Self::Standing,
            "crawling" => Self::Crawling,
            _ => Self::Falling,
        }
    }

    /// How long an episode lasts, s.
    pub fn duration(self) -> f64 {
        match self {
            Self::Falling => 1.5,
            Self::Standing => 0.2,
            Self::Crawling => 0.1,
        }
    }
}

/// CPU time of this process, s; where the system does not tell, time that has passed.
pub fn cpu_seconds() -> f64 {
    let times = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = times.and_then(|times| times.split(' ').next()?.parse::<f64>().ok());
    let elapsed = || std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0.0, |time| time.as_secs_f64());
    nanoseconds.map_or_else(elapsed, |time| time * 1e-9)
}

/// The joints of a crawling body that are not where the model has them, rad: `pose neutral` and the `init` of `tasks/locomotion/crawl.msk`.
/// Left and right are alike.
const CRAWLING: [(&str, f64); 7] = [
    ("hip_flexion", 80.0),
    ("hip_adduction", -12.0),
    ("knee_angle", 85.0),
    ("ankle_angle", -35.0),
    ("elv_angle", 85.0),
    ("shoulder_elv", 85.0),
    ("elbow_flexion", 10.0),
];

/// How far a crawling body leans forward, degrees.
const PITCH: f64 = 85.0;

/// How long a crawling body sinks before its episode begins, s: first its fingers touch the ground, then knees and feet, too.
const SINKING: f64 = 0.12;

/// The first state of an episode. On the ground means lowered until something touches it.
pub fn initial_state(model: &Model, protocol: Protocol) -> Result<State<f64>, Fault> {
    let mut state = State::new(model);
    let free = model.joints.kind.iter().position(|kind| *kind == JointKind::Free);
    let Some(root) = free.map(|joint| model.joints.position_address[joint]).filter(|_| protocol != Protocol::Falling) else {
        return Ok(state);
    };
    if protocol == Protocol::Crawling {
        crawl(model, root, &mut state.position);
    }
    lower(model, root + 2, &mut state)?;
    if protocol == Protocol::Crawling {
        let mut workspace = Workspace::new(model);
        while state.time < SINKING {
            step(model, &mut state, &mut workspace)?;
        }
        state.time = 0.0;
    }
    Ok(state)
}

/// Lowers the coordinate `height` until something touches what stands still.
fn lower(model: &Model, height: usize, state: &mut State<f64>) -> Result<(), Fault> {
    let mut workspace = Workspace::new(model);
    let start = state.position[height];
    let (mut low, mut high) = (-3.0, 3.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        state.position[height] = start + middle;
        motion(model, state, &mut workspace)?;
        // A body may touch itself wherever it is.
        let fixed = |geom: usize| model.geoms.body[geom] == 0;
        let contacts = &workspace.lanes[0].constraints.contacts;
        let touches = contacts.iter().any(|contact| contact.distance < 0.0 && contact.geoms.iter().any(|&geom| fixed(geom)));
        if touches { low = middle } else { high = middle }
    }
    Ok(())
}

/// Puts a body on hands and knees. A model without such joints stays as it is but for its root.
fn crawl(model: &Model, root: usize, position: &mut [f64]) {
    let (joints, couplings) = (&model.joints, &model.couplings);
    for (name, degrees) in CRAWLING {
        for side in ["l", "r"] {
            let joint = joints.name.iter().position(|known| *known == format!("{name}_{side}"));
            if let Some(joint) = joint {
                position[joints.position_address[joint]] = degrees.to_radians();
            }
        }
    }
    // What a knee or a shoulder takes along; leaders come before those that they lead.
    for (coupling, &joint) in couplings.joint.iter().enumerate() {
        let displacement = couplings.leader[coupling].map_or(0.0, |leader| {
            let leader = joints.position_address[leader];
            position[leader] - model.reference_position[leader]
        });
        let polynomial = couplings.polynomial[coupling].iter().rev().fold(0.0, |sum, c| sum * displacement + c);
        let coupled = joints.position_address[joint];
        position[coupled] = model.reference_position[coupled] + polynomial;
    }
    // About the world's x axis: in the reference configuration the body looks along -y.
    let half = 0.5 * PITCH.to_radians();
    let turn = [libm::cos(half), libm::sin(half), 0.0, 0.0];
    let own: Quaternion = [position[root + 3], position[root + 4], position[root + 5], position[root + 6]];
    position[root + 3..root + 7].copy_from_slice(&rotation::product(turn, own));
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
