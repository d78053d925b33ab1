//! Suites: families of tasks and protocols.

use super::constant;
use super::dimension::Dimension;
use crate::diagnostics::nearest;
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::syntax::tree::{self, Expr, ExprKind, Field, FieldValue};
use msk_program::sweep::{Axis, EPISODES, SweepProtocol};

/// Families of tasks and the protocols by which policies are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// Its name.
    pub name: String,
    /// Families with the names of their tasks.
    pub families: Vec<(String, Vec<String>)>,
    /// The ways to evaluate it; the first is the default.
    pub protocols: Vec<Protocol>,
}

/// A protocol of a suite: how many episodes, from which seed, under which perturbations.
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    /// Its name; empty if it has none.
    pub name: String,
    /// Episodes per task.
    pub episodes: u32,
    /// Seed of the first episode.
    pub seed: u64,
    /// Along what it sweeps, if it does.
    pub sweep: Option<SweepProtocol>,
}

impl Default for Protocol {
    fn default() -> Self {
        Self { name: String::new(), episodes: 50, seed: 0, sweep: None }
    }
}

/// Checks a suite against the names of all tasks in sight, which are sorted.
pub(crate) fn check(suite: &tree::Suite, file: FileId, tasks: &[&str], diagnostics: &mut Vec<Diagnostic>) -> Suite {
    let mut checked = Suite { name: suite.name.text.clone(), families: Vec::new(), protocols: Vec::new() };
    let mut empty = |what: &str, name: &tree::Ident| {
        let diagnostic =
            Diagnostic::new(codes::tasks::MISSING, file, name.span, format!("the {what} `{}` lists no task", name.text));
        diagnostics.push(diagnostic.help("write `family stabilization { stand, walk }`"));
    };
    if suite.families.is_empty() {
        empty("suite", &suite.name);
    }
    suite.families.iter().filter(|family| family.tasks.is_empty()).for_each(|family| empty("family", &family.name));
    for family in &suite.families {
        let mut members = Vec::new();
        for task in &family.tasks {
            if tasks.binary_search(&task.text.as_str()).is_err() {
                let near = nearest(&task.text, tasks.iter().copied());
                let message = format!("undefined task `{}`", task.text);
                let mut diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, file, task.span, message);
                if near.is_empty() {
                    diagnostic = diagnostic.help("import it with `use \"...\"`");
                }
                for name in near {
                    diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), task.span, name);
                }
                diagnostics.push(diagnostic);
            }
            members.push(task.text.clone());
        }
        checked.families.push((family.name.text.clone(), members));
    }
    for protocol in &suite.protocols {
        let repeated = |name: &tree::Ident| checked.protocols.iter().any(|before| before.name == name.text);
        if let Some(name) = protocol.name.as_ref().filter(|name| repeated(name)) {
            let message = format!("the protocol `{}` is declared twice", name.text);
            diagnostics.push(Diagnostic::new(codes::tasks::REPEATED, file, name.span, message));
        }
        checked.protocols.push(self::protocol(protocol, file, diagnostics));
    }
    checked
}

