//! `.trc`: places of markers of a motion capture.

use super::{Recording, RecordingError};

/// Line of the names of markers, from 1; the line after it numbers their axes.
const NAMES: usize = 4;

/// Reads frames: `Frame#`, `Time`, and `NAME.x`, `NAME.y`, `NAME.z` for each marker, in the unit of the file. Cells are separated by tabs.
pub(super) fn read(text: &str) -> Result<Recording, RecordingError> {
    let lines: Vec<&str> = text.lines().collect();
    let names = lines.get(NAMES - 1).ok_or(RecordingError::Missing("line of marker names"))?;
    let mut cells = names.split('\t').map(str::trim);
    let [frame, time] = [cells.next(), cells.next()];
    if !frame.is_some_and(|frame| frame.starts_with("Frame")) || time.is_none() {
        return Err(RecordingError::Missing("columns `Frame#` and `Time` in its fourth line"));
    }
    // Two cells after each name are empty.
    let markers: Vec<&str> = cells.filter(|name| !name.is_empty()).collect();
    let places = markers.iter().flat_map(|marker| ["x", "y", "z"].map(|axis| format!("{marker}.{axis}")));
    let mut recording =
        Recording { names: ["frame", "time"].map(String::from).into_iter().chain(places).collect(), ..Recording::default() };
    for (place, line) in lines.iter().enumerate().skip(NAMES + 1).filter(|(_, line)| !line.trim().is_empty()) {
        let mut cells: Vec<&str> = line.trim_end_matches(['\r', '\n']).split('\t').map(str::trim).collect();
        // Some programs end lines with a tab; others leave out the cells of markers that were lost at the end of a line.
        while cells.len() > recording.names.len() && cells.last().is_some_and(|cell| cell.is_empty()) {
            cells.pop();
        }
        cells.resize(cells.len().max(recording.names.len()), "");
        recording.push(place + 1, &cells)?;
    }
    Ok(recording)
}
