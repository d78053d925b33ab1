//! Weights of compiled tasks while they are used: overlays, files that change under a running evaluation, and tuning.
//!
//! 1. An [`overlay::Overlay`] is a weights file, checked against the tasks that it lies over;
//! 2. a [`store::Store`] replaces such a file, or a source, in one step, under a lock, with a history that is complete;
//! 3. [`live::Live`] feeds a running evaluation (or any loop of episodes) from it;
//! 4. [`statistics`] summarizes what each term did in episodes;
//! 5. a [`reasoner::Reasoner`] proposes other weights from that, and [`session`] is the loop around it.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod live;
pub mod overlay;
pub mod reasoner;
pub mod session;
pub mod statistics;
pub mod store;
