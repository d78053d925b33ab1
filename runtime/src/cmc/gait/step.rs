//! What one hold of a gait is for: where the body is to be pushed, and where its feet are to go.

use super::super::CONTACT_HEIGHT;
use super::super::feedback::Law;
use super::super::support::Point;
use super::super::wishes::{Bearing, PointWish};
use super::pace::Manner;
use crate::cmc::{Present, turning};
use core::ops::Range;
use msk_physics::scalar::Real;
use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};

/// Which share of its time a foot takes to be where it lands; in what is left it seeks the ground, and goes this far below, m.
const ARRIVED: f64 = 0.914;
const SEEK: f64 = 0.02;
/// Stiffness (1/s²) and weight of points of a foot on its way.
const SWING_STIFFNESS: f64 = 440.0;
const SWING_WEIGHT: f64 = 0.98;
/// Which share of its way up a foot takes for the whole rise of the ground.
const SOON: f64 = 0.46;
/// After this share of its time a foot may bear where it meets the ground.
const LANDS: f64 = 0.5;

/// One of two feet.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Foot {
    /// The body that carries the sole, and the axes forward, left, up of the sole in that.
    pub body: usize,
    pub axes: Matrix3<f64>,
    /// Keys of its points.
    pub keys: Range<usize>,
    /// 1 for the left one, -1 for the right one.
    pub side: f64,
    /// Heading of the sole from that of the body, rad.
    pub toes: f64,
}

/// Where a sole is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    /// The middle of its points, m.
    pub middle: Vector3<f64>,
    /// Where it points, rad.
    pub heading: f64,
    /// Of its lowest point over the ground, m.
    pub height: f64,
}

/// What one hold of a gait is for.
#[derive(Debug, Clone)]
pub(in crate::cmc) struct Step {
    /// Of the root, and how it turns, in its own axes, rad/s.
    pub orientation: [f64; 4],
    pub spin: Vector3<f64>,
    /// Of the centre of mass, m, and how fast it rises, m/s.
    pub height: f64,
    pub rise: f64,
    /// Of the centre of mass along the ground, m/s².
    pub acceleration: Vector2<f64>,
    pub(super) swing: Option<Swing>,
    pub(super) roll: Option<Roll>,
    pub(super) manner: Manner,
}

/// A foot that bears and that the body has passed: its heel may rise.
#[derive(Debug, Clone)]
pub(super) struct Roll {
    pub keys: Range<usize>,
    /// The middle of its sole, m, and where it points.
    pub middle: Vector2<f64>,
    pub forward: Vector2<f64>,
}

/// The way of a foot in one hold.
#[derive(Debug, Clone)]
pub(super) struct Swing {
    body: usize,
    keys: Range<usize>,
    /// Where the sole is, and where it shall be.
    present: (Vector3<f64>, Matrix3<f64>),
    goal: (Vector3<f64>, Matrix3<f64>),
    moving: Vector3<f64>,
    bending: Vector3<f64>,
    /// Whether it may bear where it meets the ground.
    bears: bool,
}

/// Where a foot goes after it has left the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    pub from: Placed,
    /// Where its middle lands, m, and where it points then, rad.
    pub to: Vector3<f64>,
    pub heading: f64,
    /// Of the ground there.
    pub normal: Vector3<f64>,
    /// How high it is lifted, m.
    pub lift: f64,
}

impl Placed {
    /// Height of the ground under it, m.
    pub fn ground(&self) -> f64 {
        self.middle.z - self.height
    }
}

impl Foot {
    /// Where its sole is, by the points that the sole itself carries.
    pub fn placed(&self, present: &Present<'_>, points: &[Point]) -> Placed {
        let own = || points.iter().filter(|point| self.keys.contains(&point.key) && point.body == self.body);
        let forward = present.workspace.kinematics.body_rotation[self.body] * self.axes.column(0);
        Placed {
            middle: own().map(|point| point.position).sum::<Vector3<f64>>() / (own().count() as f64).at_least(1.0),
            heading: libm::atan2(forward.y, forward.x),
            height: own().map(|point| point.height).fold(f64::INFINITY, f64::at_most),
        }
    }
}

