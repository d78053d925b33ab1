//! A body file: from tree to [`BodyDescription`], all problems reported at their places.
//!
//! Names of the model are not known here; the runtime checks them when it binds the description to the model.

use super::context::{Checked, Checker, Settled};
use super::dimension::Dimension;
use crate::body::{Axis, BodyDescription, ExcitationMap, LandmarkDescription, TendonKind};
use crate::diagnostics::{Code, Diagnostic, FileId, Span, codes};
use crate::resolve::scope::{Names, Place};
use crate::syntax::tree::{
    Body, BodyGroup, BodyStatement, Element, ElementName, Expr, ExprKind, Field, FieldValue, Ident, Name, NamePart, Text,
    UnaryOperator,
};
use crate::vocabulary::Vocabulary;
use std::collections::BTreeMap;

/// Longest list that a brace pattern may unfold to.
const LONGEST_PATTERN: usize = 4096;

/// Describes a body, whose numbers may be constants in sight; without errors in `diagnostics` the description is whole.
pub(crate) fn describe<'a>(
    body: &'a Body,
    file: FileId,
    names: &'a Names<'a>,
    diagnostics: &mut Vec<Diagnostic>,
) -> BodyDescription {
    let nothing = Vocabulary::default();
    let mut checker = Checker::new(&nothing, names, Place { file, in_task: false }, &[]);
    checker.settled = Settled::default();
    let description = BodyDescription { name: body.name.text.clone(), ..BodyDescription::default() };
    let mut reader = Reader { file, checker, body: description, seen: BTreeMap::new() };
    for statement in &body.statements {
        reader.statement(statement);
    }
    let needed = [("model", "`model \"model.xml\"`"), ("root", "`root pelvis { forward x, up z }`")];
    let missing: Vec<_> = needed.into_iter().filter(|(word, _)| !reader.seen.contains_key(*word)).collect();
    if !missing.is_empty() {
        let words: Vec<String> = missing.iter().map(|(word, _)| format!("`{word}`")).collect();
        let message = format!("the body `{}` does not declare its {}", body.name.text, words.join(", "));
        let examples: Vec<&str> = missing.iter().map(|(_, example)| *example).collect();
        let diagnostic = Diagnostic::new(codes::tasks::MISSING, file, body.name.span, message)
            .help(format!("write {}", examples.join(", ")))
            .help("`msk new body NAME --model FILE` writes a body file for a model");
        reader.checker.report(diagnostic);
    }
    diagnostics.append(&mut reader.checker.diagnostics);
    reader.body
}

struct Reader<'a> {
    file: FileId,
    /// Evaluates numbers; it knows no body.
    checker: Checker<'a>,
    body: BodyDescription,
    /// Names and settings already there.
    seen: BTreeMap<String, Span>,
}

impl<'a> Reader<'a> {
    fn error(&mut self, code: &'static Code, span: Span, message: impl Into<String>) {
        self.checker.error(code, span, message);
    }

    /// Reports a name or setting that is there already.
    fn once(&mut self, name: &str, span: Span) {
        if let Some(first) = self.seen.insert(name.to_owned(), span) {
            let diagnostic =
                Diagnostic::new(codes::names::DECLARED_TWICE, self.file, span, format!("`{name}` is declared twice"));
            self.checker.report(diagnostic.here("again here").label(self.file, first, "first here"));
        }
    }

    fn statement(&mut self, statement: &'a BodyStatement) {
        match statement {
            BodyStatement::Model(path) => {
                self.once("model", path.span);
                self.body.model.clone_from(&path.value);
            }
            BodyStatement::Setting { name, value } => self.setting(name, value),
            BodyStatement::Element(element) => match element.kind.text.as_str() {
                "root" => self.root(element),
                "landmark" => self.landmark(element),
                other => {
                    let message = format!("a body has no `{other}`; it has a `root` and `landmark`s");
                    self.error(codes::tasks::UNKNOWN_SETTING, element.kind.span, message);
                }
            },
            BodyStatement::Group(group) => self.group(group),
            BodyStatement::Pose(pose) => {
                self.once(&format!("pose {}", pose.name.text), pose.name.span);
                let mut joints = Vec::new();
                for assignment in &pose.joints {
                    let value = self.coordinate(&assignment.value).ok();
                    for name in self.names(&assignment.target) {
                        joints.extend(value.map(|value| (name, value)));
                    }
                }
                self.body.poses.push((pose.name.text.clone(), joints));
            }
        }
    }

