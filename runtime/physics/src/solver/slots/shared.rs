//! Rows that are computed in all lanes at once: couplings of joints, friction of dofs, limits of hinges and slides.
//! Operation by operation what [`Constraints::build`](crate::constraint::Constraints::build) computes in one lane.

use super::{
    Row, Slot, Slots,
    merge::{Key, key},
};
use crate::{
    collision,
    constrained::ConstraintState,
    constraint::{
        RowKind, RowPlan, Soft,
        equalities::polynomial,
        impedance::Spring,
        rows::{BOTH_WAYS, ONE_WAY, regularization},
    },
    kinematics::Kinematics,
    model::{Equality, JointKind, Model},
    scalar::Real,
    solver::together::differ,
    state::State,
};

/// What rows are made of.
pub(crate) struct Source<'a, T: Real> {
    pub model: &'a Model,
    pub plan: &'a RowPlan,
    pub pairs: &'a collision::Plan,
    pub state: &'a State<T>,
    pub kinematics: &'a Kinematics<T>,
    /// The contacts of each lane, and the rows that it has built alone.
    pub lanes: &'a [ConstraintState],
    /// The lanes that are stepped.
    pub living: T::Mask,
}

/// What one row does, as [`Place`](crate::constraint::rows::Place) has it in one lane.
struct Law<'a, T> {
    spring: &'a Spring,
    /// Its entry in the diagonal of J M^-1 J'.
    approximate: f64,
    position: T,
    margin: f64,
    bounds: [f64; 2],
}

impl<T: Real> Slots<T> {
    /// Builds all slots and their rows.
    #[inline(always)]
    pub fn build(&mut self, source: &Source<'_, T>) {
        self.clear();
        for (lane, own) in source.lanes.iter().enumerate().filter(|(lane, _)| T::holds(source.living, *lane)) {
            self.note_lane(own, lane);
        }
        self.merge.begin(source.pairs, source.lanes, |lane| T::holds(source.living, lane));
        let switches = source.model.options.switches;
        if switches.equality {
            self.add_equalities(source);
        }
        if switches.friction_loss {
            self.add_dof_friction(source);
        }
        if switches.limit {
            self.add_joint_limits(source);
        }
        self.merge_until(key(RowKind::Contact(0), false), source.lanes);
        self.add_contacts(source);
        self.cross_couplings.sort_unstable();
    }

    /// Notes what a lane has built alone.
    fn note_lane(&mut self, own: &ConstraintState, lane: usize) {
        if !own.constraints.rows.is_empty() {
            self.occupied = T::or(self.occupied, T::mask(|other| other == lane));
        }
        for coupling in &own.constraints.cross_couplings {
            if !self.cross_couplings.contains(coupling) {
                self.cross_couplings.push(*coupling);
            }
        }
    }

    #[inline(always)]
    fn add_equalities(&mut self, source: &Source<'_, T>) {
        for (equality, kind) in source.model.equalities.kind.iter().enumerate() {
            if let Equality::Joint(coupling) = kind {
                self.merge_until(key(RowKind::Equality(equality), false), source.lanes);
                self.add_coupling(source, equality, *coupling);
            }
        }
    }

    #[inline(always)]
    fn add_coupling(&mut self, source: &Source<'_, T>, equality: usize, coupling: usize) {
        let Source { model, plan, state, living, .. } = source;
        let (joints, couplings, weights) = (&model.joints, &model.couplings, &model.dofs.inverse_weight);
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let holds = T::and(*living, differ(state.active[equality], zero));
        let (key, spring) = (key(RowKind::Equality(equality), false), &plan.springs[equality]);
        let (dependent, coefficients) = (couplings.joint[coupling], &couplings.polynomial[coupling]);
        let dof = joints.dof_address[dependent];
        let moved = displacement(source, dependent);
        let law = Law { spring, approximate: weights[dof], position: moved, margin: 0.0, bounds: BOTH_WAYS };
        let Some(leader) = couplings.leader[coupling] else {
            let law = Law { position: moved - T::splat(coefficients[0]), ..law };
            return self.add_row(source, key, holds, &[(dof, one)], &law);
        };
        let [wanted, slope] = polynomial(coefficients, displacement(source, leader));
        let leading = joints.dof_address[leader];
        let law = Law { position: moved - wanted, approximate: weights[dof] + weights[leading], ..law };
        let entries = if leading < dof { [(leading, -slope), (dof, one)] } else { [(dof, one), (leading, -slope)] };
        self.add_row(source, key, holds, &entries, &law);
    }

