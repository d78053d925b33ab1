//! What an agent learns from beside the reward: data sets of `msk collect`, a teacher, an agent to start as.

use crate::error::{Context, Error};
use crate::policies::Limits;
use msk::compiler::task::Channel;
use msk::evaluate::Journal;
use msk::evaluate::collection::{LAYOUT, archive_name};
use msk::evaluate::npz::{NpzReader, ZipError};
use msk::runtime::episode::Engine;
use msk::runtime::policy::ActsOn;
use msk::train::{Agent, DataSet, Lessons};
use msk_storage::{read_file, read_text_file};
use npyz::NpyFile;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest files that are read, bytes.
const LARGEST: u64 = 4 << 30;
const LARGEST_TEXT: u64 = 64 << 20;
/// Most bytes of the header of an array.
const LONGEST_HEADER: u64 = 4096;

/// Lessons as a command line names them.
#[derive(clap::Args)]
pub struct Named {
    /// For the algorithm clone: data set of `msk collect` to imitate; may be given several times
    #[arg(long, value_name = "DIR")]
    data: Vec<PathBuf>,
    /// For the algorithm clone: the policy that knows what to do in the states to which the agent comes, as `msk run --policy` names it
    #[arg(long, value_name = "POLICY")]
    teacher: Option<String>,
    /// The agent that the training begins as: the folder of an agent or of a training
    #[arg(long, value_name = "DIR")]
    start: Option<PathBuf>,
    #[command(flatten)]
    limits: Limits,
}

impl Named {
    /// Reads them.
    ///
    /// # Errors
    /// A folder that holds no data set of this task or no agent, or a policy that does not exist.
    pub fn lessons(&self, engine: &Engine) -> Result<Lessons, Error> {
        let data = self.data.iter().map(|folder| read(folder, engine)).collect::<Result<_, _>>()?;
        let teacher = self.teacher.as_deref().map(|policy| self.limits.source(policy)).transpose()?;
        let start = self.start.as_deref().map(Agent::read).transpose()?;
        Ok(Lessons { data, teacher, start: start.map(Arc::new) })
    }
}

/// Reads a data set.
fn read(folder: &Path, engine: &Engine) -> Result<DataSet, Error> {
    let shown = folder.display();
    let refuse = |reason: String| {
        let error = Error::new(format!("the data set `{shown}` {reason}"));
        error.hint("`msk collect TASK --policy cmc --out DIR` makes one")
    };
    let layout = folder.join(LAYOUT);
    let text = read_text_file(&layout, LARGEST_TEXT).context(|| format!("`{shown}` holds no data set"))?;
    let layout: Value = serde_json::from_str(&text).map_err(|error| refuse(format!("is damaged: {error}")))?;
    let acts_on = match layout["acts_on"].as_str() {
        Some("muscles") => ActsOn::Muscles,
        Some("task") => ActsOn::Task,
        _ => return Err(refuse("is damaged: `acts_on` in data.json is neither \"muscles\" nor \"task\"".into())),
    };
    check(&layout, engine, acts_on).map_err(refuse)?;
    let [width, entries] = [engine.task().observation_size(), acts_on.size(engine.task(), engine.body())];
    let (mut observations, mut actions) = (Vec::new(), Vec::new());
    for path in episodes(folder)? {
        let bytes = read_file(&path, LARGEST).map_err(|error| refuse(format!("is not whole: {error}")))?;
        let damaged = |reason: String| refuse(format!("is damaged: `{}` {reason}", path.display()));
        let mut archive = NpzReader::new(&bytes).map_err(|error| damaged(error.to_string()))?;
        let seen: Vec<f32> = array(&mut archive, "observations", width).map_err(damaged)?;
        let done: Vec<f64> = array(&mut archive, "actions", entries).map_err(damaged)?;
        // A task without anything to decide has no entries.
        let rows = done.len().checked_div(entries).unwrap_or(0);
        if seen.len() != (rows + 1) * width {
            return Err(damaged(format!("has {} observations for {rows} actions", seen.len() / width)));
        }
        if !(seen.iter().all(|value| value.is_finite()) && done.iter().all(|value| value.is_finite())) {
            return Err(damaged("has numbers that are not finite".into()));
        }
        // The last observation is what came of the last action.
        observations.extend_from_slice(&seen[..rows * width]);
        actions.extend(done);
    }
    if actions.is_empty() {
        return Err(refuse("has no episodes".into()));
    }
    Ok(DataSet::new(&shown.to_string(), acts_on, observations, actions))
}

