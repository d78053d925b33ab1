//! Graph to program: what a compiled task runs once per control step.
//!
//! 1. `outputs`: sensors of all live nodes get slots in the frame, in a fixed order, so that neighbours can be copied as one.
//! 2. `spread`: nodes become single numbers (`lane`), so that choosing lanes and putting them side by side costs nothing; long
//!    lists stay whole.
//! 3. `sharing`: what has several readers is computed once and written down; what has one is computed within it.
//! 4. `assemble`: every formula becomes one closure that calls those within it (`formula`), sums over two lists are computed in
//!    one go (`pairs`), long lists by loops (`block`), and what is observed is copied in as few pieces as possible (`plan`).
//! 5. `run`: executes the statements: no look-up by name, no allocation, no types.

mod assemble;
mod block;
mod formula;
#[cfg(any(test, feature = "interpreter"))]
mod interpret;
mod lane;
mod outputs;
mod pairs;
mod plan;
mod program;
mod run;
mod sharing;
mod spread;

pub(crate) use assemble::assemble;
pub(crate) use formula::{Scalar, View};
#[cfg(any(test, feature = "interpreter"))]
pub use interpret::{Interpreter, Moment};
pub(crate) use outputs::deciding_sensors;
pub use outputs::{DrawOutput, Outputs, layout};
pub(crate) use plan::Plan;
pub(crate) use program::Program;
pub(crate) use run::NoneTaken;
