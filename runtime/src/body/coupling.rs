//! Slaved joints: q₁ = q₁₀ + p(q₂ - q₂₀), where p is the coupling's polynomial and q₁₀, q₂₀ the reference coordinates.

use crate::model::Model;

/// The couplings of a model in an order in which every leader is known before its followers.
///
/// # Errors
/// The names of the joints that lead each other in a circle.
pub(super) fn order(model: &Model) -> Result<Vec<usize>, Vec<String>> {
    let couplings = &model.couplings;
    let mut waiting: Vec<usize> = (0..couplings.joint.len()).collect();
    let mut sorted = Vec::with_capacity(waiting.len());
    while !waiting.is_empty() {
        let slaved: Vec<usize> = waiting.iter().map(|&coupling| couplings.joint[coupling]).collect();
        let (blocked, ready): (Vec<usize>, Vec<usize>) =
            waiting.iter().partition(|&&coupling| couplings.leader[coupling].is_some_and(|leader| slaved.contains(&leader)));
        if ready.is_empty() {
            return Err(slaved.into_iter().map(|joint| model.joints.name[joint].clone()).collect());
        }
        sorted.extend(ready);
        waiting = blocked;
    }
    Ok(sorted)
}

/// Sets the coordinates of all slaved joints in `position` (length `nq`) from their leaders, couplings in the given `order`.
pub(super) fn solve(model: &Model, order: &[usize], position: &mut [f64]) {
    let (couplings, address) = (&model.couplings, &model.joints.position_address);
    for &coupling in order {
        let displacement = couplings.leader[coupling].map_or(0.0, |leader| {
            let leader = address[leader];
            position[leader] - model.reference_position[leader]
        });
        let polynomial = couplings.polynomial[coupling].iter().rev().fold(0.0, |sum, c| sum * displacement + c);
        let slaved = address[couplings.joint[coupling]];
        position[slaved] = model.reference_position[slaved] + polynomial;
    }
}
