//! Many episodes side by side.

use crate::arrays::{self, OutOfRange};
use crate::environment::{End, end};
use crate::guard::{Guarded, detached};
use crate::queue::Queue;
use crate::snapshot::Snapshot;
use crate::state;
use crate::task::Task;
use crate::workers::{Process, no_threads, threads};
use msk_runtime::episode::{self, AutoresetMode, EpisodeKey, VectorStep};
use numpy::PyArray1;
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::num::NonZeroUsize;

/// Episodes of a task that are stepped together, on threads of their own.
#[pyclass(frozen, module = "msk._native")]
pub struct VectorEnvironment {
    task: Py<Task>,
    inner: Guarded<episode::VectorEnvironment>,
    process: Process,
    count: usize,
    rule: OutOfRange,
    single: bool,
}

/// (observations, rewards, terminated, truncated, ended), one row per slot.
type Step<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
);

/// (slot, how it ended, (seed, episode), success, steps, return, what each term added to it, terms and metrics at the last step).
type Ended = (usize, End, (u64, u64), bool, u32, f64, Vec<f64>, Vec<f64>, Vec<f64>);

/// (values of the terms, metrics, successes, whether a step has been reported), one row per slot.
type Report<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<bool>>);

#[pymethods]
impl VectorEnvironment {
    #[new]
    #[pyo3(signature = (task, count, threads, autoreset, clip_actions, single_precision))]
    fn new(
        py: Python<'_>,
        task: Py<Task>,
        count: NonZeroUsize,
        threads: Option<NonZeroUsize>,
        autoreset: &str,
        clip_actions: bool,
        single_precision: bool,
    ) -> PyResult<Self> {
        let autoreset = match autoreset {
            "SameStep" => AutoresetMode::SameStep,
            "NextStep" => AutoresetMode::NextStep,
            "Disabled" => AutoresetMode::Disabled,
            other => return Err(PyValueError::new_err(format!("there is no autoreset mode `{other}`"))),
        };
        let threads = self::threads(threads);
        let engine = task.get().engine().clone();
        let made = detached(py, move || episode::VectorEnvironment::new(engine, count, threads))?;
        let inner = made.map_err(|error| no_threads(&error))?.with_autoreset(autoreset).with_stride(1);
        let rule = if clip_actions { OutOfRange::Clip } else { OutOfRange::Reject };
        let (inner, process) = (Guarded::new(inner), Process::present());
        Ok(Self { task, inner, process, count: count.get(), rule, single: single_precision })
    }

