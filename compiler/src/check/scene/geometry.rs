//! Sizes and places of objects that formulas read: constants, so that a task never repeats values of its scene.

use super::drawn::SceneField;
use super::{CheckedScene, Stage, shapes, varied};
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::signals::{self, Owner, Read};
use crate::check::types::{ElementType, Frame, Type};
use crate::check::value::{EntityRef, TypedValue};
use crate::diagnostics::{Span, codes};
use crate::frame::Sensor;
use crate::graph::NodeId;
use crate::scene::{Motion, Object, Parent, Shape, Terrain};
use crate::syntax::tree::Name;

/// A constant of an object.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Known {
    pub lanes: Vec<f64>,
    pub element: ElementType,
}

impl<'a> Checker<'a> {
    /// Keeps what is constant of the object at `index`.
    pub(super) fn keep_geometry(&mut self, stage: &Stage<'a>, index: usize) {
        let (object, landmark, fixed) = (&stage.scene.objects[index], &stage.landmarks[index], stage.fixed[index]);
        let aligned =
            object.parent == Parent::World && object.motion == Motion::Fixed && object.orientation == super::rotation::NONE;
        let frame = if aligned { Frame::World } else { Frame::Landmark(self.vocabulary.landmarks.len() + index) };
        let name = object.name.clone();
        let mut keep = |signal: &str, lanes: Vec<f64>, element: ElementType| {
            self.known.insert(format!("{name}.{signal}"), Known { lanes, element });
        };
        let length = ElementType::Number(Dimension::LENGTH);
        let mut keep_length = |signal: &str, value: f64| keep(signal, vec![value], length);
        match &object.shape {
            Some(Shape::Sphere(radius)) => keep_length("radius", *radius),
            Some(Shape::Capsule(radius, long) | Shape::Cylinder(radius, long)) => {
                keep_length("radius", *radius);
                keep_length("length", *long);
            }
            Some(Shape::Terrain(Terrain::Stairs { count, rise, run, width })) => {
                keep_length("rise", *rise);
                keep_length("run", *run);
                keep_length("width", *width);
                keep_length("length", f64::from(*count) * run);
                keep("count", vec![f64::from(*count)], ElementType::Int);
            }
            Some(Shape::Terrain(Terrain::Slope { length, width, angle })) => {
                keep_length("length", *length);
                keep_length("width", *width);
                keep("angle", vec![*angle], ElementType::ANGLE);
            }
            Some(Shape::Terrain(Terrain::Heights { size, .. })) => {
                keep_length("length", size[0]);
                keep_length("width", size[1]);
            }
            Some(shape @ (Shape::Box(_) | Shape::Ellipsoid(_))) => {
                let size = match shape {
                    Shape::Box(size) => *size,
                    Shape::Ellipsoid(half) => half.map(|half| 2.0 * half),
                    _ => [0.0; 3],
                };
                keep("size", size.to_vec(), ElementType::Vector { size: 3, dimension: Dimension::LENGTH, frame });
            }
            Some(Shape::Plane) | None => {}
        }
        if object.shape.is_some() {
            keep("friction", vec![object.surface.friction[0]], ElementType::PLAIN);
        }
        for drawn in stage.drawn.iter().filter(|drawn| drawn.object == Some(index)) {
            for signal in varied::signals_of(drawn.field, object.shape.as_ref()) {
                self.known.remove(&format!("{name}.{signal}"));
            }
        }
        if !fixed {
            return;
        }
        self.known.insert(
            format!("{name}.position"),
            Known { lanes: landmark.neutral_position.to_vec(), element: ElementType::Place(Frame::World) },
        );
        if let Some([below, above]) = object.shape.as_ref().and_then(|shape| shapes::reach(shape, &landmark.neutral_axes)) {
            let height = landmark.neutral_position[2];
            self.known.insert(format!("{name}.top"), Known { lanes: vec![height + above], element: length });
            self.known.insert(format!("{name}.bottom"), Known { lanes: vec![height + below], element: length });
        }
    }

    /// A constant by its full name, such as `seat.top`.
    pub(crate) fn known_constant(&mut self, name: &str) -> Option<TypedValue> {
        let known = self.known.get(name)?.clone();
        let node = self.graph.constants(&known.lanes);
        Some(TypedValue::new(node, known.element))
    }

