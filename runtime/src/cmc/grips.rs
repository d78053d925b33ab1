//! Grips: where the body is held by connections and welds to what does not move, such as hands that are welded to a bar.
//!
//! A grip pulls and pushes in every direction. A connection holds one point, a weld three around its origin, which bear torques, too.

use super::Present;
use super::feedback::HANGING;
use super::support::Point;
use super::wishes::{Bearing, PointWish, Wishes};
use msk_physics::model::{Equality, Model};
use msk_physics::moving_dofs;
use nalgebra::Vector3;

/// A point of the body that is held.
#[derive(Debug, Clone, Copy)]
struct Grip {
    /// The equality that holds it.
    equality: usize,
    body: usize,
    /// In the body's frame, m.
    position: Vector3<f64>,
}

/// The points that equalities of a model hold.
#[derive(Debug, Clone)]
pub(super) struct Grips(Vec<Grip>);

/// How far the points of a weld are from its origin, m.
const RADIUS: f64 = 0.04;
/// Keys of grips come after those of all points of feet.
const FIRST_KEY: usize = 1 << (usize::BITS - 1);
/// A point that is held rests whatever else is wished for: its weight, squared.
const WEIGHT: f64 = 100.0;

impl Grips {
    /// Those of a model: one body of the equality stands still, muscles may move the other.
    pub fn new(model: &Model) -> Self {
        let mut grips = Vec::new();
        for (equality, kind) in model.equalities.kind.iter().enumerate() {
            let (attachment, arms): (_, &[Vector3<f64>]) = match kind {
                Equality::Connect(attachment) => (attachment, &[Vector3::new(0.0, 0.0, 0.0)]),
                Equality::Weld { attachment, .. } => (
                    attachment,
                    &[Vector3::new(RADIUS, 0.0, 0.0), Vector3::new(0.0, RADIUS, 0.0), Vector3::new(0.0, 0.0, RADIUS)],
                ),
                Equality::Joint(_) | Equality::Tendon(_) => continue,
            };
            let moves = attachment.bodies.map(|body| !moving_dofs(model, body).is_empty());
            let side = match moves {
                [true, false] => 0,
                [false, true] => 1,
                _ => continue,
            };
            let (body, origin) = (attachment.bodies[side], attachment.position[side]);
            grips.extend(arms.iter().map(|arm| Grip { equality, body, position: origin + arm }));
        }
        Self(grips)
    }

    /// The bodies that are held, in the order of the model's equalities.
    pub fn carriers(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().map(|grip| grip.body)
    }

    /// Wishes that the points which are held now stay where they are, and that a body which has nothing else to lean on hangs still.
    pub fn wish(&self, present: &Present<'_>, wishes: &mut Wishes) {
        let &Present { state, workspace, .. } = present;
        let mut held = self.0.iter().enumerate().filter(|(_, grip)| state.active[grip.equality] != 0.0).peekable();
        let stands = wishes.points.iter().any(|wish| wish.bearing == Bearing::Ground);
        if !stands && held.peek().is_some() {
            wishes.centre.laws = HANGING;
        }
        for (index, &Grip { body, position, .. }) in held {
            let (origin, rotation) = (workspace.kinematics.body_position[body], workspace.kinematics.body_rotation[body]);
            let point = Point {
                key: FIRST_KEY + index,
                body,
                position: origin + rotation * position,
                normal: Vector3::z(),
                height: 0.0,
                friction: 0.0,
            };
            wishes.points.push(PointWish { bearing: Bearing::Grip, ..PointWish::at_rest(point, WEIGHT) });
        }
    }
}
