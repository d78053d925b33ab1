//! Changing a weights file: values are replaced, everything else stays as people have written it.

use super::Overlay;
use msk_compiler::diagnostics::SourceMap;
use msk_compiler::weights::written;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// Why a weights file cannot be changed: it cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the weights file cannot be changed: {0}")]
pub struct EditError(pub String);

/// The text with the weights (task, term, weight) in it: in the lines that it has for them, of which only the digits change,
/// else in new ones.
///
/// # Errors
/// A text that is no weights file.
pub fn edited(text: &str, weights: &[(&str, &str, f64)]) -> Result<String, EditError> {
    let overlay = Overlay::read("", text, &mut SourceMap::default())
        .map_err(|diagnostics| EditError(diagnostics.first().map_or(String::new(), |diagnostic| diagnostic.message.clone())))?;
    let (mut replacements, mut fresh) = (Vec::new(), Vec::new());
    for &(task, term, weight) in weights {
        match overlay.lines.iter().find(|line| line.task == task && line.term == term) {
            Some(line) if line.weight == weight => {}
            Some(line) => replacements.push((line.value.range(), written(weight))),
            None => fresh.push((task, term, weight)),
        }
    }
    // From the back, so that the places before stay where they are.
    replacements.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    let mut edited = text.to_owned();
    for (range, digits) in replacements {
        edited.replace_range(range, &digits);
    }
    if fresh.is_empty() { Ok(edited) } else { added(&edited, &fresh) }
}

/// The text with further lines.
fn added(text: &str, weights: &[(&str, &str, f64)]) -> Result<String, EditError> {
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| EditError(error.to_string()))?;
    for &(task, term, weight) in weights {
        let item = document.entry(task).or_insert_with(|| Item::Table(Table::new()));
        let table = item.as_table_like_mut().ok_or_else(|| EditError(format!("`{task}` is not a table of weights")))?;
        put(table, term, weight);
    }
    let added = document.to_string();
    // The library knows one kind of line end; a file that has the other throughout keeps it.
    let lines = |end: &str| text.matches(end).count();
    Ok(if lines("\r\n") > 0 && lines("\r\n") == lines("\n") { added.replace('\n', "\r\n") } else { added })
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
    if let Ok(value) = written(weight).parse::<Value>() {
        table.insert(term, Item::Value(value));
    }
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
    fn line_ends_stay() {
        let after = edited("[stand]\r\npose = 1\r\n", &[("stand", "pose", 2.0), ("stand", "effort", -1.0)]).unwrap();
        assert_eq!(after, "[stand]\r\npose = 2\r\neffort = -1\r\n");
    }

    #[test]
    fn what_is_no_weights_file_is_not_changed() {
        assert!(edited("pose: 1", &[]).is_err());
        let message = edited("stand = 1", &[("stand", "pose", 1.0)]).unwrap_err().to_string();
        assert!(message.contains("`stand` is outside of any task"), "{message}");
    }
}
