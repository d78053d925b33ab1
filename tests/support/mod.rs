//! What the comparisons with MuJoCo share: golden files and the random states both sides draw.
#![allow(
    dead_code,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "test support: a broken golden file fails the test"
)]

pub mod manifests;
pub mod rows;
pub mod touching;

use flate2::read::GzDecoder;
use msk_physics::State;
use msk_physics::model::{JointKind, Model};
use nalgebra::Vector3;
use serde_json::Value;
use std::{fs::File, path::PathBuf};

/// A path inside the repository.
pub fn repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A compressed golden file of `tests/golden`.
pub fn golden(name: &str) -> Value {
    let path = repository("tests/golden").join(format!("{name}.json.gz"));
    let file = File::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_reader(GzDecoder::new(file)).expect("golden files are JSON")
}

/// A flat list of numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|number| number.as_f64().expect("a number")).collect()
}

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014), the same as in `tests/oracle/smooth.py`.
pub struct SplitMix(pub u64);

impl SplitMix {
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 2f64.powi(-53)
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// The random state that `draw` of `tests/oracle/smooth.py` makes, number for number.
pub fn draw(model: &Model, random: &mut SplitMix) -> State<f64> {
    let mut state = State::new(model);
    for joint in 0..model.joints.kind.len() {
        let address = model.joints.position_address[joint];
        let width = match model.joints.kind[joint] {
            JointKind::Free => 7,
            JointKind::Ball => 4,
            JointKind::Hinge | JointKind::Slide => {
                let [low, high] = model.joints.range[joint].unwrap_or([-1.0, 1.0]);
                state.position[address] = low + (high - low) * random.between(-0.1, 1.1);
                continue;
            }
        };
        state.position[address..address + width].fill_with(|| random.between(-1.0, 1.0));
    }
    state.velocity.fill_with(|| random.between(-3.0, 3.0));
    state.activation.fill_with(|| random.unit());
    state.control.fill_with(|| random.between(-0.1, 1.1));
    state.applied_force.fill_with(|| random.between(-5.0, 5.0));
    for [force, torque] in &mut state.body_force[1..] {
        *force = Vector3::from_fn(|_, _| random.between(-2.0, 2.0));
        *torque = Vector3::from_fn(|_, _| random.between(-2.0, 2.0));
    }
    state
}

/// Holds a page of `docs` that a test writes to what the test has found; with `MSK_UPDATE=1` in the environment, writes it.
pub fn page(name: &str, found: &str) {
    let path = repository("docs").join(format!("{name}.md"));
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::write(&path, found).unwrap();
        return;
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == found, "{} is not as found; MSK_UPDATE=1 writes it anew:\n{found}", path.display());
}
