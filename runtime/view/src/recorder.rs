//! Looks at an episode step by step and keeps what a page shows of it.

use crate::anatomy::Anatomy;
use crate::contacts::Contacts;
use crate::muscles::{ACTIVATION, EXCITATION, FORCE, Muscles};
use crate::recording::{Caption, Header, Quanta, Recording, RecordingError, Tracks};
use crate::task::TaskRecorder;
use crate::track::{Track, quantise};
use crate::wraps;
use msk_runtime::body::sensors::Snapshot;
use msk_runtime::episode::{Ending, Environment};

/// Frames per second at most: a display shows no more.
const FRAMES_PER_SECOND: f64 = 60.0;
/// Quantum of joint coordinates, m and rad, of a root's place, and of the parts of a quaternion: the end of a chain of joints is off by
/// less than 0.1 mm.
pub(crate) const COORDINATE: f64 = 4e-5;
/// Quantum of the lengths of fibres, where tendons are elastic, and of markers, m.
pub(crate) const LENGTH: f64 = 1e-4;

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

    /// Memory that a control step takes at most, in the mean over many, bytes.
    pub fn bytes_per_step(&self) -> usize {
        // Forces, gains and passive forces beside activations and excitations.
        let muscles = 5 * self.anatomy.muscles.len();
        let tracks = [&self.steps, &self.coordinates, &self.placed, &self.fatigued, &self.fibres, &self.wraps];
        let numbers = muscles + tracks.map(Track::width).iter().sum::<usize>();
        (numbers * size_of::<i32>()).div_ceil(self.stride as usize)
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

    /// What was recorded so far; more may follow.
    ///
    /// # Errors
    /// Nothing was.
    pub fn recording(&self, caption: Caption) -> Result<Recording, RecordingError> {
        let frames = self.steps.frames();
        if frames == 0 {
            return Err(RecordingError::Empty);
        }
        let (pairs, contacts) = self.contacts.finish();
        let [forces, gains, passive] = self.muscles.finish();
        let touched: Vec<usize> =
            (0..self.anatomy.wraps.len()).filter(|wrap| self.wraps.column(wrap * wraps::WIDTH).any(|state| state != 0)).collect();
        let kept: Vec<bool> =
            (0..self.wraps.width()).map(|column| touched.binary_search(&(column / wraps::WIDTH)).is_ok()).collect();
        let mut bytes = Vec::new();
        let mut write = |track: &Track| track.write(&mut bytes);
        let tracks = Tracks {
            steps: write(&self.steps),
            coordinates: write(&self.coordinates),
            placed: write(&self.placed),
            activations: write(&self.muscles.activations),
            excitations: write(&self.muscles.excitations),
            forces: write(&forces),
            gains: write(&gains),
            passive: write(&passive),
            fatigued: write(&self.fatigued),
            fibres: write(&self.fibres),
            wraps: write(&self.wraps.only(&kept)),
            contacts: write(&contacts),
            ..Tracks::default()
        };
        let quanta = Quanta {
            coordinate: COORDINATE,
            activation: ACTIVATION,
            excitation: EXCITATION,
            force: FORCE,
            length: LENGTH,
            wrap: wraps::QUANTUM,
        };
        let mut header =
            Header { caption, frames, period: self.period, quanta, contacts: pairs, touched, tracks, ..Header::default() };
        if let Some(task) = &self.task {
            task.write(&mut header, &mut bytes);
        }
        Ok(Recording { anatomy: self.anatomy.clone(), header, bytes })
    }
}
