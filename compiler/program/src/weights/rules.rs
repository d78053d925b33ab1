//! How far one change may go: a relative bound, signs and zeros kept, and a fixed sum of sizes.
//!
//! A proposal p for weights w is turned into the nearest permitted one (in the Euclidean sense):
//!
//! * every weight stays within `step` of its size, `|x - w| <= step |w|`, and within its own bounds: a box;
//! * so its sign stays, and a weight that is zero stays zero;
//! * if a `norm` is kept, the sizes of the weights in scope sum to it. Over sizes m = p sign(w) the nearest point of box and
//!   plane is clip(m - ν, low, high), where the ν that meets the sum is found exactly, piece by piece.

use super::Bounds;
use crate::extremes::{between, maximum, minimum};
use crate::numbers::for_people;

/// What a change must keep to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Largest relative change of a weight in one step: 0.2 is 20 %.
    pub step: f64,
    /// Sum of the sizes of all weights in scope, if it is kept.
    pub norm: Option<f64>,
}

impl Default for Rules {
    /// 20 % a step, no fixed norm.
    fn default() -> Self {
        Self { step: 0.2, norm: None }
    }
}

/// A weight that a change may concern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// Present value.
    pub value: f64,
    /// What its author allows.
    pub bounds: Bounds,
    /// Whether it is tuned and counts in the norm. Others stay as they are: the end of an episode, for example, which
    /// outweighs everything that counts step by step.
    pub in_scope: bool,
}

/// What a norm counts and a tuner may change: the two readings of the published norm.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Scope {
    /// All terms that are not fixed.
    #[default]
    All,
    /// Those that count while an episode goes on: not the price of its end.
    Running,
}

impl Scope {
    /// Whether a term is in it.
    pub fn holds(self, bounds: Bounds, terminal: bool) -> bool {
        bounds != Bounds::Fixed && !(terminal && self == Self::Running)
    }
}

/// Why there is no permitted change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RuleError {
    /// Not one proposal for each weight.
    #[error("{found} weights are proposed for {expected}")]
    Count {
        /// Number of weights.
        expected: usize,
        /// Number of proposals.
        found: usize,
    },
    /// A proposal is no number.
    #[error("proposal {index} is {}, not a number from -{most} to {most}", for_people(*.value), most = for_people(super::LARGEST))]
    NotFinite {
        /// Which.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The weights cannot reach the norm in one step.
    #[error("a sum of absolute values of {} cannot be reached in one step: within bounds it is {} to {}", for_people(*.wanted), for_people(*.low), for_people(*.high))]
    Unreachable {
        /// The norm.
        wanted: f64,
        /// Least sum.
        low: f64,
        /// Largest sum.
        high: f64,
    },
    /// All weights are zero.
    #[error("weights that are all zero cannot be scaled to a sum of {wanted}")]
    Nothing {
        /// The norm.
        wanted: f64,
    },
    /// The rules themselves make no sense.
    #[error("the bound of a step is a number from 0 to 1 and a norm is positive")]
    Rules,
}

