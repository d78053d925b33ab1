//! `msk weights apply FILE --weights weights.toml`.

use super::{Opened, Target, change};
use crate::error::Error;
use crate::project::Project;
use msk::compiler::diagnostics::{FileId, Report, SourceMap};
use msk::compiler::files::Loader;
use msk::compiler::task::Origin;
use msk::compiler::weights::{Edit, Weights};
use msk::runtime::library::FileLoader;
use msk::tuning::overlay::Overlay;
use std::path::PathBuf;
use std::process::ExitCode;

/// Write the weights of a weights file into the source; only digits change
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// The weights file
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
}

/// Which of the files that were read writes the weight of a term.
fn writer(project: &Project, term: &str) -> Option<String> {
    let sources = &project.compilation.sources;
    let writes = |file: &FileId| Weights::of(*file, sources.text(*file)).is_ok_and(|weights| weights.find(term).is_ok());
    sources.files().find(writes).map(|file| sources.path(file).to_owned())
}

/// Writes the weights into the source.
///
/// # Errors
/// A file that cannot be read or written, weights that the tasks do not allow, or terms that another file writes.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let opened = Opened::read(&args.target.file)?;
    let project = Project::open(&args.target.file, &[])?;
    let text = FileLoader.load(&args.weights)?;
    let (name, mut sources) = (args.weights.display().to_string(), SourceMap::default());
    let refused = |sources, diagnostics| Error::rendered(&Report::new(sources, diagnostics));
    let overlay = Overlay::read(&name, &text, &mut sources).map_err(|errors| refused(sources.clone(), errors))?;
    let origin = Origin::Overlay(name.clone());
    overlay.apply(&project.compilation.tasks, &origin).map_err(|errors| refused(sources.clone(), errors))?;
    let edits: Vec<Edit> =
        overlay.lines().iter().map(|line| Edit::new(format!("{}.{}", line.task, line.term), line.weight)).collect();
    for edit in &edits {
        if opened.weights.find(&edit.term).is_err() {
            let message = format!("the weight of `{}` is not declared in `{}`", edit.term, args.target.file.display());
            let hint = match writer(&project, &edit.term) {
                Some(file) => format!("apply them to the file that declares it: {file}"),
                None => "apply them to the tasks that the file declares itself, and set this one where it is declared".into(),
            };
            return Err(Error::new(message).hint(hint));
        }
    }
    if edits.is_empty() {
        return Err(Error::new(format!("nothing was changed: `{name}` contains no weights")));
    }
    change(&args.target, "apply", |_| Ok(edits.clone()))
}
