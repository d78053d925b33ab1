//! The parts of a report that are of single episodes, which were traced.

use super::read::Source;
use super::{Grid, Section};
use crate::error::Error;
use crate::trace;
use crate::trace::emg::{HEAD, Human, picture, rows};
use msk::compiler::numbers::for_people;
use msk::draw::chart::{self, Chart, Panel};
use msk::draw::heat;
use msk::evaluate::metrics::similarity::{Similarity, mean_correlation};
use msk::evaluate::trace::{Origin, Quantity, Trace};
use std::io::{self, Write};

/// Reward terms in a picture.
const MOST_TERMS: usize = 12;

/// A part for every trace, and one more with a recording of people, where the episode has gait cycles to be compared with it.
///
/// # Errors
/// A trace that cannot be read, or standard error.
pub fn sections(sources: &[Source], human: Option<&Human>) -> Result<Vec<Section>, Error> {
    let mut all = Vec::new();
    for source in sources {
        for path in &source.traces {
            let trace = trace::read(path)?;
            all.push(section(&source.label, &trace));
            match human.map(|human| human.compare(&trace)) {
                Some(Ok(found)) => all.push(envelopes(&source.label, &trace, &found)),
                Some(Err(error)) => {
                    let Origin { task, episode, .. } = &trace.origin;
                    writeln!(io::stderr(), "episode {episode} of {task} is not compared with electromyograms: {error}")?;
                }
                None => {}
            }
        }
    }
    Ok(all)
}

/// Activations over the gait cycle beside envelopes of human electromyograms.
fn envelopes(label: &str, trace: &Trace, found: &[Similarity]) -> Section {
    let Origin { task, episode, .. } = &trace.origin;
    let mean = mean_correlation(found).map_or_else(String::new, |mean| format!(" Mean r {}.", for_people(mean)));
    Section {
        title: format!("Envelopes of electromyograms, episode {episode} of {task}: {label}"),
        words: format!(
            "Mean activation and human envelope over the gait cycle at the best cyclic shift; chance: curves of the same spectrum.{mean}"
        ),
        table: Some(Grid { head: HEAD.map(String::from).to_vec(), rows: rows(found) }),
        figures: vec![picture(task, found)],
    }
}

fn section(label: &str, trace: &Trace) -> Section {
    let origin = &trace.origin;
    let figures = [terms(trace), activations(trace)].into_iter().flatten().collect();
    let outcome = if origin.success { "success" } else { "no success" };
    Section {
        title: format!("Episode {} of {}: {label}", origin.episode, origin.task),
        words: format!("Seed {}, ended by {}, {outcome}.", origin.seed, origin.ended_by),
        table: None,
        figures,
    }
}

/// What each term adds to the reward over time.
fn terms(trace: &Trace) -> Option<String> {
    let block = trace.layout().block(Quantity::Terms).filter(|_| trace.rows() > 1)?;
    let curve = |(place, column): (usize, &msk::evaluate::trace::Column)| {
        Some((column.name.clone(), trace.column(Quantity::Terms, place)?))
    };
    let mut curves: Vec<(String, Vec<f64>)> = block.columns.iter().enumerate().filter_map(curve).collect();
    let size = |(_, values): &(String, Vec<f64>)| values.iter().map(|value| value.abs()).sum::<f64>();
    curves.sort_by(|a, b| size(b).total_cmp(&size(a)));
    curves.truncate(MOST_TERMS);
    let at = trace.times().into_iter().skip(1).collect();
    let panel = Panel { label: "weight times value".into(), curves };
    let title = format!("Reward terms, {}", trace.origin.task);
    Some(chart::svg(&Chart { title, axis: "time [s]".into(), at, panels: vec![panel], bands: vec![] }))
}

/// Mean activation of every muscle family over time.
fn activations(trace: &Trace) -> Option<String> {
    let layout = trace.layout();
    layout.block(Quantity::Activations)?;
    let row = |family: &String| {
        let members: Vec<usize> = (0..layout.muscles.len()).filter(|&muscle| layout.muscles[muscle].family == *family).collect();
        let mean = |row: &[f64]| members.iter().map(|&muscle| row[muscle]).sum::<f64>() / members.len() as f64;
        (family.clone(), trace.block(Quantity::Activations).map(mean).collect())
    };
    let rows: Vec<(String, Vec<f64>)> = layout.families.iter().map(row).collect();
    let end = trace.times().last().copied()?;
    (!rows.is_empty()).then(|| heat::svg(&format!("Mean activation by muscle family, {}", trace.origin.task), &rows, "s", end))
}
