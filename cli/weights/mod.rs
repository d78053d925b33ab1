//! `msk weights ...`: the weights of a file as data.
//!
//! Every change goes the same way: the file is read, all wishes are checked together, what would change is printed, the file is
//! replaced in one step, and the change is added to the history from which `reset` can go back.

mod apply;
mod extract;
mod list;
mod normalize;
mod reset;
mod scale;
mod set;

use crate::error::{Context, Error};
use crate::terminal;
use msk::compiler::compile;
use msk::compiler::diagnostics::{Report, SourceMap};
use msk::compiler::files::Loader;
use msk::compiler::weights::{Change, Edit, Weights};
use msk::runtime::library::{BodyLibrary, FileLoader};
use msk::tuning::store::Store;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// List and change the weights of reward terms in a file; only digits change
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    List(list::Args),
    Set(set::Args),
    Scale(scale::Args),
    Normalize(normalize::Args),
    Reset(reset::Args),
    Apply(apply::Args),
    Extract(extract::Args),
}

/// Runs the chosen subcommand.
///
/// # Errors
/// Those of the subcommand.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    match args.command {
        Command::List(args) => list::run(&args),
        Command::Set(args) => set::run(&args),
        Command::Scale(args) => scale::run(&args),
        Command::Normalize(args) => normalize::run(&args),
        Command::Reset(args) => reset::run(&args),
        Command::Apply(args) => apply::run(&args),
        Command::Extract(args) => extract::run(&args),
    }
}

/// A file whose weights change.
#[derive(clap::Args)]
struct Target {
    /// The file
    file: PathBuf,
    /// Show what would change, without changing it
    #[arg(long)]
    dry_run: bool,
    /// Print the changes as JSON
    #[arg(long)]
    json: bool,
}

/// A file with its weights.
struct Opened {
    path: PathBuf,
    text: String,
    weights: Weights,
}

impl Opened {
    fn read(path: &Path) -> Result<Self, Error> {
        Self::of(path, FileLoader.load(path)?)
    }

    fn of(path: &Path, text: String) -> Result<Self, Error> {
        let mut sources = SourceMap::default();
        let file = sources.add(path.display().to_string(), text.clone());
        match Weights::of(file, &text) {
            Ok(mut weights) => {
                // Ranges that another task gives are known once both are compiled; a file that cannot be is edited by its text.
                if weights.inherits
                    && let Ok(compilation) = compile(path, &FileLoader, &BodyLibrary::default())
                {
                    weights.bounded_by(&compilation.tasks);
                }
                Ok(Self { path: path.into(), text, weights })
            }
            Err(errors) => Err(Error::rendered(&Report::new(sources, errors))),
        }
    }

    /// Why there is nothing to list or change.
    fn none(&self) -> Error {
        Error::new(format!("`{}` contains no weights", self.path.display()))
            .hint("weights are declared in a task: `reward { 10 pose = ... }`")
    }

    /// The entries of the named terms; of all that are not fixed if none is named.
    fn chosen(&self, terms: &[String]) -> Result<Vec<usize>, Error> {
        if self.weights.entries.is_empty() {
            return Err(self.none());
        }
        if terms.is_empty() {
            let bounds = |index: &usize| self.weights.entries[*index].bounds;
            return Ok((0..self.weights.entries.len())
                .filter(|index| bounds(index) != msk::compiler::weights::Bounds::Fixed)
                .collect());
        }
        terms.iter().map(|term| self.weights.find(term).map_err(Error::from)).collect()
    }

    /// The wish that entry `index` become `value`.
    fn wish(&self, index: usize, value: f64) -> Edit {
        let entry = &self.weights.entries[index];
        Edit::new(format!("{}.{}", entry.task, entry.term), value)
    }

    fn edit(&self, edits: &[Edit]) -> Result<(String, Vec<Change>), Error> {
        self.weights.edit(&self.text, edits).context(|| "nothing was changed".into())
    }
}

/// Makes the changes that `edits` wishes of a file, or shows them. While they are made the file is locked, so that no program's
/// change is lost.
fn change(target: &Target, by: &str, edits: impl Fn(&Opened) -> Result<Vec<Edit>, Error>) -> Result<ExitCode, Error> {
    // A file that cannot be edited is reported before anything is made beside it.
    let opened = Opened::read(&target.file)?;
    let (_, mut changes) = opened.edit(&edits(&opened)?)?;
    if !target.dry_run {
        changes = Store::open(&target.file)?.edit::<Error>(by, |version| {
            let opened = Opened::of(&target.file, version.text.clone())?;
            opened.edit(&edits(&opened)?)
        })?;
    }
    print(&changes, target)
}

fn print(changes: &[Change], target: &Target) -> Result<ExitCode, Error> {
    let mut out = terminal::out();
    if target.json {
        let report = serde_json::json!({ "file": target.file, "applied": !target.dry_run, "changes": changes });
        writeln!(out, "{report}")?;
        return Ok(ExitCode::SUCCESS);
    }
    for change in changes {
        writeln!(out, "{change}")?;
    }
    match (changes.len(), target.dry_run) {
        (0, _) => writeln!(out, "nothing to change")?,
        (_, true) => writeln!(out, "(dry run: `{}` is unchanged)", target.file.display())?,
        _ => {}
    }
    Ok(ExitCode::SUCCESS)
}
