//! Which instructions of the processor the stages are compiled to, chosen while the program runs.
//!
//! The hot functions of all stages are inlined into the operations here, which are compiled once for each set of instructions.
//! Wider registers change how many numbers an instruction takes and nothing else: no operation is fused or reordered, so the bits
//! are the same.

use crate::{Workspace, actuation, inertia, integrator, kinematics, model::Model, scalar::Real, smooth, state::State, tendons};
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
    /// Does work with these instructions: the bits are those of any others.
    pub fn run<W: LaneWork>(self, work: W) -> W::Output {
        self.arch().dispatch(Inlined(work))
    }

    pub(crate) fn arch(self) -> Arch {
        match self {
            Self::Baseline => Arch::Scalar,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Wide => pulp::x86::V3::try_new().map_or(Arch::Scalar, Arch::V3),
            _ => Arch::new(),
        }
    }
}

/// Work on [`Lanes`](crate::lanes::Lanes) outside the simulator.
///
/// ```
/// use msk_physics::{Instructions, LaneWork, lanes::Lanes, scalar::Real};
///
/// struct Sum<'a>(&'a [Lanes]);
///
/// impl LaneWork for Sum<'_> {
///     type Output = Lanes;
///     #[inline(always)]
///     fn run(self) -> Lanes {
///         self.0.iter().fold(Lanes::splat(0.0), |sum, value| sum + *value)
///     }
/// }
///
/// let sum = Instructions::default().run(Sum(&[Lanes::splat(1.0), Lanes::splat(2.0)]));
/// assert_eq!(sum.lane(7), 3.0);
/// ```
pub trait LaneWork {
    /// What it gives.
    type Output;
    /// Does it. With all that it calls it must be `#[inline(always)]`, so that it is compiled once for each set of instructions.
    fn run(self) -> Self::Output;
}

struct Inlined<W>(W);

impl<W: LaneWork> WithSimd for Inlined<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> W::Output {
        self.0.run()
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
    /// The activation rates alone.
    Excitation,
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
            Stage::Inertia => inertia::update(model, state, &workspace.kinematics, &mut workspace.inertia),
            Stage::Tendons => tendons::update(state, &workspace.kinematics, &mut workspace.tendons),
            Stage::Velocities => smooth::velocity_stage(model, state, workspace),
            Stage::Actuation => smooth::actuation_stage(model, state, workspace),
            Stage::Excitation => actuation::update_rates(state, &mut workspace.actuation),
            Stage::Unconstrained => smooth::unconstrained_stage(model, workspace),
            Stage::Damped => integrator::damped_acceleration(model, state, workspace),
        }
    }
}

/// Runs a stage with the instructions of the workspace.
#[inline(never)]
pub(crate) fn run<T: Real>(stage: Stage, model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    workspace.arch.dispatch(Run { stage, model, state, workspace });
}
