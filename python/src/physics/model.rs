//! Models.

use crate::guard::detached;
use msk_physics::Plan;
use msk_physics::model::Model as PhysicsModel;
use msk_runtime::bodies;
use msk_runtime::library::in_words;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A compiled model: immutable, shared by all simulations of it.
#[pyclass(frozen, module = "msk.physics")]
pub struct Model {
    pub(super) inner: Arc<PhysicsModel>,
    pub(super) plan: Plan,
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
    pub(super) fn nu(&self) -> usize {
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