    /// A size of an object, or of each of several.
    pub(crate) fn object_property(
        &mut self,
        things: &[EntityRef],
        list: bool,
        name: &Name,
        span: Span,
    ) -> Checked<Option<TypedValue>> {
        let objects: Option<Vec<usize>> = things
            .iter()
            .map(|thing| match thing {
                EntityRef::Landmark(index) if self.vocabulary.landmarks[*index].of_scene => Some(*index),
                _ => None,
            })
            .collect();
        let (Some(objects), Some(signal)) = (objects, signals::find(Owner::Object, &name.text)) else { return Ok(None) };
        let mut parts = Vec::with_capacity(objects.len());
        let mut kind = None;
        for index in objects {
            let object = self.vocabulary.landmarks[index].name.clone();
            let drawn = match name.text.as_str() {
                "friction" => self.drawn_field(index, |field| field == SceneField::Friction),
                "angle" => self.drawn_field(index, |field| matches!(field, SceneField::Angle(_))),
                other => self.drawn_size(index, other),
            };
            let known = match drawn {
                Some(drawn) => Some(drawn?),
                None => self.known_constant(&format!("{object}.{}", name.text)),
            };
            let Some(data) = known else {
                return Err(self.no_such_size(&object, signal.read, name));
            };
            let own = data.kind.element_at(0);
            if *kind.get_or_insert(own) != own {
                let message = "only objects of one kind share sizes";
                return Err(self.error(codes::names::UNKNOWN_PROPERTY, span, message));
            }
            parts.push(data.node);
        }
        let Some(kind) = kind else { return Ok(None) };
        let node = self.graph.join(&parts);
        Ok(Some(TypedValue::new(node, Type::one_or_list(kind, list, parts.len()))))
    }

    fn no_such_size(&mut self, object: &str, read: Read, name: &Name) -> crate::check::context::Reported {
        let message = format!("`{object}` has no `{}`", name.text);
        let prefix = format!("{object}.");
        let known: Vec<&str> = self
            .known
            .keys()
            .filter_map(|key| key.strip_prefix(&prefix))
            .filter(|key| !key.contains('.') && *key != "position")
            .collect();
        let help = match read {
            Read::Top | Read::Bottom => "only fixed objects with a shape have it; for moving objects use `position`".to_owned(),
            _ if known.is_empty() => "it has no shape of its own; use one of its parts".to_owned(),
            _ => format!("it has {}, and the signals of landmarks", known.join(", ")),
        };
        let diagnostic = self.diagnostic(codes::names::UNKNOWN_PROPERTY, name.span, message).help(help);
        self.report(diagnostic)
    }

    /// Sensor blocks side by side; what is measured on things that stand still is a constant.
    pub(crate) fn measured(&mut self, sensors: Vec<Sensor>) -> NodeId {
        if !sensors.iter().any(|sensor| self.constant_sensor(*sensor).is_some()) {
            return self.graph.sensors(sensors);
        }
        let mut nodes = Vec::with_capacity(sensors.len());
        for sensor in sensors {
            nodes.push(match self.constant_sensor(sensor) {
                Some(lanes) => self.graph.constants(&lanes),
                None => self.graph.sensors(vec![sensor]),
            });
        }
        self.graph.join(&nodes)
    }

    /// The constant value of a sensor of a thing that stands still.
    fn constant_sensor(&self, sensor: Sensor) -> Option<Vec<f64>> {
        use Sensor::{LandmarkAcceleration, LandmarkAngularVelocity, LandmarkAxes, LandmarkPosition, LandmarkVelocity};
        let (LandmarkPosition(index)
        | LandmarkVelocity(index)
        | LandmarkAcceleration(index)
        | LandmarkAxes(index)
        | LandmarkAngularVelocity(index)) = sensor
        else {
            return None;
        };
        let landmark = self.vocabulary.landmarks.get(index).filter(|_| self.stands_still(index))?;
        Some(match sensor {
            LandmarkPosition(_) => landmark.neutral_position.to_vec(),
            LandmarkAxes(_) => landmark.neutral_axes.to_vec(),
            _ => vec![0.0; 3],
        })
    }

    /// Whether a landmark is an object that stays where it is over an episode.
    pub(crate) fn stands_over_episode(&self, landmark: usize) -> bool {
        let placed = |scene: &CheckedScene<'_>, object: usize| {
            matches!(scene.description.objects.get(object), Some(Object { motion: Motion::Placed, .. }))
        };
        self.stands_still(landmark)
            || self.object_of(landmark).zip(self.scene).is_some_and(|(object, scene)| placed(scene, object))
    }

    /// Whether a landmark is an object that nothing can move.
    pub(crate) fn stands_still(&self, landmark: usize) -> bool {
        let object = self.object_of(landmark).zip(self.scene);
        object.is_some_and(|(object, scene)| scene.fixed.get(object).copied().unwrap_or(false))
    }
}
