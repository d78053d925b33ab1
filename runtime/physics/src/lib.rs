//! A simulator of rigid bodies and muscles that equals MuJoCo: it reads MJCF, MuJoCo's model format, and steps it.
//!
//! It knows nothing of tasks, rewards or `.msk` files. A [`Model`](model::Model) and the [`Plan`] that follows from it are immutable
//! and shared; a [`State`] is plain data, so a snapshot is a clone; a [`Workspace`] is the scratch memory of one worker.
//!
//! ```
//! use msk_physics::{State, Workspace, model::Model, step};
//!
//! let model = Model::from_mjcf(r#"<mujoco><worldbody><body>
//!     <joint type="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -1" size="0.05"/>
//! </body></worldbody></mujoco>"#)?;
//! let (mut state, mut workspace) = (State::<f64>::new(&model), Workspace::new(&model));
//! state.position[0] = 0.3;
//! for _ in 0..500 {
//!     step(&model, &mut state, &mut workspace)?;
//! }
//! assert!(state.position[0].abs() <= 0.3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! One forward step, in MuJoCo's order:
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

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod actuation;
mod batch;
pub mod collision;
pub mod constants;
pub mod constrained;
pub mod constraint;
mod dispatch;
pub mod elastic;
pub mod fault;
mod fluid;
pub mod forces;
pub mod inertia;
pub mod integrator;
pub mod jacobian;
pub mod kinematics;
pub mod lanes;
pub mod model;
pub mod overrides;
pub mod path_matrix;
mod plan;
pub mod rotation;
pub mod scalar;
pub mod sensors;
mod single;
pub mod smooth;
pub mod solver;
pub mod spatial;
pub mod state;
pub mod stepping;
pub mod tendons;
pub mod tree_matrix;
pub mod velocities;
pub mod workspace;

pub use batch::{Batch, BatchError, LaneGroup, Parts, Rates};
pub use dispatch::{Instructions, LaneWork};
pub use fault::{Fault, Input};
pub use jacobian::{center_of_mass_jacobian, moving_dofs, point_jacobian};
pub use plan::Plan;
pub use single::{excite, forward, integrate, motion, smooth, step, step_by_stage, unconstrained};
pub use state::State;
pub use stepping::STAGES;
pub use tendons::{MomentPlan, each_moment_arm, moment_arm, moment_arms, moment_dofs};
pub use workspace::Workspace;

/// The example of the README, compiled and run.
#[cfg(all(doctest, feature = "disk"))]
#[doc = include_str!("../README.md")]
struct Readme;
