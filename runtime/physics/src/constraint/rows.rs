//! The rows' numbers, in MuJoCo's order and units.

use super::{impedance::SpringDamper, jacobian::Jacobian};
use crate::scalar::Real;

/// What a constraint row belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowKind {
    /// One of an equality's rows, by the equality's index.
    Equality(usize),
    /// Friction loss of a dof, by its index.
    DofFriction(usize),
    /// Friction loss of a tendon, by its index.
    TendonFriction(usize),
    /// Limit of a joint, by the joint's index.
    JointLimit(usize),
    /// Limit of a tendon, by its index.
    TendonLimit(usize),
    /// Normal, friction or edge of the friction pyramid of a contact, by the contact's index.
    Contact(usize),
}

impl RowKind {
    /// The index of what the row belongs to (`efc_id`).
    pub fn element(&self) -> usize {
        match *self {
            Self::Equality(index)
            | Self::DofFriction(index)
            | Self::TendonFriction(index)
            | Self::JointLimit(index)
            | Self::TendonLimit(index)
            | Self::Contact(index) => index,
        }
    }
}

/// All rows, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows {
    /// What the row belongs to (`efc_type`, `efc_id`).
    pub kind: Vec<RowKind>,
    /// Residual or distance (`efc_pos`).
    pub position: Vec<f64>,
    /// Distance at which the row becomes active (`efc_margin`).
    pub margin: Vec<f64>,
    /// J v (`efc_vel`), with the velocity of bodies that are moved from outside.
    pub velocity: Vec<f64>,
    /// Stiffness of the reference before scaling by the impedance, 1/s² (`efc_KBIP`).
    pub stiffness: Vec<f64>,
    /// Damping of the reference, 1/s (`efc_KBIP`).
    pub damping: Vec<f64>,
    /// Impedance (`efc_KBIP`).
    pub impedance: Vec<f64>,
    /// Approximate diagonal of J M^-1 J' (`efc_diagA`).
    pub diagonal: Vec<f64>,
    /// Regularisation R (`efc_R`).
    pub regularization: Vec<f64>,
    /// Inverse regularisation (`efc_D`).
    pub weight: Vec<f64>,
    /// Reference acceleration (`efc_aref`).
    pub reference: Vec<f64>,
    /// Least force. The rows of an elliptic cone have no forces of their own: both bounds are zero, and the cone's law holds.
    pub lower: Vec<f64>,
    /// Largest force.
    pub upper: Vec<f64>,
    /// Force (`efc_force`); filled by the solver.
    pub force: Vec<f64>,
}

/// Where a constraint stands, how soft it is, and what it may do.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Residual or distance.
    pub position: f64,
    /// Distance at which it becomes active.
    pub margin: f64,
    /// Stiffness, damping and impedance at its violation.
    pub spring: SpringDamper,
    /// Least and largest force.
    pub bounds: [f64; 2],
}

/// Forces of a constraint that pulls both ways.
pub(crate) const BOTH_WAYS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
/// Forces of a constraint that only pushes.
pub(crate) const ONE_WAY: [f64; 2] = [0.0, f64::INFINITY];

/// R of a row from its impedance and its entry in the diagonal of J M^-1 J'.
#[inline(always)]
pub(crate) fn regularization<T: Real>(impedance: T, approximate: T) -> T {
    ((T::splat(1.0) - impedance) / impedance * approximate).at_least(T::splat(1e-15))
}

impl Rows {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.kind.len()
    }

    /// Whether nothing is constrained.
    pub fn is_empty(&self) -> bool {
        self.kind.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.kind.clear();
        for array in [
            &mut self.position,
            &mut self.margin,
            &mut self.velocity,
            &mut self.stiffness,
            &mut self.damping,
            &mut self.impedance,
            &mut self.diagonal,
            &mut self.regularization,
            &mut self.weight,
            &mut self.reference,
            &mut self.lower,
            &mut self.upper,
            &mut self.force,
        ] {
            array.clear();
        }
    }

    /// Appends a row; `approximate` is its entry in the diagonal of J M^-1 J'.
    pub(super) fn push(&mut self, kind: RowKind, place: Place, approximate: f64) {
        let Place { position, margin, spring, bounds: [lower, upper] } = place;
        self.kind.push(kind);
        self.position.push(position);
        self.margin.push(margin);
        self.stiffness.push(spring.stiffness);
        self.damping.push(spring.damping);
        self.impedance.push(spring.impedance);
        self.regularization.push(regularization(spring.impedance, approximate));
        self.lower.push(lower);
        self.upper.push(upper);
    }

    /// Completes the arrays that follow from R, the Jacobian and the velocities.
    pub(super) fn finish(&mut self, jacobian: &Jacobian, velocity: &[f64], drift: &[(usize, f64)]) {
        let count = self.len();
        self.velocity.resize(count, 0.0);
        jacobian.multiply(velocity, &mut self.velocity);
        drift.iter().for_each(|(row, velocity)| self.velocity[*row] += velocity);
        for row in 0..count {
            let (impedance, regularization) = (self.impedance[row], self.regularization[row]);
            self.diagonal.push(regularization * impedance / (1.0 - impedance));
            self.weight.push(1.0 / regularization);
            let pull = self.stiffness[row] * impedance * (self.position[row] - self.margin[row]);
            self.reference.push(-self.damping[row] * self.velocity[row] - pull);
        }
        self.force.resize(count, 0.0);
    }
}
