//! Constraint rows: what is coupled, limited or touching, how far it is violated, and how hard it pulls back.
//!
//! 1. joint couplings, joint limits and contacts become blocks of the Jacobian and rows, in MuJoCo's order;
//! 2. each row gets its impedance, stiffness and damping (`solref`, `solimp`), its regularisation R from the inverse weights
//!    at the reference configuration, and the acceleration that it asks for:  a_ref = -b J v - k d (position - margin);
//! 3. every row's force is a clipped spring on its acceleration error, force = clip(-(J a - a_ref) / R, lower, upper): no
//!    bounds for equalities, non-negative for limits and the edges of a contact's pyramid. One law for all rows leaves
//!    room for friction loss and needs no branches in the solver.
//!
//! The set of rows differs between episodes, so this stage and the solver work on one episode in `f64`: an episode in a
//! SIMD lane is read through [`Real::lane`]. What is common to all lanes is computed in the stages before and after.

mod impedance;
pub(crate) mod jacobian;
mod rows;

pub use rows::{RowKind, Rows};

use super::{Workspace, collision, state::State};
use crate::{
    model::{JointKind, Model},
    scalar::Real,
};
use jacobian::Jacobian;
use nalgebra::Vector3;
use rows::Place;

/// The constraints of one episode.
#[derive(Debug, Clone, Default)]
pub struct Constraints {
    /// Which geoms can meet.
    pub plan: collision::Plan,
    /// Contacts, including those in the gap that carry no force.
    pub contacts: Vec<collision::Contact>,
    /// Constraint rows.
    pub rows: Rows,
    /// Their Jacobian.
    pub(crate) jacobian: Jacobian,
    /// Candidates in contact that couple two chains, ascending: what the solver's pattern depends on.
    pub(crate) bridges: Vec<usize>,
    velocity: Vec<f64>,
    memory: collision::Memory,
}

impl Constraints {
    /// Memory for `model`, and the pairs of its geoms that can meet.
    pub fn new(model: &Model) -> Self {
        Self { plan: collision::Plan::new(model), ..Self::default() }
    }

    /// Row `row` of the constraint Jacobian (`efc_J`), dense, `nv` entries. On request only.
    pub fn jacobian_row(&self, model: &Model, row: usize) -> Vec<f64> {
        let mut dense = vec![0.0; model.nv];
        for (dof, value) in self.jacobian.row_values(self.jacobian.block_of(row), row) {
            dense[dof] = value;
        }
        dense
    }

    /// Spreads the row forces over the contacts.
    pub(crate) fn share_forces(&mut self) {
        for contact in &mut self.contacts {
            contact.force = [0.0; 6];
        }
        for block in &self.jacobian.blocks {
            if let RowKind::Contact(contact) = self.rows.kind[block.rows.start] {
                self.contacts[contact].force = self.jacobian.base_force(block, &self.rows.force);
            }
        }
    }

    /// Detects the contacts of the episode in `lane`. Needs the kinematics of `workspace`.
    pub fn detect<T: Real>(&mut self, model: &Model, workspace: &Workspace<T>, lane: usize) {
        let kinematics = &workspace.kinematics;
        let position = |geom: usize| kinematics.geom_position[geom].map(|value| value.lane(lane));
        let rotation = |geom: usize| kinematics.geom_rotation[geom].map(|value| value.lane(lane));
        self.plan.detect(model, position, rotation, &mut self.contacts, &mut self.memory);
    }

    /// Builds all rows of the episode in `lane` from its contacts.
    pub fn build<T: Real>(&mut self, model: &Model, state: &State<T>, workspace: &Workspace<T>, lane: usize) {
        self.rows.clear();
        self.jacobian.clear();
        self.bridges.clear();
        let position = |address: usize| state.position[address].lane(lane);
        self.add_couplings(model, position);
        self.add_limits(model, position);
        self.add_contacts(model, workspace, lane);
        self.velocity.clear();
        self.velocity.extend(state.velocity.iter().map(|value| value.lane(lane)));
        self.rows.finish(&self.jacobian, &self.velocity);
    }

    /// Polynomial couplings q1 - q1₀ = p(q2 - q2₀).
    fn add_couplings(&mut self, model: &Model, position: impl Fn(usize) -> f64) {
        let (joints, couplings) = (&model.joints, &model.couplings);
        let displacement = |joint: usize| {
            let address = joints.position_address[joint];
            position(address) - model.reference_position[address]
        };
        for (index, &slave) in couplings.joint.iter().enumerate() {
            let [a0, a1, a2, a3, a4] = couplings.polynomial[index];
            let slave_dof = joints.dof_address[slave];
            let mut approximate = model.dofs.inverse_weight[slave_dof];
            let wanted = if let Some(leader) = couplings.leader[index] {
                let x = displacement(leader);
                let slope = a1 + x * (2.0 * a2 + x * (3.0 * a3 + x * 4.0 * a4));
                let leader_dof = joints.dof_address[leader];
                self.jacobian.push_row(&mut [(slave_dof, 1.0), (leader_dof, -slope)]);
                approximate += model.dofs.inverse_weight[leader_dof];
                a0 + x * (a1 + x * (a2 + x * (a3 + x * a4)))
            } else {
                self.jacobian.push_row(&mut [(slave_dof, 1.0)]);
                a0
            };
            let place = Place {
                position: displacement(slave) - wanted,
                margin: 0.0,
                softness: &couplings.softness[index],
                timestep: model.options.timestep,
            };
            self.rows.push(RowKind::Coupling(index), place, approximate);
        }
    }

