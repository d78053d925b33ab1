//! One episode after the other.

use crate::arrays::{self, OutOfRange};
use crate::guard::Guarded;
use crate::recorded::Recorded;
use crate::snapshot::Snapshot;
use crate::state;
use crate::task::Task;
use msk_draw::{Options, View, svg};
use msk_runtime::episode::{self, Ending, EpisodeError, EpisodeKey};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// One episode of a task after the other. It starts no thread.
#[pyclass(frozen, module = "msk._native")]
pub struct Environment {
    task: Py<Task>,
    inner: Guarded<Recorded>,
    rule: OutOfRange,
    single: bool,
}

/// How an episode ended: the kind, and the conditions or the fault in words.
pub type End = (&'static str, String);

/// How an episode of a task ended, if it has.
pub fn end(ending: Option<&Ending>, task: &Task) -> Option<End> {
    let ending = ending?;
    Some(match ending {
        Ending::Terminated(_) => ("terminated", ending.conditions(task.engine().task())),
        Ending::Finished(_) => ("finished", ending.conditions(task.engine().task())),
        Ending::Truncated => ("truncated", String::new()),
        Ending::Fault(fault) => ("fault", fault.to_string()),
    })
}

#[pymethods]
impl Environment {
    #[new]
    fn new(py: Python<'_>, task: Py<Task>, clip_actions: bool, single_precision: bool, record: bool) -> PyResult<Self> {
        let engine = task.get().engine().clone();
        let environment = crate::guard::detached(py, move || episode::Environment::of(engine))?;
        let inner = Guarded::new(Recorded::new(environment, record));
        let rule = if clip_actions { OutOfRange::Clip } else { OutOfRange::Reject };
        Ok(Self { task, inner, rule, single: single_precision })
    }

    /// Begins an episode; gives its first observation.
    fn reset<'py>(&self, py: Python<'py>, seed: u64, episode: u64) -> PyResult<Bound<'py, PyAny>> {
        self.inner.change(py, |inner| inner.begin(|inner| inner.reset(EpisodeKey { seed, episode })))?;
        self.begun(py)
    }

    /// Begins an episode in a state, of which `arrays` replaces parts of the present one.
    fn reset_to<'py>(
        &self,
        py: Python<'py>,
        seed: u64,
        episode: u64,
        arrays: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let inner = self.inner.get()?;
        let fresh = state::replaced(inner.state(), arrays, inner.engine().model())?;
        drop(inner);
        self.inner.change(py, move |inner| {
            inner.begin(|inner| {
                inner.reset_to(EpisodeKey { seed, episode }, &mut |state| *state = fresh.clone());
                inner.end_script();
            });
        })?;
        self.begun(py)
    }

    /// Takes one control step: (observation, reward, terminated, truncated).
    fn step<'py>(&self, py: Python<'py>, action: &Bound<'py, PyAny>) -> PyResult<(Bound<'py, PyAny>, f64, bool, bool)> {
        let action = arrays::actions(action, None, self.task.get().action_names(), self.rule)?;
        self.inner
            .change(py, move |inner| {
                inner.step(&action)?;
                inner.look();
                Ok(())
            })?
            .map_err(|error: EpisodeError| PyRuntimeError::new_err(error.to_string()))?;
        let inner = self.inner.get()?;
        let ending = inner.ending();
        let terminated = ending.is_some_and(|ending| !ending.bootstraps(inner.task()));
        Ok((
            arrays::row(py, inner.observation(), self.single),
            inner.report().reward,
            terminated,
            ending.is_some() && !terminated,
        ))
    }

    /// (unweighted values of the terms, metrics, success) of the last step; the lists are empty before the first, and after a fault.
    fn report(&self) -> PyResult<(Vec<f64>, Vec<f64>, bool)> {
        let inner = self.inner.get()?;
        let report = inner.report();
        Ok((report.terms.clone(), report.metrics.clone(), report.success))
    }

    /// (return, what each term added to it) since reset.
    fn returns(&self) -> PyResult<(f64, Vec<f64>)> {
        let inner = self.inner.get()?;
        let episode = inner.episode();
        Ok((episode.total(), episode.totals().to_vec()))
    }

    fn end(&self) -> PyResult<Option<End>> {
        Ok(end(self.inner.get()?.ending(), self.task.get()))
    }

    /// (seed, index) of the episode.
    fn key(&self) -> PyResult<(u64, u64)> {
        let EpisodeKey { seed, episode } = self.inner.get()?.key();
        Ok((seed, episode))
    }

    fn steps(&self) -> PyResult<u32> {
        Ok(self.inner.get()?.steps())
    }

    fn observation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(arrays::row(py, self.inner.get()?.observation(), self.single))
    }

    fn critic_observation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(arrays::row(py, self.inner.get()?.critic_observation(), self.single))
    }

    fn weights(&self) -> PyResult<Vec<f64>> {
        Ok(self.inner.get()?.weights().to_vec())
    }

    fn last_weights(&self) -> PyResult<Vec<f64>> {
        Ok(self.inner.get()?.last_weights().to_vec())
    }

    fn set_weight(&self, index: usize, value: f64) -> PyResult<()> {
        self.task.get().check_weight(index, value)?;
        self.inner.get_mut()?.set_weight(index, value);
        Ok(())
    }

    /// Sets parameters, in the units in which they are written, from the next reset on: all of them or none.
    fn set_parameters(&self, values: Vec<(String, f64)>) -> PyResult<()> {
        let values = self.task.get().checked_parameters(values)?;
        let mut inner = self.inner.get_mut()?;
        values
            .iter()
            .try_for_each(|(name, value)| inner.set_parameter(name, *value))
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    fn progress(&self) -> PyResult<f64> {
        Ok(self.inner.get()?.progress())
    }

    fn set_progress(&self, progress: f64) -> PyResult<()> {
        self.inner.get_mut()?.set_progress(progress).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    fn snapshot(&self) -> PyResult<Snapshot> {
        let episode = self.inner.get()?.snapshot();
        let key = episode.key();
        Ok(Snapshot::new(self.task.get(), vec![(episode, key)]))
    }

    fn restore(&self, py: Python<'_>, snapshot: &Snapshot) -> PyResult<()> {
        snapshot.check(self.task.get(), 1)?;
        self.inner.change(py, |inner| inner.begin(|inner| snapshot.slots.iter().for_each(|(episode, _)| inner.restore(episode))))
    }

    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let inner = self.inner.get()?;
        state::arrays(py, inner.state(), inner.engine().model())
    }

    /// The present episode so far as an HTML page.
    fn page(&self, py: Python<'_>, title: String) -> PyResult<String> {
        self.inner.change(py, move |inner| inner.page(title))?.map_err(PyRuntimeError::new_err)
    }

    /// A picture as SVG, from the side and from in front.
    fn draw(&self, py: Python<'_>, caption: String) -> PyResult<String> {
        self.inner.change(py, move |inner| {
            let options = Options { views: vec![View::Side, View::Front], caption, anatomy: true, markers: inner.markers() };
            svg(&inner.context().snapshot(), &options)
        })
    }
}

impl Environment {
    /// The first observation, unless the episode could not begin.
    fn begun<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let inner = self.inner.get()?;
        match inner.ending() {
            Some(Ending::Fault(fault)) => {
                let EpisodeKey { seed, episode } = inner.key();
                Err(PyRuntimeError::new_err(format!("episode {episode} of seed {seed} cannot begin: {fault}")))
            }
            _ => Ok(arrays::row(py, inner.observation(), self.single)),
        }
    }
}
