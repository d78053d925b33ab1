//! Shapes whose sizes are drawn: which numbers may vary, and which objects may have them.
//!
//! What varies leaves the model as it is: the kind of each shape, their count, and what touches what. So the count of steps and the
//! samples of a height field stay constants.

use super::Stage;
use super::drawn::{FieldNumber, SceneField};
use super::fields::Fields;
use super::shapes::Draw;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::types::{ElementType, Frame};
use crate::check::value::{TypedValue, Value};
use crate::diagnostics::codes;
use crate::graph::interval::Bounds;
use crate::graph::operation::Binary;
use crate::scene::{Motion, Parent, Shape, Terrain};
use crate::syntax::tree::Expr;

/// Most samples of a height field whose formula is drawn: each is a number of the initial state.
pub(super) const MOST_SAMPLES: usize = 1000;

/// Numbers of a shape that one field gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ShapeField {
    /// The three of `size`, each times this.
    Extents(f64),
    /// The one of this place among those of the shape.
    Length(usize),
    /// The heights at so many samples over a rectangle.
    Heights([f64; 2], [usize; 2]),
}

impl<'a> Checker<'a> {
    /// A length of a shape that is above 0 in every episode, and is the number of this place.
    pub(super) fn shape_length(
        &mut self,
        fields: &Fields<'a>,
        name: &str,
        place: usize,
        drawn: &mut Vec<Draw<'a>>,
    ) -> Checked<f64> {
        let field = self.required(fields, name)?;
        let expr = self.field_value(field)?;
        let number = self.field_number(expr, Dimension::LENGTH, &format!("`{name}`"))?;
        let Some(formula) = number.drawn else {
            self.must_be_positive(number.value, name, expr.span)?;
            return Ok(number.value);
        };
        self.must_be_within(&number, not_positive, &format!("`{name}`"), expr.span)?;
        drawn.push((SceneField::Shape(ShapeField::Length(place)), formula));
        Ok(number.value)
    }

    /// `size [x, y, z]`, above 0 in every episode; the shape has its numbers `times` those.
    pub(super) fn extents(&mut self, fields: &Fields<'a>, times: f64, drawn: &mut Vec<Draw<'a>>) -> Checked<[f64; 3]> {
        let field = self.required(fields, "size")?;
        let expr = self.field_value(field)?;
        let (size, varies): ([f64; 3], bool) = self.field_bracket(expr, Dimension::LENGTH, "`size`")?;
        if varies {
            let node = self.data(expr)?.node;
            for lane in 0..3 {
                let lane = self.graph.select([lane], node);
                let bounds = self.bounds_of_draw(lane);
                self.must_be_bounded(bounds, expr.span, "`size`")?;
                let drawn = self.graph.constant_value(lane).is_none().then_some(expr);
                let number = FieldNumber { value: bounds.low, bounds, dimension: Dimension::LENGTH, drawn };
                self.must_be_within(&number, not_positive, "`size`", expr.span)?;
            }
            drawn.push((SceneField::Shape(ShapeField::Extents(times)), expr));
        } else {
            for extent in size {
                self.must_be_positive(extent, "size", expr.span)?;
            }
        }
        Ok(size.map(|extent| times * extent))
    }

    /// `rise`, which goes up or down in every episode.
    pub(super) fn rise(&mut self, fields: &Fields<'a>, drawn: &mut Vec<Draw<'a>>) -> Checked<f64> {
        let field = self.required(fields, "rise")?;
        let expr = self.field_value(field)?;
        let number = self.field_number(expr, Dimension::LENGTH, "`rise`")?;
        let Bounds { low, high } = number.bounds;
        if low <= 0.0 && high >= 0.0 {
            let message = if number.drawn.is_some() { "`rise` may be 0 in an episode" } else { "`rise` must not be 0" };
            return Err(self.error(codes::scene::SIZE, expr.span, message));
        }
        drawn.extend(number.drawn.map(|formula| (SceneField::Shape(ShapeField::Length(0)), formula)));
        Ok(number.value)
    }

    /// A number that decides how the model is built.
    pub(super) fn must_not_vary(&mut self, expr: &'a Expr, name: &str, instead: &str) -> Checked<()> {
        let Value::Typed(data) = self.value(expr)? else { return Ok(()) };
        if self.graph.constant_lanes(data.node).is_some() || !self.graph.is_drawn_first(data.node) {
            return Ok(());
        }
        let message = format!("`{name}` decides which shapes the model has, so it is the same in every episode");
        let diagnostic = self.diagnostic(codes::types::NOT_CONSTANT, expr.span, message).help(instead);
        Err(self.report(diagnostic))
    }

