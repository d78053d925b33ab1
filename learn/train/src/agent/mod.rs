//! Agents: what was learned, as a folder.
//!
//! A folder holds `agent.toml` (what it was trained on and how well it does), `policy.safetensors` (its network with the normaliser of
//! observations, as the policy `network` reads it) and `curve.jsonl` (how it became what it is).

mod actor;

pub use actor::Actor;
pub(crate) use actor::Output;

use crate::curve;
use crate::dynsyn::Synergies;
use crate::evaluate::Evaluation;
use crate::onnx;
use crate::training::Identity;
use msk_network::Shape;
use msk_network::file::{Precision, TensorFile};
use msk_program::digest::hexadecimal;
use msk_program::task::CompiledTask;
use msk_runtime::episode::Engine;
use msk_storage::{Folder, StorageError};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::Path;

/// The description of an agent, within its folder.
const DESCRIPTION: &str = "agent.toml";
/// Its network.
const NETWORK: &str = "policy.safetensors";
/// Largest description, bytes.
const LARGEST_DESCRIPTION: u64 = 1 << 20;
/// Largest network, bytes.
const LARGEST_NETWORK: u64 = 1 << 32;

/// What an agent was trained on, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// Name of the task.
    pub task: String,
    /// Content hash of the task.
    pub task_hash: String,
    /// Name of the body.
    pub body: String,
    /// Of names and masses of the body's parts: strengths and conditions of muscles may differ.
    pub body_hash: String,
    /// How it learned.
    pub algorithm: String,
    /// Random seed.
    pub seed: u64,
    /// Control steps that it learned from.
    pub steps: u64,
    /// Whether the hyperbolic tangent of its output acts.
    squash: bool,
    /// Bound of normalised observations.
    clip: f32,
    /// Control steps that an action lasts for.
    #[serde(default = "one")]
    pub action_repeat: u32,
    /// How it did when it was last evaluated.
    pub evaluation: Option<Evaluation>,
    /// The groups of entries through which it acts, if it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    synergies: Option<Synergies>,
    network: Shape,
    observation: Vec<Channel>,
}

/// What agents of earlier versions mean by saying nothing.
fn one() -> u32 {
    1
}

/// A channel of the observation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Channel {
    name: String,
    size: usize,
}

/// An agent: what acts, and what it was trained on.
#[derive(Debug, Clone, PartialEq)]
pub struct Agent {
    /// What it was trained on.
    pub description: Description,
    actor: Actor,
}

/// Why an agent should not act on a task, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unfit {
    /// It cannot: it sees other channels, or gives other numbers.
    Numbers(String),
    /// It can, but what it sees and does means something else there.
    Meaning(String),
}

/// Why a folder holds no agent.
#[derive(Debug, thiserror::Error)]
pub enum AgentError {
    /// A file cannot be used.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// A file is missing.
    #[error("`{folder}` holds no `{file}`: expected the folder of an agent, as `msk train` writes it")]
    Missing {
        /// The folder.
        folder: String,
        /// What it lacks.
        file: &'static str,
    },
    /// A file with another content.
    #[error("`{folder}/{file}` {reason}")]
    Invalid {
        /// The folder.
        folder: String,
        /// Which file.
        file: &'static str,
        /// What is wrong, in words that continue the name.
        reason: String,
    },
    /// A number that half precision does not have.
    #[error("`{tensor}` holds {value}: numbers of half precision are at most 65504")]
    TooLarge {
        /// The tensor.
        tensor: String,
        /// The number.
        value: f32,
    },
    /// A folder without agents.
    #[error("`{folder}` holds no folder of an agent: expected trainings of `msk train --out {folder}/NAME`, or agents")]
    NoAgents {
        /// The folder.
        folder: String,
    },
}

impl Description {
    /// Of the text in a folder.
    ///
    /// # Errors
    /// A text that describes no agent.
    fn read(folder: &str, text: &str) -> Result<Self, AgentError> {
        let invalid = |reason: String| AgentError::Invalid { folder: folder.to_owned(), file: DESCRIPTION, reason };
        let description: Self = toml::from_str(text).map_err(|error| invalid(format!("describes no agent: {error}")))?;
        let Shape { inputs, hidden, outputs, .. } = &description.network;
        // Saturating: sizes may be any numbers.
        let observed = description.observation.iter().fold(0, |all: usize, channel| all.saturating_add(channel.size));
        if observed != *inputs || hidden.iter().chain([outputs]).any(|size| !(1..=1 << 20).contains(size)) {
            return Err(invalid(format!("describes a network of {inputs} inputs for {observed} observed numbers")));
        }
        if !(description.clip.is_finite() && description.clip > 0.0) {
            return Err(invalid(format!("bounds observations by {}: expected a number greater than 0", description.clip)));
        }
        if description.action_repeat == 0 {
            return Err(invalid("repeats an action for 0 control steps: expected at least 1".into()));
        }
        if let Some(wrong) = description.evaluation.and_then(|found| found.wrong()) {
            return Err(invalid(format!("describes an evaluation {wrong}")));
        }
        if let Some(needed) = description.synergies.as_ref().map(Synergies::outputs).filter(|needed| needed != outputs) {
            return Err(invalid(format!("describes a network of {outputs} outputs for synergies that take {needed}")));
        }
        Ok(description)
    }

