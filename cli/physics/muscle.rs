//! `msk physics muscle`: a muscle's path, wraps, length and moment arm over a joint's sweep.

use super::Start;
use crate::error::Error;
use crate::output;
use crate::terminal;
use core::fmt::Write as _;
use msk::compiler::numbers::fixed;
use msk_draw::chart::{self, Band, Chart, Panel};
use msk_runtime::inspect::{MuscleSweep, Sample, sweep_muscle};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Print a muscle's path, wraps, length and moment arm over the range of a joint, couplings solved
///
/// The other joints stay as the state has them. A moment arm is -dL/dq along the motion of the joint with all joints that
/// follow it by couplings; it is positive where the muscle drives the joint towards larger coordinates.
#[derive(clap::Args)]
pub struct Args {
    /// Name of the muscle
    muscle: String,
    /// Name of the hinge or slide to sweep
    #[arg(long)]
    joint: String,
    #[command(flatten)]
    start: Start,
    /// Equal steps over the joint's range
    #[arg(long, default_value_t = 40, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    steps: u16,
    /// Also draw the curves into this SVG file
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Print JSON, in metres and radians
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
///
/// # Errors
/// A model or state that cannot be read, names that do not exist, a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (model, state) = args.start.load()?;
    let sweep = sweep_muscle(&model, &state, &args.muscle, &args.joint, usize::from(args.steps))?;
    if let Some(path) = &args.plot {
        output::write(path, chart::svg(&picture(&sweep)))?;
    }
    let text = if args.json { serde_json::to_string(&sweep)? + "\n" } else { readable(&sweep) };
    terminal::out().write_all(text.as_bytes())?;
    Ok(ExitCode::SUCCESS)
}

/// Factor and name of the unit in which people read a joint's coordinate.
fn coordinate(sweep: &MuscleSweep) -> (f64, &'static str) {
    if sweep.unit == "m" { (1e3, "mm") } else { (180.0 / core::f64::consts::PI, "deg") }
}

/// Factor and name of the unit of moment arms.
fn arm(sweep: &MuscleSweep) -> (f64, &'static str) {
    if sweep.unit == "m" { (1.0, "m/m") } else { (1e3, "mm") }
}

fn readable(sweep: &MuscleSweep) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{} on {}, tendon {}", sweep.muscle, sweep.joint, sweep.tendon);
    if !sweep.followers.is_empty() {
        let _ = writeln!(out, "coupled joints: {}", sweep.followers.join(", "));
    }
    let _ = writeln!(
        out,
        "peak force {} N, optimal fibre {} mm, tendon slack {} mm; fibre over the sweep {}..{} optimal lengths",
        fixed(sweep.peak_force, 0),
        fixed(1e3 * sweep.optimal_fibre_length, 1),
        fixed(1e3 * sweep.tendon_slack_length, 1),
        fixed(sweep.fibre_range[0], 2),
        fixed(sweep.fibre_range[1], 2),
    );
    if sweep.stretching_length > sweep.tendon_slack_length {
        let _ = writeln!(
            out,
            "the operating range leaves {} tendon: with `tendons elastic` {} mm of the path would be elastic",
            if sweep.tendon_slack_length > 0.0 { "little" } else { "no" },
            fixed(1e3 * sweep.stretching_length, 1),
        );
    }
    let _ = writeln!(out, "\npath at the start (world frame, m; length from the previous point, mm)");
    let width = sweep.path.iter().map(|point| point.at.chars().count()).max().unwrap_or(0);
    for point in &sweep.path {
        let [x, y, z] = point.position.map(|coordinate| fixed(coordinate, 4));
        let (kind, at, length, body) = (point.kind, &point.at, fixed(1e3 * point.length, 2), &point.body);
        let _ = writeln!(out, "  {kind:<5} {at:<width$} {x:>9} {y:>9} {z:>9} {length:>9}  on {body}");
    }
    let ((turn, degree), (scale, unit)) = (coordinate(sweep), arm(sweep));
    let _ = writeln!(out, "\n{:>9} {:>11} {:>15} {:>10}  wraps (arc, mm)", degree, "length, mm", format!("arm, {unit}"), "fibre");
    for sample in &sweep.samples {
        let Sample { coordinate, length, moment_arm, fibre, .. } = sample;
        let (at, length, arm) = (fixed(turn * coordinate, 2), fixed(1e3 * length, 3), fixed(scale * moment_arm, 3));
        let fibre = fixed(*fibre, 3);
        let _ = writeln!(out, "{at:>9} {length:>11} {arm:>15} {fibre:>10}  {}", wraps(sample));
    }
    out
}

fn wraps(sample: &Sample) -> String {
    let touched = sample.wraps.iter().filter(|wrap| wrap.touches);
    let words: Vec<String> = touched.map(|wrap| format!("{} {}", wrap.geom, fixed(1e3 * wrap.arc, 2))).collect();
    if words.is_empty() && !sample.wraps.is_empty() { "none".into() } else { words.join(", ") }
}

fn picture(sweep: &MuscleSweep) -> Chart {
    let ((turn, degree), (scale, unit)) = (coordinate(sweep), arm(sweep));
    let curve = |value: &dyn Fn(&Sample) -> f64| sweep.samples.iter().map(value).collect::<Vec<f64>>();
    let panel = |label: String, values| Panel { label, curves: vec![(String::new(), values)] };
    let mut arms = vec![(String::new(), curve(&|sample| scale * sample.moment_arm))];
    if !sweep.followers.is_empty() {
        arms[0].0 = "with coupled joints".into();
        arms.push(("of the joint alone".into(), curve(&|sample| scale * sample.own_moment_arm)));
    }
    Chart {
        title: format!("{} over {}", sweep.muscle, sweep.joint),
        axis: format!("{} [{degree}]", sweep.joint),
        at: curve(&|sample| turn * sample.coordinate),
        panels: vec![
            panel("length of the path [mm]".into(), curve(&|sample| 1e3 * sample.length)),
            Panel { label: format!("moment arm [{unit}]"), curves: arms },
            panel("fibre [optimal lengths]".into(), curve(&|sample| sample.fibre)),
        ],
        bands: bands(sweep, turn),
    }
}

/// Where along the sweep each obstacle is touched.
fn bands(sweep: &MuscleSweep, turn: f64) -> Vec<Band> {
    let mut bands = Vec::new();
    for obstacle in 0..sweep.samples.first().map_or(0, |sample| sample.wraps.len()) {
        let mut from = None;
        for (index, sample) in sweep.samples.iter().enumerate() {
            let wrap = &sample.wraps[obstacle];
            let here = turn * sample.coordinate;
            if wrap.touches && from.is_none() {
                from = Some(here);
            }
            let ends = !wrap.touches || index + 1 == sweep.samples.len();
            if let (true, Some(start)) = (ends, from) {
                bands.push(Band { label: format!("on {}", wrap.geom), range: [start, here] });
                from = None;
            }
        }
    }
    bands
}
