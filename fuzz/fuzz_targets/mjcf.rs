//! Any text given as a model file: it is read or refused, and what is read can be stepped or gives a fault.
#![no_main]

use libfuzzer_sys::fuzz_target;
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace};

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = core::str::from_utf8(bytes) else { return };
    let Ok(model) = Model::from_mjcf(text) else { return };
    let written = model.to_mjcf();
    let again = Model::from_mjcf(&written);
    // A mesh that is read is put into a frame of its own, which rounding moves.
    let same = |again: Model| !model.meshes.is_empty() || again == model;
    assert!(again.is_ok_and(same), "what was written does not read back:\n{written}");
    let mut state = State::<f64>::new(&model);
    let mut workspace = Workspace::new(&model);
    for _ in 0..3 {
        if physics::step(&model, &mut state, &mut workspace).is_err() {
            return;
        }
    }
});
