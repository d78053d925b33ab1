//! The learning curve of a training: a line of JSON for each round and for each evaluation, as sessions write it and as everything that
//! shows trainings reads it.

use crate::evaluate::Evaluation;
use crate::training::Round;
use msk_program::task::CompiledTask;
use msk_storage::{Folder, Log, StorageError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The file, within the folder of a training or of an agent.
pub const FILE: &str = "curve.jsonl";
/// Largest file, bytes.
const LARGEST: u64 = 1 << 30;

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

impl Curve {
    /// The curve in a folder; `None` if it holds none.
    ///
    /// # Errors
    /// A folder or file that cannot be read.
    pub fn in_folder(path: &Path) -> Result<Option<Self>, StorageError> {
        Ok(Folder::open(path)?.read(Path::new(FILE), LARGEST)?.map(|bytes| Self::of(&bytes)))
    }

    /// The curve that bytes of a file hold. A line that is just being written, and what is no line of a curve, is left out.
    pub fn of(bytes: &[u8]) -> Self {
        let lines = Log::whole_lines(bytes).split(|byte| *byte == b'\n');
        Self { lines: lines.filter_map(|line| serde_json::from_slice(line).ok()).collect() }
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
        let curve = Curve::of(TEXT.as_bytes());
        let written: Vec<u8> = curve.lines.iter().flat_map(|line| [line.bytes(), vec![b'\n']].concat()).collect();
        assert_eq!(String::from_utf8_lossy(&written), TEXT);
        assert_eq!(curve.evaluations().map(|(step, found)| (step, found.total)).collect::<Vec<_>>(), [(200, 4.0)]);
        assert_eq!(curve.rounds().map(|round| round.step).collect::<Vec<_>>(), [100, 200]);
        assert_eq!(curve.ended().map(|(step, ended)| (step, ended.terms["near"])).collect::<Vec<_>>(), [(200, 3.0)]);
    }

    #[test]
    fn a_line_that_is_being_written_is_left_out() {
        let cut = &TEXT.as_bytes()[..TEXT.len() - 1];
        assert_eq!(Curve::of(cut).lines.len(), 2);
        assert_eq!(Curve::of(b"nonsense\n{}\n").lines, []);
    }
}
