//! A difference in words.

use super::{Change, ChangeKind, Difference, FieldChange, FormulaChange, people};
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
            let (before, after, ratio) = people::told(&told(before), &told(after));
            match field.as_str() {
                "order" => writeln!(f, "      {before} -> {after}")?,
                _ => writeln!(f, "      {field} {before} -> {after}{ratio}")?,
            }
        }
        self.formula.iter().try_for_each(|formula| write!(f, "{formula}"))
    }
}

impl Change {
    /// What is added or removed, on one line.
    fn one_sided(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |field: &FieldChange| field.after.clone().or_else(|| field.before.clone()).unwrap_or_default();
        let fields: Vec<String> =
            self.fields.iter().map(|field| format!("{} {}", field.field, people::one(&value(field)))).collect();
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
            // Formulas hold the numbers in the units in which they were typed; what they are computed with adds nothing to that.
            let (_, _, ratio) = people::told(&self.before, &self.after);
            writeln!(f, "      from {}", self.before)?;
            return writeln!(f, "        to {}{ratio}", self.after);
        }
        let formula = if self.after.is_empty() { String::new() } else { format!(" ({})", self.after) };
        writeln!(f, "      computes something else, though it is written as before{formula}: a name in it means another thing")?;
        for name in &self.names {
            let (before, after, ratio) = people::told(&name.before, &name.after);
            writeln!(f, "      {} = {before} -> {after}{ratio}", name.name)?;
        }
        if !self.names.is_empty() || self.constants_before.is_empty() && self.constants_after.is_empty() {
            return Ok(());
        }
        let list = |constants: &[String]| if constants.is_empty() { "none".to_owned() } else { constants.join(", ") };
        let (before, after, ratio) = people::told(&list(&self.constants_before), &list(&self.constants_after));
        writeln!(f, "      in SI units {before} -> {after}{ratio}")
    }
}
