//! What is held to what, places that are shown, and forces that disturb: their formulas see the whole vocabulary.

use crate::check::context::{Checked, Checker, Failures, Step};
use crate::check::dimension::Dimension;
use crate::check::scene::expand::Unrolled;
use crate::check::types::{ElementType, Frame, Type};
use crate::check::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::{Span, codes};
use crate::graph::NodeId;
use crate::graph::operation::Binary;
use crate::numbers::for_people;
use crate::scene::{Connection, SceneDescription};
use crate::syntax::tree::{self, Element, ElementName, Expr, Field, Marker, TaskStatement};
use crate::task::{Disturbance, DisturbanceSetting};

/// Connections of a scene, and when those that let go do so.
type Connections = (Vec<Connection>, Vec<(usize, NodeId)>);

/// Numbers of a disturbance that are drawn.
type Drawn = Vec<(DisturbanceSetting, NodeId)>;

/// The whole scene of a task, and the types of its formulas.
#[derive(Debug, Default)]
pub(crate) struct Staged {
    pub scene: SceneDescription,
    /// Connections that let go, with the conditions.
    pub releases: Vec<(usize, NodeId)>,
    pub markers: Vec<(String, NodeId)>,
    /// Objects that formulas of time move, with what they do in a control step.
    pub drives: Vec<(usize, NodeId)>,
    pub disturbances: Vec<Disturbance>,
    /// Numbers of these that are drawn.
    pub drawn: Vec<(usize, DisturbanceSetting, NodeId)>,
}

impl<'a> Checker<'a> {
    /// Completes the scene by what sees the whole vocabulary.
    pub(crate) fn staged(&mut self) -> Checked<Staged> {
        let scene = self.scene.map(|scene| scene.description.clone()).unwrap_or_default();
        let statements = self.statements;
        let (mut disturbances, mut drawn) = (Vec::new(), Vec::new());
        let mut failures = Failures::default();
        for placed in statements {
            if let TaskStatement::Disturb(element) = &placed.statement {
                match self.in_file(placed.file, |checker| checker.disturbance(element)) {
                    Ok((disturbance, numbers)) => {
                        drawn.extend(numbers.into_iter().map(|(setting, node)| (disturbances.len(), setting, node)));
                        disturbances.push(disturbance);
                    }
                    Err(reported) => failures.add(reported),
                }
            }
        }
        let (connections, markers, drives) = (self.connections(), self.markers(), self.drives());
        let ((connections, releases), markers, drives) = (connections?, markers?, drives?);
        failures.or(())?;
        Ok(Staged { scene: SceneDescription { connections, ..scene }, releases, markers, drives, disturbances, drawn })
    }

    /// The welds and connections of the scene.
    fn connections(&mut self) -> Checked<Connections> {
        let Some(scene) = self.scene else { return Ok(Connections::default()) };
        let (mut connections, mut releases) = Connections::default();
        let mut failures = Failures::default();
        for Unrolled { statement, locals, file, .. } in &scene.statements.connections {
            match self.in_file(*file, |checker| checker.with_locals(locals, |checker| checker.connection(statement))) {
                Ok((held, release)) => {
                    releases.extend(release.map(|node| (connections.len(), node)));
                    connections.push(held);
                }
                Err(reported) => failures.add(reported),
            }
        }
        failures.or((connections, releases))
    }

    fn connection(&mut self, connection: &'a tree::Connection) -> Checked<(Connection, Option<NodeId>)> {
        let (from, to) = (self.end(&connection.from), self.end(&connection.to));
        let release = connection.release.as_ref().map(|condition| self.single_condition(condition)).transpose();
        let (from, to, release) = (from?, to?, release?);
        if from == to {
            return Err(self.error(codes::scene::MOTION, connection.span, "an object cannot be connected to itself"));
        }
        let still = |index: usize| self.stands_still(index);
        if still(from) && still(to) {
            let message = "both ends are fixed: the connection has no effect";
            return Err(self.error(codes::scene::MOTION, connection.span, message));
        }
        let name = |index: usize| self.vocabulary.landmarks[index].name.clone();
        let held = Connection { weld: connection.kind.text == "weld", from: name(from), to: name(to), here: connection.here };
        Ok((held, release.map(|condition| condition.node)))
    }

    /// An end of a connection: a landmark of the body or an object.
    fn end(&mut self, expr: &'a Expr) -> Checked<usize> {
        match self.value(expr)? {
            Value::Entity(EntityRef::Landmark(index)) => Ok(index),
            other => {
                let found = match &other {
                    Value::Entity(thing) => self.thing_name(*thing),
                    Value::Entities { .. } => "a list of entities".to_owned(),
                    Value::Typed(data) => data.kind.described(self.vocabulary),
                };
                let diagnostic = self
                    .diagnostic(codes::types::WRONG_TYPE, expr.span, "expected the name of a landmark or an object")
                    .found(found)
                    .help("name a place on an object with a point: `point grip { at [0, 0.15 m, 0] }`, then `bar.grip`");
                Err(self.report(diagnostic))
            }
        }
    }

