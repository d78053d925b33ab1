//! OpenSim's `.sto` and `.mot`.

use super::{Recording, RecordingError};

/// Reads a storage file: `key=value` lines and others up to `endheader`, then names, then rows, separated by blanks.
pub(super) fn read(text: &str) -> Result<Recording, RecordingError> {
    let mut lines = (1..).zip(text.lines());
    let mut recording = Recording::default();
    loop {
        let (_, line) = lines.next().ok_or(RecordingError::Missing("line `endheader`"))?;
        let line = line.trim();
        if line.eq_ignore_ascii_case("endheader") {
            break;
        }
        if let Some(("inDegrees", value)) = line.split_once('=').map(|(key, value)| (key.trim(), value.trim())) {
            recording.degrees = value.eq_ignore_ascii_case("yes");
        }
    }
    let mut rows =
        lines.map(|(line, text)| (line, text.split_whitespace().collect::<Vec<_>>())).filter(|(_, cells)| !cells.is_empty());
    let (_, names) = rows.next().ok_or(RecordingError::Missing("names of columns"))?;
    recording.names = names.into_iter().map(str::to_owned).collect();
    for (line, cells) in rows {
        recording.push(line, &cells)?;
    }
    Ok(recording)
}
