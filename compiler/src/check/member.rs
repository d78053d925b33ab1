//! Properties: `pelvis.height`, `independent.q`, `v.z`, and what stands by itself: `t`, `spine`.

use super::context::{Checked, Checker, Reported};
use super::dimension::Dimension;
use super::scene::object::dotted;
use super::signals::{self, Owner, Read, Signal};
use super::types::{ElementType, Frame, Type};
use super::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::nearest;
use crate::diagnostics::{Span, codes};
use crate::emit::places::{self, components};
use crate::emit::signals::Reading;
use crate::frame::Sensor;
use crate::graph::NodeId;
use crate::graph::operation::{Operation, Reduction};
use crate::hir::{Resolution, entity_name};
use crate::syntax::tree::{Expr, ExprKind, Name};
use crate::vocabulary::JointKind;

impl<'a> Checker<'a> {
    /// `base.name`
    pub(crate) fn field(&mut self, base: &'a Expr, name: &'a Name, span: Span) -> Checked<Value> {
        if let Some(value) = self.of_reference(base, name, None, span) {
            return value;
        }
        if let Some(data) = self.of_episode(base, name) {
            return Ok(Value::Typed(data));
        }
        if let Some(field_of_test) = self.test_field(base, name) {
            return field_of_test.map(Value::Typed);
        }
        if let Some(object) = dotted(base)
            && self.scene.is_none()
            && let Some(constant) = self.known_constant(&format!("{object}.{}", name.text))
        {
            return Ok(Value::Typed(constant));
        }
        let place = matches!(&base.kind, ExprKind::Name(word) if name.text == "position" && self.is_marker(&word.text));
        let base = self.value(base)?;
        // A marker is a place: `goal.position` is `goal`.
        if place {
            return Ok(base);
        }
        if let Some(part) = self.part_of_object(&base, &name.text) {
            return Ok(part);
        }
        match base {
            Value::Entity(thing) => self.property(&[thing], false, name, span).map(Value::Typed),
            Value::Entities { members, .. } => self.property(&members, true, name, span).map(Value::Typed),
            Value::Typed(data) => self.component(&data, name).map(Value::Typed),
        }
    }

    /// `episode.t`, which does not restart with a phase of a sequence, and `walk.success` of a phase.
    fn of_episode(&mut self, base: &Expr, name: &Name) -> Option<TypedValue> {
        let ExprKind::Name(word) = &base.kind else { return None };
        let declared = self.names.find(self.place, &word.text).is_some();
        match (word.text.as_str(), name.text.as_str()) {
            ("episode", "t") if !declared => {
                let node = Reading::Sensors(vec![Sensor::Time]).emit(&mut self.graph);
                Some(TypedValue::new(node, ElementType::Number(Dimension::TIME)))
            }
            (phase, "success") => {
                if let Some((_, node)) = self.own_success.as_ref().filter(|(own, _)| own == phase) {
                    return Some(TypedValue::new(*node, ElementType::Bool));
                }
                let index = self.phases.iter().position(|known| known == phase)?;
                let index = u32::try_from(index).unwrap_or(u32::MAX);
                Some(TypedValue::new(self.graph.add(Operation::PhaseSuccess(index), &[]), ElementType::Bool))
            }
            _ => None,
        }
    }

    /// A property of one part of the body, or of each of several.
    fn property(&mut self, things: &[EntityRef], list: bool, name: &Name, span: Span) -> Checked<TypedValue> {
        let owner = self.common_owner(things, span)?;
        let Some(signal) = signals::find(owner, &name.text) else {
            if let Some(size) = self.object_property(things, list, name, span)? {
                return Ok(size);
            }
            return Err(self.unknown_property(things[0], owner, name));
        };
        self.must_be_supported(signal, name.span)?;
        self.resolved(name.span, Resolution::Signal(signal));
        self.spend(things.len(), span)?;
        match owner {
            Owner::Joint => self.joint_property(things, list, signal.read, span),
            Owner::Muscle => Ok(self.muscle_property(things, list, signal.read)),
            _ => self.place_property(things, list, signal.read, span),
        }
    }

