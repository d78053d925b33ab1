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
use std::sync::Arc;

/// Simulations of one model, stepped together in the lanes of the processor, on threads of their own.
#[pyclass(module = "msk.physics")]
pub struct Batch {
    model: Py<Model>,
    inner: Guarded<PhysicsBatch>,
    pool: Arc<ThreadPool>,
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
        let inner = Guarded::new(detached(py, || PhysicsBatch::new(inner, count).with_workers(workers))?);
        Ok(Self { model, inner, pool: pool(workers)?, process: Process::present(), count })
    }

    /// Takes `steps` steps in every simulation without a fault.
    #[pyo3(signature = (steps = 1))]
    fn step(&mut self, py: Python<'_>, steps: usize) -> PyResult<()> {
        if self.process.has_changed() {
            let fresh = pool(self.pool.current_num_threads())?;
            // Dropping the old pool would lock what one of its threads may have held when the process was forked.
            std::mem::forget(std::mem::replace(&mut self.pool, fresh));
        }
        let pool = Arc::clone(&self.pool);
        in_portions(py, steps, |steps| {
            let pool = &pool;
            self.inner.change(py, move |batch| pool.install(|| (0..steps).for_each(|_| batch.step())))
        })
    }

    fn state<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        state::arrays(py, &self.present(index)?, &self.model.get().inner)
    }

    fn set_state(&mut self, index: usize, arrays: &Bound<'_, PyDict>) -> PyResult<()> {
        let fresh = state::replaced(&self.present(index)?, arrays, &self.model.get().inner)?;
        self.inner.get_mut()?.set(index, &fresh).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Sets the controls of all simulations, one row each.
    fn set_control(&mut self, control: &Bound<'_, PyAny>) -> PyResult<()> {
        let width = self.model.get().nu();
        let rows = controls(control, &[self.count, width])?;
        let inner = self.inner.get_mut()?;
        for (index, row) in rows.chunks_exact(width.max(1)).enumerate() {
            inner.set_control(index, row).map_err(|error| PyValueError::new_err(error.to_string()))?;
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
        Ok(self.inner.get()?.fault(index).map(Fault::to_string))
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
        self.inner.get()?.get(index, &mut state).map_err(|error| PyIndexError::new_err(error.to_string()))?;
        Ok(state)
    }

    fn rows<'py>(&self, py: Python<'py>, part: impl Fn(&State<f64>) -> &Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        let (mut rows, mut width) = (Vec::new(), 0);
        for index in 0..self.count {
            let state = self.present(index)?;
            width = part(&state).len();
            rows.extend_from_slice(part(&state));
        }
        arrays::table(py, &rows, width, false)
    }
}

fn pool(workers: usize) -> PyResult<Arc<ThreadPool>> {
    ThreadPoolBuilder::new().num_threads(workers).build().map(Arc::new).map_err(|error| no_threads(&error))
}
