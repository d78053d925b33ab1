//! The functions and operators of the language: one table from which calls are resolved and the reference is made.

mod contact;
mod elementary;
mod lists;
mod muscles;
mod temporal;
mod terrain;
mod vectors;

use super::context::{Checked, Checker, Reported};
use super::dimension::Dimension;
use super::types::Type;
use super::value::Data;
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::syntax::tree::{Argument, BinaryOperator, Expr, ExprKind};

/// A call of a built-in function, its arguments not yet checked.
pub(crate) struct Call<'a> {
    pub name: &'static str,
    pub signature: &'static str,
    pub arguments: &'a [Argument],
    pub span: Span,
}

/// What a function does with a call.
type Apply = for<'c, 'a> fn(&'c mut Checker<'a>, &Call<'a>) -> Checked<Data>;

/// A row of the table.
pub struct Function {
    /// As called.
    pub name: &'static str,
    /// With its parameters.
    pub signature: &'static str,
    /// One sentence.
    pub description: &'static str,
    apply: Apply,
}

const fn row(name: &'static str, signature: &'static str, description: &'static str, apply: Apply) -> Function {
    Function { name, signature, description, apply }
}

/// Functions of the present moment.
#[rustfmt::skip]
pub const FUNCTIONS: &[Function] = &[
    row("exp", "exp(x)", "exponential of a plain number", elementary::exp),
    row("log", "log(x)", "natural logarithm of a plain number", elementary::log),
    row("tanh", "tanh(x)", "hyperbolic tangent of a plain number", elementary::tanh),
    row("sqrt", "sqrt(x)", "square root; halves the powers of the unit", elementary::sqrt),
    row("sin", "sin(angle)", "sine", elementary::sin),
    row("cos", "cos(angle)", "cosine", elementary::cos),
    row("tan", "tan(angle)", "tangent", elementary::tan),
    row("asin", "asin(x)", "angle whose sine is x, x clipped to -1..1", elementary::asin),
    row("acos", "acos(x)", "angle whose cosine is x, x clipped to -1..1", elementary::acos),
    row("atan2", "atan2(y, x)", "angle of the point (x, y); both of one unit", elementary::atan2),
    row("abs", "abs(x)", "without its sign", elementary::abs),
    row("sign", "sign(x)", "-1, 0 or 1", elementary::sign),
    row("floor", "floor(x)", "greatest whole number not above a plain number", elementary::floor),
    row("mod", "mod(x, y)", "x - y floor(x / y)", elementary::modulo),
    row("hypot", "hypot(x, y)", "root of x^2 + y^2", elementary::hypot),
    row("min", "min(x, y, ...) or min(list)", "the lowest", lists::min),
    row("max", "max(x, y, ...) or max(list)", "the highest", lists::max),
    row("clip", "clip(x, low, high)", "x, but not below low nor above high", elementary::clip),
    row("lerp", "lerp(a, b, share)", "a + share (b - a)", elementary::lerp),
    row("between", "between(x, low, high)", "condition: low <= x <= high", elementary::between),
    row("smoothstep", "smoothstep(x, low, high)", "0 below low, 1 above high, smooth between", elementary::smoothstep),
    row("tolerance", "tolerance(x, low, high, margin)", "1 within, falling as a bell to 0.1 at the margin outside", elementary::tolerance),
    row("sum", "sum(list)", "sum of a list; conditions count 0 or 1", lists::sum),
    row("mean", "mean(list)", "mean of a list; the mean of places is a place", lists::mean),
    row("std", "std(list)", "standard deviation of a list of numbers, divided by n", lists::std),
    row("prod", "prod(list)", "product of a list of plain numbers", lists::prod),
    row("norm", "norm(v)", "length of a vector; root of the sum of squares of a list of numbers", lists::norm),
    row("any", "any(list)", "condition: one of the conditions holds", lists::any),
    row("all", "all(list)", "condition: all of the conditions hold", lists::all),
    row("first", "first(list)", "first element", lists::first),
    row("last", "last(list)", "last element", lists::last),
    row("argmin", "argmin(list)", "place of the lowest element", lists::argmin),
    row("argmax", "argmax(list)", "place of the highest element", lists::argmax),
    row("dot", "dot(a, b)", "scalar product of two vectors in the same axes", vectors::dot),
    row("cross", "cross(a, b)", "vector product of two vectors in the same axes", vectors::cross),
    row("unit", "unit(v)", "the vector divided by its length; zero stays zero", vectors::unit),
    row("distance", "distance(a, b)", "between two places", vectors::distance),
    row("angle_between", "angle_between(a, b)", "angle between two vectors, 0 to half a turn", vectors::angle_between),
    row("turn", "turn(a, b)", "of two angles the short way from a to b, wrapped; of two orientations the angle of the turn between them, 0 to half a turn", vectors::turn),
    row("moment_arm", "moment_arm(muscle, joint)", "moment arm of a muscle, or of each of a list, about a joint", muscles::moment_arm),
    row("neutral", "neutral(x)", "the value of x in the body's standing pose, folded while compiling", vectors::neutral),
    row("touching", "touching(a, b)", "condition: the two touch; a named group counts as one thing, a list gives one answer each", contact::touching),
    row("contact_force", "contact_force(a, b)", "force on a by b, world axes", contact::contact_force),
    row("contact_count", "contact_count(a, b)", "number of contact points between them", contact::contact_count),
    row("surface_distance", "surface_distance(a, b)", "distance of their nearest surfaces, negative where they overlap", contact::surface_distance),
    row("slip", "slip(a, b)", "speed at which a slides on b where they touch, weighted by the pressure; 0 without contact", contact::slip),
    row("ground_height", "ground_height(place) or ground_height(landmark, [forward, left, up])", "height of walkable ground under a landmark, a constant place, or an offset along a heading", terrain::ground_height),
    row("ground_normal", "ground_normal(place) or ground_normal(landmark, [forward, left, up])", "upward unit normal of the ground there, world axes", terrain::ground_normal),
    row("scan", "scan(heading(landmark), offsets)", "heights of the ground at constant offsets [forward, left] along a heading", terrain::scan),
    row("radar", "radar(from, group, sectors, over, range)", "per sector, left to right: 1 - distance / range of the nearest member, 0 where none is in range", terrain::radar),
    row("ray", "ray(from, direction, range)", "distance to the first surface of the scene along a constant direction (forward, left, up) of a landmark, at most the range", terrain::ray),
];

/// Operators that remember: each advances once per control step, wherever it stands.
#[rustfmt::skip]
pub const OPERATORS: &[Function] = &[
    row("prev", "prev(x)", "x one control step ago; at step 0 x itself", temporal::prev),
    row("rate", "rate(x)", "(x - prev(x)) / dt; 0 at step 0; angles that wrap take the short way", temporal::rate),
    row("initial", "initial(x)", "x at step 0", temporal::initial),
    row("highest", "highest(x)", "highest x so far, step 0 included", temporal::highest),
    row("lowest", "lowest(x)", "lowest x so far, step 0 included", temporal::lowest),
    row("count", "count(c)", "at how many steps after step 0 the condition held", temporal::count),
    row("rising", "rising(c)", "condition: c holds and did not one step ago; never at step 0", temporal::rising),
    row("falling", "falling(c)", "condition: c does not hold and did one step ago; never at step 0", temporal::falling),
    row("hysteresis", "hysteresis(x, low, high)", "condition: holds once x rises above high, until it falls below low", temporal::hysteresis),
    row("once", "once(c)", "condition: holds at the first step after step 0 at which c holds, and at no other", temporal::once),
    row("ever", "ever(c)", "condition: c has held at some step, step 0 included", temporal::ever),
    row("always", "always(c)", "condition: c has held at every step, step 0 included", temporal::always),
    row("held", "held(c, 25 steps)", "condition: c has held for so long without a break, counted from step 1", temporal::held),
    row("since", "since(c)", "time since c last held; infinite before", temporal::since),
    row("timer", "timer(c)", "for how long c has held without a break; 0 at step 0", temporal::timer),
    row("smooth", "smooth(x, tau)", "x through a first-order low pass with time constant tau, starting at x", temporal::smooth),
    row("integral", "integral(x)", "sum of x dt over the steps after step 0", temporal::integral),
    row("sampled", "sampled(x, c)", "x at the last step at which c held; at first x at step 0", temporal::sampled),
    row("delay", "delay(x, 10 steps)", "x so long ago; before that x at step 0", temporal::delay),
];

/// Names of functions of the language that this version does not have yet.
const LATER: &[&str] = &[];

/// The function called `name`.
pub fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().chain(OPERATORS).find(|function| function.name == name)
}