    /// Begins the episodes `keys`, (seed, index), in their slots; None leaves a slot as it is.
    fn reset<'py>(&self, py: Python<'py>, keys: Vec<Option<(u64, u64)>>) -> PyResult<Step<'py>> {
        let key = |(seed, episode)| EpisodeKey { seed, episode };
        let keys: Vec<Option<EpisodeKey>> = keys.into_iter().map(|slot| slot.map(key)).collect();
        self.change(py, move |inner| inner.reset_to(&keys).ended.len())?;
        self.last(py)
    }

    /// Takes one control step in every slot.
    fn step<'py>(&self, py: Python<'py>, actions: &Bound<'py, PyAny>) -> PyResult<Step<'py>> {
        let actions = arrays::actions(actions, Some(self.count), self.task.get().action_names(), self.rule)?;
        self.change(py, move |inner| inner.step(&actions).map(|_| ()))?
            .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        self.last(py)
    }

    /// Begins a control step in every slot, in the background, after what was sent to the queue before.
    fn send(&self, actions: &Bound<'_, PyAny>, queue: &Queue) -> PyResult<()> {
        self.inner.get()?;
        let actions = arrays::actions(actions, Some(self.count), self.task.get().action_names(), self.rule)?;
        self.live()?;
        self.inner.send(queue, move |inner| {
            // It fails for a wrong number of actions alone, which was checked.
            drop(inner.step(&actions));
        })
    }

    /// Waits for the step that was sent.
    fn recv<'py>(&self, py: Python<'py>) -> PyResult<Step<'py>> {
        self.inner.wait(py)?;
        self.last(py)
    }

    /// The episodes that ended in the last step.
    fn ends(&self) -> PyResult<Vec<Ended>> {
        let task = self.task.get();
        let ended = |ended: &episode::EpisodeEnd| {
            let key = (ended.key.seed, ended.key.episode);
            let (totals, terms, metrics) = (ended.totals.clone(), ended.terms.clone(), ended.metrics.clone());
            let how = end(Some(&ended.ending), task)?;
            Some((ended.slot, how, key, ended.success, ended.steps, ended.total, totals, terms, metrics))
        };
        Ok(self.inner.get()?.last().ends.iter().filter_map(ended).collect())
    }

    /// The last observations of the episodes that ended in the last step, in the rows of their slots; zeros in the others.
    fn final_observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.final_rows(py, &self.inner.get()?.last().final_observations)
    }

    /// Of the present episodes: (unweighted values of the terms, metrics, successes, whether a step has been reported), one row per
    /// slot.
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Report<'py>> {
        let task = self.task.get().engine().task();
        let widths = [task.terms.len(), task.metrics.iter().map(|part| part.size).sum()];
        let mut tables = widths.map(|width| vec![0.0; width * self.count]);
        let (mut successes, mut reported) = (Vec::with_capacity(self.count), Vec::with_capacity(self.count));
        for (slot, episode) in self.inner.get()?.episodes().enumerate() {
            let report = episode.report();
            for ((table, width), values) in tables.iter_mut().zip(widths).zip([&report.terms, &report.metrics]) {
                if values.len() == width {
                    table[width * slot..width * (slot + 1)].copy_from_slice(values);
                }
            }
            successes.push(report.success);
            reported.push(report.terms.len() == widths[0] && episode.steps() > 0);
        }
        let [terms, metrics] = tables;
        let table = |values: &[f64], width| arrays::table(py, values, [self.count, width], false);
        let flags = |flags| PyArray1::from_vec(py, flags);
        Ok((table(&terms, widths[0])?, table(&metrics, widths[1])?, flags(successes), flags(reported)))
    }

    /// (seed, index) of the episodes, slot by slot.
    fn keys(&self) -> PyResult<Vec<(u64, u64)>> {
        Ok(self.inner.get()?.episodes().map(|episode| (episode.key().seed, episode.key().episode)).collect())
    }

    /// (seed, index) of the episodes that follow them.
    fn next_keys(&self) -> PyResult<Vec<(u64, u64)>> {
        Ok(self.inner.get()?.next_keys().map(|key| (key.seed, key.episode)).collect())
    }

    /// Why the episodes have ended, slot by slot; None for those that have not.
    fn endings(&self) -> PyResult<Vec<Option<End>>> {
        Ok(self.inner.get()?.episodes().map(|episode| end(episode.ending(), self.task.get())).collect())
    }

    fn weights(&self) -> PyResult<Vec<f64>> {
        Ok(self.inner.get()?.weights(0).unwrap_or_default().to_vec())
    }

    fn last_weights(&self) -> PyResult<Vec<f64>> {
        Ok(self.inner.get()?.last_weights(0).unwrap_or_default().to_vec())
    }

    /// Sets the weight of a term in all slots.
    fn set_weight(&self, index: usize, value: f64) -> PyResult<()> {
        self.task.get().check_weight(index, value)?;
        let mut inner = self.inner.get_mut()?;
        for slot in 0..self.count {
            inner.set_weight(slot, index, value);
        }
        Ok(())
    }

    /// Sets parameters, in the units in which they are written, for the episodes that begin from now on in the slots of the mask: a
    /// value for each slot. All of them are set or none.
    fn set_parameters(&self, values: Vec<(String, Vec<f64>)>, mask: Vec<bool>) -> PyResult<()> {
        let mut checked = Vec::new();
        for (name, values) in values {
            if values.len() != self.count {
                let message = format!("`{name}` has {} values for {} slots", values.len(), self.count);
                return Err(PyValueError::new_err(message));
            }
            for (slot, value) in values.into_iter().enumerate().filter(|(slot, _)| mask.get(*slot) == Some(&true)) {
                let own = self.task.get().checked_parameters(vec![(name.clone(), value)])?;
                checked.extend(own.into_iter().map(|(name, value)| (slot, name, value)));
            }
        }
        let mut inner = self.inner.get_mut()?;
        let set = checked.iter().try_for_each(|(slot, name, value)| inner.set_parameter(*slot, name, *value));
        set.map_err(|error| PyValueError::new_err(error.to_string()))
    }

    fn progress(&self) -> PyResult<f64> {
        Ok(self.inner.get()?.progress())
    }

    fn set_progress(&self, progress: f64) -> PyResult<()> {
        self.inner.get_mut()?.set_progress(progress).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    fn snapshot(&self) -> PyResult<Snapshot> {
        let inner = self.inner.get()?;
        Ok(Snapshot::new(self.task.get(), inner.episodes().cloned().zip(inner.next_keys()).collect()))
    }

    fn restore(&self, py: Python<'_>, snapshot: &Snapshot) -> PyResult<()> {
        snapshot.check(self.task.get(), self.count)?;
        self.change(py, |inner| {
            for (slot, (episode, next)) in snapshot.slots.iter().enumerate() {
                inner.restore(slot, episode);
                inner.set_next_key(slot, *next);
            }
        })
    }

    /// The present observations, one row per slot.
    fn observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values: Vec<f64> = self.inner.get()?.episodes().flat_map(|episode| episode.observation()).copied().collect();
        arrays::table(py, &values, [self.count, values.len() / self.count], self.single)
    }

    /// What only a critic sees at present, one row per slot.
    fn critic_observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values: Vec<f64> = self.inner.get()?.episodes().flat_map(|episode| episode.critic_observation()).copied().collect();
        arrays::table(py, &values, [self.count, values.len() / self.count], self.single)
    }

    /// What only a critic saw at the end of the episodes that ended in the last step, in the rows of their slots; zeros in the others.
    fn final_critic_observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.final_rows(py, &self.inner.get()?.last().final_critic_observations)
    }

    /// The state of the episode in a slot.
    fn state<'py>(&self, py: Python<'py>, slot: usize) -> PyResult<Bound<'py, PyDict>> {
        let inner = self.inner.get()?;
        let episode = inner.episodes().nth(slot);
        let episode = episode.ok_or_else(|| PyIndexError::new_err(format!("slot {slot} of {} environments", self.count)))?;
        state::arrays(py, episode.state(), inner.engine().model())
    }
}

