//! Learning curves as event files of TensorBoard: records with checksums, each an event with one number per curve.
//!
//! A record is the length of its data (eight bytes, little endian), the masked CRC-32C of that length, the data, and the masked CRC-32C of
//! the data (the format TFRecord of TensorFlow).

use crate::curve::Line;
use crate::protobuf::Message;
use msk_storage::StorageError;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// How the names of event files begin, as TensorBoard looks for them, and how those of this program end.
const NAME: [&str; 2] = ["events.out.tfevents.", ".msk"];

/// An event file that grows with a curve.
#[derive(Debug)]
pub(crate) struct Events {
    path: PathBuf,
    file: File,
}

impl Events {
    /// Begins a file in a folder with the lines that its curve has so far, and removes the files of earlier processes: TensorBoard takes
    /// the first event as a new start from step 0, and forgets what it has read.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn begin(folder: &Path, lines: &[Line]) -> Result<Self, StorageError> {
        let now = now();
        let path = folder.join(format!("{}{:010}{}", NAME[0], now as u64, NAME[1]));
        let cannot = |source: io::Error| StorageError::System { action: "write", path: path.clone(), source };
        for entry in fs::read_dir(folder).map_err(cannot)?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with(NAME[0]) && name.ends_with(NAME[1]) {
                fs::remove_file(entry.path()).map_err(cannot)?;
            }
        }
        let file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(cannot)?;
        let mut events = Self { path: path.clone(), file };
        // Field 3 of an event is the version of the file, field 7 the log of a session, whose status 1 is a start.
        let version = Message::default().double(1, now).data(3, "brain.Event:2");
        let start = Message::default().double(1, now).message(7, Message::default().integer(1, 1));
        events.write(&[record(&version.bytes()), record(&start.bytes())].concat())?;
        let seconds = |line: &Line| match line {
            Line::Round(round) => Some(round.seconds),
            Line::Evaluation { .. } => None,
        };
        let last = lines.iter().rev().find_map(seconds).unwrap_or(0.0);
        let mut time = now;
        for line in lines {
            // Lines of earlier processes, whose clocks are not known, are as old as their own tell.
            time = seconds(line).map_or(time, |own| if own < last { now - (last - own) } else { now });
            events.write(&record(&event(line, time).bytes()))?;
        }
        Ok(events)
    }

    /// Adds a line of the curve.
    ///
    /// # Errors
    /// A full disk.
    pub fn add(&mut self, line: &Line) -> Result<(), StorageError> {
        self.write(&record(&event(line, now()).bytes()))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), StorageError> {
        let cannot = |source: io::Error| StorageError::System { action: "write", path: self.path.clone(), source };
        self.file.write_all(bytes).map_err(cannot)
    }
}

/// Seconds since 1970; 0 on a machine whose clock is set before.
fn now() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |time| time.as_secs_f64())
}

/// The event of a line: its numbers by name.
fn event(line: &Line, time: f64) -> Message {
    let (step, values): (u64, Vec<(String, f64)>) = match line {
        Line::Evaluation { step, evaluation } => {
            let values = [("return", evaluation.total), ("success", evaluation.success), ("length", evaluation.steps)];
            (*step, values.map(|(name, value)| (format!("evaluation/{name}"), value)).into())
        }
        Line::Round(round) => {
            let mut values = Vec::new();
            if let Some(ended) = &round.ended {
                let own = [("return", ended.total), ("success", ended.success), ("length", ended.length)];
                values.extend(own.map(|(name, value)| (format!("episodes/{name}"), value)));
                values.extend(ended.terms.iter().map(|(name, value)| (format!("terms/{name}"), *value)));
            }
            values.extend(round.losses.iter().map(|(name, value)| (format!("losses/{name}"), *value)));
            (round.step, values)
        }
    };
    let summary = values.into_iter().fold(Message::default(), |summary, (name, value)| {
        // A value: its tag, and a plain number.
        summary.message(1, Message::default().data(1, name).float(2, value as f32))
    });
    Message::default().double(1, time).integer(2, step).message(5, summary)
}

/// Data as a record.
fn record(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    [&length, &masked(&length).to_le_bytes()[..], data, &masked(data).to_le_bytes()].concat()
}

/// The checksum of a record: rotated and moved, since the data may hold checksums itself.
fn masked(bytes: &[u8]) -> u32 {
    crc32c(bytes).rotate_right(15).wrapping_add(0xA282_EAD8)
}

/// CRC-32C (RFC 3720, appendix B.4), bit by bit: records are short and few.
fn crc32c(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0x82F6_3B78 } else { crc >> 1 };
    !bytes.iter().fold(!0_u32, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Curve;
    use crate::evaluate::Evaluation;
    use msk_program::digest::hexadecimal;

    const GOLDEN: &str = concat!(
        "5d00000000000000615bbbb909000000000000f83f10ac022a4f0a180a116576616c756174696f6e2f72657475726e150000a0bf0a190a12657661",
        "6c756174696f6e2f73756363657373150000003f0a180a116576616c756174696f6e2f6c656e6774681500007042934b4317"
    );

    #[test]
    fn checksums_are_those_of_the_standard() {
        // RFC 3720, appendix B.4.
        assert_eq!(crc32c(&[0; 32]), 0x8A91_36AA);
        assert_eq!(crc32c(&[0xFF; 32]), 0x62A8_AB43);
        assert_eq!(crc32c(b"123456789"), 0xE306_9283);
    }

    #[test]
    fn a_record_is_what_tensorboard_reads() {
        // tests/oracle/events.py: the same event by TensorBoard's own writer.
        let line =
            Line::Evaluation { step: 300, evaluation: Evaluation { episodes: 2, success: 0.5, total: -1.25, steps: 60.0 } };
        assert_eq!(hexadecimal(&record(&event(&line, 1.5).bytes())), GOLDEN);
    }

    #[test]
    fn a_new_process_replaces_the_events_of_the_last() {
        let folder = tempfile::tempdir().unwrap();
        let curve = Curve::of(b"{\"step\":5,\"losses\":{\"value\":0.25},\"seconds\":1.0}\n").unwrap();
        fs::write(folder.path().join("events.out.tfevents.0000000001.msk"), "old").unwrap();
        fs::write(folder.path().join("events.out.tfevents.of.another"), "kept").unwrap();
        let mut events = Events::begin(folder.path(), &curve.lines).unwrap();
        let before = fs::read(&events.path).unwrap().len();
        events.add(&curve.lines[0]).unwrap();
        let bytes = fs::read(&events.path).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert_eq!(text.matches("losses/value").count(), 2);
        assert!(bytes.len() > before && fs::read_dir(folder.path()).unwrap().count() == 2);
    }
}
