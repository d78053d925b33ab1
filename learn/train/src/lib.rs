//! Learners of tasks: an agent plays batches of episodes and becomes better at what their reward asks for.
//!
//! 1. [`Settings`] choose algorithm and sizes; presets are `fast` and `paper`;
//! 2. `play` steps the episodes, scales what networks see, and keeps how episodes end;
//! 3. `ppo`, `sac`, `mpo`, `dynsyn` and `imitation` are the algorithms, `dep` explores, each a file that reads like its paper;
//! 4. a [`Training`] plays and learns in rounds; its state can be written between any two and continued bit for bit;
//! 5. a [`Session`](session::Session) keeps a training in a folder, evaluates it and keeps the best agents;
//! 6. an [`Agent`] is a folder, [`Agents`] are those of several tasks; [`source`] makes them policies of `run`, `eval` and `test`.
//!
//! The same seed gives the same bits at any number of threads. `docs/training.md` has settings, files and measurements.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod agent;
mod agents;
pub mod curve;
mod dep;
mod dynsyn;
mod error;
mod evaluate;
mod head;
mod imitation;
mod learner;
mod mpo;
mod noise;
mod numbers;
mod onnx;
mod play;
mod policy;
mod ppo;
mod protobuf;
mod recorded;
mod replay;
mod sac;
mod sensors;
pub mod session;
mod settings;
mod teaching;
mod tensorboard;
mod training;

pub use agent::{Actor, Agent, AgentError, Description, Unfit};
pub use agents::Agents;
pub use error::TrainError;
pub use evaluate::Evaluation;
pub use learner::Losses;
pub use msk_settings::SettingsError;
pub use policy::{source, source_of};
pub use recorded::{DataSet, RecordedEpisode, RecordedOutcome};
pub use settings::{
    Algorithm, CloneSettings, DepSettings, DynsynSettings, MpoSettings, PpoSettings, Precision, Preset, SacSettings, Settings,
};
pub use teaching::Lessons;
pub use training::{Identity, Provenance, ReplaySize, Round, Training};
