//! Calls: built-in functions, and functions of the files, inlined and checked at each call.

use super::context::{Checked, Checker, Failures, Local, Reported, Step};
use super::dimension::Dimension;
use super::functions;
use super::lookup::renamed;
use super::offered::offer_decimal_point;
use super::types::{ElementType, Frame, Type};
use super::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::{Diagnostic, Edit, FileId, Fix, Span, codes};
use crate::diagnostics::{function_elsewhere, is_module, nearest};
use crate::emit::frames;
use crate::frame::Sensor;
use crate::graph::NodeId;
use crate::hir::{DefinitionId, Resolution};
use crate::resolve::scope::Definition;
use crate::syntax::tree::{self, Argument, Expr, ExprKind, Function, Ident, Parameter};

/// Types that are no dimension.
const OTHER_TYPES: [&str; 10] = ["bool", "int", "duration", "place", "vec2", "vec3", "rotation", "landmark", "joint", "muscle"];

impl<'a> Checker<'a> {
    pub(crate) fn call(&mut self, function: &'a Expr, arguments: &'a [Argument], span: Span) -> Checked<Value> {
        if let ExprKind::Field { base, name } = &function.kind
            && let Some(value) = self.of_reference(base, name, Some(arguments), span)
        {
            return value;
        }
        let ExprKind::Name(name) = &function.kind else {
            return Err(self.call_on_a_value(function, arguments, span));
        };
        if let Some((declared, place)) = self.names.find(self.place, &name.text) {
            let Definition::Function(callee) = declared.definition else {
                let message = format!("`{}` is not a function", name.text);
                let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, name.span, message).label(
                    declared.file,
                    declared.definition.span(),
                    "declared here",
                );
                return Err(self.report(diagnostic));
            };
            self.resolved_to(name.span, declared);
            self.names.called.borrow_mut().insert((declared.file, name.text.clone()));
            let values = self.bind_arguments(callee, declared.file, arguments, span)?;
            self.enter(Step { name: name.text.clone(), file: self.place.file, span, call: true }, declared)?;
            let value = self.deeper(span, |checker| {
                checker.elsewhere(place, |checker| {
                    checker.locals = values;
                    let value = checker.value(&callee.body)?;
                    checker.check_annotation(callee.annotation.as_ref(), &value)?;
                    Ok(value)
                })
            });
            self.path.pop();
            return value;
        }
        match functions::find(&name.text) {
            Some(function) => {
                self.resolved(name.span, Resolution::Function(function.name));
                function.call(self, arguments, span).map(Value::Typed)
            }
            None if functions::is_later(&name.text) => {
                let message = format!("`{}` is part of the language, but not supported yet", name.text);
                Err(self.error(codes::names::NOT_YET, name.span, message))
            }
            None => Err(self.unknown_function(&name.text, name.span)),
        }
    }

    /// Reports `np.exp(x)` and `v.norm()`: functions stand by themselves.
    fn call_on_a_value(&mut self, function: &Expr, arguments: &[Argument], span: Span) -> Reported {
        let ExprKind::Field { base, name } = &function.kind else {
            return self.error(codes::names::NOT_YET, function.span, "only functions can be called, by their name");
        };
        let own = functions::find(&name.text).is_some() || self.names.find(self.place, &name.text).is_some();
        if let ExprKind::Name(module) = &base.kind
            && is_module(&module.text)
        {
            let message = format!("undefined name `{}`", module.text);
            let diagnostic = self.diagnostic(codes::names::UNKNOWN_NAME, function.span, message);
            let diagnostic = match function_elsewhere(&name.text) {
                Some(advice) if !own => diagnostic.help(advice),
                _ => diagnostic.help("functions have no prefix"),
            };
            let offered = format!("write `{}(...)`", name.text);
            return self.report(if own { diagnostic.suggest(offered, function.span, &*name.text) } else { diagnostic });
        }
        let message = format!("`{}` cannot be called on a value", name.text);
        let diagnostic = self.diagnostic(codes::names::UNKNOWN_PROPERTY, name.span, message);
        if !own {
            let advice = function_elsewhere(&name.text).unwrap_or("functions are called without receiver: `norm(v)`, `exp(x)`");
            return self.report(diagnostic.help(advice));
        }
        // `v.norm()` becomes `norm(v)`, `a.distance(b)` becomes `distance(a, b)`.
        let between = match arguments.first() {
            Some(first) => (Span::new(base.span.end as usize, first.value.span.start as usize), ", "),
            None => (Span::new(base.span.end as usize, span.end as usize), ")"),
        };
        let edit = |span: Span, replacement: String| Edit { file: diagnostic.file(), span, replacement };
        let edits =
            vec![edit(Span::at(base.span.start as usize), format!("{}(", name.text)), edit(between.0, between.1.to_owned())];
        let mut diagnostic = diagnostic;
        diagnostic.fixes.push(Fix { title: format!("write `{}(...)` around it", name.text), edits, automatic: false });
        self.report(diagnostic)
    }

    fn unknown_function(&mut self, text: &str, span: Span) -> Reported {
        let known = functions::FUNCTIONS.iter().chain(functions::OPERATORS).map(|function| function.name);
        let names: Vec<&str> = known.chain(self.names.in_sight(self.place)).collect();
        let near = nearest(text, names);
        let message = format!("undefined function `{text}`");
        let mut diagnostic = self.diagnostic(codes::names::UNKNOWN_NAME, span, message);
        if let Some(present) = renamed(text).filter(|present| functions::find(present).is_some()) {
            diagnostic = diagnostic.suggest(format!("it is now called `{present}`"), span, present);
            return self.report(diagnostic);
        }
        if let Some(advice) = function_elsewhere(text) {
            return self.report(diagnostic.help(advice));
        }
        if near.is_empty() {
            diagnostic = diagnostic.help("import functions of a library with `use \"...\"`");
        }
        for name in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), span, name);
        }
        self.report(diagnostic)
    }

    /// The arguments by the names of the parameters.
    fn bind_arguments(
        &mut self,
        callee: &'a Function,
        declared_in: FileId,
        arguments: &'a [Argument],
        span: Span,
    ) -> Checked<Vec<Local>> {
        let mut slots: Vec<Option<&'a Expr>> = vec![None; callee.parameters.len()];
        let mut next = 0;
        for argument in arguments {
            let place = match &argument.name {
                Some(name) => callee.parameters.iter().position(|parameter| parameter.name.text == name.text),
                None => {
                    next += 1;
                    Some(next - 1)
                }
            };
            match place.and_then(|place| slots.get_mut(place)) {
                Some(slot @ None) => *slot = Some(&argument.value),
                _ => return Err(self.wrong_count(callee, arguments, span)),
            }
        }
        let mut values = Vec::new();
        let mut failures = Failures::default();
        for (parameter, slot) in callee.parameters.iter().zip(slots) {
            let Some(expr) = slot else { return Err(self.wrong_count(callee, arguments, span)) };
            match self.value(expr) {
                Ok(value) => {
                    failures.catch(self.check_parameter(parameter, declared_in, &value, expr.span));
                    let definition = Some(DefinitionId { file: declared_in, span: parameter.name.span });
                    values.push(Local { name: parameter.name.text.clone(), value, definition });
                }
                Err(reported) => failures.add(reported),
            }
        }
        failures.or(values)
    }

    fn wrong_count(&mut self, callee: &Function, arguments: &[Argument], span: Span) -> Reported {
        let names: Vec<&str> = callee.parameters.iter().map(|parameter| parameter.name.text.as_str()).collect();
        let message = format!("`{}` does not take these arguments", callee.name.text);
        let diagnostic = self
            .diagnostic(codes::types::ARGUMENTS, span, message)
            .expected(format!("`{}({})`", callee.name.text, names.join(", ")))
            .found(format!("{} argument(s)", arguments.len()));
        self.report(offer_decimal_point(diagnostic, arguments))
    }

    /// Checks the value of a declaration against the annotation written beside its name.
    pub(crate) fn check_annotation(&mut self, annotation: Option<&Ident>, value: &Value) -> Checked<()> {
        let Some(annotation) = annotation else { return Ok(()) };
        let file = self.place.file;
        if self.is_of_type(annotation, file, value)? {
            return Ok(());
        }
        let message = format!("the value does not have the type `{}`", annotation.text);
        let diagnostic = self.diagnostic(codes::types::ANNOTATION, annotation.span, message);
        let diagnostic = self.compare_types(diagnostic, annotation, value);
        Err(self.report(diagnostic))
    }

    /// Checks an argument against the annotation of its parameter, which may stand in another file.
    fn check_parameter(&mut self, parameter: &Parameter, file: FileId, value: &Value, argument: Span) -> Checked<()> {
        let Some(annotation) = &parameter.annotation else { return Ok(()) };
        if self.is_of_type(annotation, file, value)? {
            return Ok(());
        }
        let message = format!("the argument `{}` does not have the type `{}`", parameter.name.text, annotation.text);
        let diagnostic =
            self.diagnostic(codes::types::ANNOTATION, argument, message).label(file, annotation.span, "expected here");
        let diagnostic = self.compare_types(diagnostic, annotation, value);
        Err(self.report(diagnostic))
    }

    fn compare_types(&self, diagnostic: Diagnostic, annotation: &Ident, value: &Value) -> Diagnostic {
        let found = match value {
            Value::Typed(data) => data.kind.described(self.vocabulary),
            Value::Entity(thing) => self.thing_name(*thing),
            Value::Entities { members, .. } => format!("{} parts of the body", members.len()),
        };
        let expected = Dimension::named(&annotation.text).map_or(annotation.text.clone(), Dimension::described);
        diagnostic.expected(expected).found(found)
    }

    /// Whether a value is of the type called so in `file`.
    fn is_of_type(&mut self, annotation: &Ident, file: FileId, value: &Value) -> Checked<bool> {
        let kind = if let Value::Typed(data) = value { Some(&data.kind) } else { None };
        let word = annotation.text.as_str();
        if OTHER_TYPES.contains(&word) {
            let one = kind.and_then(|kind| if let Type::One(element) = kind { Some(*element) } else { None });
            return Ok(matches!(
                (word, one, value),
                ("landmark", _, Value::Entity(EntityRef::Landmark(_)))
                    | ("joint", _, Value::Entity(EntityRef::Joint(_)))
                    | ("muscle", _, Value::Entity(EntityRef::Muscle(_)))
                    | ("bool", Some(ElementType::Bool), _)
                    | ("int", Some(ElementType::Int), _)
                    | ("duration", Some(ElementType::Steps), _)
                    | ("place", Some(ElementType::Place(_)), _)
                    | ("rotation", Some(ElementType::Rotation), _)
                    | ("vec2", Some(ElementType::Vector { size: 2, .. }), _)
                    | ("vec3", Some(ElementType::Vector { size: 3, .. }), _)
            ));
        }
        let Some(dimension) = Dimension::named(word) else {
            return Err(self.unknown_type(annotation, file));
        };
        let zero = matches!(value, Value::Typed(data) if data.is_zero());
        let number = |ty: &Type| ty.is_one_number() && ty.dimension() == Some(dimension);
        Ok(zero || kind.is_some_and(number))
    }

    fn unknown_type(&mut self, annotation: &Ident, file: FileId) -> Reported {
        let near = nearest(&annotation.text, Dimension::names().chain(OTHER_TYPES.iter().copied()));
        let message = format!("there is no type `{}`", annotation.text);
        let mut diagnostic = Diagnostic::new(codes::names::UNKNOWN_NAME, file, annotation.span, message);
        for name in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), annotation.span, name);
        }
        self.report(diagnostic)
    }

    /// `v in pelvis`, `v in heading(pelvis)`: the same vector counted in other axes; a place also moves its origin.
    pub(crate) fn in_frame(&mut self, value: &'a Expr, frame: &'a tree::Frame) -> Checked<TypedValue> {
        let data = self.value(value);
        let target = self.frame(frame);
        let (data, target) = (data?, target?);
        let data = match data {
            Value::Typed(data) => self.as_vector(data, Frame::World),
            other => return Err(self.not_numbers(&other, value.span)),
        };
        let own = match data.kind.element() {
            Some(ElementType::Vector { size: 3, frame, .. } | ElementType::Place(frame)) => frame,
            _ => {
                let found = data.kind.described(self.vocabulary);
                let message = "only places and vectors with three components can be expressed in another frame";
                let diagnostic = self.diagnostic(codes::types::FRAMES_DIFFER, value.span, message).found(found);
                return Err(self.report(diagnostic));
            }
        };
        if own == target {
            return Ok(data);
        }
        if own != Frame::World {
            let message = format!("this is already expressed in the frame of {}", own.name(self.vocabulary));
            let diagnostic = self
                .diagnostic(codes::types::FRAMES_DIFFER, value.span, message)
                .help("express the vector in the world frame first");
            return Err(self.report(diagnostic));
        }
        let count = data.kind.shape().count();
        let mut node = data.node;
        let is_place = matches!(data.kind.element(), Some(ElementType::Place(_)));
        if let (true, Frame::Landmark(index) | Frame::Heading(index)) = (is_place, target) {
            let origin = self.measured(vec![Sensor::LandmarkPosition(index)]);
            node = frames::from_origin(&mut self.graph, node, count, origin);
        }
        let node = self.express(node, count, target);
        let element = match data.kind.element() {
            Some(ElementType::Vector { size, dimension, .. }) => ElementType::Vector { size, dimension, frame: target },
            _ => ElementType::Place(target),
        };
        Ok(TypedValue::new(node, data.kind.with_element(element)))
    }

    fn frame(&mut self, frame: &'a tree::Frame) -> Checked<Frame> {
        if frame.name.text == "world" && !frame.heading {
            return Ok(Frame::World);
        }
        match self.name(&frame.name)? {
            Value::Entity(EntityRef::Landmark(index)) if frame.heading => Ok(Frame::Heading(index)),
            Value::Entity(EntityRef::Landmark(index)) => Ok(Frame::Landmark(index)),
            _ => {
                let message = format!("`{}` has no frame", frame.name.text);
                let diagnostic = self
                    .diagnostic(codes::types::FRAMES_DIFFER, frame.span, message)
                    .help("a frame is `world`, a landmark, or `heading(landmark)`");
                Err(self.report(diagnostic))
            }
        }
    }

    /// World components of `count` vectors as components along the axes of a frame.
    fn express(&mut self, vectors: NodeId, count: usize, frame: Frame) -> NodeId {
        let (Frame::Landmark(index) | Frame::Heading(index)) = frame else { return vectors };
        let mut axes = self.measured(vec![Sensor::LandmarkAxes(index)]);
        if matches!(frame, Frame::Heading(_)) {
            axes = frames::heading(&mut self.graph, axes);
        }
        frames::along_axes(&mut self.graph, vectors, count, axes)
    }

    /// Where parts of the body are.
    pub(crate) fn positions(&mut self, value: &Value, span: Span) -> Checked<TypedValue> {
        let (things, list) = match value {
            Value::Entity(thing) => (vec![*thing], false),
            Value::Entities { members, .. } => (members.clone(), true),
            Value::Typed(data) => return Ok(data.clone()),
        };
        let mut sensors = Vec::new();
        for thing in &things {
            match thing {
                EntityRef::Landmark(index) => sensors.push(Sensor::LandmarkPosition(*index)),
                EntityRef::CentreOfMass => sensors.push(Sensor::ComPosition),
                _ => return Err(self.not_numbers(value, span)),
            }
        }
        let node = self.measured(sensors);
        Ok(TypedValue::new(node, Type::one_or_list(ElementType::Place(Frame::World), list, things.len())))
    }
}
