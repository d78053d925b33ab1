//! `msk motion check FILE`: a motion in numbers.

use super::Start;
use crate::error::{Error, FAILURE};
use crate::numbers::within;
use crate::terminal;
use msk::compiler::numbers::{exact, fixed, for_people};
use msk::runtime::inspect::{MotionLimits, MotionReport, inspect_motion};
use std::fmt::Write as _;
use std::io::Write;
use std::process::ExitCode;

/// Measure a motion on a body: ranges, couplings, feet on the ground, the seam of a cycle, left against right
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    start: Start,
    /// How far a standing foot may slide, mm
    #[arg(long, value_name = "MM", default_value_t = 20.0, value_parser = within(0.0, 1e6))]
    sliding: f64,
    /// Print JSON, in metres, seconds and radians
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand; the exit code tells whether everything is within its limits.
///
/// # Errors
/// A motion or body that cannot be read, or that do not fit each other.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (motion, bound) = args.start.load()?;
    let report = inspect_motion(&bound.model, &bound.body, &motion);
    let limits = MotionLimits { sliding: args.sliding / 1e3, ..MotionLimits::default() };
    let faults = report.faults(&limits);
    let text = if args.json { serde_json::to_string(&report)? + "\n" } else { readable(&report, &limits, &faults) };
    terminal::out().write_all(text.as_bytes())?;
    Ok(if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

fn readable(report: &MotionReport, limits: &MotionLimits, faults: &[String]) -> String {
    let mut out = String::new();
    let kind = if report.cycle { "a cycle" } else { "a motion" };
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{}: {kind} of {} s in {} rows", report.name, for_people(report.duration), report.rows);
    if let Some([stride, speed]) = report.stride {
        let _ = writeln!(out, "one cycle moves the root by {} m, {} m/s", for_people(stride), for_people(speed));
    }
    let _ =
        writeln!(out, "\n{:<24} {:>5} {:>9} {:>9} {:>19} {:>11}", "column", "unit", "lowest", "highest", "range", "fastest, /s");
    for column in &report.columns {
        let shown = |value: f64| for_people((value / column.factor * 100.0).round() / 100.0);
        let range = column.range.map_or_else(|| "-".to_owned(), |[low, high]| format!("{} .. {}", shown(low), shown(high)));
        let [low, high] = column.values.map(shown);
        let residual = column.residual.map_or_else(String::new, |residual| format!("  off its coupling by {}", shown(residual)));
        let (name, unit, rate) = (&column.name, &column.unit, shown(column.rate));
        let _ = writeln!(out, "{name:<24} {unit:>5} {low:>9} {high:>9} {range:>19} {rate:>11}{residual}");
    }
    if !report.feet.is_empty() {
        let _ = writeln!(
            out,
            "\n{:<24} {:>8} {:>13} {:>12} {:>14}",
            "foot", "stands", "penetration, mm", "slides, mm", "highest, mm"
        );
    }
    for foot in &report.feet {
        let millimetres = |value: f64| fixed(1e3 * value, 1);
        let (stance, deep, slides) = (fixed(100.0 * foot.stance, 0), millimetres(foot.penetration), millimetres(foot.sliding));
        let _ = writeln!(out, "{:<24} {stance:>6} % {deep:>13} {slides:>12} {:>14}", foot.name, millimetres(foot.clearance));
    }
    let (deep, slides) = (exact(1e3 * limits.penetration), exact(1e3 * limits.sliding));
    let _ = writeln!(
        out,
        "\nlimits: feet {deep} mm penetration, sliding {slides} mm; joints within their ranges, coupled joints on their couplings"
    );
    if let Some(seam) = report.seam {
        let _ = writeln!(out, "seam: the sharpest bend there is {} of the sharpest elsewhere", fixed(seam, 2));
    }
    if let Some((difference, later)) = report.sides {
        let when = if later { "half a cycle later" } else { "at the same time" };
        let _ =
            writeln!(out, "sides: the left side equals the right side {when}, within {} deg", fixed(difference.to_degrees(), 2));
    }
    for fault in faults {
        let _ = writeln!(out, "wrong: {fault}");
    }
    let _ = writeln!(out, "{}", if faults.is_empty() { "all within the limits" } else { "not within the limits" });
    out
}
