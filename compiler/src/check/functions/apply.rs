//! Calls: arguments are evaluated, fitted to a signature, laid out alike, and handed to what computes the value.

use super::Call;
use super::signature::{Computes, Gives, Parameter, Shapes, Signature, Takes};
use crate::check::context::{Checked, Checker, Failures, ReadMode, Reported};
use crate::check::dimension::Dimension;
use crate::check::observe::spoken_unit;
use crate::check::types::{ElementType, Frame, Shape, Type};
use crate::check::value::{LiteralKind, TypedValue, Value};
use crate::diagnostics::{Span, codes};
use crate::emit::Arguments;
use crate::syntax::tree::Expr;

/// Arguments that fit a signature.
pub(super) struct Bound<'a> {
    /// As written.
    pub exprs: Vec<&'a Expr>,
    /// Of the whole call.
    pub span: Span,
    /// Of each argument.
    pub kinds: Vec<Type>,
    /// Laid out alike.
    pub arguments: Arguments,
}

/// An argument, evaluated.
enum Argument {
    Value(Value),
    /// Known while compiling.
    Constant(f64),
}

/// Checks a call against the signatures of its function and computes the value.
pub(super) fn apply<'a>(checker: &mut Checker<'a>, call: &Call<'a>, signatures: &'static [Signature]) -> Checked<TypedValue> {
    let given = call.count();
    let Some(first) = signatures.iter().find(|signature| signature.takes_so_many(given)) else {
        return Err(call.wrong_arguments(checker));
    };
    let exprs = if first.variadic {
        call.unnamed(checker)?
    } else {
        call.by_name(checker, &first.parameters.iter().map(|parameter| parameter.name).collect::<Vec<_>>())?
    };
    let mut arguments = Vec::with_capacity(exprs.len());
    let mut failures = Failures::default();
    for (place, &expr) in exprs.iter().enumerate() {
        arguments.extend(failures.catch(evaluated(checker, call, first.parameter(place).takes, expr)));
    }
    failures.or(())?;
    // Of several signatures the first that fits the first argument, else the last gives the error.
    let mut candidates = signatures.iter().filter(|signature| signature.takes_so_many(given));
    let fitting = candidates.clone().find(|signature| fits(checker, signature.parameter(0), &arguments[0]));
    let Some(signature) = fitting.or(candidates.next_back()) else { return Err(call.wrong_arguments(checker)) };
    let (mut data, mut failures) = (Vec::with_capacity(exprs.len()), Failures::default());
    for ((place, argument), &expr) in arguments.into_iter().enumerate().zip(&exprs) {
        data.extend(failures.catch(checker.fitted(call, signature, signature.parameter(place), argument, expr)));
    }
    failures.or(())?;
    if let Some((low, high)) = call.range()
        && let [_, bottom, top, ..] = data.as_mut_slice()
    {
        *bottom = checker.lower_end(bottom.clone(), low, (top, high));
    }
    in_order(checker, call, signature, &exprs, &data)?;
    let (bound, shape) = bind(checker, call, signature, exprs, data)?;
    let reduces = matches!(signature.parameter(0).shapes, Shapes::List | Shapes::OneOrList);
    let Some(kind) = signature.gives.kind(&bound, (!reduces).then_some(shape)) else {
        let message = format!("the exponents of the unit of this {} are too large", signature.gives.noun());
        return Err(checker.error(codes::types::POWER, bound.exprs[0].span, message));
    };
    let (graph, arguments) = (&mut checker.graph, &bound.arguments);
    let nodes = arguments.nodes.as_slice();
    let node = match &signature.computes {
        Computes::Unary(function) => graph.unary(*function, nodes[0]),
        Computes::Binary(function) => graph.binary(*function, nodes[0], nodes[1]),
        Computes::Memory(memory) => graph.memory(*memory, nodes),
        Computes::Reduce(_) if bound.kinds[0].shape() == Shape::One => nodes[0],
        Computes::Reduce(reduction) => graph.reduce(*reduction, arguments.length, nodes[0]),
        Computes::Emits(emit) => emit(graph, arguments),
        Computes::Looks(look) => look(checker, &bound)?,
    };
    Ok(TypedValue::new(node, kind))
}

