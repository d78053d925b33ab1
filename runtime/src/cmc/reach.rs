//! Hands that reach: the joints of an arm bend until its hand is where it shall be.
//!
//! The way e that is missing becomes a change of the joints' targets by damped least squares, Δq = J' (J J' + λ² I)⁻¹ e (Wampler, Manipulator
//! inverse kinematic solutions based on vector formulations and damped least-squares methods, IEEE Trans. Systems, Man and Cybernetics 16, 1986),
//! anew in every control step. The trunk has a part in it only where other targets move it: one that leans after a hand costs the balance.

use super::coordinates::{Coordinates, Slopes};
use super::feedback::{Feedback, Law};
use super::motion::Moved;
use super::wishes::Wishes;
use super::{Offsets, Present, View};
use crate::body::Body;
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// Of the joints that bring a hand there.
const REACH: Law = Law::critical(300.0, 17.3, 2.0);
/// λ, m.
const DAMPING: f64 = 0.1;
/// How far a hand is to go in one step at most, m.
const STRIDE: f64 = 0.25;
/// What carries less than this share of the body belongs to an arm, what carries more to the trunk.
const ARM: f64 = 0.15;
/// An offset of this length or more counts wholly, m; a smaller one less, so that none asks for nothing.
const WHOLE: f64 = 0.1;

/// Where hands are when an episode begins, from the root in its heading: forward, left, up, m.
pub(super) fn at_rest(present: &Present<'_>) -> Vec<Vector3<f64>> {
    let &Present { body, workspace, .. } = present;
    let (root, heading) = (workspace.kinematics.body_position[body.root.body], body.root_heading(&workspace.kinematics));
    let place = |&hand: &usize| body.landmark_position(&workspace.kinematics, hand);
    body.hands().iter().map(|hand| heading.transpose() * (place(hand) - root)).collect()
}

/// Memory for what moves hands, laid out once per model.
#[derive(Debug, Clone)]
pub(super) struct Reaching {
    slopes: Slopes<f64>,
    arms: Vec<Arm>,
    motion: Vec<Vector3<f64>>,
}

/// What moves one hand.
#[derive(Debug, Clone)]
struct Arm {
    hand: usize,
    moved: Moved,
    /// Which of its coordinates belong to the arm.
    own: Vec<bool>,
}

impl Reaching {
    pub fn new(model: &Model, body: &Body, coordinates: &Coordinates) -> Self {
        let carried = |dof: usize| model.bodies.subtree_mass[model.dofs.body[dof]];
        let arm = |&hand: &usize| {
            let moved = Moved::body(model, coordinates, body.landmarks[hand].body);
            let own = moved.coordinates.iter().map(|&coordinate| carried(coordinates.dofs[coordinate]) < ARM * body.mass);
            Arm { hand, own: own.collect(), moved }
        };
        let arms = body.hands().iter().map(arm).collect();
        Self { slopes: Slopes::new(coordinates), arms, motion: Vec::new() }
    }

    /// Adds the wishes of joints that bring hands where `offsets` have them, from where they are at `rest`.
    pub fn wish(
        &mut self,
        (present, view): (&Present<'_>, &View<'_>),
        rest: &[Vector3<f64>],
        feedback: &Feedback,
        offsets: &Offsets,
        wishes: &mut Wishes,
    ) {
        let &Present { body, model, state, workspace } = present;
        if offsets.hands.iter().all(|(_, offset)| *offset == Vector3::zeros()) {
            return;
        }
        let Self { slopes, arms, motion } = self;
        slopes.update(view.coordinates, model, state);
        let kinematics = &workspace.kinematics;
        let (root, heading) = (kinematics.body_position[body.root.body], body.root_heading(kinematics));
        for (Arm { hand, moved, own }, rest) in arms.iter().zip(rest) {
            let Some((_, offset)) = offsets.hands.iter().find(|(moved, _)| moved == hand) else { continue };
            let length = offset.norm();
            if length == 0.0 {
                continue;
            }
            let place = body.landmark_position(kinematics, *hand);
            let missing = root + heading * (rest + offset) - place;
            let missing = missing * (STRIDE / missing.norm().at_least(STRIDE));
            moved.point((model, kinematics, slopes), (body.landmarks[*hand].body, &place), motion);
            let mut matrix = Matrix3::identity() * (DAMPING * DAMPING);
            let bends = || moved.coordinates.iter().zip(&*motion).zip(own).filter(|(_, own)| **own).map(|(bend, _)| bend);
            for (_, column) in bends() {
                matrix += column * column.transpose();
            }
            // Positive definite by the damping.
            let Some(pull) = matrix.cholesky().map(|factors| factors.solve(&missing)) else { continue };
            let law = Law { weight: REACH.weight * (length / WHOLE).at_most(1.0), ..REACH };
            let changes = bends().map(|(coordinate, column)| (*coordinate, column.dot(&pull)));
            feedback.wish_changes(changes, &law, (view, body), wishes);
        }
    }
}
