//! Coupled joints: q₁ = q₁₀ + p(q₂ - q₂₀), where p is the coupling's polynomial and q₁₀, q₂₀ the reference coordinates.

use msk_physics::model::Model;

/// The couplings of a model that hold from the beginning, in an order in which every leader is known before its followers.
///
/// # Errors
/// The names of the joints that lead each other in a circle.
pub(crate) fn order(model: &Model) -> Result<Vec<usize>, Vec<String>> {
    let couplings = &model.couplings;
    let holds = |coupling: &usize| model.equalities.active[couplings.equality[*coupling]];
    let mut waiting: Vec<usize> = (0..couplings.joint.len()).filter(holds).collect();
    let mut sorted = Vec::with_capacity(waiting.len());
    while !waiting.is_empty() {
        let coupled: Vec<usize> = waiting.iter().map(|&coupling| couplings.joint[coupling]).collect();
        let (blocked, ready): (Vec<usize>, Vec<usize>) =
            waiting.iter().partition(|&&coupling| couplings.leader[coupling].is_some_and(|leader| coupled.contains(&leader)));
        if ready.is_empty() {
            return Err(coupled.into_iter().map(|joint| model.joints.name[joint].clone()).collect());
        }
        sorted.extend(ready);
        waiting = blocked;
    }
    Ok(sorted)
}

/// Sets the coordinates of all coupled joints in `position` (length `nq`) from their leaders, couplings in the given `order`.
pub(crate) fn solve(model: &Model, order: &[usize], position: &mut [f64]) {
    let (couplings, address) = (&model.couplings, &model.joints.position_address);
    for &coupling in order {
        let displacement = couplings.leader[coupling].map_or(0.0, |leader| {
            let leader = address[leader];
            position[leader] - model.reference_position[leader]
        });
        let polynomial = couplings.polynomial[coupling].iter().rev().fold(0.0, |sum, c| sum * displacement + c);
        let coupled = address[couplings.joint[coupling]];
        position[coupled] = model.reference_position[coupled] + polynomial;
    }
}

/// Sets the velocities of all coupled joints in `velocity` (length `nv`) from their leaders: q̇₁ = p'(q₂ - q₂₀) q̇₂.
pub(crate) fn solve_velocities(model: &Model, order: &[usize], position: &[f64], velocity: &mut [f64]) {
    let (couplings, joints) = (&model.couplings, &model.joints);
    for &coupling in order {
        let rate = couplings.leader[coupling].map_or(0.0, |leader| {
            let address = joints.position_address[leader];
            let displacement = position[address] - model.reference_position[address];
            let [_, c1, c2, c3, c4] = couplings.polynomial[coupling];
            let slope = c1 + displacement * (2.0 * c2 + displacement * (3.0 * c3 + displacement * 4.0 * c4));
            slope * velocity[joints.dof_address[leader]]
        });
        velocity[joints.dof_address[couplings.joint[coupling]]] = rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slide follows a hinge by a polynomial of degree 4, and a second slide follows the first.
    const CHAIN: &str = r#"<mujoco><worldbody><body><geom size="1"/>
        <joint name="a" type="slide" axis="1 0 0"/> <joint name="b" type="slide" axis="0 1 0"/> <joint name="c"/>
        </body></worldbody><equality>
        <joint joint1="a" joint2="b" polycoef="0.1 2 0 0 0"/> <joint joint1="b" joint2="c" polycoef="0.5 1 -2 3 0.25"/>
        </equality></mujoco>"#;

    #[test]
    fn coupled_velocities_are_the_rates_of_coupled_coordinates() {
        let model = Model::from_mjcf(CHAIN).unwrap();
        let order = order(&model).unwrap();
        let at = |angle: f64| {
            let mut position = vec![0.0, 0.0, angle];
            solve(&model, &order, &mut position);
            position
        };
        let (rate, step) = (0.7, 1e-6);
        let mut velocity = vec![9.0, 9.0, rate];
        solve_velocities(&model, &order, &at(0.4), &mut velocity);
        for (joint, found) in velocity.iter().enumerate() {
            let expected = (at(0.4 + rate * step)[joint] - at(0.4 - rate * step)[joint]) / (2.0 * step);
            assert!((found - expected).abs() < 1e-8, "joint {joint}: {found} is not {expected}");
        }
    }
}
