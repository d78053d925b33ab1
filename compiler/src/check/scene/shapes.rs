//! Shapes from the fields of an element: sizes, volumes, and how far a shape reaches up and down.

use super::drawn::{FieldNumber, SceneField};
use super::fields::Fields;
use super::rotation;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::diagnostics::codes;
use crate::extremes::{maximum, minimum};
use crate::scene::{Shape, Terrain};
use crate::syntax::tree::{Expr, ExprKind, FieldValue};
use std::f64::consts::PI;

/// A field that is drawn, and its formula.
pub(super) type Draw<'a> = (SceneField, &'a Expr);

/// A shape and where its own frame stands in that of its parent.
#[derive(Debug, Clone)]
pub(super) struct Placed<'a> {
    pub shape: Option<Shape>,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
    /// What of its place is drawn for every episode.
    pub drawn: Vec<Draw<'a>>,
}

impl<'a> Checker<'a> {
    /// The shape of an element and its place.
    pub(super) fn placed(&mut self, fields: &Fields<'a>) -> Checked<Placed<'a>> {
        let mut drawn = Vec::new();
        let shape = match fields.kind() {
            "box" => Some(Shape::Box(self.extents(fields, 1.0, &mut drawn)?)),
            "ellipsoid" => Some(Shape::Ellipsoid(self.extents(fields, 0.5, &mut drawn)?)),
            "sphere" => Some(Shape::Sphere(self.shape_length(fields, "radius", 0, &mut drawn)?)),
            "capsule" | "cylinder" => return self.long_shape(fields),
            "plane" => Some(Shape::Plane),
            "stairs" => Some(Shape::Terrain(self.stairs(fields, &mut drawn)?)),
            "slope" => return self.slope(fields),
            "heights" => Some(Shape::Terrain(self.heights(fields, &mut drawn)?)),
            _ => None,
        };
        self.placed_shape(fields, shape, drawn)
    }

    fn placed_shape(&mut self, fields: &Fields<'a>, shape: Option<Shape>, mut drawn: Vec<Draw<'a>>) -> Checked<Placed<'a>> {
        let (position, place) = self.place_of(fields)?;
        let (orientation, turn) = self.orientation_of(fields)?;
        drawn.extend(place.into_iter().chain(turn));
        Ok(Placed { shape, position, orientation, drawn })
    }

    /// `at [x, y, z]` in the frame of the parent; its origin by default.
    fn place_of(&mut self, fields: &Fields<'a>) -> Checked<([f64; 3], Option<Draw<'a>>)> {
        let Some(field) = fields.get("at") else { return Ok(([0.0; 3], None)) };
        let expr = self.field_value(field)?;
        let (place, drawn) = self.field_bracket(expr, Dimension::LENGTH, "`at`")?;
        // A free thing whose place is drawn has none in the model.
        let nowhere = drawn && fields.get("free").is_some();
        Ok((if nowhere { [0.0; 3] } else { place }, drawn.then_some((SceneField::Place, expr))))
    }

    fn orientation_of(&mut self, fields: &Fields<'a>) -> Checked<([f64; 4], Option<Draw<'a>>)> {
        let Some(field) = fields.get("orientation") else { return Ok((rotation::NONE, None)) };
        let expr = self.field_value(field)?;
        if matches!(expr.kind, ExprKind::List(_)) {
            return Ok((self.turned(expr)?, None));
        }
        let FieldNumber { value, drawn, .. } = self.field_number(expr, Dimension::ANGLE, "`orientation`")?;
        Ok((rotation::turned([0.0, 0.0, value]), drawn.map(|expr| (SceneField::Turn, expr))))
    }

