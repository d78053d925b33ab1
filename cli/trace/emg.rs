//! `msk trace emg`: activations against envelopes of human electromyograms.

use crate::error::{Context, Error};
use crate::output;
use crate::terminal;
use msk::compiler::numbers::{fixed, for_people};
use msk::draw::chart::{self, Chart, Panel};
use msk::evaluate::metrics::similarity::{Similarity, compare, mean_correlation};
use msk::evaluate::recordings::{OBTAIN, Recording, muscle};
use msk::evaluate::report::Table;
use msk::evaluate::trace::Trace;
use msk_storage::read_file;
use std::io::Write;
use std::path::{Path, PathBuf};
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
    /// Table of human envelopes, .csv, .sto, .mot or .c3d: a column per muscle, rows at equal distances over the gait cycle. `msk trace
    /// envelopes` makes one of a published data set
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// A muscle and the column that it is compared with [default: every column that is called like a muscle, or as Gait120 calls one]
    #[arg(long, value_name = "MUSCLE=COLUMN", value_parser = pair)]
    map: Vec<(String, String)>,
    /// Draw the curves to this SVG file
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// Reads `MUSCLE=COLUMN`.
pub fn pair(text: &str) -> Result<(String, String), String> {
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
    let found = Human::read(path, &args.map)?.compare(&trace)?;
    let mut table = Table::new(&HEAD);
    rows(&found).into_iter().for_each(|row| table.row(row));
    let mut out = terminal::out();
    write!(out, "{}", table.markdown())?;
    if let Some(mean) = mean_correlation(&found) {
        writeln!(out, "\nmean r {}", for_people(mean))?;
    }
    if let Some(path) = &args.plot {
        output::write(path, picture(&trace.origin.task, &found))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// A recording of people, and the muscles that its columns are compared with.
pub struct Human {
    path: PathBuf,
    recording: Recording,
    map: Vec<(String, String)>,
}

impl Human {
    /// Reads a recording.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(path: &Path, map: &[(String, String)]) -> Result<Self, Error> {
        let bytes = read_file(path, LARGEST).context(|| format!("cannot read `{}`", path.display()))?;
        let recording = Recording::read(&path.to_string_lossy(), &bytes).map_err(|error| damaged(path, &error))?;
        Ok(Self { path: path.into(), recording, map: map.to_vec() })
    }

    /// Compares the muscles of a trace with its columns.
    ///
    /// # Errors
    /// Columns or muscles that do not exist, or an episode without a gait cycle.
    pub fn compare(&self, trace: &Trace) -> Result<Vec<Similarity>, Error> {
        let muscles = &trace.layout().muscles;
        let like_muscles = || {
            let is_muscle = |name: &String| muscles.iter().any(|muscle| muscle.name == *name);
            let pair = |name: &String| {
                let muscle = if is_muscle(name) { Some(name.clone()) } else { muscle(name).filter(is_muscle) };
                Some((muscle?, name.clone()))
            };
            self.recording.names.iter().filter_map(pair).collect::<Vec<_>>()
        };
        let pairs = if self.map.is_empty() { like_muscles() } else { self.map.clone() };
        if pairs.is_empty() {
            let columns = self.recording.names.join(", ");
            let error = Error::new(format!("no column of `{}` is called like a muscle; it has {columns}", self.path.display()));
            return Err(error.hint("name pairs as in `--map soleus_r=Soleus`"));
        }
        let envelopes = self.recording.envelopes(&pairs).map_err(|error| damaged(&self.path, &error))?;
        Ok(compare(trace, &envelopes)?)
    }
}

fn damaged(path: &Path, error: &dyn std::fmt::Display) -> Error {
    Error::new(format!("`{}` {error}", path.display())).hint(OBTAIN)
}

/// Titles of the columns of a comparison.
pub const HEAD: [&str; 7] = ["muscle", "recorded as", "cycles", "shift, %", "r", "chance", "reached by chance"];

/// A row for every muscle.
pub fn rows(found: &[Similarity]) -> Vec<Vec<String>> {
    let row = |muscle: &Similarity| {
        let Similarity { cycles, shift, correlation, chance, reached, .. } = muscle;
        vec![
            muscle.muscle.clone(),
            muscle.column.clone(),
            cycles.to_string(),
            fixed(100.0 * shift, 0),
            for_people(*correlation),
            for_people(*chance),
            format!("{} %", fixed(100.0 * reached, 1)),
        ]
    };
    found.iter().map(row).collect()
}

/// The column of a recording behind the name of a muscle, where it has another name.
fn recorded(muscle: &Similarity) -> String {
    if muscle.column == muscle.muscle { String::new() } else { format!(" ({})", muscle.column) }
}

/// The curves of all muscles, simulated and human.
pub fn picture(task: &str, found: &[Similarity]) -> String {
    let panel = |muscle: &Similarity| {
        let band =
            |sign: f64| muscle.simulated.iter().zip(&muscle.deviation).map(|(mean, deviation)| mean + sign * deviation).collect();
        Panel {
            label: format!("{}{}, r = {}", muscle.muscle, recorded(muscle), for_people(muscle.correlation)),
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
