//! A compiled task on its body.

use crate::guard::detached;
use msk_compiler::explain::{self, Options};
use msk_program::numbers::for_people;
use msk_program::task::{Channel, CompiledTask, Origin, Parameter};
use msk_program::weights::{Bounds, Schedule};
use msk_runtime::episode::{Engine, Environment, EpisodeError};
use msk_runtime::library::BoundBody;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A compiled task on its body: immutable, and shared by all its environments.
#[pyclass(frozen, module = "msk._native")]
pub struct Task {
    engine: Engine,
    body: BoundBody,
    actions: Vec<String>,
}

/// (name, weight, lowest, highest, formula) of a term.
type TermData = (String, f64, Option<f64>, Option<f64>, String, Option<(f64, f64, f64)>);

/// Of a parameter: see [`Task::parameters`].
type ParameterData = (String, f64, String, Option<(f64, f64)>, bool);

impl Task {
    /// Parameters of an episode in SI units, which are given in the units in which they are written.
    pub fn checked_parameters(&self, values: Vec<(String, f64)>) -> PyResult<Vec<(String, f64)>> {
        let checked = |(name, value): (String, f64)| {
            let known = self.task().parameters.iter().find(|known| known.name == name);
            let value = known.map_or(value, |known| value * known.scale);
            self.task().check_parameter(&name, value).map_err(|error| PyValueError::new_err(error.to_string()))?;
            Ok((name, value))
        };
        values.into_iter().map(checked).collect()
    }

    /// The task on its body.
    ///
    /// # Errors
    /// A body that does not fit, or a control step that is not a whole number of physics steps.
    pub fn new(task: Arc<CompiledTask>, body: BoundBody) -> Result<Self, EpisodeError> {
        let engine = Engine::new(Arc::clone(&body.model), Arc::clone(&body.body), task)?;
        let actions = engine.task().action.names(&engine.task().vocabulary);
        Ok(Self { engine, body, actions })
    }

    /// What its episodes are played with.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The names of the entries of an action.
    pub fn action_names(&self) -> &[String] {
        &self.actions
    }

    fn task(&self) -> &CompiledTask {
        self.engine.task()
    }

    /// The value at `index`, if the author of the task allows it as a weight.
    ///
    /// # Errors
    /// `ValueError`: what it may be instead.
    pub fn check_weight(&self, index: usize, value: f64) -> PyResult<()> {
        self.task().check_weight(index, value).map_err(|problem| PyValueError::new_err(problem.to_string()))
    }
}

#[pymethods]
impl Task {
    #[getter]
    fn name(&self) -> &str {
        &self.task().name
    }

    #[getter]
    fn family(&self) -> &str {
        &self.task().family
    }

    #[getter]
    fn summary(&self) -> &str {
        &self.task().summary
    }

    #[getter]
    fn hash(&self) -> &str {
        &self.task().hash
    }

    #[getter]
    pub fn body_hash(&self) -> &str {
        self.body.hash()
    }

    #[getter]
    fn control_frequency(&self) -> f64 {
        self.task().control_frequency
    }

    #[getter]
    fn timestep(&self) -> f64 {
        self.engine.model().options.timestep
    }

    #[getter]
    fn horizon(&self) -> u32 {
        self.task().horizon
    }

    #[getter]
    fn observation_size(&self) -> usize {
        self.task().observation_size()
    }

    #[getter]
    fn muscles(&self) -> Vec<String> {
        self.engine.body().muscles.iter().map(|muscle| muscle.name.clone()).collect()
    }

    /// The names of the entries of an action.
    #[getter]
    fn actions(&self) -> Vec<String> {
        self.actions.clone()
    }

    /// The entry of an action that asks for rest.
    #[getter]
    fn rest(&self) -> f64 {
        self.task().action.rest()
    }

    /// (name, offset, size, unit) of each part of the observation.
    #[getter]
    fn channels(&self) -> Vec<(String, usize, usize, String)> {
        parts(&self.task().channels)
    }

    /// (name, offset, size, unit) of each part of what only a critic sees.
    #[getter]
    fn critic(&self) -> Vec<(String, usize, usize, String)> {
        parts(&self.task().critic)
    }