    /// A capsule or cylinder: by its length and direction, or by its ends.
    fn long_shape(&mut self, fields: &Fields<'a>) -> Checked<Placed<'a>> {
        let mut drawn = Vec::new();
        let radius = self.shape_length(fields, "radius", 0, &mut drawn)?;
        let (length, (position, place), (orientation, turn)) = match fields.get("from") {
            Some(field) => {
                for other in ["at", "along", "orientation", "length"] {
                    if let Some(other) = fields.get(other) {
                        let message = format!("`from ... to` already determines `{}`", other.name.text);
                        return Err(self.error(codes::tasks::REPEATED, other.span, message));
                    }
                }
                let FieldValue::FromTo { from, to } = &field.value else { return Err(self.unread_ends(field.span)) };
                let start: [f64; 3] = self.fixed_bracket(from, Dimension::LENGTH, "`from`")?;
                let end: [f64; 3] = self.fixed_bracket(to, Dimension::LENGTH, "`to`")?;
                let along: [f64; 3] = core::array::from_fn(|k| end[k] - start[k]);
                let Some(direction) = rotation::unit(along) else {
                    return Err(self.error(codes::scene::SIZE, field.span, "both ends are at the same place"));
                };
                let middle = core::array::from_fn(|k| 0.5 * (start[k] + end[k]));
                (rotation::length(along), (middle, None), (rotation::z_to(direction), None))
            }
            None => {
                let length = self.shape_length(fields, "length", 1, &mut drawn)?;
                let orientation = match (fields.get("along"), fields.get("orientation")) {
                    (Some(along), None) => (rotation::z_to(self.direction(along)?), None),
                    (Some(_), Some(turned)) => {
                        let message = "`along` already determines the orientation";
                        return Err(self.error(codes::tasks::REPEATED, turned.span, message));
                    }
                    _ => self.orientation_of(fields)?,
                };
                (length, self.place_of(fields)?, orientation)
            }
        };
        let shape = if fields.kind() == "capsule" { Shape::Capsule(radius, length) } else { Shape::Cylinder(radius, length) };
        drawn.extend(place.into_iter().chain(turn));
        Ok(Placed { shape: Some(shape), position, orientation, drawn })
    }

    fn unread_ends(&mut self, span: crate::diagnostics::Span) -> crate::check::context::Reported {
        let diagnostic = self
            .diagnostic(codes::tasks::UNKNOWN_SETTING, span, "invalid value of `from`")
            .expected("`from [x, y, z] to [x, y, z]`");
        self.report(diagnostic)
    }

    /// A direction, as a unit vector.
    pub(super) fn direction(&mut self, field: &'a crate::syntax::tree::Field) -> Checked<[f64; 3]> {
        let name = field.name.text.as_str();
        let expr = self.field_value(field)?;
        let vector = self.fixed_bracket(expr, Dimension::NONE, &format!("`{name}`"))?;
        match rotation::unit(vector) {
            Some(direction) => Ok(direction),
            None => Err(self.error(codes::scene::SIZE, expr.span, format!("`{name}` must not be a zero vector"))),
        }
    }

    fn stairs(&mut self, fields: &Fields<'a>, drawn: &mut Vec<Draw<'a>>) -> Checked<Terrain> {
        let field = self.required(fields, "count")?;
        let expr = self.field_value(field)?;
        self.must_not_vary(expr, "count", "draw `rise` and `run` instead")?;
        let count = self.whole(expr)?;
        if !(1.0..=1000.0).contains(&count) {
            return Err(self.error(codes::scene::SIZE, expr.span, "a flight has 1 to 1000 steps"));
        }
        let rise = self.rise(fields, drawn)?;
        let run = self.shape_length(fields, "run", 1, drawn)?;
        let width = self.shape_length(fields, "width", 2, drawn)?;
        Ok(Terrain::Stairs { count: count as u32, rise, run, width })
    }

    /// A slope whose angle is drawn is a level one, which its object turns; it is as long as the steepest asks for.
    fn slope(&mut self, fields: &Fields<'a>) -> Checked<Placed<'a>> {
        let mut sizes = Vec::new();
        let length = self.shape_length(fields, "length", 0, &mut sizes)?;
        let length_drawn = sizes.first().map(|(_, expr)| *expr);
        let width = self.shape_length(fields, "width", 1, &mut sizes)?;
        let field = self.required(fields, "angle")?;
        let expr = self.field_value(field)?;
        let angle = self.field_number(expr, Dimension::ANGLE, "`angle`")?;
        let wall = |angle: f64| (angle.abs() > 80.0 * PI / 180.0).then_some("is steeper than 80 deg");
        self.must_be_within(&angle, wall, "`angle`", expr.span)?;
        let Some(drawn) = angle.drawn else {
            let terrain = Terrain::Slope { length, width, angle: angle.value };
            return self.placed_shape(fields, Some(Shape::Terrain(terrain)), sizes);
        };
        if let Some(length) = length_drawn {
            let message = "only one of `angle` and `length` of a slope can be drawn";
            return Err(self.error(codes::types::NOT_CONSTANT, length.span, message));
        }
        let steepest = maximum(angle.bounds.low.abs(), angle.bounds.high.abs());
        let terrain = Terrain::Slope { length: length / libm::cos(steepest), width, angle: 0.0 };
        let mut placed = self.placed_shape(fields, Some(Shape::Terrain(terrain)), sizes)?;
        if let Some((_, turn)) = placed.drawn.iter().find(|(field, _)| *field == SceneField::Turn) {
            let message = "only one of `angle` and `orientation` of a slope can be drawn";
            return Err(self.error(codes::types::NOT_CONSTANT, turn.span, message));
        }
        placed.drawn.push((SceneField::Angle(placed.orientation), drawn));
        placed.orientation = rotation::product(placed.orientation, rotation::turned([0.0, -angle.value, 0.0]));
        Ok(placed)
    }
}

/// Volume, m³; `None` of what has none.
pub(super) fn volume(shape: &Shape) -> Option<f64> {
    Some(match shape {
        Shape::Box([x, y, z]) => x * y * z,
        Shape::Sphere(radius) => 4.0 / 3.0 * PI * radius * radius * radius,
        Shape::Capsule(radius, length) => PI * radius * radius * (length + 4.0 / 3.0 * radius),
        Shape::Cylinder(radius, length) => PI * radius * radius * length,
        Shape::Ellipsoid([a, b, c]) => 4.0 / 3.0 * PI * a * b * c,
        Shape::Plane | Shape::Terrain(_) => return None,
    })
}

/// How far a shape reaches below and above its place, along the vertical of the world; `axes` are its own, one after the
/// other. `None` where it has no end.
pub(super) fn reach(shape: &Shape, axes: &[f64; 9]) -> Option<[f64; 2]> {
    // Vertical parts of the shape's axes.
    let up = [axes[2], axes[5], axes[8]];
    let symmetric = |half: f64| Some([-half, half]);
    match shape {
        Shape::Box(size) => symmetric((0..3).map(|k| 0.5 * size[k] * up[k].abs()).sum()),
        Shape::Sphere(radius) => symmetric(*radius),
        Shape::Capsule(radius, length) => symmetric(radius + 0.5 * length * up[2].abs()),
        Shape::Cylinder(radius, length) => {
            symmetric(0.5 * length * up[2].abs() + radius * libm::sqrt(maximum(1.0 - up[2] * up[2], 0.0)))
        }
        Shape::Ellipsoid(half) => symmetric(libm::sqrt((0..3).map(|k| half[k] * up[k]).map(|part| part * part).sum())),
        Shape::Plane => None,
        Shape::Terrain(terrain) if up[2] > 1.0 - 1e-12 => Some(match terrain {
            Terrain::Stairs { count, rise, .. } => ends(0.0, f64::from(*count) * rise),
            Terrain::Slope { length, angle, .. } => ends(0.0, length * libm::tan(*angle)),
            Terrain::Heights { heights, .. } => {
                let lowest = heights.iter().copied().fold(f64::INFINITY, minimum);
                let highest = heights.iter().copied().fold(f64::NEG_INFINITY, maximum);
                [lowest, highest]
            }
        }),
        Shape::Terrain(_) => None,
    }
}

fn ends(a: f64, b: f64) -> [f64; 2] {
    [minimum(a, b), maximum(a, b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_are_those_of_the_books() {
        assert!((volume(&Shape::Capsule(1.0, 0.0)).unwrap() - volume(&Shape::Sphere(1.0)).unwrap()).abs() < 1e-12);
        assert!((volume(&Shape::Ellipsoid([1.0; 3])).unwrap() - volume(&Shape::Sphere(1.0)).unwrap()).abs() < 1e-12);
        assert_eq!(volume(&Shape::Box([1.0, 2.0, 3.0])), Some(6.0));
        assert_eq!(volume(&Shape::Plane), None);
    }

    #[test]
    fn a_lying_shape_reaches_as_far_as_it_is_thick() {
        // z along world y.
        let lying = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0];
        assert_eq!(reach(&Shape::Cylinder(0.1, 2.0), &lying), Some([-0.1, 0.1]));
        assert_eq!(reach(&Shape::Capsule(0.1, 2.0), &lying), Some([-0.1, 0.1]));
        assert_eq!(reach(&Shape::Box([1.0, 2.0, 3.0]), &lying), Some([-1.0, 1.0]));
    }
}