/// Of two bounds that are known while compiling the lower comes first.
fn in_order<'a>(
    checker: &mut Checker<'a>,
    call: &Call<'a>,
    signature: &Signature,
    exprs: &[&'a Expr],
    data: &[TypedValue],
) -> Checked<()> {
    let [bottom, top] = ["low", "high"].map(|name| signature.parameters.iter().position(|parameter| parameter.name == name));
    let (Some(bottom), Some(top)) = (bottom, top) else { return Ok(()) };
    let [low, high] = [bottom, top].map(|place| checker.graph.constant_value(data[place].node));
    let (Some(low), Some(high)) = (low, high) else { return Ok(()) };
    if low <= high {
        return Ok(());
    }
    let span = exprs[bottom].span.to(exprs[top].span);
    if low.is_nan() || high.is_nan() {
        let message = format!("a bound of `{}` is NaN in every state", call.name);
        let diagnostic = checker.diagnostic(codes::tasks::NOT_FINITE, span, message);
        return Err(checker.report(diagnostic.help("look for a division by zero")));
    }
    let unit = spoken_unit(&data[top].kind, [exprs[top]]);
    let (range, _) = unit.tell_beside([high, low], low);
    let message = format!("the bounds of `{}` are swapped: the lower bound comes first", call.name);
    let diagnostic = checker.diagnostic(codes::tasks::OUT_OF_RANGE, span, message).expected(range);
    Err(checker.report(diagnostic))
}

/// Lays the arguments out alike; the shape is that in which those meet over which the function maps.
fn bind<'a>(
    checker: &mut Checker<'a>,
    call: &Call<'a>,
    signature: &'static Signature,
    exprs: Vec<&'a Expr>,
    data: Vec<TypedValue>,
) -> Checked<(Bound<'a>, Shape)> {
    let kinds: Vec<Type> = data.iter().map(|data| data.kind.clone()).collect();
    let is_alike = |place: &usize| signature.parameter(*place).alike;
    let alike: Vec<_> = (0..data.len()).filter(is_alike).map(|place| (data[place].clone(), exprs[place])).collect();
    let subject =
        if alike.is_empty() { kinds[0].clone() } else { checker.common_type_of(verb(call.name), &alike[0], &alike[1..])? };
    if matches!(signature.gives, Gives::Dot | Gives::Cross) || signature.parameters.iter().all(|p| p.takes == Takes::Vector3) {
        same_axes(checker, call, &kinds)?;
    }
    let maps = |place: usize| matches!(signature.parameter(place).shapes, Shapes::Each);
    let mapped: Vec<&TypedValue> = (0..data.len()).filter(|place| maps(*place)).map(|place| &data[place]).collect();
    let (mut laid_out, shape) = {
        let span = exprs.last().map_or(call.span, |expr| expr.span);
        let (nodes, shape) = checker.laid_out(&mapped, span)?;
        (nodes.into_iter(), shape)
    };
    let nodes = (0..data.len()).map(|place| if maps(place) { laid_out.next() } else { None }.unwrap_or(data[place].node));
    let arguments = Arguments {
        nodes: nodes.collect(),
        subject,
        length: kinds[0].shape().count(),
        lanes: kinds[0].element_lanes(),
        interval: checker.timing.interval,
    };
    Ok((Bound { span: call.span, exprs, kinds, arguments }, shape))
}

/// What arguments cannot do, in the words of an error.
fn verb(function: &str) -> &'static str {
    match function {
        "angle_difference" => "turn between",
        "distance" => "measure between",
        "lerp" => "blend",
        "atan2" | "hypot" | "mod" => "combine",
        _ => "compare",
    }
}

