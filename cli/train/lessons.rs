//! What an agent learns from beside the reward: data sets of `msk collect`, a teacher, an agent to start as.

use crate::error::{Context, Error};
use crate::policies::Limits;
use msk::compiler::task::Channel;
use msk::evaluate::Journal;
use msk::evaluate::collection::{LAYOUT, archive_name};
use msk::evaluate::npz::{NpzReader, ZipError};
use msk::runtime::episode::Engine;
use msk::runtime::policy::ActsOn;
use msk::train::{Agent, Algorithm, DataSet, Lessons, RecordedEpisode, RecordedOutcome};
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
    /// Data set of `msk collect`, which the algorithm clone imitates, and from which sac, simba and dynsyn learn beside what they play
    /// themselves: half of every batch; may be given several times
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
    pub fn lessons(&self, engine: &Engine, algorithm: Algorithm) -> Result<Lessons, Error> {
        let from_rewards = algorithm != Algorithm::Clone;
        let data = self.data.iter().map(|folder| read(folder, engine, from_rewards)).collect::<Result<_, _>>()?;
        let teacher = self.teacher.as_deref().map(|policy| self.limits.source(policy)).transpose()?;
        let start = self.start.as_deref().map(Agent::read).transpose()?;
        Ok(Lessons { data, teacher, start: start.map(Arc::new) })
    }
}

/// Reads a data set, with what came of its actions where a learner needs it.
fn read(folder: &Path, engine: &Engine, from_rewards: bool) -> Result<DataSet, Error> {
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
    let weights = if from_rewards { Some(weights(&layout, engine).map_err(refuse)?) } else { None };
    let mut episodes = Vec::new();
    for path in archives(folder)? {
        let bytes = read_file(&path, LARGEST).map_err(|error| refuse(format!("is not whole: {error}")))?;
        let damaged = |reason: String| refuse(format!("is damaged: `{}` {reason}", path.display()));
        let mut archive = NpzReader::new(&bytes).map_err(|error| damaged(error.to_string()))?;
        episodes.push(episode(&mut archive, engine, acts_on, weights.as_deref()).map_err(damaged)?);
    }
    if episodes.iter().all(|episode| episode.actions.is_empty()) {
        return Err(refuse("has no episodes".into()));
    }
    Ok(DataSet::new(&shown.to_string(), acts_on, episodes))
}

/// Reads an episode; with the weights under which it was played also what came of it.
fn episode(
    archive: &mut NpzReader<'_>,
    engine: &Engine,
    acts_on: ActsOn,
    weights: Option<&[f64]>,
) -> Result<RecordedEpisode, String> {
    let task = engine.task();
    let [width, entries] = [task.observation_size(), acts_on.size(task, engine.body())];
    let observations: Vec<f32> = array(archive, "observations", &[width as u64])?;
    let actions: Vec<f64> = array(archive, "actions", &[entries as u64])?;
    // A task without anything to decide has no entries.
    let rows = actions.len().checked_div(entries).unwrap_or(0);
    if observations.len() != (rows + 1) * width {
        return Err(format!("has {} observations for {rows} actions", observations.len() / width));
    }
    let outcome = weights.map(|weights| outcome(archive, task.critic_size(), weights)).transpose()?;
    let more = outcome.iter().flat_map(|outcome| outcome.critic_observations.iter());
    let values = outcome.iter().flat_map(|outcome| outcome.values.iter());
    if !(observations.iter().chain(more).all(|value| value.is_finite())
        && actions.iter().chain(values).all(|value| value.is_finite()))
    {
        return Err("has numbers that are not finite".into());
    }
    Ok(RecordedEpisode { observations, actions, outcome })
}

/// What came of the actions of an episode under these weights.
fn outcome(archive: &mut NpzReader<'_>, critic: usize, weights: &[f64]) -> Result<RecordedOutcome, String> {
    let critic_observations = if critic > 0 { array(archive, "critic_observations", &[critic as u64])? } else { Vec::new() };
    let contributions: Vec<f64> = array(archive, "terms", &[weights.len() as u64])?;
    let ends: Vec<bool> = array(archive, "terminations", &[])?;
    let values = contributions.iter().zip(weights.iter().cycle()).map(|(contribution, weight)| contribution / weight).collect();
    Ok(RecordedOutcome { critic_observations, values, terminated: ends.last() == Some(&true) })
}

/// The weights under which a data set was played, if the reward of the task is what it was; if not, why, in words that follow its name.
fn weights(layout: &Value, engine: &Engine) -> Result<Vec<f64>, String> {
    let task = engine.task();
    if layout["task_hash"].as_str() != Some(&task.hash) {
        return Err(format!(
            "has the rewards of another task than `{}`, or of what it was: it can be imitated only, by the algorithm `clone`",
            task.name
        ));
    }
    let of = |term: &Value| term["weight"].as_f64();
    let weights: Option<Vec<f64>> = layout["terms"].as_array().and_then(|terms| terms.iter().map(of).collect());
    let weights = weights.filter(|weights| weights.len() == task.terms.len());
    let weights = weights.ok_or("is damaged: `terms` in data.json does not have a weight for each term of the task")?;
    match weights.iter().zip(&task.terms).find(|(weight, _)| **weight == 0.0) {
        Some((_, term)) => Err(format!("does not say what `{}` was, whose weight was 0", term.name)),
        None => Ok(weights),
    }
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
fn archives(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut episodes = Vec::new();
    Journal::each(folder, |record| episodes.push(record.episode)).map_err(crate::eval::explain)?;
    episodes.sort_unstable();
    Ok(episodes.into_iter().map(|episode| folder.join(archive_name(episode))).collect())
}

/// The numbers of an array whose rows have this shape.
fn array<T: npyz::Deserialize>(archive: &mut NpzReader<'_>, name: &str, row: &[u64]) -> Result<Vec<T>, String> {
    let entry_name = format!("{name}.npy");
    let unreadable = |error: ZipError| format!("has no array `{name}`: {error}");
    // The header first: an archive of a few bytes may unpack to gigabytes.
    let header = archive.entry(&entry_name, LONGEST_HEADER).map_err(unreadable)?;
    let size = NpyFile::new(&header[..]).map_err(|error| error.to_string())?.shape().to_vec();
    if size.len() != row.len() + 1 || !size[1..].iter().eq(row) {
        return Err(format!("has an array `{name}` of shape {size:?}, expected rows of shape {row:?}"));
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
