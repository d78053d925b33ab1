//! `msk physics bench`: how fast the simulator is.

use crate::error::Error;
use crate::numbers::within;
use crate::terminal;
use msk_physics::model::ElasticTendons;
use msk_runtime::{
    bench::{self, Protocol, Report, Settings},
    bodies,
};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Measure steps per second, with random muscle excitations throughout
#[derive(clap::Args)]
pub struct Args {
    /// The model to run; the built-in human by default
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Independent bodies, one per thread
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Wall-clock time to measure
    #[arg(long, default_value_t = 5.0, value_parser = within(0.0, LONGEST))]
    seconds: f64,
    /// What the body does
    #[arg(long, value_enum, default_value_t = Activity::Falling)]
    protocol: Activity,
    /// Seed of the excitations
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Let all tendons stretch
    #[arg(long)]
    elastic: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// More is no measurement, and may be more than a clock counts to.
const LONGEST: f64 = 86_400.0;

#[derive(Clone, Copy, clap::ValueEnum)]
enum Activity {
    /// From the reference configuration onto the ground
    Falling,
    /// On the feet for a fifth of a second, again and again
    Standing,
}

/// Runs the subcommand.
///
/// # Errors
/// A model that cannot be read or uses unsupported features.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let path = args.model.unwrap_or_else(|| Path::new(bodies::ROOT).join("bodies/models/human416.xml"));
    let mut model = bodies::model(&path)?;
    if args.elastic {
        model = model.with_elastic_tendons(ElasticTendons::default())?;
    }
    let protocol = match args.protocol {
        Activity::Falling => Protocol::Falling,
        Activity::Standing => Protocol::Standing,
    };
    let settings = Settings { protocol, seconds: args.seconds, threads: usize::from(args.threads), seed: args.seed };
    let report = bench::run(&model, &settings);
    let text = if args.json { serde_json::to_string_pretty(&report)? + "\n" } else { readable(&report) };
    terminal::out().write_all(text.as_bytes())?;
    Ok(ExitCode::SUCCESS)
}

fn readable(report: &Report) -> String {
    let mut lines = vec![
        format!("{:.0} steps per second and thread on {} thread(s)", report.steps_per_second_per_thread, report.threads),
        format!("{:.1} times real time in all; {} steps, {} faults", report.real_time_factor, report.steps, report.faults),
    ];
    for (name, spread) in [("rows", report.rows), ("contacts", report.contacts), ("iterations", report.iterations)] {
        lines.push(format!("{name:>12} {:8.2} mean {:6} at the 95th percentile", spread.mean, spread.p95));
    }
    lines.extend(report.us_per_stage.iter().map(|(stage, time)| format!("{stage:>12} {time:8.2} us")));
    lines.push(format!("{:>12} {:8.1} kB\n", "state", report.state_bytes as f64 / 1024.0));
    lines.join("\n")
}
