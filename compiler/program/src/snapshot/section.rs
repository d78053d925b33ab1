//! The form of a snapshot: sections with fields, and the text that holds them.

use serde::{Deserialize, Serialize};
use std::fmt::{self, Display, Write};
use std::str::FromStr;

/// First line of the text: the form's name and number.
const HEAD: &str = "msk snapshot 1";

/// What a task means, section by section.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Snapshot {
    /// In the order of the task: heading, parameters, scene, beginning, chance, then phase by phase terms, metrics, ends,
    /// success, channels.
    pub sections: Vec<Section>,
}

/// One declaration of a task.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Section {
    /// `task`, `parameter`, `object`, `beginning`, `random`, `term`, `metric`, `terminate`, `finish`, `success`, `channel`, ...
    pub kind: String,
    /// Its name; empty where there is one of its kind only.
    pub name: String,
    /// Its fields, by keyword.
    pub fields: Vec<(String, String)>,
    /// The formula as mathematics, for people: two formulas that are written differently may mean the same.
    pub formula: String,
    /// What the formula computes, operation by operation, numbered within this section.
    pub graph: Vec<String>,
}

impl Section {
    pub(super) fn new(kind: &str, name: &str) -> Self {
        Self { kind: kind.to_owned(), name: name.to_owned(), ..Self::default() }
    }

    pub(super) fn field(mut self, name: &str, value: impl Display) -> Self {
        self.fields.push((name.to_owned(), value.to_string()));
        self
    }

    /// The value of a field.
    pub fn get(&self, field: &str) -> Option<&str> {
        self.fields.iter().find(|(name, _)| name == field).map(|(_, value)| value.as_str())
    }

    /// Kind and name, as they stand in the text.
    pub fn title(&self) -> String {
        if self.name.is_empty() { self.kind.clone() } else { format!("{} {}", self.kind, self.name) }
    }
}

impl Snapshot {
    /// Name of the task.
    pub fn task(&self) -> &str {
        self.sections.iter().find(|section| section.kind == "task").map_or("", |section| &section.name)
    }
}

impl Display for Snapshot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{HEAD}")?;
        for section in &self.sections {
            writeln!(f, "\n{}", section.title())?;
            for (name, value) in &section.fields {
                writeln!(f, "    {name}: {value}")?;
            }
            if !section.formula.is_empty() {
                writeln!(f, "    = {}", section.formula)?;
            }
            for line in &section.graph {
                writeln!(f, "        {line}")?;
            }
        }
        Ok(())
    }
}

/// Why a text is no snapshot.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line} of the snapshot: expected {expected}, found `{found}`; rewrite it with `msk snapshot`")]
pub struct Unreadable {
    /// Counted from 1.
    pub line: usize,
    /// What should stand there.
    pub expected: String,
    /// What does.
    pub found: String,
}

impl FromStr for Snapshot {
    type Err = Unreadable;

    fn from_str(text: &str) -> Result<Self, Unreadable> {
        let mut lines = text.lines().enumerate();
        let wrong = |line: usize, expected: &str, found: &str| Unreadable {
            line: line + 1,
            expected: expected.to_owned(),
            found: found.chars().take(60).collect(),
        };
        let (_, head) = lines.next().unwrap_or((0, ""));
        if head != HEAD {
            return Err(wrong(0, &format!("`{HEAD}`"), head));
        }
        let mut snapshot = Self::default();
        for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            let Some(indented) = line.strip_prefix("    ") else {
                let (kind, name) = line.split_once(' ').unwrap_or((line, ""));
                snapshot.sections.push(Section::new(kind, name));
                continue;
            };
            let section = snapshot.sections.last_mut().ok_or_else(|| wrong(number, "the title of a section", line))?;
            if let Some(step) = indented.strip_prefix("    ") {
                section.graph.push(step.to_owned());
            } else if let Some(formula) = indented.strip_prefix("= ") {
                section.formula = formula.to_owned();
            } else {
                let (name, value) = indented.split_once(": ").ok_or_else(|| wrong(number, "`name: value`", line))?;
                section.fields.push((name.to_owned(), value.to_owned()));
            }
        }
        Ok(snapshot)
    }
}

/// Text of a section for hashing: everything but what is for people only.
pub(super) fn meant(section: &Section, text: &mut String) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", section.title());
    for (name, value) in &section.fields {
        let _ = writeln!(text, " {name}: {value}");
    }
    for line in &section.graph {
        let _ = writeln!(text, "  {line}");
    }
}
