//! Shapes of objects that an episode draws.

use super::{Fault, Least, allowed};
use crate::body::Body;
use crate::scene::objects::shapes_of;
use msk_physics::State;
use msk_physics::model::{HeightField, Model, inertia};
use msk_physics::overrides::{Overrides, ShapeOverride, ShapeOverrides};
use msk_program::init::{ObjectShape, Variation};
use msk_program::scene::{Shape, Terrain};

/// Gives the state the shapes that are drawn.
///
/// # Errors
/// A size that no shape can have.
pub(super) fn vary(model: &Model, body: &Body, variation: &Variation, state: &mut State<f64>) -> Result<(), Fault> {
    if variation.shapes.is_empty() {
        return Ok(());
    }
    let mut own = ShapeOverrides::default();
    for ObjectShape { object, shape } in &variation.shapes {
        let object = &body.objects[*object];
        let name = &model.bodies.name[object.body];
        check(name, shape)?;
        for (drawn, &geom) in shapes_of(name, shape, model.bodies.mass[object.body]).into_iter().zip(&object.shapes) {
            if drawn.mass > 0.0 {
                own.moments.push((object.body, inertia::moments(drawn.kind, drawn.size, drawn.mass)));
            }
            let size = drawn.heights.as_ref().map_or(drawn.size, HeightField::size);
            own.shapes.push(ShapeOverride { geom, size, position: drawn.position, heights: drawn.heights });
        }
    }
    state.overrides = Overrides::of(own);
    Ok(())
}

/// Whether every number of a shape is one that it can have.
fn check(name: &str, shape: &Shape) -> Result<(), Fault> {
    let mut numbers = shape.clone();
    for index in 0.. {
        let Some(&mut value) = numbers.number(index) else { return Ok(()) };
        let field = shape.number_name(index);
        let least = match shape {
            Shape::Terrain(Terrain::Stairs { .. }) if field == "rise" => Least::NotZero,
            Shape::Terrain(Terrain::Heights { .. }) => Least::Finite,
            _ => Least::AboveZero,
        };
        allowed(|| format!("`{field}` of `{name}`"), value, least)?;
    }
    Ok(())
}
