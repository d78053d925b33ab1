//! Suites: families of tasks and protocols.

use super::context::{Checked, Checker, Reported, Settled};
use super::dimension::Dimension;
use crate::diagnostics::{Code, Diagnostic, FileId, Span, codes, nearest};
use crate::resolve::scope::{Names, Place};
use crate::syntax::tree::{self, Expr, ExprKind, FieldValue};
use crate::vocabulary::Vocabulary;
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

/// Checks a suite against the names of all tasks in sight, which are sorted; its numbers may be constants in sight.
pub(crate) fn check<'a>(
    suite: &'a tree::Suite,
    file: FileId,
    names: &'a Names<'a>,
    tasks: &[&str],
    diagnostics: &mut Vec<Diagnostic>,
) -> Suite {
    let nothing = Vocabulary::default();
    let mut checker = Checker::new(&nothing, names, Place { file, in_task: false }, &[]);
    checker.settled = Settled::default();
    let mut reader = Reader { file, checker };
    let families = reader.families(suite, tasks);
    let mut protocols: Vec<Protocol> = Vec::new();
    for protocol in &suite.protocols {
        let repeated = |name: &tree::Ident| protocols.iter().any(|before| before.name == name.text);
        if let Some(name) = protocol.name.as_ref().filter(|name| repeated(name)) {
            reader.error(codes::tasks::REPEATED, name.span, format!("the protocol `{}` is declared twice", name.text));
        }
        protocols.push(reader.protocol(protocol));
    }
    diagnostics.append(&mut reader.checker.diagnostics);
    Suite { name: suite.name.text.clone(), families, protocols }
}

/// Reads a suite.
struct Reader<'a> {
    file: FileId,
    /// Evaluates numbers; it knows no body.
    checker: Checker<'a>,
}

impl<'a> Reader<'a> {
    fn error(&mut self, code: &'static Code, span: Span, message: impl Into<String>) {
        self.checker.error(code, span, message);
    }

    /// A diagnostic of the suite's own file.
    fn diagnostic(&self, code: &'static Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(code, self.file, span, message)
    }

