//! `msk motion view FILE`: a motion as a page for a browser.

use super::Start;
use crate::error::Error;
use crate::html;
use msk::compiler::numbers::fixed;
use msk::physics::scalar::Real;
use msk::physics::{self, State, Workspace};
use msk::runtime::body::sensors::Snapshot;
use msk::view::{Caption, Recorder};
use std::path::PathBuf;
use std::process::ExitCode;

/// Frames per second.
const FREQUENCY: f64 = 60.0;
/// A cycle is shown so many times, so that its seam can be seen.
const CYCLES: f64 = 2.0;
/// A longer motion is cut, s: what a page of some tens of megabytes holds.
const LONGEST: f64 = 600.0;

/// Write a motion as a page for a browser: the moving body with its muscles, and its joints over time
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    start: Start,
    /// The file to write
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
}

/// Runs the subcommand.
///
/// # Errors
/// A motion or body that cannot be read or do not fit each other, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (motion, bound) = args.start.load()?;
    let (model, body) = (&*bound.model, &*bound.body);
    let length = if motion.cycle { CYCLES * motion.duration } else { motion.duration };
    let frames = (length.clip(0.0, LONGEST) * FREQUENCY) as u32;
    let (mut state, mut workspace) = (State::new(model), Workspace::new(model));
    let mut recorder = None;
    for frame in 0..=frames {
        body.follow(model, &motion, f64::from(frame) / FREQUENCY, &mut state, &mut workspace);
        physics::smooth(model, &state, &mut workspace);
        let snapshot = Snapshot { body, model, state: &state, workspace: &workspace };
        recorder.get_or_insert_with(|| Recorder::of(&snapshot, &[], 1.0 / FREQUENCY)).look_at(frame, &snapshot);
    }
    let kind = if motion.cycle { "cycle" } else { "motion" };
    let outcome = format!("{kind} of {} s", fixed(motion.duration, 2));
    let caption = Caption { task: motion.name.clone(), outcome, ..Caption::default() };
    if let Some(recorder) = recorder {
        html::write(&args.out, &motion.name, &[recorder.recording(caption)?])?;
    }
    Ok(ExitCode::SUCCESS)
}
