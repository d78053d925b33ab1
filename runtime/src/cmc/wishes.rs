//! What the controller of one episode wishes for, in plain numbers: the compromise between wishes is found for several episodes at once.

use super::support::Point;
use nalgebra::Vector3;

/// The wishes of one control step.
#[derive(Debug, Clone, Default)]
pub(super) struct Wishes {
    /// Of each independent coordinate the weight of its wish, squared, and that times the acceleration wished for.
    pub coordinates: Vec<[f64; 2]>,
    pub centre: CentreWish,
    /// The points that bear weight, keys ascending, with the weights of their wishes to come to rest, squared: 0 for one that is to move.
    pub feet: Vec<(Point, f64)>,
}

/// The wish for an acceleration of the centre of mass, in world axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct CentreWish {
    /// From where it is to where it shall be, m.
    pub error: Vector3<f64>,
    /// Velocity and acceleration that the reference has, m/s and m/s².
    pub moving: Vector3<f64>,
    pub bending: Vector3<f64>,
    /// Factor of the weights; 0 without a wish.
    pub factor: f64,
}

impl Default for CentreWish {
    fn default() -> Self {
        let zeros = Vector3::zeros();
        Self { error: zeros, moving: zeros, bending: zeros, factor: 0.0 }
    }
}

impl Wishes {
    /// Forgets all wishes of so many independent coordinates.
    pub fn clear(&mut self, coordinates: usize) {
        self.coordinates.clear();
        self.coordinates.resize(coordinates, [0.0; 2]);
        self.centre = CentreWish::default();
        self.feet.clear();
    }

    /// Adds the wish of a coordinate for an acceleration.
    pub fn add(&mut self, coordinate: usize, weight: f64, acceleration: f64) {
        let [total, weighted] = &mut self.coordinates[coordinate];
        *total += weight * weight;
        *weighted += weight * weight * acceleration;
    }
}
