//! Constraint rows: what is held together, rubs, is limited or touches, how far it is violated, and how hard it pulls back.
//!
//! The model is that of E. Todorov, "Convex and analytically-invertible dynamics with contacts and constraints: theory and
//! implementation in MuJoCo" (ICRA 2014), as MuJoCo's manual has it in its chapter Computation, "Constraint model" and
//! "Constraint solver, Parameters":
//!
//! 1. equalities, friction losses of joints and tendons, limits of joints and tendons, and contacts become blocks of the
//!    Jacobian J and rows, in this order, which is MuJoCo's;
//! 2. each row gets its impedance d, stiffness k and damping b (`solref`, `solimp`), its regularisation
//!    R = (1 - d) / d Â from the inverse weights Â at the reference configuration, and the acceleration that it asks for,
//!    a_ref = -b J v - k d (position - margin), without stiffness for friction, which has no position; connections and welds
//!    subtract the acceleration J' v that their points have without joint accelerations (J' the rate of J);
//! 3. a row's force is a clipped spring on its acceleration error, force = clip(-(J a - a_ref) / R, lower, upper): no bounds
//!    for equalities, plus and minus the loss for friction loss, non-negative for limits, frictionless contacts and the edges
//!    of a pyramid. The rows of an elliptic contact share one law instead, that of their `cone`.
//!
//! What depends on the model alone (which dofs an equality or tendon couples) is decided once, in `plan`.
//!
//! The set of rows differs between episodes, so this stage works on one episode in `f64`: an episode in a SIMD lane is read through
//! [`Real::lane`]. For the solver of all lanes most rows are made in all of them at once instead (`solver::slots`), and an episode gets
//! rows of its own when it leaves its lane. What is common to all lanes is computed in the stages before and after.

pub(crate) mod cone;
pub(crate) mod contacts;
pub(crate) mod equalities;
pub(crate) mod impedance;
pub(crate) mod jacobian;
mod limits;
mod plan;
pub(crate) mod rows;

pub use rows::{RowKind, Rows};

use super::{Workspace, collision, state::State, tendons::each_moment_arm};
use crate::{model::Model, scalar::Real};
use cone::Cone;
use jacobian::{Jacobian, Shape};
pub(crate) use plan::{RowPlan, Soft};
use std::sync::Arc;

/// What couples dofs that do not lie on one root path, so that the solver's pattern needs room for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum CrossCoupling {
    /// An equality, by its index.
    Equality(usize),
    /// A tendon with a friction or limit row, by its index.
    Tendon(usize),
    /// A contact, by its candidate's index.
    Contact(usize),
}

/// Which rows an episode has of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Extent {
    /// All.
    #[default]
    All,
    /// Those that are not made in all lanes at once for the solver of all lanes: equalities but couplings of joints, friction and limits of
    /// tendons, limits of balls.
    Unshared,
}

/// The constraints of one episode.
#[derive(Debug, Clone, Default)]
pub struct Constraints {
    /// Which geoms can meet.
    pub plan: Arc<collision::Plan>,
    /// Contacts, including those in the gap that carry no force.
    pub contacts: Vec<collision::Contact>,
    /// Constraint rows.
    pub rows: Rows,
    /// Their Jacobian.
    pub(crate) jacobian: Jacobian,
    /// Elliptic friction cones, in the order of their rows.
    pub(crate) cones: Vec<Cone>,
    /// What couples several chains, in the order of the rows: what the solver's pattern depends on.
    pub(crate) cross_couplings: Vec<CrossCoupling>,
    /// Which rows have been built.
    pub(crate) extent: Extent,
    pub(crate) fixed: Arc<RowPlan>,
    velocity: Vec<f64>,
    /// Velocities of rows that no dof makes: those of contacts with bodies that are moved from outside.
    drift: Vec<(usize, f64)>,
    /// A tendon's row of the Jacobian while it is gathered.
    arms: Vec<f64>,
}

