//! Folders of results.

use crate::error::Error;
use crate::output;
use msk::evaluate::{JournalError, Plan, Shard};
use msk_storage::{Folder, StorageError};
use std::io;
use std::path::{Path, PathBuf};

/// What a run is called: after its task or its file, and its policy.
pub(super) fn name(plan: &Plan, file: &Path, policy: &str) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name = if let [trial] = plan.trials.as_slice() { trial.task.name.clone() } else { stem.into_owned() };
    format!("{name}-{}{}", in_path(policy), shard_in_path(plan.shard))
}

/// The end of the name of a run: `-shard-2-of-3`, or nothing of a whole one.
pub fn shard_in_path(shard: Shard) -> String {
    if shard.is_whole() { String::new() } else { format!("-shard-{}", shard.to_string().replace('/', "-of-")) }
}

/// Words as a part of a path, such as a policy: `process python3 policy.py` is `process-python3-policy-py`.
pub fn in_path(policy: &str) -> String {
    const LONGEST: usize = 40;
    let words = policy.split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_').filter(|word| !word.is_empty());
    let joined = words.collect::<Vec<_>>().join("-");
    joined.chars().take(LONGEST).collect::<String>().trim_end_matches('-').to_owned()
}

/// Makes `results/NAME-1`, or the first that does not exist yet: nothing is ever overwritten. It is on the disk when this returns.
///
/// # Errors
/// A folder that cannot be made.
pub fn fresh(name: &str) -> Result<PathBuf, Error> {
    let results = Path::new("results");
    let cannot = |source: StorageError| explain(JournalError::Unusable { folder: results.into(), source });
    output::own_folder("results").map_err(cannot)?;
    for number in 1_u64.. {
        let folder = results.join(format!("{name}-{number}"));
        match Folder::create_new(&folder) {
            Err(StorageError::System { source, .. }) if source.kind() == io::ErrorKind::AlreadyExists => {}
            made => return made.map(|_| folder).map_err(cannot),
        }
    }
    Err(Error::new("`results` is full"))
}

/// Adds what to do about a folder that cannot be used.
pub fn explain(error: JournalError) -> Error {
    let hint = match &error {
        JournalError::Unusable { .. } => {
            "free some space or choose a writable folder with `--out DIR`; completed episodes are kept"
        }
        JournalError::OtherRun { .. } => "choose another folder with `--out DIR`, or repeat that run's settings",
        JournalError::Unclaimed { .. } => "restore its `run.json`, or choose another folder with `--out DIR`",
        JournalError::Empty { .. } => "name a folder of results, such as results/tasks-cmc-1",
        JournalError::Damaged { .. } | JournalError::Foreign { .. } => {
            "remove the line or restore the file, or choose another folder with `--out DIR`; nothing was changed"
        }
        JournalError::Busy { .. } => "wait for it, or choose another folder with `--out DIR`",
    };
    Error::from(error).hint(hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn policies_are_named_in_paths_without_what_paths_cannot_hold() {
        assert_eq!(in_path("cmc"), "cmc");
        assert_eq!(in_path("process python3 ../policy.py"), "process-python3-policy-py");
        assert_eq!(in_path(&"x/".repeat(100)).len(), 39);
    }
}
