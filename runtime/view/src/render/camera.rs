//! A camera that looks at the body, from the places that the page has.

use super::Vector;
use std::f64::consts::{FRAC_PI_2, PI};

/// Where the camera stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// From in front and a little from the right.
    #[default]
    ThreeQuarter,
    /// From in front.
    Front,
    /// From the body's right.
    Right,
    /// From behind.
    Back,
    /// From the body's left.
    Left,
    /// From above.
    Above,
}

impl View {
    /// All, by the names that they have in the page and on a command line.
    pub const NAMED: [(&str, Self); 6] = [
        ("three-quarter", Self::ThreeQuarter),
        ("front", Self::Front),
        ("right", Self::Right),
        ("back", Self::Back),
        ("left", Self::Left),
        ("above", Self::Above),
    ];

    /// Angles about the vertical and above the horizon, rad.
    fn angles(self) -> [f64; 2] {
        match self {
            Self::ThreeQuarter => [-0.65, 0.18],
            Self::Front => [0.0, 0.05],
            Self::Right => [-FRAC_PI_2, 0.05],
            Self::Back => [PI, 0.05],
            Self::Left => [FRAC_PI_2, 0.05],
            Self::Above => [-FRAC_PI_2, 1.5],
        }
    }
}

/// Distance from what it looks at, m.
const DISTANCE: f32 = 3.7;
/// Height of what it looks at, m.
const HEIGHT: f32 = 0.92;
/// Angle from the lower to the upper edge of a picture, rad.
const FIELD: f64 = 0.55;
/// Nearer than this nothing is drawn, m.
pub(super) const NEAR: f32 = 0.05;

/// A camera for pictures of one size.
#[derive(Debug, Clone)]
pub(super) struct Camera {
    pub eye: Vector,
    right: Vector,
    up: Vector,
    forward: Vector,
    /// Pixels per unit of the tangent.
    focal: f32,
    middle: [f32; 2],
}

impl Camera {
    /// Looks at the body whose root is at `centre`, for a picture of so many pixels.
    pub fn new(view: View, centre: Vector, [width, height]: [f32; 2]) -> Self {
        let [yaw, pitch] = view.angles();
        let level = libm::cos(pitch);
        let back = Vector::new((level * libm::cos(yaw)) as f32, (level * libm::sin(yaw)) as f32, libm::sin(pitch) as f32);
        let target = Vector::new(centre.x, centre.y, HEIGHT);
        // In a narrow picture the body shall fit as well.
        let mut eye = target + back * (DISTANCE * (0.72 * height / width).max(1.0));
        eye.z = eye.z.max(NEAR);
        let vertical = match pitch > 1.45 {
            true => Vector::new(-libm::cos(yaw) as f32, -libm::sin(yaw) as f32, 0.0),
            false => Vector::z(),
        };
        let forward = (target - eye).normalize();
        let right = forward.cross(&vertical).normalize();
        let focal = 0.5 * height / libm::tan(0.5 * FIELD) as f32;
        Self { eye, right, up: right.cross(&forward), forward, focal, middle: [0.5 * width, 0.5 * height] }
    }

    /// Where a place is seen: pixels from the left and from above, and its depth along the line of sight, m.
    pub fn project(&self, place: &Vector) -> [f32; 3] {
        let from = place - self.eye;
        let depth = from.dot(&self.forward);
        let scale = self.focal / depth;
        [self.middle[0] + scale * from.dot(&self.right), self.middle[1] - scale * from.dot(&self.up), depth]
    }

    /// The direction of what is seen at a place of the picture, as long as reaches a depth of 1 m.
    pub fn ray(&self, x: f32, y: f32) -> Vector {
        self.forward + self.right * ((x - self.middle[0]) / self.focal) + self.up * ((self.middle[1] - y) / self.focal)
    }
}
