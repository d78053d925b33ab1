//! Recruitment by family: A_k = Σ_{m in k} mean_t a_m(t), the activation mass of family k, over the samples before a step, and its share
//! P_k = A_k / Σ_k A_k. Both are dimensionless.
//!
//! Families are those of the body file, which assigns every muscle to exactly one: published tables of keywords count some names twice
//! (`SUPSP` as `SUP`, `EPL` as `PL`).

use crate::trace::{Quantity, Row};

/// Sums up activations.
#[derive(Debug, Clone, Default)]
pub struct Recruitment {
    sums: Vec<f64>,
    samples: u32,
    last: Vec<f64>,
    /// Families, and that of each muscle.
    families: Vec<String>,
    of: Vec<Option<usize>>,
}

impl Recruitment {
    /// Adds the next row.
    pub fn look(&mut self, row: &Row<'_>) {
        let activations = row.of(Quantity::Activations);
        if self.of.is_empty() {
            let layout = row.layout();
            self.families.clone_from(&layout.families);
            let family = |muscle: &crate::trace::Muscle| layout.families.iter().position(|family| *family == muscle.family);
            self.of = layout.muscles.iter().map(family).collect();
            self.sums = vec![0.0; activations.len()];
        }
        if !self.last.is_empty() {
            self.sums.iter_mut().zip(&self.last).for_each(|(sum, activation)| *sum += activation);
            self.samples += 1;
        }
        self.last.clear();
        self.last.extend_from_slice(activations);
    }

    /// Mean activation of every muscle; none without a step.
    pub fn means(&self) -> Vec<f64> {
        if self.samples == 0 {
            return Vec::new();
        }
        self.sums.iter().map(|sum| sum / f64::from(self.samples)).collect()
    }

    /// Activation mass of every family, in the order of the body file.
    pub fn masses(&self) -> Vec<(String, f64)> {
        let means = self.means();
        if means.is_empty() {
            return Vec::new();
        }
        let mass =
            |family: usize| means.iter().zip(&self.of).filter(|(_, of)| **of == Some(family)).map(|(mean, _)| mean).sum::<f64>();
        self.families.iter().enumerate().map(|(index, name)| (name.clone(), mass(index))).collect()
    }
}

/// Shares of activation masses; all are zero where nothing is active.
pub fn shares(masses: &[(String, f64)]) -> Vec<(String, f64)> {
    let whole: f64 = masses.iter().map(|(_, mass)| mass).sum();
    masses.iter().map(|(name, mass)| (name.clone(), if whole > 0.0 { mass / whole } else { 0.0 })).collect()
}
