//! An action as text.

use serde_json::Value;

/// Why a text is no action.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ActionError {
    /// Not JSON.
    #[error("the action is not JSON: {0}")]
    Json(String),
    /// Something else than a list.
    #[error("expected a list of {expected} numbers, found {found}")]
    Kind {
        /// Entries of the action space.
        expected: usize,
        /// What it is.
        found: &'static str,
    },
    /// A list of another length.
    #[error("expected {expected} entries, found {found}")]
    Length {
        /// Entries of the action space.
        expected: usize,
        /// As it is.
        found: usize,
    },
    /// An entry that is no number.
    #[error("entry {index} (from 0), `{name}`, is {found}, expected a number from -1 to 1")]
    Entry {
        /// The first such entry.
        index: usize,
        /// Its name.
        name: String,
        /// What it is.
        found: String,
    },
}

/// Reads a list of numbers from -1 to 1, one for each name.
///
/// # Errors
/// Anything else; the first entry that is wrong is named.
pub fn read_action(text: &str, names: &[String]) -> Result<Vec<f64>, ActionError> {
    let value: Value = serde_json::from_str(text).map_err(|error| ActionError::Json(error.to_string()))?;
    let Value::Array(entries) = value else {
        return Err(ActionError::Kind { expected: names.len(), found: kind(&value) });
    };
    if entries.len() != names.len() {
        return Err(ActionError::Length { expected: names.len(), found: entries.len() });
    }
    let entry = |(index, entry): (usize, &Value)| {
        let number = entry.as_f64().filter(|number| (-1.0..=1.0).contains(number));
        number.ok_or_else(|| {
            let found: String = match entry {
                Value::Number(number) => number.to_string(),
                other => kind(other).to_owned(),
            };
            ActionError::Entry { index, name: names[index].clone(), found }
        })
    };
    entries.iter().enumerate().map(entry).collect()
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a truth value",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_are_accepted_as_they_are_or_rejected() {
        let names = ["a", "b", "c"].map(String::from);
        let read = |text: &str| read_action(text, &names);
        assert_eq!(read("[-1, 0.25, 1]"), Ok(vec![-1.0, 0.25, 1.0]));
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(message("{\"action\": [0, 0, 0]}"), "expected a list of 3 numbers, found an object");
        assert_eq!(message("[0, 0]"), "expected 3 entries, found 2");
        assert_eq!(message("[0, true, 2]"), "entry 1 (from 0), `b`, is a truth value, expected a number from -1 to 1");
        assert_eq!(message("[0, 0, 1.0000001]"), "entry 2 (from 0), `c`, is 1.0000001, expected a number from -1 to 1");
        assert!(message("[0, NaN, 0]").starts_with("the action is not JSON"));
        assert!(message("[0, 1e999, 0]").starts_with("the action is not JSON"));
    }
}
