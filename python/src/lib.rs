//! The native part of the Python package `msk`: compiler, environments and simulator, as thin classes over the Rust crates.
//!
//! What Gymnasium wants of an environment (spaces, info, registration) is written in Python, in `msk/`. Two rules hold here: no
//! class holds the interpreter's lock while it computes, and no panic reaches Python (both in [`guard`]).

mod agent;
mod arrays;
mod camera;
mod collection;
mod compilation;
mod environment;
mod evaluation;
mod guard;
mod physics;
mod queue;
mod recorded;
mod report;
mod snapshot;
mod state;
mod task;
mod texts;
mod vector;
mod workers;

use pyo3::prelude::*;

/// The native part of the package `msk`; use the package instead.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::agent::Agent;
    #[pymodule_export]
    use super::camera::Camera;
    #[pymodule_export]
    use super::collection::{collect, merge_collected};
    #[pymodule_export]
    use super::compilation::{check, compile};
    #[pymodule_export]
    use super::environment::Environment;
    #[pymodule_export]
    use super::evaluation::{evaluate, merge};
    #[cfg(debug_assertions)]
    #[pymodule_export]
    use super::guard::provoke_panic;
    #[pymodule_export]
    use super::physics::{Batch, Model, Simulation};
    #[pymodule_export]
    use super::queue::Queue;
    #[pymodule_export]
    use super::report::Report;
    #[pymodule_export]
    use super::snapshot::Snapshot;
    #[pymodule_export]
    use super::task::Task;
    #[pymodule_export]
    use super::texts::{text, texts};
    #[pymodule_export]
    use super::vector::VectorEnvironment;
}