    fn common_owner(&mut self, things: &[EntityRef], span: Span) -> Checked<Owner> {
        let owner = |thing: &EntityRef| match thing {
            EntityRef::Landmark(_) => Some(Owner::Landmark),
            EntityRef::Joint(_) => Some(Owner::Joint),
            EntityRef::Muscle(_) => Some(Owner::Muscle),
            EntityRef::CentreOfMass => Some(Owner::CentreOfMass),
            EntityRef::Ground | EntityRef::Robot => None,
        };
        let first = things.first().and_then(owner);
        match first.filter(|_| things.iter().all(|thing| owner(thing) == first)) {
            Some(owner) => Ok(owner),
            None if things.is_empty() => Err(self.error(codes::names::NOTHING_FITS, span, "this set is empty on this body")),
            None if things.iter().any(|thing| matches!(thing, EntityRef::Robot | EntityRef::Ground)) => {
                let message = "this has no properties; it is one side of a contact";
                let diagnostic = self
                    .diagnostic(codes::names::UNKNOWN_PROPERTY, span, message)
                    .help("signals of the whole body are those of `com`; the height of the ground is `ground_height(...)`");
                Err(self.report(diagnostic))
            }
            None => {
                let message = "only parts of one kind share properties";
                Err(self.error(codes::names::UNKNOWN_PROPERTY, span, message))
            }
        }
    }

    /// A signal that the language has but this version does not measure is an error, never a silent number.
    pub(crate) fn must_be_supported(&mut self, signal: &Signal, span: Span) -> Checked<()> {
        if signal.supported {
            return Ok(());
        }
        let message = format!("`{}` is part of the language, but not supported yet", signal.name);
        Err(self.error(codes::names::NOT_YET, span, message))
    }

