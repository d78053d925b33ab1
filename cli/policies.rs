//! `--policy` and `--policy-timeout`, and actions written to a file.

use crate::error::{Context, Error};
use crate::numbers::within;
use crate::output;
use msk::plan::Preset;
use msk::runtime::policy::{ActsOn, Policy, PolicyContext, PolicyError, PolicySource};
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

/// A policy whose actions are kept.
pub struct Recorder<'p> {
    policy: Box<dyn Policy + 'p>,
    actions: Vec<f64>,
    width: usize,
}

impl<'p> Recorder<'p> {
    /// Keeps what `policy` does.
    pub fn new(policy: Box<dyn Policy + 'p>) -> Self {
        Self { policy, actions: Vec::new(), width: 0 }
    }

    /// The actions since the reset, one after the other, and the number of entries of each.
    pub fn actions(&self) -> (&[f64], usize) {
        (&self.actions, self.width)
    }

    /// Writes the actions as `replay` reads them: a NumPy array of doubles, a row per control step, a column per entry of an action.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let cannot = || format!("cannot write `{}`", path.display());
        let mut file = Vec::new();
        let shape = [self.actions.len().checked_div(self.width).unwrap_or(0) as u64, self.width as u64];
        let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(&mut file).begin_nd().context(cannot)?;
        writer.extend(self.actions.iter().copied()).context(cannot)?;
        writer.finish().context(cannot)?;
        output::write(path, file)
    }
}

impl Policy for Recorder<'_> {
    fn name(&self) -> &str {
        self.policy.name()
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        self.actions.clear();
        self.policy.reset(context)?;
        self.width = self.policy.acts_on().size(context.task, context.body);
        Ok(())
    }

    fn acts_on(&self) -> ActsOn {
        self.policy.acts_on()
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        self.policy.act(context, action)?;
        self.actions.extend_from_slice(action);
        Ok(())
    }
}
