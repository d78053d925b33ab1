//! Tendons without Jacobians.
//!
//! The length of a path is a sum of straight segments and arcs. Only segments that join two different bodies change with the
//! configuration at first order: an arc lies on one body and its tangent points move along it at no cost. Such a segment is
//! a *line of action* l = (moment about the tree's centre of mass, unit direction), the same for both of its bodies, so that
//!
//! * the lengthening velocity of the tendon is the sum of l . (velocity of the second body - velocity of the first),
//! * its tension pulls the first body with +l and the second with -l,
//!
//! both in spatial vectors. A sweep up the tree turns the gathered pulls into generalised forces, which is J'f without J.

mod moments;
mod path;
mod plan;
mod wrap;

use super::{
    jacobian::last_dof,
    kinematics::Kinematics,
    rotation::MINIMUM,
    spatial::{Spatial, add_scaled, constant, cross, norm, pair, scale, spatial_zero, zero},
    state::State,
    velocities::Velocities,
};
use crate::{batch::one_lane, model::Model, scalar::Real};
use nalgebra::Vector3;
pub(crate) use plan::Plan;
use plan::{Segment, Side, Wrap};
use std::sync::Arc;

pub use moments::MomentPlan;
pub use path::{PathVertex, VertexKind, path};
pub use wrap::{WrapPath, WrapShape, WrappingSurface, bend};

/// Lengths, velocities and lines of action of all tendons.
#[derive(Debug, Clone)]
pub struct TendonPaths<T: Real> {
    /// Length, m (`ten_length`).
    pub length: Vec<T>,
    /// Rate of lengthening, m/s (`ten_velocity`); filled once body velocities are known.
    pub velocity: Vec<T>,
    /// World positions of the sites that segments join, m.
    point: Vec<Vector3<T>>,
    /// lines of action: moment about the tree's centre of mass and unit direction.
    line: Vec<Spatial<T>>,
    plan: Arc<Plan>,
}

one_lane!(TendonPaths { length, velocity, point, line; but plan });

impl<T: Real> TendonPaths<T> {
    /// Memory for `model`, and the decisions that depend on it alone.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Arc::new(Plan::new(model)))
    }

    pub(crate) fn of(model: &Model, plan: &Arc<Plan>) -> Self {
        let zeros = vec![T::splat(0.0); model.tendons.path.len()];
        Self {
            length: zeros.clone(),
            velocity: zeros,
            point: vec![zero(); plan.points.len()],
            line: vec![spatial_zero(); plan.lines.len()],
            plan: Arc::clone(plan),
        }
    }

    /// Whether a tendon is fixed: a linear combination of joint coordinates, which pulls joints and not bodies.
    #[inline(always)]
    pub(super) fn is_fixed(&self, tendon: usize) -> bool {
        !self.plan.tendon_joints[tendon].is_empty()
    }

    /// Whether any tendon is fixed.
    pub(super) fn any_fixed(&self) -> bool {
        !self.plan.joint_terms.is_empty()
    }

    /// Adds the generalised force of a fixed tendon under `force`; nothing for a spatial one, which [`pull`](Self::pull)s.
    pub(super) fn pull_joints(&self, tendon: usize, force: T, generalised: &mut [T]) {
        for term in &self.plan.joint_terms[self.plan.tendon_joints[tendon].clone()] {
            generalised[term.dof] += force * T::splat(term.coefficient);
        }
    }

    /// The dofs that can change the length of `tendon`, ascending.
    pub(super) fn columns(&self, model: &Model, tendon: usize) -> Vec<usize> {
        let mut columns: Vec<usize> =
            self.plan.joint_terms[self.plan.tendon_joints[tendon].clone()].iter().map(|term| term.dof).collect();
        for line in &self.plan.lines[self.plan.tendon_lines[tendon].clone()] {
            each_mover(model, line, |dof, _| columns.push(dof));
        }
        columns.sort_unstable();
        columns.dedup();
        columns
    }

    /// Adds `force * weight` along every line of `tendon` to the forces on the bodies it pulls together: a positive force
    /// lengthens (MuJoCo's sign: a muscle's pull is negative).
    #[inline(always)]
    pub(super) fn pull(&self, tendon: usize, force: T, body_force: &mut [Spatial<T>]) {
        let lines = self.plan.tendon_lines[tendon].clone();
        for (line, plan) in self.line[lines.clone()].iter().zip(&self.plan.lines[lines]) {
            let force = force * T::splat(plan.weight);
            add_scaled(&mut body_force[plan.from], line, -force);
            add_scaled(&mut body_force[plan.to], line, force);
        }
    }
}