/// Checks the settings of a protocol.
fn protocol(protocol: &tree::Protocol, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Protocol {
    let name = protocol.name.as_ref().map(|name| name.text.clone()).unwrap_or_default();
    let mut checked = Protocol { name, ..Protocol::default() };
    let unknown = |name: &str, span| {
        Diagnostic::new(codes::tasks::UNKNOWN_SETTING, file, span, format!("a protocol has no `{name}`"))
            .help("it takes `episodes 50`, `seed 0` and `sweep { action [0, 0.1, 0.2] }`")
    };
    let mut seen = Seen::default();
    for field in &protocol.settings.fields {
        let name = field.name.text.as_str();
        seen.note(&field.name, field.span, file, diagnostics);
        match (name, &field.value) {
            ("episodes", FieldValue::Value(value)) => {
                episodes(value, file, diagnostics).into_iter().for_each(|number| checked.episodes = number);
            }
            ("seed", FieldValue::Value(value)) => match constant::whole(value) {
                Ok(number) => checked.seed = number,
                Err(wrong) => diagnostics.push(Diagnostic::new(wrong.code, file, wrong.span, wrong.message)),
            },
            _ => diagnostics.push(unknown(name, field.span)),
        }
    }
    for part in &protocol.settings.parts {
        if part.kind.text == "sweep" && part.name.is_none() && part.on.is_none() {
            seen.note(&part.kind, part.span, file, diagnostics);
            checked.sweep = Some(sweep(part, file, diagnostics));
        } else {
            diagnostics.push(unknown(&part.kind.text, part.span));
        }
    }
    checked
}

/// Checks along what a protocol sweeps.
fn sweep(element: &tree::Element, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> SweepProtocol {
    let mut checked = SweepProtocol { episodes: EPISODES, axes: Vec::new() };
    let unknown = |name: &str, span| {
        let names = Axis::ALL.map(Axis::name);
        let message = format!("a sweep has no `{name}`");
        let diagnostic = Diagnostic::new(codes::tasks::UNKNOWN_SETTING, file, span, message);
        match nearest(name, names.into_iter().chain(["episodes"])).first() {
            Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
            None => diagnostic.help(format!("it takes `episodes 30`, and scales of {}", names.join(", "))),
        }
    };
    let mut seen = Seen::default();
    for field in &element.fields {
        let name = field.name.text.as_str();
        seen.note(&field.name, field.span, file, diagnostics);
        match (name, Axis::named(name), &field.value) {
            ("episodes", _, FieldValue::Value(value)) => {
                episodes(value, file, diagnostics).into_iter().for_each(|number| checked.episodes = number);
            }
            (_, Some(axis), FieldValue::Value(value)) => match scales(axis, value, file) {
                Ok(scales) => checked.axes.push((axis, scales)),
                Err(wrong) => diagnostics.push(*wrong),
            },
            (_, Some(axis), _) => diagnostics.push(no_scales(axis, field, file)),
            _ => diagnostics.push(unknown(name, field.span)),
        }
    }
    diagnostics.extend(element.parts.iter().map(|part| unknown(&part.kind.text, part.span)));
    checked.axes.sort_by_key(|(axis, _)| *axis);
    checked
}

/// The scales of an axis: a list that grows from 0.
fn scales(axis: Axis, value: &Expr, file: FileId) -> Result<Vec<f64>, Box<Diagnostic>> {
    let out_of_range = |span, message: String| Diagnostic::new(codes::tasks::OUT_OF_RANGE, file, span, message);
    let ExprKind::List(elements) = &value.kind else {
        let message = format!("expected a list of scales of `{}`", axis.name());
        return Err(Box::new(Diagnostic::new(codes::types::NOT_CONSTANT, file, value.span, message).help(example(axis))));
    };
    let mut scales: Vec<f64> = Vec::new();
    for element in elements {
        let scale = constant::of_dimension(element, Dimension::NONE);
        let scale = scale.map_err(|wrong| Box::new(Diagnostic::new(wrong.code, file, wrong.span, wrong.message)))?;
        if let Some(expected) = axis.refuses(scale) {
            return Err(Box::new(out_of_range(element.span, format!("a scale of `{}` is {expected}", axis.name()))));
        }
        let grows = scales.last().map_or(scale == 0.0, |before| *before < scale);
        if !grows {
            return Err(Box::new(out_of_range(element.span, "scales begin at 0 and grow".into()).help(example(axis))));
        }
        scales.push(scale);
    }
    if scales.len() < 2 {
        let wrong = out_of_range(value.span, "a sweep needs 0 and at least one scale more".into());
        return Err(Box::new(wrong.help(example(axis))));
    }
    Ok(scales)
}

fn no_scales(axis: Axis, field: &Field, file: FileId) -> Diagnostic {
    let message = format!("`{}` needs its scales", axis.name());
    Diagnostic::new(codes::tasks::MISSING, file, field.span, message).help(example(axis))
}

fn example(axis: Axis) -> String {
    let grid: Vec<String> = axis.grid().iter().map(f64::to_string).collect();
    format!("write `{} [{}]`: {}", axis.name(), grid.join(", "), axis.scale())
}

/// A number of episodes.
fn episodes(value: &Expr, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Option<u32> {
    match constant::whole(value) {
        Ok(number @ 1..=1_000_000) => return Some(number as u32),
        Ok(_) => {
            let message = "between one and a million episodes";
            diagnostics.push(Diagnostic::new(codes::tasks::OUT_OF_RANGE, file, value.span, message));
        }
        Err(wrong) => diagnostics.push(Diagnostic::new(wrong.code, file, wrong.span, wrong.message)),
    }
    None
}

/// Names that have been given.
#[derive(Default)]
struct Seen<'a>(Vec<&'a str>);

impl<'a> Seen<'a> {
    fn note(&mut self, name: &'a tree::Ident, span: Span, file: FileId, diagnostics: &mut Vec<Diagnostic>) {
        if self.0.contains(&name.text.as_str()) {
            let message = format!("`{}` is given twice", name.text);
            diagnostics.push(Diagnostic::new(codes::tasks::REPEATED, file, span, message));
        }
        self.0.push(&name.text);
    }
}
