//! `--trace` and what goes with it.

use msk::evaluate::Tracing;
use msk::evaluate::trace::{Quantity, quantities};

/// Which traces are kept.
#[derive(clap::Args)]
pub struct TraceArgs {
    /// Keep a trace of each episode in the folder traces/ of the results: a NumPy archive with a row per control step. Quantities
    /// are separated by commas, without any all of them: excitations, activations, muscle_forces, positions, velocities, torques,
    /// joint_reactions, contacts, ground_reactions, feet, center_of_mass, metabolic_power, tracking_error, terms, rewards, observations,
    /// actions
    #[arg(long, value_name = "QUANTITIES", num_args = 0..=1, require_equals = true, default_missing_value = "all", value_parser = parse)]
    trace: Option<Quantities>,
    /// Keep traces of so many episodes of each task only, the first ones
    #[arg(long, value_name = "N", requires = "trace")]
    trace_episodes: Option<u64>,
}

/// Quantities of a trace.
#[derive(Debug, Clone)]
pub struct Quantities(pub Vec<Quantity>);

/// Reads the names of quantities.
pub fn parse(text: &str) -> Result<Quantities, String> {
    quantities(text).map(Quantities).map_err(|error| error.to_string())
}

impl TraceArgs {
    /// What is to be kept, if anything is.
    pub fn tracing(&self) -> Option<Tracing> {
        let quantities = self.trace.as_ref()?.0.clone();
        Some(Tracing { quantities, episodes: self.trace_episodes.unwrap_or(u64::MAX) })
    }
}