impl Way {
    /// Where the middle is after a share of the time. It goes up before it goes on, and down after that.
    pub fn at(&self, share: f64) -> Vector3<f64> {
        let ((along, bump), way) = (eased(share), self.to - self.from.middle);
        let (risen, _) = eased(if way.z > 0.0 { share / SOON } else { (share - (ARRIVED - SOON * ARRIVED)) / SOON });
        let sunk = SEEK * ((share - ARRIVED) / (1.0 - ARRIVED)).clip(0.0, 1.0);
        let level = Vector3::new(way.x * along, way.y * along, way.z * risen);
        self.from.middle + level + Vector3::z() * (self.lift * bump - sunk)
    }

    /// By how much it is higher after a share of the time if it is lifted by 1 more.
    pub fn gain(&self, share: f64) -> f64 {
        eased(share).1
    }

    /// What is to be done `time` (s) after the foot has left, in a hold of that length, s, by a foot whose sole has its middle there.
    pub fn swing(
        &self,
        (foot, manner): (&Foot, &Manner),
        present: &Present<'_>,
        middle: Vector3<f64>,
        [time, hold]: [f64; 2],
    ) -> Swing {
        let share = |time: f64| time / (manner.timing.single + manner.early);
        let (bearing, time) = (time + hold <= manner.early, time + manner.ahead);
        let [now, next, later] = [0.0, 1.0, 2.0].map(|holds| self.at(share(time + holds * hold)));
        let (along, _) = eased(share(time + hold));
        let heading = self.from.heading + turning::between(self.from.heading, self.heading) * along;
        let rotation = present.workspace.kinematics.body_rotation[foot.body] * foot.axes;
        Swing {
            body: foot.body,
            keys: foot.keys.clone(),
            present: (middle, rotation),
            goal: (next, upright(heading, &self.normal)),
            moving: (later - now) / (2.0 * hold),
            bending: (later - next * 2.0 + now) / (hold * hold),
            bears: bearing || share(time) > LANDS,
        }
    }
}

impl Step {
    /// How many times as stiff as usual the root, and the joints, are held.
    pub fn firmness(&self) -> [f64; 2] {
        self.manner.firmness
    }

    /// What is wished for of a point of a foot, if anything is.
    pub fn wish(&self, point: &Point) -> Option<PointWish> {
        let near = point.height < CONTACT_HEIGHT;
        let Some(swing) = self.swing.as_ref().filter(|swing| swing.keys.contains(&point.key)) else {
            let rolls =
                |roll: &&Roll| roll.keys.contains(&point.key) && (point.position.xy() - roll.middle).dot(&roll.forward) < 0.0;
            let weight = self.roll.as_ref().filter(rolls).map_or(self.manner.stance, |_| self.manner.heel);
            return near.then(|| PointWish::at_rest(*point, weight));
        };
        let bearing = if near && swing.bears { Bearing::Ground } else { Bearing::None };
        if point.body != swing.body {
            // Toes go along.
            return (bearing == Bearing::Ground).then(|| PointWish::at_rest(*point, 0.0));
        }
        let ((middle, rotation), (goal, facing)) = (swing.present, swing.goal);
        let arm = rotation.transpose() * (point.position - middle);
        let mut error = goal + facing * arm - point.position;
        error.z *= self.manner.clearing;
        let law = Law { stiffness: SWING_STIFFNESS, damping: self.manner.damping, weight: SWING_WEIGHT };
        Some(PointWish { point: *point, bearing, law, error, moving: swing.moving, bending: swing.bending })
    }
}

/// The axes forward, left, up of a sole that points there, on ground with that normal.
fn upright(heading: f64, normal: &Vector3<f64>) -> Matrix3<f64> {
    let facing = Rotation3::from_axis_angle(&Vector3::z_axis(), heading);
    // Level ground needs no tilt, and none is made up by rounding.
    let tilt = Rotation3::rotation_between(&Vector3::z(), normal).unwrap_or_else(Rotation3::identity);
    if normal.z < 1.0 { (tilt * facing).into_inner() } else { facing.into_inner() }
}

/// From 0 to 1 with a constant change of acceleration, which takes less speed than the least jerk, and a bump of height 1 between.
fn eased(share: f64) -> (f64, f64) {
    let u = (share / ARRIVED).clip(0.0, 1.0);
    (u * u * (3.0 - 2.0 * u), 16.0 * u * u * (1.0 - u) * (1.0 - u))
}
