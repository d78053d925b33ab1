//! Fields of a scene whose numbers a `random` decides: for every episode, before its first snapshot.
//!
//! The model is compiled once, with a number from the middle of what may be drawn. The draw itself is evaluated with the initial
//! state, when the randoms of the task are known.

use super::expand::Locals;
use super::varied::ShapeField;
use crate::body::Property;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::{FileId, Span, codes};
use crate::frame::Sensor;
use crate::graph::NodeId;
use crate::graph::interval::{self, Bounds, Ranges};
use crate::graph::operation::Binary;
use crate::numbers::for_people;
use crate::scene::{Motion, Object, Parent};
use crate::syntax::tree::Expr;

/// A field whose value is drawn.
#[derive(Debug, Clone)]
pub(crate) struct DrawnField<'a> {
    /// The object, by its place in the scene; none for the ground.
    pub object: Option<usize>,
    pub field: SceneField,
    pub expr: &'a Expr,
    pub locals: Locals,
    pub file: FileId,
}

/// A field that may be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SceneField {
    /// `at`, three lengths.
    Place,
    /// `orientation`, a turn about the vertical.
    Turn,
    /// `angle` of a slope, with the orientation of its level plane.
    Angle([f64; 4]),
    Mass,
    /// Sliding friction.
    Friction,
    /// Damping or stiffness of the joint of this place among those of the object.
    Joint {
        place: usize,
        property: Property,
        dimension: Dimension,
    },
    /// Numbers of its shape.
    Shape(ShapeField),
}

/// A number of a field.
#[derive(Debug, Clone, Copy)]
pub(in crate::check) struct FieldNumber<'a> {
    /// Known while compiling, or from the middle of what may be drawn.
    pub value: f64,
    pub bounds: Bounds,
    pub dimension: Dimension,
    /// Its formula, where it is drawn.
    pub drawn: Option<&'a Expr>,
}

impl<'a> FieldNumber<'a> {
    /// One that is known.
    pub fn known(value: f64, dimension: Dimension) -> Self {
        Self { value, bounds: Bounds::point(value), dimension, drawn: None }
    }
}

/// Randoms that are drawn first read nothing that has bounds of its own.
struct NothingMeasured;

impl Ranges for NothingMeasured {
    fn sensor(&self, _: Sensor, _: usize) -> Bounds {
        Bounds::ANY
    }
}