/// Whether the language has such a function, but this version does not.
pub(crate) fn is_later(name: &str) -> bool {
    LATER.contains(&name)
        || super::signals::SIGNALS.iter().any(|s| !s.supported && s.name.split_once('(').is_some_and(|(n, _)| n == name))
}

impl Function {
    pub(crate) fn call<'a>(&'static self, checker: &mut Checker<'a>, arguments: &'a [Argument], span: Span) -> Checked<Data> {
        let call = Call { name: self.name, signature: self.signature, arguments, span };
        (self.apply)(checker, &call)
    }
}

impl<'a> Call<'a> {
    /// Exactly these arguments, by place or by name.
    pub(crate) fn take<const COUNT: usize>(&self, checker: &mut Checker<'a>, names: [&str; COUNT]) -> Checked<[&'a Expr; COUNT]> {
        let mut found: [Option<&'a Expr>; COUNT] = [None; COUNT];
        let mut next = 0;
        for argument in self.arguments {
            let place = match &argument.name {
                Some(name) => names.iter().position(|known| *known == name.text),
                None => {
                    next += 1;
                    Some(next - 1)
                }
            };
            match place.and_then(|place| found.get_mut(place)) {
                Some(slot @ None) => *slot = Some(&argument.value),
                _ => return Err(self.wrong_arguments(checker)),
            }
        }
        // Every place is filled, or the first that is not is reported.
        let mut filled = Vec::with_capacity(COUNT);
        for slot in found {
            filled.push(slot.ok_or_else(|| self.wrong_arguments(checker))?);
        }
        <[&'a Expr; COUNT]>::try_from(filled).map_err(|_| self.wrong_arguments(checker))
    }

    pub(crate) fn wrong_arguments(&self, checker: &mut Checker<'a>) -> Reported {
        let message = format!("`{}` does not take these arguments", self.name);
        let diagnostic = checker
            .diagnostic(codes::types::ARGUMENTS, self.span, message)
            .expected(format!("`{}`", self.signature))
            .found(format!("{} argument(s)", self.arguments.len()));
        checker.report(diagnostic)
    }

    /// `x, low, high`, or `x, low..high` with the bounds in one.
    pub(crate) fn take_bounded<const REST: usize>(
        &self,
        checker: &mut Checker<'a>,
        rest: [&str; REST],
    ) -> Checked<(&'a Expr, &'a Expr, &'a Expr, [&'a Expr; REST])> {
        let range = self.arguments.get(1).filter(|argument| argument.name.is_none()).and_then(|argument| {
            if let ExprKind::Range { low, high } = &argument.value.kind { Some((&**low, &**high)) } else { None }
        });
        let first = self.arguments.first().filter(|argument| argument.name.is_none());
        let (Some(first), skip) = (first, if range.is_some() { 2 } else { 3 }) else {
            return Err(self.wrong_arguments(checker));
        };
        if self.arguments.len() < skip {
            return Err(self.wrong_arguments(checker));
        }
        let tail = Call { arguments: &self.arguments[skip..], ..*self };
        let rest = tail.take(checker, rest)?;
        let (low, high) = match range {
            Some(bounds) => bounds,
            None => (&self.arguments[1].value, &self.arguments[2].value),
        };
        Ok((&first.value, low, high, rest))
    }
}

impl<'a> Checker<'a> {
    /// A number, or a list of them, that must have this dimension.
    ///
    /// # Errors
    /// Another dimension; the error says what to divide by.
    pub(crate) fn number_of(&mut self, expr: &'a Expr, dimension: Dimension, wanted_by: &str) -> Checked<Data> {
        let data = self.data(expr)?;
        self.must_have_dimension(&data, expr, dimension, wanted_by)?;
        Ok(data)
    }

