//! The rows' numbers, in MuJoCo's order and units.

use super::{impedance::spring_damper, jacobian::Jacobian};
use crate::model::Softness;

/// What a constraint row belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowKind {
    /// Joint coupling, by its index.
    Coupling(usize),
    /// Limit of a joint, by the joint's index.
    Limit(usize),
    /// Edge of a contact's friction pyramid (or its normal), by the contact's index.
    Contact(usize),
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
    /// J v (`efc_vel`).
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
    /// Least force.
    pub lower: Vec<f64>,
    /// Largest force.
    pub upper: Vec<f64>,
    /// Force (`efc_force`); filled by the solver.
    pub force: Vec<f64>,
}

/// Where a constraint stands and how soft it is.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// Residual or distance.
    pub position: f64,
    /// Distance at which it becomes active.
    pub margin: f64,
    /// Its softness.
    pub softness: &'a Softness,
    /// Physics step, s.
    pub timestep: f64,
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
    pub(super) fn push(&mut self, kind: RowKind, place: Place<'_>, approximate: f64) {
        let spring = spring_damper(place.softness, place.position - place.margin, place.timestep);
        self.kind.push(kind);
        self.position.push(place.position);
        self.margin.push(place.margin);
        self.stiffness.push(spring.stiffness);
        self.damping.push(spring.damping);
        self.impedance.push(spring.impedance);
        self.regularization.push(((1.0 - spring.impedance) / spring.impedance * approximate).max(1e-15));
        self.lower.push(if matches!(kind, RowKind::Coupling(_)) { f64::NEG_INFINITY } else { 0.0 });
        self.upper.push(f64::INFINITY);
    }

    /// Completes the arrays that follow from R, the Jacobian and the velocities.
    pub(super) fn finish(&mut self, jacobian: &Jacobian, velocity: &[f64]) {
        let count = self.len();
        self.velocity.resize(count, 0.0);
        jacobian.multiply(velocity, &mut self.velocity);
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
