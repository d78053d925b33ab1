//! `msk trace emg`: activations against envelopes of human electromyograms.

use crate::error::{Context, Error};
use msk::compiler::numbers::for_people;
use msk::draw::chart::{self, Chart, Panel};
use msk::evaluate::metrics::similarity::{Similarity, compare, mean_correlation};
use msk::evaluate::recordings::{OBTAIN, Recording};
use msk::evaluate::report::Table;
use msk_storage::read_text_file;
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Largest recording that is read, bytes.
const LARGEST: u64 = 1 << 30;

/// Compare muscle activations of a trace with envelopes of human electromyograms over the gait cycle
///
/// Cycles run from foot strike to foot strike. r is the Pearson correlation of mean and human envelope at the best cyclic shift;
/// chance is what curves of the same spectrum with shuffled phases reach. Recordings of people are not included.
#[derive(clap::Args)]
pub struct Args {
    /// The trace: with activations, ground_reactions, feet and center_of_mass
    trace: PathBuf,
    /// Table of human envelopes, .csv, .sto or .mot: a column per muscle, rows at equal distances over the gait cycle
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// A muscle and the column that it is compared with [default: every column that is called like a muscle]
    #[arg(long, value_name = "MUSCLE=COLUMN", value_parser = pair)]
    map: Vec<(String, String)>,
    /// Draw the curves to this SVG file
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

fn pair(text: &str) -> Result<(String, String), String> {
    let (muscle, column) = text.split_once('=').ok_or_else(|| format!("expected MUSCLE=COLUMN, found `{text}`"))?;
    Ok((muscle.trim().to_owned(), column.trim().to_owned()))
}

/// Prints the comparison.
///
/// # Errors
/// No reference, files that cannot be read, columns or muscles that do not exist, or an episode without a gait cycle.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let Some(path) = &args.reference else { return Err(Error::usage("there is no `--reference`").hint(OBTAIN)) };
    let trace = super::read(&args.trace)?;
    let text = read_text_file(path, LARGEST).context(|| format!("cannot read `{}`", path.display()))?;
    let named = |error: &dyn std::fmt::Display| Error::new(format!("`{}` {error}", path.display())).hint(OBTAIN);
    let recording = Recording::read(&path.to_string_lossy(), &text).map_err(|error| named(&error))?;
    let muscles = &trace.layout().muscles;
    let like_muscles = || {
        let known = recording.names.iter().filter(|name| muscles.iter().any(|muscle| muscle.name == **name));
        known.map(|name| (name.clone(), name.clone())).collect::<Vec<_>>()
    };
    let pairs = if args.map.is_empty() { like_muscles() } else { args.map.clone() };
    if pairs.is_empty() {
        let columns = recording.names.join(", ");
        let error = Error::new(format!("no column of `{}` is called like a muscle; it has {columns}", path.display()));
        return Err(error.hint("name pairs as in `--map soleus_r=Soleus`"));
    }
    let envelopes = recording.envelopes(&pairs).map_err(|error| named(&error))?;
    let found = compare(&trace, &envelopes)?;
    let mut table = Table::new(&["muscle", "cycles", "shift, %", "r", "chance", "reached by chance"]);
    for muscle in &found {
        let Similarity { cycles, shift, correlation, chance, reached, .. } = muscle;
        table.row(vec![
            muscle.muscle.clone(),
            cycles.to_string(),
            format!("{:.0}", 100.0 * shift),
            for_people(*correlation),
            for_people(*chance),
            format!("{:.1} %", 100.0 * reached),
        ]);
    }
    let mut out = io::stdout().lock();
    write!(out, "{}", table.markdown())?;
    if let Some(mean) = mean_correlation(&found) {
        writeln!(out, "\nmean r {}", for_people(mean))?;
    }
    if let Some(path) = &args.plot {
        fs::write(path, picture(&trace.origin.task, &found)).context(|| format!("cannot write `{}`", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn picture(task: &str, found: &[Similarity]) -> String {
    let panel = |muscle: &Similarity| {
        let band =
            |sign: f64| muscle.simulated.iter().zip(&muscle.deviation).map(|(mean, deviation)| mean + sign * deviation).collect();
        Panel {
            label: format!("{}, r = {}", muscle.muscle, for_people(muscle.correlation)),
            curves: vec![
                ("simulated".into(), muscle.simulated.clone()),
                ("human".into(), muscle.human.clone()),
                ("deviation over cycles".into(), band(1.0)),
                (String::new(), band(-1.0)),
            ],
        }
    };
    let panels = found.iter().map(panel).collect();
    let at = (0..101).map(f64::from).collect();
    chart::svg(&Chart {
        title: format!("Activation and human envelopes, {task}"),
        axis: "gait cycle [%]".into(),
        at,
        panels,
        bands: vec![],
    })
}