impl VectorEnvironment {
    /// The rows of the episodes that ended in the last step; zeros in the others.
    fn final_rows<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
        let width = values.len() / self.count;
        let mut values = values.to_vec();
        for (slot, _) in self.inner.get()?.last().ended.iter().enumerate().filter(|(_, ended)| !**ended) {
            values[width * slot..width * (slot + 1)].fill(0.0);
        }
        arrays::table(py, &values, [self.count, width], self.single)
    }

    /// Changes the environment with threads that live in this process.
    fn change<R: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut episode::VectorEnvironment) -> R + Send) -> PyResult<R> {
        self.live()?;
        self.inner.change(py, work)
    }

    /// Starts threads in this process where there are none.
    fn live(&self) -> PyResult<()> {
        let mut inner = self.inner.get_mut()?;
        if self.process.has_changed() {
            inner.restart_workers().map_err(|error| no_threads(&error))?;
        }
        Ok(())
    }

    fn last<'py>(&self, py: Python<'py>) -> PyResult<Step<'py>> {
        let inner = self.inner.get()?;
        let VectorStep { observations, rewards, terminated, truncated, ended, .. } = inner.last();
        let flags = |flags: &[bool]| PyArray1::from_slice(py, flags);
        let observations = arrays::table(py, observations, [self.count, observations.len() / self.count], self.single)?;
        Ok((observations, PyArray1::from_slice(py, rewards), flags(terminated), flags(truncated), flags(ended)))
    }
}