/// Whether a data set has the columns of a task; if not, why, in words that follow its name.
fn check(layout: &Value, engine: &Engine, acts_on: ActsOn) -> Result<(), String> {
    let task = engine.task();
    let channel = |channel: &Channel| (channel.name.clone(), channel.size as u64);
    let expected: Vec<(String, u64)> = task.channels.iter().map(channel).collect();
    let named = |part: &Value| Some((part["name"].as_str()?.to_owned(), part["size"].as_u64()?));
    let found: Option<Vec<(String, u64)>> = layout["observations"].as_array().and_then(|parts| parts.iter().map(named).collect());
    if found.as_ref() != Some(&expected) {
        return Err(format!("observes other channels than the task `{}`: it is of another task, or of what it was", task.name));
    }
    let expected: Vec<String> = match acts_on {
        ActsOn::Task => task.action.names(&task.vocabulary),
        ActsOn::Muscles => engine.body().muscles.iter().map(|muscle| muscle.name.clone()).collect(),
    };
    let names = layout["actions"].as_array().map(|names| names.iter().filter_map(Value::as_str).collect::<Vec<_>>());
    if names.as_deref().is_none_or(|names| names != expected) {
        return Err(format!("has actions of other entries than the task `{}`", task.name));
    }
    Ok(())
}

/// The archives of the episodes that the journal of a data set has, in their order.
fn episodes(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut episodes = Vec::new();
    Journal::each(folder, |record| episodes.push(record.episode)).map_err(crate::eval::explain)?;
    episodes.sort_unstable();
    Ok(episodes.into_iter().map(|episode| folder.join(archive_name(episode))).collect())
}

/// The numbers of an array with so many columns.
fn array<T: npyz::Deserialize>(archive: &mut NpzReader<'_>, name: &str, columns: usize) -> Result<Vec<T>, String> {
    let entry_name = format!("{name}.npy");
    let unreadable = |error: ZipError| format!("has no array `{name}`: {error}");
    // The header first: an archive of a few bytes may unpack to gigabytes.
    let header = archive.entry(&entry_name, LONGEST_HEADER).map_err(unreadable)?;
    let size = NpyFile::new(&header[..]).map_err(|error| error.to_string())?.shape().to_vec();
    if size.len() != 2 || size[1] != columns as u64 {
        return Err(format!("has an array `{name}` of shape {size:?}, expected {columns} columns"));
    }
    let described = size.iter().try_fold(size_of::<T>() as u64, |size, length| size.checked_mul(*length));
    let limit = described.and_then(|size| size.checked_add(LONGEST_HEADER)).filter(|limit| *limit <= LARGEST);
    let limit = limit.ok_or_else(|| format!("has an array `{name}` of shape {size:?}, which is more than {LARGEST} bytes"))?;
    let bytes = archive.entry(&entry_name, limit).map_err(unreadable)?;
    let entry = NpyFile::new(&bytes[..]).map_err(|error| error.to_string())?;
    // Room is made for what the header describes, which may be more than follows it.
    if described.is_none_or(|size| size > bytes.len() as u64) {
        return Err(format!("has an array `{name}` that ends before its shape {size:?} is filled"));
    }
    entry.into_vec().map_err(|error| error.to_string())
}