/// Fills lengths and lines of action.
#[inline(always)]
pub fn update<T: Real>(state: &State<T>, kinematics: &Kinematics<T>, out: &mut TendonPaths<T>) {
    let plan = Arc::clone(&out.plan);
    for (position, point) in out.point.iter_mut().zip(&plan.points) {
        *position = kinematics.point(point.body, &constant(&point.local));
    }
    for (length, constant) in out.length.iter_mut().zip(&plan.constant_length) {
        *length = T::splat(*constant);
    }
    for segment in &plan.segments {
        lay_segment(kinematics, &plan, segment, out);
    }
    for wrap in &plan.wraps {
        lay_wrap(kinematics, &plan, wrap, out);
    }
    add_joint_terms(&plan, &mut out.length, |term| state.position[term.address]);
}

#[inline(always)]
fn lay_segment<T: Real>(kinematics: &Kinematics<T>, plan: &Plan, segment: &Segment, out: &mut TendonPaths<T>) {
    let [start, end] = segment.ends.map(|end| out.point[end]);
    let (length, direction) = straight(&start, &end);
    out.length[segment.tendon] += length * T::splat(segment.weight);
    for line in segment.lines.clone() {
        out.line[line] = line_through(&start, &direction, &kinematics.subtree_com[plan.lines[line].root]);
    }
}

#[inline(always)]
fn lay_wrap<T: Real>(kinematics: &Kinematics<T>, plan: &Plan, wrap: &Wrap, out: &mut TendonPaths<T>) {
    let [start, end] = wrap.ends.map(|end| out.point[end]);
    let (position, rotation) = (kinematics.geom_position[wrap.geom], kinematics.geom_rotation[wrap.geom]);
    let side = match &wrap.side {
        Side::None => None,
        Side::Fixed(local) => Some(constant(local)),
        Side::Moving(point) => Some(super::spatial::rotate_back(&rotation, &(out.point[*point] - position))),
    };
    let obstacle = WrappingSurface { shape: wrap.shape, position, rotation, radius: T::splat(wrap.radius), side };
    let (mut length, direction) = straight(&start, &end);
    let mut directions = [direction; 2];
    if let Some(bend) = bend(&start, &end, &obstacle) {
        let (before, approach) = straight(&start, &bend.first);
        let (after, departure) = straight(&bend.second, &end);
        let mixed = |bent: &Vector3<T>| Vector3::from_fn(|row, _| T::select(bend.touches, bent[row], direction[row]));
        directions = [mixed(&approach), mixed(&departure)];
        length = T::select(bend.touches, before + bend.arc + after, length);
    }
    out.length[wrap.tendon] += length * T::splat(wrap.weight);
    for (part, through) in [start, end].iter().enumerate() {
        for line in wrap.lines[part].clone() {
            out.line[line] = line_through(through, &directions[part], &kinematics.subtree_com[plan.lines[line].root]);
        }
    }
}

/// Length and unit direction from `start` to `end`; along x where they coincide.
#[inline(always)]
fn straight<T: Real>(start: &Vector3<T>, end: &Vector3<T>) -> (T, Vector3<T>) {
    let gap = end - start;
    let length = norm(&gap);
    let vanishes = length.less(T::splat(MINIMUM));
    let direction = scale(&gap, T::splat(1.0) / length.at_least(T::splat(MINIMUM)));
    let along = |value: T, other: f64| T::select(vanishes, T::splat(other), value);
    (length, Vector3::new(along(direction.x, 1.0), along(direction.y, 0.0), along(direction.z, 0.0)))
}

#[inline(always)]
fn line_through<T: Real>(point: &Vector3<T>, direction: &Vector3<T>, reference: &Vector3<T>) -> Spatial<T> {
    [cross(&(point - reference), direction), *direction]
}