    fn setting(&mut self, name: &Ident, value: &Ident) {
        self.once(&name.text, name.span);
        match (name.text.as_str(), value.text.as_str()) {
            ("excitation", "linear") => self.body.excitation = ExcitationMap::Linear,
            ("excitation", "sigmoid") => self.body.excitation = ExcitationMap::Sigmoid,
            ("tendons", "rigid") => self.body.tendons = TendonKind::Rigid,
            ("tendons", "elastic") => self.body.tendons = TendonKind::Elastic,
            ("excitation" | "tendons", other) => {
                let choices = if name.text == "excitation" { "`linear` or `sigmoid`" } else { "`rigid` or `elastic`" };
                let message = format!("`{}` cannot be `{other}`; it is {choices}", name.text);
                self.error(codes::tasks::UNKNOWN_SETTING, value.span, message);
            }
            (other, _) => {
                let message = format!("a body has no setting `{other}`; it has `excitation` and `tendons`");
                self.error(codes::tasks::UNKNOWN_SETTING, name.span, message);
            }
        }
    }

    fn root(&mut self, element: &Element) {
        self.once("root", element.kind.span);
        match &element.name {
            Some(ElementName::Name(name)) => self.body.root.clone_from(&name.text),
            Some(ElementName::Quoted(text)) => self.body.root.clone_from(&text.value),
            None => self.error(codes::tasks::MISSING, element.kind.span, "the root does not declare a body of the model"),
        }
        let (mut forward, mut up) = (None, None);
        for field in &element.fields {
            match field.name.text.as_str() {
                "forward" => forward = self.axis(field),
                "up" => up = self.axis(field),
                _ => self.unknown_field(field, "`forward` and `up`"),
            }
        }
        match (forward, up) {
            (Some(forward), Some(up)) => {
                self.must_be_across(forward, up, element.kind.span);
                (self.body.root_forward, self.body.root_up) = (forward, up);
            }
            _ => self.error(codes::tasks::MISSING, element.kind.span, "the root must declare its axes `forward` and `up`"),
        }
    }

    fn must_be_across(&mut self, forward: Axis, up: Axis, span: Span) {
        let line = |axis| match axis {
            Axis::PlusX | Axis::MinusX => 0,
            Axis::PlusY | Axis::MinusY => 1,
            Axis::PlusZ | Axis::MinusZ => 2,
        };
        if line(forward) == line(up) {
            self.error(codes::tasks::OUT_OF_RANGE, span, "`forward` and `up` must be perpendicular");
        }
    }

    fn unknown_field(&mut self, field: &Field, known: &str) {
        let message = format!("there is no `{}` here; known names are {known}", field.name.text);
        self.error(codes::tasks::UNKNOWN_SETTING, field.name.span, message);
    }

    fn landmark(&mut self, element: &'a Element) {
        let Some(ElementName::Name(name)) = &element.name else {
            return self.error(codes::tasks::MISSING, element.kind.span, "a landmark needs a name");
        };
        let names = self.expand(name);
        let description = element.docs.as_ref().map_or(String::new(), |docs| docs.text.replace('\n', " ").trim().to_owned());
        let mut parts = LandmarkParts::default();
        for field in &element.fields {
            self.landmark_field(field, names.len(), &mut parts);
        }
        let missing: Vec<&str> = [
            ("on", parts.bodies.is_empty()),
            ("at", parts.point.is_none()),
            ("forward", parts.forward.is_none()),
            ("up", parts.up.is_none()),
        ]
        .iter()
        .filter(|(_, missing)| *missing)
        .map(|(word, _)| *word)
        .collect();
        let (Some(point), Some(forward), Some(up)) = (parts.point, parts.forward, parts.up) else {
            let message = format!("the landmark `{}` does not declare `{}`", name.text, missing.join("`, `"));
            return self.error(codes::tasks::MISSING, name.span, message);
        };
        self.must_be_across(forward, up, name.span);
        for (place, own) in names.into_iter().enumerate() {
            self.once(&own, name.span);
            let Some(body) = pick(&parts.bodies, place) else { continue };
            let segment = parts.segment.iter().filter_map(|shapes| pick(shapes, place)).cloned().collect();
            let description = description.clone();
            let landmark = LandmarkDescription { name: own, description, body: body.clone(), point, forward, up, segment };
            self.body.landmarks.push(landmark);
        }
    }

