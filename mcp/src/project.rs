//! Tasks of the project, compiled.

use crate::confine::{Confined, Outside};
use msk_compiler::diagnostics::SourceMap;
use msk_compiler::files::{LARGEST_FILE, LoadError, Loader};
use msk_compiler::task::{CompiledTask, Origin};
use msk_compiler::{Compilation, compile};
use msk_evaluate::Trial;
use msk_runtime::library::BodyLibrary;
use msk_tuning::overlay::Overlay;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// The suite at the root of a project.
pub const SUITE: &str = "tasks.msk";

/// What went wrong, for an agent: words, and diagnostics where the compiler has them.
#[derive(Debug)]
pub struct Failure(pub Value);

impl<E: std::fmt::Display> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(json!({ "error": error.to_string() }))
    }
}

/// The project with the bodies that are already bound.
pub struct Project {
    pub confined: Confined,
    pub library: BodyLibrary,
}

impl Project {
    /// The project in `root`, whose models are read beneath it, too.
    ///
    /// # Errors
    /// A folder that cannot be used.
    pub fn new(root: &Path) -> Result<Self, Outside> {
        let confined = Confined::new(root)?;
        Ok(Self { library: BodyLibrary::of(confined.clone()), confined })
    }

    /// Compiles a file of the project.
    pub fn compile(&self, file: &str) -> Result<Compilation, Failure> {
        // What cannot be read at all is reported without the frame of a report.
        self.confined.text(Path::new(file), LARGEST_FILE)?;
        self.compile_with(file, &self.confined)
    }

    /// Compiles with another loader: of a text that is no file yet.
    pub fn compile_with(&self, file: &str, loader: &dyn Loader) -> Result<Compilation, Failure> {
        compile(&self.confined.spelled(Path::new(file)), loader, &self.library).map_err(|report| {
            let mut json = report.to_json();
            json["error"] = "the file has errors".into();
            json["rendered"] = report.to_string().into();
            Failure(json)
        })
    }

    /// A task by its name, with a weights file laid over it.
    pub fn task(&self, file: Option<&str>, name: &str, weights: Option<&str>) -> Result<Arc<CompiledTask>, Failure> {
        let compilation = self.compile(file.unwrap_or(SUITE))?;
        let tasks = match weights {
            Some(weights) => self.overlaid(&compilation, weights)?,
            None => compilation.tasks.clone(),
        };
        find(&tasks, name)
    }

    /// All tasks with a weights file laid over them.
    pub fn overlaid(&self, compilation: &Compilation, weights: &str) -> Result<Vec<Arc<CompiledTask>>, Failure> {
        let text = self.confined.load(Path::new(weights))?;
        let mut sources = SourceMap::default();
        let laid = Overlay::read(weights, &text, &mut sources)
            .and_then(|overlay| overlay.apply(&compilation.tasks, &Origin::Overlay(weights.to_owned())));
        laid.map_err(|diagnostics| {
            let report = msk_compiler::diagnostics::Report::new(sources, diagnostics);
            let mut json = report.to_json();
            json["error"] = "the weights file has errors".into();
            json["rendered"] = report.to_string().into();
            Failure(json)
        })
    }

    /// A task on its body.
    pub fn trial(&self, task: Arc<CompiledTask>) -> Result<Trial, Failure> {
        let body = self.library.stage(&task.body, &task.scene)?;
        Ok(Trial::new(task, body))
    }
}

/// The task of that name.
pub fn find(tasks: &[Arc<CompiledTask>], name: &str) -> Result<Arc<CompiledTask>, Failure> {
    tasks.iter().find(|task| task.name == name).cloned().ok_or_else(|| {
        let known: Vec<&str> = tasks.iter().map(|task| task.name.as_str()).collect();
        Failure(json!({ "error": format!("there is no task `{name}`"), "tasks": known }))
    })
}

/// A text that stands for a file, among those of the project.
pub struct Draft<'a> {
    pub name: &'a str,
    pub text: &'a str,
    pub confined: &'a Confined,
}

impl Loader for Draft<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        let spelled = |path: &Path| self.confined.spelled(path);
        if spelled(path) == spelled(Path::new(self.name)) { Ok(self.text.to_owned()) } else { self.confined.load(path) }
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        self.confined.load_bytes(path, limit)
    }
}
