//! What only the episodes of a task have: reward terms, conditions, markers, its reference and signals.

use crate::recorder::{COORDINATE, LENGTH};
use crate::recording::Header;
use crate::signals::{self, Signals};
use crate::track::{Block, Track, quantise};
use msk_program::task::CompiledTask;
use msk_runtime::body::sensors::Snapshot;
use msk_runtime::episode::Environment;
use msk_runtime::reference::Reference;

/// What only a task has.
pub(crate) struct TaskRecorder {
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

#[derive(Clone)]
struct TaskNames {
    terminations: Vec<String>,
    finishes: Vec<String>,
    markers: Vec<String>,
    phases: Vec<String>,
}

impl TaskRecorder {
    pub fn new(snapshot: &Snapshot<'_>, task: &CompiledTask) -> Self {
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

    /// Appends a frame.
    pub fn look(&mut self, environment: &Environment) {
        let report = environment.report();
        // The first number tells whether there is a reference at present.
        match self.reference.coordinates(&environment.context()) {
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

    /// Adds names and tracks to a recording.
    pub fn write(&self, header: &mut Header, bytes: &mut Vec<u8>) {
        let (terms, term_codes) = self.terms.finish();
        let (signals, signal_codes) = self.signals.finish();
        let mut write = |track: &Track| -> Block { track.write(bytes) };
        header.tracks.reference = write(&self.referenced);
        header.tracks.phase = write(&self.phase);
        header.tracks.markers = write(&self.markers);
        header.tracks.conditions = write(&self.conditions);
        header.tracks.terms = write(&term_codes);
        header.tracks.signals = write(&signal_codes);
        (header.terms, header.signals) = (terms, signals);
        let TaskNames { terminations, finishes, markers, phases } = self.names.clone();
        (header.terminations, header.finishes, header.markers, header.phases) = (terminations, finishes, markers, phases);
    }
}
