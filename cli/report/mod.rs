//! `msk report DIR...`: evaluations, sweeps and trainings as one page, and as Markdown, CSV and LaTeX.

mod episodes;
mod page;
mod paper;
mod read;
mod results;
mod strips;

use crate::error::{Context, Error};
use crate::trace::emg::{Human, pair};
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Write a report of evaluations, sweeps and trainings: one HTML page that works without a network, and its tables as Markdown, CSV
/// and LaTeX
///
/// The page has the leaderboard, means of families, a radar, standard metrics, recruitment, robustness curves, learning curves with
/// peak-efficiency steps, film strips of `msk eval --strip`, and for episodes that were traced the reward terms over time and the
/// activations of muscle families.
#[derive(clap::Args)]
pub struct Args {
    /// Folders: results of `msk eval` (with --sweep too) or of `msk train`
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Folder for report.html, report.md, report.csv, report.tex, and the tables in the layouts of the paper, paper.tex
    #[arg(long, value_name = "DIR", default_value = "report")]
    out: PathBuf,
    /// Envelopes of human electromyograms, with which the muscles of traced episodes are compared: .csv, .sto or .mot, a column per
    /// muscle, rows at equal distances over the gait cycle
    #[arg(long, value_name = "FILE")]
    emg: Option<PathBuf>,
    /// A muscle and the column of --emg that it is compared with [default: every column that is called like a muscle]
    #[arg(long, value_name = "MUSCLE=COLUMN", value_parser = pair, requires = "emg")]
    map: Vec<(String, String)>,
    /// Title of the page
    #[arg(long, default_value = "Evaluation")]
    title: String,
}

/// A part of a report.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// What the numbers are, in a sentence.
    pub words: String,
    /// Head and rows; none if there is no table.
    pub table: Option<Grid>,
    /// Pictures as elements of HTML.
    pub figures: Vec<String>,
}

/// A table: the first column has names.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grid {
    /// Titles of the columns.
    pub head: Vec<String>,
    /// As many cells as the head.
    pub rows: Vec<Vec<String>>,
}

/// Writes the report.
///
/// # Errors
/// A folder that cannot be read or has neither results nor a training, or a file that cannot be written.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let sources = args.folders.iter().map(|folder| read::read(folder)).collect::<Result<Vec<_>, _>>()?;
    let mut sections = results::sections(&sources);
    sections.extend(strips::sections(&sources)?);
    let human = args.emg.as_ref().map(|path| Human::read(path, &args.map)).transpose()?;
    sections.extend(episodes::sections(&sources, human.as_ref())?);
    sections.retain(|section| section.table.as_ref().is_some_and(|grid| !grid.rows.is_empty()) || !section.figures.is_empty());
    fs::create_dir_all(&args.out).context(|| format!("cannot make `{}`", args.out.display()))?;
    let files = [
        ("report.html", page::html(&args.title, &sections)),
        ("report.md", page::markdown(&args.title, &sections)),
        ("report.csv", page::csv(&sections)),
        ("report.tex", page::latex(&sections)),
        ("paper.tex", paper::latex(&sources)),
    ];
    let mut out = io::stdout().lock();
    for (name, text) in files.into_iter().filter(|(_, text)| !text.is_empty()) {
        let path = args.out.join(name);
        fs::write(&path, text).context(|| format!("cannot write `{}`", path.display()))?;
        writeln!(out, "{}", path.display())?;
    }
    Ok(ExitCode::SUCCESS)
}
