//! Ground that is not level: where a foot may land on it, and how high it has to go over it.

use super::step::Way;
use crate::cmc::{Present, turning};
use crate::scene::ground::Ground;
use msk_physics::scalar::Real;
use nalgebra::{Vector2, Vector3};

/// The ground of a scene with more than one plane.
#[derive(Clone, Copy)]
pub(super) struct Terrain<'a>(Ground<'a>);

/// Where a sole has its heel, what has to bear, and its toes, ahead of the middle of its points, m.
const SOLE: [f64; 4] = [-0.1, -0.04, 0.06, 0.18];
/// Ground under a sole may rise by this share of the way along it.
const SLOPE: f64 = 0.12;
/// Shifts of a landing that are tried, m, in this order: a foot that lands short lets the body go on, one that lands far ahead stops it.
const SHIFTS: [f64; 14] = [0.0, -0.03, -0.06, 0.03, -0.09, -0.12, 0.06, -0.16, -0.2, 0.09, -0.24, 0.12, 0.16, 0.2];
/// And by so much besides, m.
const EVEN: f64 = 0.005;
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

    /// Heights under the places of a sole.
    fn heights(&self, middle: Vector2<f64>, heading: f64) -> [f64; 4] {
        SOLE.map(|along| self.0.height(middle + turning::level(Vector2::new(along, 0.0), heading)))
    }

    /// The place near another where a sole finds ground that is not much higher or lower than `height` (m): even where it bears, and nowhere above
    /// that; the other one itself, at that height, if there is none.
    pub fn foothold(&self, place: Vector2<f64>, heading: f64, height: f64) -> Vector3<f64> {
        let shifted = SHIFTS.iter().map(|&shift| place + turning::level(Vector2::new(shift, 0.0), heading));
        let found = shifted.filter_map(|place| {
            let (under, heights) = (self.0.height(place), self.heights(place, heading));
            let rises = |part: usize| heights[part] - under;
            let even = [1, 2].into_iter().all(|part| rises(part).abs() < SLOPE * SOLE[part].abs() + EVEN);
            let free = [0, 3].into_iter().all(|part| rises(part) < SLOPE * SOLE[part].abs() + EVEN);
            (even && free && (under - height).abs() < CLIMB).then(|| place.push(under))
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
            let heights = self.heights(place.xy(), way.heading);
            let highest = heights.iter().zip(tilt).map(|(height, tilt)| height - tilt).fold(f64::NEG_INFINITY, f64::at_least);
            (highest + CLEAR * gain - place.z) / gain.at_least(0.1)
        });
        missing.fold(0.0, f64::at_least).at_most(MOST_LIFT)
    }
}
