//! Planners as a command line names them.

use crate::planner::Planner;
use crate::settings::{Preset, Settings};
use msk_program::digest::hexadecimal;
use msk_runtime::policy::{Policy, PolicyError, PolicyMaker, PolicySource};
use msk_storage::read_file;
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Largest file of settings, bytes.
const LARGEST: u64 = 1 << 20;

/// A planner with its settings, to be opened.
#[derive(Debug)]
struct Maker {
    name: String,
    settings: Settings,
}

impl PolicyMaker for Maker {
    // The samples of one plan fill the lanes of a worker.
    fn most_at_once(&self) -> usize {
        1
    }

    fn reacts_to_weights(&self) -> bool {
        true
    }

    fn open<'a>(&self, stop: &'a AtomicBool) -> Result<Box<dyn Policy + 'a>, PolicyError> {
        Ok(Box::new(Planner::new(self.name.clone(), self.settings.clone(), stop)))
    }
}

/// The planner that `text` names: `plan`, `plan PRESET` or `plan FILE`; `None` if it names none.
///
/// A file is read here, so that all episodes see the same; results tell two files of one name apart.
///
/// # Errors
/// A file that cannot be read, or settings that make no sense.
pub fn source(text: &str) -> Option<Result<PolicySource, PolicyError>> {
    let made = |(name, settings): (String, Settings)| PolicySource::made(name.clone(), Arc::new(Maker { name, settings }));
    Some(settings_of(settings_named(text)?).map(made))
}

/// Planners that look for what else than success the reward asks for: one for each seed, of the planner that `text` names as [`source`] does.
/// `None` if it names none.
///
/// # Errors
/// As [`source`].
pub fn sources_without_success(text: &str, seeds: impl Iterator<Item = u64>) -> Option<Result<Vec<PolicySource>, PolicyError>> {
    let made = |(name, settings): (String, Settings)| {
        let maker = |seed: u64| {
            let settings = Settings { seed, avoid_success: true, ..settings.clone() };
            let name = format!("{name}, seed {seed}, without success");
            PolicySource::made(name.clone(), Arc::new(Maker { name, settings }))
        };
        seeds.map(maker).collect()
    };
    Some(settings_of(settings_named(text)?).map(made))
}

/// What stands behind `plan`; `None` if `text` names no planner.
fn settings_named(text: &str) -> Option<&str> {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word == "plan").then(|| rest.trim())
}

/// The settings of a preset or a file, with the name of the planner that has them.
fn settings_of(rest: &str) -> Result<(String, Settings), PolicyError> {
    let rest = if rest.is_empty() { "fast" } else { rest };
    Ok(match Preset::ALL.into_iter().find(|(name, _)| *name == rest) {
        Some((name, preset)) => (format!("plan {name}"), Settings::of(preset)),
        None => read(rest)?,
    })
}

fn read(path: &str) -> Result<(String, Settings), PolicyError> {
    let unreadable = |reason: String| PolicyError::Unreadable { path: path.to_owned(), reason };
    let presets = || Preset::ALL.map(|(name, _)| name).join(", ");
    let bytes = read_file(Path::new(path), LARGEST)
        .map_err(|error| unreadable(format!("{error}; `plan` takes one of {} or a file of settings", presets())))?;
    let text = String::from_utf8(bytes).map_err(|error| unreadable(error.to_string()))?;
    let settings = Settings::read(&text).map_err(|error| unreadable(error.to_string()))?;
    let digest = hexadecimal(&Sha256::digest(text.as_bytes())[..4]);
    Ok((format!("plan {path} ({digest})"), settings))
}