impl<'a> Checker<'a> {
    /// A number of this dimension that is known while compiling or drawn before the first snapshot.
    pub(in crate::check) fn field_number(
        &mut self,
        expr: &'a Expr,
        dimension: Dimension,
        wanted_by: &str,
    ) -> Checked<FieldNumber<'a>> {
        let data = self.data(expr)?;
        let fits = data.kind.is_one_number() && data.kind.dimension() == Some(dimension);
        if !fits || self.graph.constant_value(data.node).is_some() {
            return Ok(FieldNumber::known(self.known_number(&data, expr, dimension, wanted_by)?, dimension));
        }
        self.must_be_drawn(data.node, expr.span, wanted_by)?;
        let bounds = self.bounds_of_draw(data.node);
        self.must_be_bounded(bounds, expr.span, wanted_by)?;
        Ok(FieldNumber { value: 0.5 * bounds.low + 0.5 * bounds.high, bounds, dimension, drawn: Some(expr) })
    }

    pub(super) fn must_be_bounded(&mut self, bounds: Bounds, span: Span, wanted_by: &str) -> Checked<()> {
        if bounds.low.is_finite() && bounds.high.is_finite() {
            return Ok(());
        }
        let diagnostic = self
            .diagnostic(codes::scene::SIZE, span, format!("{wanted_by} is drawn without bounds"))
            .help("draw it with `uniform(low .. high)`, or bound it: `clip(x, low, high)`");
        Err(self.report(diagnostic))
    }

    /// Components that are known while compiling, or those from the middle of what may be drawn; and whether they are drawn.
    pub(super) fn field_bracket<const SIZE: usize>(
        &mut self,
        expr: &'a Expr,
        dimension: Dimension,
        wanted_by: &str,
    ) -> Checked<([f64; SIZE], bool)> {
        let data = match self.value(expr)? {
            Value::Typed(data) => data,
            other => return Err(self.not_numbers(&other, expr.span)),
        };
        self.must_be_bracket(&data, SIZE, dimension, expr.span, wanted_by)?;
        if self.graph.constant_lanes(data.node).is_some() {
            return Ok((self.known_bracket(&data, expr.span, wanted_by)?, false));
        }
        self.must_be_drawn(data.node, expr.span, wanted_by)?;
        let middles = core::array::from_fn(|lane| {
            let lane = self.graph.select([lane], data.node);
            let Bounds { low, high } = self.bounds_of_draw(lane);
            let middle = 0.5 * low + 0.5 * high;
            if middle.is_finite() { middle } else { 0.0 }
        });
        Ok((middles, true))
    }

    /// Between which numbers a draw lies: of one number.
    pub(in crate::check) fn bounds_of_draw(&self, node: NodeId) -> Bounds {
        interval::analyse_for(&self.graph, node, &NothingMeasured).first().copied().unwrap_or(Bounds::ANY)
    }

    /// Whether all that may be drawn is allowed.
    pub(in crate::check) fn must_be_within(
        &mut self,
        number: &FieldNumber<'a>,
        wrong: impl Fn(f64) -> Option<&'static str>,
        wanted_by: &str,
        span: Span,
    ) -> Checked<()> {
        let Bounds { low, high } = number.bounds;
        let shown = |end: f64| format!("{} {}", for_people(end), number.dimension).trim_end().to_owned();
        for end in [low, high] {
            let Some(reason) = wrong(end) else { continue };
            let message = match number.drawn {
                None => format!("{wanted_by} {reason}"),
                Some(_) => {
                    format!("{wanted_by} {reason} in some episodes: it is drawn from {} to {}", shown(low), shown(high))
                }
            };
            return Err(self.error(codes::scene::SIZE, span, message));
        }
        Ok(())
    }

    /// What is drawn for a field of the object that a landmark is, if it is drawn.
    pub(in crate::check) fn drawn_field(&mut self, landmark: usize, is: fn(SceneField) -> bool) -> Option<Checked<TypedValue>> {
        let object = self.object_of(landmark)?;
        let drawn = self.scene?.drawn.iter().find(|drawn| drawn.object == Some(object) && is(drawn.field))?;
        Some(self.in_file(drawn.file, |checker| checker.with_locals(&drawn.locals, |checker| checker.data(drawn.expr))))
    }

    /// The object that a landmark is, by its place in the scene.
    pub(in crate::check) fn object_of(&self, landmark: usize) -> Option<usize> {
        let first = self.vocabulary.landmarks.iter().position(|landmark| landmark.of_scene)?;
        landmark.checked_sub(first)
    }

    /// Mass of a landmark's segment, of an object with what it carries rigidly, or of the whole body, kg.
    pub(in crate::check) fn mass_of(&mut self, thing: EntityRef) -> Checked<NodeId> {
        let EntityRef::Landmark(landmark) = thing else { return Ok(self.graph.constant(self.vocabulary.mass)) };
        let known = self.vocabulary.landmarks[landmark].mass;
        let (Some(object), Some(scene)) = (self.object_of(landmark), self.scene) else { return Ok(self.graph.constant(known)) };
        let objects = &scene.description.objects;
        let carried: Vec<usize> = (object..objects.len()).filter(|&part| moves_with(objects, part, object)).collect();
        let (mut rest, mut drawn) = (0.0, Vec::new());
        for part in carried {
            match self.drawn_field(landmark - object + part, |field| field == SceneField::Mass) {
                Some(mass) => drawn.push(mass?.node),
                None => rest += objects[part].mass,
            }
        }
        let Some((&first, others)) = drawn.split_first() else { return Ok(self.graph.constant(known)) };
        let total = others.iter().fold(first, |sum, &mass| self.graph.binary(Binary::Add, sum, mass));
        if rest == 0.0 {
            return Ok(total);
        }
        let rest = self.graph.constant(rest);
        Ok(self.graph.binary(Binary::Add, total, rest))
    }
}

/// Whether a part moves with an object as one.
fn moves_with(objects: &[Object], part: usize, object: usize) -> bool {
    part == object
        || match (&objects[part].motion, &objects[part].parent) {
            (Motion::Fixed, Parent::Object(parent)) => moves_with(objects, *parent, object),
            _ => false,
        }
}