    fn unknown_property(&mut self, thing: EntityRef, owner: Owner, name: &Name) -> Reported {
        let parts = self.parts_of(thing);
        let mut known: Vec<&str> = signals::of(owner).map(|signal| signal.name).collect();
        known.extend(parts.iter().map(String::as_str));
        let near = nearest(&name.text, known.iter().copied());
        let message = format!("{} has no `{}`", self.thing_name(thing), name.text);
        let mut diagnostic = self.diagnostic(codes::names::UNKNOWN_PROPERTY, name.span, message);
        if near.is_empty() {
            diagnostic = diagnostic.help(format!("it has {}", known.join(", ")));
        }
        if matches!(name.text.as_str(), "x" | "y" | "z" | "xy") {
            diagnostic = diagnostic.help(format!("components belong to vectors and places: `.position.{}`", name.text));
        }
        for property in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{property}`?"), name.span, property);
        }
        self.report(diagnostic)
    }

    /// How an error calls a part of the body.
    pub(crate) fn thing_name(&self, thing: EntityRef) -> String {
        entity_name(self.vocabulary, thing)
    }

    /// Properties of landmarks and of the centre of mass.
    fn place_property(&mut self, things: &[EntityRef], list: bool, read: Read, span: Span) -> Checked<TypedValue> {
        use Dimension as D;
        let blocks = |landmark: fn(usize) -> Sensor, com: Sensor| {
            let block = |thing: &EntityRef| if let EntityRef::Landmark(index) = thing { landmark(*index) } else { com };
            things.iter().map(block).collect::<Vec<_>>()
        };
        let shaped = |node: NodeId, element: ElementType| TypedValue::new(node, Type::one_or_list(element, list, things.len()));
        let position = blocks(Sensor::LandmarkPosition, Sensor::ComPosition);
        let velocity = blocks(Sensor::LandmarkVelocity, Sensor::ComVelocity);
        Ok(match read {
            Read::Position => shaped(self.measured(position), ElementType::Place(Frame::World)),
            Read::Velocity => shaped(self.measured(velocity), ElementType::world_vector(D::SPEED)),
            Read::Acceleration => {
                let sensors = blocks(Sensor::LandmarkAcceleration, Sensor::ComAcceleration);
                shaped(self.measured(sensors), ElementType::world_vector(D::ACCELERATION))
            }
            Read::Speed => {
                let velocity = self.measured(velocity);
                shaped(self.graph.reduce(Reduction::Norm, 3, velocity), ElementType::Number(D::SPEED))
            }
            Read::Height => {
                let position = self.measured(position);
                let heights = components(&mut self.graph, position, things.len(), 3, &[2]);
                shaped(heights, ElementType::Number(D::LENGTH))
            }
            Read::Clearance => {
                self.must_have_segments(things, span)?;
                let sensors = blocks(Sensor::LandmarkClearance, Sensor::Time);
                shaped(self.graph.sensors(sensors), ElementType::Number(D::LENGTH))
            }
            Read::AngularVelocity => {
                let sensors = blocks(Sensor::LandmarkAngularVelocity, Sensor::Time);
                shaped(self.measured(sensors), ElementType::world_vector(D::ANGULAR_VELOCITY))
            }
            Read::Mass => {
                let mut masses = Vec::with_capacity(things.len());
                for thing in things {
                    masses.push(self.mass_of(*thing)?);
                }
                shaped(self.graph.join(&masses), ElementType::Number(D::MASS))
            }
            attitude => self.attitude(things, list, attitude),
        })
    }

    /// Axes and angles of landmarks.
    fn attitude(&mut self, things: &[EntityRef], list: bool, read: Read) -> TypedValue {
        let axes = things.iter().filter_map(|thing| match thing {
            EntityRef::Landmark(index) => Some(Sensor::LandmarkAxes(*index)),
            _ => None,
        });
        let axes = self.measured(axes.collect());
        let (graph, count) = (&mut self.graph, things.len());
        let axis = ElementType::world_vector(Dimension::NONE);
        let (node, element) = match read {
            Read::Forward => (components(graph, axes, count, 9, &[0, 1, 2]), axis),
            Read::Left => (components(graph, axes, count, 9, &[3, 4, 5]), axis),
            Read::Up => (components(graph, axes, count, 9, &[6, 7, 8]), axis),
            Read::Yaw => (places::yaw(graph, axes, count), ElementType::WrappingAngle),
            Read::Pitch => (places::pitch(graph, axes, count), ElementType::WrappingAngle),
            Read::Roll => (places::roll(graph, axes, count), ElementType::WrappingAngle),
            _ => (axes, ElementType::Rotation),
        };
        TypedValue::new(node, Type::one_or_list(element, list, count))
    }

    pub(crate) fn must_have_segments(&mut self, things: &[EntityRef], span: Span) -> Checked<()> {
        for thing in things {
            if let EntityRef::Landmark(index) = thing
                && !self.vocabulary.landmarks[*index].has_segment
            {
                let message = format!("{} has no segment, so it has no contacts and no clearance", self.thing_name(*thing));
                let help = format!("landmarks with one: {}", self.segments_in_words());
                let diagnostic = self.diagnostic(codes::names::UNKNOWN_PROPERTY, span, message).help(help);
                return Err(self.report(diagnostic));
            }
        }
        Ok(())
    }

    fn joint_property(&mut self, things: &[EntityRef], list: bool, read: Read, span: Span) -> Checked<TypedValue> {
        let indices: Vec<usize> =
            things.iter().filter_map(|thing| if let EntityRef::Joint(index) = thing { Some(*index) } else { None }).collect();
        let joints = &self.vocabulary.joints;
        let sensors = |sensor: fn(usize) -> Sensor| indices.iter().map(|&index| sensor(index)).collect::<Vec<_>>();
        // Length for slides, angle for hinges, over time so often.
        let per = |time: i32| {
            move |kind: JointKind| match kind {
                JointKind::Hinge => Dimension::of(0, 0, -time, 1),
                JointKind::Slide => Dimension::of(1, 0, -time, 0),
            }
        };
        let kinds = |dimension: &dyn Fn(JointKind) -> Dimension| {
            let dimensions = indices.iter().map(|&index| dimension(joints[index].kind)).collect::<Vec<_>>();
            if list { Type::numbers(dimensions) } else { ElementType::Number(dimensions[0]).into() }
        };
        let (reading, kind) = match read {
            Read::CoordinateVelocity => (Reading::Sensors(sensors(Sensor::JointVelocity)), kinds(&per(1))),
            Read::CoordinateAcceleration => (Reading::Sensors(sensors(Sensor::JointAcceleration)), kinds(&per(2))),
            Read::Torque => {
                let dimension = |kind| if kind == JointKind::Hinge { Dimension::TORQUE } else { Dimension::FORCE };
                (Reading::Sensors(sensors(Sensor::JointTorque)), kinds(&dimension))
            }
            Read::ReactionForce => {
                let element = ElementType::world_vector(Dimension::FORCE);
                (Reading::Sensors(sensors(Sensor::JointReactionForce)), Type::one_or_list(element, list, indices.len()))
            }
            Read::ReactionTorque => {
                let element = ElementType::world_vector(Dimension::TORQUE);
                (Reading::Sensors(sensors(Sensor::JointReactionTorque)), Type::one_or_list(element, list, indices.len()))
            }
            Read::Power => {
                let power = Reading::Product(sensors(Sensor::JointTorque), sensors(Sensor::JointVelocity));
                (power, kinds(&|_| Dimension::POWER))
            }
            Read::Neutral => {
                let values = indices.iter().map(|&index| joints[index].neutral);
                (Reading::Constants(values.collect()), kinds(&per(0)))
            }
            Read::Lower | Read::Upper => {
                let end = usize::from(read == Read::Upper);
                let mut values = Vec::with_capacity(indices.len());
                for &index in &indices {
                    let Some(range) = joints[index].range else {
                        let message = format!("{} has no limits", self.thing_name(EntityRef::Joint(index)));
                        return Err(self.error(codes::names::UNKNOWN_PROPERTY, span, message));
                    };
                    values.push(range[end]);
                }
                (Reading::Constants(values), kinds(&per(0)))
            }
            _ => (Reading::Sensors(sensors(Sensor::JointPosition)), kinds(&per(0))),
        };
        Ok(TypedValue::new(reading.emit(&mut self.graph), kind))
    }

    fn muscle_property(&mut self, things: &[EntityRef], list: bool, read: Read) -> TypedValue {
        let indices: Vec<usize> =
            things.iter().filter_map(|thing| if let EntityRef::Muscle(index) = thing { Some(*index) } else { None }).collect();
        let sensors = |sensor: fn(usize) -> Sensor| indices.iter().map(|&index| sensor(index)).collect::<Vec<_>>();
        let (reading, dimension) = match read {
            Read::Length => (Reading::Sensors(sensors(Sensor::MuscleLength)), Dimension::LENGTH),
            Read::Velocity => (Reading::Sensors(sensors(Sensor::MuscleVelocity)), Dimension::SPEED),
            Read::Force => (Reading::Sensors(sensors(Sensor::MuscleForce)), Dimension::FORCE),
            Read::Tension => (Reading::Negated(sensors(Sensor::MuscleForce)), Dimension::FORCE),
            Read::MetabolicPower => (Reading::Sensors(sensors(Sensor::MuscleMetabolicPower)), Dimension::POWER),
            Read::Strength => (Reading::Sensors(sensors(Sensor::MuscleStrength)), Dimension::NONE),
            Read::FibreLength => (Reading::Sensors(sensors(Sensor::MuscleFibreLength)), Dimension::LENGTH),
            Read::TendonLength => (Reading::Sensors(sensors(Sensor::MuscleTendonLength)), Dimension::LENGTH),
            Read::Excitation => (Reading::Sensors(sensors(Sensor::MuscleExcitation)), Dimension::NONE),
            Read::Action => (Reading::Sensors(sensors(Sensor::Action)), Dimension::NONE),
            Read::PeakForce => {
                let values = indices.iter().map(|&index| self.vocabulary.muscles[index].peak_force);
                (Reading::Constants(values.collect()), Dimension::FORCE)
            }
            Read::Power => (Reading::Product(sensors(Sensor::MuscleForce), sensors(Sensor::MuscleVelocity)), Dimension::POWER),
            _ => (Reading::Sensors(sensors(Sensor::MuscleActivation)), Dimension::NONE),
        };
        let kind = Type::one_or_list(ElementType::Number(dimension), list, indices.len());
        TypedValue::new(reading.emit(&mut self.graph), kind)
    }

    /// `.x`, `.xy`, `.forward`: a component in the axes in which the vector is counted.
    fn component(&mut self, data: &TypedValue, name: &Name) -> Checked<TypedValue> {
        let (size, dimension, frame) = match data.kind.element() {
            Some(ElementType::Vector { size, dimension, frame }) => (size, dimension, frame),
            Some(ElementType::Place(frame)) => (3, Dimension::LENGTH, frame),
            Some(ElementType::Rotation) => return self.rotation_component(data, name),
            _ => {
                let found = data.kind.described(self.vocabulary);
                let message = format!("`.{}` cannot be read here", name.text);
                let diagnostic = self.diagnostic(codes::names::UNKNOWN_PROPERTY, name.span, message).found(found);
                let of_vectors = ["x", "y", "z", "xy", "forward", "left", "up"].contains(&name.text.as_str());
                let help = format!("components belong to vectors and places: `.velocity.{0}`, `.position.{0}`", name.text);
                return Err(self.report(if of_vectors { diagnostic.help(help) } else { diagnostic }));
            }
        };
        let lanes: Option<&[usize]> = match (frame, name.text.as_str()) {
            (Frame::World, "x") | (Frame::Landmark(_) | Frame::Heading(_), "forward") => Some(&[0]),
            (Frame::World, "y") | (Frame::Landmark(_) | Frame::Heading(_), "left") => Some(&[1]),
            (Frame::World, "z") | (Frame::Landmark(_) | Frame::Heading(_), "up") => Some(&[2]),
            (Frame::World, "xy") => Some(&[0, 1]),
            _ => None,
        };
        let Some(lanes) = lanes.filter(|lanes| lanes.iter().all(|lane| *lane < size)) else {
            return Err(self.no_such_component(frame, name));
        };
        let node = components(&mut self.graph, data.node, data.kind.shape().count(), size, lanes);
        let element = match lanes.len() {
            1 => ElementType::Number(dimension),
            size => ElementType::Vector { size, dimension, frame },
        };
        Ok(TypedValue::new(node, data.kind.with_element(element)))
    }

    fn no_such_component(&mut self, frame: Frame, name: &Name) -> Reported {
        let anatomical = matches!(name.text.as_str(), "forward" | "left" | "up");
        let axes = frame.name(self.vocabulary);
        let (message, help) = match frame {
            Frame::World if anatomical => (
                format!("`.{}` needs an anatomical frame, this vector is expressed in the world frame", name.text),
                format!("choose a frame: `(v in pelvis).{0}` or `(v in heading(pelvis)).{0}`", name.text),
            ),
            Frame::World => (
                format!("a vector in the world frame has no `.{}`", name.text),
                "its components are `.x`, `.y`, `.z` and `.xy`".to_owned(),
            ),
            _ => (
                format!("a vector in the frame of {axes} has no `.{}`", name.text),
                "its components are `.forward`, `.left` and `.up`".to_owned(),
            ),
        };
        let of_axes = anatomical || matches!(name.text.as_str(), "x" | "y" | "z" | "xy");
        let code = if of_axes { codes::types::FRAMES_DIFFER } else { codes::names::UNKNOWN_PROPERTY };
        let diagnostic = self.diagnostic(code, name.span, message).help(help);
        self.report(diagnostic)
    }

    fn rotation_component(&mut self, data: &TypedValue, name: &Name) -> Checked<TypedValue> {
        let first = match name.text.as_str() {
            "forward" => 0,
            "left" => 3,
            "up" => 6,
            other => {
                let message = format!("an orientation has no `.{other}`");
                let diagnostic = self
                    .diagnostic(codes::names::UNKNOWN_PROPERTY, name.span, message)
                    .help("it has `.forward`, `.left` and `.up`; angles are properties of the landmark: `.pitch`");
                return Err(self.report(diagnostic));
            }
        };
        let lanes = [first, first + 1, first + 2];
        let node = components(&mut self.graph, data.node, data.kind.shape().count(), 9, &lanes);
        Ok(TypedValue::new(node, data.kind.with_element(ElementType::world_vector(Dimension::NONE))))
    }

    /// A signal that stands by itself.
    pub(crate) fn single_signal(&mut self, signal: &Signal, span: Span) -> Checked<TypedValue> {
        self.must_be_supported(signal, span)?;
        self.must_be_settled(signal, span)?;
        let (vocabulary, interval) = (self.vocabulary, self.timing.interval);
        let (reading, kind): (Reading, Type) = match signal.read {
            Read::Action if !self.action.is_default() => {
                let size = self.action.size(vocabulary.muscles.len());
                self.spend(size, span)?;
                let entries = (0..size).map(Sensor::ActionEntry).collect();
                (Reading::Sensors(entries), Type::one_or_list(ElementType::PLAIN, true, size))
            }
            Read::Time => (Reading::Time { interval }, ElementType::Number(Dimension::TIME).into()),
            Read::Step => (Reading::Step, ElementType::Int.into()),
            Read::Interval => (Reading::constant(interval), ElementType::Number(Dimension::TIME).into()),
            Read::Horizon => (Reading::constant(f64::from(self.timing.horizon)), ElementType::Int.into()),
            Read::Pi => (Reading::constant(std::f64::consts::PI), ElementType::PLAIN.into()),
            Read::BodyMass => (Reading::constant(vocabulary.mass), ElementType::Number(Dimension::MASS).into()),
            Read::BodyWeight => {
                let weight = vocabulary.mass * vocabulary.gravity;
                (Reading::constant(weight), ElementType::Number(Dimension::FORCE).into())
            }
            Read::CentreOfPressure => (Reading::Sensors(vec![Sensor::CentreOfPressure]), ElementType::Place(Frame::World).into()),
            Read::SupportMargin => (Reading::Sensors(vec![Sensor::SupportMargin]), ElementType::Number(Dimension::LENGTH).into()),
            Read::AngularMomentum => {
                let element = ElementType::world_vector(Dimension::ANGULAR_MOMENTUM);
                (Reading::Sensors(vec![Sensor::AngularMomentum]), element.into())
            }
            Read::Spine => (self.spine(span)?, ElementType::world_vector(Dimension::NONE).into()),
            Read::Terminated | Read::Finished | Read::Truncated | Read::Ended | Read::Survived => {
                return self.end_signal(signal.read);
            }
            read => {
                let muscles: Vec<EntityRef> = (0..vocabulary.muscles.len()).map(EntityRef::Muscle).collect();
                if muscles.is_empty() {
                    let message = format!("`{}` is that of the muscles, and this body has none", signal.name);
                    return Err(self.error(codes::names::NOTHING_FITS, span, message));
                }
                return Ok(self.muscle_property(&muscles, true, read));
            }
        };
        Ok(TypedValue::new(reading.emit(&mut self.graph), kind))
    }

    /// A constant of the task or of the body is no constant before that is known.
    fn must_be_settled(&mut self, signal: &Signal, span: Span) -> Checked<()> {
        let (known, decided_by) = match signal.read {
            Read::Interval => (self.settled.interval, "the task's `control`"),
            Read::Horizon => (self.settled.horizon, "the task's `horizon`"),
            Read::Terminated | Read::Finished | Read::Truncated | Read::Ended | Read::Survived => (self.settled.body, "a task"),
            _ if signal.owner == Owner::WholeBody => (self.settled.body, "the model of the body"),
            _ => return Ok(()),
        };
        if known {
            return Ok(());
        }
        let message = format!("`{}` is not known here yet: it follows from {decided_by}", signal.name);
        Err(self.error(codes::types::NOT_CONSTANT, span, message))
    }

    /// The unit vector from the pelvis to the head.
    fn spine(&mut self, span: Span) -> Checked<Reading> {
        let landmark = |name: &str| self.vocabulary.landmarks.iter().position(|landmark| landmark.name == name);
        let (Some(pelvis), Some(head)) = (landmark("pelvis"), landmark("head")) else {
            let message = "`spine` needs landmarks `pelvis` and `head`, which this body does not have";
            return Err(self.error(codes::names::UNKNOWN_NAME, span, message));
        };
        Ok(Reading::Direction { from: Sensor::LandmarkPosition(pelvis), to: Sensor::LandmarkPosition(head) })
    }
}
