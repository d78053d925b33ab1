//! The simulator's quantities for people and scripts, in MuJoCo's names, orders and units.
//!
//! 1. [`StateFile`] is a state as JSON (`qpos`, `qvel`, `act`, `ctrl` and what acts from outside; what is absent is at rest);
//! 2. [`forward_report`] lists every intermediate quantity of one forward computation as JSON.
//! 3. [`sweep_muscle`] follows one muscle over the range of one joint: path, wraps, length, moment arm.
//! 4. [`inspect_motion`] measures a motion on a body: ranges, couplings, feet, seam, sides.
//! 5. [`Excitations`] are read from a NumPy array, for a rollout.
//!
//! Arrays are flat and row-major; numbers are the shortest that read back to the same bits.

mod excitations;
mod motion;
mod muscle;
mod report;
mod state_file;

pub use excitations::{Excitations, ExcitationsError};
pub use motion::{MotionColumn, MotionFoot, MotionLimits, MotionReport, inspect_motion};
pub use muscle::{MuscleSweep, PathPoint, Sample, SweepError, Wrap, sweep_muscle};
pub use report::{Extra, forward_report};
pub use state_file::{StateError, StateFile};
