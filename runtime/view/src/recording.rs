//! A finished recording: plain data that a page is made of.

use crate::anatomy::Anatomy;
use crate::contacts::Pair;
use crate::signals::Signal;
use crate::track::Block;
use serde::Serialize;

/// What stands above a recording.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Caption {
    /// What tells it from others on the same page, such as "worst"; may be empty.
    pub label: String,
    /// Name of the task, or of the motion.
    pub task: String,
    /// What acted.
    pub policy: String,
    /// Seed and index of the episode, if it is one.
    pub episode: Option<[u64; 2]>,
    /// How it ended, in words.
    pub outcome: String,
    /// Whether it succeeded, if that was a question.
    pub success: Option<bool>,
    /// Its return, if it has one.
    pub total: Option<f64>,
    /// Condition of the muscles; empty for healthy ones.
    pub condition: String,
}

/// Why there is nothing to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordingError {
    /// No frame: the episode could not begin.
    Empty,
}

impl std::fmt::Display for RecordingError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("there is nothing to show: the episode ended with a fault at its reset")
    }
}

impl std::error::Error for RecordingError {}

/// A finished recording.
#[derive(Debug, Clone)]
pub struct Recording {
    pub(crate) anatomy: Anatomy,
    pub(crate) header: Header,
    pub(crate) bytes: Vec<u8>,
}

/// Everything of a recording but its bytes.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Header {
    pub caption: Caption,
    pub frames: usize,
    /// Length of a control step, s.
    pub period: f64,
    pub quanta: Quanta,
    /// Reward terms: what each adds to the reward of a step.
    pub terms: Vec<Signal>,
    /// Reasons that end an episode as a failure, then those that end it without being one.
    pub terminations: Vec<String>,
    pub finishes: Vec<String>,
    pub markers: Vec<String>,
    /// Names of the phases of a sequence; empty for a task by itself.
    pub phases: Vec<String>,
    pub contacts: Vec<Pair>,
    pub signals: Vec<Signal>,
    /// The wrapping surfaces that are touched at some time, in the order of their columns.
    pub touched: Vec<usize>,
    pub tracks: Tracks,
}

/// What the whole numbers of tracks are multiples of.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Quanta {
    pub coordinate: f64,
    pub activation: f64,
    pub excitation: f64,
    pub force: f64,
    pub length: f64,
    pub wrap: f64,
}

/// Where each track stands in the bytes.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Tracks {
    pub steps: Block,
    pub phase: Block,
    pub coordinates: Block,
    pub reference: Block,
    pub placed: Block,
    pub activations: Block,
    pub excitations: Block,
    pub forces: Block,
    pub gains: Block,
    pub passive: Block,
    pub fatigued: Block,
    pub fibres: Block,
    pub wraps: Block,
    pub contacts: Block,
    pub markers: Block,
    pub conditions: Block,
    pub terms: Block,
    pub signals: Block,
}