    /// How the output of the network acts.
    fn output(&self) -> Output {
        match (&self.synergies, self.squash) {
            (Some(synergies), _) => Output::Synergies(synergies.clone()),
            (None, true) => Output::Squashed,
            (None, false) => Output::Clipped,
        }
    }

    /// Entries of an action.
    fn entries(&self) -> usize {
        self.synergies.as_ref().map_or(self.network.outputs, Synergies::entries)
    }
}

/// What tells bodies apart for an agent: names and masses of their parts, joints and actuators.
pub(crate) fn body_hash(engine: &Engine) -> String {
    let (model, mut hasher) = (engine.model(), Sha256::new());
    let names = model.bodies.name.iter().chain(&model.joints.name).chain(&model.actuators.name);
    names.for_each(|name| {
        hasher.update((name.len() as u64).to_le_bytes());
        hasher.update(name);
    });
    model.bodies.mass.iter().for_each(|mass| hasher.update(mass.to_bits().to_le_bytes()));
    hexadecimal(&hasher.finalize()[..8])
}

fn channels(task: &CompiledTask) -> Vec<Channel> {
    task.channels.iter().map(|channel| Channel { name: channel.name.clone(), size: channel.size }).collect()
}

impl Agent {
    /// An agent for the task of an engine.
    pub(crate) fn new(engine: &Engine, actor: Actor, training: &Identity, steps: u64) -> Self {
        let task = engine.task();
        let description = Description {
            task: task.name.clone(),
            task_hash: task.hash.clone(),
            body: task.body.name.clone(),
            body_hash: body_hash(engine),
            algorithm: training.settings.algorithm.name().to_owned(),
            seed: training.seed,
            steps,
            squash: actor.output.squashes(),
            clip: actor.clip,
            action_repeat: u32::try_from(training.settings.action_repeat).unwrap_or(u32::MAX),
            evaluation: None,
            synergies: actor.output.synergies().cloned(),
            network: actor.network.shape().clone(),
            observation: channels(task),
        };
        Self { description, actor }
    }

    /// Whether it chooses an action at a control step of an episode, counted from 0; at the others it repeats the last one.
    pub fn acts_at(&self, step: u32) -> bool {
        step.is_multiple_of(self.description.action_repeat)
    }

    /// What acts.
    pub fn actor(&self) -> &Actor {
        &self.actor
    }

    /// Writes its folder beneath another; `lines` are the curve by which it became what it is, a line of JSON per round.
    ///
    /// # Errors
    /// A full disk, a folder that cannot be written.
    pub fn write(&self, folder: &Folder, name: &str, lines: &[u8]) -> Result<(), StorageError> {
        let own = folder.create_subfolder(Path::new(name))?;
        own.replace(Path::new(curve::FILE), lines)?;
        self.write_in(&own)
    }

