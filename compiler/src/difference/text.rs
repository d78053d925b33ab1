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
            return writeln!(f, "  no semantic difference");
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
        if self.section == "noise" {
            self.spreads(f)?;
            return self.formula.iter().try_for_each(|formula| write!(f, "{formula}"));
        }
        for FieldChange { field, before, after } in &self.fields {
            let shown = |value: &Option<String>| value.as_deref().map_or_else(|| "none".to_owned(), people::degrees);
            let (before, after, ratio) = people::formatted(&shown(before), &shown(after));
            match field.as_str() {
                "order" => writeln!(f, "      {before} -> {after}")?,
                _ => writeln!(f, "      {field} {before} -> {after}{ratio}")?,
            }
        }
        self.formula.iter().try_for_each(|formula| write!(f, "{formula}"))
    }
}

impl Change {
    /// Noise, whose fields are distributions with the joints that they belong to: joints that only have another distribution are
    /// listed once.
    fn spreads(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved_to = |change: &FieldChange| {
            self.fields.iter().find(|other| change.after.is_none() && other.before.is_none() && other.after == change.before)
        };
        for change in &self.fields {
            let FieldChange { field, before, after } = change;
            let spread = people::degrees(field);
            match (before, after) {
                (Some(joints), None) => match moved_to(change) {
                    Some(now) => {
                        let (old, new, ratio) = people::formatted(&spread, &people::degrees(&now.field));
                        writeln!(f, "      {old} -> {new}{ratio}: {joints}")?;
                    }
                    None => writeln!(f, "      {} -> none: {joints}", people::one(&spread))?,
                },
                (None, Some(_)) if self.fields.iter().any(|other| moved_to(other) == Some(change)) => {}
                (None, Some(joints)) => writeln!(f, "      none -> {}: {joints}", people::one(&spread))?,
                (Some(old), Some(new)) => writeln!(f, "      {}: {old} -> {new}", people::one(&spread))?,
                (None, None) => {}
            }
        }
        Ok(())
    }

    /// What is added or removed, on one line.
    fn one_sided(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |field: &FieldChange| field.after.clone().or_else(|| field.before.clone()).unwrap_or_default();
        let fields: Vec<String> = self
            .fields
            .iter()
            .map(|field| {
                format!("{} {}", people::one(&people::degrees(&field.field)), people::one(&people::degrees(&value(field))))
            })
            .collect();
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
            let (_, _, ratio) = people::formatted(&self.before, &self.after);
            writeln!(f, "      from {}", self.before)?;
            return writeln!(f, "        to {}{ratio}", self.after);
        }
        let formula = if self.after.is_empty() { String::new() } else { format!(" ({})", self.after) };
        writeln!(f, "      same source, different value{formula}: a name in it has changed")?;
        for name in &self.names {
            let (before, after, ratio) = people::formatted(&name.before, &name.after);
            writeln!(f, "      {} = {before} -> {after}{ratio}", name.name)?;
        }
        if !self.names.is_empty() || self.constants_before.is_empty() && self.constants_after.is_empty() {
            return Ok(());
        }
        let list = |constants: &[String]| if constants.is_empty() { "none".to_owned() } else { constants.join(", ") };
        let (before, after, ratio) = people::formatted(&list(&self.constants_before), &list(&self.constants_after));
        writeln!(f, "      in SI units {before} -> {after}{ratio}")
    }
}