    /// The places that are shown.
    fn markers(&mut self) -> Checked<Vec<(String, NodeId)>> {
        let Some(scene) = self.scene else { return Ok(Vec::new()) };
        let mut markers: Vec<(String, NodeId)> = Vec::new();
        let mut failures = Failures::default();
        for Unrolled { statement: marker, name, locals, file, .. } in &scene.statements.markers {
            let name = name.clone().unwrap_or_default();
            let found = self.in_file(*file, |checker| {
                let place = checker.with_locals(locals, |checker| checker.marked_place(&marker.at))?;
                if markers.iter().any(|(known, _)| *known == name) {
                    let message = format!("the marker `{name}` is declared twice");
                    return Err(checker.error(codes::tasks::LABEL_TWICE, marker.span, message));
                }
                Ok(place)
            });
            match found {
                Ok(node) => markers.push((name, node)),
                Err(reported) => failures.add(reported),
            }
        }
        failures.or(markers)
    }

    /// Whether a name is that of a marker, which nothing else is called.
    pub(in crate::check) fn is_marker(&self, name: &str) -> bool {
        let declared = self.names.find(self.place, name).is_some() || self.body_element(name).is_some();
        !declared && self.marker_called(name).is_some()
    }

    fn marker_called(&self, name: &str) -> Option<&'a Unrolled<'a, Marker>> {
        self.scene?.statements.markers.iter().find(|marker| marker.name.as_deref() == Some(name))
    }

    /// The place of a marker, where a formula reads it.
    pub(in crate::check) fn marker(&mut self, name: &str, span: Span) -> Option<Checked<TypedValue>> {
        let Unrolled { statement, locals, file, .. } = self.marker_called(name)?;
        let step = Step { name: format!("marker {name}"), file: self.place.file, span, call: false };
        if self.path.iter().any(|known| known.name == step.name) {
            let message = format!("the marker `{name}` depends on itself");
            return Some(Err(self.error(codes::names::CYCLE, span, message)));
        }
        self.path.push(step);
        let node = self.in_file(*file, |checker| checker.with_locals(locals, |checker| checker.marked_place(&statement.at)));
        self.path.pop();
        Some(node.map(|node| TypedValue::new(node, ElementType::Place(Frame::World))))
    }

    fn marked_place(&mut self, expr: &'a Expr) -> Checked<NodeId> {
        let value = self.value(expr)?;
        let data = self.positions(&value, expr.span)?;
        let length = |data: &TypedValue| data.kind.dimension() == Some(Dimension::LENGTH) || data.is_zero();
        let fits = match &data.kind {
            Type::One(ElementType::Place(Frame::World)) => true,
            Type::One(ElementType::Vector { size: 3, frame: Frame::World, .. }) => length(&data),
            list => list.length() == Some(3) && data.is_bracket() && length(&data),
        };
        if fits {
            return Ok(data.node);
        }
        let found = data.kind.described(self.vocabulary);
        let diagnostic = self
            .diagnostic(codes::types::WRONG_TYPE, expr.span, "a marker needs a place")
            .expected("a place (world frame)")
            .found(found);
        Err(self.report(diagnostic))
    }

