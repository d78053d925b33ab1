//! Files of tasks, compiled: shared by all subcommands that take one.

use crate::error::{Context, Error};
use msk::compiler::compile::Setting;
use msk::compiler::diagnostics::{Report, Style};
use msk::compiler::{Compilation, compile_with};
use msk::runtime::evaluate::Trial;
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::collections::BTreeSet;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

/// The suite at the root of a project.
const SUITE: &str = "tasks.msk";

/// A compiled file and the bodies that its tasks run on.
pub struct Project {
    /// Tasks and suites.
    pub compilation: Compilation,
    /// Where bodies come from.
    pub bodies: BodyLibrary,
}

impl Project {
    /// Compiles `path` with parameters set; warnings go to standard error.
    ///
    /// # Errors
    /// What the compiler says, all of it.
    pub fn open(path: &Path, settings: &[Setting]) -> Result<Self, Error> {
        let bodies = BodyLibrary::default();
        let compilation = compile_with(path, &FileLoader, &bodies, settings)
            .map_err(|report| Error::told(report.render(style(&io::stderr()))))?;
        let warnings = Report::new(compilation.sources.clone(), compilation.warnings.clone());
        write!(io::stderr().lock(), "{}", warnings.render(style(&io::stderr())))?;
        Ok(Self { compilation, bodies })
    }

    /// Finds one task: `name` is a task of the suite in `tasks.msk`, or a file with a single task.
    ///
    /// # Errors
    /// No such task or file, or errors in it.
    pub fn find(name: &str, settings: &[Setting]) -> Result<(Self, Trial), Error> {
        if name.ends_with(".msk") || name.contains(std::path::MAIN_SEPARATOR) {
            let project = Self::open(Path::new(name), settings)?;
            let trials = project.trials(None)?;
            return match <[Trial; 1]>::try_from(trials) {
                Ok([trial]) => Ok((project, trial)),
                Err(trials) => {
                    let names: Vec<&str> = trials.iter().map(|trial| trial.task.name.as_str()).collect();
                    let message = format!("`{name}` holds {} tasks: {}", names.len(), names.join(", "));
                    Err(Error::new(message).hint("give the name of one of them"))
                }
            };
        }
        if !Path::new(SUITE).exists() {
            let message = format!("there is no `{SUITE}` here in which to look for the task `{name}`");
            return Err(Error::new(message).hint("go to the folder that has it, or give the path of the task's file"));
        }
        let project = Self::open(Path::new(SUITE), settings)?;
        let trial = project.trials(Some(name))?.remove(0);
        Ok((project, trial))
    }

    /// The tasks to run, bound to their bodies: the one that is called `only`, else those of the suites in their order, else
    /// all tasks of the file.
    ///
    /// # Errors
    /// No such task, no task at all, or a body that cannot be bound.
    pub fn trials(&self, only: Option<&str>) -> Result<Vec<Trial>, Error> {
        let tasks = &self.compilation.tasks;
        let members: Vec<&str> = match only {
            Some(name) => vec![name],
            None => {
                let families = self.compilation.suites.iter().flat_map(|suite| &suite.families);
                let members: Vec<&str> = families.flat_map(|(_, members)| members).map(String::as_str).collect();
                if members.is_empty() { tasks.iter().map(|task| task.name.as_str()).collect() } else { members }
            }
        };
        // A task that is in two families runs once.
        let mut seen = BTreeSet::new();
        let members: Vec<&str> = members.into_iter().filter(|name| seen.insert(*name)).collect();
        if members.is_empty() {
            return Err(Error::new("the file holds no task").hint("a task begins with `task NAME {`"));
        }
        let trial = |name: &str| {
            let task = tasks.iter().find(|task| task.name == name).ok_or_else(|| {
                let known: Vec<&str> = tasks.iter().map(|task| task.name.as_str()).collect();
                Error::new(format!("there is no task `{name}`")).hint(format!("there are: {}", known.join(", ")))
            })?;
            let body = self.bodies.stage(&task.body, &task.scene).context(|| format!("task `{name}` has no body to run on"))?;
            Ok(Trial { task: task.clone(), body })
        };
        members.into_iter().map(trial).collect()
    }
}

/// Parameters of tasks that are set on the command line.
#[derive(clap::Args)]
pub struct Settings {
    /// Set a parameter of the tasks: `--set speed=1.5` (in the unit in which it is written), `--set speed="1.5 m/s"`,
    /// `--set walk.speed=1.5` for one task only
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub settings: Vec<Setting>,
}

fn setting(text: &str) -> Result<Setting, String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok(Setting { name: name.trim().into(), value: value.trim().into() })
        }
        _ => Err("a parameter is set as NAME=VALUE".into()),
    }
}

/// Colours for people, none for files and pipes.
pub fn style(stream: &impl IsTerminal) -> Style {
    let coloured = stream.is_terminal() && std::env::var_os("NO_COLOR").is_none();
    if coloured { Style::Coloured } else { Style::Plain }
}
