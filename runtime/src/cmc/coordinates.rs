//! Independent coordinates: the degrees of freedom that no coupling determines.
//!
//! A coupled joint follows q₁ = p(q₂), so that q̇₁ = p' q̇₂ and q̈₁ = p' q̈₂ + p'' q̇₂². With P the matrix of these slopes,
//! v = P w and v̇ = P ẇ + d, and because the couplings' forces do no work along P they drop out of the projected equations of
//! motion P'M P ẇ + P'(M d + bias) = P'force.

use msk_physics::State;
use msk_physics::model::Model;
use msk_physics::scalar::Real;

/// Which independent coordinate moves each degree of freedom of a model.
#[derive(Debug, Clone)]
pub(super) struct Coordinates {
    /// The dof of each independent coordinate.
    pub dofs: Vec<usize>,
    /// The independent coordinate that moves each dof; `None` for a dof that is held still.
    column: Vec<Option<usize>>,
    /// Couplings, leaders before followers.
    order: Vec<usize>,
}

/// How fast each degree of freedom moves with its independent coordinate, at one state.
#[derive(Debug, Clone)]
pub(super) struct Slopes<T> {
    /// The one entry of each row of P.
    slope: Vec<T>,
    /// d, acceleration of each dof at constant independent velocities.
    pub drift: Vec<T>,
}

impl Coordinates {
    /// The independent coordinates of `model`.
    pub fn new(model: &Model) -> Self {
        let couplings = &model.couplings;
        let dof = |joint: usize| model.joints.dof_address[joint];
        let mut coupled = vec![false; model.nv];
        for &joint in &couplings.joint {
            coupled[dof(joint)] = true;
        }
        let dofs: Vec<usize> = (0..model.nv).filter(|&dof| !coupled[dof]).collect();
        let mut column = vec![None; model.nv];
        for (index, &dof) in dofs.iter().enumerate() {
            column[dof] = Some(index);
        }
        // Every round settles at least one coupling of each chain; couplings in a circle never get their turn and hold still.
        let mut order = Vec::with_capacity(couplings.joint.len());
        let mut waiting: Vec<usize> = (0..couplings.joint.len()).collect();
        loop {
            let ready = |&coupling: &usize| couplings.leader[coupling].is_none_or(|leader| !coupled[dof(leader)]);
            let (now, later): (Vec<usize>, Vec<usize>) = waiting.iter().partition(|coupling| ready(coupling));
            if now.is_empty() {
                break;
            }
            for &coupling in &now {
                coupled[dof(couplings.joint[coupling])] = false;
                column[dof(couplings.joint[coupling])] = couplings.leader[coupling].and_then(|leader| column[dof(leader)]);
            }
            order.extend(now);
            waiting = later;
        }
        Self { dofs, column, order }
    }

    /// Number of independent coordinates.
    pub fn len(&self) -> usize {
        self.dofs.len()
    }

    /// The independent coordinate that moves `dof`.
    #[inline(always)]
    pub fn of(&self, dof: usize) -> Option<usize> {
        self.column[dof]
    }
}

impl<T: Real> Slopes<T> {
    /// Those of dofs that follow no other; [`update`](Self::update) fills the rest.
    pub fn new(coordinates: &Coordinates) -> Self {
        let slope = coordinates.column.iter().map(|column| T::splat(if column.is_some() { 1.0 } else { 0.0 }));
        Self { slope: slope.collect(), drift: vec![T::splat(0.0); coordinates.column.len()] }
    }

    /// Fills slopes and drift at `state`.
    #[inline(always)]
    pub fn update(&mut self, coordinates: &Coordinates, model: &Model, state: &State<T>) {
        let (couplings, joints) = (&model.couplings, &model.joints);
        for &coupling in &coordinates.order {
            let Some(leader) = couplings.leader[coupling] else { continue };
            let (address, lead) = (joints.position_address[leader], joints.dof_address[leader]);
            let x = state.position[address] - T::splat(model.reference_position[address]);
            let speed = state.velocity[lead];
            let [_, c1, c2, c3, c4] = couplings.polynomial[coupling];
            let [two, three, four, six, twelve] = [2.0, 3.0, 4.0, 6.0, 12.0].map(T::splat);
            let [c1, c2, c3, c4] = [c1, c2, c3, c4].map(T::splat);
            let first = c1 + x * (two * c2 + x * (three * c3 + x * four * c4));
            let second = two * c2 + x * (six * c3 + x * twelve * c4);
            let follower = joints.dof_address[couplings.joint[coupling]];
            self.slope[follower] = first * self.slope[lead];
            self.drift[follower] = first * self.drift[lead] + second * speed * speed;
        }
    }

    /// Of every dof what [`of`](Self::of) gives.
    #[inline(always)]
    pub fn all(&self) -> &[T] {
        &self.slope
    }

    /// The velocity of `dof` per unit of that of its independent coordinate.
    #[inline(always)]
    pub fn of(&self, dof: usize) -> T {
        self.slope[dof]
    }

    /// `out` = P' `full`: generalised forces of all dofs as seen by the independent coordinates.
    #[inline(always)]
    pub fn project(&self, coordinates: &Coordinates, full: &[T], out: &mut [T]) {
        out.fill(T::splat(0.0));
        for (dof, &force) in full.iter().enumerate() {
            if let Some(column) = coordinates.of(dof) {
                out[column] += self.slope[dof] * force;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// a follows b by a polynomial of degree 4, b follows c; d is held still.
    const CHAIN: &str = r#"<mujoco><worldbody><body><geom size="1"/>
        <joint name="a" type="slide" axis="1 0 0"/> <joint name="b" type="slide" axis="0 1 0"/> <joint name="c"/>
        <joint name="d" type="slide"/>
        </body></worldbody><equality>
        <joint joint1="a" joint2="b" polycoef="0.1 2 -1 0.5 0.25"/> <joint joint1="b" joint2="c" polycoef="0.5 1 -2 3 0.25"/>
        <joint joint1="d"/>
        </equality></mujoco>"#;

    fn polynomial(c: [f64; 5], x: f64) -> f64 {
        c.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    #[test]
    fn a_chain_of_couplings_moves_with_its_first_leader() {
        let model = Model::from_mjcf(CHAIN).unwrap();
        let coordinates = Coordinates::new(&model);
        assert_eq!(coordinates.dofs, [2]);
        let at = |c: f64| {
            let b = polynomial([0.5, 1.0, -2.0, 3.0, 0.25], c);
            [polynomial([0.1, 2.0, -1.0, 0.5, 0.25], b), b, c, 0.0]
        };
        let (angle, rate, step) = (0.4, 0.7, 1e-4);
        let [before, now, after] = [-step, 0.0, step].map(|time| at(angle + rate * time));
        let mut state = State::new(&model);
        state.position.copy_from_slice(&now);
        for dof in 0..4 {
            state.velocity[dof] = (after[dof] - before[dof]) / (2.0 * step);
        }
        let mut slopes = Slopes::new(&coordinates);
        slopes.update(&coordinates, &model, &state);
        for dof in 0..4 {
            let velocity = slopes.of(dof) * rate;
            let acceleration = (after[dof] - 2.0 * now[dof] + before[dof]) / (step * step);
            assert!((velocity - state.velocity[dof]).abs() < 1e-6, "dof {dof}: velocity {velocity}");
            assert!((slopes.drift[dof] - acceleration).abs() < 1e-5, "dof {dof}: {acceleration}");
        }
    }
}
