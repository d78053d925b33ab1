//! Simulation options.

use nalgebra::Vector3;

/// How time advances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// Semi-implicit Euler with implicit joint damping.
    Euler,
    /// Implicit in all velocities but those of Coriolis forces (MuJoCo's `implicitfast`).
    Implicit,
    /// Runge-Kutta of fourth order (`RK4`).
    RungeKutta,
}

/// Shape of the set of admissible contact forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cone {
    /// Edges of a pyramid inside the cone.
    Pyramidal,
    /// The cone itself.
    Elliptic,
}

/// Kinds of constraints that a model switches off (MuJoCo's `flag` element); all are on by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Switches {
    /// Equalities.
    pub equality: bool,
    /// Friction loss of joints and tendons.
    pub friction_loss: bool,
    /// Limits of joints and tendons.
    pub limit: bool,
    /// Contacts.
    pub contact: bool,
    /// Time constants of constraints are raised to two steps.
    pub safe_reference: bool,
}

impl Default for Switches {
    fn default() -> Self {
        Self { equality: true, friction_loss: true, limit: true, contact: true, safe_reference: true }
    }
}

/// A medium that fills all space; nothing does where density and viscosity are zero.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fluid {
    /// kg/m³.
    pub density: f64,
    /// Pa s.
    pub viscosity: f64,
    /// Velocity of the medium, m/s.
    pub wind: Vector3<f64>,
}

/// Simulation options, MuJoCo's `option` element.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Physics step in seconds.
    pub timestep: f64,
    /// How time advances.
    pub integrator: Integrator,
    /// Whether Euler's method takes joint damping implicitly.
    pub euler_damping: bool,
    /// Gravity in m/s².
    pub gravity: Vector3<f64>,
    /// What surrounds all bodies.
    pub fluid: Fluid,
    /// Solver iterations at most.
    pub iterations: usize,
    /// Line-search iterations at most.
    pub line_search_iterations: usize,
    /// Solver stops when the scaled improvement or gradient falls below this.
    pub tolerance: f64,
    /// Line search stops at this fraction of the solver's tolerance.
    pub line_search_tolerance: f64,
    /// Sweeps at most of the second pass over friction, which stops its creeping ([`solver`](crate::solver)); zero does without.
    pub no_slip_iterations: usize,
    /// The second pass stops when the scaled improvement falls below this.
    pub no_slip_tolerance: f64,
    /// Ratio of frictional to normal constraint impedance.
    pub impedance_ratio: f64,
    /// Friction cone of contacts.
    pub cone: Cone,
    /// Kinds of constraints that are on.
    pub switches: Switches,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            timestep: 0.002,
            integrator: Integrator::Euler,
            euler_damping: true,
            gravity: Vector3::new(0.0, 0.0, -9.81),
            fluid: Fluid::default(),
            iterations: 100,
            line_search_iterations: 50,
            tolerance: 1e-8,
            line_search_tolerance: 0.01,
            no_slip_iterations: 0,
            no_slip_tolerance: 1e-6,
            impedance_ratio: 1.0,
            cone: Cone::Pyramidal,
            switches: Switches::default(),
        }
    }
}
