//! Changing a weights file: values are replaced, everything else stays as people have written it.

use msk_compiler::weights::written;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// Why a weights file cannot be changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// It is not TOML.
    #[error("the weights file cannot be read: {0}")]
    Syntax(String),
    /// The place of a weight is taken by something else.
    #[error("`{0}` in the weights file is no table of weights")]
    NoTable(String),
}

/// The text with the weights (task, term, weight) in it: in the lines that it has for them, else in new ones.
///
/// # Errors
/// A text that is not TOML, or in which the name of a task is no table.
pub fn edited(text: &str, weights: &[(&str, &str, f64)]) -> Result<String, EditError> {
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| EditError::Syntax(error.to_string()))?;
    for &(task, term, weight) in weights {
        let item = document.entry(task).or_insert_with(|| Item::Table(Table::new()));
        let table = item.as_table_like_mut().ok_or_else(|| EditError::NoTable(task.to_owned()))?;
        put(table, term, weight);
    }
    Ok(document.to_string())
}

/// Puts a weight where its term stands: as one name, or as a phase and a name.
fn put(table: &mut dyn TableLike, term: &str, weight: f64) {
    if let Some((phase, own)) = term.split_once('.')
        && !table.contains_key(term)
        && let Some(inner) = table.get_mut(phase).and_then(Item::as_table_like_mut)
    {
        return put(inner, own, weight);
    }
    // The digits of a finite number are a number of TOML too.
    let Ok(mut value) = written(weight).parse::<Value>() else { return };
    match table.get_mut(term).and_then(Item::as_value_mut) {
        Some(old) if number(old) == Some(weight) => {}
        Some(old) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        None => {
            table.insert(term, Item::Value(value));
        }
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn what_is_there_is_changed_in_its_line_and_what_is_not_is_added() {
        let text = "# tuned by hand\n[stand] # quiet\n  pose   = 11.50  # more of it\n\n[rise]\nsit.pose = 3\n";
        let edits = [("stand", "pose", 12.0), ("stand", "effort", -0.01), ("rise", "sit.pose", 4.0), ("walk", "speed", 1e-7)];
        let after = edited(text, &edits).unwrap();
        assert_eq!(
            after,
            "# tuned by hand\n[stand] # quiet\n  pose   = 12  # more of it\neffort = -0.01\n\n[rise]\nsit.pose = 4\n\n[walk]\nspeed = 1e-7\n"
        );
        assert_eq!(edited(&after, &edits).unwrap(), after, "nothing new changes nothing");
        assert_eq!(edited(text, &[("stand", "pose", 11.5)]).unwrap(), text, "the same number keeps its digits");
    }

    #[test]
    fn a_phase_without_a_table_gets_one_name() {
        assert_eq!(edited("", &[("rise", "sit.pose", 4.0)]).unwrap(), "[rise]\n\"sit.pose\" = 4\n");
    }

    #[test]
    fn what_is_no_weights_file_is_not_changed() {
        assert!(matches!(edited("pose: 1", &[]), Err(EditError::Syntax(_))));
        assert_eq!(edited("stand = 1", &[("stand", "pose", 1.0)]), Err(EditError::NoTable("stand".into())));
    }
}
