//! Many simulations side by side.

use super::{Model, controls, in_portions};
use crate::arrays;
use crate::guard::{Guarded, detached};
use crate::state;
use crate::workers::{Process, no_threads, threads};
use msk_physics::{Batch as PhysicsBatch, Fault, State};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;

/// Simulations of one model, stepped together in the lanes of the processor, on threads of their own.
#[pyclass(frozen, module = "msk.physics")]
pub struct Batch {
    model: Py<Model>,
    inner: Guarded<(PhysicsBatch, ThreadPool)>,
    process: Process,
    count: usize,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (model, count, threads = None))]
    fn new(py: Python<'_>, model: Py<Model>, count: NonZeroUsize, threads: Option<NonZeroUsize>) -> PyResult<Self> {
        let (workers, count) = (self::threads(threads).get(), count.get());
        let inner = &model.get().inner;
        let batch = detached(py, || PhysicsBatch::new(inner, count).with_workers(workers))?;
        Ok(Self { model, inner: Guarded::new((batch, pool(workers)?)), process: Process::present(), count })
    }

    /// Takes `steps` steps in every simulation without a fault.
    #[pyo3(signature = (steps = 1))]
    fn step(&self, py: Python<'_>, steps: usize) -> PyResult<()> {
        let mut inner = self.inner.get_mut()?;
        if self.process.has_changed() {
            let fresh = pool(inner.1.current_num_threads())?;
            // Dropping the old pool would lock what one of its threads may have held when the process was forked.
            std::mem::forget(std::mem::replace(&mut inner.1, fresh));
        }
        drop(inner);
        in_portions(py, steps, |steps| {
            self.inner.change(py, move |(batch, pool)| pool.install(|| (0..steps).for_each(|_| batch.step())))
        })
    }

    fn state<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        state::arrays(py, &self.present(index)?, &self.model.get().inner)
    }

    fn set_state(&self, index: usize, arrays: &Bound<'_, PyDict>) -> PyResult<()> {
        let fresh = state::replaced(&self.present(index)?, arrays, &self.model.get().inner)?;
        self.inner.get_mut()?.0.set(index, &fresh).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Sets the controls of all simulations, one row each.
    fn set_control(&self, control: &Bound<'_, PyAny>) -> PyResult<()> {
        let width = self.model.get().nu();
        let rows = controls(control, &[self.count, width])?;
        let mut inner = self.inner.get_mut()?;
        for (index, row) in rows.chunks_exact(width.max(1)).enumerate() {
            inner.0.set_control(index, row).map_err(|error| PyValueError::new_err(error.to_string()))?;
        }
        Ok(())
    }

    /// The positions of all simulations, one row each.
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |state| &state.position)
    }

    /// The velocities of all simulations, one row each.
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |state| &state.velocity)
    }

    /// Why a simulation is not stepped any more; None if it is.
    fn fault(&self, index: usize) -> PyResult<Option<String>> {
        Ok(self.inner.get()?.0.fault(index).map(Fault::to_string))
    }

    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    fn __len__(&self) -> usize {
        self.count
    }
}

impl Batch {
    fn present(&self, index: usize) -> PyResult<State<f64>> {
        let mut state = State::new(&self.model.get().inner);
        self.inner.get()?.0.get(index, &mut state).map_err(|error| PyIndexError::new_err(error.to_string()))?;
        Ok(state)
    }

    fn rows<'py>(&self, py: Python<'py>, part: impl Fn(&State<f64>) -> &Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        let (mut rows, mut width) = (Vec::new(), 0);
        for index in 0..self.count {
            let state = self.present(index)?;
            width = part(&state).len();
            rows.extend_from_slice(part(&state));
        }
        arrays::table(py, &rows, [self.count, width], false)
    }
}

fn pool(workers: usize) -> PyResult<ThreadPool> {
    ThreadPoolBuilder::new().num_threads(workers).build().map_err(|error| no_threads(&error))
}