    /// `disturb pelvis { force [50 N, 0, 0], at 3 s, for 0.1 s, every 2 s }`, with the numbers in it that are drawn.
    fn disturbance(&mut self, element: &'a Element) -> Checked<(Disturbance, Drawn)> {
        let Some(ElementName::Name(name)) = &element.name else {
            return Err(self.error(codes::tasks::MISSING, element.span, "`disturb` needs a landmark or an object"));
        };
        let landmark = match self.name(name)? {
            Value::Entity(EntityRef::Landmark(index)) if !self.stands_over_episode(index) => index,
            Value::Entity(EntityRef::Landmark(_)) => {
                return Err(self.error(
                    codes::scene::MOTION,
                    name.span,
                    format!("`{}` is fixed: a force has no effect", name.text),
                ));
            }
            _ => {
                let message = "a force applies to a landmark of the body or to an object that moves";
                return Err(self.error(codes::types::WRONG_TYPE, name.span, message));
            }
        };
        let mut disturbance = Disturbance { landmark, force: [0.0; 3], torque: [0.0; 3], start: 0, steps: 0, every: 0 };
        let mut drawn = Drawn::new();
        let mut seen: Vec<&str> = Vec::new();
        for field in &element.fields {
            let word = field.name.text.as_str();
            if seen.contains(&word) {
                return Err(self.error(codes::tasks::REPEATED, field.span, format!("`{word}` is given twice")));
            }
            seen.push(word);
            match word {
                "force" | "torque" => {
                    let is_force = word == "force";
                    let dimension = if is_force { Dimension::FORCE } else { Dimension::TORQUE };
                    let setting = if is_force { DisturbanceSetting::Force } else { DisturbanceSetting::Torque };
                    let (node, place) = self.pushing(field, dimension)?;
                    for axis in 0..3 {
                        let part = self.graph.select([axis], node);
                        self.disturb(part, setting(axis), (word, place), &mut disturbance, &mut drawn)?;
                    }
                }
                "at" => {
                    let expr = self.field_value(field)?;
                    match self.drawn_steps(expr)? {
                        Some(steps) => {
                            let setting = DisturbanceSetting::Start;
                            self.disturb(steps, setting, (word, expr.span), &mut disturbance, &mut drawn)?;
                        }
                        None => disturbance.start = self.steps(expr)? as u32,
                    }
                }
                "every" => {
                    let expr = self.field_value(field)?;
                    disturbance.every = self.steps(expr)? as u32;
                }
                "for" => {
                    let expr = self.field_value(field)?;
                    disturbance.steps = self.steps(expr)? as u32;
                }
                _ => {
                    let message = format!("a disturbance has no `{word}`");
                    let diagnostic = self
                        .diagnostic(codes::tasks::UNKNOWN_SETTING, field.name.span, message)
                        .help("write `disturb pelvis { force [50 N, 0, 0], at 3 s, for 0.1 s }`; `torque [0, 0, 5 N*m]` and `every 2 s` as well");
                    return Err(self.report(diagnostic));
                }
            }
        }
        let pushes = seen.contains(&"force") || seen.contains(&"torque");
        if !pushes || !seen.contains(&"at") || disturbance.steps == 0 {
            let diagnostic = self
                .diagnostic(
                    codes::tasks::MISSING,
                    element.span,
                    "a disturbance needs a force or torque, a start time and a duration",
                )
                .help("write `disturb pelvis { force [50 N, 0, 0], at 3 s, for 0.1 s }`");
            return Err(self.report(diagnostic));
        }
        self.lasts_within(element, &disturbance, seen.contains(&"every"))?;
        Ok((disturbance, drawn))
    }

    /// The force or torque of a disturbance: three components.
    fn pushing(&mut self, field: &'a Field, dimension: Dimension) -> Checked<(NodeId, Span)> {
        let expr = self.field_value(field)?;
        let data = match self.value(expr)? {
            Value::Typed(data) => data,
            other => return Err(self.not_numbers(&other, expr.span)),
        };
        self.must_be_bracket(&data, 3, dimension, expr.span, &format!("`{}`", field.name.text))?;
        Ok((data.node, expr.span))
    }

    /// A time that is drawn, in control steps; `None` for what else there is.
    fn drawn_steps(&mut self, expr: &'a Expr) -> Checked<Option<NodeId>> {
        let data = self.data(expr)?;
        if self.graph.constant_value(data.node).is_some() {
            return Ok(None);
        }
        Ok(match data.kind {
            Type::One(ElementType::Steps) => Some(data.node),
            Type::One(ElementType::Number(Dimension::TIME)) => {
                let interval = self.graph.constant(self.timing.interval);
                Some(self.graph.binary(Binary::Divide, data.node, interval))
            }
            _ => None,
        })
    }

    /// Writes a number that is known; keeps one that is drawn.
    fn disturb(
        &mut self,
        node: NodeId,
        setting: DisturbanceSetting,
        (word, span): (&str, Span),
        disturbance: &mut Disturbance,
        drawn: &mut Drawn,
    ) -> Checked<()> {
        let wanted_by = format!("`{word}`");
        match self.graph.constant_value(node) {
            Some(value) if value.is_finite() => setting.set(value, disturbance),
            Some(_) => {
                let message = format!("{wanted_by} takes finite numbers");
                return Err(self.error(codes::types::WRONG_TYPE, span, message));
            }
            None => {
                self.must_be_drawn(node, span, &wanted_by)?;
                drawn.push((setting, node));
            }
        }
        Ok(())
    }

    /// Whether a disturbance starts and lasts within the episode, and ends before it is repeated.
    fn lasts_within(&mut self, element: &Element, disturbance: &Disturbance, repeats: bool) -> Checked<()> {
        let horizon = self.timing.horizon;
        let (message, expected, found) = if disturbance.start >= horizon {
            ("the disturbance starts after the end of the episode", "the task's horizon", disturbance.start)
        } else if disturbance.steps > horizon {
            ("the duration is longer than the episode", "the task's horizon", disturbance.steps)
        } else if repeats && disturbance.every <= disturbance.steps {
            ("the disturbance is repeated before it ends", "", disturbance.every)
        } else {
            return Ok(());
        };
        let in_words = |steps: u32| format!("{steps} steps ({} s)", for_people(f64::from(steps) * self.timing.interval));
        let expected = match expected {
            "" => format!("`every` longer than {}, its duration", in_words(disturbance.steps)),
            what => format!("within {}, {what}", in_words(horizon)),
        };
        let diagnostic = self.diagnostic(codes::tasks::OUT_OF_RANGE, element.span, message);
        Err(self.report(diagnostic.expected(expected).found(in_words(found))))
    }
}