/// Vectors meet in the same axes.
fn same_axes<'a>(checker: &mut Checker<'a>, call: &Call<'a>, kinds: &[Type]) -> Checked<()> {
    let axes = |ty: &Type| match ty.element() {
        Some(ElementType::Vector { size, frame, .. }) => Some((size, frame)),
        _ => None,
    };
    let [left, right] = kinds else { return Ok(()) };
    let Some((_, frame)) = axes(left).filter(|own| Some(*own) != axes(right)) else { return Ok(()) };
    let (expected, found) = (left.described(checker.vocabulary), right.described(checker.vocabulary));
    let diagnostic = checker
        .diagnostic(codes::types::FRAMES_DIFFER, call.span, "these vectors are expressed in different frames")
        .expected(expected)
        .found(found)
        .help(format!("express the second in the frame of the first: `(... in {})`", frame.name(checker.vocabulary)));
    Err(checker.report(diagnostic))
}

/// Evaluates an argument; those of operators are read in the step itself, also inside `observe`.
fn evaluated<'a>(checker: &mut Checker<'a>, call: &Call<'a>, takes: Takes, expr: &'a Expr) -> Checked<Argument> {
    match takes {
        Takes::Duration => checker.bounded_steps(expr).map(Argument::Constant),
        Takes::TimeConstant => checker.time_constant(expr).map(Argument::Constant),
        _ => {
            let mode = ReadMode { after: checker.mode.after && !call.remembers, ..checker.mode };
            checker.in_mode(mode, |checker| checker.value(expr)).map(Argument::Value)
        }
    }
}

fn fits(checker: &Checker<'_>, parameter: &Parameter, argument: &Argument) -> bool {
    match argument {
        Argument::Constant(_) => parameter.takes.is_constant(),
        Argument::Value(Value::Typed(data)) => {
            let data = read_as(checker, parameter.takes, data.clone());
            let listed = parameter.shapes != Shapes::List || data.kind.length().is_some();
            listed && data.kind.all(|element| parameter.takes.accepts(element))
        }
        Argument::Value(_) => parameter.takes == Takes::Place,
    }
}

/// A bracket as the vector or place that it stands for.
fn read_as(checker: &Checker<'_>, takes: Takes, data: TypedValue) -> TypedValue {
    if !takes.reads_brackets() {
        return data;
    }
    let vector = checker.as_vector(data.clone(), Frame::World);
    match vector.kind.element() {
        Some(ElementType::Vector { size: 3, dimension, .. })
            if takes == Takes::Place && data.is_bracket() && (dimension == Dimension::LENGTH || vector.is_zero()) =>
        {
            TypedValue::new(data.node, ElementType::Place(Frame::World))
        }
        _ if takes == Takes::Place => data,
        _ => vector,
    }
}

impl<'a> Checker<'a> {
    /// An argument as its parameter takes it.
    fn fitted(
        &mut self,
        call: &Call<'a>,
        signature: &Signature,
        parameter: &Parameter,
        argument: Argument,
        expr: &'a Expr,
    ) -> Checked<TypedValue> {
        let data = match argument {
            Argument::Constant(value) => return Ok(TypedValue::new(self.graph.constant(value), ElementType::PLAIN)),
            Argument::Value(Value::Typed(data)) => data,
            Argument::Value(value) if parameter.takes == Takes::Place => self.positions(&value, expr.span)?,
            Argument::Value(value) => return Err(self.not_numbers(&value, expr.span)),
        };
        let data = read_as(self, parameter.takes, data);
        match parameter.shapes {
            Shapes::List => self.must_be_list(call, parameter, &data, expr)?,
            Shapes::One if data.kind.length().is_some() => return Err(self.not_one(call, parameter, &data, expr)),
            _ => {}
        }
        let any_dimension = matches!(parameter.takes, Takes::Quantity(_) | Takes::Angle);
        let zero = any_dimension && data.is_zero() && data.kind.all(ElementType::is_number);
        if zero || data.kind.all(|element| parameter.takes.accepts(element)) {
            // What a list is made into one value of must be of one type; angles wrap if one of them does.
            let Some(met) = data.kind.met().filter(|_| parameter.shapes == Shapes::List && parameter.takes != Takes::Anything)
            else {
                return Ok(data);
            };
            let kind = data.kind.with_element(met);
            return Ok(TypedValue { kind, literal: LiteralKind::Plain, ..data });
        }
        Err(self.not_taken(call, signature, parameter, &data, expr))
    }

