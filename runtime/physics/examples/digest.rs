//! A digest of the states to which eight episodes come, one at a time and in lanes: equal wherever the bits are.
//!
//! `cargo run --release -p msk-physics --example digest -- [model.xml] [falling|standing|crawling] [steps] [baseline|wide|widest] [alone|lanes|both]`
//!
//! Muscles are excited at random anew every ten milliseconds. It reads no clock, so it says the same on any processor and under emulation.

mod protocol;

use msk_physics::model::Model;
use msk_physics::{Batch, State, Workspace, step};
use protocol::{Protocol, Random, initial_state, instructions};
use std::sync::Arc;

const EPISODES: usize = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.into());
    let model = Arc::new(Model::from_file(argument(0, "bodies/models/human416.xml"))?);
    let origin = initial_state(&model, Protocol::named(&argument(1, "falling")))?;
    let steps: usize = argument(2, "200").parse()?;
    let (instructions, ways) = (instructions(&argument(3, "widest")), argument(4, "both"));
    if ways != "lanes" {
        let mut workspace = Workspace::new(&model).with_instructions(instructions);
        let mut digest = Digest::default();
        for episode in 0..EPISODES {
            let mut state = origin.clone();
            for number in 0..steps {
                excite(episode, number, &mut state.control);
                step(&model, &mut state, &mut workspace)?;
            }
            digest.add(&state);
        }
        println!("{:016x}  one at a time, {steps} steps of {EPISODES} episodes", digest.0);
    }
    if ways != "alone" {
        let mut batch = Batch::new(&model, EPISODES).with_instructions(instructions);
        let mut state = origin.clone();
        for episode in 0..EPISODES {
            batch.set(episode, &origin)?;
        }
        for number in 0..steps {
            for episode in 0..EPISODES {
                excite(episode, number, &mut state.control);
                batch.set_control(episode, &state.control)?;
            }
            batch.step();
        }
        let mut digest = Digest::default();
        for episode in 0..EPISODES {
            batch.get(episode, &mut state)?;
            digest.add(&state);
        }
        println!("{:016x}  in lanes, {steps} steps of {EPISODES} episodes", digest.0);
    }
    Ok(())
}

/// Controls of a step of an episode, new ones every ten.
fn excite(episode: usize, number: usize, control: &mut [f64]) {
    let mut random = Random((episode as u64) << 32 | (number as u64 / 10));
    control.fill_with(|| random.unit());
}

/// FNV-1a of all that steps change.
struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    fn add(&mut self, state: &State<f64>) {
        let lists = [core::slice::from_ref(&state.time), &state.position, &state.velocity, &state.activation, &state.warm_start];
        for byte in lists.into_iter().flatten().flat_map(|value| value.to_bits().to_le_bytes()) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