    fn landmark_field(&mut self, field: &'a Field, count: usize, parts: &mut LandmarkParts) {
        match (field.name.text.as_str(), &field.value) {
            ("on", FieldValue::Value(value) | FieldValue::On(value)) => {
                parts.bodies = self.names(value);
                self.must_pair(parts.bodies.len(), count, value.span);
            }
            ("at", FieldValue::Value(value)) => {
                // What is wrong is reported; that nothing is declared would be wrong to say.
                parts.point = Some(self.point(value).unwrap_or_default());
            }
            ("forward", _) => parts.forward = self.axis(field),
            ("up", _) => parts.up = self.axis(field),
            ("segment", FieldValue::Value(Expr { kind: ExprKind::List(shapes), .. })) => {
                for shape in shapes {
                    let names = self.names(shape);
                    if names.len() == count && count > 1 || names.len() == 1 {
                        parts.segment.push(names);
                    } else {
                        // A pattern inside a single landmark's segment simply lists its shapes.
                        parts.segment.extend(names.into_iter().map(|name| vec![name]));
                    }
                }
            }
            _ => self.unknown_field(field, "`on`, `at`, `forward`, `up` and `segment [...]`"),
        }
    }

    fn must_pair(&mut self, found: usize, count: usize, span: Span) {
        if found != count && found != 1 {
            let message = format!("these {found} names cannot be paired with {count}");
            self.error(codes::types::LENGTHS_DIFFER, span, message);
        }
    }

    fn axis(&mut self, field: &Field) -> Option<Axis> {
        let axis = match &field.value {
            FieldValue::Value(expr) => match &expr.kind {
                ExprKind::Unary { operator: UnaryOperator::Negate, operand } => word(operand).and_then(|w| axis_of(w, true)),
                _ => word(expr).and_then(|w| axis_of(w, false)),
            },
            _ => None,
        };
        if axis.is_none() {
            self.error(codes::tasks::UNKNOWN_SETTING, field.span, "an axis is one of x, y, z, -x, -y, -z");
        }
        axis
    }

    fn group(&mut self, group: &BodyGroup) {
        let members = self.names(&group.members);
        let names = self.expand(&group.name);
        match group.kind.text.as_str() {
            "joint" => {
                self.must_pair(members.len(), names.len(), group.members.span);
                for (place, name) in names.into_iter().enumerate() {
                    self.once(&name, group.name.span);
                    let joint = pick(&members, place).cloned();
                    self.body.joint_aliases.extend(joint.map(|joint| (name, joint)));
                }
            }
            "joints" | "muscles" | "landmarks" | "family" => {
                self.once(&group.name.text, group.name.span);
                self.must_not_repeat(&members, group.members.span);
                let entry = (group.name.text.clone(), members);
                match group.kind.text.as_str() {
                    "joints" => self.body.joint_groups.push(entry),
                    "landmarks" => self.body.landmark_groups.push(entry),
                    "muscles" => self.body.muscle_groups.push(entry),
                    _ => {
                        let title = group.title.as_ref().map_or(&group.name.text, |Text { value, .. }| value).clone();
                        self.body.families.push((title, entry.1.clone()));
                        self.body.muscle_groups.push(entry);
                    }
                }
            }
            other => {
                let message = format!("a body has no `{other}`; it has groups of `joints`, `muscles`, `landmarks`, and `family`");
                self.error(codes::tasks::UNKNOWN_SETTING, group.kind.span, message);
            }
        }
    }

