//! Looks at an episode step by step and keeps what a page shows of it.

use crate::anatomy::Anatomy;
use crate::contacts::{Contacts, Pair};
use crate::muscles::{ACTIVATION, FORCE, Muscles};
use crate::reference::Reference;
use crate::signals::{self, Signal, Signals};
use crate::track::{Block, Track, quantise};
use crate::wraps;
use msk_program::task::CompiledTask;
use msk_runtime::body::sensors::Snapshot;
use msk_runtime::episode::{Ending, Environment};
use serde::Serialize;

/// Frames per second at most: a display shows no more.
const FRAMES_PER_SECOND: f64 = 60.0;
/// Quantum of joint coordinates, m and rad, of a root's place, and of the parts of a quaternion: the end of a chain of joints is off by
/// less than 0.1 mm.
const COORDINATE: f64 = 4e-5;
/// Quantum of the lengths of fibres, where tendons are elastic, and of markers, m.
const LENGTH: f64 = 1e-4;

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
#[derive(Debug, Clone, Serialize)]
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

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Quanta {
    coordinate: f64,
    activation: f64,
    force: f64,
    length: f64,
    wrap: f64,
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

/// Keeps frames of an episode, or of anything that moves a body.
pub struct Recorder {
    anatomy: Anatomy,
    strengths: Vec<f64>,
    period: f64,
    stride: u32,
    ended: bool,
    task: Option<TaskRecorder>,
    steps: Track,
    coordinates: Track,
    placed: Track,
    muscles: Muscles,
    fatigued: Track,
    fibres: Track,
    /// The rows of the wrapping surfaces at present.
    wrap_rows: Vec<i32>,
    wraps: Track,
    contacts: Contacts,
}

/// What only a task has.
struct TaskRecorder {
    names: TaskNames,
    reference: Reference,
    referenced: Track,
    phase: Track,
    markers: Track,
    conditions: Track,
    terms: Signals,
    signals: Signals,
    /// Places of the curves in the task's frame.
    places: Vec<usize>,
}

struct TaskNames {
    terminations: Vec<String>,
    finishes: Vec<String>,
    markers: Vec<String>,
    phases: Vec<String>,
}

impl Recorder {
    /// For the episodes of an environment whose muscles have these strengths, one per muscle; none for healthy ones.
    pub fn new(environment: &Environment, strengths: &[f64]) -> Self {
        let context = environment.context();
        let mut recorder = Self::of(&context.snapshot(), strengths, environment.control_period());
        recorder.task = Some(TaskRecorder::new(&context.snapshot(), environment.task()));
        recorder
    }

    /// For snapshots of one model without a task, `period` (s) apart.
    pub fn of(snapshot: &Snapshot<'_>, strengths: &[f64], period: f64) -> Self {
        let anatomy = Anatomy::of(snapshot, strengths);
        let muscles = snapshot.body.muscles.len();
        let frequency = if period > 0.0 { 1.0 / period } else { 1.0 };
        let fibres = if snapshot.model.elastic_tendons.is_some() { muscles } else { 0 };
        Self {
            period,
            stride: (frequency / FRAMES_PER_SECOND).ceil().clamp(1.0, 1e6) as u32,
            ended: false,
            task: None,
            steps: Track::new(1),
            coordinates: Track::new(snapshot.model.nq),
            placed: Track::new(7 * snapshot.state.mocap_position.len()),
            muscles: Muscles::new(muscles),
            fatigued: Track::new(muscles),
            fibres: Track::new(fibres),
            wrap_rows: vec![0; wraps::WIDTH * anatomy.wraps.len()],
            wraps: Track::new(wraps::WIDTH * anatomy.wraps.len()),
            contacts: Contacts::default(),
            anatomy,
            strengths: strengths.to_vec(),
        }
    }

    /// Looks at an environment after its reset and after every control step. Steps that come faster than a display are left out, but
    /// for the one that ends the episode. A fault leaves nothing to look at.
    pub fn look(&mut self, environment: &Environment) {
        let (steps, ending) = (environment.steps(), environment.ending());
        let over = matches!(ending, Some(Ending::Truncated)) || ending.is_some() && !self.ended;
        self.ended |= ending.is_some();
        if matches!(ending, Some(Ending::Fault(_))) || !(over || steps.is_multiple_of(self.stride)) {
            return;
        }
        let context = environment.context();
        self.frame(steps, &context.snapshot());
        match environment.compartments() {
            Some(compartments) => {
                let share = |muscle| quantise(compartments.of(muscle)[2], ACTIVATION);
                self.fatigued.push((0..self.anatomy.muscles.len()).map(share));
            }
            None => self.fatigued.push([]),
        }
        if let Some(task) = &mut self.task {
            task.look(environment);
        }
    }

    /// Looks at a snapshot after that many control steps.
    pub fn look_at(&mut self, steps: u32, snapshot: &Snapshot<'_>) {
        if steps.is_multiple_of(self.stride) {
            self.frame(steps, snapshot);
            self.fatigued.push([]);
        }
    }

    fn frame(&mut self, steps: u32, snapshot: &Snapshot<'_>) {
        let &Snapshot { state, workspace, .. } = snapshot;
        if self.steps.frames() == 0 {
            // Strengths may be drawn for each episode.
            self.anatomy = Anatomy::of(snapshot, &self.strengths);
        }
        self.steps.push([i32::try_from(steps).unwrap_or(i32::MAX)]);
        self.coordinates.push(state.position.iter().map(|value| quantise(*value, COORDINATE)));
        let placed = state.mocap_position.iter().zip(&state.mocap_orientation);
        self.placed.push(placed.flat_map(|(position, orientation)| {
            position.iter().chain(orientation).map(|value| quantise(*value, COORDINATE)).collect::<Vec<_>>()
        }));
        self.muscles.look(&self.anatomy, snapshot);
        self.fibres.push((0..self.fibres.width()).map(|muscle| quantise(workspace.actuation.fibre_length(muscle), LENGTH)));
        wraps::update(snapshot, &self.anatomy.wraps, &mut self.wrap_rows);
        self.wraps.push(self.wrap_rows.iter().copied());
        self.contacts.look(snapshot);
    }

    /// What was recorded.
    ///
    /// # Errors
    /// Nothing was.
    pub fn finish(self, caption: Caption) -> Result<Recording, RecordingError> {
        let frames = self.steps.frames();
        if frames == 0 {
            return Err(RecordingError::Empty);
        }
        let (pairs, contacts) = self.contacts.finish();
        let touched: Vec<usize> =
            (0..self.anatomy.wraps.len()).filter(|wrap| self.wraps.column(wrap * wraps::WIDTH).any(|state| state != 0)).collect();
        let kept: Vec<bool> =
            (0..self.wraps.width()).map(|column| touched.binary_search(&(column / wraps::WIDTH)).is_ok()).collect();
        let [forces, gains, passive] = self.muscles.finish();
        let mut bytes = Vec::new();
        let mut write = |track: &Track| track.write(&mut bytes);
        let mut tracks = Tracks {
            steps: write(&self.steps),
            coordinates: write(&self.coordinates),
            placed: write(&self.placed),
            activations: write(&self.muscles.activations),
            forces: write(&forces),
            gains: write(&gains),
            passive: write(&passive),
            fatigued: write(&self.fatigued),
            fibres: write(&self.fibres),
            wraps: write(&self.wraps.only(&kept)),
            contacts: write(&contacts),
            ..Tracks::default()
        };
        let mut header = Header {
            caption,
            frames,
            period: self.period,
            quanta: Quanta { coordinate: COORDINATE, activation: ACTIVATION, force: FORCE, length: LENGTH, wrap: wraps::QUANTUM },
            terms: Vec::new(),
            terminations: Vec::new(),
            finishes: Vec::new(),
            markers: Vec::new(),
            phases: Vec::new(),
            contacts: pairs,
            signals: Vec::new(),
            touched,
            tracks: Tracks::default(),
        };
        if let Some(task) = self.task {
            let (terms, term_codes) = task.terms.finish();
            let (signals, signal_codes) = task.signals.finish();
            tracks.reference = write(&task.referenced);
            tracks.phase = write(&task.phase);
            tracks.markers = write(&task.markers);
            tracks.conditions = write(&task.conditions);
            tracks.terms = write(&term_codes);
            tracks.signals = write(&signal_codes);
            (header.terms, header.signals) = (terms, signals);
            let TaskNames { terminations, finishes, markers, phases } = task.names;
            (header.terminations, header.finishes, header.markers, header.phases) = (terminations, finishes, markers, phases);
        }
        header.tracks = tracks;
        Ok(Recording { anatomy: self.anatomy, header, bytes })
    }
}

impl TaskRecorder {
    fn new(snapshot: &Snapshot<'_>, task: &CompiledTask) -> Self {
        let (mut terms, mut signals) = (Signals::default(), Signals::default());
        task.terms.iter().for_each(|term| terms.add(&term.name, ""));
        signals.add("reward", "");
        signals.add("return", "");
        for metric in &task.metrics {
            for part in 0..metric.size {
                let suffix = if metric.size > 1 { format!("[{part}]") } else { String::new() };
                signals.add(format!("{}{suffix}", metric.name), &metric.unit);
            }
        }
        let curves = signals::of_frame(task);
        curves.iter().for_each(|(_, name, unit)| signals.add(name, *unit));
        let referenced = if task.motions.is_empty() { 0 } else { 1 + snapshot.model.nq };
        let phases =
            if task.phases.len() > 1 { task.phases.iter().map(|phase| phase.name.clone()).collect() } else { Vec::new() };
        Self {
            reference: Reference::new(snapshot.model),
            referenced: Track::new(referenced),
            phase: Track::new(usize::from(!phases.is_empty())),
            markers: Track::new(3 * task.markers.len()),
            conditions: Track::new(task.terminations.len() + task.finishes.len()),
            terms,
            signals,
            places: curves.into_iter().map(|(place, _, _)| place).collect(),
            names: TaskNames {
                terminations: task.terminations.clone(),
                finishes: task.finishes.clone(),
                markers: task.markers.clone(),
                phases,
            },
        }
    }

    fn look(&mut self, environment: &Environment) {
        let report = environment.report();
        // The first number tells whether there is a reference at present.
        match self.reference.coordinates(environment) {
            Some(coordinates) => {
                let row = coordinates.iter().map(|value| quantise(*value, COORDINATE));
                self.referenced.push(std::iter::once(1).chain(row));
            }
            None => self.referenced.push([]),
        }
        self.phase.push((0..self.phase.width()).map(|_| i32::try_from(report.phase).unwrap_or(i32::MAX)));
        let task = environment.task();
        let progress = environment.context().progress;
        self.markers.push((0..task.markers.len()).flat_map(|marker| {
            let place = task.marker(marker, environment.frame(), progress).unwrap_or_default();
            place.map(|value| quantise(value, LENGTH))
        }));
        // Nothing has been judged at a reset.
        let judged =
            |reasons: &[bool], count: usize| (0..count).map(|index| reasons.get(index).is_some_and(|holds| *holds)).collect();
        let failed: Vec<bool> = judged(&report.terminations, task.terminations.len());
        let finished: Vec<bool> = judged(&report.finishes, task.finishes.len());
        self.conditions.push(failed.into_iter().chain(finished).map(i32::from));
        let contributions = report.terms.iter().zip(environment.weights()).map(|(value, weight)| value * weight);
        self.terms.push(contributions);
        let reward = if report.terms.is_empty() { f64::NAN } else { report.reward };
        let metrics = task.metrics.last().map_or(0, |metric| metric.offset + metric.size);
        let metric = |index: usize| report.metrics.get(index).copied().unwrap_or(f64::NAN);
        let whole = [reward, environment.episode().total()];
        let frame = self.places.iter().map(|place| environment.frame().get(*place).copied().unwrap_or(f64::NAN));
        self.signals.push(whole.into_iter().chain((0..metrics).map(metric)).chain(frame));
    }
}