    fn must_have_dimension(&mut self, data: &Data, expr: &Expr, wanted: Dimension, by: &str) -> Checked<()> {
        let number = matches!(data.kind.element(), Type::Number(_) | Type::Int);
        let found = data.kind.dimension().filter(|_| number);
        if found == Some(wanted) || number && data.is_zero() {
            return Ok(());
        }
        let diagnostic = self
            .diagnostic(codes::types::DIMENSIONS_DIFFER, expr.span, format!("{by} takes {}", wanted.described()))
            .expected(wanted.described())
            .found(data.kind.element().described(self.vocabulary));
        let factor = found.and_then(|found| found.per(wanted));
        let inverse = found.and_then(|found| found.times(wanted)).is_some_and(Dimension::is_none);
        let diagnostic = match factor {
            _ if inverse && !wanted.is_none() => {
                diagnostic.help(format!("this is its inverse: write `1 / x`, or the number in `{}`", preferred(wanted)))
            }
            Some(_) if found.is_some_and(Dimension::is_none) => diagnostic.help(format!("give it the unit `{wanted}`")),
            Some(factor) => divide_by(diagnostic, expr, factor),
            None => diagnostic,
        };
        Err(self.report(diagnostic))
    }
}

/// The unit in which a dimension is usually written.
fn preferred(dimension: Dimension) -> String {
    if dimension == Dimension::FREQUENCY { "Hz".to_owned() } else { dimension.to_string() }
}

/// Advises to divide `expr` by a quantity; offers to write it where that needs no brackets.
pub(crate) fn divide_by(diagnostic: Diagnostic, expr: &Expr, factor: Dimension) -> Diagnostic {
    let advice = format!("divide by `1 {factor}`, or by the size at which it shall matter");
    let mut first = expr;
    while let ExprKind::Unary { operand, .. } = &first.kind {
        first = operand;
    }
    let binds = match &first.kind {
        ExprKind::Binary { operator, .. } => {
            matches!(operator, BinaryOperator::Multiply | BinaryOperator::Divide | BinaryOperator::Power)
        }
        ExprKind::Name(_) | ExprKind::Field { .. } | ExprKind::Call { .. } | ExprKind::Paren(_) | ExprKind::Number(_) => true,
        _ => false,
    };
    if binds {
        diagnostic.suggest(advice, Span::at(expr.span.end as usize), format!(" / 1 {factor}"))
    } else {
        diagnostic.help(advice)
    }
}
