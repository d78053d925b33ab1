//! `--policy` and `--policy-timeout`, and actions written to a file.

use crate::error::{Context, Error};
use crate::numbers::within;
use crate::output;
use msk::evaluate::collection::ActionRecorder;
use msk::plan::Preset;
use msk::runtime::policy::PolicySource;
use npyz::WriterBuilder;
use std::path::Path;
use std::time::Duration;

/// An hour is more than any policy thinks, and less than any clock overflows at.
const LONGEST: f64 = 3600.0;

/// Limits for policies that are programs.
#[derive(clap::Args)]
pub struct Limits {
    /// How long a policy that is a process may take for each reply, s
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, value_parser = within(0.001, LONGEST))]
    policy_timeout: f64,
}

impl Limits {
    /// What `--policy` names.
    ///
    /// # Errors
    /// A policy that does not exist, or a file that cannot be read.
    pub fn source(&self, policy: &str) -> Result<PolicySource, Error> {
        let made = msk::plan::source(policy).or_else(|| msk::train::source(policy));
        let source = made.unwrap_or_else(|| PolicySource::parse(policy));
        Ok(source?.with_timeout(Duration::from_secs_f64(self.policy_timeout)))
    }
}

/// The policy that results name. Anybody may have written them, so that it must neither start a program nor open a file.
///
/// # Errors
/// A policy that is neither built in nor a preset of the planner.
pub fn recorded(policy: &str) -> Result<PolicySource, Error> {
    let is_preset = Preset::ALL.into_iter().any(|(name, _)| policy.strip_prefix("plan ") == Some(name));
    let planner = is_preset.then(|| msk::plan::source(policy)).flatten();
    planner.unwrap_or_else(|| PolicySource::built_in(policy)).map_err(|error| {
        Error::new(format!("the results name the policy `{policy}`; only built-in policies are played from results: {error}"))
            .hint("play the episode with `msk run TASK --html FILE`, with the `--policy`, `--seed` and `--episode` of the run")
    })
}

/// Writes the actions of an episode as `replay` reads them: a NumPy array of doubles, a row per control step, a column per entry of an
/// action.
///
/// # Errors
/// A file that cannot be written.
pub fn write_actions(recorder: &ActionRecorder<'_>, path: &Path) -> Result<(), Error> {
    let cannot = || format!("cannot write `{}`", path.display());
    let (actions, width) = recorder.actions();
    let mut file = Vec::new();
    let shape = [actions.len().checked_div(width).unwrap_or(0) as u64, width as u64];
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(&mut file).begin_nd().context(cannot)?;
    writer.extend(actions.iter().copied()).context(cannot)?;
    writer.finish().context(cannot)?;
    output::write(path, file)
}