    #[inline(always)]
    fn add_dof_friction(&mut self, source: &Source<'_, T>) {
        let Source { model, plan, living, .. } = source;
        self.merge_until(key(RowKind::DofFriction(0), false), source.lanes);
        for &Soft { element: dof, spring } in &plan.friction_loss_dofs {
            let loss = model.dofs.friction_loss[dof];
            let (approximate, spring) = (model.dofs.inverse_weight[dof], &spring.slack());
            let law = Law { spring, approximate, position: T::splat(0.0), margin: 0.0, bounds: [-loss, loss] };
            self.add_row(source, key(RowKind::DofFriction(dof), false), *living, &[(dof, T::splat(1.0))], &law);
        }
    }

    /// The lower limits first; those of balls have been built lane by lane.
    #[inline(always)]
    fn add_joint_limits(&mut self, source: &Source<'_, T>) {
        let Source { model, plan, state, living, .. } = source;
        let joints = &model.joints;
        for Soft { element, spring } in &plan.limited_joints {
            let joint = *element;
            let Some([low, high]) = joints.range[joint] else { continue };
            if joints.kind[joint] == JointKind::Ball {
                continue;
            }
            self.merge_until(key(RowKind::JointLimit(joint), false), source.lanes);
            let value = state.position[joints.position_address[joint]];
            let (dof, margin) = (joints.dof_address[joint], T::splat(joints.margin[joint]));
            let distances = [value - T::splat(low), T::splat(high) - value];
            for (side, distance) in distances.iter().enumerate() {
                let near = T::and(*living, distance.less(margin));
                if !T::any(near) {
                    continue;
                }
                let upper = side == 1;
                let (approximate, margin) = (model.dofs.inverse_weight[dof], joints.margin[joint]);
                let law = Law { spring, approximate, position: *distance, margin, bounds: ONE_WAY };
                let sign = T::splat(if upper { -1.0 } else { 1.0 });
                self.add_row(source, key(RowKind::JointLimit(joint), upper), near, &[(dof, sign)], &law);
            }
        }
    }

    /// Appends a constraint with one row in the lanes of the mask, if there are any. The entries of its Jacobian ascend.
    #[inline(always)]
    fn add_row(&mut self, source: &Source<'_, T>, key: Key, has: T::Mask, entries: &[(usize, T)], law: &Law<'_, T>) {
        if !T::any(has) {
            return;
        }
        let zero = T::splat(0.0);
        let (columns, values, row) = (self.columns.len(), self.values.len(), self.rows.len());
        let mut velocity = T::splat(-0.0);
        for (dof, value) in entries {
            velocity += *value * source.state.velocity[*dof];
            self.columns.push(*dof);
            self.values.push(T::select(has, *value, zero));
        }
        let Law { spring, approximate, position, margin, bounds } = law;
        let depth = *position - T::splat(*margin);
        let impedance = spring.impedance(depth);
        let regularization = regularization(impedance, T::splat(*approximate));
        let pull = T::splat(spring.stiffness) * impedance * depth;
        let reference = -T::splat(spring.damping) * velocity - pull;
        self.rows.push(Row::new(has, regularization, reference, *bounds));
        let (rows, columns) = (row..row + 1, columns..self.columns.len());
        self.slots.push(Slot { rows, columns, values, dimension: 1, pyramid: false, frictions: 0 });
        self.keys.push(key);
        self.occupied = T::or(self.occupied, has);
    }
}

/// How far a joint is from its reference.
#[inline(always)]
fn displacement<T: Real>(source: &Source<'_, T>, joint: usize) -> T {
    let address = source.model.joints.position_address[joint];
    source.state.position[address] - T::splat(source.model.reference_position[address])
}
