//! The parts of a report that are of single episodes, which were traced.

use super::read::Source;
use super::{Grid, Section};
use crate::error::Error;
use crate::terminal;
use crate::trace::emg::{HEAD, Human, picture, rows};
use msk::compiler::numbers::for_people;
use msk::draw::heat;
use msk::draw::stack::{self, Stack};
use msk::evaluate::metrics::similarity::{Similarity, mean_correlation};
use msk::evaluate::trace::{Origin, Quantity, Trace};
use std::io::Write;

/// Reward terms in a picture; the others are one.
const MOST_TERMS: usize = 11;
/// Points in time of a picture: of more, means are drawn.
const MOST_POINTS: usize = 250;

/// An episode that was compared with a recording of people.
pub struct Compared {
    /// Name of the policy.
    pub policy: String,
    /// Name of the task.
    pub task: String,
    /// Muscle by muscle.
    pub found: Vec<Similarity>,
}

/// A recording of people, and the task whose episodes are compared with it: all that have no other one if it names none.
pub type Recorded = (Option<String>, Human);

/// A part for every trace, and one more with a recording of people, where the episode has gait cycles to be compared with it.
///
/// # Errors
/// A trace that cannot be read, or standard error.
pub fn sections(sources: &[Source], recorded: &[Recorded]) -> Result<(Vec<Section>, Vec<Compared>), Error> {
    let (mut all, mut compared) = (Vec::new(), Vec::new());
    for source in sources {
        for trace in &source.traces {
            all.push(section(&source.label, trace));
            let Origin { task, episode, policy, .. } = &trace.origin;
            let of = |wanted: Option<&str>| recorded.iter().find(|(task, _)| task.as_deref() == wanted);
            let Some((_, human)) = of(Some(task)).or_else(|| of(None)) else { continue };
            match human.compare(trace) {
                Ok(found) => {
                    all.push(envelopes(&source.label, trace, &found));
                    compared.push(Compared { policy: policy.clone(), task: task.clone(), found });
                }
                Err(error) => {
                    writeln!(terminal::notes(), "episode {episode} of {task} is not compared with electromyograms: {error}")?
                }
            }
        }
    }
    Ok((all, compared))
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

/// What each term adds to the reward over time, one upon the other.
fn terms(trace: &Trace) -> Option<String> {
    let block = trace.layout().block(Quantity::Terms).filter(|_| trace.rows() > 1)?;
    let part = |(place, column): (usize, &msk::evaluate::trace::Column)| {
        Some((column.name.clone(), fewer(&trace.column(Quantity::Terms, place)?)))
    };
    let mut parts: Vec<(String, Vec<f64>)> = block.columns.iter().enumerate().filter_map(part).collect();
    let size = |(_, values): &(String, Vec<f64>)| values.iter().map(|value| value.abs()).sum::<f64>();
    parts.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let others = parts.split_off(parts.len().min(MOST_TERMS));
    if let Some((_, first)) = others.first() {
        let sum = |place: usize| others.iter().map(|(_, values)| values[place]).sum::<f64>();
        parts.push((format!("{} others", others.len()), (0..first.len()).map(sum).collect()));
    }
    let at = fewer(&trace.times()[1..]);
    let title = format!("Reward terms, {}", trace.origin.task);
    Some(stack::svg(&Stack { title, axis: "time [s]".into(), label: "weight times value, and their sum".into(), at, parts }))
}

/// Means over stretches of a curve that has too many points for a picture.
fn fewer(values: &[f64]) -> Vec<f64> {
    let count = values.len().min(MOST_POINTS);
    let mean = |place: usize| {
        let part = &values[place * values.len() / count..(place + 1) * values.len() / count];
        part.iter().sum::<f64>() / part.len() as f64
    };
    (0..count).map(mean).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_curves_are_averaged_and_short_ones_kept() {
        assert_eq!(fewer(&[1.0, 2.0, 4.0]), [1.0, 2.0, 4.0]);
        let long: Vec<f64> = (0..1000).map(f64::from).collect();
        let found = fewer(&long);
        assert_eq!((found.len(), found[0], found[249]), (250, 1.5, 997.5));
        assert!(fewer(&[]).is_empty());
    }
}
