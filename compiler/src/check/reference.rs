//! `reference`: a motion that an episode follows from a phase on. All that is read of it is read at one and the same time.
//!
//! The graph holds the phase in turns, `start + t / duration`, where `start` is a number, or a random with a stream of its own.
//! Every signal of the motion is a [`Track`] of its table at that time.

use super::context::{Checked, Checker, Reported};
use super::dimension::Dimension;
use super::random::KnownRandom;
use super::signals::{self, Owner};
use super::types::{ElementType, Frame, Type};
use super::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::{Diagnostic, FileId, Span, codes, nearest};
use crate::emit::motion::MotionClock;
use crate::emit::{draws, motion};
use crate::graph::NodeId;
use crate::graph::operation::Chance;
use crate::graph::track::Track;
use crate::motion::{Motion, RootPart};
use crate::numbers::for_people;
use crate::resolve::scope::Definition;
use crate::syntax::tree::{Argument, Expr, ExprKind, Name, Reference, TaskStatement, Text};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A motion that was read, and from which file.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    pub file: FileId,
    pub motion: Arc<Motion>,
}

/// Motions by the file that names them and the path as it stands there, as far as they could be read.
pub(crate) type Tables = BTreeMap<(FileId, String), Checked<Table>>;

/// Places of a body's landmarks at the rows of a motion; why there are none, in words.
pub(crate) type Trace<'a> = &'a dyn Fn(&Motion) -> Result<Vec<Vec<[f64; 3]>>, String>;

/// The motions in sight of a task.
#[derive(Clone, Copy)]
pub(crate) struct Motions<'a> {
    pub tables: &'a Tables,
    pub trace: Trace<'a>,
}

/// A reference whose motion and start are checked.
#[derive(Debug, Clone)]
pub(crate) struct KnownReference {
    pub name: String,
    pub motion: Arc<Motion>,
    /// The same with the places of landmarks, once one is read.
    sites: Option<Arc<Motion>>,
    /// The phase at which an episode starts, 0 to 1.
    pub start: NodeId,
}

/// At how many times of a motion the places of landmarks are computed.
const PLACES: usize = 200;

impl<'a> Checker<'a> {
    /// Checks all references, in the order of the text.
    pub(crate) fn references(&mut self) {
        let statements = self.statements;
        for placed in statements {
            if let TaskStatement::Reference(reference) = &placed.statement {
                match self.in_file(placed.file, |checker| checker.declare_reference(reference, placed.file)) {
                    Ok(known) => self.references.push(known),
                    Err(reported) => {
                        self.broken_references.insert(reference.name.text.clone(), reported);
                    }
                }
            }
        }
    }

    fn declare_reference(&mut self, reference: &'a Reference, file: FileId) -> Checked<KnownReference> {
        let start = self.start(reference);
        let table = self.table(file, &reference.motion)?;
        let problems = crate::motion::problems(&table.motion, table.file, self.vocabulary);
        let misfit = Reported::among(&problems);
        self.diagnostics.extend(problems);
        misfit.map_or(Ok(()), Err)?;
        Ok(KnownReference { name: reference.name.text.clone(), motion: table.motion.clone(), sites: None, start: start? })
    }

    /// The table of a motion that `file` names; one that could not be read is reported there.
    pub(crate) fn table(&mut self, file: FileId, named: &Text) -> Checked<Table> {
        let known = self.motions.and_then(|motions| motions.tables.get(&(file, named.value.clone())));
        match known {
            Some(table) => table.clone(),
            None => Err(self.error(codes::composition::MOTION, named.span, "this is not a motion")),
        }
    }

    /// A reference by its name, or why there is none.
    pub(crate) fn known_reference(&mut self, name: &str, span: Span) -> Checked<usize> {
        if let Some(index) = self.references.iter().position(|known| known.name == name) {
            return Ok(index);
        }
        match self.broken_references.get(name) {
            Some(reported) => Err(*reported),
            None => Err(self.error(codes::names::UNKNOWN_NAME, span, format!("the reference `{name}` is not known yet here"))),
        }
    }