    fn must_not_repeat(&mut self, members: &[String], span: Span) {
        let mut sorted: Vec<&String> = members.iter().collect();
        sorted.sort();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            let message = format!("`{}` occurs twice in this list", pair[0]);
            self.error(codes::names::DECLARED_TWICE, span, message);
        }
    }

    /// A coordinate of a joint: an angle or a length, of which the model decides.
    fn coordinate(&mut self, value: &'a Expr) -> Checked<f64> {
        let data = self.checker.data(value)?;
        let found = data.kind.dimension().filter(|_| data.kind.is_one_number());
        let dimension = match found {
            Some(dimension @ (Dimension::ANGLE | Dimension::LENGTH)) => dimension,
            _ if data.is_zero() => Dimension::ANGLE,
            _ => {
                let found = data.kind.described(self.checker.vocabulary);
                let message = format!("a coordinate is an angle or a length, found {found}");
                return Err(self.checker.error(codes::types::DIMENSIONS_DIFFER, value.span, message));
            }
        };
        self.checker.known_number(&data, value, dimension, "a coordinate")
    }

    /// A point in the frame of a model's body; plain numbers are metres, as in the model file.
    fn point(&mut self, value: &'a Expr) -> Checked<[f64; 3]> {
        let data = self.checker.data(value)?;
        let plain = data.kind.dimension() == Some(Dimension::NONE);
        let dimension = if plain { Dimension::NONE } else { Dimension::LENGTH };
        self.checker.must_be_bracket(&data, 3, dimension, value.span, "`at`")?;
        self.checker.known_bracket(&data, value.span, "`at`")
    }

    /// The names that an expression lists: a name, a quoted name, a selector, or a bracket of them.
    fn names(&mut self, expr: &Expr) -> Vec<String> {
        match &expr.kind {
            ExprKind::Name(name) => self.expand(name),
            ExprKind::Text(text) => vec![text.clone()],
            ExprKind::Selector { pattern, .. } => vec![pattern.value.clone()],
            ExprKind::List(elements) => elements.iter().flat_map(|element| self.names(element)).collect(),
            ExprKind::Error(_) => Vec::new(),
            _ => {
                self.error(codes::types::WRONG_TYPE, expr.span, "expected names of the model");
                Vec::new()
            }
        }
    }

    fn expand(&mut self, name: &Name) -> Vec<String> {
        let mut texts = vec![String::new()];
        for part in &name.parts {
            let choices: Vec<String> = match part {
                NamePart::Literal(text) => vec![text.clone()],
                NamePart::Words(words) => words.clone(),
                NamePart::Range(low, high) if (high.saturating_sub(*low) as usize) <= LONGEST_PATTERN => {
                    (*low..*high).map(|number| number.to_string()).collect()
                }
                _ => Vec::new(),
            };
            if choices.is_empty() || texts.len() * choices.len() > LONGEST_PATTERN {
                let message = "in a body file every name is written in full, or listed in braces: `_{l,r}`";
                self.error(codes::names::NOTHING_FITS, name.span, message);
                return Vec::new();
            }
            texts = texts.iter().flat_map(|text| choices.iter().map(move |choice| format!("{text}{choice}"))).collect();
        }
        texts
    }
}

#[derive(Default)]
struct LandmarkParts {
    bodies: Vec<String>,
    point: Option<[f64; 3]>,
    forward: Option<Axis>,
    up: Option<Axis>,
    /// Each shape: one name for all sides, or one per side.
    segment: Vec<Vec<String>>,
}

/// The entry for one side: the only one, or the one at the same place.
fn pick<T>(entries: &[T], place: usize) -> Option<&T> {
    if entries.len() == 1 { entries.first() } else { entries.get(place) }
}

fn word(expr: &Expr) -> Option<&str> {
    if let ExprKind::Name(name) = &expr.kind { Some(&name.text) } else { None }
}

fn axis_of(word: &str, negative: bool) -> Option<Axis> {
    Some(match (word, negative) {
        ("x", false) => Axis::PlusX,
        ("x", true) => Axis::MinusX,
        ("y", false) => Axis::PlusY,
        ("y", true) => Axis::MinusY,
        ("z", false) => Axis::PlusZ,
        ("z", true) => Axis::MinusZ,
        _ => return None,
    })
}
