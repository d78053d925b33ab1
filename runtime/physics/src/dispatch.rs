//! Which instructions of the processor the stages are compiled to, chosen while the program runs.
//!
//! The hot functions of all stages are inlined into the operations here, which are compiled once for each set of instructions.
//! Wider registers change how many numbers an instruction takes and nothing else: no operation is fused or reordered, so the bits
//! are the same.

use crate::{Workspace, inertia, integrator, kinematics, model::Model, scalar::Real, smooth, state::State, tendons};
use pulp::{Arch, Simd, WithSimd};

/// A set of instructions; one that the processor lacks stands for the next smaller one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Instructions {
    /// Those that the program was compiled for: SSE2 on x86-64.
    Baseline,
    /// AVX2 on x86-64, NEON on ARM.
    Wide,
    /// AVX-512 on x86-64.
    #[default]
    Widest,
}

impl Instructions {
    pub(crate) fn arch(self) -> Arch {
        match self {
            Self::Baseline => Arch::Scalar,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Wide => pulp::x86::V3::try_new().map_or(Arch::Scalar, Arch::V3),
            _ => Arch::new(),
        }
    }
}

/// A part of a step that works on all lanes at once.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stage {
    Kinematics,
    Inertia,
    Tendons,
    Velocities,
    Actuation,
    /// The acceleration without constraints.
    Unconstrained,
    /// The acceleration that Euler's method applies.
    Damped,
}

struct Run<'a, T: Real> {
    stage: Stage,
    model: &'a Model,
    state: &'a State<T>,
    workspace: &'a mut Workspace<T>,
}

impl<T: Real> WithSimd for Run<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { stage, model, state, workspace } = self;
        match stage {
            Stage::Kinematics => kinematics::update_lanes(model, state, &mut workspace.kinematics),
            Stage::Inertia => inertia::update(model, &workspace.kinematics, &mut workspace.inertia),
            Stage::Tendons => tendons::update(state, &workspace.kinematics, &mut workspace.tendons),
            Stage::Velocities => smooth::velocity_stage(model, state, workspace),
            Stage::Actuation => smooth::actuation_stage(model, state, workspace),
            Stage::Unconstrained => smooth::unconstrained_stage(model, workspace),
            Stage::Damped => integrator::damped_acceleration(model, workspace),
        }
    }
}

/// Runs a stage with the instructions of the workspace.
#[inline(never)]
pub(crate) fn run<T: Real>(stage: Stage, model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    workspace.arch.dispatch(Run { stage, model, state, workspace });
}
