//! Weights files, which lie over compiled tasks.
//!
//! ```toml
//! [stand]         # a task
//! pose = 11.5     # the weight of one of its terms; all others stay as the source has them
//!
//! [rise]
//! sit.pose = 3    # a term of a phase of a sequence
//! ```

mod edit;
mod wish;

pub use edit::{EditError, edited};
pub use wish::{Laid, Wish, WishError, wished};

use msk_compiler::diagnostics::{Diagnostic, FileId, SourceMap, Span, codes, nearest};
use msk_compiler::numbers::for_people;
use msk_compiler::task::{CompiledTask, Origin};
use msk_compiler::weights::{LARGEST, Problem, may_be};
use std::collections::BTreeSet;
use std::sync::Arc;
use toml_edit::{Document, Item, TableLike};

/// A weights file that has been read.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    file: FileId,
    tasks: Vec<(String, Span)>,
    lines: Vec<Line>,
}

/// A weight in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The task.
    pub task: String,
    /// The term.
    pub term: String,
    /// The weight.
    pub weight: f64,
    key: Span,
    value: Span,
}

impl Overlay {
    /// Reads a weights file; it is added to `sources`, and `path` is how messages name it.
    ///
    /// # Errors
    /// All that is wrong with the file itself.
    pub fn read(path: &str, text: &str, sources: &mut SourceMap) -> Result<Self, Vec<Diagnostic>> {
        let file = sources.add(path, text);
        let document = Document::parse(text).map_err(|error| {
            let span = error.span().map_or(Span::default(), |span| Span::new(span.start, span.end));
            let message = error.message().lines().next().unwrap_or("this is not TOML").trim().to_owned();
            let diagnostic = Diagnostic::new(codes::weights::WEIGHTS_FILE, file, span, message);
            vec![diagnostic.help("a weights file contains a table for each task: `[stand]`, then `pose = 11.5`")]
        })?;
        let mut reader = Reader {
            file,
            overlay: Self { file, tasks: Vec::new(), lines: Vec::new() },
            given: BTreeSet::new(),
            diagnostics: Vec::new(),
        };
        for (task, _) in document.as_table().iter() {
            let Some((key, item)) = document.as_table().get_key_value(task) else { continue };
            reader.task(task, span(key.span()), item);
        }
        if reader.diagnostics.is_empty() { Ok(reader.overlay) } else { Err(reader.diagnostics) }
    }

    /// The weights, in the order of the file.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// The tasks with the weights of this file laid over them, in their order. A task that the file does not name stays, and so
    /// does a weight from the command line.
    ///
    /// # Errors
    /// Everything that does not fit the tasks, or that they do not allow.
    pub fn apply(&self, tasks: &[Arc<CompiledTask>], origin: &Origin) -> Result<Vec<Arc<CompiledTask>>, Vec<Diagnostic>> {
        let mut diagnostics = Vec::new();
        for (name, at) in &self.tasks {
            if tasks.iter().all(|task| task.name != *name) {
                diagnostics.push(self.unknown_task(name, *at, tasks));
            }
        }
        let mut laid = Vec::new();
        for task in tasks {
            let mut weights = Vec::new();
            for line in self.lines.iter().filter(|line| line.task == task.name) {
                match task.find_term(&line.term).and_then(|term| task.check_weight(term, line.weight).map(|()| term)) {
                    Ok(term) if task.terms[term].origin == Origin::CommandLine => {}
                    Ok(term) => weights.push((term, line.weight)),
                    Err(problem) => diagnostics.push(self.problem(line, problem, task)),
                }
            }
            // Refused weights were reported above, one by one.
            laid.push(match task.reweighted(&weights, origin) {
                Ok(changed) if !weights.is_empty() => Arc::new(changed),
                _ => task.clone(),
            });
        }
        if diagnostics.is_empty() { Ok(laid) } else { Err(diagnostics) }
    }

    fn unknown_task(&self, name: &str, at: Span, tasks: &[Arc<CompiledTask>]) -> Diagnostic {
        let known: Vec<&str> = tasks.iter().map(|task| task.name.as_str()).collect();
        let mut diagnostic = Diagnostic::new(codes::weights::WEIGHTS_TASK, self.file, at, format!("there is no task `{name}`"));
        for near in nearest(name, known.iter().copied()) {
            diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), at, near);
        }
        diagnostic.help(format!("there are: {}", known.join(", ")))
    }

    fn problem(&self, line: &Line, problem: Problem, task: &CompiledTask) -> Diagnostic {
        match problem {
            Problem::Unknown { nearest, .. } => {
                let message = format!("task `{}` has no term `{}`", line.task, line.term);
                let mut diagnostic = Diagnostic::new(codes::weights::WEIGHTS_TERM, self.file, line.key, message);
                for near in nearest {
                    diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), line.key, near);
                }
                let terms: Vec<&str> = task.terms.iter().map(|term| term.name.as_str()).collect();
                diagnostic.help(format!("its terms are: {}", terms.join(", ")))
            }
            problem => Diagnostic::new(codes::weights::WEIGHT_REFUSED, self.file, line.value, problem.to_string()),
        }
    }
}

struct Reader {
    file: FileId,
    overlay: Overlay,
    /// Tasks and terms that have a line.
    given: BTreeSet<(String, String)>,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    fn task(&mut self, name: &str, at: Span, item: &Item) {
        let Some(table) = item.as_table_like() else {
            let message = format!("`{name}` is outside of any task");
            let diagnostic = Diagnostic::new(codes::weights::NO_WEIGHT, self.file, at, message);
            self.diagnostics
                .push(diagnostic.help(format!("write the name of its task above it: `[stand]`, then `{name} = ...`")));
            return;
        };
        self.overlay.tasks.push((name.to_owned(), at));
        self.terms(name, "", table);
    }

    /// The weights of a table; tables in it are the phases of a sequence.
    fn terms(&mut self, task: &str, before: &str, table: &dyn TableLike) {
        for (name, _) in table.iter() {
            let Some((key, item)) = table.get_key_value(name) else { continue };
            let (term, key) = (format!("{before}{name}"), span(key.span()));
            if let Some(inner) = item.as_table_like().filter(|_| before.is_empty()) {
                self.terms(task, &format!("{term}."), inner);
                continue;
            }
            let value = span(item.span());
            let number = item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
            let wrong = match number {
                Some(weight) if !may_be(weight) => {
                    let most = for_people(LARGEST);
                    Some(format!("the weight of `{term}` must be a number from -{most} to {most}"))
                }
                None => Some(format!("the weight of `{term}` must be a number, not {}", kind(item))),
                Some(_) if !self.given.insert((task.to_owned(), term.clone())) => Some(format!("`{term}` is given twice")),
                Some(weight) => {
                    self.overlay.lines.push(Line { task: task.to_owned(), term, weight, key, value });
                    None
                }
            };
            self.diagnostics.extend(wrong.map(|message| Diagnostic::new(codes::weights::NO_WEIGHT, self.file, value, message)));
        }
    }
}

fn kind(item: &Item) -> &'static str {
    match item.type_name() {
        "string" => "a text",
        "boolean" => "a truth value",
        "datetime" => "a date",
        "array" | "array of tables" => "a list",
        _ => "a table",
    }
}

fn span(range: Option<std::ops::Range<usize>>) -> Span {
    range.map_or(Span::default(), |range| Span::new(range.start, range.end))
}
