//! `msk trace envelopes`: mean envelopes of electromyograms from the data sets in which they are published.

use crate::error::{Context, Error};
use crate::output;
use crate::terminal;
use msk::evaluate::recordings::{OBTAIN, Participant, Recording, RecordingError, average, gait120, van_hooren};
use msk_storage::read_file;
use msk_text::{in_one_line, numbers::exact};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Largest file that is read, bytes.
const LARGEST: u64 = 2 << 30;
/// Levels of folders that are searched.
const DEEPEST: usize = 4;

/// Average the electromyograms of a published data set over gait cycles and people, to a table that `msk trace emg` and `msk report`
/// compare activations with
///
/// Gait120 (walking, stairs, slopes; https://doi.org/10.6084/m9.figshare.27677016): a folder such as Gait120_001_to_010, with
/// S001/EMG/ProcessedData.mat and so on. Van Hooren and Meijer (running; https://osf.io/7qbxc): a folder with their `0. C3D files` and
/// `Excel file with EMG channels.xlsx`. A part of a data set will do: the table is the mean of everybody who is there. Both are published
/// under CC BY 4.0 and not included.
#[derive(clap::Args)]
pub struct Args {
    /// Folder with a data set, or a part of one
    folder: PathBuf,
    /// Movement of Gait120 (LevelWalking, StairAscent, StairDescent, SlopeAscent, SlopeDescent, SitToStand, StandToSit) or condition of
    /// Van Hooren and Meijer as their files name it (3ms, 278ms, 3deg_up, ...) [default: LevelWalking; 3ms]
    #[arg(long, value_name = "NAME")]
    condition: Option<String>,
    /// File to write, .csv; without it, standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the table.
///
/// # Errors
/// A folder without a data set, a condition that it does not have, or a file that cannot be read or written.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let files = files(&args.folder)?;
    let people: Vec<Person> = match gait120_files(&files) {
        found if !found.is_empty() => walking(&found, args.condition.as_deref())?,
        _ => running(&files, args)?,
    };
    let mut notes = terminal::notes();
    let mut participants = Vec::new();
    for Person { file, read } in people {
        match read {
            Ok(participant) => participants.push(participant),
            Err(error) => writeln!(notes, "`{}` {error}: left out", file.display())?,
        }
    }
    if participants.is_empty() {
        let message = format!("no file of `{}` has a gait cycle that can be read", args.folder.display());
        return Err(Error::new(message).hint(OBTAIN));
    }
    let cycles: usize = participants.iter().map(|participant| participant.cycles).sum();
    writeln!(notes, "{cycles} cycles of {} participants", participants.len())?;
    let text = table(&average(&participants));
    match &args.out {
        Some(path) => output::write(path, text)?,
        None => terminal::bytes().write_all(text.as_bytes())?,
    }
    Ok(ExitCode::SUCCESS)
}

/// A file of somebody's recording, and what there is in it.
struct Person {
    file: PathBuf,
    read: Result<Participant, RecordingError>,
}

/// All files below a folder, in the order of their names.
fn files(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    let mut folders = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        let entries = fs::read_dir(&folder).context(|| format!("cannot read the folder `{}`", folder.display()))?;
        for entry in entries {
            let entry = entry.context(|| format!("cannot read the folder `{}`", folder.display()))?;
            match entry.file_type() {
                Ok(ty) if ty.is_dir() && depth < DEEPEST => folders.push((entry.path(), depth + 1)),
                Ok(ty) if ty.is_dir() => {}
                _ => files.push(entry.path()),
            }
        }
    }
    files.sort();
    Ok(files)
}

fn bytes(path: &Path) -> Result<Vec<u8>, Error> {
    read_file(path, LARGEST).context(|| format!("cannot read `{}`", path.display()))
}

/// The file of each participant of Gait120.
fn gait120_files(files: &[PathBuf]) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = Vec::new();
    for ending in gait120::FILES {
        // The first of two files of a participant counts.
        for file in files.iter().filter(|file| file.ends_with(ending)) {
            if !found.iter().any(|known| known.parent() == file.parent()) {
                found.push(file.clone());
            }
        }
    }
    found.sort();
    found
}

fn walking(files: &[PathBuf], condition: Option<&str>) -> Result<Vec<Person>, Error> {
    let movement = condition.unwrap_or(gait120::MOVEMENTS[0]);
    if !gait120::MOVEMENTS.contains(&movement) {
        let known = gait120::MOVEMENTS.join(", ");
        return Err(Error::usage(format!("Gait120 has no movement `{movement}`")).hint(format!("choose of {known}")));
    }
    files.iter().map(|file| Ok(Person { file: file.clone(), read: gait120::read(&bytes(file)?, movement) })).collect()
}

fn running(files: &[PathBuf], args: &Args) -> Result<Vec<Person>, Error> {
    let name = |file: &PathBuf| file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let all: Vec<(&PathBuf, String)> = files.iter().map(|file| (file, name(file))).collect();
    let recorded: Vec<(&PathBuf, u32, &str)> = all
        .iter()
        .filter_map(|(file, name)| van_hooren::named(name).map(|(person, condition)| (*file, person, condition)))
        .collect();
    if recorded.is_empty() {
        let message =
            format!("`{}` has no data set that is known: no EMG/ProcessedData.mat and no Sub_01_3ms.c3d", args.folder.display());
        return Err(Error::new(message).hint(OBTAIN));
    }
    let Some((book, _)) = all.iter().find(|(_, name)| name == van_hooren::WORKBOOK) else {
        let message = format!("`{}` has recordings of runners, but no `{}`", args.folder.display(), van_hooren::WORKBOOK);
        return Err(Error::new(message).hint("it tells which channel is of which muscle: download it from https://osf.io/7qbxc"));
    };
    let condition = args.condition.as_deref().unwrap_or("3ms");
    let chosen: Vec<_> = recorded.iter().filter(|(.., known)| *known == condition).collect();
    if chosen.is_empty() {
        let mut known: Vec<&str> = recorded.iter().map(|(.., condition)| *condition).collect();
        known.sort_unstable();
        known.dedup();
        let message = format!("no recording in `{}` is of the condition `{condition}`", args.folder.display());
        return Err(Error::usage(message).hint(format!("there are {}", known.join(", "))));
    }
    let workbook = bytes(book)?;
    let person = |(file, person, _): &(&PathBuf, u32, &str)| {
        let channels = van_hooren::channels(&workbook, *person, condition);
        let read = match channels {
            Ok(channels) => van_hooren::read(&bytes(file)?, &channels),
            Err(error) => Err(error),
        };
        Ok(Person { file: (*file).clone(), read })
    };
    chosen.into_iter().map(person).collect()
}

/// A recording as comma-separated values with all digits.
fn table(recording: &Recording) -> String {
    // Names are read back as they are written, so they have no separators.
    let plain = |name: &String| {
        let name = in_one_line(&name.replace([',', ';', '\t', '"', '\n'], " "));
        // Nor is one a formula for a spreadsheet.
        if name.starts_with(['=', '+', '-', '@']) { format!("'{name}") } else { name }
    };
    let mut text = recording.names.iter().map(plain).collect::<Vec<_>>().join(",") + "\n";
    for row in 0..recording.rows() {
        let cells: Vec<String> = recording.columns.iter().map(|column| exact(column[row])).collect();
        text.push_str(&(cells.join(",") + "\n"));
    }
    text
}
