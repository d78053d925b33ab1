//! What a test expects.

use super::reset::statistic_of;
use super::{Draft, Found, Reader, Wanted, over_resets};
use crate::check::context::{Checked, Checker, Failures};
use crate::check::observe::{ObservedChannel, spoken_unit, unit_of};
use crate::check::types::ElementType;
use crate::check::value::TypedValue;
use crate::diagnostics::{codes, nearest};
use crate::resolve::{Texts, written};
use crate::syntax::tree::{BinaryOperator, Expr, ExprKind, Ident, Test};
use crate::testing::{Check, Expectation, Probe, Reading, Side};
use std::collections::BTreeSet;

impl<'a> Checker<'a> {
    /// Checks the expectations of a test; a cheat expects at least that it does not succeed. What a phase of a sequence cannot
    /// say is kept, for another may.
    pub(super) fn expectations(
        &mut self,
        test: &'a Test,
        reader: &Reader<'a>,
        probes: &mut Vec<ObservedChannel>,
        texts: &dyn Texts,
    ) -> Checked<Vec<Found>> {
        let mut found: Vec<Found> = Vec::new();
        let mut failures = Failures::default();
        if test.cheat
            && let Some(success) = self.test_name("success")
        {
            let node = self.graph.unary(crate::graph::operation::Unary::Not, success.node);
            let probe = self.probe(&TypedValue::new(node, ElementType::Bool), test.title.span, probes);
            found.push(Ok(vec![Expectation {
                source: "not success".to_owned(),
                at: (self.place.file, test.title.span),
                check: Check::Holds { probe, reading: Reading { take: 0, step: None } },
            }]));
        }
        for wanted in &reader.wanted {
            if test.cheat && matches!(&wanted.condition.kind, ExprKind::Name(name) if name.text == "success") {
                let message = "a cheat expects that the task does not succeed";
                let diagnostic = self.diagnostic(codes::tests::TEST_PLACE, wanted.span, message);
                failures.add(self.report(diagnostic.help("use `test` for a script that succeeds")));
                continue;
            }
            let locals = std::mem::replace(&mut self.locals, wanted.locals.clone());
            let before = self.diagnostics.len();
            let mut parts = Vec::new();
            match self.expectation(wanted, &reader.drafts, probes, texts, &mut parts) {
                Ok(()) => found.push(Ok(parts)),
                Err(reported) if self.in_sequence() => found.push(Err((reported, self.diagnostics.split_off(before)))),
                Err(reported) => failures.add(reported),
            }
            self.locals = locals;
        }
        failures.or(found)
    }

    fn expectation(
        &mut self,
        wanted: &Wanted<'a>,
        drafts: &[Draft],
        probes: &mut Vec<ObservedChannel>,
        texts: &dyn Texts,
        found: &mut Vec<Expectation>,
    ) -> Checked<()> {
        let condition = self.single_condition(wanted.condition)?;
        let reading = self.reading(wanted.moment, drafts)?;
        let at = (self.place.file, wanted.span);
        let mut parts = Vec::new();
        conjuncts(wanted.condition, &mut parts);
        let several = parts.len() > 1;
        for part in parts {
            let source = written(part, self.place.file, texts);
            let check = match self.order(part, reading, drafts, probes, texts)? {
                Some(order) => order,
                None => {
                    let data = if several { self.single_condition(part)? } else { condition.clone() };
                    Check::Holds { probe: self.probe(&data, part.span, probes), reading }
                }
            };
            found.push(Expectation { source, at, check });
        }
        Ok(())
    }

