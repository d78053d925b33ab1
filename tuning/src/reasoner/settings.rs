//! Which reasoner, from a file of settings.

use super::{Http, Process, Reasoner, RuleBook, Secret};
use msk_storage::{StorageError, read_text_file};
use msk_text::numbers::exact;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Largest file of settings that is read, bytes.
const LARGEST: u64 = 1 << 16;
/// Most attempts: the pause doubles after each, to two minutes before the tenth.
const MOST_ATTEMPTS: u32 = 10;

/// Why a reasoner cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// The file cannot be read.
    #[error("cannot read the reasoner's settings: {0}")]
    Unreadable(#[from] StorageError),
    /// The file is not what is expected.
    #[error("`{}` contains no settings of a reasoner: {reason}", path.display())]
    Wrong {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The key is not in the environment.
    #[error("the key of the reasoner is not set: expected it in the environment variable `{variable}`")]
    NoKey {
        /// The variable.
        variable: String,
    },
    /// A variable that a program is to get is not in the environment.
    #[error("the environment variable `{variable}` is not set: `environment` lists it for the reasoner")]
    NoVariable {
        /// The variable.
        variable: String,
    },
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum Settings {
    Rules,
    Http {
        url: String,
        model: String,
        key_variable: Option<String>,
        #[serde(default = "usual_timeout")]
        timeout_s: f64,
        #[serde(default = "usual_attempts")]
        attempts: u32,
        #[serde(default = "usual_temperature")]
        temperature: f64,
    },
    Process {
        command: Vec<String>,
        #[serde(default)]
        environment: Vec<String>,
        #[serde(default = "usual_timeout")]
        timeout_s: f64,
    },
}

fn usual_timeout() -> f64 {
    60.0
}

fn usual_attempts() -> u32 {
    3
}

fn usual_temperature() -> f64 {
    0.2
}

/// The reasoner that a file describes. A key is never in the file: it names the environment variable that has it, and
/// `environment` looks it up. A program gets the variables that the file names, and none of the others but the usual ones.
///
/// # Errors
/// A file that cannot be read or is not understood, or a variable that is not set.
pub fn from_file(path: &Path, environment: impl Fn(&str) -> Option<String>) -> Result<Box<dyn Reasoner>, SettingsError> {
    let text = read_text_file(path, LARGEST)?;
    let wrong = |reason: String| SettingsError::Wrong { path: path.into(), reason };
    // Without the text of the line, which the parser would repeat: a key that somebody wrote there by mistake stays there.
    let settings: Settings = toml::from_str(&text).map_err(|error| {
        let line = error.span().filter(|span| span.start > 0).map(|span| text[..span.start].matches('\n').count() + 1);
        wrong(line.map_or(String::new(), |line| format!("line {line}: ")) + error.message())
    })?;
    let limit = |seconds: f64| {
        let sensible = (0.001..=3600.0).contains(&seconds);
        if sensible {
            Ok(Duration::from_secs_f64(seconds))
        } else {
            Err(wrong(format!("timeout_s is {}, not 0.001 to 3600", exact(seconds))))
        }
    };
    Ok(match settings {
        Settings::Rules => Box::new(RuleBook),
        Settings::Process { command, environment: named, timeout_s } => {
            if command.is_empty() {
                return Err(wrong("`command` is empty: expected a program and its arguments".into()));
            }
            let process = Process::new(command, limit(timeout_s)?, &named, environment);
            Box::new(process.map_err(|variable| SettingsError::NoVariable { variable })?)
        }
        Settings::Http { url, model, key_variable, timeout_s, attempts, temperature } => {
            let key = match key_variable {
                None => None,
                Some(variable) => match environment(&variable).filter(|key| !key.is_empty()) {
                    Some(key) => Some(Secret::new(key)),
                    None => return Err(SettingsError::NoKey { variable }),
                },
            };
            if !(0.0..=2.0).contains(&temperature) {
                return Err(wrong(format!("temperature is {}, not 0 to 2", exact(temperature))));
            }
            if !(1..=MOST_ATTEMPTS).contains(&attempts) {
                return Err(wrong(format!("attempts is {attempts}, not 1 to {MOST_ATTEMPTS}")));
            }
            let http = Http::new(&url, &model, key, limit(timeout_s)?, attempts).map_err(wrong)?;
            Box::new(http.temperature(temperature))
        }
    })
}
