//! A policy that looks ahead: before it acts it imagines how the episode would go on under many plans, and follows the one that the
//! task's own reward likes best. Nothing is trained; an edited reward is seen as behaviour in the next run.
//!
//! 1. `space` chooses what a plan decides: by default the targets of computed muscle control;
//! 2. a plan is a `curve` through a few knots over a horizon; `proposal` draws others around the present one;
//! 3. `imagine` plays each in the lanes of the simulator, then for some more time without a plan; `value` judges what came of it;
//! 4. `search` makes a better plan of these values: predictive sampling, the cross-entropy method, or MPPI;
//! 5. [`Planner`] is the policy: it acts on the first part of the plan, then plans anew from where that has led.
//!
//! What is imagined knows the present state and nothing of the future: chance comes from other streams, and forces that have not begun
//! to act never do. The same seed gives the same bits at any number of threads. `docs/planning.md` has settings and measurements.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod curve;
mod imagine;
mod look;
mod planner;
mod proposal;
mod search;
mod settings;
mod source;
mod space;
mod value;

pub use msk_settings::SettingsError;
pub use planner::Planner;
pub use settings::{Along, Interpolation, Method, Preset, Settings, SpaceChoice, Targets};
pub use source::{source, sources_without_success};
