//! Pictures of episodes without a browser: the scene of the page, drawn by the processor.
//!
//! 1. [`Renderer`] turns what an environment shows at a moment into a [`Scene`]: solids, muscles and labels in the world;
//! 2. `geometry` makes triangles of them, `raster` finds for each sample of a picture the nearest one, `shade` lights it;
//! 3. [`Scene::render`] gives a [`Picture`], [`film_strip`] several moments beside each other.
//!
//! A scene gives the same bytes everywhere: one thread draws it, with operations that IEEE 754 defines and those of `libm`.

mod camera;
mod geometry;
mod label;
mod muscles;
mod palette;
mod picture;
mod raster;
mod scene;
mod shade;
mod shadow;
mod solids;
mod strip;

pub use camera::View;
pub use palette::{Colouring, Theme};
pub use picture::{Picture, PictureError};
pub use scene::{Renderer, Scene};
pub use strip::{Strip, film_strip};

use nalgebra::Vector3;

/// A place or a direction in the world, m.
type Vector = Vector3<f32>;
/// Red, green and blue, 0 to 1, as sRGB has them.
type Rgb = [f32; 3];

/// Pixels of a side at most.
pub const LARGEST: u32 = 8192;

/// How a scene is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Pixels, 1 to [`LARGEST`] each.
    pub width: u32,
    /// Pixels, 1 to [`LARGEST`] each.
    pub height: u32,
    /// Where the camera stands; it follows the body.
    pub view: View,
    /// Light or dark.
    pub theme: Theme,
    /// Whether forces, markers and the scale of colours have their numbers and names.
    pub labels: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { width: 960, height: 720, view: View::ThreeQuarter, theme: Theme::Light, labels: true }
    }
}

impl Options {
    /// Whether there are pictures of that size.
    ///
    /// # Errors
    /// There are none.
    pub fn check(&self) -> Result<(), PictureError> {
        let fits = [self.width, self.height].iter().all(|pixels| (1..=LARGEST).contains(pixels));
        if fits { Ok(()) } else { Err(PictureError::Size(self.width, self.height)) }
    }
}

/// From `from` to `to` by a share.
fn mix(from: Rgb, to: Rgb, share: f32) -> Rgb {
    std::array::from_fn(|part| from[part] + (to[part] - from[part]) * share)
}

/// From 0 to 1 between two edges, smoothly.
fn smoothstep(low: f32, high: f32, value: f32) -> f32 {
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// A vector of the simulator.
fn single(value: &Vector3<f64>) -> Vector {
    value.map(|part| part as f32)
}

#[cfg(test)]
mod tests;
