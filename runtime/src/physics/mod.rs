//! The simulator: one forward step in MuJoCo's order.
//!
//! 1. [`kinematics`]: frames of bodies, inertias, geoms and sites, joint axes, centres of mass, motion subspace;
//! 2. [`inertia`]: composite rigid bodies, the mass matrix on the tree's own sparsity, its factor;
//! 3. [`tendons`]: path lengths with wrapping, the segments that join two bodies;
//! 4. [`velocities`]: bodies, dofs' time derivatives, tendon and muscle velocities, without any tendon Jacobian;
//! 5. [`muscles`] and [`forces`]: muscles, passive elements, bias;
//! 6. constraints: couplings, limits, contacts; rows, references, regularisation;
//! 7. solver: Newton on the primal problem;
//! 8. integrator: Euler with implicit joint damping.
//!
//! Every stage owns a struct of outputs (structure of arrays) inside [`Workspace`], which is allocated once per worker.

pub mod forces;
pub mod inertia;
pub mod jacobian;
pub mod kinematics;
pub mod muscles;
pub mod rotation;
pub mod smooth;
pub mod spatial;
pub mod state;
pub mod tendons;
pub mod velocities;
pub mod workspace;

pub use jacobian::{center_of_mass_jacobian, point_jacobian};
pub use smooth::smooth;
pub use state::State;
pub use tendons::moment_arms;
pub use workspace::Workspace;
