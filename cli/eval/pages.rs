//! `--html worst,median,best`: episodes of an evaluation as pages.

use super::explain;
use crate::error::Error;
use crate::html::{self, Film};
use msk::evaluate::{EpisodeRecord, Journal, Plan, RunSettings, play_watched};
use msk::runtime::episode::EpisodeKey;
use msk::view::{Caption, page};
use std::io::{self, Write};
use std::sync::atomic::AtomicBool;

/// An episode of a task, by its return.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Which {
    /// The smallest return
    Worst,
    /// The return in the middle; of two, the smaller
    Median,
    /// The largest return
    Best,
}

impl Which {
    fn name(self) -> &'static str {
        match self {
            Self::Worst => "worst",
            Self::Median => "median",
            Self::Best => "best",
        }
    }

    /// Of records sorted by their returns.
    fn of<'a>(self, sorted: &[&'a EpisodeRecord]) -> Option<&'a EpisodeRecord> {
        let place = match self {
            Self::Worst => 0,
            Self::Median => sorted.len().saturating_sub(1) / 2,
            Self::Best => sorted.len().saturating_sub(1),
        };
        sorted.get(place).copied()
    }
}

/// Plays the episodes that are asked for once more, and writes a page for each task.
///
/// # Errors
/// A policy that cannot act any more, or a page that cannot be written.
pub fn write(
    wanted: &[Which],
    plan: &Plan,
    records: &[EpisodeRecord],
    journal: &Journal,
    stop: &AtomicBool,
) -> Result<(), Error> {
    let mut wanted = wanted.to_vec();
    wanted.sort();
    wanted.dedup();
    if wanted.is_empty() {
        return Ok(());
    }
    let settings = RunSettings::of(plan);
    for (place, trial) in plan.trials.iter().enumerate() {
        let mut sorted: Vec<&EpisodeRecord> = records.iter().filter(|record| settings.place(record) == Some(place)).collect();
        sorted.sort_by(|a, b| a.total.total_cmp(&b.total).then(a.episode.cmp(&b.episode)));
        let mut recordings = Vec::new();
        for which in &wanted {
            let Some(record) = which.of(&sorted) else { continue };
            let mut episode = trial.episode()?;
            let mut film = Film::of(&episode, trial, true)?;
            let mut policy = plan.policy.open(stop)?;
            let key = EpisodeKey { seed: record.seed, episode: record.episode };
            let played = play_watched(trial, &mut episode, key, policy.as_mut(), stop, &mut |episode| film.look(episode))?;
            let Some(played) = played else { return Ok(()) };
            if !played.same_as(record) {
                let (task, number) = (&record.task, record.episode);
                writeln!(io::stderr(), "episode {number} of {task} went another way when it was played again for its page")?;
            }
            // An episode that ended at its reset cannot be shown.
            recordings.extend(film.finish(Caption { label: which.name().into(), ..html::caption(&played) }).ok().flatten());
        }
        if !recordings.is_empty() {
            let title = format!("{}, {}", trial.task.name, plan.policy.name());
            journal.write(&format!("{}.html", trial.task.name), &page(&title, &recordings)?).map_err(explain)?;
        }
    }
    Ok(())
}
