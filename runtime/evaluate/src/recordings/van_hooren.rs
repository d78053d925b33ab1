//! Running on a treadmill at several speeds and gradients with electromyograms (Van Hooren and Meijer, "Dataset of running kinematics,
//! kinetics and muscle activation at different speeds, surface gradients, cadences and with forward trunk lean", Data in Brief 54, 110312,
//! 2024; <https://osf.io/7qbxc>, CC BY 4.0).
//!
//! The folder `0. C3D files` has a file for each participant and condition, `Sub_01_3ms.c3d` at 3 m/s, with the raw signals of all
//! analog channels, forces of the treadmill among them (`Force.Fz1`, `Force.Fz2`). Which channel is of which muscle, counted from 1, stands
//! in the sheet `Corresponding analogue channel` of `Excel file with EMG channels.xlsx`: a row for each `Subject` and `Condition`, such as
//! `3.00 m/s`, with a column per muscle.
//!
//! Envelopes are made as follows; corners after De Luca et al. (J. Biomech. 43, 2010) and Winter ("Biomechanics and Motor Control of Human
//! Movement", 4th ed., chapter 10), all filters of the fourth order and without delay: high-pass 20 Hz, low-pass 450 Hz, absolute value,
//! low-pass 6 Hz. A foot strikes where the sum of both vertical forces, low-pass 50 Hz, rises above 50 N and stays there for 50 ms. Steps
//! that differ by more than a quarter from the median one are a gap; of the longest stretch without a gap, cycles are from every second
//! strike to the next but one. Which foot strikes is not told apart: the phase of the curves is that of the foot that was first, which the
//! largest correlation over cyclic shifts does not depend on. The mean curve of each muscle is divided by its largest value.

use super::c3d::{Analog, analog};
use super::envelopes::Participant;
use super::filter::{Pass, filter};
use super::workbook::sheet;
use super::{RecordingError, RecordingError::Damaged, RecordingError::Missing};
use crate::statistics::quantile;

/// The workbook with the channels, beside the folder of recordings.
pub const WORKBOOK: &str = "Excel file with EMG channels.xlsx";
/// The sheet of the workbook.
const SHEET: &str = "Corresponding analogue channel";
/// Columns of the sheet that are no muscles.
const KEYS: [&str; 2] = ["Subject", "Condition"];

/// Corners of the filters, Hz.
const BAND: [f64; 2] = [20.0, 450.0];
const ENVELOPE: f64 = 6.0;
const FORCE: f64 = 50.0;
/// A foot stands above this force, N, for at least that long, s.
const STANDS: f64 = 50.0;
const SHORTEST: f64 = 0.05;
/// By how much of the median duration a step may differ.
const TOLERANCE: f64 = 0.25;

/// Analog channels of muscles, with their numbers from 1.
pub type Channels = Vec<(String, usize)>;

/// The participant and condition of a file name such as `Sub_01_3ms.c3d`.
pub fn named(file: &str) -> Option<(u32, &str)> {
    let (number, condition) = file.strip_prefix("Sub_")?.strip_suffix(".c3d")?.split_once('_')?;
    Some((number.parse().ok()?, condition))
}

/// The speed of a condition as files name it, `3ms` or `278ms`, m/s.
fn speed(condition: &str) -> Option<f64> {
    let digits = condition.strip_suffix("ms").filter(|digits| digits.bytes().all(|digit| digit.is_ascii_digit()))?;
    let number: f64 = digits.parse().ok()?;
    Some(if digits.len() == 1 { number } else { number / 100.0 })
}

/// Which channels are of which muscles for a participant and condition, from the workbook.
///
/// # Errors
/// Another format, a sheet or column that is missing, or no row for them.
pub fn channels(workbook: &[u8], participant: u32, condition: &str) -> Result<Channels, RecordingError> {
    let rows = sheet(workbook, SHEET)?;
    let (head, rows) = rows.split_first().ok_or(Missing("row of names in its sheet"))?;
    let place = |name: &str| {
        head.iter().position(|cell| cell == name).ok_or_else(|| RecordingError::Column(name.to_owned(), head.join(", ")))
    };
    let [subject, key] = KEYS.map(place);
    let (subject, key) = (subject?, key?);
    let cell = |row: &'_ [String], place: usize| row.get(place).map_or("", |cell| cell.trim()).to_owned();
    let of_row = |row: &&Vec<String>| -> Channels {
        let muscles = head.iter().enumerate().filter(|(place, name)| *place != subject && *place != key && !name.is_empty());
        let channel = |(place, name): (usize, &String)| {
            let number = cell(row, place).parse::<f64>().ok().filter(|number| *number >= 1.0 && number.fract() == 0.0)?;
            Some((name.trim().to_owned(), number as usize))
        };
        muscles.filter_map(channel).collect()
    };
    let own: Vec<&Vec<String>> = rows
        .iter()
        .filter(|row| cell(row, subject).parse::<f64>().is_ok_and(|number| number == f64::from(participant)))
        .collect();
    let is_it = |row: &&&Vec<String>| {
        let words = cell(row, key);
        let number = words.strip_suffix("m/s").and_then(|number| number.trim().parse::<f64>().ok());
        words == condition || number.zip(speed(condition)).is_some_and(|(known, wanted)| (known - wanted).abs() < 1e-3)
    };
    let found = own.iter().find(is_it).map(of_row).or_else(|| {
        // Without a row of its own, a condition has the channels of the others, where these agree.
        let all: Vec<Channels> = own.iter().map(of_row).collect();
        all.first().filter(|first| all.iter().all(|other| other == *first)).cloned()
    });
    found.filter(|channels| !channels.is_empty()).ok_or(Missing("row with channels for this participant and condition"))
}

