//! The simulator: one forward step in MuJoCo's order.
//!
//! 1. [`kinematics`]: frames of bodies, inertias, geoms and sites, joint axes, centres of mass, motion subspace;
//! 2. [`inertia`]: composite rigid bodies, the mass matrix on the tree's own sparsity, its factor;
//! 3. [`tendons`]: path lengths with wrapping, the segments that join two bodies;
//! 4. [`velocities`]: bodies, dofs' time derivatives, tendon and muscle velocities, without any tendon Jacobian;
//! 5. [`actuation`] with [`elastic`] tendons and [`forces`]: muscles and other actuators, passive elements, bias;
//! 6. [`collision`] and [`constraint`]: contacts; rows of equalities, friction, limits and contacts, their softness;
//! 7. [`solver`]: Newton on the primal problem;
//! 8. [`integrator`]: Euler with implicit joint damping, implicit in velocity, Runge-Kutta.
//!
//! Every stage owns a struct of outputs (structure of arrays) inside [`Workspace`], which is allocated once per worker.

pub mod actuation;
pub mod collision;
pub mod constants;
pub mod constrained;
pub mod constraint;
pub mod elastic;
pub mod fault;
mod fluid;
pub mod forces;
pub mod inertia;
pub mod integrator;
pub mod jacobian;
pub mod kinematics;
pub mod rotation;
pub mod sensors;
pub mod smooth;
pub mod solver;
pub mod spatial;
pub mod state;
pub mod stepping;
pub mod tendons;
pub mod tree_matrix;
pub mod velocities;
pub mod workspace;

pub use fault::Fault;
pub use jacobian::{center_of_mass_jacobian, point_jacobian};
pub use smooth::smooth;
pub use state::State;
pub use stepping::{forward, integrate, motion, step};
pub use tendons::{moment_arm, moment_arms};
pub use workspace::Workspace;
