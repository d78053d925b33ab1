//! The simulator alone: models, one simulation, many side by side.

mod batch;
mod model;
mod simulation;

pub use batch::Batch;
pub use model::Model;
pub use simulation::Simulation;

use crate::arrays::numbers;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Steps between two looks at whether Ctrl-C was pressed.
const STEPS_AT_ONCE: usize = 50;

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
