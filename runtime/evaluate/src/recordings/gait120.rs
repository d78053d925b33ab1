//! Gait120: level walking, stairs and slopes of 120 people with electromyograms of twelve muscles of the right leg (Boo, Seo, Kim and Koo,
//! "Comprehensive human locomotion and electromyography dataset: Gait120", Scientific Data 12, 1023, 2025; CC BY 4.0).
//!
//! A folder `Gait120_001_to_010` has a folder for each participant, `S001`, with `EMG/ProcessedData.mat`. In that file there is a structure
//! for each [movement](MOVEMENTS), in it `AvailableTrialIdx` and a structure for each trial, `Trial01`, and in that one for each gait cycle,
//! `Step01`. Of these `EMGs_interpolated` is read: a table with a column per muscle and 101 rows from 0 to 100 % of the cycle, rectified,
//! filtered, and divided by the largest value of a maximal contraction. `EMG/ConvertedData.mat` of the redistribution `Gait120-EMG`, which
//! has structures in place of tables, is read likewise.

use super::envelopes::Participant;
use super::mat::{MatFile, Value};
use super::{RecordingError, RecordingError::Missing};

/// The movements of the data set, in its words.
pub const MOVEMENTS: [&str; 7] =
    ["LevelWalking", "StairAscent", "StairDescent", "SlopeAscent", "SlopeDescent", "SitToStand", "StandToSit"];

/// Files of a participant that are read, below the participant's folder; the first that exists counts.
pub const FILES: [&str; 2] = ["EMG/ProcessedData.mat", "EMG/ConvertedData.mat"];

/// The table of a cycle.
const TABLE: &str = "EMGs_interpolated";

/// Reads the gait cycles of one movement from the file of a participant.
///
/// # Errors
/// Another format, a damaged file, or one without a cycle of that movement.
pub fn read(bytes: &[u8], movement: &str) -> Result<Participant, RecordingError> {
    let file = MatFile::read(bytes)?;
    let Some(found) = file.get(movement) else {
        return Err(RecordingError::Variable(movement.to_owned(), file.names().collect::<Vec<_>>().join(", ")));
    };
    let available = found.field("AvailableTrialIdx").and_then(Value::numbers);
    let is_available = |name: &str| {
        let number = name.strip_prefix("Trial").and_then(|digits| digits.parse::<f64>().ok());
        number.is_some_and(|number| available.is_none_or(|available| available.contains(&number)))
    };
    let mut participant = Participant::default();
    for (_, trial) in found.fields().iter().filter(|(name, _)| is_available(name)) {
        let steps = trial.fields().iter().filter(|(name, _)| name.starts_with("Step"));
        for table in steps.filter_map(|(_, step)| step.field(TABLE)) {
            participant.add(file.columns(table)?)?;
        }
    }
    if participant.cycles == 0 { Err(Missing("cycle with a table `EMGs_interpolated`")) } else { Ok(participant) }
}

#[cfg(test)]
mod tests;
