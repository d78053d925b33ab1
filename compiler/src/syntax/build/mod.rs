//! Pest's pairs to the syntax tree.
//!
//! The grammar guarantees which parts a statement has; where a part is nevertheless asked for and missing, that is reported and
//! the tree gets an [`ExprKind::Error`] or an empty name rather than a panic.

mod bodies;
mod chain;
mod expression;
mod names;
mod scene;
mod tasks;
mod tests;

use super::grammar::{Pair, Rule};
use super::scanner::Scanned;
use super::tree::{Allow, Binding, Docs, Entry, Expr, ExprKind, File, Function, Item, Observation, Parameter, Remove, Use};
use super::{MAXIMUM_ERRORS, recovery, wording};
use crate::diagnostics::{Diagnostic, FileId, Reported, Span};
use pest::iterators::Pairs;

/// Builds the tree of a file.
pub(super) fn build(file: FileId, scanned: &Scanned, pairs: Pairs<'_, Rule>, diagnostics: &mut Vec<Diagnostic>) -> File {
    let reported = diagnostics.iter().map(Diagnostic::span).collect();
    let docs_used = vec![false; scanned.docs.len()];
    let mut builder = Builder { file, scanned, reported, docs_used, nesting: 0, operators: 0, diagnostics };
    let items = pairs.flat_map(Pair::into_inner).filter_map(|pair| builder.item(pair)).collect();
    let docs = scanned.file_docs.iter().map(|run| Docs { text: run.text.clone(), span: run.span }).reduce(|mut all, run| {
        all.text = format!("{}\n{}", all.text, run.text);
        all.span = all.span.to(run.span);
        all
    });
    builder.report_stray_docs();
    File { file, docs, items }
}

/// What the functions of this module share.
struct Builder<'a> {
    file: FileId,
    scanned: &'a Scanned,
    /// Places of the scanner's errors: junk that holds one needs no second.
    reported: Vec<Span>,
    docs_used: Vec<bool>,
    /// Depth of expressions within expressions.
    nesting: usize,
    /// Operators of the present statement so far.
    operators: usize,
    diagnostics: &'a mut Vec<Diagnostic>,
}

/// The first part of a rule.
fn part<'i>(pair: &Pair<'i>, rule: Rule) -> Option<Pair<'i>> {
    pair.clone().into_inner().find(|part| part.as_rule() == rule)
}

/// All parts of a rule.
fn parts<'i>(pair: &Pair<'i>, rule: Rule) -> impl Iterator<Item = Pair<'i>> {
    pair.clone().into_inner().filter(move |part| part.as_rule() == rule)
}

