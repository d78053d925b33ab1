//! NumPy arrays in and out: checked, and written once.

use msk_runtime::episode::single_precision;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// Numbers of an array of the given shape, float32 or float64; `what` names them in errors, with their article.
///
/// # Errors
/// `TypeError` for anything but an array of floats, `ValueError` for another shape.
pub fn numbers(given: &Bound<'_, PyAny>, shape: &[usize], what: &str) -> PyResult<Vec<f64>> {
    let Ok(array) = given.cast::<PyUntypedArray>() else {
        let found = given.get_type().name()?;
        return Err(PyTypeError::new_err(format!(
            "{what} must be a NumPy array of shape {}, found {found}: convert it with numpy.asarray(..., dtype=numpy.float32)",
            tuple(shape)
        )));
    };
    if array.shape() != shape {
        let found = tuple(array.shape());
        return Err(PyValueError::new_err(format!("{what} must have the shape {}, found {found}", tuple(shape))));
    }
    if let Ok(array) = given.cast::<PyArrayDyn<f32>>() {
        return Ok(array.try_readonly()?.as_array().iter().map(|&number| f64::from(number)).collect());
    }
    if let Ok(array) = given.cast::<PyArrayDyn<f64>>() {
        return Ok(array.try_readonly()?.as_array().iter().copied().collect());
    }
    let found = array.dtype().typeobj().name()?.to_string();
    Err(PyTypeError::new_err(format!(
        "{what} must have the dtype float32 or float64, found {found}: convert it with .astype(numpy.float32)"
    )))
}

/// A shape as Python writes it.
fn tuple(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        several => format!("({})", several.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// What is done with an action outside of [-1, 1].
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum OutOfRange {
    /// It is an error.
    Reject,
    /// It is clipped.
    Clip,
}

/// Actions, entries in [-1, 1] with the given names: of shape (entries,), or (slots, entries) if there are several.
///
/// # Errors
/// Those of [`numbers`], and `ValueError` for what is not a number or lies outside.
pub fn actions(given: &Bound<'_, PyAny>, slots: Option<usize>, names: &[String], rule: OutOfRange) -> PyResult<Vec<f64>> {
    let shape = [slots.unwrap_or(1), names.len()];
    let shape = if slots.is_some() { &shape[..] } else { &shape[1..] };
    let mut actions = numbers(given, shape, "an action")?;
    for (index, action) in actions.iter_mut().enumerate() {
        if (-1.0..=1.0).contains(action) {
            continue;
        }
        if action.is_nan() || rule == OutOfRange::Reject {
            let (slot, entry) = (index / names.len(), index % names.len());
            let place = if slots.is_some() { format!("[{slot}, {entry}]") } else { format!("[{entry}]") };
            let hint = match action.is_nan() {
                true => "the policy that computed it has diverged",
                false => "clip it (numpy.clip, gymnasium.wrappers.ClipAction), or make the environment with clip_actions=True",
            };
            let name = &names[entry];
            return Err(PyValueError::new_err(format!("action{place}, of `{name}`, is {action}, not in [-1, 1]: {hint}")));
        }
        *action = if *action < 0.0 { -1.0 } else { 1.0 };
    }
    Ok(actions)
}

/// The numbers as an array of one dimension, float32 if `single`, else float64.
pub fn row<'py>(py: Python<'py>, values: &[f64], single: bool) -> Bound<'py, PyAny> {
    match single {
        true => values.iter().map(|&value| single_precision(value)).collect::<Vec<f32>>().into_pyarray(py).into_any(),
        false => PyArray1::from_slice(py, values).into_any(),
    }
}

/// Rows as an array of two dimensions, of the shape (rows, width), float32 if `single`, else float64.
///
/// # Errors
/// Another number of values than the shape has.
pub fn table<'py>(py: Python<'py>, values: &[f64], shape: [usize; 2], single: bool) -> PyResult<Bound<'py, PyAny>> {
    if shape[0] * shape[1] != values.len() {
        return Err(PyValueError::new_err(format!("{} values do not have the shape {}", values.len(), tuple(&shape))));
    }
    if single {
        let array = PyArray2::<f32>::zeros(py, shape, false);
        for (out, &value) in array.try_readwrite()?.as_slice_mut()?.iter_mut().zip(values) {
            *out = single_precision(value);
        }
        return Ok(array.into_any());
    }
    let array = PyArray2::<f64>::zeros(py, shape, false);
    array.try_readwrite()?.as_slice_mut()?.copy_from_slice(values);
    Ok(array.into_any())
}