/// Adds to `sums` the linear combinations of the fixed tendons.
#[inline(always)]
fn add_joint_terms<T: Real>(plan: &Plan, sums: &mut [T], value: impl Fn(&plan::JointTerm) -> T) {
    if plan.joint_terms.is_empty() {
        return;
    }
    for (sum, terms) in sums.iter_mut().zip(&plan.tendon_joints) {
        for term in &plan.joint_terms[terms.clone()] {
            *sum += value(term) * T::splat(term.coefficient);
        }
    }
}

/// Fills the velocities of all tendons from those of the bodies, and of the joints for fixed ones.
#[inline(always)]
pub fn update_velocities<T: Real>(state: &State<T>, velocities: &Velocities<T>, out: &mut TendonPaths<T>) {
    for (velocity, lines) in out.velocity.iter_mut().zip(&out.plan.tendon_lines) {
        let mut sum = T::splat(0.0);
        for (line, plan) in out.line[lines.clone()].iter().zip(&out.plan.lines[lines.clone()]) {
            let (from, to) = (&velocities.body[plan.from], &velocities.body[plan.to]);
            sum += T::splat(plan.weight) * pair(line, &[to[0] - from[0], to[1] - from[1]]);
        }
        *velocity = sum;
    }
    add_joint_terms(&out.plan, &mut out.velocity, |term| state.velocity[term.dof]);
}

/// Writes into `row` (`nv` entries) how the length of `tendon` changes with every dof, m or m/rad: its row of the tendon
/// Jacobian, the negative of the muscle's moment arms. On request only; the step has no use for it.
pub fn moment_arms<T: Real>(model: &Model, kinematics: &Kinematics<T>, paths: &TendonPaths<T>, tendon: usize, row: &mut [T]) {
    row.fill(T::splat(0.0));
    each_moment_arm(model, kinematics, paths, tendon, |dof, part| row[dof] += part);
}

/// The dofs that can change the length of `tendon`, ascending: all that [`each_moment_arm`] can visit.
pub fn moment_dofs<T: Real>(model: &Model, paths: &TendonPaths<T>, tendon: usize) -> Vec<usize> {
    paths.columns(model, tendon)
}

/// Visits the parts that make up a tendon's row of the Jacobian ([`moment_arms`]): a dof may come up several times.
pub fn each_moment_arm<T: Real>(
    model: &Model,
    kinematics: &Kinematics<T>,
    paths: &TendonPaths<T>,
    tendon: usize,
    mut visit: impl FnMut(usize, T),
) {
    let plan = &paths.plan;
    let lines = plan.tendon_lines[tendon].clone();
    for (line, plan) in paths.line[lines.clone()].iter().zip(&plan.lines[lines]) {
        each_mover(model, plan, |dof, weight| visit(dof, pair(&kinematics.dof_axis[dof], line) * T::splat(weight)));
    }
    for term in &plan.joint_terms[plan.tendon_joints[tendon].clone()] {
        visit(term.dof, T::splat(term.coefficient));
    }
}

/// Visits the dofs that a line moves with, those on the way from one of its bodies to the root but not from both, with the
/// line's weight, negative on the side it comes from.
fn each_mover(model: &Model, line: &plan::Line, mut visit: impl FnMut(usize, f64)) {
    let (mut to, mut from) = (last_dof(model, line.to), last_dof(model, line.from));
    // Parents come before their children, so the later of the two is never an ancestor of the other.
    while to != from {
        let (end, weight) = if to > from { (&mut to, line.weight) } else { (&mut from, -line.weight) };
        let Some(dof) = *end else { break };
        visit(dof, weight);
        *end = model.dofs.parent[dof];
    }
}

/// Moment arm of `tendon` about one dof, -dL/dq: m for a rotation, a pure number for a translation. Positive where the pull
/// drives the dof towards larger coordinates. On request only.
pub fn moment_arm<T: Real>(model: &Model, kinematics: &Kinematics<T>, paths: &TendonPaths<T>, tendon: usize, dof: usize) -> T {
    let mut sum = T::splat(0.0);
    each_moment_arm(model, kinematics, paths, tendon, |moved, part| {
        if moved == dof {
            sum -= part;
        }
    });
    sum
}
