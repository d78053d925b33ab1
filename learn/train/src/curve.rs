//! The learning curve of a training: a line of JSON for each round and for each evaluation, as sessions write it and as everything that
//! shows trainings reads it.

use crate::evaluate::Evaluation;
use crate::training::Round;
use msk_program::numbers::exact;
use msk_program::task::CompiledTask;
use msk_storage::{Folder, Log, StorageError};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The file, within the folder of a training or of an agent.
pub const FILE: &str = "curve.jsonl";
/// Largest file, bytes.
const LARGEST: u64 = 1 << 30;
/// Largest number: sums and differences of two stay finite.
const LARGEST_NUMBER: f64 = 1e300;

/// A line of a curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Line {
    /// How the agent did when it was evaluated.
    Evaluation {
        /// Control steps so far.
        step: u64,
        /// Means over its episodes.
        evaluation: Evaluation,
    },
    /// What a round of learning came to.
    Round(RoundLine),
}

/// What a round of learning came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoundLine {
    /// Control steps so far.
    pub step: u64,
    /// Means over the episodes that ended in it; none where none has.
    #[serde(flatten)]
    pub ended: Option<Ended>,
    /// Parts of the loss, by name.
    pub losses: BTreeMap<String, f64>,
    /// Time since the process began to train, s.
    pub seconds: f64,
}

/// Means over episodes that ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ended {
    /// How many.
    pub episodes: usize,
    /// Mean return.
    #[serde(rename = "return")]
    pub total: f64,
    /// Share that ended in success.
    pub success: f64,
    /// Mean length, control steps.
    pub length: f64,
    /// What each term added to the mean return.
    pub terms: BTreeMap<String, f64>,
}

/// A learning curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Its lines, in the order in which they were written.
    pub lines: Vec<Line>,
}

/// Why a file holds no curve.
#[derive(Debug, thiserror::Error)]
pub enum CurveError {
    /// A folder or file that cannot be read.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// A damaged line.
    #[error("line {line} of the learning curve `{FILE}` {reason}: expected a round or an evaluation, as `msk train` writes them")]
    Line {
        /// Its number, from 1.
        line: usize,
        /// What is wrong, in words that continue the file's name.
        reason: String,
    },
}

impl Curve {
    /// The curve in a folder; `None` if it holds none.
    ///
    /// # Errors
    /// A folder or file that cannot be read, or a damaged line.
    pub fn in_folder(path: &Path) -> Result<Option<Self>, CurveError> {
        Folder::open(path)?.read(Path::new(FILE), LARGEST)?.map(|bytes| Self::of(&bytes)).transpose()
    }

    /// The curve that bytes of a file hold. A last line without an end, which is just being written, is left out.
    ///
    /// # Errors
    /// A line that is none of a curve, or holds a number that no training comes to.
    pub fn of(bytes: &[u8]) -> Result<Self, CurveError> {
        let whole = Log::whole_lines(bytes);
        let lines = whole.strip_suffix(b"\n").unwrap_or(whole).split(|byte| *byte == b'\n');
        let read = |(index, text): (usize, &[u8])| {
            let damaged = |reason: String| CurveError::Line { line: index + 1, reason };
            let line: Line = serde_json::from_slice(text).map_err(|_| damaged("is damaged".into()))?;
            // What is optional and cannot be read is left out without a word.
            let names: BTreeMap<String, IgnoredAny> = serde_json::from_slice(text).unwrap_or_default();
            if matches!(&line, Line::Round(RoundLine { ended: None, .. })) && names.contains_key("episodes") {
                return Err(damaged("is damaged".into()));
            }
            if let Line::Evaluation { evaluation, .. } = &line
                && let Some(wrong) = evaluation.wrong()
            {
                return Err(damaged(format!("holds an evaluation {wrong}")));
            }
            let large = line.numbers().find(|number| number.abs() > LARGEST_NUMBER);
            match large {
                Some(number) => Err(damaged(format!("holds {}", exact(number)))),
                None => Ok(line),
            }
        };
        let lines = if whole.is_empty() { Vec::new() } else { lines.enumerate().map(read).collect::<Result<_, _>>()? };
        Ok(Self { lines })
    }

    /// Steps, and how the agent did there.
    pub fn evaluations(&self) -> impl DoubleEndedIterator<Item = (u64, &Evaluation)> {
        self.lines.iter().filter_map(|line| match line {
            Line::Evaluation { step, evaluation } => Some((*step, evaluation)),
            Line::Round(_) => None,
        })
    }

