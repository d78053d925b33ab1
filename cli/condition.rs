//! `--weakness` and `--fatigue`: conditions of the muscles, for subcommands that run episodes.

use crate::error::Error;
use msk::evaluate::Trial;
use msk::runtime::condition::{Fatigue, MuscleCondition, Weakness};

/// Conditions of a body's muscles.
#[derive(Debug, clap::Args)]
pub struct Condition {
    /// Scale the active force of all muscles, or of a muscle or group: 0.5 or calves=0.5; may be repeated
    #[arg(long, value_name = "[MUSCLES=]FACTOR")]
    weakness: Vec<String>,
    /// Let muscles tire and recover (three compartments: active, resting, fatigued)
    #[arg(long)]
    fatigue: bool,
}

impl Condition {
    /// Puts the bodies of all trials into this condition.
    ///
    /// # Errors
    /// A factor that is no number or out of range, or muscles that a body does not have.
    pub fn apply(&self, trials: &mut [Trial]) -> Result<(), Error> {
        let weakness = self.weakness.iter().map(|text| parse(text)).collect::<Result<_, _>>()?;
        let condition = MuscleCondition { weakness, fatigue: self.fatigue.then(Fatigue::default) };
        for trial in trials {
            trial.body = trial.body.under(&condition)?;
        }
        Ok(())
    }
}

fn parse(text: &str) -> Result<Weakness, Error> {
    let (muscles, factor) = match text.split_once('=') {
        Some((muscles, factor)) => (Some(muscles.trim().to_owned()), factor),
        None => (None, text),
    };
    let factor = factor.trim().parse().map_err(|_| {
        Error::usage(format!("`{text}` is not a weakness"))
            .hint("give a factor, as in 0.5, or muscles and a factor, as in calves=0.5")
    })?;
    Ok(Weakness { muscles, factor })
}