    /// Joint limits, the lower one first; a ball joint is limited in its rotation angle.
    fn add_limits(&mut self, model: &Model, position: impl Fn(usize) -> f64) {
        let joints = &model.joints;
        for joint in 0..joints.kind.len() {
            let Some([low, high]) = joints.range[joint] else { continue };
            let (address, dof) = (joints.position_address[joint], joints.dof_address[joint]);
            match joints.kind[joint] {
                JointKind::Hinge | JointKind::Slide => {
                    let value = position(address);
                    self.add_limit(model, joint, value - low, &mut [(dof, 1.0)]);
                    self.add_limit(model, joint, high - value, &mut [(dof, -1.0)]);
                }
                JointKind::Ball => {
                    let (angle, axis) = turn(core::array::from_fn(|k| position(address + k)));
                    let mut entries = [(dof, -axis.x), (dof + 1, -axis.y), (dof + 2, -axis.z)];
                    self.add_limit(model, joint, low.max(high) - angle, &mut entries);
                }
                JointKind::Free => {}
            }
        }
    }

    fn add_limit(&mut self, model: &Model, joint: usize, distance: f64, entries: &mut [(usize, f64)]) {
        let margin = model.joints.margin[joint];
        if distance < margin {
            self.jacobian.push_row(entries);
            let softness = &model.joints.limit_softness[joint];
            let place = Place { position: distance, margin, softness, timestep: model.options.timestep };
            self.rows.push(RowKind::Limit(joint), place, model.dofs.inverse_weight[model.joints.dof_address[joint]]);
        }
    }

    /// Contacts within their margin: one row per edge of the friction pyramid, or one for the normal.
    fn add_contacts<T: Real>(&mut self, model: &Model, workspace: &Workspace<T>, lane: usize) {
        let kinematics = &workspace.kinematics;
        for (index, contact) in self.contacts.iter().enumerate() {
            let candidate = &self.plan.candidates[contact.candidate];
            if contact.distance >= candidate.margin || candidate.columns.is_empty() {
                continue;
            }
            let columns = &self.plan.columns[candidate.columns.clone()];
            let sides = &self.plan.sides[candidate.columns.clone()];
            if candidate.bridges_chains && self.bridges.last() != Some(&contact.candidate) {
                self.bridges.push(contact.candidate);
            }
            self.jacobian.push_contact(columns, candidate.dimension, candidate.friction, |column| {
                let dof = columns[column];
                let reference = kinematics.reference(model, model.dofs.body[dof]).map(|value| value.lane(lane));
                let [angular, linear] = kinematics.dof_axis[dof].map(|vector| vector.map(|value| value.lane(lane)));
                let velocity = linear + angular.cross(&(contact.position - reference));
                let (along, about) = (contact.frame * velocity * sides[column], contact.frame * angular * sides[column]);
                [along.x, along.y, along.z, about.x, about.y, about.z]
            });
            let (softness, timestep) = (&candidate.softness, model.options.timestep);
            let place = Place { position: contact.distance, margin: candidate.margin, softness, timestep };
            add_contact_rows(model, candidate, RowKind::Contact(index), place, &mut self.rows);
        }
    }
}

/// Angle in [0, π] and unit axis of a rotation.
fn turn([w, x, y, z]: [f64; 4]) -> (f64, Vector3<f64>) {
    let vector = Vector3::new(x, y, z) * if w < 0.0 { -1.0 } else { 1.0 };
    (2.0 * libm::atan2(vector.norm(), w.abs()), vector.try_normalize(1e-15).unwrap_or_else(Vector3::x))
}

fn add_contact_rows(model: &Model, candidate: &collision::Candidate, kind: RowKind, place: Place<'_>, rows: &mut Rows) {
    let [translation, rotation] = candidate.inverse_weight;
    if candidate.dimension == 1 {
        rows.push(kind, place, translation);
        return;
    }
    let first = rows.len();
    for direction in 0..candidate.dimension - 1 {
        let friction = candidate.friction[direction];
        let moved = if direction < 2 { translation } else { rotation };
        for _ in 0..2 {
            rows.push(kind, place, translation + friction * friction * moved);
        }
    }
    // All edges share one regularisation, that of the first scaled to keep the normal's stiffness (MuJoCo's pyramid).
    let sliding = candidate.friction[0] * candidate.friction[0] / model.options.impedance_ratio;
    let common = (2.0 * sliding * rows.regularization[first]).max(1e-15);
    rows.regularization[first..].fill(common);
}