/// The cycles of a recording.
///
/// # Errors
/// Another format, a damaged file, channels or forces that it does not have, or fewer than two cycles.
pub fn read(c3d: &[u8], channels: &Channels) -> Result<Participant, RecordingError> {
    let is_force = |name: &str| name.to_ascii_lowercase().rsplit('.').next().is_some_and(|name| name == "fz1" || name == "fz2");
    let muscle = |place: usize| channels.iter().find(|(_, number)| *number == place + 1).map(|(name, _)| name.as_str());
    let Analog { rate, all, channels: found } = analog(c3d, |place, name| is_force(name) || muscle(place).is_some())?;
    if let Some((name, number)) = channels.iter().find(|(_, number)| *number > all) {
        return Err(RecordingError::Channel { name: name.clone(), number: *number, all });
    }
    let forces: Vec<&Vec<f64>> = found.iter().filter(|(_, name, _)| is_force(name)).map(|(.., values)| values).collect();
    let [first, second] = *forces.as_slice() else { return Err(Missing("channels `Force.Fz1` and `Force.Fz2`")) };
    if rate <= 2.0 * BAND[1] {
        return Err(Damaged("its rate: electromyograms need more than 900 samples per second"));
    }
    let vertical: Vec<f64> = upward(first).zip(upward(second)).map(|(one, other)| one + other).collect();
    let cycles = cycles(&strikes(&filter(&vertical, Pass::Low, FORCE, rate), rate));
    let envelopes: Vec<(&str, Vec<f64>)> =
        found.iter().filter_map(|(place, _, values)| Some((muscle(*place)?, envelope(values, rate)))).collect();
    let mut participant = Participant::default();
    for [from, to] in cycles {
        participant.add(envelopes.iter().map(|(name, values)| (*name, &values[from..=to])).collect())?;
    }
    if participant.cycles < 2 {
        Err(Missing("two gait cycles: the forces have too few strikes"))
    } else {
        Ok(participant.scaled())
    }
}

/// A vertical force that is positive upward: some plates count the force on the plate, which points downward.
fn upward(force: &[f64]) -> impl Iterator<Item = f64> {
    let sum: f64 = force.iter().sum();
    let sign = if sum < 0.0 { -1.0 } else { 1.0 };
    force.iter().map(move |value| sign * value)
}

/// Rectified and smooth.
fn envelope(raw: &[f64], rate: f64) -> Vec<f64> {
    let band = filter(&filter(raw, Pass::High, BAND[0], rate), Pass::Low, BAND[1], rate);
    let rectified: Vec<f64> = band.iter().map(|value| value.abs()).collect();
    // The filter swings below zero beside bursts.
    filter(&rectified, Pass::Low, ENVELOPE, rate).into_iter().map(|value| if value > 0.0 { value } else { 0.0 }).collect()
}

/// Samples at which a foot strikes.
fn strikes(force: &[f64], rate: f64) -> Vec<usize> {
    let longest = (SHORTEST * rate) as usize;
    let stands = |place: usize| force[place] > STANDS;
    let begins = |place: &usize| stands(*place) && !stands(*place - 1) && (*place..force.len().min(place + longest)).all(stands);
    (1..force.len()).filter(begins).collect()
}

/// First and last sample of each cycle: from every second strike to the next but one, in the longest stretch of regular steps.
fn cycles(strikes: &[usize]) -> Vec<[usize; 2]> {
    let mut durations: Vec<f64> = strikes.windows(2).map(|pair| (pair[1] - pair[0]) as f64).collect();
    durations.sort_by(f64::total_cmp);
    if durations.is_empty() {
        return Vec::new();
    }
    let median = quantile(&durations, 0.5);
    let is_regular = |from: &usize, to: &usize| ((to - from) as f64 - median).abs() <= TOLERANCE * median;
    let stretches = strikes.chunk_by(is_regular);
    let longest = stretches.fold(&[][..], |longest, stretch| if stretch.len() > longest.len() { stretch } else { longest });
    let of_one_foot: Vec<usize> = longest.iter().copied().step_by(2).collect();
    of_one_foot.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

#[cfg(test)]
mod tests;