    /// How an object moves whose shape is drawn: one that is fixed to the world is placed there by every episode.
    pub(super) fn varied(&mut self, stage: &Stage<'a>, motion: Motion, parent: &Parent, expr: &Expr) -> Checked<Motion> {
        match (motion, parent) {
            (Motion::Fixed, Parent::World) => Ok(Motion::Placed),
            (Motion::Fixed, Parent::Object(carrier)) if stage.fixed[*carrier] => {
                let message = "a part of what is fixed to the world has the same size in every episode";
                let diagnostic = self
                    .diagnostic(codes::types::NOT_CONSTANT, expr.span, message)
                    .help("declare it at the top level; or draw the place of what carries it, too: `at [x, 0, 0]`");
                Err(self.report(diagnostic))
            }
            (motion, _) => Ok(motion),
        }
    }

    /// A density times a volume that is drawn would be a mass that is drawn.
    pub(super) fn must_have_own_mass(&mut self, fields: &Fields<'a>, drawn: &[Draw<'a>]) -> Checked<()> {
        let Some(density) = fields.get("density").filter(|_| drawn.iter().any(|(field, _)| is_shape(*field))) else {
            return Ok(());
        };
        let diagnostic = self
            .diagnostic(codes::types::NOT_CONSTANT, density.span, "`density` needs a size that is a compile-time constant")
            .help("write `mass`, which may be drawn, too");
        Err(self.report(diagnostic))
    }

    /// A size of an object that formulas read, if it is drawn.
    pub(super) fn drawn_size(&mut self, landmark: usize, name: &str) -> Option<Checked<TypedValue>> {
        let object = self.object_of(landmark)?;
        let shape = self.scene?.description.objects.get(object)?.shape.as_ref()?;
        let place = match (shape, name) {
            (Shape::Box(_) | Shape::Ellipsoid(_), "size") => {
                let data = self.drawn_field(landmark, |field| matches!(field, SceneField::Shape(ShapeField::Extents(_))))?;
                let frame = Frame::Landmark(landmark);
                return Some(data.map(|data| {
                    let kind = ElementType::Vector { size: 3, dimension: Dimension::LENGTH, frame };
                    TypedValue::new(data.node, kind)
                }));
            }
            (Shape::Terrain(Terrain::Stairs { .. }), "length") => 1,
            (Shape::Sphere(_) | Shape::Capsule(..) | Shape::Cylinder(..), "radius")
            | (Shape::Terrain(Terrain::Stairs { .. }), "rise")
            | (Shape::Terrain(Terrain::Slope { .. }), "length") => 0,
            (Shape::Capsule(..) | Shape::Cylinder(..), "length")
            | (Shape::Terrain(Terrain::Stairs { .. }), "run")
            | (Shape::Terrain(Terrain::Slope { .. }), "width") => 1,
            (Shape::Terrain(Terrain::Stairs { .. }), "width") => 2,
            _ => return None,
        };
        let count = match (shape, name) {
            (Shape::Terrain(Terrain::Stairs { count, .. }), "length") => Some(f64::from(*count)),
            _ => None,
        };
        let is: fn(SceneField) -> bool = match place {
            0 => |field| field == SceneField::Shape(ShapeField::Length(0)),
            1 => |field| field == SceneField::Shape(ShapeField::Length(1)),
            _ => |field| field == SceneField::Shape(ShapeField::Length(2)),
        };
        let data = self.drawn_field(landmark, is)?;
        Some(data.map(|data| match count {
            Some(count) => {
                let count = self.graph.constant(count);
                TypedValue { node: self.graph.binary(Binary::Multiply, count, data.node), ..data }
            }
            None => data,
        }))
    }
}

/// The signals of an object that a drawn field decides.
pub(super) fn signals_of(field: SceneField, shape: Option<&Shape>) -> Vec<&'static str> {
    match (field, shape) {
        (SceneField::Friction, _) => vec!["friction"],
        (SceneField::Angle(_), _) => vec!["angle"],
        (SceneField::Shape(ShapeField::Extents(_)), _) => vec!["size"],
        (SceneField::Shape(ShapeField::Length(1)), Some(Shape::Terrain(Terrain::Stairs { .. }))) => vec!["run", "length"],
        (SceneField::Shape(ShapeField::Length(place)), Some(shape)) => vec![shape.number_name(place)],
        _ => Vec::new(),
    }
}

/// Whether a field gives numbers of a shape.
pub(super) fn is_shape(field: SceneField) -> bool {
    matches!(field, SceneField::Shape(_))
}

fn not_positive(value: f64) -> Option<&'static str> {
    (value <= 0.0).then_some("is not positive")
}
