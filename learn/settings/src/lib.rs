//! Settings of planner and learners as TOML files: a file changes those of its preset, and every number lies within its range.
//!
//! ```
//! use msk_settings::{Checked, SettingsError, read};
//! use serde::{Deserialize, Serialize};
//!
//! #[derive(Debug, PartialEq, Serialize, Deserialize)]
//! #[serde(default)]
//! struct Settings { rate: f64, episodes: usize }
//! impl Default for Settings {
//!     fn default() -> Self { Self { rate: 0.5, episodes: 8 } }
//! }
//! let text = "episodes = 3";
//! let settings = read(text, |_: &Settings| Settings::default())?;
//! assert_eq!(settings, Settings { rate: 0.5, episodes: 3 });
//! Checked::of(text).count("episodes", settings.episodes, 1..=64)?;
//! let refused = Checked::of("\nrate = 2").number("rate", 2.0, 0.0..=1.0, "");
//! assert_eq!(refused.map_err(|error| error.to_string()), Err("line 2: `rate` is 2; expected a number from 0 to 1".into()));
//! # Ok::<(), SettingsError>(())
//! ```

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

use msk_text::numbers::exact;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::RangeInclusive;

/// Why settings are rejected.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    /// No TOML, an unknown key, or a value of another kind: the message shows the place in the file.
    #[error("{0}")]
    Invalid(String),
    /// A number that makes no sense.
    #[error("{place}`{key}` is {found}; expected {expected}", place = if *line > 0 { format!("line {line}: ") } else { String::new() })]
    Range {
        /// Line in the file, from 1; 0 if the file does not set it.
        line: usize,
        /// Its name.
        key: &'static str,
        /// What it is.
        found: String,
        /// What it may be.
        expected: String,
    },
}

/// Reads a TOML file: keys that it does not set, in its tables too, are those of `base`, which is asked with what the file says alone.
///
/// # Errors
/// No TOML, an unknown key, or a value of another kind.
pub fn read<S: Serialize + DeserializeOwned>(text: &str, base: impl FnOnce(&S) -> S) -> Result<S, SettingsError> {
    let invalid = |error: &dyn ToString| SettingsError::Invalid(error.to_string());
    // Read by itself first: the message shows the place in the file.
    let written: S = toml::from_str(text).map_err(|error| invalid(&error))?;
    let mut table = toml::Table::try_from(base(&written)).map_err(|error| invalid(&error))?;
    let changes: toml::Table = text.parse().map_err(|error: toml::de::Error| invalid(&error))?;
    for (key, value) in changes {
        match (table.get_mut(&key), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(changes)) => inner.extend(changes),
            (_, value) => drop(table.insert(key, value)),
        }
    }
    table.try_into().map_err(|error| invalid(&error))
}

/// Checks numbers of settings, and knows the lines of the file that sets them.
#[derive(Debug, Clone, Copy)]
pub struct Checked<'a> {
    text: &'a str,
}

impl<'a> Checked<'a> {
    /// Of the text of a file.
    pub fn of(text: &'a str) -> Self {
        Self { text }
    }

    /// A number within a range, in a unit if it has one; NaN is in none.
    ///
    /// # Errors
    /// Any other number.
    pub fn number(&self, key: &'static str, found: f64, range: RangeInclusive<f64>, unit: &str) -> Result<(), SettingsError> {
        if range.contains(&found) {
            return Ok(());
        }
        let expected = format!("a number from {} to {} {unit}", exact(*range.start()), exact(*range.end()));
        self.refuse(key, exact(found), expected.trim_end().to_owned())
    }

    /// A whole number within a range.
    ///
    /// # Errors
    /// Any other number.
    pub fn count(&self, key: &'static str, found: usize, range: RangeInclusive<usize>) -> Result<(), SettingsError> {
        if range.contains(&found) {
            return Ok(());
        }
        self.refuse(key, found.to_string(), format!("a whole number from {} to {}", range.start(), range.end()))
    }

    /// The error of a value that makes no sense.
    ///
    /// # Errors
    /// Always.
    pub fn refuse(&self, key: &'static str, found: String, expected: String) -> Result<(), SettingsError> {
        let is_of = |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
        let line = self.text.lines().position(is_of).map_or(0, |index| index + 1);
        Err(SettingsError::Range { line, key, found, expected })
    }
}
