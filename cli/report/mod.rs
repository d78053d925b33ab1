//! `msk report DIR...`: evaluations, sweeps and trainings as one page, and as Markdown, CSV and LaTeX.

mod episodes;
mod page;
mod paper;
mod radars;
mod read;
mod results;
mod sessions;
mod strips;

use crate::error::Error;
use crate::output;
use crate::terminal;
use crate::trace::emg::{Human, pair};
use msk_text::in_one_line;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// The folder of `--out` by itself.
const FOLDER: &str = "report";

/// Write a report of evaluations, sweeps and trainings: one HTML page that works without a network, and its tables as Markdown, CSV
/// and LaTeX
///
/// The page has the leaderboard, means of families, radars, standard metrics, recruitment, robustness curves, learning curves with
/// peak-efficiency steps, film strips of `msk eval --strip`, sessions of direct control, and for episodes that were traced the reward
/// terms over time and the activations of muscle families. The tables in the layouts of the paper are in files of their own.
#[derive(clap::Args)]
pub struct Args {
    /// Folders: results of `msk eval` (with --sweep too) or of `msk train`, or sessions of `msk session`
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Folder for report.html, report.md, report.csv, report.tex, and the tables in the layouts of the paper, paper.md, paper.csv,
    /// paper.tex
    #[arg(long, value_name = "DIR", default_value = FOLDER)]
    out: PathBuf,
    /// Envelopes of human electromyograms, with which the muscles of traced episodes are compared: .csv, .sto or .mot, a column per
    /// muscle, rows at equal distances over the gait cycle. `msk trace envelopes` makes one of a published data set. Several, each with its
    /// own `--emg`, are for the tasks that they name
    #[arg(long, value_name = "[TASK=]FILE", value_parser = of_task)]
    emg: Vec<(Option<String>, PathBuf)>,
    /// A muscle and the column of --emg that it is compared with [default: every column that is called like a muscle, or as Gait120
    /// calls one]
    #[arg(long, value_name = "MUSCLE=COLUMN", value_parser = pair, requires = "emg")]
    map: Vec<(String, String)>,
    /// Title of the page
    #[arg(long, default_value = "Evaluation")]
    title: String,
}

/// Reads `TASK=FILE`, or a file for all tasks.
fn of_task(text: &str) -> Result<(Option<String>, PathBuf), String> {
    let is_name = |name: &str| !name.is_empty() && name.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'_');
    match text.split_once('=') {
        Some((task, file)) if is_name(task) && !file.is_empty() => Ok((Some(task.to_owned()), file.into())),
        Some((_, "")) | None if text.is_empty() || text.ends_with('=') => Err("expected FILE or TASK=FILE".into()),
        _ => Ok((None, text.into())),
    }
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

impl Section {
    /// The same part with every text in one line, whatever the files hold from which it comes.
    fn in_lines(mut self) -> Self {
        let cells = self.table.iter_mut().flat_map(|grid| grid.head.iter_mut().chain(grid.rows.iter_mut().flatten()));
        cells.chain([&mut self.title, &mut self.words]).for_each(|text| *text = in_one_line(text));
        self
    }
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
    let recorded = args.emg.iter().map(|(task, path)| Ok((task.clone(), Human::read(path, &args.map)?)));
    let (episodes, compared) = episodes::sections(&sources, &recorded.collect::<Result<Vec<_>, Error>>()?)?;
    sections.extend(episodes);
    let columns = paper::columns(&sources);
    sections.push(radars::section(&columns, &sources, &compared));
    let tables = paper::tables(&columns, &sources, &compared);
    sections = sections.into_iter().map(Section::in_lines).collect();
    let title = in_one_line(&args.title);
    sections.retain(|section| section.table.as_ref().is_some_and(|grid| !grid.rows.is_empty()) || !section.figures.is_empty());
    let folder = output::folder(&args.out, FOLDER)?;
    let files = [
        ("report.html", page::html(&title, &sections)),
        ("report.md", page::markdown(&title, &sections)),
        ("report.csv", page::csv(&sections)),
        ("report.tex", page::latex(&sections)),
        ("paper.md", paper::markdown(&tables)),
        ("paper.csv", paper::csv(&tables)),
        ("paper.tex", paper::latex(&tables)),
    ];
    let mut out = terminal::out();
    for (name, text) in files.into_iter().filter(|(_, text)| !text.is_empty()) {
        output::write_in(&folder, name, text)?;
        writeln!(out, "{}", args.out.join(name).display())?;
    }
    Ok(ExitCode::SUCCESS)
}
