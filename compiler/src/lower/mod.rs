//! Graph to program: what a compiled task runs once per control step.
//!
//! 1. `assemble`: sensors of all live nodes get slots in the frame, in a fixed order, so that neighbours can be read as one
//!    slice; every live node becomes one instruction that writes its lanes to a register range, views of frame, constants and
//!    registers cost nothing. Nodes that need a state after its update come last.
//! 2. `run`: executes the list: no look-up by name, no allocation, no types.
//! 3. `finish`: labels, layout and hash around it.

mod assemble;
mod finish;
#[cfg(any(test, feature = "interpreter"))]
mod interpret;
mod program;
mod run;

pub(crate) use assemble::{DrawOutput, Outputs, assemble, layout};
pub(crate) use finish::{CheckedPhase, Heading, Tested, finish};
#[cfg(feature = "interpreter")]
pub use interpret::{PlainTask, Snapshot};
pub(crate) use program::Program;
pub(crate) use run::NoneTaken;
