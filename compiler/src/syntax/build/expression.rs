//! Expressions but for precedence: literals, names with what is attached to them, lists, conditionals.

use super::{Builder, part, parts};
use crate::diagnostics::{Diagnostic, Reported};
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{Argument, Expr, ExprKind, Text};
use crate::syntax::{MAXIMUM_ERRORS, MAXIMUM_OPERATORS};
use crate::syntax::{recovery, wording};

impl Builder<'_> {
    /// An `expression`, a `chain` or an `if_then_else`.
    pub(super) fn expression(&mut self, pair: Option<Pair<'_>>) -> Expr {
        let Some(pair) = pair else { return self.missing() };
        if self.nesting == 0 {
            self.operators = 0;
        }
        self.nesting += 1;
        let expr = match pair.as_rule() {
            Rule::expression => self.whole_expression(&pair),
            Rule::chain => self.chain(&pair),
            Rule::if_then_else => self.if_then_else(&pair),
            Rule::postfixed => self.postfixed(&pair),
            _ => self.missing(),
        };
        self.nesting -= 1;
        expr
    }

    fn whole_expression(&mut self, pair: &Pair<'_>) -> Expr {
        let span = self.span(pair);
        let mut values = pair.clone().into_inner().filter(|part| matches!(part.as_rule(), Rule::chain | Rule::if_then_else));
        let value = self.expression(values.next());
        match values.next() {
            None => value,
            Some(condition) => {
                let condition = Box::new(self.expression(Some(condition)));
                Expr { kind: ExprKind::When { value: Box::new(value), condition }, span }
            }
        }
    }

    fn if_then_else(&mut self, pair: &Pair<'_>) -> Expr {
        let span = self.span(pair);
        let mut chains: Vec<Expr> = parts(pair, Rule::chain).map(|chain| self.expression(Some(chain))).collect();
        let otherwise = Box::new(chains.pop().unwrap_or_else(|| self.missing()));
        let mut branches = Vec::new();
        let mut chains = chains.into_iter();
        while let (Some(condition), Some(value)) = (chains.next(), chains.next()) {
            branches.push((condition, value));
        }
        self.operators += branches.len();
        Expr { kind: ExprKind::If { branches, otherwise }, span }
    }

    /// An atom and the members, calls and indices that touch it.
    pub(super) fn postfixed(&mut self, pair: &Pair<'_>) -> Expr {
        let mut inner = pair.clone().into_inner();
        let Some(atom) = inner.next() else { return self.missing() };
        let mut expr = self.atom(&atom);
        for suffix in inner {
            self.operators += 1;
            if self.operators > MAXIMUM_OPERATORS {
                return self.too_many_operators(pair);
            }
            let span = expr.span.to(self.span(&suffix));
            let base = Box::new(expr);
            let kind = match suffix.as_rule() {
                Rule::member => ExprKind::Field { base, name: self.name(part(&suffix, Rule::any_name)) },
                Rule::index => ExprKind::Index { base, index: Box::new(self.expression_in(&suffix)) },
                _ => ExprKind::Call { function: base, arguments: self.arguments(&suffix) },
            };
            expr = Expr { kind, span };
        }
        expr
    }

    pub(super) fn too_many_operators(&mut self, pair: &Pair<'_>) -> Expr {
        let span = self.span(pair);
        let diagnostic = wording::too_many_operators(self.file, span, MAXIMUM_OPERATORS);
        // The statement is left at its first excess; what is around it does not report it again.
        let earlier = self.diagnostics.iter().rev().take(MAXIMUM_ERRORS);
        let earlier = Reported::among(earlier.filter(|known| known.code == diagnostic.code && known.span().end >= span.end));
        let reported = earlier.unwrap_or_else(|| self.report(diagnostic));
        Expr { kind: ExprKind::Error(reported), span }
    }

    pub(super) fn atom(&mut self, pair: &Pair<'_>) -> Expr {
        let span = self.span(pair);
        let kind = match pair.as_rule() {
            Rule::quantity => ExprKind::Number(self.quantity(pair)),
            Rule::boolean => ExprKind::Bool(pair.as_str().trim_end() == "true"),
            Rule::name => ExprKind::Name(self.name(Some(pair.clone()))),
            Rule::text => ExprKind::Text(self.text(Some(pair.clone())).value),
            Rule::selector => {
                let pattern: Text = self.text(part(pair, Rule::text));
                ExprKind::Selector { kind: self.identifier_in(pair), pattern }
            }
            Rule::ended_by => ExprKind::EndedBy(self.identifier_in(pair)),
            Rule::round_list => ExprKind::Paren(Box::new(self.expression_in(pair))),
            Rule::square_list => self.list(pair),
            Rule::glued => ExprKind::Error(self.report(wording::glued_number(self.file, span, pair.as_str().trim_end()))),
            Rule::bare_unit => {
                let diagnostic = self.bare_unit(pair);
                ExprKind::Error(self.report(diagnostic))
            }
            _ => self.missing().kind,
        };
        Expr { kind, span }
    }

    /// A unit where a value is wanted: `1/m^2`, `30 /m^2` and `x / 1 m / s` meant it to belong to the number before.
    fn bare_unit(&self, pair: &Pair<'_>) -> Diagnostic {
        let masked = &self.scanned.masked;
        let start = pair.as_span().start();
        let unit = pair.as_str().trim_end();
        let meant = recovery::unit_of_number_before(&masked.text[..start], unit);
        let meant = meant.map(|(from, text)| (masked.span(from, start + unit.len()), text));
        wording::bare_unit(self.file, self.span(pair), unit, meant)
    }

    fn list(&mut self, pair: &Pair<'_>) -> ExprKind {
        let Some(loop_part) = part(pair, Rule::comprehension) else {
            return ExprKind::List(parts(pair, Rule::expression).map(|item| self.expression(Some(item))).collect());
        };
        let element = Box::new(self.expression_in(pair));
        let variable = self.identifier_in(&loop_part);
        let source = Box::new(self.ranged(&loop_part));
        ExprKind::Comprehension { element, variable, source }
    }

    /// One expression, or two with dots between them.
    pub(super) fn ranged(&mut self, pair: &Pair<'_>) -> Expr {
        let mut bounds = parts(pair, Rule::expression);
        let low = self.expression(bounds.next());
        match bounds.next() {
            None => low,
            Some(high) => {
                let high = self.expression(Some(high));
                let span = low.span.to(high.span);
                Expr { kind: ExprKind::Range { low: Box::new(low), high: Box::new(high) }, span }
            }
        }
    }

    fn arguments(&mut self, pair: &Pair<'_>) -> Vec<Argument> {
        parts(pair, Rule::argument)
            .map(|argument| {
                let name = part(&argument, Rule::identifier).map(|name| self.identifier(&name));
                Argument { name, value: self.ranged(&argument) }
            })
            .collect()
    }
}
