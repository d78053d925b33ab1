//! Orthographic views: the world as seen from far away, in millimetres, with a depth to sort by.

use nalgebra::{Vector2, Vector3};

/// Where the picture is taken from. The body is taken to face world x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// From the body's right side, facing right in the picture.
    Side,
    /// From in front; the body's left is on the right of the picture.
    Front,
    /// From behind; the body's right is on the right of the picture.
    Back,
}

impl View {
    /// How far to the left and right of the body a picture reaches at most, mm.
    pub(super) fn window(self) -> [f64; 2] {
        match self {
            Self::Side => [1800.0, 3600.0],
            Self::Front | Self::Back => [1500.0, 1500.0],
        }
    }

    /// Its name, for captions.
    pub fn name(self) -> &'static str {
        match self {
            Self::Side => "side",
            Self::Front => "front",
            Self::Back => "back",
        }
    }
}

/// A projection onto the picture plane: x to the right, y downwards, in millimetres, the world's origin at (0, 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Camera {
    right: Vector3<f64>,
    up: Vector3<f64>,
    /// Points away from the viewer.
    away: Vector3<f64>,
}

const MILLIMETRES: f64 = 1000.0;

impl Camera {
    pub fn new(view: View) -> Self {
        let (right, away) = match view {
            View::Side => (Vector3::x(), Vector3::y()),
            View::Front => (Vector3::y(), -Vector3::x()),
            View::Back => (-Vector3::y(), Vector3::x()),
        };
        Self { right, up: Vector3::z(), away }
    }

    /// A point (m) in the picture (mm).
    pub fn project(&self, point: Vector3<f64>) -> Vector2<f64> {
        self.direction(point)
    }

    /// A vector (m) in the picture (mm).
    pub fn direction(&self, vector: Vector3<f64>) -> Vector2<f64> {
        Vector2::new(self.right.dot(&vector), -self.up.dot(&vector)) * MILLIMETRES
    }

    /// Distance from the viewer (m), up to a constant.
    pub fn depth(&self, point: Vector3<f64>) -> f64 {
        self.away.dot(&point)
    }

    /// The direction away from the viewer, in the world.
    pub fn away(&self) -> Vector3<f64> {
        self.away
    }
}
