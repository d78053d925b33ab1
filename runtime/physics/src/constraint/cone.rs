//! The law of a contact with an elliptic friction cone.
//!
//! The force f = (normal, friction...) is the projection of -R^-1 r onto the cone in the metric of R, where r = J a - a_ref is
//! the residual, and the negative gradient of the cost f'R f / 2 (E. Todorov, "Convex and analytically-invertible dynamics with
//! contacts and constraints", ICRA 2014; MuJoCo's manual, chapter Computation, "Reduced primal problem", "Friction cones"). With the friction
//! coefficients m_j and R chosen such that R_j m_j² is one number, that of the normal times the square of the *regularised*
//! coefficient μ, the scaled residual
//!
//! ```text
//! u = (μ r_0, m_1 r_1, m_2 r_2, ...)      N = u_0,   T = |(u_1, u_2, ...)|
//! ```
//!
//! tells the three zones apart, and in the middle one the cost is a quadratic of one number:
//!
//! ```text
//! N >= μ T        open:     f = 0,  cost = 0
//! μ N + T <= 0    sticking: f = -R^-1 r,  cost = r' R^-1 r / 2
//! otherwise       sliding:  cost = D (N - μ T)² / 2,  D = 1 / (R_0 μ² (1 + μ²));  f lies on the cone's surface
//! ```

use super::jacobian::MOST_BASE_ROWS;
use crate::scalar::Real;
use core::ops::Range;

/// A vector or matrix over a contact's rows; the first `dimension` entries count.
type Vector = [f64; MOST_BASE_ROWS];
type Matrix = [Vector; MOST_BASE_ROWS];

/// One contact's cone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cone {
    /// Its rows, the normal first.
    pub rows: Range<usize>,
    /// Friction coefficient of each row but the first.
    pub friction: [f64; 5],
    /// The regularised coefficient μ.
    pub ratio: f64,
}

/// What a contact does at a residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Zone {
    /// No force.
    Open,
    /// A force inside the cone.
    Sticking,
    /// A force on the cone's surface.
    Sliding,
}

/// The scaled residual: zone, N - μ T, T, and u.
struct Scaled {
    zone: Zone,
    depth: f64,
    tangential: f64,
    vector: Vector,
}

impl Cone {
    fn dimension(&self) -> usize {
        self.rows.len()
    }

    /// From residuals to their scaled form: μ and the friction coefficients.
    fn scales(&self) -> Vector {
        core::array::from_fn(|row| if row == 0 { self.ratio } else { self.friction[row - 1] })
    }

    /// D of the sliding zone, given D of the normal row.
    fn stiffness(&self, weight: &[f64]) -> f64 {
        let square = self.ratio * self.ratio;
        weight[self.rows.start] / (square * (1.0 + square))
    }

    fn scaled(&self, residual: impl Fn(usize) -> f64) -> Scaled {
        let scales = self.scales();
        let mut vector = [0.0; MOST_BASE_ROWS];
        for (row, value) in vector[..self.dimension()].iter_mut().enumerate() {
            *value = scales[row] * residual(self.rows.start + row);
        }
        let tangential = vector[1..].iter().map(|value| value * value).sum::<f64>().sqrt();
        let (normal, ratio) = (vector[0], self.ratio);
        let zone = if normal >= ratio * tangential {
            Zone::Open
        } else if ratio * normal + tangential <= 0.0 {
            Zone::Sticking
        } else {
            Zone::Sliding
        };
        Scaled { zone, depth: normal - ratio * tangential, tangential, vector }
    }

    /// The zone of a residual.
    pub fn zone(&self, residual: &[f64]) -> Zone {
        self.scaled(|row| residual[row]).zone
    }

    /// Cost of a residual; `weight` is D of all rows.
    pub fn cost(&self, residual: &[f64], weight: &[f64]) -> f64 {
        let scaled = self.scaled(|row| residual[row]);
        match scaled.zone {
            Zone::Open => 0.0,
            Zone::Sticking => self.rows.clone().map(|row| 0.5 * weight[row] * residual[row] * residual[row]).sum(),
            Zone::Sliding => 0.5 * self.stiffness(weight) * scaled.depth * scaled.depth,
        }
    }

    /// Writes the forces at a residual and returns the zone.
    pub fn push(&self, residual: &[f64], weight: &[f64], force: &mut [f64]) -> Zone {
        let scaled = self.scaled(|row| residual[row]);
        match scaled.zone {
            Zone::Open => force[self.rows.clone()].fill(0.0),
            Zone::Sticking => self.rows.clone().for_each(|row| force[row] = -weight[row] * residual[row]),
            Zone::Sliding => {
                let (slope, scales) = (self.slope(&scaled), self.scales());
                let push = -self.stiffness(weight) * scaled.depth;
                for (place, row) in self.rows.clone().enumerate() {
                    force[row] = push * slope[place] * scales[place];
                }
            }
        }
        scaled.zone
    }

    /// Gradient of N - μ T over u, in the sliding zone.
    fn slope(&self, scaled: &Scaled) -> Vector {
        let part = |row: usize| if row == 0 { 1.0 } else { -self.ratio * scaled.vector[row] / scaled.tangential };
        core::array::from_fn(part)
    }