    /// Families with the names of their tasks.
    fn families(&mut self, suite: &tree::Suite, tasks: &[&str]) -> Vec<(String, Vec<String>)> {
        let lists_nothing = suite.families.is_empty().then_some(("suite", &suite.name));
        let empty = suite.families.iter().filter(|family| family.tasks.is_empty()).map(|family| ("family", &family.name));
        for (what, name) in lists_nothing.into_iter().chain(empty) {
            let message = format!("the {what} `{}` lists no task", name.text);
            let diagnostic = self.diagnostic(codes::tasks::MISSING, name.span, message);
            self.checker.report(diagnostic.help("write `family stabilization { stand, walk }`"));
        }
        for task in suite.families.iter().flat_map(|family| &family.tasks) {
            if tasks.binary_search(&task.text.as_str()).is_err() {
                let near = nearest(&task.text, tasks.iter().copied());
                let mut diagnostic =
                    self.diagnostic(codes::names::UNKNOWN_NAME, task.span, format!("undefined task `{}`", task.text));
                if near.is_empty() {
                    diagnostic = diagnostic.help("import it with `use \"...\"`");
                }
                for name in near {
                    diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), task.span, name);
                }
                self.checker.report(diagnostic);
            }
        }
        let members = |family: &tree::Family| family.tasks.iter().map(|task| task.text.clone()).collect();
        suite.families.iter().map(|family| (family.name.text.clone(), members(family))).collect()
    }

    /// Checks the settings of a protocol.
    fn protocol(&mut self, protocol: &'a tree::Protocol) -> Protocol {
        let name = protocol.name.as_ref().map(|name| name.text.clone()).unwrap_or_default();
        let mut checked = Protocol { name, ..Protocol::default() };
        let mut seen = Vec::new();
        for field in &protocol.settings.fields {
            let name = field.name.text.as_str();
            self.once(&mut seen, &field.name, field.span);
            // What is wrong with a number is reported.
            match (name, &field.value) {
                ("episodes", FieldValue::Value(value)) => {
                    self.episodes(value).into_iter().for_each(|number| checked.episodes = number);
                }
                ("seed", FieldValue::Value(value)) => {
                    self.checker.fixed_count(value, "`seed`").into_iter().for_each(|number| checked.seed = number);
                }
                _ => self.no_setting(name, field.span),
            }
        }
        for part in &protocol.settings.parts {
            if part.kind.text == "sweep" && part.name.is_none() && part.on.is_none() {
                self.once(&mut seen, &part.kind, part.span);
                checked.sweep = Some(self.sweep(part));
            } else {
                self.no_setting(&part.kind.text, part.span);
            }
        }
        checked
    }

    fn no_setting(&mut self, name: &str, span: Span) {
        let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, span, format!("a protocol has no `{name}`"));
        self.checker.report(diagnostic.help("it takes `episodes 50`, `seed 0` and `sweep { action [0, 0.1, 0.2] }`"));
    }

    /// Reports what is given for the second time.
    fn once(&mut self, seen: &mut Vec<&'a str>, name: &'a tree::Ident, span: Span) {
        if seen.contains(&name.text.as_str()) {
            self.error(codes::tasks::REPEATED, span, format!("`{}` is given twice", name.text));
        }
        seen.push(&name.text);
    }

    /// Checks along what a protocol sweeps.
    fn sweep(&mut self, element: &'a tree::Element) -> SweepProtocol {
        let mut checked = SweepProtocol { episodes: EPISODES, axes: Vec::new() };
        let mut seen = Vec::new();
        for field in &element.fields {
            let name = field.name.text.as_str();
            self.once(&mut seen, &field.name, field.span);
            match (name, Axis::named(name), &field.value) {
                ("episodes", _, FieldValue::Value(value)) => {
                    self.episodes(value).into_iter().for_each(|number| checked.episodes = number);
                }
                (_, Some(axis), FieldValue::Value(value)) => checked.axes.extend(self.scales(axis, value).map(|own| (axis, own))),
                (_, Some(axis), _) => {
                    let message = format!("`{}` needs its scales", axis.name());
                    let diagnostic = self.diagnostic(codes::tasks::MISSING, field.span, message);
                    self.checker.report(diagnostic.help(example(axis)));
                }
                _ => self.no_axis(name, field.span),
            }
        }
        element.parts.iter().for_each(|part| self.no_axis(&part.kind.text, part.span));
        checked.axes.sort_by_key(|(axis, _)| *axis);
        checked
    }

    fn no_axis(&mut self, name: &str, span: Span) {
        let names = Axis::ALL.map(Axis::name);
        let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, span, format!("a sweep has no `{name}`"));
        let help = match nearest(name, names.into_iter().chain(["episodes"])).first() {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("it takes `episodes 30`, and scales of {}", names.join(", ")),
        };
        self.checker.report(diagnostic.help(help));
    }

    /// The scales of an axis: a list that grows from 0.
    fn scales(&mut self, axis: Axis, value: &'a Expr) -> Checked<Vec<f64>> {
        let ExprKind::List(elements) = &value.kind else {
            let message = format!("expected a list of scales of `{}`", axis.name());
            let diagnostic = self.diagnostic(codes::types::NOT_CONSTANT, value.span, message);
            return Err(self.checker.report(diagnostic.help(example(axis))));
        };
        let wanted_by = format!("a scale of `{}`", axis.name());
        let mut scales: Vec<f64> = Vec::new();
        for element in elements {
            let scale = self.checker.fixed_number(element, Dimension::NONE, &wanted_by)?;
            if let Some(expected) = axis.refuses(scale) {
                let message = format!("a scale of `{}` is {expected}", axis.name());
                return Err(self.checker.error(codes::tasks::OUT_OF_RANGE, element.span, message));
            }
            let grows = scales.last().map_or(scale == 0.0, |before| *before < scale);
            if !grows {
                return Err(self.no_sweep(axis, element.span, "scales begin at 0 and grow"));
            }
            scales.push(scale);
        }
        if scales.len() < 2 {
            return Err(self.no_sweep(axis, value.span, "a sweep needs 0 and at least one scale more"));
        }
        Ok(scales)
    }

    fn no_sweep(&mut self, axis: Axis, span: Span, message: &str) -> Reported {
        let diagnostic = self.diagnostic(codes::tasks::OUT_OF_RANGE, span, message);
        self.checker.report(diagnostic.help(example(axis)))
    }

    /// A number of episodes.
    fn episodes(&mut self, value: &'a Expr) -> Checked<u32> {
        match self.checker.fixed_count(value, "`episodes`")? {
            number @ 1..=1_000_000 => Ok(number as u32),
            _ => Err(self.checker.error(codes::tasks::OUT_OF_RANGE, value.span, "between one and a million episodes")),
        }
    }
}

fn example(axis: Axis) -> String {
    let grid: Vec<String> = axis.grid().iter().map(f64::to_string).collect();
    format!("write `{} [{}]`: {}", axis.name(), grid.join(", "), axis.scale())
}
