//! Reward terms: weights, bounds, and formulas that must be plain numbers.

use super::context::{Checked, Checker, Failures};
use super::dimension::Dimension;
use super::functions::divide_by;
use super::types::{ElementType, Type};
use super::value::TypedValue;
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::graph::operation::Binary;
use crate::graph::{NodeId, events};
use crate::hir::{ExprId, Resolution};
use crate::numbers::{distinguished, exact, for_people};
use crate::syntax::tree::{Bounds, Docs, Expr, Reward, TaskStatement, Term};
use crate::weights::{LARGEST, Schedule, may_be};

/// A term that the graph computes.
#[derive(Debug, Clone)]
pub(crate) struct RewardTerm<'a> {
    pub name: String,
    /// At the end of a training.
    pub weight: f64,
    pub schedule: Option<Schedule>,
    /// Where the weight stands, which may be in another file than the formula.
    pub weight_at: (FileId, Span),
    pub range: Option<[f64; 2]>,
    pub fixed: bool,
    pub formula: &'a Expr,
    /// The same in the typed HIR.
    pub expr: ExprId,
    /// Documentation.
    pub docs: Option<&'a Docs>,
    /// In which file.
    pub file: FileId,
    /// Whether it is multiplied by the control step.
    pub per_second: bool,
    pub node: NodeId,
    /// Whether it counts 0 or 1.
    pub condition: bool,
}

