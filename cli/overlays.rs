//! `--weights` and `--weight`: weights over those of the source, for subcommands that use tasks.

use crate::error::{Context, Error};
use crate::project::Project;
use crate::terminal;
use msk::compiler::diagnostics::{Report, SourceMap};
use msk::compiler::files::Loader;
use msk::compiler::task::Origin;
use msk::evaluate::Trial;
use msk::runtime::library::FileLoader;
use msk::tuning::live::{Live, LiveError};
use msk::tuning::overlay::{Overlay, Wish, wished};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Weights laid over the source: first a file's, then those of the command line.
#[derive(Debug, clap::Args)]
pub struct Overlays {
    /// Lay a weights file over the tasks: `[stand]`, then `pose = 11.5`
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Set one weight, over the source and the weights file: pose=11.5 or stand.pose=11.5; may be repeated
    #[arg(long, value_name = "TERM=WEIGHT", value_parser = wish, allow_hyphen_values = true)]
    weight: Vec<Wish>,
}

fn wish(text: &str) -> Result<Wish, String> {
    let (term, weight) = text.split_once('=').ok_or("a weight is set as TERM=WEIGHT, as in `pose=11.5`")?;
    let weight = weight.trim().parse().map_err(|_| format!("`{}` is not a number", weight.trim()))?;
    Ok(Wish { term: term.trim().to_owned(), weight })
}

impl Overlays {
    /// The weights file, as it was named; empty if there is none.
    pub fn file(&self) -> String {
        self.weights.as_deref().unwrap_or(Path::new("")).display().to_string()
    }

    /// Lays the weights over the tasks of the trials.
    ///
    /// # Errors
    /// A file that cannot be read or does not fit the project's tasks, or a weight that is not allowed.
    pub fn apply(&self, project: &Project, trials: &mut [Trial]) -> Result<(), Error> {
        if let Some(path) = &self.weights {
            let text = FileLoader.load(path)?;
            let (name, mut sources) = (self.file(), SourceMap::default());
            let origin = Origin::Overlay(name.clone());
            let laid = Overlay::read(&name, &text, &mut sources)
                .and_then(|overlay| overlay.apply(&project.compilation.tasks, &origin))
                .map_err(|problems| Error::rendered(&Report::new(sources, problems)))?;
            for trial in &mut *trials {
                if let Some(task) = laid.iter().find(|task| task.name == trial.task.name) {
                    trial.task = task.clone();
                }
            }
        }
        self.wish(trials)
    }

    /// Lays the weights of the command line over the tasks of the trials, and the file's under them, to be read anew again and
    /// again.
    ///
    /// # Errors
    /// Those of [`apply`](Self::apply).
    pub fn live(&self, project: &Project, trials: &mut [Trial]) -> Result<Live, Error> {
        self.wish(trials)?;
        // The file may name tasks that are not run.
        let run = |name: &str| trials.iter().find(|trial| trial.task.name == name).map(|trial| trial.task.clone());
        let tasks = project.compilation.tasks.iter().map(|task| run(&task.name).unwrap_or_else(|| task.clone())).collect();
        let path = self.weights.as_deref().unwrap_or(Path::new(""));
        let notify = |message: &str| {
            // Nothing is left to be done when standard error itself cannot be written.
            let _ = writeln!(terminal::notes(), "{message}");
        };
        Live::open(path, tasks, notify).map_err(|error| match error {
            LiveError::Refused(report) => Error::rendered(&report),
            error => error.into(),
        })
    }

    fn wish(&self, trials: &mut [Trial]) -> Result<(), Error> {
        let tasks: Vec<_> = trials.iter().map(|trial| trial.task.clone()).collect();
        let laid = wished(&tasks, &self.weight, &Origin::CommandLine).context(|| "these weights cannot be set".into())?;
        for (trial, task) in trials.iter_mut().zip(laid.tasks) {
            trial.task = task;
        }
        Ok(())
    }
}
