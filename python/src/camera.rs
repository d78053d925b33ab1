//! Pictures of episodes.

use crate::guard::{Guarded, detached};
use crate::snapshot::Snapshot;
use crate::task::Task;
use msk_runtime::episode::{Environment, Episode};
use msk_view::render::{Colouring, Options, Picture, PictureError, Renderer, View};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Draws the episodes of a task. It starts no thread.
#[pyclass(frozen, module = "msk._native")]
pub struct Camera {
    task: Py<Task>,
    inner: Guarded<Inner>,
}

struct Inner {
    /// Where episodes are looked at: it is never stepped.
    environment: Environment,
    /// One for each slot.
    renderers: Vec<Renderer>,
    options: Options,
}

#[pymethods]
impl Camera {
    /// Pictures of so many pixels, from a view of that name.
    #[new]
    fn new(py: Python<'_>, task: Py<Task>, width: u32, height: u32, view: &str) -> PyResult<Self> {
        let found = View::NAMED.iter().find(|(name, _)| *name == view).map(|(_, view)| *view);
        let view = found.ok_or_else(|| {
            let known: Vec<&str> = View::NAMED.iter().map(|(name, _)| *name).collect();
            PyValueError::new_err(format!("there is no camera `{view}`; there are: {}", known.join(", ")))
        })?;
        let options = Options { width, height, view, labels: false, ..Options::default() };
        options.check().map_err(|error| PyValueError::new_err(error.to_string()))?;
        let engine = task.get().engine().clone();
        let environment = detached(py, move || Environment::of(engine))?;
        let inner = Guarded::new(Inner { environment, renderers: Vec::new(), options });
        Ok(Self { task, inner })
    }

    /// The episodes of a snapshot, one picture for each slot: arrays of shape (height, width, 3), uint8.
    fn render<'py>(&self, py: Python<'py>, snapshot: &Snapshot) -> PyResult<Vec<Bound<'py, PyArray3<u8>>>> {
        snapshot.check(self.task.get(), snapshot.slots.len())?;
        let pictures = self.inner.change(py, |inner| {
            let slots = snapshot.slots.iter().enumerate();
            slots.map(|(slot, (episode, _))| inner.picture(slot, episode)).collect::<Result<Vec<_>, _>>()
        })?;
        let array = |picture: Picture| {
            let shape = [picture.height() as usize, picture.width() as usize, 3];
            PyArray1::from_vec(py, picture.into_bytes()).reshape(shape)
        };
        pictures.map_err(|error| PyValueError::new_err(error.to_string()))?.into_iter().map(array).collect()
    }
}

impl Inner {
    fn picture(&mut self, slot: usize, episode: &Episode) -> Result<Picture, PictureError> {
        self.environment.restore(episode);
        while self.renderers.len() <= slot {
            self.renderers.push(Renderer::new(&self.environment, &[], Colouring::Activation));
        }
        self.renderers[slot].scene(&self.environment).render(&self.options)
    }
}