impl Builder<'_> {
    fn span(&self, pair: &Pair<'_>) -> Span {
        let span = pair.as_span();
        self.scanned.masked.span(span.start(), span.end())
    }

    fn report(&mut self, diagnostic: Diagnostic) -> Reported {
        diagnostic.report(self.diagnostics)
    }

    fn junk(&mut self, pair: &Pair<'_>, context: Rule) {
        let span = self.span(pair);
        self.docs(span);
        if self.diagnostics.len() > MAXIMUM_ERRORS {
            return;
        }
        let known = |reported: &Span| reported.start < span.end.max(span.start + 1) && reported.end >= span.start;
        if !self.reported.iter().any(known) {
            let start = pair.as_span().start();
            let diagnostic = recovery::explain(self.file, &self.scanned.masked, start, pair.as_str(), context);
            self.report(diagnostic);
        }
    }

    /// The documentation directly above a declaration that begins at `start`.
    fn docs(&mut self, declaration: Span) -> Option<Docs> {
        let runs = &self.scanned.docs;
        let start = declaration.start as usize;
        let index = runs.binary_search_by_key(&start, |run| run.above.unwrap_or(run.span.end as usize)).ok()?;
        let run = &runs[index];
        run.above?;
        self.docs_used[index] = true;
        Some(Docs { text: run.text.clone(), span: run.span })
    }

    fn report_stray_docs(&mut self) {
        for (run, used) in self.scanned.docs.iter().zip(&self.docs_used) {
            if !used {
                self.diagnostics.push(wording::stray_docs(self.file, run.span));
            }
        }
    }

    fn item(&mut self, pair: Pair<'_>) -> Option<Item> {
        Some(match pair.as_rule() {
            Rule::use_file => {
                let path = part(&pair, Rule::text);
                Item::Use(Use { path: self.text(path), span: self.span(&pair) })
            }
            Rule::constant => Item::Const(self.binding(&pair)),
            Rule::function => Item::Function(self.function(&pair)),
            Rule::observation => Item::Observation(self.observation(&pair)),
            Rule::task => Item::Task(self.task(&pair)),
            Rule::sequence => Item::Sequence(self.sequence(&pair)),
            Rule::body => Item::Body(self.body(&pair)),
            Rule::suite => Item::Suite(self.suite(&pair)),
            Rule::junk => {
                self.junk(&pair, Rule::one_declaration);
                return None;
            }
            _ => return None,
        })
    }

    fn binding(&mut self, pair: &Pair<'_>) -> Binding {
        let span = self.span(pair);
        Binding {
            docs: self.docs(span),
            name: self.identifier_in(pair),
            annotation: self.annotation(pair),
            value: self.expression_in(pair),
            span,
        }
    }

    fn function(&mut self, pair: &Pair<'_>) -> Function {
        let span = self.span(pair);
        let docs = self.docs(span);
        let list = part(pair, Rule::parameters);
        let parameters = list.iter().flat_map(|list| parts(list, Rule::parameter));
        let parameters = parameters
            .map(|parameter| Parameter { name: self.identifier_in(&parameter), annotation: self.annotation(&parameter) })
            .collect();
        Function {
            docs,
            name: self.identifier_in(pair),
            parameters,
            annotation: self.annotation(pair),
            body: self.expression_in(pair),
            span,
        }
    }

    fn observation(&mut self, pair: &Pair<'_>) -> Observation {
        let span = self.span(pair);
        Observation { docs: self.docs(span), name: self.identifier_in(pair), channels: self.channels(pair), span }
    }

    /// The lines of a block in which an extending task may remove, and lints may be allowed.
    fn entries<T>(&mut self, block: Option<Pair<'_>>, context: Rule, item: impl Fn(&mut Self, &Pair<'_>) -> T) -> Vec<Entry<T>> {
        let mut entries = Vec::new();
        for pair in block.into_iter().flat_map(Pair::into_inner) {
            match pair.as_rule() {
                Rule::remove => entries.push(Entry::Remove(self.remove(&pair))),
                Rule::allow => entries.push(Entry::Allow(self.allow(&pair))),
                Rule::junk => self.junk(&pair, context),
                rule if is_mark(rule) => {}
                _ => entries.push(Entry::Item(item(self, &pair))),
            }
        }
        entries
    }

    fn remove(&mut self, pair: &Pair<'_>) -> Remove {
        Remove { name: self.path_in(pair), span: self.span(pair) }
    }

    fn allow(&mut self, pair: &Pair<'_>) -> Allow {
        let reason = part(pair, Rule::text);
        Allow { lint: self.identifier_in(pair), reason: self.text(reason), span: self.span(pair) }
    }

    fn expression_in(&mut self, pair: &Pair<'_>) -> Expr {
        let value = part(pair, Rule::expression);
        self.expression(value)
    }

    /// In place of an expression that the grammar promises.
    fn missing(&mut self) -> Expr {
        let reported = self.report(wording::missing_expression(self.file));
        Expr { kind: ExprKind::Error(reported), span: Span::default() }
    }
}

/// What stands in a block beside its statements.
fn is_mark(rule: Rule) -> bool {
    matches!(rule, Rule::open_brace | Rule::close_brace | Rule::newline | Rule::semicolon | Rule::comma)
}
