//! The functions and operators of the language: one table from which calls are resolved and the reference is made.

mod apply;
mod contact;
mod muscles;
pub mod signature;
mod terrain;
#[cfg(test)]
mod tests;
mod values;

use super::context::{Checked, Checker, Reported};
use super::dimension::Dimension;
use super::offered::{offer_decimal_point, offer_unit};
use super::types::ElementType;
use super::unit;
use super::value::TypedValue;
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::emit::{elementary, lists, temporal, vectors};
use crate::graph::operation::{Binary, Memory, Reduction, Unary};
use crate::syntax::tree::{Argument, BinaryOperator, Expr, ExprKind};
use signature::{Computes, Gives, Parameter, Shapes, Signature, Takes, alike, each, list, of, one, repeated};

/// A call of a built-in function, its arguments not yet checked.
pub(crate) struct Call<'a> {
    pub name: &'static str,
    pub signature: &'static str,
    pub arguments: &'a [Argument],
    pub span: Span,
    /// Whether the function advances once per control step.
    pub remembers: bool,
}

/// What a function does with a call that no signature describes.
type Apply = for<'c, 'a> fn(&'c mut Checker<'a>, &Call<'a>) -> Checked<TypedValue>;

/// How calls of a function are checked.
pub enum Checks {
    /// Against these signatures.
    Signatures(&'static [Signature]),
    /// By a function of its own: it takes parts of the body, objects, or what a sensor must know beforehand.
    Own(#[doc(hidden)] OwnCheck),
}

/// A check that no signature describes.
pub struct OwnCheck(Apply);

/// A row of the table.
pub struct Function {
    /// As called.
    pub name: &'static str,
    /// With its parameters.
    pub signature: &'static str,
    /// One sentence.
    pub description: &'static str,
    /// What its arguments may be, and what it gives.
    pub checks: Checks,
}

const fn row(
    name: &'static str,
    signature: &'static str,
    description: &'static str,
    signatures: &'static [Signature],
) -> Function {
    Function { name, signature, description, checks: Checks::Signatures(signatures) }
}

const fn own(name: &'static str, signature: &'static str, description: &'static str, apply: Apply) -> Function {
    Function { name, signature, description, checks: Checks::Own(OwnCheck(apply)) }
}

/// A function of one quantity.
macro_rules! map {
    ($parameter:literal: $takes:expr => $gives:expr, $function:ident) => {
        &[of(&[each($parameter, $takes)], $gives, Computes::Unary(Unary::$function))]
    };
}

/// A list made into one value.
macro_rules! fold {
    ($takes:expr => $gives:expr, $computes:expr) => {
        &[of(&[list($takes)], $gives, $computes)]
    };
}

/// A function of several arguments that are laid out alike.
macro_rules! form {
    ($($parameter:expr),+ => $gives:expr, $function:expr) => {
        &[of(&[$($parameter),+], $gives, Computes::Emits($function))]
    };
}

/// The same, where type checking looks at the values of arguments.
macro_rules! looked_at {
    ($($parameter:expr),+ => $gives:expr, $function:expr) => {
        &[of(&[$($parameter),+], $gives, Computes::Looks($function))]
    };
}

const PLAIN: Takes = Takes::Quantity(Dimension::NONE);
const ANGLE: Takes = Takes::Quantity(Dimension::ANGLE);
const TO_PLAIN: Gives = Gives::Quantity(Dimension::NONE);
const TO_ANGLE: Gives = Gives::Quantity(Dimension::ANGLE);
const TO_TIME: Gives = Gives::Quantity(Dimension::TIME);
const BOUNDED: [Parameter; 3] = [alike("x", Takes::Number), alike("low", Takes::Number), alike("high", Takes::Number)];

/// Functions of the present moment.
#[rustfmt::skip]
pub const FUNCTIONS: &[Function] = &[
    row("exp", "exp(x)", "exponential function", map!("x": PLAIN => TO_PLAIN, Exponential)),
    row("log", "log(x)", "natural logarithm", map!("x": PLAIN => TO_PLAIN, Logarithm)),
    row("tanh", "tanh(x)", "hyperbolic tangent", map!("x": PLAIN => TO_PLAIN, HyperbolicTangent)),
    row("sqrt", "sqrt(x)", "square root; halves the exponents of the unit", map!("x": Takes::Number => Gives::Root, SquareRoot)),
    row("sin", "sin(angle)", "sine", map!("angle": ANGLE => TO_PLAIN, Sine)),
    row("cos", "cos(angle)", "cosine", map!("angle": ANGLE => TO_PLAIN, Cosine)),
    row("tan", "tan(angle)", "tangent", map!("angle": ANGLE => TO_PLAIN, Tangent)),
    row("asin", "asin(x)", "angle whose sine is x, x clipped to -1..1", map!("x": PLAIN => TO_ANGLE, ArcSine)),
    row("acos", "acos(x)", "angle whose cosine is x, x clipped to -1..1", map!("x": PLAIN => TO_ANGLE, ArcCosine)),
    row("atan2", "atan2(y, x)", "angle of the point (x, y); both have the same unit",
        &[of(&[alike("y", Takes::Number), alike("x", Takes::Number)], Gives::WrappingAngle, Computes::Binary(Binary::ArcTangent2))]),
    row("abs", "abs(x)", "absolute value", looked_at!(each("x", Takes::Number) => Gives::Unsigned, values::abs)),
    row("sign", "sign(x)", "-1, 0 or 1", map!("x": Takes::Number => Gives::Whole, Sign)),
    row("floor", "floor(x)", "largest whole number not above x", map!("x": PLAIN => Gives::Whole, Floor)),
    row("mod", "mod(x, y)", "x - y floor(x / y)",
        &[of(&[alike("x", Takes::Number), alike("y", Takes::Number)], Gives::Same, Computes::Binary(Binary::Modulo))]),
    row("hypot", "hypot(x, y)", "root of x^2 + y^2",
        &[of(&[alike("x", Takes::Number), alike("y", Takes::Number)], Gives::Magnitude, Computes::Binary(Binary::Hypotenuse))]),
    row("min", "min(x, y, ...) or min(list)", "the lowest",
        &[of(&[list(Takes::Counted)], Gives::Same, Computes::Reduce(Reduction::Minimum)),
          repeated(&[alike("x", Takes::Ordered), alike("y", Takes::Ordered)], Gives::Same, Computes::Emits(lists::lowest))]),
    row("max", "max(x, y, ...) or max(list)", "the highest",
        &[of(&[list(Takes::Counted)], Gives::Same, Computes::Reduce(Reduction::Maximum)),
          repeated(&[alike("x", Takes::Ordered), alike("y", Takes::Ordered)], Gives::Same, Computes::Emits(lists::highest))]),
    row("clip", "clip(x, low, high)", "x limited to low..high", &[of(&BOUNDED, Gives::Same, Computes::Emits(elementary::clip))]),
    row("lerp", "lerp(a, b, share)", "a + share (b - a)",
        form!(alike("a", Takes::Number), alike("b", Takes::Number), each("share", PLAIN) => Gives::Blend, elementary::lerp)),
    row("between", "between(x, low, high)", "condition: low <= x <= high", &[of(&BOUNDED, Gives::Condition, Computes::Emits(elementary::between))]),
    row("smoothstep", "smoothstep(x, low, high)", "0 below low, 1 above high, smooth between", &[of(&BOUNDED, TO_PLAIN, Computes::Emits(elementary::smoothstep))]),
    row("tolerance", "tolerance(x, low, high, margin)", "1 within low..high, outside a bell curve that is 0.1 at the margin",
        form!(BOUNDED[0], BOUNDED[1], BOUNDED[2], alike("margin", Takes::Number) => TO_PLAIN, elementary::tolerance)),
    row("sum", "sum(list)", "sum of a list; conditions are 0 or 1", fold!(Takes::Summed => Gives::Sum, Computes::Emits(lists::sum))),
    row("mean", "mean(list)", "mean of a list; of places a place, of angles that wrap their circular mean", fold!(Takes::Averaged => Gives::Mean, Computes::Emits(lists::mean))),
    row("std", "std(list)", "standard deviation of a list of numbers, divided by n", fold!(Takes::Counted => Gives::Magnitude, Computes::Emits(lists::std))),
    row("prod", "prod(list)", "product of a list of dimensionless numbers", fold!(Takes::Counted => Gives::Product, Computes::Reduce(Reduction::Product))),
    row("norm", "norm(v)", "length of a vector; root of the sum of squares of a list of numbers",
        &[of(&[each("v", Takes::Vector)], Gives::Magnitude, Computes::Emits(lists::length)),
          of(&[Parameter { name: "v", ..list(Takes::Counted) }], Gives::Magnitude, Computes::Reduce(Reduction::Norm))]),
    row("any", "any(list)", "condition: at least one condition holds",
        &[of(&[Parameter { shapes: Shapes::OneOrList, ..list(Takes::Condition) }], Gives::Condition, Computes::Reduce(Reduction::Maximum))]),
    row("all", "all(list)", "condition: all conditions hold",
        &[of(&[Parameter { shapes: Shapes::OneOrList, ..list(Takes::Condition) }], Gives::Condition, Computes::Reduce(Reduction::Minimum))]),
    row("first", "first(list)", "first element", fold!(Takes::Anything => Gives::ElementAt { last: false }, Computes::Emits(lists::first))),
    row("last", "last(list)", "last element", fold!(Takes::Anything => Gives::ElementAt { last: true }, Computes::Emits(lists::last))),
    row("argmin", "argmin(list)", "index of the lowest element", fold!(Takes::Counted => Gives::Whole, Computes::Reduce(Reduction::ArgMinimum))),
    row("argmax", "argmax(list)", "index of the highest element", fold!(Takes::Counted => Gives::Whole, Computes::Reduce(Reduction::ArgMaximum))),
    row("dot", "dot(a, b)", "scalar product of two vectors in the same frame",
        form!(each("a", Takes::Vector), each("b", Takes::Vector) => Gives::Dot, vectors::dot)),
    row("cross", "cross(a, b)", "vector product of two vectors in the same frame",
        form!(each("a", Takes::Vector3), each("b", Takes::Vector3) => Gives::Cross, vectors::cross)),
    row("normalize", "normalize(v)", "the vector divided by its length; a zero vector stays zero",
        form!(each("v", Takes::Vector) => Gives::Direction, vectors::unit)),
    row("distance", "distance(a, b)", "distance between two places",
        form!(alike("a", Takes::Place), alike("b", Takes::Place) => Gives::Quantity(Dimension::LENGTH), vectors::distance)),
    row("angle_between", "angle_between(a, b)", "angle between two vectors, 0 to pi",
        form!(each("a", Takes::Vector3), each("b", Takes::Vector3) => TO_ANGLE, vectors::angle_between)),
    row("angle_difference", "angle_difference(a, b)", "of two angles the wrapped difference from a to b; of two orientations the angle of the rotation between them, 0 to pi",
        &[of(&[alike("a", Takes::Rotation), alike("b", Takes::Rotation)], TO_ANGLE, Computes::Emits(vectors::turn_of_axes)),
          of(&[alike("a", Takes::Angle), alike("b", Takes::Angle)], Gives::WrappingAngle, Computes::Emits(vectors::turn))]),
    own("moment_arm", "moment_arm(muscle, joint)", "moment arm of a muscle, or of each of a list, about a joint", muscles::moment_arm),
    row("neutral", "neutral(x)", "the value of x in the body's standing pose, computed at compile time",
        looked_at!(each("x", Takes::Anything) => Gives::Same, values::neutral)),
    own("touching", "touching(a, b)", "condition: a and b are in contact; a named group is one entity, a list gives one result per member", contact::touching),
    own("contact_force", "contact_force(a, b)", "force on a by b, expressed in the world frame", contact::contact_force),
    own("contact_count", "contact_count(a, b)", "number of contact points between them", contact::contact_count),
    own("surface_distance", "surface_distance(a, b)", "distance of their nearest surfaces, negative if they overlap", contact::surface_distance),
    own("slip", "slip(a, b)", "sliding speed of a on b, weighted by the contact pressure; 0 without contact", contact::slip),
    own("ground_height", "ground_height(place) or ground_height(landmark, [forward, left, up])", "height of walkable ground under a landmark, a constant place, or an offset along a heading", terrain::ground_height),
    own("ground_normal", "ground_normal(place) or ground_normal(landmark, [forward, left, up])", "upward unit normal of the ground there, expressed in the world frame", terrain::ground_normal),
    own("scan", "scan(heading(landmark), offsets)", "heights of the ground at constant offsets [forward, left] along a heading", terrain::scan),
    own("radar", "radar(from, group, sectors, over, range)", "per sector, left to right: 1 - distance / range of the nearest member, 0 if none is in range", terrain::radar),
    own("ray", "ray(from, direction, range)", "distance to the first surface of the scene along a constant direction (forward, left, up) of a landmark, at most the range", terrain::ray),
];

/// Operators that remember: each advances once per control step, wherever it stands.
#[rustfmt::skip]
pub const OPERATORS: &[Function] = &[
    row("prev", "prev(x)", "x one control step earlier; at step 0 x itself",
        &[of(&[each("x", Takes::Anything)], Gives::Same, Computes::Memory(Memory::Delay(1)))]),
    row("rate", "rate(x)", "(x - prev(x)) / dt; 0 at step 0; angles that wrap take the short way",
        form!(each("x", Takes::Gradual) => Gives::Rate, temporal::rate)),
    row("initial", "initial(x)", "x at step 0", &[of(&[each("x", Takes::Anything)], Gives::Same, Computes::Memory(Memory::Initial))]),
    row("running_max", "running_max(x)", "running maximum of x, step 0 included",
        &[of(&[each("x", Takes::Number)], Gives::Same, Computes::Memory(Memory::Highest))]),
    row("running_min", "running_min(x)", "running minimum of x, step 0 included",
        &[of(&[each("x", Takes::Number)], Gives::Same, Computes::Memory(Memory::Lowest))]),
    row("count", "count(c)", "number of steps after step 0 at which c held",
        &[of(&[each("c", Takes::Condition)], Gives::Whole, Computes::Memory(Memory::Accumulate))]),
    row("rising", "rising(c)", "condition: c holds and did not hold one step earlier; never at step 0",
        form!(each("c", Takes::Condition) => Gives::Condition, temporal::rising)),
    row("falling", "falling(c)", "condition: c does not hold and did hold one step earlier; never at step 0",
        form!(each("c", Takes::Condition) => Gives::Condition, temporal::falling)),
    row("hysteresis", "hysteresis(x, low, high)", "condition: holds once x rises above high, until it falls below low",
        &[of(&BOUNDED, Gives::Condition, Computes::Memory(Memory::Hysteresis))]),
    row("once", "once(c)", "condition: holds only at the first step after step 0 at which c holds",
        form!(each("c", Takes::Condition) => Gives::Condition, temporal::once)),
    row("ever", "ever(c)", "condition: c has held at some step, step 0 included",
        &[of(&[each("c", Takes::Condition)], Gives::Condition, Computes::Memory(Memory::Highest))]),
    row("always", "always(c)", "condition: c has held at every step, step 0 included",
        &[of(&[each("c", Takes::Condition)], Gives::Condition, Computes::Memory(Memory::Lowest))]),
    row("held", "held(c, 25 steps)", "condition: c has held without interruption for the duration, counted from step 1",
        form!(each("c", Takes::Condition), one("duration", Takes::Duration) => Gives::Condition, temporal::held)),
    row("since", "since(c)", "time since c last held; infinite before",
        form!(each("c", Takes::Condition) => TO_TIME, temporal::since)),
    row("timer", "timer(c)", "time for which c has held without interruption; 0 at step 0",
        form!(each("c", Takes::Condition) => TO_TIME, temporal::timer)),
    row("smooth", "smooth(x, tau)", "x through a first-order low pass with time constant tau, starting at x; angles that wrap take the short way",
        form!(each("x", Takes::Gradual), one("tau", Takes::TimeConstant) => Gives::Blend, temporal::smooth)),
    row("integral", "integral(x)", "sum of x dt over the steps after step 0",
        form!(each("x", Takes::Number) => Gives::Integral, temporal::integral)),
    row("sample_hold", "sample_hold(x, c)", "x at the last step at which c held; before that x at step 0",
        &[of(&[each("x", Takes::Anything), each("c", Takes::Condition)], Gives::Same, Computes::Memory(Memory::Sampled))]),
    row("delay", "delay(x, 10 steps)", "x delayed by the duration; before that x at step 0",
        looked_at!(each("x", Takes::Anything), one("duration", Takes::Duration) => Gives::Same, values::delay)),
];

/// The function called `name`.
pub fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().chain(OPERATORS).find(|function| function.name == name)
}

/// Whether the language has such a function, but this version does not.
pub(crate) fn is_later(name: &str) -> bool {
    super::signals::SIGNALS.iter().any(|s| !s.supported && s.name.split_once('(').is_some_and(|(n, _)| n == name))
}

impl Function {
    /// What it takes and gives, in the words of the reference; nothing of a function with a check of its own.
    pub fn in_words(&self) -> (String, String) {
        let Checks::Signatures(signatures) = &self.checks else { return Default::default() };
        let takes: Vec<String> = signatures.iter().map(Signature::takes_in_words).collect();
        let mut gives: Vec<String> = signatures.iter().map(|signature| signature.gives.to_string()).collect();
        gives.dedup();
        (takes.join(", or "), gives.join(", or "))
    }

    pub(crate) fn call<'a>(
        &'static self,
        checker: &mut Checker<'a>,
        arguments: &'a [Argument],
        span: Span,
    ) -> Checked<TypedValue> {
        let remembers = OPERATORS.iter().any(|operator| operator.name == self.name);
        let call = Call { name: self.name, signature: self.signature, arguments, span, remembers };
        match &self.checks {
            Checks::Signatures(signatures) => apply::apply(checker, &call, signatures),
            Checks::Own(OwnCheck(apply)) => apply(checker, &call),
        }
    }
}

impl<'a> Call<'a> {
    /// How many arguments there are, where bounds in one, `low..high`, count as two.
    pub(crate) fn count(&self) -> usize {
        self.arguments.len() + usize::from(self.range().is_some())
    }

    /// Bounds in one as the second argument: `x, low..high`.
    pub(super) fn range(&self) -> Option<(&'a Expr, &'a Expr)> {
        match self.arguments.get(1) {
            Some(Argument { name: None, value: Expr { kind: ExprKind::Range { low, high }, .. } }) => Some((&**low, &**high)),
            _ => None,
        }
    }

    /// Exactly these arguments, by place or by name.
    pub(crate) fn take<const COUNT: usize>(&self, checker: &mut Checker<'a>, names: [&str; COUNT]) -> Checked<[&'a Expr; COUNT]> {
        <[&'a Expr; COUNT]>::try_from(self.by_name(checker, &names)?).map_err(|_| self.wrong_arguments(checker))
    }

    /// Exactly these arguments, by place or by name; `x, low, high` may be written `x, low..high`.
    pub(crate) fn by_name(&self, checker: &mut Checker<'a>, names: &[&str]) -> Checked<Vec<&'a Expr>> {
        let bounded = names.get(1..3) == Some(&["low", "high"]);
        let mut found: Vec<Option<&'a Expr>> = vec![None; names.len()];
        let mut next = 0;
        for argument in self.arguments {
            let place = match &argument.name {
                Some(name) => names.iter().position(|known| *known == name.text),
                None => {
                    next += 1;
                    Some(next - 1)
                }
            };
            let mut fill = |place: Option<usize>, value: &'a Expr| match place.and_then(|place| found.get_mut(place)) {
                Some(slot @ None) => {
                    *slot = Some(value);
                    true
                }
                _ => false,
            };
            let filled = match self.range().filter(|_| bounded && place == Some(1) && argument.name.is_none()) {
                Some((low, high)) => {
                    next += 1;
                    fill(Some(1), low) && fill(Some(2), high)
                }
                None => fill(place, &argument.value),
            };
            if !filled {
                return Err(self.wrong_arguments(checker));
            }
        }
        match found.into_iter().collect() {
            Some(all) => Ok(all),
            None => Err(self.wrong_arguments(checker)),
        }
    }

    /// All arguments, none of which has a name.
    fn unnamed(&self, checker: &mut Checker<'a>) -> Checked<Vec<&'a Expr>> {
        let unnamed = self.arguments.iter().map(|argument| argument.name.is_none().then_some(&argument.value));
        match unnamed.collect() {
            Some(all) => Ok(all),
            None => Err(self.wrong_arguments(checker)),
        }
    }

    pub(crate) fn wrong_arguments(&self, checker: &mut Checker<'a>) -> Reported {
        let message = format!("`{}` does not take these arguments", self.name);
        let diagnostic = checker
            .diagnostic(codes::types::ARGUMENTS, self.span, message)
            .expected(format!("`{}`", self.signature))
            .found(format!("{} argument(s)", self.arguments.len()));
        checker.report(offer_decimal_point(diagnostic, self.arguments))
    }
}

impl<'a> Checker<'a> {
    /// One number that must have this dimension.
    ///
    /// # Errors
    /// Another dimension, where the error names what to divide by, or a list.
    pub(crate) fn number_of(&mut self, expr: &'a Expr, dimension: Dimension, wanted_by: &str) -> Checked<TypedValue> {
        let data = self.data(expr)?;
        let number = data.kind.is_one_number();
        if number && (data.is_zero() || data.kind.dimension() == Some(dimension)) {
            return Ok(data);
        }
        if !number && data.kind.dimension() == Some(dimension) {
            let found = data.kind.described(self.vocabulary);
            let message = format!("{wanted_by} takes one number");
            let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            return Err(self.report(diagnostic));
        }
        Err(self.wrong_dimension(&data, expr, dimension, wanted_by))
    }

    /// Reports numbers of another dimension.
    pub(super) fn wrong_dimension(&mut self, data: &TypedValue, expr: &Expr, wanted: Dimension, by: &str) -> Reported {
        let found = data.kind.dimension().filter(|_| data.kind.all(ElementType::is_number));
        let diagnostic = self
            .diagnostic(codes::types::DIMENSIONS_DIFFER, expr.span, format!("{by} takes {}", wanted.described()))
            .expected(wanted.described())
            .found(data.kind.element_described(self.vocabulary));
        let factor = found.and_then(|found| found.per(wanted));
        let inverse = found.and_then(|found| found.times(wanted)).is_some_and(Dimension::is_none);
        let diagnostic = match factor {
            _ if inverse && !wanted.is_none() => {
                diagnostic.help(format!("this is its inverse: write `1 / x`, or the number in `{}`", preferred(wanted)))
            }
            Some(_) if found.is_some_and(Dimension::is_none) => offer_unit(diagnostic, wanted, expr),
            Some(factor) if wanted.is_none() && is_number(expr) => {
                divide_by(diagnostic, expr, factor).help("these brackets contain only constants: are they closed too early?")
            }
            Some(factor) => match inverted_unit(expr, factor).filter(|_| wanted.is_none()) {
                Some((span, unit)) => diagnostic.suggest(format!("did you mean `{unit}`?"), span, unit),
                None => divide_by(diagnostic, expr, factor),
            },
            None => match data.kind.element() {
                Some(ElementType::Vector { .. }) => diagnostic.help("use its length, `norm(v)`, or one component, such as `.z`"),
                Some(ElementType::Place(_)) => {
                    diagnostic.help("use a distance, `distance(a, b)`, or one component, such as `.z`")
                }
                _ => diagnostic,
            },
        };
        self.report(diagnostic)
    }
}

/// Whether an expression is written as one number, with or without a unit.
fn is_number(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_) => true,
        ExprKind::Paren(inner) | ExprKind::Unary { operand: inner, .. } => is_number(inner),
        _ => false,
    }
}

/// Of a product in which a number has the unit of the rest, `10 m/s * com.speed`: that number and the inverse of its unit, which
/// leaves a plain number.
fn inverted_unit(expr: &Expr, excess: Dimension) -> Option<(Span, String)> {
    match &expr.kind {
        ExprKind::Paren(inner) | ExprKind::Unary { operand: inner, .. } => inverted_unit(inner, excess),
        ExprKind::Binary { operator: BinaryOperator::Multiply | BinaryOperator::Divide, left, .. } => inverted_unit(left, excess),
        ExprKind::Number(number) => {
            let unit = number.unit.as_ref()?;
            let one = unit::evaluate(unit).ok()?;
            let inverse = one.dimension.inverse();
            (one.value == 1.0 && one.dimension.times(one.dimension) == Some(excess)).then(|| (unit.span, inverse.to_string()))
        }
        _ => None,
    }
}

/// The unit in which a dimension is usually written.
fn preferred(dimension: Dimension) -> String {
    if dimension == Dimension::FREQUENCY { "Hz".to_owned() } else { dimension.to_string() }
}

/// Advises to divide `expr` by a quantity; offers to write it where that needs no brackets.
pub(crate) fn divide_by(diagnostic: Diagnostic, expr: &Expr, factor: Dimension) -> Diagnostic {
    let advice = format!("divide by `1 {factor}`, or by a characteristic size");
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