    /// The phase at which an episode starts.
    fn start(&mut self, reference: &'a Reference) -> Checked<NodeId> {
        let Some(start) = &reference.start else { return Ok(self.graph.constant(0.0)) };
        if matches!(&start.kind, ExprKind::Name(name) if name.text == "uniform") {
            let index = self.randoms.len();
            let drawn = draws::noise(&mut self.graph, index, Chance::Uniform, 1);
            let node = draws::held(&mut self.graph, index, &[drawn]);
            let name = format!("{}.start", reference.name.text);
            self.randoms.push(KnownRandom {
                name,
                data: TypedValue::new(node, ElementType::PLAIN),
                redraw: None,
                written: Some(["uniform(0 .. 1)".to_owned(), String::new()]),
                parameter: None,
            });
            return Ok(node);
        }
        let data = self.number_of(start, Dimension::NONE, "`start`")?;
        match self.graph.constant_value(data.node) {
            Some(phase) if !(0.0..=1.0).contains(&phase) => {
                let diagnostic = self
                    .diagnostic(codes::composition::MOTION, start.span, "a motion starts at a constant or random phase")
                    .expected("a number from 0 to 1, or `uniform`")
                    .found(for_people(phase));
                Err(self.report(diagnostic))
            }
            Some(_) => Ok(data.node),
            None => self.must_be_drawn(data.node, start.span, "`start`").map(|()| data.node),
        }
    }

    /// Whether an expression is the name of a reference; its place among those known.
    fn reference_named(&mut self, base: &Expr) -> Option<Checked<usize>> {
        let ExprKind::Name(name) = &base.kind else { return None };
        let (declared, _) = self.names.find(self.place, &name.text)?;
        if !matches!(declared.definition, Definition::Reference(_)) || self.locals.iter().any(|local| local.name == name.text) {
            return None;
        }
        self.used.insert(name.text.clone());
        Some(self.known_reference(&name.text, name.span))
    }

    /// `gait.phase`, `gait.q(knee_angle_r)`; `None` if the base is no reference.
    pub(crate) fn of_reference(
        &mut self,
        base: &Expr,
        name: &Name,
        arguments: Option<&'a [Argument]>,
        span: Span,
    ) -> Option<Checked<Value>> {
        let index = self.reference_named(base)?;
        Some(index.and_then(|index| self.motion_signal(index, name, arguments, span)))
    }