    /// A list whose elements are of one kind.
    fn must_be_list(&mut self, call: &Call<'a>, parameter: &Parameter, data: &TypedValue, expr: &'a Expr) -> Checked<()> {
        let found = data.kind.described(self.vocabulary);
        if data.kind.length().is_none() {
            let message = format!("`{}` takes a list", call.name);
            let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            let single = call.name == "norm" && data.kind.all(ElementType::is_number);
            return Err(self.report(if single {
                diagnostic.help("this is a single number; its absolute value is `abs(x)`")
            } else {
                diagnostic
            }));
        }
        if data.kind.met().is_some() || parameter.takes == Takes::Anything {
            return Ok(());
        }
        let message = format!("`{}` cannot mix different dimensions", call.name);
        let diagnostic = self
            .diagnostic(codes::types::MIXED, expr.span, message)
            .found(found)
            .help("use only hinges or only slides: `hinges.q`, `slides.q`, `independent.q`");
        Err(self.report(diagnostic))
    }

    fn not_one(&mut self, call: &Call<'a>, parameter: &Parameter, data: &TypedValue, expr: &'a Expr) -> Reported {
        let found = data.kind.described(self.vocabulary);
        let message = format!("`{}` takes one value for its {}, found a list", call.name, parameter.name);
        let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
        self.report(diagnostic)
    }

    /// Reports an argument whose elements the parameter does not take.
    fn not_taken(
        &mut self,
        call: &Call<'a>,
        signature: &Signature,
        parameter: &Parameter,
        data: &TypedValue,
        expr: &'a Expr,
    ) -> Reported {
        let found = data.kind.described(self.vocabulary);
        let name = call.name;
        let diagnostic = |checker: &Self, message: String| checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message);
        let error = match (parameter.takes, parameter.shapes) {
            (Takes::Quantity(dimension), _) => {
                let by =
                    if signature.parameters.len() == 1 { format!("`{name}`") } else { format!("`{name}`'s {}", parameter.name) };
                return self.wrong_dimension(data, expr, dimension, &by);
            }
            (Takes::Condition, _) => return self.not_a_condition(data, expr),
            (Takes::Angle | Takes::Rotation, _) => {
                let message = format!("`{name}` takes two angles or two orientations");
                self.diagnostic(codes::types::WRONG_TYPE, call.span, message)
            }
            (Takes::Vector3, _) if data.kind.all(|element| Takes::Vector.accepts(element)) => {
                let message = format!("`{name}` takes vectors of three components");
                return self.error(codes::types::WRONG_TYPE, call.span, message);
            }
            (Takes::Vector | Takes::Vector3, _) => diagnostic(self, format!("`{name}` takes vectors")),
            (Takes::Place, _) => diagnostic(self, format!("`{name}` takes places"))
                .help("a place is a part of the body, an object, a marker, or `[x, y, z]` in the world; two numbers differ by `abs(a - b)`"),
            (Takes::Summed | Takes::Averaged, _) => {
                let place = matches!(data.kind.element(), Some(ElementType::Place(_)));
                let code = if place { codes::types::PLACES } else { codes::types::WRONG_TYPE };
                let message = format!("`{name}` is not defined for this value");
                self.diagnostic(code, expr.span, message).help("`mean` of places is a place")
            }
            (_, Shapes::List) => diagnostic(self, format!("`{name}` takes a list of numbers")),
            _ => {
                let error = diagnostic(self, format!("`{name}` takes numbers"));
                match data.kind.element() {
                    Some(ElementType::Vector { .. }) => error.help("use its length, `norm(v)`, or one component, such as `.z`"),
                    Some(ElementType::Bool) => error.help("`rising(c)` and `falling(c)` are the start and the end of a condition"),
                    _ => error,
                }
            }
        };
        self.report(error.found(found))
    }
}
