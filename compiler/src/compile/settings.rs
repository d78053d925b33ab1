//! Parameters set from outside: each setting is a little text of its own, so that errors can point into it.

use super::Setting;
use super::units::Unit;
use crate::diagnostics::{Diagnostic, FileId, SourceMap, Span, codes, nearest};
use crate::syntax;
use crate::syntax::tree::{Entry, Expr, Item, TaskParameter, TaskStatement};

/// A setting that could be read.
pub(super) struct ReadSetting {
    /// Whose parameter; any task's if none is named.
    task: Option<String>,
    name: String,
    value: Expr,
    file: FileId,
    span: Span,
}

/// Reads settings; each gets a text `const NAME = VALUE` in `sources`.
pub(super) fn read(settings: &[Setting], sources: &mut SourceMap, diagnostics: &mut Vec<Diagnostic>) -> Vec<ReadSetting> {
    let mut read = Vec::new();
    for setting in settings {
        let (task, name) = match setting.name.rsplit_once('.') {
            Some((task, name)) => (Some(task.trim().to_owned()), name.trim()),
            None => (None, setting.name.trim()),
        };
        let file =
            sources.add(format!("--set {}={}", setting.name, setting.value), format!("const {name} = {}\n", setting.value));
        let parsed = syntax::parse(file, sources.text(file));
        diagnostics.extend(parsed.diagnostics);
        let binding =
            parsed.tree.items.into_iter().find_map(|item| if let Item::Const(binding) = item { Some(binding) } else { None });
        if let Some(binding) = binding {
            read.push(ReadSetting { task, name: binding.name.text, value: binding.value, file, span: binding.name.span });
        } else if !diagnostics.iter().any(|diagnostic| diagnostic.file() == file) {
            let message = "a parameter is set as NAME=VALUE, or TASK.NAME=VALUE";
            diagnostics.push(Diagnostic::new(codes::names::UNKNOWN_NAME, file, Span::default(), message));
        }
    }
    read
}

/// Gives the parameters of all tasks the values that they are set to.
pub(super) fn apply(settings: &[ReadSetting], units: &mut [Unit<'_>], diagnostics: &mut Vec<Diagnostic>) {
    for setting in settings {
        let mut found = false;
        let mut known = Vec::new();
        for unit in units.iter_mut() {
            for (task, parameter) in parameters(unit) {
                let fits = setting.task.as_ref().is_none_or(|wanted| *wanted == task);
                known.push(if setting.task.is_some() {
                    format!("{task}.{}", parameter.name.text)
                } else {
                    parameter.name.text.clone()
                });
                if fits && parameter.name.text == setting.name {
                    parameter.set.push((setting.value.clone(), setting.file));
                    found = true;
                }
            }
        }
        if !found {
            diagnostics.push(unknown(setting, known));
        }
    }
}

/// The parameters of a unit with the names of the tasks that have them.
fn parameters<'u>(unit: &'u mut Unit<'_>) -> impl Iterator<Item = (String, &'u mut TaskParameter)> {
    unit.phases.iter_mut().flat_map(|phase| {
        let task = phase.task.task.name.text.clone();
        let blocks = phase.task.statements.iter_mut().filter_map(|placed| match &mut placed.statement {
            TaskStatement::Params(block) => Some(block),
            _ => None,
        });
        let entries = blocks.flat_map(|block| block.entries.iter_mut());
        entries.filter_map(move |entry| match entry {
            Entry::Item(parameter) => Some((task.clone(), parameter)),
            _ => None,
        })
    })
}

fn unknown(setting: &ReadSetting, mut known: Vec<String>) -> Diagnostic {
    known.sort();
    known.dedup();
    let whole = setting.task.as_ref().map_or(setting.name.clone(), |task| format!("{task}.{}", setting.name));
    let message = format!("no task has a parameter `{whole}`");
    let diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, setting.file, setting.span, message);
    let near = nearest(&whole, known.iter().map(String::as_str));
    match (near.as_slice(), known.as_slice()) {
        ([], []) => diagnostic.help("these tasks have no parameters; declare them in `params { }`"),
        ([], known) => diagnostic.help(format!("there is {}", known.join(", "))),
        (near, _) => diagnostic.help(format!("did you mean `{}`?", near.join("` or `"))),
    }
}