impl Constraints {
    /// Memory for `model`, the pairs of its geoms that can meet, and the topology of its other constraints.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Arc::new(collision::Plan::new(model)), &Arc::new(RowPlan::new(model)))
    }

    pub(crate) fn of(model: &Model, pairs: &Arc<collision::Plan>, rows: &Arc<RowPlan>) -> Self {
        Self { plan: Arc::clone(pairs), fixed: Arc::clone(rows), arms: vec![0.0; model.nv], ..Self::default() }
    }

    /// Row `row` of the constraint Jacobian (`efc_J`), dense, `nv` entries. On request only.
    pub fn jacobian_row(&self, model: &Model, row: usize) -> Vec<f64> {
        let mut dense = vec![0.0; model.nv];
        for (dof, value) in self.jacobian.row_values(self.jacobian.block_of(row), row) {
            dense[dof] = value;
        }
        dense
    }

    /// MuJoCo's number for the type of a row (`efc_type`).
    pub fn row_type(&self, row: usize) -> u8 {
        match (self.rows.kind[row], self.jacobian.block_of(row).shape) {
            (RowKind::Equality(_), _) => 0,
            (RowKind::DofFriction(_), _) => 1,
            (RowKind::TendonFriction(_), _) => 2,
            (RowKind::JointLimit(_), _) => 3,
            (RowKind::TendonLimit(_), _) => 4,
            (RowKind::Contact(_), Shape::Plain) => 5,
            (RowKind::Contact(_), Shape::Pyramid) => 6,
            (RowKind::Contact(_), Shape::Cone(_)) => 7,
        }
    }

    /// The dofs that a coupling couples, ascending.
    pub(crate) fn columns_of(&self, coupling: CrossCoupling) -> &[usize] {
        match coupling {
            CrossCoupling::Equality(equality) => self.fixed.columns_of(&self.fixed.equalities[equality]),
            CrossCoupling::Tendon(tendon) => self.fixed.columns_of(&self.fixed.tendons[tendon]),
            CrossCoupling::Contact(candidate) => self.plan.columns_of(candidate),
        }
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

    /// Builds all rows of the episode in `lane` from its positions, velocities and contacts.
    pub fn build<T: Real>(&mut self, model: &Model, state: &State<T>, workspace: &Workspace<T>, lane: usize) {
        self.build_extent(model, state, workspace, lane, Extent::All);
    }

    /// Builds the rows of the episode in `lane`, all of them or those that are not made in all lanes at once.
    pub(crate) fn build_extent<T: Real>(
        &mut self,
        model: &Model,
        state: &State<T>,
        workspace: &Workspace<T>,
        lane: usize,
        extent: Extent,
    ) {
        self.extent = extent;
        self.rows.clear();
        self.jacobian.clear();
        self.cones.clear();
        self.cross_couplings.clear();
        self.drift.clear();
        if extent == Extent::Unshared && !self.fixed.some_unshared {
            return;
        }
        let switches = model.options.switches;
        if switches.equality {
            self.add_equalities(model, state, workspace, lane, extent);
        }
        if switches.friction_loss {
            if extent == Extent::All {
                self.add_dof_friction(model);
            }
            self.add_tendon_friction(model, workspace, lane);
        }
        if switches.limit {
            self.add_joint_limits(model, extent, |address| state.position[address].lane(lane));
            self.add_tendon_limits(model, workspace, lane);
        }
        if extent == Extent::All {
            self.add_contacts(model, state, workspace, lane);
        }
        if self.rows.is_empty() {
            return;
        }
        self.velocity.clear();
        self.velocity.extend(state.velocity.iter().map(|value| value.lane(lane)));
        self.rows.finish(&self.jacobian, &self.velocity, &self.drift);
        if switches.equality {
            self.subtract_curvature(model, state, workspace, lane);
        }
    }

    /// Sets `arms` over `columns` to `first` times the Jacobian row of one tendon plus, if there is one, a multiple of another's.
    fn gather_arms<T: Real>(
        &mut self,
        model: &Model,
        workspace: &Workspace<T>,
        lane: usize,
        (tendon, factor): (usize, f64),
        other: Option<(usize, f64)>,
    ) {
        self.arms.fill(0.0);
        for (tendon, factor) in core::iter::once((tendon, factor)).chain(other) {
            each_moment_arm(model, &workspace.kinematics, &workspace.tendons, tendon, |dof, part| {
                self.arms[dof] += factor * part.lane(lane);
            });
        }
    }
}

/// The shortest time constant of a spring, s.
pub(crate) fn shortest_time_constant(model: &Model) -> f64 {
    if model.options.switches.safe_reference { 2.0 * model.options.timestep } else { 0.0 }
}
