//! Functions, constants and blocks of channels that nothing reads. What they are is only checked where they are read; what they
//! name can be looked at without.

use super::functions;
use super::scope::{Definition, FileInSight, Names, Place};
use super::signals::{self, Owner};
use crate::diagnostics::{Diagnostic, FileId, Span, codes, nearest};
use crate::syntax::tree::walk::{Visitor, walk_expression};
use crate::syntax::tree::{Entry, Expr, ExprKind, Function, Item, NamePart, Observation};
use crate::vocabulary::Vocabulary;
use std::collections::BTreeSet;

/// Words that every body and the language know beside signals and functions.
const WORDS: [&str; 10] = ["com", "ground", "robot", "joints", "hinges", "slides", "independent", "muscles", "world", "heading"];

/// Looks at the declarations of the first file in `sight` that are not in `called`: names that mean nothing, and circles. Parts of
/// bodies are only judged where there is a body.
pub(crate) fn check(
    sight: &[FileInSight<'_>],
    called: &BTreeSet<(FileId, String)>,
    bodies: &[&Vocabulary],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let Some(own) = sight.first() else { return };
    let names = Names::collect(sight, None, diagnostics);
    let place = Place { file: own.tree.file, in_task: false };
    for item in &own.tree.items {
        let (name, formulas): (_, Vec<&Expr>) = match item {
            Item::Function(function) => (&function.name, vec![&function.body]),
            Item::Const(binding) => (&binding.name, vec![&binding.value]),
            Item::Observation(observation) => (&observation.name, channels(observation)),
            _ => continue,
        };
        if called.contains(&(own.tree.file, name.text.clone())) {
            continue;
        }
        let parameters = if let Item::Function(function) = item { &function.parameters[..] } else { &[] };
        let locals = parameters.iter().map(|parameter| parameter.name.text.as_str()).collect();
        let mut reader = Reader { names: &names, place, bodies, locals, diagnostics };
        formulas.into_iter().for_each(|formula| reader.expression(formula));
        if let Item::Function(function) = item {
            circle(function, &names, place, diagnostics);
        }
    }
}

fn channels(observation: &Observation) -> Vec<&Expr> {
    let items = observation.channels.iter();
    items.filter_map(|entry| if let Entry::Item(channel) = entry { Some(&channel.value) } else { None }).collect()
}

struct Reader<'a, 'd> {
    names: &'a Names<'a>,
    place: Place,
    bodies: &'a [&'a Vocabulary],
    locals: Vec<&'a str>,
    diagnostics: &'d mut Vec<Diagnostic>,
}

impl<'a> Reader<'a, '_> {
    fn known(&self, name: &str) -> bool {
        let of_body = |body: &&Vocabulary| {
            body.landmarks.iter().any(|part| part.name == name)
                || body.joints.iter().any(|part| part.name == name)
                || body.muscles.iter().any(|part| part.name == name)
                || body.groups.iter().any(|part| part.name == name)
        };
        self.locals.contains(&name)
            || self.names.find(self.place, name).is_some()
            || [Owner::Time, Owner::WholeBody].into_iter().any(|owner| signals::find(owner, name).is_some())
            || WORDS.contains(&name)
            || self.bodies.is_empty()
            || self.bodies.iter().any(of_body)
    }

    fn unknown(&mut self, name: &str, span: Span, message: String) {
        let candidates = self.names.in_sight(self.place).chain(self.locals.iter().copied());
        let functions = functions::FUNCTIONS.iter().chain(functions::OPERATORS).map(|function| function.name);
        let mut diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, self.place.file, span, message);
        for near in nearest(name, candidates.chain(functions)) {
            diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), span, near);
        }
        self.diagnostics.push(diagnostic);
    }
}

impl<'a> Visitor<'a> for Reader<'a, '_> {
    fn expression(&mut self, expression: &'a Expr) {
        match &expression.kind {
            ExprKind::Name(name) => {
                if matches!(name.parts.as_slice(), [NamePart::Literal(_)]) && !self.known(&name.text) {
                    self.unknown(&name.text, name.span, format!("there is nothing called `{}`", name.text));
                }
            }
            ExprKind::Call { function, arguments } => {
                if let ExprKind::Name(name) = &function.kind {
                    let known = functions::find(&name.text).is_some() || self.names.find(self.place, &name.text).is_some();
                    // A heading is a frame, and a distribution a draw: neither stands in a function, but each is a word.
                    if !known && !matches!(name.text.as_str(), "heading" | "uniform" | "normal" | "choice") {
                        self.unknown(&name.text, name.span, format!("there is no function `{}`", name.text));
                    }
                } else {
                    self.expression(function);
                }
                arguments.iter().for_each(|argument| self.expression(&argument.value));
            }
            ExprKind::Comprehension { element, variable, source } => {
                self.expression(source);
                self.locals.push(&variable.text);
                self.expression(element);
                self.locals.pop();
            }
            _ => walk_expression(self, expression),
        }
    }
}

/// Reports a function that calls itself, over whatever others.
fn circle(function: &Function, names: &Names<'_>, place: Place, diagnostics: &mut Vec<Diagnostic>) {
    let mut path: Vec<(String, Span)> = Vec::new();
    let mut seen = BTreeSet::new();
    if let Some(span) = leads_back(function, &function.name.text, names, place, &mut path, &mut seen) {
        let mut circle: Vec<&str> = vec![&function.name.text];
        circle.extend(path.iter().map(|(name, _)| name.as_str()));
        let message = format!("`{}` depends on itself", function.name.text);
        let span = path.first().map_or(span, |(_, first)| *first);
        let diagnostic = Diagnostic::new(codes::names::CYCLE, place.file, span, message)
            .here("this closes the circle")
            .label(place.file, function.name.span, "declared here")
            .help(format!("the circle: {}", circle.join(" -> ")))
            .help("a function cannot call itself: every formula must come to an end");
        diagnostics.push(diagnostic);
    }
}

/// The call by which a function comes back to `wanted`; `path` are the calls on the way.
fn leads_back(
    function: &Function,
    wanted: &str,
    names: &Names<'_>,
    place: Place,
    path: &mut Vec<(String, Span)>,
    seen: &mut BTreeSet<(FileId, String)>,
) -> Option<Span> {
    let mut calls = Calls(Vec::new());
    calls.expression(&function.body);
    for (name, span) in calls.0 {
        let Some((declared, there)) = names.find(place, &name) else { continue };
        let Definition::Function(next) = declared.definition else { continue };
        path.push((name.clone(), span));
        if name == wanted {
            return Some(span);
        }
        // Each function is followed once: the walk ends, however they call each other.
        if seen.insert((declared.file, name)) && leads_back(next, wanted, names, there, path, seen).is_some() {
            return Some(span);
        }
        path.pop();
    }
    None
}

/// The calls of a formula.
struct Calls(Vec<(String, Span)>);

impl<'a> Visitor<'a> for Calls {
    fn expression(&mut self, expression: &'a Expr) {
        if let ExprKind::Call { function, .. } = &expression.kind
            && let ExprKind::Name(name) = &function.kind
        {
            self.0.push((name.text.clone(), expression.span));
        }
        walk_expression(self, expression);
    }
}
