//! The physical state as named arrays: MuJoCo's names, shapes and units.

use crate::arrays::numbers;
use msk_physics::State;
use msk_physics::model::Model;
use msk_runtime::inspect::StateFile;
use numpy::PyArray1;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The lists of a state file, by name.
fn lists(file: &mut StateFile) -> [(&'static str, &mut Option<Vec<f64>>); 17] {
    [
        ("qpos", &mut file.qpos),
        ("qvel", &mut file.qvel),
        ("act", &mut file.act),
        ("ctrl", &mut file.ctrl),
        ("fibre_length", &mut file.fibre_length),
        ("fibre_velocity", &mut file.fibre_velocity),
        ("qfrc_applied", &mut file.qfrc_applied),
        ("xfrc_applied", &mut file.xfrc_applied),
        ("qacc_warmstart", &mut file.qacc_warmstart),
        ("mocap_pos", &mut file.mocap_pos),
        ("mocap_quat", &mut file.mocap_quat),
        ("mocap_vel", &mut file.mocap_vel),
        ("strength", &mut file.strength),
        ("mass_scale", &mut file.mass_scale),
        ("friction", &mut file.friction),
        ("damping", &mut file.damping),
        ("stiffness", &mut file.stiffness),
    ]
}

/// All of a state, with the forces that act from outside.
fn file(state: &State<f64>, model: &Model) -> StateFile {
    let wrench = |forces: &[_; 2]| forces.iter().flatten().copied().collect::<Vec<f64>>();
    StateFile {
        qfrc_applied: Some(state.applied_force.clone()),
        xfrc_applied: Some(state.body_force.iter().flat_map(wrench).collect()),
        strength: Some(state.strength.clone()),
        mass_scale: Some(state.mass_scale.clone()),
        friction: Some(state.friction.clone()),
        damping: Some(state.damping.clone()),
        stiffness: Some(state.stiffness.clone()),
        ..StateFile::of(model, state)
    }
}

/// All arrays of a state, copied.
///
/// # Errors
/// Those of the interpreter.
pub fn arrays<'py>(py: Python<'py>, state: &State<f64>, model: &Model) -> PyResult<Bound<'py, PyDict>> {
    let mut file = file(state, model);
    let arrays = PyDict::new(py);
    arrays.set_item("time", state.time)?;
    for (name, list) in lists(&mut file) {
        arrays.set_item(name, PyArray1::from_vec(py, list.take().unwrap_or_default()))?;
    }
    arrays.set_item("eq_active", PyArray1::from_vec(py, file.eq_active.unwrap_or_default()))?;
    Ok(arrays)
}

/// The state with some of its arrays replaced.
///
/// # Errors
/// An unknown name, another shape, what is not a finite number, or a quaternion of length zero.
pub fn replaced(state: &State<f64>, given: &Bound<'_, PyDict>, model: &Model) -> PyResult<State<f64>> {
    let mut file = file(state, model);
    for (name, value) in given {
        let name: String = name.extract()?;
        match name.as_str() {
            "time" => file.time = Some(finite(&[value.extract()?], "the `time` of a state")?[0]),
            "eq_active" => file.eq_active = Some(value.extract()?),
            _ => {
                let mut lists = lists(&mut file);
                let Some((_, list)) = lists.iter_mut().find(|(known, _)| *known == name) else {
                    let known = lists.map(|(name, _)| name).join(", ");
                    return Err(PyKeyError::new_err(format!("a state has no `{name}`; it has: time, {known}, eq_active")));
                };
                let what = format!("the `{name}` of a state");
                let values = numbers(&value, &[list.as_ref().map_or(0, Vec::len)], &what)?;
                finite(&values, &what)?;
                **list = Some(values);
            }
        }
    }
    let mut fresh = file.state(model).map_err(|error| PyValueError::new_err(error.to_string()))?;
    // What is held as it stands keeps its place.
    fresh.held.clone_from(&state.held);
    fresh.fibre_step = state.fibre_step;
    Ok(fresh)
}

fn finite<'a>(values: &'a [f64], what: &str) -> PyResult<&'a [f64]> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(PyValueError::new_err(format!("{what} has {} at {index}: expected a finite number", values[index]))),
        None => Ok(values),
    }
}
