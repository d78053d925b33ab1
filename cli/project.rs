//! Files of tasks, compiled: shared by all subcommands that take one.

use crate::error::{Context, Error};
use crate::terminal;
use msk::compiler::compile::Setting;
use msk::compiler::diagnostics::{Levels, Report};
use msk::compiler::task::CompiledTask;
use msk::compiler::{Compilation, compile_with};
use msk::evaluate::Trial;
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::path::Path;
use std::sync::Arc;

/// The suite at the root of a project.
pub const SUITE: &str = "tasks.msk";

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
    /// All errors of the compiler.
    pub fn open(path: &Path, settings: &[Setting]) -> Result<Self, Error> {
        Self::open_at(path, settings, &Levels::default())
    }

    /// The same with lints at other levels: a warning that is denied is an error.
    ///
    /// # Errors
    /// All errors of the compiler, and warnings that are denied.
    pub fn open_at(path: &Path, settings: &[Setting], levels: &Levels) -> Result<Self, Error> {
        let bodies = BodyLibrary::default();
        let compilation = compile_with(path, &FileLoader, &bodies, settings).map_err(|report| Error::rendered(&report))?;
        let mut warnings = Report::new(compilation.sources.clone(), compilation.warnings.clone());
        levels.apply(&mut warnings.diagnostics);
        if warnings.has_errors() {
            return Err(Error::rendered(&warnings));
        }
        terminal::notes().diagnostics(&terminal::rendered(&warnings))?;
        Ok(Self { compilation, bodies })
    }

    /// Finds one task: `name` is a task of the suite in `tasks.msk`, a file with a single task, or FILE@TASK.
    ///
    /// # Errors
    /// No such task or file, or errors in it.
    pub fn find(name: &str, settings: &[Setting]) -> Result<(Self, Trial), Error> {
        let (project, trials) = Self::select(name, settings)?;
        match <[Trial; 1]>::try_from(trials) {
            Ok([trial]) => Ok((project, trial)),
            Err(trials) => {
                let names: Vec<&str> = trials.iter().map(|trial| trial.task.name.as_str()).collect();
                let message = format!("`{name}` contains {} tasks: {}", names.len(), names.join(", "));
                Err(Error::new(message).hint(format!("select one of them, as in {name}@{}", names[0])))
            }
        }
    }

    /// Finds tasks: `name` is a task of the suite in `tasks.msk`, a file with all its tasks, or FILE@TASK; never none.
    ///
    /// # Errors
    /// No such task or file, or errors in it.
    pub fn select(name: &str, settings: &[Setting]) -> Result<(Self, Vec<Trial>), Error> {
        let (file, only) = named(name)?;
        let project = Self::open(file, settings)?;
        let trials = project.trials(only)?;
        Ok((project, trials))
    }

    /// The tasks to run, bound to their bodies: the one that is called `only`, else those of the suites in their order, else
    /// all tasks of the file.
    ///
    /// # Errors
    /// No such task, no task at all, or a body that cannot be bound.
    pub fn trials(&self, only: Option<&str>) -> Result<Vec<Trial>, Error> {
        let trial = |task: &Arc<CompiledTask>| {
            let body =
                self.bodies.stage(&task.body, &task.scene).context(|| format!("task `{}` has no body to run on", task.name))?;
            Ok(Trial::new(task.clone(), body))
        };
        chosen(&self.compilation, only)?.into_iter().map(trial).collect()
    }
}

/// Which file a name on the command line means, and which of its tasks.
pub fn named(name: &str) -> Result<(&Path, Option<&str>), Error> {
    if let Some((file, task)) = name.rsplit_once('@').filter(|(file, _)| file.ends_with(".msk")) {
        return Ok((Path::new(file), Some(task)));
    }
    if name.ends_with(".msk") || name.contains(std::path::MAIN_SEPARATOR) {
        return Ok((Path::new(name), None));
    }
    if !Path::new(SUITE).exists() {
        let message = format!("there is no `{SUITE}` here to look up the task `{name}`");
        return Err(Error::new(message).hint("change to its folder, or give the path of the task's file"));
    }
    Ok((Path::new(SUITE), Some(name)))
}

/// The tasks that a name on the command line means, compiled and not bound to a body; warnings are not printed.
///
/// # Errors
/// No such task or file, or errors in it.
pub fn compiled(name: &str, settings: &[Setting]) -> Result<Vec<Arc<CompiledTask>>, Error> {
    let (file, only) = named(name)?;
    let compilation =
        compile_with(file, &FileLoader, &BodyLibrary::default(), settings).map_err(|report| Error::rendered(&report))?;
    Ok(chosen(&compilation, only)?.into_iter().cloned().collect())
}

/// The task that is called `only`, else those of the suites in their order, else all tasks of the file.
fn chosen<'a>(compilation: &'a Compilation, only: Option<&str>) -> Result<Vec<&'a Arc<CompiledTask>>, Error> {
    let tasks = &compilation.tasks;
    if tasks.is_empty() {
        return Err(Error::new("the file contains no task").hint("a task begins with `task NAME {`"));
    }
    let Some(name) = only else { return Ok(compilation.members()) };
    let found = tasks.iter().find(|task| task.name == name).ok_or_else(|| {
        let known: Vec<&str> = tasks.iter().map(|task| task.name.as_str()).collect();
        Error::new(format!("there is no task `{name}`")).hint(format!("there are: {}", known.join(", ")))
    })?;
    Ok(vec![found])
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
