//! How long pictures take: `cargo bench -p msk-view --bench render`.

#![allow(missing_docs)]

use msk_physics::{self as physics, State, Workspace};
use msk_program::body::{Axis, BodyDescription};
use msk_program::task::RootPlacement;
use msk_runtime::bodies;
use msk_runtime::body::Body;
use msk_runtime::body::sensors::Snapshot;
use msk_view::render::{Colouring, Options, Renderer};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

const ROUNDS: u32 = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let model = bodies::model(&Path::new(bodies::ROOT).join("bodies/models/human416.xml"))?;
    let description = BodyDescription {
        name: "human".into(),
        root: "Full Body".into(),
        root_forward: Axis::MinusY,
        root_up: Axis::PlusZ,
        poses: vec![("neutral".into(), Vec::new())],
        ..BodyDescription::default()
    };
    let body = Body::bind(&description, &model)?;
    let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
    body.place(&model, &RootPlacement::default(), body.neutral(), &mut state, &mut workspace);
    physics::forward(&model, &state, &mut workspace)?;
    let snapshot = Snapshot { body: &body, model: &model, state: &state, workspace: &workspace };
    let renderer = Renderer::of(&snapshot, &[], Colouring::Activation);
    let scene = renderer.scene_of(0.0, &snapshot, None);
    report("scene", || drop(renderer.scene_of(0.0, &snapshot, None)));
    for (width, height) in [(320, 240), (640, 480), (960, 720), (1920, 1080)] {
        let options = Options { width, height, ..Options::default() };
        report(&format!("{width} x {height}"), || drop(scene.render(&options)));
    }
    let picture = scene.render(&Options::default())?;
    report("PNG of 960 x 720", || drop(picture.png()));
    Ok(())
}

/// Prints the median time of a call.
fn report(what: &str, mut call: impl FnMut()) {
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            call();
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{what:>18}: {:6.1} ms", times[times.len() / 2]);
}
