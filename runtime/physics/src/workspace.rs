//! The outputs of all stages, allocated once per worker.

use super::integrator::{implicit::Implicit, runge_kutta::RungeKutta};
use super::{
    Fault, Instructions, Plan,
    actuation::Actuation,
    collision::{Memory, NearPairs},
    constrained::ConstraintState,
    forces::Forces,
    inertia::Inertia,
    kinematics::Kinematics,
    tendons::TendonPaths,
    velocities::Velocities,
};
use crate::{
    model::{Cone, Integrator, Model},
    scalar::Real,
    solver::together::Together,
};
use pulp::Arch;

/// Scratch memory and results of one forward step, in the order of the stages. Nothing in it outlives the step: whatever an
/// episode needs to continue is in [`State`](super::state::State).
#[derive(Debug, Clone)]
pub struct Workspace<T: Real> {
    /// Frames, centres of mass and motion axes.
    pub kinematics: Kinematics<T>,
    /// Pairs of geoms that are near each other.
    pub(crate) near: NearPairs<T>,
    /// Memory of the search for contacts.
    pub(crate) memory: Memory<T>,
    /// The mass matrix and its factor.
    pub inertia: Inertia<T>,
    /// Tendon lengths and velocities and the lines of action between bodies.
    pub tendons: TendonPaths<T>,
    /// Body velocities.
    pub velocities: Velocities<T>,
    /// Lengths, velocities, activation rates and forces of muscles and other actuators.
    pub actuation: Actuation<T>,
    /// Generalised forces and the acceleration that they cause without constraints.
    pub forces: Forces<T>,
    /// What went wrong in each lane of `T` in the last step.
    pub faults: Vec<Option<Fault>>,
    /// Lanes that hold no episode, or one that is not stepped: nothing is decided, written or reported for them.
    pub(crate) masked: Vec<bool>,
    pub(crate) arch: Arch,
    /// The solver of several lanes at once, for constraints whose forces have bounds of their own: not for elliptic cones, nor
    /// where friction has a second pass.
    pub(crate) together: Option<Together<T>>,
    /// Contacts, constraint rows and solver: one per lane of `T`. Where lanes are solved together, most of their rows are made in all of
    /// them at once and are not here.
    pub lanes: Vec<ConstraintState>,
    /// Generalised acceleration, constraints included, `nv` entries (`qacc`): m/s² and rad/s².
    pub acceleration: Vec<T>,
    /// Generalised force of all constraints, `nv` entries (`qfrc_constraint`): N and N m.
    pub constraint_force: Vec<T>,
    /// Acceleration that the integrator applies, damping implicit, `nv` entries.
    pub damped_acceleration: Vec<T>,
    /// Memory of the implicit integrator, if the model asks for it.
    pub(super) implicit: Option<Implicit<T>>,
    /// Memory of the Runge-Kutta method, if the model asks for it.
    pub(super) runge_kutta: Option<RungeKutta<T>>,
}

impl<T: Real> Workspace<T> {
    /// Memory for `model`, with a plan of its own.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Plan::new(model))
    }

    /// Memory for `model`, with a plan that is shared.
    pub fn of(model: &Model, plan: &Plan) -> Self {
        Self {
            kinematics: Kinematics::of(model, &plan.kinematics),
            near: NearPairs::of(&plan.pairs),
            memory: Memory::new(),
            inertia: Inertia::of(model, &plan.armature),
            tendons: TendonPaths::of(model, &plan.tendons),
            velocities: Velocities::new(model),
            actuation: Actuation::of(model, &plan.actuation),
            forces: Forces::of(model, &plan.medium),
            faults: vec![None; T::LANES],
            masked: vec![false; T::LANES],
            together: solved_together::<T>(model).then(|| Together::of(model, &plan.coupled)),
            arch: Instructions::default().arch(),
            lanes: vec![ConstraintState::of(model, plan); T::LANES],
            acceleration: vec![T::splat(0.0); model.nv],
            constraint_force: vec![T::splat(0.0); model.nv],
            damped_acceleration: vec![T::splat(0.0); model.nv],
            implicit: (model.options.integrator == Integrator::Implicit).then(|| Implicit::of(model, &plan.floating)),
            runge_kutta: (model.options.integrator == Integrator::RungeKutta).then(|| RungeKutta::of(model, &plan.turning)),
        }
    }

    /// The same with these instructions of the processor instead of the widest: the bits are the same.
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.arch = instructions.arch();
        self
    }

    /// Whether a register holds four numbers or more.
    pub(crate) fn arch_is_wide(&self) -> bool {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        return matches!(self.arch, Arch::V3(_) | Arch::V4(_));
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        return false;
    }

    /// Whether the step goes on in a lane.
    pub(crate) fn lives(&self, lane: usize) -> bool {
        !self.masked[lane] && self.faults[lane].is_none()
    }

    /// Moves the faults that have just been found to those of their lanes, which are masked from here on.
    pub(crate) fn take_faults(&mut self, met: &mut [Option<Fault>]) {
        for ((kept, found), masked) in met.iter_mut().zip(&mut self.faults).zip(&mut self.masked) {
            if let Some(fault) = found.take().filter(|_| !*masked) {
                *kept = Some(fault);
                *masked = true;
            }
        }
    }

    /// The fault of the first lane that has one.
    pub(crate) fn outcome(&self) -> Result<(), Fault> {
        self.faults.iter().flatten().next().map_or(Ok(()), |fault| Err(fault.clone()))
    }
}

/// Whether the lanes of `T` are solved together.
fn solved_together<T: Real>(model: &Model) -> bool {
    T::LANES > 1 && model.options.cone == Cone::Pyramidal && model.options.no_slip_iterations == 0
}
