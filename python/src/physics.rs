//! The simulator alone: models, one simulation, many side by side.

use crate::arrays::{self, numbers};
use crate::compilation::in_words;
use crate::guard::{Guarded, detached};
use crate::state;
use crate::workers::{Process, no_threads, threads};
use msk_physics::model::Model as PhysicsModel;
use msk_physics::{self as physics, Batch as PhysicsBatch, Fault, Plan, State, Workspace};
use msk_runtime::bodies;
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;

/// Steps between two looks at whether Ctrl-C was pressed.
const STEPS_AT_ONCE: usize = 50;

/// A compiled model: immutable, shared by all simulations of it.
#[pyclass(frozen, module = "msk.physics")]
pub struct Model {
    inner: Arc<PhysicsModel>,
    plan: Plan,
}

#[pymethods]
impl Model {
    /// Reads a model from MJCF text.
    #[staticmethod]
    fn from_mjcf(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::read(py, || PhysicsModel::from_mjcf(text))
    }

    /// Reads a model from an MJCF file.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::read(py, || bodies::model(&path))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    #[getter]
    fn nq(&self) -> usize {
        self.inner.nq
    }

    #[getter]
    fn nv(&self) -> usize {
        self.inner.nv
    }

    #[getter]
    fn na(&self) -> usize {
        self.inner.na
    }

    #[getter]
    fn nu(&self) -> usize {
        self.inner.actuators.name.len()
    }

    #[getter]
    fn timestep(&self) -> f64 {
        self.inner.options.timestep
    }

    #[getter]
    fn actuators(&self) -> Vec<String> {
        self.inner.actuators.name.clone()
    }

    #[getter]
    fn joints(&self) -> Vec<String> {
        self.inner.joints.name.clone()
    }

    #[getter]
    fn bodies(&self) -> Vec<String> {
        self.inner.bodies.name.clone()
    }

    fn __repr__(&self) -> String {
        let Self { inner, .. } = self;
        format!("<Model {}: nq={} nv={} na={} nu={}>", inner.name, inner.nq, inner.nv, inner.na, self.nu())
    }
}

impl Model {
    fn read<E: std::error::Error + Send>(
        py: Python<'_>,
        read: impl FnOnce() -> Result<PhysicsModel, E> + Send,
    ) -> PyResult<Self> {
        let inner = detached(py, read)?.map_err(|error| PyValueError::new_err(in_words(&error)))?;
        let plan = Plan::new(&inner);
        Ok(Self { inner: Arc::new(inner), plan })
    }
}

/// A model with its state, and what was computed from it last.
#[pyclass(module = "msk.physics")]
pub struct Simulation {
    model: Py<Model>,
    inner: Guarded<(State<f64>, Workspace<f64>)>,
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(py: Python<'_>, model: Py<Model>) -> PyResult<Self> {
        let Model { inner, plan } = model.get();
        let inner = Guarded::new(detached(py, || (State::new(inner), Workspace::of(inner, plan)))?);
        Ok(Self { model, inner })
    }

    /// Takes `count` steps of the model's timestep.
    #[pyo3(signature = (count = 1))]
    fn step(&mut self, py: Python<'_>, count: usize) -> PyResult<()> {
        let model = Arc::clone(&self.model.get().inner);
        in_portions(py, count, |steps| {
            let model = &*model;
            self.inner
                .change(py, move |(state, workspace)| (0..steps).try_for_each(|_| physics::step(model, state, workspace)))?
                .map_err(|fault| fault_error(&fault))
        })
    }

    /// Computes everything from positions to accelerations, without advancing time.
    fn forward(&mut self, py: Python<'_>) -> PyResult<()> {
        let model = Arc::clone(&self.model.get().inner);
        self.inner
            .change(py, move |(state, workspace)| physics::forward(&model, state, workspace))?
            .map_err(|fault| fault_error(&fault))
    }

    /// Puts everything back to the reference configuration at rest.
    fn reset(&mut self, py: Python<'_>) -> PyResult<()> {
        let model = Arc::clone(&self.model.get().inner);
        self.inner.change(py, move |(state, _)| *state = State::new(&model))
    }

    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        state::arrays(py, &self.inner.get()?.0)
    }

    fn set_state(&mut self, arrays: &Bound<'_, PyDict>) -> PyResult<()> {
        let (state, _) = self.inner.get_mut()?;
        *state = state::replaced(state, arrays, &self.model.get().inner)?;
        Ok(())
    }

    /// Sets the controls, one per actuator.
    fn set_control(&mut self, control: &Bound<'_, PyAny>) -> PyResult<()> {
        let (state, _) = self.inner.get_mut()?;
        state.control = controls(control, &[state.control.len()])?;
        Ok(())
    }

    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.inner.get()?.0.time)
    }

    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }
}

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
        state::arrays(py, &self.present(index)?)
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

/// Does so many steps in portions, after each of which Ctrl-C is heard.
fn in_portions(py: Python<'_>, count: usize, mut work: impl FnMut(usize) -> PyResult<()>) -> PyResult<()> {
    let mut left = count;
    while left > 0 {
        let portion = left.min(STEPS_AT_ONCE);
        work(portion)?;
        left -= portion;
        py.check_signals()?;
    }
    Ok(())
}

fn controls(given: &Bound<'_, PyAny>, shape: &[usize]) -> PyResult<Vec<f64>> {
    let values = numbers(given, shape, "a control")?;
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(PyValueError::new_err(format!("control {index} is {}: expected a finite number", values[index]))),
        None => Ok(values),
    }
}

fn pool(workers: usize) -> PyResult<Arc<ThreadPool>> {
    ThreadPoolBuilder::new().num_threads(workers).build().map(Arc::new).map_err(|error| no_threads(&error))
}

fn fault_error(fault: &Fault) -> PyErr {
    PyRuntimeError::new_err(fault.to_string())
}
