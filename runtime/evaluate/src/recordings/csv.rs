//! Tables separated by commas, semicolons or tabs.

use super::{Recording, RecordingError};

/// Reads names and rows; the separator is the one of them that the first line has most of.
pub(super) fn read(text: &str) -> Result<Recording, RecordingError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let (_, head) = lines.next().ok_or(RecordingError::Missing("names of columns"))?;
    let count = |separator: &char| head.matches(*separator).count();
    let separator = [',', ';', '\t'].into_iter().rev().max_by_key(count).unwrap_or(',');
    let split =
        |line: &str| -> Vec<String> { line.split(separator).map(|cell| cell.trim().trim_matches('"').to_owned()).collect() };
    let mut recording = Recording { names: split(head), ..Recording::default() };
    for (number, line) in lines {
        let cells = split(line);
        recording.push(number, &cells.iter().map(String::as_str).collect::<Vec<_>>())?;
    }
    Ok(recording)
}
