//! Rows of contacts: the edges of a friction pyramid, the axes of an elliptic cone, or the normal alone.

use super::{
    Constraints, CrossCoupling, RowKind,
    cone::Cone,
    impedance::{Spring, SpringDamper},
    jacobian::Shape,
    rows::{ONE_WAY, Place, Rows},
    shortest_time_constant,
};
use crate::{
    Workspace,
    collision::{CollisionPair, Contact},
    kinematics::Kinematics,
    model::{self, Model, SolverParameters},
    scalar::Real,
    spatial::lane_of,
    state::State,
};
use nalgebra::Vector3;

impl Constraints {
    /// Contacts within their margin.
    pub(super) fn add_contacts<T: Real>(&mut self, model: &Model, state: &State<T>, workspace: &Workspace<T>, lane: usize) {
        let kinematics = &workspace.kinematics;
        for (index, contact) in self.contacts.iter().enumerate() {
            let candidate = &self.plan.candidates[contact.candidate];
            if !acts(candidate, contact) {
                continue;
            }
            let friction = candidate.friction_with(|geom| state.friction[geom].lane(lane));
            let columns = &self.plan.columns[candidate.columns.clone()];
            let sides = &self.plan.sides[candidate.columns.clone()];
            let coupling = CrossCoupling::Contact(contact.candidate);
            if candidate.bridges_chains && self.cross_couplings.last() != Some(&coupling) {
                self.cross_couplings.push(coupling);
            }
            let shape = match (candidate.dimension, model.options.cone) {
                (1, _) => Shape::Plain,
                (_, model::Cone::Pyramidal) => Shape::Pyramid,
                (_, model::Cone::Elliptic) => Shape::Cone(self.cones.len()),
            };
            self.jacobian.push_rows(columns, candidate.dimension, shape, friction, |column| {
                let dof = columns[column];
                let reference = lane_of(kinematics.reference(model, model.dofs.body[dof]), lane);
                let [angular, linear] = kinematics.dof_axis[dof].each_ref().map(|vector| lane_of(vector, lane));
                let velocity = linear + angular.cross(&(contact.position - reference));
                let (along, about) = (contact.frame * velocity * sides[column], contact.frame * angular * sides[column]);
                [along.x, along.y, along.z, about.x, about.y, about.z]
            });
            let violation = contact.distance - candidate.margin;
            let place = Place {
                position: contact.distance,
                margin: candidate.margin,
                spring: Spring::new(&candidate.softness, shortest_time_constant(model)).at(violation),
                bounds: ONE_WAY,
            };
            let kind = RowKind::Contact(index);
            if let Some(drift) = drift(model, state, kinematics, lane, (candidate, contact)) {
                let first = self.rows.len();
                each_row(shape, candidate.dimension, &friction, &drift, |row, value| self.drift.push((first + row, value)));
            }
            match shape {
                Shape::Plain => self.rows.push(kind, place, candidate.inverse_weight[0]),
                Shape::Pyramid => add_edges(model, (candidate, &friction), kind, place, &mut self.rows),
                Shape::Cone(_) => self.cones.push(add_axes(model, (candidate, &friction), kind, place, &mut self.rows)),
            }
        }
    }
}

/// Whether a contact has rows.
#[inline(always)]
pub(crate) fn acts(candidate: &CollisionPair, contact: &Contact) -> bool {
    contact.distance < candidate.margin && !candidate.columns.is_empty()
}

/// How fast the second body of a contact is moved from outside against the first, in the contact's frame: along, then about its axes.
/// `None` where neither is.
pub(crate) fn drift<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    lane: usize,
    (candidate, contact): (&CollisionPair, &Contact),
) -> Option<[f64; 6]> {
    if state.mocap_velocity.is_empty() {
        return None;
    }
    let mut moves = false;
    let [first, second] = candidate.bodies.map(|body| {
        let root = model.bodies.root[body];
        let Some(index) = kinematics.placed(root) else { return [Vector3::zeros(); 2] };
        let [spin, linear] = state.mocap_velocity[index].each_ref().map(|vector| lane_of(vector, lane));
        moves |= spin != Vector3::zeros() || linear != Vector3::zeros();
        let arm = contact.position - lane_of(&kinematics.body_position[root], lane);
        [linear + spin.cross(&arm), spin]
    });
    let [along, about] = [0, 1].map(|part| contact.frame * (second[part] - first[part]));
    moves.then_some([along.x, along.y, along.z, about.x, about.y, about.z])
}

/// The rows that a velocity in the contact's frame has, in the order of the Jacobian's.
fn each_row(shape: Shape, dimension: usize, friction: &[f64; 5], base: &[f64; 6], mut take: impl FnMut(usize, f64)) {
    if shape != Shape::Pyramid {
        return base[..dimension].iter().enumerate().for_each(|(row, value)| take(row, *value));
    }
    for (direction, (tangent, coefficient)) in base[1..dimension].iter().zip(friction).enumerate() {
        take(2 * direction, base[0] + coefficient * tangent);
        take(2 * direction + 1, base[0] - coefficient * tangent);
    }
}

/// Two rows per friction direction, J_normal ± μ J_tangent.
fn add_edges(model: &Model, (candidate, friction): (&CollisionPair, &[f64; 5]), kind: RowKind, place: Place, rows: &mut Rows) {
    let [translation, rotation] = candidate.inverse_weight;
    let first = rows.len();
    for (direction, coefficient) in friction[..candidate.dimension - 1].iter().enumerate() {
        let moved = if direction < 2 { translation } else { rotation };
        for _ in 0..2 {
            rows.push(kind, place, translation + coefficient * coefficient * moved);
        }
    }
    // All edges share one regularisation, that of the first scaled to keep the normal's stiffness (MuJoCo's pyramid).
    let sliding = friction[0] * friction[0] / model.options.impedance_ratio;
    let common = (2.0 * sliding * rows.regularization[first]).at_least(1e-15);
    rows.regularization[first..].fill(common);
}

/// The normal, and the friction directions, which have no position: they only damp, with their own reference if there is one.
///
/// The regularisation of the first friction direction is that of the normal divided by `impratio`; those of the others keep
/// R_j μ_j² the same, so that the cone stays round in scaled coordinates.
fn add_axes(
    model: &Model,
    (candidate, friction): (&CollisionPair, &[f64; 5]),
    kind: RowKind,
    place: Place,
    rows: &mut Rows,
) -> Cone {
    let first = rows.len();
    let bounds = [0.0; 2];
    rows.push(kind, Place { bounds, ..place }, candidate.inverse_weight[0]);
    let own = candidate.friction_reference != [0.0; 2];
    let reference = if own { candidate.friction_reference } else { candidate.softness.reference };
    let softness = SolverParameters { reference, ..candidate.softness };
    let damping = Spring::new(&softness, shortest_time_constant(model)).damping;
    let spring = SpringDamper { stiffness: 0.0, damping, ..place.spring };
    for _ in 1..candidate.dimension {
        rows.push(kind, Place { position: 0.0, margin: 0.0, spring, bounds }, candidate.inverse_weight[0]);
    }
    let sliding = rows.regularization[first] / model.options.impedance_ratio;
    let ratio = friction[0] * (sliding / rows.regularization[first]).sqrt();
    let scale = |coefficient: f64| (friction[0] / coefficient) * (friction[0] / coefficient);
    for (regularization, &coefficient) in rows.regularization[first + 1..].iter_mut().zip(&friction[..candidate.dimension - 1]) {
        *regularization = sliding * scale(coefficient);
    }
    Cone { rows: first..rows.len(), friction: *friction, ratio }
}