    /// A comparison of single numbers, both of whose sides can be printed.
    fn order(
        &mut self,
        part: &'a Expr,
        reading: Reading,
        drafts: &[Draft],
        probes: &mut Vec<ObservedChannel>,
        texts: &dyn Texts,
    ) -> Checked<Option<Check>> {
        let ExprKind::Compare { operands, operators } = &part.kind else { return Ok(None) };
        let mut sides = Vec::new();
        let mut single = true;
        for operand in operands {
            let data = self.data(operand)?;
            single &= data.kind.length().is_none();
            let (reading, statistic) = match &operand.kind {
                ExprKind::At { pose, .. } => (self.reading(Some(pose), drafts)?, None),
                ExprKind::Call { function, arguments } => match over_resets(arguments) {
                    Some((_, moment)) => (self.reading(Some(moment), drafts)?, statistic_of(function)),
                    None => (reading, None),
                },
                _ => (reading, None),
            };
            sides.push((data, reading, statistic, operand));
        }
        let moments = operands.iter().find(|operand| match &operand.kind {
            ExprKind::At { .. } => true,
            ExprKind::Call { arguments, .. } => over_resets(arguments).is_some(),
            _ => false,
        });
        if !single {
            return match moments {
                Some(moment) => {
                    let message = "moments are compared by single numbers";
                    Err(self.error(codes::types::WRONG_TYPE, moment.span, message))
                }
                None => Ok(None),
            };
        }
        let of_each =
            sides.iter().filter(|(data, _, statistic, _)| statistic.is_none() && self.graph.constant_lanes(data.node).is_none());
        let several = of_each.filter(|(_, reading, ..)| drafts[reading.take].resets.is_some_and(|resets| resets > 1));
        let takes: BTreeSet<usize> = several.map(|(_, reading, ..)| reading.take).collect();
        if takes.len() > 1 {
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, part.span, "episodes of different moments are independent")
                .help("compare aggregates: `mean(x at one) < mean(x at other)`");
            return Err(self.report(diagnostic));
        }
        let mut shown = Vec::new();
        for (data, reading, statistic, operand) in sides {
            let unit = spoken_unit(&data.kind, operands);
            let constant = self.graph.constant_lanes(data.node).is_some();
            shown.push(Side {
                source: written(operand, self.place.file, texts),
                unit,
                probe: self.probe(&data, operand.span, probes),
                reading,
                statistic,
                constant,
            });
        }
        let comparisons = operators.iter().map(|(operator, _)| *operator).collect();
        Ok(Some(Check::Order { sides: shown, comparisons }))
    }

    /// Has a number reported at every step; gives its place.
    fn probe(&mut self, data: &TypedValue, span: crate::diagnostics::Span, probes: &mut Vec<ObservedChannel>) -> Probe {
        if let Some(known) = probes.iter().position(|known| known.node == data.node) {
            return vec![Some(known)];
        }
        let name = format!("test {}", probes.len());
        let (unit, source, docs, block) = (unit_of(&data.kind), String::new(), String::new(), String::new());
        // A probe is never printed, so its formula does not matter.
        let formula = Expr { kind: ExprKind::Bool(true), span };
        probes.push(ObservedChannel {
            critic: false,
            noise: Vec::new(),
            past: 0,
            name,
            node: data.node,
            data: data.clone(),
            unit,
            source,
            formula,
            docs,
            block,
            settings: String::new(),
            file: self.place.file,
            span,
        });
        vec![Some(probes.len() - 1)]
    }

    /// Where a moment is.
    fn reading(&mut self, moment: Option<&'a Ident>, drafts: &[Draft]) -> Checked<Reading> {
        let Some(moment) = moment else { return Ok(Reading { take: 0, step: None }) };
        for (take, draft) in drafts.iter().enumerate() {
            if draft.name.as_ref() == Some(&moment.text) {
                return Ok(Reading { take, step: None });
            }
            if let Some((_, step)) = draft.labels.iter().find(|(name, _)| *name == moment.text) {
                return Ok(Reading { take, step: Some(*step) });
            }
        }
        let message = format!("undefined moment `{}`", moment.text);
        let mut diagnostic = self.diagnostic(codes::tests::UNKNOWN_MOMENT, moment.span, message);
        let names = drafts.iter().flat_map(|draft| draft.name.iter().chain(draft.labels.iter().map(|(name, _)| name)));
        let names: Vec<&str> = names.map(String::as_str).collect();
        for near in nearest(&moment.text, names) {
            diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), moment.span, near);
        }
        let help = "name it in the script, `at 1 s pose squatting as low`, or declare it: `moment low { pose squatting }`";
        Err(self.report(diagnostic.help(help)))
    }
}

/// The conditions that all must hold.
fn conjuncts<'a>(expr: &'a Expr, parts: &mut Vec<&'a Expr>) {
    match &expr.kind {
        ExprKind::Binary { operator: BinaryOperator::And, left, right, .. } => {
            conjuncts(left, parts);
            conjuncts(right, parts);
        }
        ExprKind::Paren(inner) => conjuncts(inner, parts),
        _ => parts.push(expr),
    }
}

/// Gives takes other numbers.
pub(super) fn renumber(expectations: &mut [Expectation], number: impl Fn(usize) -> usize) {
    for expectation in expectations {
        match &mut expectation.check {
            Check::Holds { reading, .. } => reading.take = number(reading.take),
            Check::Order { sides, .. } => sides.iter_mut().for_each(|side| side.reading.take = number(side.reading.take)),
        }
    }
}
