//! What the controller of one episode wishes for, in plain numbers: the compromise between wishes is found for several episodes at once.

use super::feedback::{CENTRE, FEET, Law};
use super::support::Point;
use nalgebra::Vector3;

/// The wishes of one control step.
#[derive(Debug, Clone, Default)]
pub(super) struct Wishes {
    /// Of each independent coordinate the weight of its wish, squared, and that times the acceleration wished for.
    pub coordinates: Vec<[f64; 2]>,
    pub centre: CentreWish,
    /// Of points of the feet that bear weight or are to go somewhere, and of points that are held; keys ascending.
    pub points: Vec<PointWish>,
}

/// The wish for an acceleration of the centre of mass, in world axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct CentreWish {
    /// From where it is to where it shall be, m.
    pub error: Vector3<f64>,
    /// Velocity and acceleration that the reference has, m/s and m/s².
    pub moving: Vector3<f64>,
    pub bending: Vector3<f64>,
    /// Along each axis.
    pub laws: [Law; 3],
    /// Factor of the weights; 0 without a wish.
    pub factor: f64,
}

/// Which forces act at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bearing {
    /// None.
    None,
    /// The ground presses, and rubs.
    Ground,
    /// A grip pulls and pushes in every direction.
    Grip,
}

/// What is wished for of a point of the body, in world axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointWish {
    pub point: Point,
    pub bearing: Bearing,
    /// Its weight is squared already: 0 for a point that moves as it likes.
    pub law: Law,
    /// From where it is to where it shall be, m.
    pub error: Vector3<f64>,
    /// Velocity and acceleration that it shall have, m/s and m/s².
    pub moving: Vector3<f64>,
    pub bending: Vector3<f64>,
}

impl PointWish {
    /// A point that bears weight, and comes to rest where it is with this weight, squared.
    pub fn at_rest(point: Point, weight: f64) -> Self {
        let zeros = Vector3::zeros();
        Self { point, bearing: Bearing::Ground, law: Law { weight, ..FEET }, error: zeros, moving: zeros, bending: zeros }
    }
}

impl Default for CentreWish {
    fn default() -> Self {
        let zeros = Vector3::zeros();
        Self { error: zeros, moving: zeros, bending: zeros, laws: CENTRE, factor: 0.0 }
    }
}

impl Wishes {
    /// Forgets all wishes of so many independent coordinates.
    pub fn clear(&mut self, coordinates: usize) {
        self.coordinates.clear();
        self.coordinates.resize(coordinates, [0.0; 2]);
        self.centre = CentreWish::default();
        self.points.clear();
    }

    /// Adds the wish of a coordinate for an acceleration.
    pub fn add(&mut self, coordinate: usize, weight: f64, acceleration: f64) {
        let [total, weighted] = &mut self.coordinates[coordinate];
        *total += weight * weight;
        *weighted += weight * weight * acceleration;
    }
}
