//! One simulation.

use super::{Model, controls, in_portions};
use crate::guard::{Guarded, detached};
use crate::state;
use msk_physics::{self as physics, Fault, State, Workspace};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// A model with its state, and what was computed from it last.
#[pyclass(frozen, module = "msk.physics")]
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
    fn step(&self, py: Python<'_>, count: usize) -> PyResult<()> {
        let model = Arc::clone(&self.model.get().inner);
        in_portions(py, count, |steps| {
            let model = &*model;
            self.inner
                .change(py, move |(state, workspace)| (0..steps).try_for_each(|_| physics::step(model, state, workspace)))?
                .map_err(|fault| fault_error(&fault))
        })
    }

    /// Computes everything from positions to accelerations, without advancing time.
    fn forward(&self, py: Python<'_>) -> PyResult<()> {
        let model = Arc::clone(&self.model.get().inner);
        self.inner
            .change(py, move |(state, workspace)| physics::forward(&model, state, workspace))?
            .map_err(|fault| fault_error(&fault))
    }

    /// Puts everything back to the reference configuration at rest.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        let model = Arc::clone(&self.model.get().inner);
        self.inner.change(py, move |(state, _)| *state = State::new(&model))
    }

    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        state::arrays(py, &self.inner.get()?.0, &self.model.get().inner)
    }

    fn set_state(&self, arrays: &Bound<'_, PyDict>) -> PyResult<()> {
        let mut inner = self.inner.get_mut()?;
        inner.0 = state::replaced(&inner.0, arrays, &self.model.get().inner)?;
        Ok(())
    }

    /// Sets the controls, one per actuator.
    fn set_control(&self, control: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut inner = self.inner.get_mut()?;
        inner.0.control = controls(control, &[inner.0.control.len()])?;
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

fn fault_error(fault: &Fault) -> PyErr {
    PyRuntimeError::new_err(fault.to_string())
}
