//! Parameters that a caller sets for every episode, without compiling the task again.

use super::{CompiledTask, Parameter, Phase, TaskState};
use crate::nearest::nearest;
use crate::numbers::{distinguished, for_people};
use serde::{Deserialize, Serialize};

/// Why a parameter cannot have a value for an episode.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
pub enum ParameterError {
    /// No such parameter.
    #[error("the task `{task}` has no parameter `{name}`{}", suggestion(.known, .nearest))]
    Unknown {
        /// The task.
        task: String,
        /// As given.
        name: String,
        /// What may be set for every episode.
        known: Vec<String>,
        /// Which may have been meant.
        nearest: Option<String>,
    },
    /// It is part of what was compiled.
    #[error(
        "the parameter `{name}` is a constant of the compiled task: compile the task again with another value, or declare it `per episode`"
    )]
    Constant {
        /// Its name.
        name: String,
    },
    /// Its range does not have the value.
    #[error("the parameter `{name}` is {value}; expected {} from {low} to {high}, in SI units", if *.whole { "a whole number" } else { "a number" })]
    OutOfRange {
        /// Its name.
        name: String,
        /// What was given.
        value: String,
        /// Whether it is a whole number.
        whole: bool,
        /// Lowest.
        low: String,
        /// Highest.
        high: String,
    },
    /// Not one value for each parameter.
    #[error("there are {found} values of parameters; the task has {expected} parameters")]
    Count {
        /// Parameters of the task.
        expected: usize,
        /// Values given.
        found: usize,
    },
}

fn suggestion(known: &[String], nearest: &Option<String>) -> String {
    match (nearest, known) {
        (Some(near), _) => format!("; did you mean `{near}`?"),
        (None, []) => "; no parameter of it is declared `per episode`".into(),
        (None, known) => format!("; per episode it has {}", known.join(", ")),
    }
}

impl CompiledTask {
    /// The parameters that a caller may set for every episode, with their places.
    pub fn parameters_per_episode(&self) -> impl Iterator<Item = (usize, &Parameter)> {
        self.parameters.iter().enumerate().filter(|(_, parameter)| parameter.per_episode)
    }

    /// The place of a parameter that an episode may have of its own with this value, in SI units.
    ///
    /// # Errors
    /// No such parameter, one that is a constant of the compiled task, or a value outside of its range.
    pub fn check_parameter(&self, name: &str, value: f64) -> Result<usize, ParameterError> {
        let Some((place, parameter)) = self.parameters.iter().enumerate().find(|(_, parameter)| parameter.name == name) else {
            let known: Vec<String> = self.parameters_per_episode().map(|(_, parameter)| parameter.name.clone()).collect();
            let nearest = nearest(name, known.iter().map(String::as_str)).into_iter().next().map(str::to_owned);
            return Err(ParameterError::Unknown { task: self.name.clone(), name: name.to_owned(), known, nearest });
        };
        // The checker gives every parameter per episode a range.
        let Some([low, high]) = parameter.range.filter(|_| parameter.per_episode) else {
            return Err(ParameterError::Constant { name: name.to_owned() });
        };
        if (low..=high).contains(&value) && !(parameter.whole && value.fract() != 0.0) {
            return Ok(place);
        }
        let shown = if value.is_finite() { distinguished(&[low, high, value]) } else { [low, high, value].map(for_people) };
        let [low, high, value] = shown;
        Err(ParameterError::OutOfRange { name: name.to_owned(), value, whole: parameter.whole, low, high })
    }

    /// Whether values, one for each parameter or none, are those that an episode may have.
    ///
    /// # Errors
    /// A wrong number of them, another value of a constant, or one outside of its range.
    pub fn check_parameters(&self, values: &[f64]) -> Result<(), ParameterError> {
        let (expected, found) = (self.parameters.len(), values.len());
        if ![0, expected].contains(&found) {
            return Err(ParameterError::Count { expected, found });
        }
        let mut changed = self.parameters.iter().zip(values).filter(|(parameter, value)| parameter.value != **value);
        changed.try_for_each(|(parameter, value)| self.check_parameter(&parameter.name, *value).map(|_| ()))
    }

    /// The values of all parameters, in SI units and the order of [`CompiledTask::parameters`]: those that are given, or the task's.
    pub fn complete_parameters(&self, given: &[f64]) -> Vec<f64> {
        let value = |(place, parameter): (usize, &Parameter)| given.get(place).copied().unwrap_or(parameter.value);
        self.parameters.iter().enumerate().map(value).collect()
    }

    /// Sets a parameter among the `values` of an episode to come, which may be none yet.
    ///
    /// # Errors
    /// As [`check_parameter`](Self::check_parameter).
    pub fn set_parameter(&self, values: &mut Vec<f64>, name: &str, value: f64) -> Result<(), ParameterError> {
        let place = self.check_parameter(name, value)?;
        let mut complete = self.complete_parameters(values);
        complete[place] = value;
        *values = complete;
        Ok(())
    }

    /// What is kept of draws, with the parameters of the episode among them, of which a caller decides and not chance.
    pub(crate) fn with_parameters(&self, phase: &Phase, state: &TaskState, kept: &[(usize, Vec<f64>)]) -> Vec<(usize, Vec<f64>)> {
        let mut all = kept.to_vec();
        for (draw, &stream) in phase.streams.iter().enumerate() {
            let place = self.randoms.get(stream).and_then(|random| random.parameter);
            let Some(place) = place.filter(|_| !kept.iter().any(|(known, _)| *known == draw)) else { continue };
            let Some(parameter) = self.parameters.get(place) else { continue };
            all.push((draw, vec![state.parameters.get(place).copied().unwrap_or(parameter.value)]));
        }
        all
    }
}
