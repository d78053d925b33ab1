//! Texts to tasks.

use crate::guard::detached;
use crate::report::Report;
use crate::task::Task;
use crate::texts::PackageLoader;
use msk_compiler::compile::Setting;
use msk_compiler::diagnostics;
use msk_compiler::{Compilation, compile_with};
use msk_evaluate::{Trial, probe};
use msk_program::files::{Loader, plain};
use msk_program::task::CompiledTask;
use msk_runtime::library::{BodyLibrary, WithText, in_words};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// The bodies of this process: environments of the same task share model and body.
fn bodies() -> &'static BodyLibrary {
    static BODIES: OnceLock<BodyLibrary> = OnceLock::new();
    BODIES.get_or_init(BodyLibrary::default)
}

/// Compiles a file, or `text` in its place, with parameters set: (name, value with its unit).
pub fn compiled(
    path: PathBuf,
    text: Option<String>,
    parameters: Vec<(String, String)>,
) -> Result<Compilation, diagnostics::Report> {
    let settings: Vec<Setting> = parameters.into_iter().map(|(name, value)| Setting { name, value }).collect();
    let path = plain(&path);
    let with_text;
    let loader: &dyn Loader = match text {
        Some(text) => {
            with_text = WithText { path: path.clone(), text, others: &PackageLoader };
            &with_text
        }
        None => &PackageLoader,
    };
    compile_with(&path, loader, bodies(), &settings)
}

/// Compiles the file at `path`, or `text` in its place, and gives the task of that name, or the only one, with its warnings.
#[pyfunction]
#[pyo3(signature = (path, text, task, parameters))]
pub fn compile(
    py: Python<'_>,
    path: PathBuf,
    text: Option<String>,
    task: Option<String>,
    parameters: Vec<(String, String)>,
) -> PyResult<(Task, Report)> {
    let name = path.display().to_string();
    let built = detached(py, move || {
        let Compilation { tasks, warnings, sources, .. } = compiled(path, text, parameters).map_err(Failure::Report)?;
        let chosen = choose(&name, &tasks, task.as_deref()).map_err(Failure::Words)?;
        let body = bodies().stage(&chosen.body, &chosen.scene).map_err(|error| Failure::Words(in_words(&error)))?;
        let task = Task::new(chosen, body).map_err(|error| Failure::Words(in_words(&error)))?;
        Ok((task, Report::of(diagnostics::Report::new(sources, warnings))))
    })?;
    built.map_err(Failure::into_error)
}

/// Why there is no task.
pub enum Failure {
    /// Errors in a text.
    Report(diagnostics::Report),
    /// Others.
    Words(String),
}

impl Failure {
    /// As Python knows it.
    pub fn into_error(self) -> PyErr {
        match self {
            Self::Report(report) => Report::of(report).into_error(),
            Self::Words(text) => PyValueError::new_err(text),
        }
    }
}

/// The tasks of a compilation in the order of its suites, or the one of that name, each on its body.
///
/// # Errors
/// No such task, or a body that does not fit.
pub fn staged(file: &str, compilation: &Compilation, only: Option<&str>) -> Result<Vec<Trial>, Failure> {
    match only {
        Some(_) => Ok(vec![staged_one(file, compilation, only)?]),
        None => compilation.members().into_iter().cloned().map(on_its_body).collect(),
    }
}

/// The task of that name, or the only one, on its body.
///
/// # Errors
/// No such task, several without a name, or a body that does not fit.
pub fn staged_one(file: &str, compilation: &Compilation, name: Option<&str>) -> Result<Trial, Failure> {
    choose(file, &compilation.tasks, name).map_err(Failure::Words).and_then(on_its_body)
}

fn on_its_body(task: Arc<CompiledTask>) -> Result<Trial, Failure> {
    match bodies().stage(&task.body, &task.scene) {
        Ok(body) => Ok(Trial::new(task, body)),
        Err(error) => Err(Failure::Words(in_words(&error))),
    }
}

fn choose(file: &str, tasks: &[Arc<CompiledTask>], name: Option<&str>) -> Result<Arc<CompiledTask>, String> {
    let names = || tasks.iter().map(|task| task.name.as_str()).collect::<Vec<_>>().join(", ");
    match (name, tasks) {
        (Some(name), _) => {
            let found = tasks.iter().find(|task| task.name == name).cloned();
            found.ok_or_else(|| format!("there is no task `{name}` in {file}; there are: {}", names()))
        }
        (None, [task]) => Ok(Arc::clone(task)),
        (None, []) => Err(format!("{file} contains no task; a task begins with `task NAME {{`")),
        (None, _) => Err(format!("{file} contains {} tasks: {}; select one with `task=`", tasks.len(), names())),
    }
}

/// Errors and warnings of the file at `path`, or of `text` in its place. With `probe` tasks without errors are also evaluated in many
/// poses of their body.
#[pyfunction]
#[pyo3(signature = (path, text, parameters, probe))]
pub fn check(
    py: Python<'_>,
    path: PathBuf,
    text: Option<String>,
    parameters: Vec<(String, String)>,
    probe: bool,
) -> PyResult<Report> {
    detached(py, move || {
        Report::of(match compiled(path, text, parameters) {
            Ok(Compilation { tasks, mut warnings, sources, .. }) => {
                if probe {
                    warnings.extend(probe::new_of(&tasks, bodies(), &warnings));
                }
                diagnostics::Report::new(sources, warnings)
            }
            Err(report) => report,
        })
    })
}
