//! `--policy` and `--policy-timeout`, and actions written to a file.

use crate::error::{Context, Error};
use msk::runtime::policy::{ActsOn, Policy, PolicyContext, PolicyError, PolicySource};
use npyz::WriterBuilder;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::Duration;

/// Limits for policies that are programs.
#[derive(clap::Args)]
pub struct Limits {
    /// How long a policy that is a process may take for each reply, s
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, value_parser = seconds)]
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

fn seconds(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    // An hour is more than any policy thinks, and less than any clock overflows at.
    if seconds > 0.0 && seconds <= 3600.0 { Ok(seconds) } else { Err("it must be more than 0 and at most 3600".into()) }
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
        let file = BufWriter::new(File::create(path).context(cannot)?);
        let shape = [self.actions.len().checked_div(self.width).unwrap_or(0) as u64, self.width as u64];
        let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd().context(cannot)?;
        writer.extend(self.actions.iter().copied()).context(cannot)?;
        writer.finish().context(cannot)
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
