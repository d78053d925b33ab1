//! Mean envelopes of electromyograms over the gait cycle, of several people.

use super::{Recording, RecordingError, RecordingError::Damaged};
use crate::metrics::curve::{POINTS, resample};

/// The cycles of one person, summed up.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Participant {
    /// Cycles that were added.
    pub cycles: usize,
    /// Sum over the cycles for each channel, at 101 points.
    sums: Vec<(String, Vec<f64>)>,
}

impl Participant {
    /// Adds a cycle, which has values at equal distances for every channel.
    ///
    /// # Errors
    /// Other channels than the cycles before, or a channel with less than two values or one that is not finite.
    pub fn add(&mut self, channels: Vec<(&str, &[f64])>) -> Result<(), RecordingError> {
        if channels.iter().any(|(_, values)| values.len() < 2 || values.iter().any(|value| !value.is_finite())) {
            return Err(Damaged("a cycle: a channel has less than two values, or one that is not finite"));
        }
        if self.cycles == 0 {
            self.sums = channels.iter().map(|(name, _)| ((*name).to_owned(), vec![0.0; POINTS])).collect();
        }
        let same =
            self.sums.len() == channels.len() && self.sums.iter().zip(&channels).all(|((known, _), (name, _))| known == name);
        if !same {
            return Err(Damaged("a cycle: it has other channels than the cycle before"));
        }
        for ((_, sum), (_, values)) in self.sums.iter_mut().zip(&channels) {
            let values = if values.len() == POINTS { values.to_vec() } else { resample(values, POINTS) };
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        self.cycles += 1;
        Ok(())
    }

    /// Mean over the cycles of each channel.
    fn means(&self) -> impl Iterator<Item = (&str, Vec<f64>)> {
        let count = self.cycles as f64;
        self.sums.iter().map(move |(name, sum)| (name.as_str(), sum.iter().map(|value| value / count).collect()))
    }

    /// The same with the mean of each channel divided by its largest value: for signals that no maximal contraction has scaled.
    pub fn scaled(mut self) -> Self {
        let count = self.cycles as f64;
        for (_, sum) in &mut self.sums {
            let largest = sum.iter().fold(0.0, |largest, value| if *value > largest { *value } else { largest });
            if largest > 0.0 {
                sum.iter_mut().for_each(|value| *value *= count / largest);
            }
        }
        self
    }
}

/// The mean over people, each of whom counts the same however many cycles there are: a table with a row per percent of the cycle, `percent`
/// and a column per channel. A channel is the mean of those who have it.
pub fn average(participants: &[Participant]) -> Recording {
    let mut columns: Vec<(String, Vec<f64>, f64)> = Vec::new();
    for (name, mean) in participants.iter().filter(|person| person.cycles > 0).flat_map(Participant::means) {
        match columns.iter_mut().find(|(known, ..)| known == name) {
            Some((_, sum, count)) => {
                sum.iter_mut().zip(mean).for_each(|(sum, value)| *sum += value);
                *count += 1.0;
            }
            None => columns.push((name.to_owned(), mean, 1.0)),
        }
    }
    let percent = (0..POINTS).map(|point| point as f64).collect();
    let (names, means): (Vec<String>, Vec<Vec<f64>>) =
        columns.into_iter().map(|(name, sum, count)| (name, sum.into_iter().map(|value| value / count).collect())).unzip();
    Recording {
        degrees: false,
        names: std::iter::once("percent".to_owned()).chain(names).collect(),
        columns: std::iter::once(percent).chain(means).collect(),
    }
}