impl<'a> Checker<'a> {
    /// All `reward` blocks, in order.
    pub(super) fn rewards(&mut self) -> Checked<Vec<RewardTerm<'a>>> {
        let statements = self.statements;
        let mut terms = Vec::new();
        let mut failures = Failures::default();
        for placed in statements {
            if let TaskStatement::Reward(reward) = &placed.statement {
                failures.catch(self.in_file(placed.file, |checker| checker.reward(reward, &mut terms)));
            }
        }
        failures.or(terms)
    }

    /// Checks the terms of a reward block.
    pub(crate) fn reward(&mut self, reward: &'a Reward, terms: &mut Vec<RewardTerm<'a>>) -> Checked<()> {
        let mut failures = Failures::default();
        for entry in &reward.terms {
            let Some(term) = self.plain_entry(entry, "term") else { continue };
            if terms.iter().any(|known| known.name == term.name.text) {
                let message = format!("the term `{}` is declared twice", term.name.text);
                failures.add(self.error(codes::tasks::LABEL_TWICE, term.name.span, message));
            }
            match self.term(term, reward.per_second) {
                Ok(checked) => terms.push(checked),
                Err(reported) => failures.add(reported),
            }
        }
        failures.or(())
    }

    fn term(&mut self, term: &'a Term, per_second: bool) -> Checked<RewardTerm<'a>> {
        let weight = self.weight(term);
        let Some(formula) = &term.formula else {
            let message = format!("the term `{}` has no formula", term.name.text);
            let diagnostic = self
                .diagnostic(codes::tasks::MISSING, term.span, message)
                .help("only a task that extends another can omit the formula");
            return Err(self.report(diagnostic));
        };
        let expr = self.hir.next();
        let data = self.data(formula).and_then(|data| self.must_be_payable(data, formula, &term.name.text));
        let schedule = self.schedule(term);
        let ((weight, range, fixed), schedule, mut data) = (weight?, schedule?, data?);
        if let Some(value) = self.graph.constant_value(data.node).filter(|value| !value.is_finite()) {
            let message = format!("the term `{}` is {} in every state", term.name.text, for_people(value));
            let diagnostic = self.diagnostic(codes::tasks::NOT_FINITE, formula.span, message);
            return Err(self.report(diagnostic.help("every episode would end in a fault at its first step")));
        }
        if per_second {
            self.must_be_a_rate(formula, expr, data.node, &term.name.text)?;
            let interval = self.graph.constant(self.timing.interval);
            data = TypedValue::new(self.graph.binary(Binary::Multiply, data.node, interval), ElementType::PLAIN);
        }
        Ok(RewardTerm {
            name: term.name.text.clone(),
            weight,
            schedule,
            weight_at: term.weight.as_ref().map_or((self.place.file, term.name.span), |weight| (weight.file, weight.span)),
            range,
            fixed,
            formula,
            expr,
            docs: term.docs.as_ref(),
            file: self.place.file,
            per_second,
            node: data.node,
            condition: data.kind == Type::One(ElementType::Bool),
        })
    }

    /// A term that counts once would contribute a fraction as a rate: `once` does not go with `reward per second`.
    fn must_be_a_rate(&mut self, formula: &Expr, expr: ExprId, node: NodeId, name: &str) -> Checked<()> {
        if events::single_event(&self.graph, node).is_none() {
            return Ok(());
        }
        let event = self.single_event(expr);
        let own = formula.span;
        let within = |(file, span): (FileId, Span)| file == self.place.file && own.start <= span.start && span.end <= own.end;
        let (here, span) = match event {
            Some((word, place)) if within(place) => (format!("`{word}` holds at one step"), place.1),
            Some((word, _)) => (format!("a name in this formula uses `{word}`, which holds at one step"), formula.span),
            None => {
                ("a name in this formula uses `once`, `rising` or `falling`, which holds at one step".to_owned(), formula.span)
            }
        };
        let message = format!("the term `{name}` rewards a single step, but `reward per second` rewards time");
        let diagnostic = self.diagnostic(codes::composition::ONCE_PER_SECOND, span, message).here(here);
        let diagnostic = match event.filter(|(_, place)| !within(*place)) {
            Some((word, (file, span))) => diagnostic.label(file, span, format!("`{word}` is used here")),
            None => diagnostic,
        };
        Err(self.report(diagnostic.help("move the term into `reward { }`, which is per control step")))
    }

    /// The first call of what holds at one step only, in a formula or behind its names and functions.
    fn single_event(&self, formula: ExprId) -> Option<(&'static str, (FileId, Span))> {
        const EVENTS: [&str; 3] = ["once", "rising", "falling"];
        let read = self.hir.read_by(formula);
        let mut calls = read.into_iter().map(|id| self.hir.expr(id)).filter_map(|expr| match expr.name {
            Some((_, Resolution::Function(name))) => Some((name, (expr.file, expr.span))),
            _ => None,
        });
        calls.find(|(name, _)| EVENTS.contains(name))
    }

    fn weight(&mut self, term: &Term) -> Checked<(f64, Option<[f64; 2]>, bool)> {
        let Some(weight) = &term.weight else {
            let message = format!("the term `{}` has no weight", term.name.text);
            let diagnostic =
                self.diagnostic(codes::tasks::MISSING, term.name.span, message).help("the weight comes first: `10 pose = ...`");
            return Err(self.report(diagnostic));
        };
        let ends = if let Bounds::Range { low, high, .. } = weight.bounds { [low, high] } else { [weight.value; 2] };
        if ![weight.value, ends[0], ends[1]].into_iter().all(may_be) {
            let message = format!("the weight of `{}` is too large", term.name.text);
            let diagnostic = Diagnostic::new(codes::tasks::WEIGHT, weight.file, weight.span, message);
            let most = for_people(LARGEST);
            return Err(self.report(diagnostic.expected(format!("a number from -{most} to {most}, and a range within them"))));
        }
        match weight.bounds {
            Bounds::Free => Ok((weight.value, None, false)),
            Bounds::Fixed(_) => Ok((weight.value, None, true)),
            Bounds::Range { low, high, span } => {
                if low <= weight.value && weight.value <= high {
                    return Ok((weight.value, Some([low, high]), false));
                }
                if low > high {
                    let message = format!("the range of `{}` is empty: its lower end is above its upper end", term.name.text);
                    let diagnostic = Diagnostic::new(codes::tasks::WEIGHT, weight.file, span, message);
                    let swapped = format!("({}..{})", exact(high), exact(low));
                    return Err(self.report(diagnostic.suggest(format!("write `{swapped}`"), span, swapped)));
                }
                let message = format!("the weight of `{}` is outside of its range", term.name.text);
                let shown = distinguished(&[low, high, weight.value]);
                let diagnostic = Diagnostic::new(codes::tasks::WEIGHT, weight.file, weight.span, message)
                    .expected(format!("{} .. {}", shown[0], shown[1]))
                    .found(&*shown[2])
                    .label(weight.file, span, "the range");
                Err(self.report(diagnostic))
            }
        }
    }

    /// How the weight of a term changes during a training.
    fn schedule(&mut self, term: &'a Term) -> Checked<Option<Schedule>> {
        let Some(weight) = &term.weight else { return Ok(None) };
        let Some(schedule) = &weight.schedule else { return Ok(None) };
        let wrong = |at, message: &str| Diagnostic::new(codes::tasks::SCHEDULE, weight.file, at, message);
        if !may_be(schedule.from) {
            let most = for_people(LARGEST);
            let diagnostic = wrong(schedule.from_span, "the first weight is too large");
            return Err(self.report(diagnostic.expected(format!("a number from -{most} to {most}"))));
        }
        match weight.bounds {
            Bounds::Range { low, high, span } if !(low..=high).contains(&schedule.from) => {
                let shown = distinguished(&[low, high, schedule.from]);
                let diagnostic = wrong(schedule.from_span, "the first weight is outside of the range of the term");
                let diagnostic = diagnostic.expected(format!("{} .. {}", shown[0], shown[1])).found(&*shown[2]);
                return Err(self.report(diagnostic.label(weight.file, span, "the range")));
            }
            Bounds::Free | Bounds::Fixed(_) if schedule.from * weight.value < 0.0 => {
                let diagnostic = wrong(schedule.from_span, "the weight changes its sign: a reward becomes a cost");
                let diagnostic = diagnostic.expected("two weights of one sign").found(format!(
                    "{} and {}",
                    for_people(schedule.from),
                    for_people(weight.value)
                ));
                return Err(
                    self.report(diagnostic.help("give it a range that has both, if that is meant: `1 -> -1 over 30 % (-1..1)`"))
                );
            }
            _ => {}
        }
        let begin = schedule.begin.as_ref().map_or(Ok(0.0), |share| self.share(share, weight.file));
        let (begin, end) = (begin?, self.share(&schedule.end, weight.file)?);
        if begin >= end {
            let at = schedule.begin.as_ref().map_or(schedule.end.span, |first| first.span.to(schedule.end.span));
            let diagnostic = wrong(at, "the weight has no share of the training in which to change");
            let diagnostic = diagnostic.expected("two shares, the first below the second").found(format!(
                "{} % and {} %",
                for_people(100.0 * begin),
                for_people(100.0 * end)
            ));
            return Err(self.report(diagnostic));
        }
        Ok(Some(Schedule { from: schedule.from, begin, end }))
    }

    /// A share of a training, 0 to 1.
    fn share(&mut self, share: &'a Expr, file: FileId) -> Checked<f64> {
        self.in_file(file, |checker| {
            let (value, dimension) = checker.constant_number(share, "a share of a training is a constant number")?;
            if dimension.is_none() && (0.0..=1.0).contains(&value) {
                return Ok(value);
            }
            let found = if dimension.is_none() { format!("{} %", for_people(100.0 * value)) } else { dimension.described() };
            let diagnostic = checker.diagnostic(codes::tasks::SCHEDULE, share.span, "this is not a share of a training");
            Err(checker.report(diagnostic.expected("0 % .. 100 %").found(found)))
        })
    }

    /// A term is one plain number; conditions count 0 or 1.
    fn must_be_payable(&mut self, data: TypedValue, formula: &Expr, name: &str) -> Checked<TypedValue> {
        let help = match data.kind {
            Type::One(ElementType::Bool | ElementType::Int | ElementType::PLAIN) => return Ok(data),
            Type::One(ElementType::Number(_) | ElementType::WrappingAngle) => "",
            Type::One(ElementType::Vector { .. }) => "use its length `norm(v)` or one component",
            Type::One(ElementType::Place(_)) => "use a distance: `distance(a, b) / 1 m`",
            Type::One(ElementType::Rotation) => "use an angle or an axis: `torso.up.z`",
            Type::One(ElementType::Steps) => "write the time in seconds and divide by `1 s`",
            Type::List(ElementType::Bool, _) => "use `any(...)`, `all(...)` or `mean(...)`",
            Type::List(..) | Type::Mixed(_) => "reduce it to one number: `sum(...)`, `mean(...)`, `norm(...)`",
        };
        let message = format!("the term `{name}` must be dimensionless, so that weights can be compared");
        let diagnostic = self
            .diagnostic(codes::types::NOT_PLAIN, formula.span, message)
            .expected(Dimension::NONE.described())
            .found(data.kind.described(self.vocabulary));
        let diagnostic = match data.kind.dimension().filter(|_| data.kind.is_one_number()) {
            Some(dimension) => divide_by(diagnostic, formula, dimension),
            None => diagnostic.help(help),
        };
        Err(self.report(diagnostic))
    }
}
