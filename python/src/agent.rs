//! What `msk train` made, as something that acts.

use crate::arrays;
use crate::guard::detached;
use crate::task::Task;
use msk_network::{Kernel, Processor, Tape};
use msk_physics::scalar::Real;
use msk_train::{Agents, Unfit};
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;

/// An agent, and the task on which it acts.
#[pyclass(frozen, module = "msk._native")]
pub struct Agent {
    agent: Arc<msk_train::Agent>,
    kernel: Arc<dyn Kernel>,
}

impl Agent {
    fn new(agent: Arc<msk_train::Agent>) -> PyResult<Self> {
        let kernel = Processor::new(NonZeroUsize::MIN).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        Ok(Self { agent, kernel: Arc::new(kernel) })
    }
}

#[pymethods]
impl Agent {
    /// Of a folder; `any_task` allows a task or body that only means something else.
    #[new]
    fn read(folder: PathBuf, task: &Task, any_task: bool) -> PyResult<Self> {
        let agent = msk_train::Agent::read(&folder).map_err(|error| PyValueError::new_err(error.to_string()))?;
        match agent.unfit(task.engine()) {
            Some(Unfit::Meaning(_)) if any_task => {}
            Some(Unfit::Meaning(reason)) => {
                return Err(PyValueError::new_err(format!("{reason}; any_task=True uses it nevertheless")));
            }
            Some(Unfit::Numbers(reason)) => return Err(PyValueError::new_err(reason)),
            None => {}
        }
        Self::new(Arc::new(agent))
    }

    /// The one that comes with the program.
    #[staticmethod]
    fn built_in(task: &Task) -> PyResult<Self> {
        let agents = Agents::built_in().map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        Self::new(agents.best(task.engine()).map_err(PyValueError::new_err)?)
    }

    /// (task, algorithm, seed, control steps, control steps that an action lasts for).
    fn description(&self) -> (String, String, u64, u64, u32) {
        let known = &self.agent.description;
        (known.task.clone(), known.algorithm.clone(), known.seed, known.steps, known.action_repeat)
    }

    /// Actions within [-1, 1], one for each observation.
    fn act<'py>(&self, py: Python<'py>, observations: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (seen, entries) = self.agent.lengths();
        let rows = observations.cast::<PyUntypedArray>().ok().filter(|array| array.ndim() == 2).map(|array| array.shape()[0]);
        let shape = [rows.unwrap_or(1), seen];
        let shape = if rows.is_some() { &shape[..] } else { &shape[1..] };
        let values = arrays::numbers(observations, shape, "an observation")?;
        let actions = detached(py, || {
            let mut actions = vec![0.0; rows.unwrap_or(1) * entries];
            self.agent.actor().act(&mut Tape::new(self.kernel.clone()), &values, &mut actions);
            // As episodes clip them.
            actions.iter_mut().for_each(|action| *action = action.clip(-1.0, 1.0));
            actions
        })?;
        match rows {
            Some(rows) => arrays::table(py, &actions, [rows, entries], true),
            None => Ok(arrays::row(py, &actions, true)),
        }
    }
}