    /// Second derivative of the cost over the rows' residuals.
    pub fn curvature(&self, residual: &[f64], weight: &[f64]) -> Matrix {
        let mut matrix = [[0.0; MOST_BASE_ROWS]; MOST_BASE_ROWS];
        let scaled = self.scaled(|row| residual[row]);
        match scaled.zone {
            Zone::Open => {}
            Zone::Sticking => (0..self.dimension()).for_each(|row| matrix[row][row] = weight[self.rows.start + row]),
            Zone::Sliding => {
                let (slope, scales) = (self.slope(&scaled), self.scales());
                let (stiffness, tangential) = (self.stiffness(weight), scaled.tangential);
                // Bending of T: (I - t t') / T with t the direction of sliding; N - μ T is negative here.
                let bend = -self.ratio * scaled.depth / tangential;
                for row in 0..self.dimension() {
                    for column in 0..self.dimension() {
                        let mut entry = slope[row] * slope[column];
                        if row > 0 && column > 0 {
                            let along = scaled.vector[row] * scaled.vector[column] / (tangential * tangential);
                            entry += bend * (f64::from(u8::from(row == column)) - along);
                        }
                        matrix[row][column] = stiffness * scales[row] * scales[column] * entry;
                    }
                }
            }
        }
        matrix
    }

    /// Slope and curvature of the cost along a line: residuals start at `residual` and change by `rate` per unit of `step`.
    pub fn along(&self, residual: &[f64], rate: &[f64], weight: &[f64], step: f64) -> [f64; 2] {
        let at = |row: usize| residual[row] + step * rate[row];
        let scaled = self.scaled(at);
        match scaled.zone {
            Zone::Open => [0.0; 2],
            Zone::Sticking => self.rows.clone().fold([0.0; 2], |[slope, curvature], row| {
                let pull = weight[row] * rate[row];
                [slope + pull * at(row), curvature + pull * rate[row]]
            }),
            Zone::Sliding => {
                let scales = self.scales();
                let moved = |place: usize| scales[place] * rate[self.rows.start + place];
                let (mut across, mut square) = (0.0, 0.0);
                for place in 1..self.dimension() {
                    across += scaled.vector[place] * moved(place);
                    square += moved(place) * moved(place);
                }
                let tangential = scaled.tangential;
                let stretch = across / tangential;
                let change = moved(0) - self.ratio * stretch;
                let bend = -self.ratio * scaled.depth * (square - stretch * stretch).at_least(0.0) / tangential;
                let stiffness = self.stiffness(weight);
                [stiffness * scaled.depth * change, stiffness * (change * change + bend)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A contact whose regularisations keep R_j m_j² the same, as the rows have them.
    fn contact(friction: [f64; 5], dimension: usize, ratio: f64) -> (Cone, Vec<f64>) {
        let normal = 3.0;
        let first = normal * ratio * ratio / (friction[0] * friction[0]);
        let mut regularization = vec![normal];
        regularization.extend((0..dimension - 1).map(|j| first * friction[0] * friction[0] / (friction[j] * friction[j])));
        let weight = regularization.iter().map(|r| 1.0 / r).collect();
        (Cone { rows: 0..dimension, friction, ratio }, weight)
    }

    proptest! {
        #[test]
        fn force_is_minus_the_gradient_and_curvature_its_slope(
            friction in prop::array::uniform5(0.1f64..2.0),
            dimension in prop::sample::select(vec![3_usize, 4, 6]),
            ratio in 0.2f64..2.0,
            residual in prop::array::uniform6(-1.0f64..1.0),
            rate in prop::array::uniform6(-1.0f64..1.0),
        ) {
            let (cone, weight) = contact(friction, dimension, ratio);
            let h = 1e-6;
            let moved = |step: f64| -> Vec<f64> { residual.iter().zip(&rate).map(|(r, v)| r + step * v).collect() };
            // Second differences across the border of two zones mean nothing.
            prop_assume!(cone.zone(&moved(-h)) == cone.zone(&moved(h)));
            let cost = |step: f64| cone.cost(&moved(step), &weight);
            let mut force = vec![0.0; 6];
            let zone = cone.push(&residual, &weight, &mut force);
            prop_assert_eq!(zone, cone.zone(&residual));
            let power: f64 = (0..dimension).map(|row| -force[row] * rate[row]).sum();
            prop_assert!((power - (cost(h) - cost(-h)) / (2.0 * h)).abs() < 1e-6);
            let [slope, bend] = cone.along(&residual, &rate, &weight, 0.0);
            prop_assert!((slope - power).abs() < 1e-9 * (1.0 + power.abs()));
            let matrix = cone.curvature(&residual, &weight);
            let quadratic: f64 = (0..dimension).flat_map(|i| (0..dimension).map(move |j| (i, j))).map(|(i, j)| rate[i] * matrix[i][j] * rate[j]).sum();
            prop_assert!((quadratic - bend).abs() < 1e-9 * (1.0 + bend.abs()));
            let slopes = [-h, h].map(|step| cone.along(&residual, &rate, &weight, step)[0]);
            prop_assert!((bend - (slopes[1] - slopes[0]) / (2.0 * h)).abs() < 1e-4 * (1.0 + bend));
            prop_assert!(bend >= 0.0);
            // Never outside the cone, and on its surface while sliding.
            let tangential: f64 = (1..dimension).map(|j| (force[j] / friction[j - 1]).squared()).sum::<f64>().sqrt();
            prop_assert!(tangential <= force[0] * (1.0 + 1e-9) + 1e-12);
            if zone == Zone::Sliding { prop_assert!((tangential - force[0]).abs() < 1e-9 * (1.0 + force[0])); }
        }
    }
}