    /// (name, offset, size, unit) of each metric.
    #[getter]
    fn metrics(&self) -> Vec<(String, usize, usize, String)> {
        parts(&self.task().metrics)
    }

    /// (name, weight, lowest, highest, formula, schedule) of each term; no bounds where the weight is free, equal ones where it is fixed;
    /// the schedule is (first weight, begin, end).
    #[getter]
    fn terms(&self) -> Vec<TermData> {
        let bounds = |index: usize, weight: f64| match self.task().weight_bounds(index) {
            Bounds::Fixed => (Some(weight), Some(weight)),
            Bounds::Range(low, high) => (Some(low), Some(high)),
            Bounds::Free => (None, None),
        };
        let terms = self.task().terms.iter().enumerate();
        let described = terms.map(|(index, term)| {
            let (low, high) = bounds(index, term.written);
            let schedule = term.schedule.map(|Schedule { from, begin, end }| (from, begin, end));
            (term.name.clone(), term.weight, low, high, term.source.clone(), schedule)
        });
        described.collect()
    }

    #[getter]
    fn terminations(&self) -> Vec<String> {
        self.task().terminations.clone()
    }

    #[getter]
    fn finishes(&self) -> Vec<String> {
        self.task().finishes.clone()
    }

    /// After which of the finishes a learner values what would have followed.
    #[getter]
    fn bootstraps(&self) -> Vec<bool> {
        self.task().bootstraps.clone()
    }

    /// (name, value in SI units, unit, lowest and highest value in SI units, whether it may be set for every episode) of each parameter.
    #[getter]
    fn parameters(&self) -> Vec<ParameterData> {
        let described = |parameter: &Parameter| {
            let Parameter { name, value, unit, range, per_episode, .. } = parameter.clone();
            (name, value, unit, range.map(|[low, high]| (low, high)), per_episode)
        };
        self.task().parameters.iter().map(described).collect()
    }

    /// The same task with other weights.
    fn reweighted(&self, weights: &Bound<'_, PyDict>, origin: String) -> PyResult<Self> {
        let mut chosen = Vec::new();
        for (name, value) in weights {
            let name: String = name.extract()?;
            let index = self.task().find_term(&name).map_err(|problem| PyKeyError::new_err(problem.to_string()))?;
            chosen.push((index, value.extract()?));
        }
        let task = self.task().reweighted(&chosen, &Origin::Overlay(origin));
        let task = task.map_err(|refused| PyValueError::new_err(refused.to_string()))?;
        Self::new(Arc::new(task), self.body.clone()).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// What the compiler understood of the task, as `text`, `json`, `html` or `latex`.
    fn explain(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let engine = self.engine.clone();
        let write: fn(&CompiledTask, &Options<'_>) -> String = match format {
            "text" => |task, options| explain::text(task, options),
            "json" => |task, options| serde_json::json!(explain::task_report(task, options)).to_string(),
            "html" => |task, options| explain::html(&task.name.replace('_', " "), &[explain::task_report(task, options)]),
            "latex" => |task, options| explain::latex(&[explain::task_report(task, options)]),
            other => {
                let known = "text, json, html, latex";
                return Err(PyValueError::new_err(format!("there is no format `{other}`; there are: {known}")));
            }
        };
        detached(py, move || {
            let environment = Environment::of(engine);
            write(environment.task(), &Options { reset: Some(environment.frame()) })
        })
    }

    /// The task as a module over MuJoCo's model and data: files by name.
    fn export(&self, py: Python<'_>) -> PyResult<BTreeMap<String, String>> {
        let engine = self.engine.clone();
        let exported = detached(py, move || msk_export::python(engine.task(), engine.body(), engine.model()))?;
        let exported = exported.map_err(|refused| PyValueError::new_err(refused.to_string()))?;
        Ok(exported.files().into_iter().map(|(name, text)| (name, text.to_owned())).collect())
    }

    fn __repr__(&self) -> String {
        let task = self.task();
        format!("<Task {}: {} steps at {} Hz>", task.name, task.horizon, for_people(task.control_frequency))
    }
}

fn parts(channels: &[Channel]) -> Vec<(String, usize, usize, String)> {
    channels.iter().map(|part| (part.name.clone(), part.offset, part.size, part.unit.clone())).collect()
}