    /// Writes its folder without a curve; an agent that is there is replaced.
    ///
    /// # Errors
    /// A full disk, a folder that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), StorageError> {
        self.write_in(&Folder::create(path)?)
    }

    fn write_in(&self, folder: &Folder) -> Result<(), StorageError> {
        folder.replace(Path::new(NETWORK), &self.actor.file(&self.description.observation).bytes())?;
        // Last: what has a description is whole. Plain data of names and numbers always has a TOML form.
        folder.replace(Path::new(DESCRIPTION), toml::to_string(&self.description).unwrap_or_default().as_bytes())
    }

    /// Reads the folder of an agent or, of a training, that of the agent which succeeded most.
    ///
    /// # Errors
    /// No such folder, or one that holds no agent.
    pub fn read(path: &Path) -> Result<Self, AgentError> {
        let folder = Folder::open(path)?;
        match Self::in_folder(&folder) {
            Err(AgentError::Missing { .. }) => match folder.subfolder(Path::new(crate::session::BEST_BY_SUCCESS)) {
                Ok(best) => Self::in_folder(&best),
                Err(_) => Err(AgentError::Missing { folder: path.display().to_string(), file: DESCRIPTION }),
            },
            result => result,
        }
    }

    fn in_folder(folder: &Folder) -> Result<Self, AgentError> {
        let shown = || folder.path().display().to_string();
        let missing = |file: &'static str| move || AgentError::Missing { folder: shown(), file };
        let text = folder.read_text(Path::new(DESCRIPTION), LARGEST_DESCRIPTION)?.ok_or_else(missing(DESCRIPTION))?;
        let description = Description::read(&shown(), &text)?;
        let network = folder.read(Path::new(NETWORK), LARGEST_NETWORK)?.ok_or_else(missing(NETWORK))?;
        Self::with_network(&shown(), description, &network)
    }

    /// Of the content of the files in a folder.
    ///
    /// # Errors
    /// Files that describe no agent, or another network than they hold.
    pub(crate) fn of(folder: &str, description: &str, network: &[u8]) -> Result<Self, AgentError> {
        Self::with_network(folder, Description::read(folder, description)?, network)
    }

    fn with_network(folder: &str, description: Description, network: &[u8]) -> Result<Self, AgentError> {
        let invalid = |reason: String| AgentError::Invalid { folder: folder.to_owned(), file: NETWORK, reason };
        let file = TensorFile::read(network).map_err(|error| invalid(error.to_string()))?;
        let actor = Actor::read(&file, &description).map_err(invalid)?;
        Ok(Self { description, actor })
    }

    /// It with the numbers of its network in half precision: another agent, which has not been evaluated, in about half the bytes.
    ///
    /// # Errors
    /// A number that half precision does not have.
    pub fn in_half_precision(&self) -> Result<Self, AgentError> {
        let description = Description { evaluation: None, ..self.description.clone() };
        Ok(Self { description, actor: self.actor.rounded_to(Precision::Half)? })
    }

    /// It as an ONNX file, the normaliser included: `observation` [batch, numbers] to `action` [batch, entries].
    pub fn onnx(&self) -> Vec<u8> {
        let Actor { network, parameters, mean, std, clip, output, .. } = &self.actor;
        let known = &self.description;
        // Strings and numbers always have a JSON form.
        let channels = serde_json::to_string(&known.observation).unwrap_or_default();
        let remarks = [
            ("task", known.task.clone()),
            ("task_hash", known.task_hash.clone()),
            ("body", known.body.clone()),
            ("observation", channels),
            ("action_repeat", known.action_repeat.to_string()),
        ];
        let remarks = remarks.map(|(key, value)| (key.to_owned(), value));
        onnx::file(&onnx::Source { network, parameters, mean, std, clip: *clip, output, remarks: &remarks })
    }

    /// The sizes of its network.
    pub(crate) fn shape(&self) -> &Shape {
        &self.description.network
    }

    /// Numbers of an observation, and entries of an action.
    pub fn lengths(&self) -> (usize, usize) {
        (self.description.network.inputs, self.description.entries())
    }

    /// The sizes of its network, from what it sees to what it gives, in words.
    pub fn sizes(&self) -> String {
        let Shape { inputs, hidden, outputs, activation, residual, .. } = &self.description.network;
        let sizes: Vec<String> = [inputs].into_iter().chain(hidden).chain([outputs]).map(ToString::to_string).collect();
        let kind = if *residual { "residual " } else { "" };
        let synergies = self.description.synergies.as_ref().map_or(String::new(), |synergies| format!(", {synergies}"));
        format!("{}, {kind}{}{synergies}", sizes.join(" - "), activation.name())
    }

    /// How the output of its network acts.
    pub(crate) fn output(&self) -> &Output {
        &self.actor.output
    }

    /// What tells it from others: a hash of its network.
    pub fn digest(&self) -> String {
        hexadecimal(&Sha256::digest(self.actor.file(&self.description.observation).bytes())[..4])
    }

    /// Why it cannot act on any task that shows these channels and takes so many entries.
    pub(crate) fn unlike(&self, task: &CompiledTask, entries: usize) -> Option<String> {
        let known = &self.description;
        let channels = channels(task);
        if channels != known.observation {
            let place = (0..channels.len().max(known.observation.len()))
                .find(|place| channels.get(*place) != known.observation.get(*place))
                .unwrap_or_default();
            let shown = |channels: &[Channel]| {
                channels.get(place).map_or("nothing".to_owned(), |channel| format!("`{}` ({})", channel.name, channel.size))
            };
            let (found, expected) = (shown(&channels), shown(&known.observation));
            return Some(format!("it was trained to see something else: channel {} is {found}, expected {expected}", place + 1));
        }
        if entries != known.entries() {
            return Some(format!("it gives {} numbers, the action has {entries}", known.entries()));
        }
        None
    }

    /// Why it should not act on the task of an engine, if it should not.
    pub fn unfit(&self, engine: &Engine) -> Option<Unfit> {
        let (known, task) = (&self.description, engine.task());
        if let Some(reason) = self.unlike(task, engine.action_size()) {
            return Some(Unfit::Numbers(reason));
        }
        if task.body.name != known.body || body_hash(engine) != known.body_hash {
            return Some(Unfit::Meaning(format!("it was trained on another body than this `{}`", task.body.name)));
        }
        if task.hash != known.task_hash {
            return Some(Unfit::Meaning(match task.name == known.task {
                true => format!("the task `{}` has changed since it was trained", known.task),
                false => format!("it was trained on the task `{}`", known.task),
            }));
        }
        None
    }
}