    /// Rounds of learning.
    pub fn rounds(&self) -> impl DoubleEndedIterator<Item = &RoundLine> {
        self.lines.iter().filter_map(|line| match line {
            Line::Round(round) => Some(round),
            Line::Evaluation { .. } => None,
        })
    }

    /// Steps, and means over the episodes that ended in the rounds up to there.
    pub fn ended(&self) -> impl DoubleEndedIterator<Item = (u64, &Ended)> {
        self.rounds().filter_map(|round| Some((round.step, round.ended.as_ref()?)))
    }
}

impl Line {
    /// What can be drawn of it.
    fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let (evaluation, round) = match self {
            Self::Evaluation { evaluation, .. } => (Some([evaluation.total, evaluation.success, evaluation.steps]), None),
            Self::Round(round) => (None, Some(round)),
        };
        let ended = round.and_then(|round| round.ended.as_ref());
        let means = ended.map(|ended| [ended.total, ended.success, ended.length]);
        let terms = ended.into_iter().flat_map(|ended| ended.terms.values().copied());
        let losses = round.into_iter().flat_map(|round| round.losses.values().copied());
        evaluation.into_iter().chain(means).flatten().chain(terms).chain(losses)
    }

    /// That of a round.
    pub(crate) fn of(round: &Round, task: &CompiledTask, seconds: f64) -> Self {
        let losses = round.losses.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        Self::Round(RoundLine { step: round.step, ended: Ended::of(round, task), losses, seconds })
    }

    /// As a line of JSON, without its end.
    pub fn bytes(&self) -> Vec<u8> {
        // Plain data of names and numbers always has a JSON form.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

impl Ended {
    fn of(round: &Round, task: &CompiledTask) -> Option<Self> {
        let (ends, count) = (&round.ends, round.ends.len() as f64);
        let mean = |value: &dyn Fn(usize) -> f64| (0..ends.len()).map(value).sum::<f64>() / count;
        let terms = task.terms.iter().enumerate().map(|(term, known)| {
            let total = mean(&|index| ends[index].totals.get(term).copied().unwrap_or_default());
            (known.name.clone(), total)
        });
        (!ends.is_empty()).then(|| Self {
            episodes: ends.len(),
            total: mean(&|index| ends[index].total),
            success: mean(&|index| f64::from(u8::from(ends[index].success))),
            length: mean(&|index| f64::from(ends[index].steps)),
            terms: terms.collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{"step":100,"losses":{"policy":-0.5},"seconds":1.5}
{"step":200,"episodes":2,"return":3.0,"success":0.5,"length":7.0,"terms":{"near":3.0},"losses":{},"seconds":2.0}
{"step":200,"evaluation":{"episodes":10,"success":1.0,"return":4.0,"steps":60.0}}
"#;

    #[test]
    fn what_is_written_is_read() {
        let curve = Curve::of(TEXT.as_bytes()).unwrap();
        let written: Vec<u8> = curve.lines.iter().flat_map(|line| [line.bytes(), vec![b'\n']].concat()).collect();
        assert_eq!(String::from_utf8_lossy(&written), TEXT);
        assert_eq!(curve.evaluations().map(|(step, found)| (step, found.total)).collect::<Vec<_>>(), [(200, 4.0)]);
        assert_eq!(curve.rounds().map(|round| round.step).collect::<Vec<_>>(), [100, 200]);
        assert_eq!(curve.ended().map(|(step, ended)| (step, ended.terms["near"])).collect::<Vec<_>>(), [(200, 3.0)]);
    }

    #[test]
    fn a_line_that_is_being_written_is_left_out() {
        let cut = &TEXT.as_bytes()[..TEXT.len() - 1];
        assert_eq!(Curve::of(cut).unwrap().lines.len(), 2);
        assert_eq!(Curve::of(b"").unwrap(), Curve::default());
        assert_eq!(Curve::of(b"{\"step").unwrap(), Curve::default());
    }

    #[test]
    fn damaged_lines_are_named() {
        let refuse = |text: String| Curve::of(text.as_bytes()).unwrap_err().to_string();
        let message = refuse(TEXT.replace("\"success\":0.5", "\"success\":\"half\""));
        assert!(message.starts_with("line 2 of the learning curve `curve.jsonl` is damaged: expected"), "{message}");
        let message = refuse(TEXT.replace("\"return\":4.0", "\"return\":-1e308"));
        assert!(message.starts_with("line 3 of the learning curve `curve.jsonl` holds -1e308: expected"), "{message}");
        assert!(refuse("\n".into()).starts_with("line 1"));
    }
}
