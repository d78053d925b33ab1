//! Peaks of reactions, in body weights.
//!
//! The ground reaction is the sum of the vertical forces of the ground on the feet; the joint reaction is the largest force that any
//! joint bears (inverse dynamics with the forces of muscles, ligaments and contacts; Winter, "Biomechanics and Motor Control of Human
//! Movement", 4th ed., chapters 5 and 9). Both are the largest of all rows, the reset among them.

use crate::trace::{Quantity, Row};
use msk_physics::scalar::Real;

/// The largest reactions so far, N.
#[derive(Debug, Clone, Default)]
pub(super) struct Reactions {
    ground: Option<f64>,
    joint: Option<f64>,
    weight: f64,
}

impl Reactions {
    pub fn look(&mut self, row: &Row<'_>) {
        self.weight = row.layout().weight();
        let feet = row.of(Quantity::GroundReactions);
        if !feet.is_empty() {
            let vertical: f64 = feet.chunks_exact(7).map(|foot| foot[2]).sum();
            self.ground = Some(self.ground.map_or(vertical, |largest| largest.at_least(vertical)));
        }
        for &force in row.of(Quantity::JointReactions) {
            self.joint = Some(self.joint.map_or(force, |largest| largest.at_least(force)));
        }
    }

    fn in_weights(&self, force: Option<f64>) -> Option<f64> {
        force.filter(|_| self.weight > 0.0).map(|force| force / self.weight)
    }

    /// Peak of the ground reaction, body weights; `None` of a body without feet.
    pub fn ground(&self) -> Option<f64> {
        self.in_weights(self.ground)
    }

    /// Peak of the joint reactions, body weights.
    pub fn joint(&self) -> Option<f64> {
        self.in_weights(self.joint)
    }
}