impl Rules {
    /// The permitted weights nearest to `proposal`.
    ///
    /// # Errors
    /// A proposal of the wrong length or not finite, or a norm that cannot be reached.
    ///
    /// ```
    /// use msk_program::weights::{Bounds, rules::{Rules, Weight}};
    /// let weights = [10.0, -1.0].map(|value| Weight { value, bounds: Bounds::Free, in_scope: true });
    /// assert_eq!(Rules::default().constrain(&weights, &[20.0, 1.0]).unwrap(), [12.0, -0.8]);
    /// ```
    pub fn constrain(&self, weights: &[Weight], proposal: &[f64]) -> Result<Vec<f64>, RuleError> {
        if !(0.0..=1.0).contains(&self.step) || self.norm.is_some_and(|norm| !(norm > 0.0 && norm.is_finite())) {
            return Err(RuleError::Rules);
        }
        if weights.len() != proposal.len() {
            return Err(RuleError::Count { expected: weights.len(), found: proposal.len() });
        }
        if let Some(index) = proposal.iter().position(|value| !super::may_be(*value)) {
            return Err(RuleError::NotFinite { index, value: proposal[index] });
        }
        let mut sizes = Vec::new();
        for (weight, wish) in weights.iter().zip(proposal) {
            if weight.in_scope {
                let (low, high) = self.box_of(weight);
                sizes.push(Size { wished: wish * weight.value.signum(), low, high });
            }
        }
        let shift = match self.norm {
            None => 0.0,
            Some(norm) => shift(&sizes, norm)?,
        };
        let mut sizes = sizes.iter().map(|size| size.at(shift));
        let next = |weight: &Weight| match weight.in_scope {
            // One size was made for every weight in scope.
            true => sizes.next().unwrap_or(0.0) * weight.value.signum(),
            false => weight.value,
        };
        Ok(weights.iter().map(next).collect())
    }

    /// Between which sizes a weight may move in one step.
    fn box_of(&self, weight: &Weight) -> (f64, f64) {
        let size = weight.value.abs();
        let (low, high) = ((1.0 - self.step) * size, (1.0 + self.step) * size);
        match weight.bounds {
            Bounds::Free => (low, high),
            Bounds::Fixed => (size, size),
            Bounds::Range(least, most) => {
                let (a, b) = (least * weight.value.signum(), most * weight.value.signum());
                // The present weight lies within its bounds, so that the boxes overlap.
                (minimum(maximum(low, minimum(a, b)), size), maximum(minimum(high, maximum(a, b)), size))
            }
        }
    }
}

/// A size that may be chosen between two bounds.
#[derive(Debug, Clone, Copy)]
struct Size {
    wished: f64,
    low: f64,
    high: f64,
}

impl Size {
    fn at(&self, shift: f64) -> f64 {
        between(self.wished - shift, self.low, self.high)
    }
}

/// The ν with Σ clip(m - ν, low, high) = `wanted`. The sum falls piecewise linearly in ν; its corners are where a size meets a
/// bound, and between two corners ν follows by interpolation.
fn shift(sizes: &[Size], wanted: f64) -> Result<f64, RuleError> {
    let sum = |shift: f64| sizes.iter().map(|size| size.at(shift)).sum::<f64>();
    let (low, high) = (sizes.iter().map(|size| size.low).sum::<f64>(), sizes.iter().map(|size| size.high).sum::<f64>());
    // Sums of rounded numbers: a norm that was reached before must count as reachable.
    let slack = 1e-12 * wanted;
    if wanted < low - slack || wanted > high + slack {
        return Err(RuleError::Unreachable { wanted, low, high });
    }
    let mut corners: Vec<f64> = sizes.iter().flat_map(|size| [size.wished - size.high, size.wished - size.low]).collect();
    corners.sort_by(f64::total_cmp);
    let Some(&first) = corners.first() else { return Ok(0.0) };
    let mut left = (first, high);
    for corner in corners {
        let right = (corner, sum(corner));
        if right.1 <= wanted {
            let fall = left.1 - right.1;
            let part = if fall > 0.0 { (left.1 - wanted) / fall } else { 1.0 };
            return Ok(left.0 + part * (right.0 - left.0));
        }
        left = right;
    }
    Ok(left.0)
}

/// All weights in scope scaled by one factor so that their sizes sum to `norm`; bounds are not looked at.
///
/// # Errors
/// Weights that are all zero.
pub fn normalized(weights: &[Weight], norm: f64) -> Result<Vec<f64>, RuleError> {
    let sum: f64 = weights.iter().filter(|weight| weight.in_scope).map(|weight| weight.value.abs()).sum();
    if sum == 0.0 {
        return Err(RuleError::Nothing { wanted: norm });
    }
    Ok(weights.iter().map(|weight| if weight.in_scope { weight.value * (norm / sum) } else { weight.value }).collect())
}
