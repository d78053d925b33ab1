//! Ground that is not level: where a foot may land on it, and how high it has to go over it.

use super::step::Way;
use crate::cmc::{Present, turning};
use crate::scene::ground::Ground;
use msk_physics::scalar::Real;
use nalgebra::{Vector2, Vector3};

/// The ground of a scene with more than one plane.
#[derive(Clone, Copy)]
pub(super) struct Terrain<'a>(Ground<'a>);

/// How far a sole reaches back and ahead of the middle of its points, m.
const SOLE: [f64; 2] = [-0.1, 0.18];
/// Ground under one sole may be uneven by this share of the sole's length.
const UNEVEN: f64 = 0.12;
/// Shifts of a landing that are tried, m: to the nearest that is even.
const SHIFTS: [f64; 13] = [0.0, 0.03, -0.03, 0.06, -0.06, 0.09, -0.09, 0.12, -0.12, 0.16, -0.16, 0.2, -0.2];
/// What is this much higher or lower than the other foot is no place to land, m.
const CLIMB: f64 = 0.35;
/// How far over the ground a foot goes in the middle of its way, m, and how much higher than usual at most.
const CLEAR: f64 = 0.03;
const MOST_LIFT: f64 = 0.3;
/// Moments of a way at which that is looked at.
const MOMENTS: u32 = 10;

impl<'a> Terrain<'a> {
    /// That under a body; `None` where it is level.
    pub fn under(present: &Present<'a>) -> Option<Self> {
        let &Present { body, model, workspace, .. } = present;
        let ground = Ground { model, kinematics: &workspace.kinematics, shapes: &body.ground };
        (body.ground != body.level).then_some(Self(ground))
    }

    /// Heights under heel, middle and toes of a sole.
    fn heights(&self, middle: Vector2<f64>, heading: f64) -> [f64; 3] {
        let [back, ahead] = SOLE.map(|along| turning::level(Vector2::new(along, 0.0), heading));
        [middle + back, middle, middle + ahead].map(|place| self.0.height(place))
    }

    /// The place near another where a whole sole finds ground that is about as high as `height` (m); the other one itself, at that height, if there is none.
    pub fn foothold(&self, place: Vector2<f64>, heading: f64, height: f64) -> Vector3<f64> {
        let shifted = SHIFTS.iter().map(|&shift| place + turning::level(Vector2::new(shift, 0.0), heading));
        let found = shifted.filter_map(|place| {
            let heights = self.heights(place, heading);
            let (low, high) = heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &height| (low.at_most(height), high.at_least(height)));
            let fits = high - low < UNEVEN * (SOLE[1] - SOLE[0]) && (heights[1] - height).abs() < CLIMB;
            fits.then(|| place.push(heights[1]))
        });
        found.into_iter().next().unwrap_or_else(|| place.push(height))
    }

    /// The upward normal of the ground.
    pub fn normal(&self, place: Vector2<f64>) -> Vector3<f64> {
        self.0.normal(place)
    }

    /// By how much more than usual a foot has to be lifted on its way, m. Its sole is tilted as the ground is where it lands.
    pub fn lift(&self, way: &Way) -> f64 {
        let tilt = SOLE.map(|along| {
            let part = turning::level(Vector2::new(along, 0.0), way.heading);
            -part.dot(&way.normal.xy()) / way.normal.z.at_least(0.5)
        });
        let missing = (1..MOMENTS).map(|moment| {
            let share = f64::from(moment) / f64::from(MOMENTS);
            let (place, gain) = (way.at(share), way.gain(share));
            let [heel, middle, toe] = self.heights(place.xy(), way.heading);
            let highest = middle.at_least(heel - tilt[0]).at_least(toe - tilt[1]);
            (highest + CLEAR * gain - place.z) / gain.at_least(0.1)
        });
        missing.fold(0.0, f64::at_least).at_most(MOST_LIFT)
    }
}
