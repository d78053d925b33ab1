//! `--html worst,median,best`: episodes of an evaluation as pages; `--strip`: as film strips.

use super::explain;
use crate::error::Error;
use crate::html::{self, Film};
use crate::terminal;
use msk::evaluate::{EpisodeRecord, Journal, Plan, RunSettings, Trial, play_watched};
use msk::runtime::episode::{Ending, Environment, EpisodeKey};
use msk::view::render::{Colouring, Options, Renderer, Strip, Theme, View, film_strip};
use msk::view::{Caption, page};
use std::io::Write;
use std::sync::atomic::AtomicBool;

/// Moments of a strip.
const FRAMES: usize = 8;
/// Height of a strip, pixels.
const HEIGHT: u32 = 320;

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

    /// The episode, of returns with the indices of their episodes, sorted.
    fn of(self, sorted: &[(f64, u64)]) -> Option<u64> {
        let place = match self {
            Self::Worst => 0,
            Self::Median => sorted.len().saturating_sub(1) / 2,
            Self::Best => sorted.len().saturating_sub(1),
        };
        sorted.get(place).map(|(_, episode)| *episode)
    }
}

/// Plays the episodes that are asked for once more, and writes a page for each task, and a film strip for each episode.
///
/// # Errors
/// A policy that cannot act any more, or a page that cannot be written.
pub fn write([html, strip]: [&[Which]; 2], plan: &Plan, journal: &Journal, stop: &AtomicBool) -> Result<(), Error> {
    let mut wanted = [html, strip].concat();
    wanted.sort();
    wanted.dedup();
    if wanted.is_empty() {
        return Ok(());
    }
    let chosen = chosen(&wanted, plan, journal)?;
    for (trial, chosen) in plan.trials.iter().zip(&chosen) {
        let mut recordings = Vec::new();
        for (which, record) in chosen {
            let mut episode = trial.episode()?;
            let mut film = Film::of(&episode, trial, html.contains(which))?;
            let mut frames = Frames::of(&episode, trial, strip.contains(which))?;
            let mut policy = plan.policy.open(stop)?;
            let key = EpisodeKey { seed: record.seed, episode: record.episode };
            let played = play_watched(trial, &mut episode, key, policy.as_mut(), stop, &mut |episode| {
                film.look(episode);
                frames.look(episode);
            })?;
            let Some(played) = played else { return Ok(()) };
            if !played.same_as(record) {
                let (task, number) = (&record.task, record.episode);
                writeln!(terminal::notes(), "episode {number} of {task} went another way when it was played again for its page")?;
            }
            if let Some(picture) = frames.picture()? {
                journal.write(&format!("{}-{}.png", trial.task.name, which.name()), picture).map_err(explain)?;
            }
            // An episode that ended at its reset cannot be shown.
            recordings.extend(film.so_far(Caption { label: which.name().into(), ..html::caption(&played) }).ok().flatten());
        }
        if !recordings.is_empty() {
            let title = format!("{}, {}", trial.task.name, plan.policy.name());
            journal.write(&format!("{}.html", trial.task.name), &page(&title, &recordings)?).map_err(explain)?;
        }
    }
    Ok(())
}

/// The moments of an episode for its strip, if one is wanted.
struct Frames {
    renderer: Option<Renderer>,
    strip: Strip,
}

impl Frames {
    fn of(episode: &Environment, trial: &Trial, wanted: bool) -> Result<Self, Error> {
        let strengths = trial.body.condition.strengths(&trial.body.body)?;
        Ok(Self { renderer: wanted.then(|| Renderer::new(episode, &strengths, Colouring::Activation)), strip: Strip::default() })
    }

    /// Keeps the present step. A fault leaves nothing to look at.
    fn look(&mut self, episode: &Environment) {
        let renderer = self.renderer.as_mut().filter(|_| !matches!(episode.ending(), Some(Ending::Fault(_))));
        renderer.into_iter().for_each(|renderer| self.strip.look(renderer.scene(episode)));
    }

    /// The strip as PNG; none of an episode that ended at its reset.
    fn picture(&self) -> Result<Option<Vec<u8>>, Error> {
        let scenes = self.strip.scenes(FRAMES);
        if scenes.is_empty() {
            return Ok(None);
        }
        let options = Options { width: HEIGHT, height: HEIGHT, view: View::ThreeQuarter, theme: Theme::Light, labels: true };
        Ok(Some(film_strip(&scenes, &options)?.png()?))
    }
}

/// The records of the episodes that are asked for, of every task.
fn chosen(wanted: &[Which], plan: &Plan, journal: &Journal) -> Result<Vec<Vec<(Which, EpisodeRecord)>>, Error> {
    let settings = RunSettings::of(plan);
    let mut returns: Vec<Vec<(f64, u64)>> = vec![Vec::new(); plan.trials.len()];
    Journal::each(journal.folder(), |record| {
        let own = settings.place(&record).and_then(|place| returns.get_mut(place));
        own.into_iter().for_each(|returns| returns.push((record.total, record.episode)));
    })
    .map_err(explain)?;
    let episodes = returns.into_iter().map(|mut returns| {
        returns.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        wanted.iter().map(|which| which.of(&returns)).collect::<Vec<_>>()
    });
    let episodes: Vec<Vec<Option<u64>>> = episodes.collect();
    let mut chosen = vec![Vec::new(); plan.trials.len()];
    Journal::each(journal.folder(), |record| {
        let Some(place) = settings.place(&record) else { return };
        for (which, episode) in wanted.iter().zip(&episodes[place]) {
            if *episode == Some(record.episode) {
                chosen[place].push((*which, record.clone()));
            }
        }
    })
    .map_err(explain)?;
    chosen.iter_mut().for_each(|chosen| chosen.sort_by_key(|(which, _)| *which));
    Ok(chosen)
}