    fn motion_signal(&mut self, index: usize, name: &Name, arguments: Option<&'a [Argument]>, span: Span) -> Checked<Value> {
        let takes = |word: &str| matches!(word, "q" | "qd" | "site");
        if let (Some(arguments), false) = (arguments, takes(&name.text))
            && signals::find(Owner::Reference, &name.text).is_some()
        {
            let message = format!("`{}` takes no arguments", name.text);
            let place = arguments.first().map_or(name.span, |argument| argument.value.span);
            return Err(self.error(codes::types::ARGUMENTS, place, message));
        }
        match name.text.as_str() {
            "phase" => Ok(Value::Typed(self.motion_phase(index))),
            "joints" => Ok(Value::Entities { members: self.motion_joints(index), group: true }),
            "q" => self.motion_joint(index, arguments, false, span).map(Value::Typed),
            "qd" => self.motion_joint(index, arguments, true, span).map(Value::Typed),
            "root" => self.motion_root(index, span).map(Value::Typed),
            "velocity" => self.motion_velocity(index, span).map(Value::Typed),
            "heading" => self.motion_turn(index, RootPart::Heading, span).map(Value::Typed),
            "pitch" => self.motion_turn(index, RootPart::Pitch, span).map(Value::Typed),
            "roll" => self.motion_turn(index, RootPart::Roll, span).map(Value::Typed),
            "site" => self.motion_site(index, arguments, span).map(Value::Typed),
            other => {
                let known: Vec<&str> = signals::of(Owner::Reference).map(|signal| bare(signal.name)).collect();
                let message = format!("a motion has no `{other}`");
                let mut diagnostic = self.diagnostic(codes::names::UNKNOWN_PROPERTY, name.span, message);
                for near in nearest(other, known.iter().copied()) {
                    diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), name.span, near);
                }
                let diagnostic = diagnostic.help(format!("it has {}", known.join(", ")));
                Err(self.report(diagnostic))
            }
        }
    }

    /// When an episode of this task reads a motion.
    fn clock_of(&self, index: usize) -> MotionClock {
        let KnownReference { start, motion, .. } = &self.references[index];
        MotionClock { start: *start, duration: motion.duration, interval: self.timing.interval }
    }

    fn motion_phase(&mut self, index: usize) -> TypedValue {
        let node = self.clock_of(index).phase(&mut self.graph, self.references[index].motion.cycle);
        TypedValue::new(node, ElementType::PLAIN)
    }

    /// The joints that a motion moves, in the order of its columns.
    pub(crate) fn motion_joints(&self, index: usize) -> Vec<EntityRef> {
        let joints = &self.vocabulary.joints;
        let place = |name: &str| joints.iter().position(|joint| joint.name == name).map(EntityRef::Joint);
        self.references[index].motion.joints().filter_map(place).collect()
    }

    /// Columns of a motion, or their rates, at the present time.
    fn follow(&mut self, index: usize, motion: Arc<Motion>, columns: Vec<usize>, rates: bool) -> NodeId {
        let time = self.clock_of(index).now(&mut self.graph);
        motion::columns(&mut self.graph, Track { motion, columns, rates }, time)
    }

    /// `gait.q(knee_angle_r)`, `gait.q(legs)`, `gait.q`: of all joints that the motion moves.
    fn motion_joint(&mut self, index: usize, arguments: Option<&'a [Argument]>, rates: bool, span: Span) -> Checked<TypedValue> {
        let (things, list, place) = match arguments {
            None => (self.motion_joints(index), true, span),
            Some([Argument { name: None, value }]) => match self.value(value)? {
                Value::Entity(thing) => (vec![thing], false, value.span),
                Value::Entities { members, .. } => (members, true, value.span),
                Value::Typed(_) => (Vec::new(), false, value.span),
            },
            Some(_) => return Err(self.one_argument("a joint, or a list of joints", span)),
        };
        if things.is_empty() || !things.iter().all(|thing| matches!(thing, EntityRef::Joint(_))) {
            let message = "this signal takes joints";
            let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, place, message).help("write `gait.q(knee_angle_r)`");
            return Err(self.report(diagnostic));
        }
        self.spend(things.len(), span)?;
        let vocabulary = self.vocabulary;
        let motion = self.references[index].motion.clone();
        let (mut columns, mut dimensions, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for thing in &things {
            let EntityRef::Joint(joint) = thing else { continue };
            match motion.joint(&vocabulary.joints[*joint].name) {
                Some(column) => {
                    let dimension = motion.columns[column].dimension;
                    let rate = dimension.per(Dimension::TIME).unwrap_or(dimension);
                    dimensions.push(if rates { rate } else { dimension });
                    columns.push(column);
                }
                None => missing.push(vocabulary.joints[*joint].name.as_str()),
            }
        }
        if !missing.is_empty() {
            return Err(self.says_nothing(index, &missing, things.len(), place));
        }
        let kind = if list { Type::numbers(dimensions) } else { ElementType::Number(dimensions[0]).into() };
        Ok(TypedValue::new(self.follow(index, motion, columns, rates), kind))
    }

    /// The motion has no column for these joints.
    fn says_nothing(&mut self, index: usize, missing: &[&str], asked: usize, span: Span) -> Reported {
        let known = &self.references[index];
        let of = if asked == 1 {
            format!("the joint `{}`", missing[0])
        } else if missing.len() == 1 {
            format!("`{}`, one of these {asked} joints", missing[0])
        } else {
            format!("{} of these {asked} joints: {}", missing.len(), few(missing))
        };
        let message = format!("the motion `{}` has no {of}", known.motion.name);
        let near: Vec<String> = match missing {
            [only] if asked == 1 => nearest(only, known.motion.joints()).into_iter().map(str::to_owned).collect(),
            _ => Vec::new(),
        };
        let help = format!("`{}.joints` are the joints with a column", known.name);
        let mut diagnostic = self.diagnostic(codes::composition::MOTION, span, message);
        for near in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), span, near);
        }
        let diagnostic = diagnostic.help(help);
        self.report(diagnostic)
    }

    /// The columns of coordinates of the root, all of which must be there.
    fn root_columns(&mut self, index: usize, parts: &[RootPart], span: Span) -> Checked<Vec<usize>> {
        let motion = self.references[index].motion.clone();
        let columns: Vec<Option<usize>> = parts.iter().map(|part| motion.root(*part)).collect();
        let missing: Vec<&str> =
            parts.iter().zip(&columns).filter(|(_, column)| column.is_none()).map(|(part, _)| part.heading()).collect();
        if missing.is_empty() {
            return Ok(columns.into_iter().flatten().collect());
        }
        let message = format!("the motion `{}` has no column for this", motion.name);
        let diagnostic =
            self.diagnostic(codes::composition::MOTION, span, message).expected(missing.join(", ")).help("add it to its table");
        Err(self.report(diagnostic))
    }

    /// Where the root should be: as far from where it began as the motion has taken it, at the motion's height.
    fn motion_root(&mut self, index: usize, span: Span) -> Checked<TypedValue> {
        let columns = self.root_columns(index, &[RootPart::X, RootPart::Y, RootPart::Height], span)?;
        let motion = self.references[index].motion.clone();
        let node = self.carried(index, motion, columns);
        Ok(TypedValue::new(node, ElementType::Place(Frame::World)))
    }

    /// Where something of the motion is that has columns x, y and z, when the motion starts under the root.
    fn carried(&mut self, index: usize, motion: Arc<Motion>, columns: Vec<usize>) -> NodeId {
        let level: Vec<usize> = [RootPart::X, RootPart::Y].into_iter().filter_map(|part| motion.root(part)).collect();
        let track = |columns: Vec<usize>| Track { motion: motion.clone(), columns, rates: false };
        let clock = self.clock_of(index);
        motion::carried(&mut self.graph, clock, track(columns), track(level))
    }

    fn motion_velocity(&mut self, index: usize, span: Span) -> Checked<TypedValue> {
        let columns = self.root_columns(index, &[RootPart::X, RootPart::Y, RootPart::Height], span)?;
        let motion = self.references[index].motion.clone();
        Ok(TypedValue::new(self.follow(index, motion, columns, true), ElementType::world_vector(Dimension::SPEED)))
    }

    fn motion_turn(&mut self, index: usize, part: RootPart, span: Span) -> Checked<TypedValue> {
        let columns = self.root_columns(index, &[part], span)?;
        let motion = self.references[index].motion.clone();
        Ok(TypedValue::new(self.follow(index, motion, columns, false), ElementType::WrappingAngle))
    }

    /// `gait.site(ankle_r)`: where a landmark should be.
    fn motion_site(&mut self, index: usize, arguments: Option<&'a [Argument]>, span: Span) -> Checked<TypedValue> {
        let Some([Argument { name: None, value }]) = arguments else {
            return Err(self.one_argument("a landmark, or a list of landmarks", span));
        };
        let (things, list) = match self.value(value)? {
            Value::Entity(thing) => (vec![thing], false),
            Value::Entities { members, .. } => (members, true),
            Value::Typed(_) => (Vec::new(), false),
        };
        let landmark = |thing: &EntityRef| match thing {
            EntityRef::Landmark(place) if !self.vocabulary.landmarks[*place].of_scene => Some(*place),
            _ => None,
        };
        let Some(landmarks) = things.iter().map(landmark).collect::<Option<Vec<usize>>>().filter(|all| !all.is_empty()) else {
            let message = "this signal takes landmarks";
            let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, value.span, message).help("write `gait.site(ankle_r)`");
            return Err(self.report(diagnostic));
        };
        self.spend(things.len(), span)?;
        self.root_columns(index, &[RootPart::X, RootPart::Y, RootPart::Height], span)?;
        let motion = self.traced(index, span)?;
        let mut places = Vec::new();
        for landmark in landmarks {
            let Some(first) = motion.site(&self.vocabulary.landmarks[landmark].name) else {
                let message =
                    format!("the position of `{}` in the motion is not known", self.vocabulary.landmarks[landmark].name);
                return Err(self.error(codes::composition::MOTION, span, message));
            };
            places.push(self.carried(index, motion.clone(), vec![first, first + 1, first + 2]));
        }
        let node = self.graph.join(&places);
        Ok(TypedValue::new(node, Type::one_or_list(ElementType::Place(Frame::World), list, places.len())))
    }

    /// The motion with the places of all landmarks of the body, computed once.
    fn traced(&mut self, index: usize, span: Span) -> Checked<Arc<Motion>> {
        if let Some(known) = &self.references[index].sites {
            return Ok(known.clone());
        }
        let Some(motions) = self.motions else {
            return Err(self.error(codes::composition::MOTION, span, "this is not a motion"));
        };
        // Landmarks move on arcs between rows, which so many places follow to a fraction of a millimetre.
        let motion = self.references[index].motion.finer(PLACES);
        let names: Vec<&str> = self
            .vocabulary
            .landmarks
            .iter()
            .filter(|landmark| !landmark.of_scene)
            .map(|landmark| landmark.name.as_str())
            .collect();
        let traced = (motions.trace)(&motion).and_then(|rows| {
            motion.with_sites(&names, &rows).ok_or_else(|| "the body has different landmarks than its vocabulary".to_owned())
        });
        match traced {
            Ok(traced) => {
                let traced = Arc::new(traced);
                self.references[index].sites = Some(traced.clone());
                Ok(traced)
            }
            Err(problem) => {
                let message = format!("the positions of landmarks in the motion `{}` are not known", motion.name);
                let diagnostic = self.diagnostic(codes::composition::MOTION, span, message).help(problem);
                Err(self.report(diagnostic))
            }
        }
    }

    fn one_argument(&mut self, wanted: &str, span: Span) -> Reported {
        let message = "this signal takes one argument";
        let diagnostic: Diagnostic = self.diagnostic(codes::types::ARGUMENTS, span, message).expected(wanted);
        self.report(diagnostic)
    }
}

/// The name of a signal without its parameters.
fn bare(name: &str) -> &str {
    name.split('(').next().unwrap_or(name)
}

/// The first of some names.
fn few(names: &[&str]) -> String {
    let shown = names.iter().take(4).copied().collect::<Vec<_>>().join(", ");
    if names.len() > 4 { format!("{shown} and others") } else { shown }
}
