//! What surrounds a body: objects, terrain, things carried and held.
//!
//! 1. [`SceneBuilder`] adds bodies, joints, shapes and sites to any model and gives the model that reading the whole from a
//!    file would give;
//! 2. [`stage`] drives it by a [`SceneDescription`] and appends objects to a bound [`Body`] as landmarks, their joints as joints,
//!    in the order of the scene: the order of the compiler's vocabulary;
//! 3. [`terrain`] turns stairs, slopes and height fields into shapes;
//! 4. [`ground`] knows how high the ground is anywhere, and how far any shape is above it; [`radar`] looks around.

mod assembly;
mod binding;
mod builder;
mod check;
mod convex;
mod elements;
mod footprint;
pub mod ground;
mod kept;
pub(crate) mod objects;
pub mod radar;
pub mod terrain;

pub use builder::{Built, SceneBuilder};
pub use check::BuildError;
pub use elements::{NewAttachment, NewBody, NewGeom, NewJoint, NewSite};
pub use objects::SceneError;

use crate::body::Body;
use msk_physics::model::Model;
use msk_program::scene::SceneDescription;

/// The body of `model` in a scene.
///
/// # Errors
/// A scene that refers to what is not there, or that no model can hold.
pub fn stage(model: &Model, body: &Body, scene: &SceneDescription) -> Result<(Model, Body), SceneError> {
    let placed = objects::add(model, body, scene)?;
    let built = placed.builder.build()?;
    let body = binding::bind(body, scene, &placed, &built);
    Ok((built.model, body))
}

#[cfg(test)]
mod tests;
