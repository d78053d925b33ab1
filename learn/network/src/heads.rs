//! Distributions of actions: what the last layer of a policy means.

use crate::tape::{Tape, Variable};

/// ln(2 pi) / 2.
const HALF_LN_TAU: f32 = 0.918_938_5;
/// ln 2.
const LN_2: f32 = core::f32::consts::LN_2;

/// The logarithm of the density of a diagonal Gaussian at each row of `action`: [rows, 1]. All arguments have one size.
pub fn gaussian_log_density(tape: &mut Tape, mean: Variable, log_std: Variable, action: Variable) -> Variable {
    let distance = tape.subtract(action, mean);
    let narrow = tape.affine(log_std, -1.0, 0.0);
    let precision = tape.exp(narrow);
    let unit = tape.multiply(distance, precision);
    let square = tape.square(unit);
    // -z^2 / 2 - ln(std) - ln(2 pi) / 2.
    let exponent = tape.affine(square, -0.5, -HALF_LN_TAU);
    let density = tape.subtract(exponent, log_std);
    tape.sum_columns(density)
}

/// The entropy of a diagonal Gaussian for each row of `log_std`: [rows, 1].
pub fn gaussian_entropy(tape: &mut Tape, log_std: Variable) -> Variable {
    let entropy = tape.affine(log_std, 1.0, 0.5 + HALF_LN_TAU);
    tape.sum_columns(entropy)
}

/// An action of a Gaussian squashed by the hyperbolic tangent, and the logarithm of its density: [rows, entries] and [rows, 1].
/// `noise` is standard normal; derivatives pass through the draw (the reparameterisation of Kingma and Welling 2014).
///
/// The density is that of the Gaussian over the derivative of the squashing (Haarnoja et al. 2018, appendix C):
/// ln(1 - tanh(u)^2) = 2 (ln 2 - u - softplus(-2 u)), which stays finite where tanh(u) rounds to 1.
pub fn squashed_gaussian(tape: &mut Tape, mean: Variable, log_std: Variable, noise: Variable) -> [Variable; 2] {
    let std = tape.exp(log_std);
    let shift = tape.multiply(std, noise);
    let raw = tape.add(mean, shift);
    let action = tape.tanh(raw);
    let square = tape.square(noise);
    let exponent = tape.affine(square, -0.5, -HALF_LN_TAU);
    let gaussian = tape.subtract(exponent, log_std);
    let doubled = tape.affine(raw, -2.0, 0.0);
    let soft = tape.softplus(doubled);
    let sum = tape.add(raw, soft);
    // Minus ln(1 - tanh(u)^2).
    let correction = tape.affine(sum, 2.0, -2.0 * LN_2);
    let density = tape.add(gaussian, correction);
    [action, tape.sum_columns(density)]
}
