//! A difference in words.

use super::{Change, ChangeKind, Difference, FieldChange, FormulaChange};
use std::fmt::{self, Display};

impl Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.before == self.after || self.before.is_empty() {
            writeln!(f, "{}", self.after)?;
        } else {
            writeln!(f, "{} -> {}", self.before, self.after)?;
        }
        if self.is_empty() {
            return writeln!(f, "  means the same");
        }
        self.changes.iter().try_for_each(|change| write!(f, "{change}"))
    }
}

impl Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = match self.kind {
            ChangeKind::Added => '+',
            ChangeKind::Removed => '-',
            ChangeKind::Changed | ChangeKind::Reordered => '~',
        };
        let title = match self.section.as_str() {
            section if self.kind == ChangeKind::Reordered => format!("order of {section}s"),
            "terminate" => format!("ends by {}", self.name),
            "finish" => format!("finishes by {}", self.name),
            "channel" => format!("observes {}", self.name),
            "start" => format!("start of {}", self.name),
            "noise" => format!("noise on {}", self.name),
            section => format!("{section} {}", self.name),
        };
        write!(f, "  {mark} {}", title.trim_end())?;
        if matches!(self.kind, ChangeKind::Added | ChangeKind::Removed) {
            return self.one_sided(f);
        }
        writeln!(f)?;
        for FieldChange { field, before, after } in &self.fields {
            let told = |value: &Option<String>| value.clone().unwrap_or_else(|| "not said".to_owned());
            match field.as_str() {
                "order" => writeln!(f, "      {} -> {}", told(before), told(after))?,
                _ => writeln!(f, "      {field} {} -> {}", told(before), told(after))?,
            }
        }
        self.formula.iter().try_for_each(|formula| write!(f, "{formula}"))
    }
}

impl Change {
    /// What is added or removed, on one line.
    fn one_sided(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |field: &FieldChange| field.after.clone().or_else(|| field.before.clone()).unwrap_or_default();
        let fields: Vec<String> = self.fields.iter().map(|field| format!("{} {}", field.field, value(field))).collect();
        let formula = self.formula.as_ref().map(|formula| format!("{}{}", formula.before, formula.after));
        match (fields.is_empty(), formula) {
            (true, None) => writeln!(f),
            (true, Some(formula)) => writeln!(f, ": {formula}"),
            (false, None) => writeln!(f, ": {}", fields.join(", ")),
            (false, Some(formula)) => writeln!(f, ": {}, {formula}", fields.join(", ")),
        }
    }
}

impl Display for FormulaChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.before != self.after {
            writeln!(f, "      from {}", self.before)?;
            writeln!(f, "        to {}", self.after)?;
        } else {
            let formula = if self.after.is_empty() { String::new() } else { format!(" ({})", self.after) };
            writeln!(
                f,
                "      computes something else, though it is written as before{formula}: a name in it means another thing"
            )?;
        }
        if self.constants_before.is_empty() && self.constants_after.is_empty() {
            return Ok(());
        }
        let list = |constants: &[String]| if constants.is_empty() { "none".to_owned() } else { constants.join(", ") };
        writeln!(f, "      numbers {} -> {}", list(&self.constants_before), list(&self.constants_after))
    }
}
