//! Agents: what was learned, as a folder.
//!
//! A folder holds `agent.toml` (what it was trained on and how well it does), `policy.safetensors` (its network with the normaliser of
//! observations, as the policy `network` reads it) and `curve.jsonl` (how it became what it is).

use crate::curve;
use crate::evaluate::Evaluation;
use crate::onnx;
use crate::play::Play;
use msk_network::file::{Precision, Stored, TensorFile};
use msk_network::{Mlp, Moments, Parameters, Shape, Tape};
use msk_program::digest::hexadecimal;
use msk_program::task::CompiledTask;
use msk_runtime::episode::{Engine, single_precision};
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

/// A network that acts.
#[derive(Debug, Clone, PartialEq)]
pub struct Actor {
    network: Mlp,
    parameters: Parameters,
    mean: Vec<f32>,
    std: Vec<f32>,
    clip: f32,
    /// Whether the hyperbolic tangent of its output acts; else the episode clips.
    squash: bool,
    /// To which the numbers of its layers are rounded, and in which they are stored; those of the normaliser are single.
    precision: Precision,
}

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
    /// How it did when it was last evaluated.
    pub evaluation: Option<Evaluation>,
    network: Shape,
    observation: Vec<Channel>,
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
        let observed: usize = description.observation.iter().map(|channel| channel.size).sum();
        if observed != *inputs || hidden.iter().chain([outputs]).any(|size| !(1..=1 << 20).contains(size)) {
            return Err(invalid(format!("describes a network of {inputs} inputs for {observed} observed numbers")));
        }
        Ok(description)
    }
}

impl Actor {
    /// The first `entries` outputs of a network among the parameters of a learner, with the present normaliser of observations.
    pub(crate) fn new(network: &Mlp, all: &Parameters, play: &Play, entries: usize, squash: bool) -> Self {
        let shape = Shape { outputs: entries, ..network.shape().clone() };
        let mut parameters = Parameters::default();
        let own = Mlp::new("policy", &shape, &mut parameters);
        let from = all.tensors().iter().filter(|tensor| network.range().contains(&tensor.range.start));
        let to = parameters.tensors().to_vec();
        for (from, to) in from.zip(to) {
            // Rows of the last layer that mean something else are left out.
            let source = from.range.start..from.range.start + to.range.len();
            parameters.values_mut()[to.range].copy_from_slice(&all.values()[source]);
        }
        let moments = &play.normaliser.moments()[..shape.inputs];
        Self {
            network: own,
            parameters,
            mean: moments.iter().map(|moments| moments.mean as f32).collect(),
            std: moments.iter().map(|moments| moments.deviation() as f32).collect(),
            clip: play.normaliser.clip() as f32,
            squash,
            precision: Precision::Single,
        }
    }

    /// Writes its numbers into a network among the parameters of a learner whose hidden layers are the same; rows of the last layer that
    /// mean something else stay as they are.
    pub(crate) fn copy_to(&self, network: &Mlp, all: &mut Parameters) {
        let to: Vec<_> = all.tensors().iter().filter(|tensor| network.range().contains(&tensor.range.start)).cloned().collect();
        for (from, to) in self.parameters.tensors().iter().zip(to) {
            let part = to.range.start..to.range.start + from.range.len();
            all.values_mut()[part].copy_from_slice(&self.parameters.values()[from.range.clone()]);
        }
    }

    /// The same for a network whose last layer has as many rows again, for the deviations of actions: these become `spread`, in the units of
    /// the learner, whatever is seen.
    pub(crate) fn begin_in(&self, network: &Mlp, all: &mut Parameters, spread: f32) {
        self.copy_to(network, all);
        if let Some(last) = network.layers().last() {
            let (entries, inputs) = (last.outputs / 2, last.inputs);
            let values = all.values_mut();
            values[last.weight.clone()][entries * inputs..].fill(0.0);
            values[last.bias.clone()][entries..].fill(spread);
        }
    }

    /// The moments by which it normalises, as if it had seen so many rows.
    pub(crate) fn moments(&self, rows: f64) -> impl Iterator<Item = Moments> {
        self.mean.iter().zip(&self.std).map(move |(mean, std)| Moments::of(f64::from(*mean), f64::from(*std), rows))
    }

    /// Writes an action for each row of observations.
    pub fn act(&self, tape: &mut Tape, observations: &[f64], actions: &mut [f64]) {
        let width = self.mean.len();
        tape.clear();
        let scaled = |(index, value): (usize, &f64)| {
            let scaled = (single_precision(*value) - self.mean[index % width]) / self.std[index % width];
            if scaled > self.clip {
                self.clip
            } else if scaled < -self.clip {
                -self.clip
            } else {
                scaled
            }
        };
        let rows = observations.len() / width.max(1);
        let seen = tape.constant(rows, width, observations.iter().enumerate().map(scaled));
        let mut output = self.network.forward(tape, &self.parameters, seen);
        if self.squash {
            output = tape.tanh(output);
        }
        for (action, output) in actions.iter_mut().zip(tape.values(output)) {
            *action = f64::from(*output);
        }
    }

    fn file(&self, channels: &[Channel]) -> TensorFile {
        let mut file = TensorFile::default();
        for tensor in self.parameters.tensors() {
            let name = tensor.name.strip_prefix("policy.").unwrap_or(&tensor.name);
            file.add_as(self.precision, name, &tensor.shape, &self.parameters.values()[tensor.range.clone()]);
        }
        file.add("observation.mean", &[self.mean.len()], self.mean.as_slice());
        file.add("observation.std", &[self.std.len()], self.std.as_slice());
        let shape = self.network.shape();
        // The policy `network` knows no layer norm and refuses the name.
        let norm = if shape.layer_norm { "layer_norm " } else { "" };
        let entries = [
            ("activation", format!("{norm}{}", shape.activation.name())),
            ("output_activation", if self.squash { "tanh" } else { "identity" }.to_owned()),
            ("observation_clip", self.clip.to_string()),
            // Strings and numbers always have a JSON form.
            ("observation", serde_json::to_string(channels).unwrap_or_default()),
        ];
        file.metadata.extend(entries.map(|(key, value)| (key.to_owned(), value)));
        file
    }

    /// # Errors
    /// Tensors of other sizes, in words that continue the name of the file.
    fn read(file: &TensorFile, description: &Description) -> Result<Self, String> {
        let mut parameters = Parameters::default();
        let network = Mlp::new("policy", &description.network, &mut parameters);
        let tensor = |name: &str, shape: &[usize]| match file.tensors.get(name) {
            Some(stored) if stored.shape == shape => Ok(stored),
            Some(Stored { shape: found, .. }) => Err(format!("holds `{name}` of shape {found:?}: expected {shape:?}")),
            None => Err(format!("lacks the tensor `{name}`")),
        };
        let mut precision = Precision::Half;
        for known in parameters.tensors().to_vec() {
            let name = known.name.strip_prefix("policy.").unwrap_or(&known.name);
            let stored = tensor(name, &known.shape)?;
            parameters.values_mut()[known.range].copy_from_slice(&stored.values);
            if stored.precision == Precision::Single {
                precision = Precision::Single;
            }
        }
        let width = [description.network.inputs];
        let numbers = |name: &str| tensor(name, &width).map(|stored| stored.values.clone());
        let (mean, std) = (numbers("observation.mean")?, numbers("observation.std")?);
        if let Some(index) = std.iter().position(|std| *std <= 0.0) {
            return Err(format!("holds {} in `observation.std`, number {index}: expected more than 0", std[index]));
        }
        Ok(Self { network, parameters, mean, std, clip: description.clip, squash: description.squash, precision })
    }

    /// It with the numbers of its layers rounded.
    ///
    /// # Errors
    /// A tensor with a number that is too large for that precision.
    fn rounded_to(&self, precision: Precision) -> Result<Self, AgentError> {
        let mut rounded = Self { precision, ..self.clone() };
        for tensor in self.parameters.tensors() {
            for value in &mut rounded.parameters.values_mut()[tensor.range.clone()] {
                let stored = precision.round(*value);
                if !stored.is_finite() {
                    return Err(AgentError::TooLarge { tensor: tensor.name.clone(), value: *value });
                }
                *value = stored;
            }
        }
        Ok(rounded)
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
    pub(crate) fn new(engine: &Engine, actor: Actor, (algorithm, seed, steps): (&str, u64, u64)) -> Self {
        let task = engine.task();
        let description = Description {
            task: task.name.clone(),
            task_hash: task.hash.clone(),
            body: task.body.name.clone(),
            body_hash: body_hash(engine),
            algorithm: algorithm.to_owned(),
            seed,
            steps,
            squash: actor.squash,
            clip: actor.clip,
            evaluation: None,
            network: actor.network.shape().clone(),
            observation: channels(task),
        };
        Self { description, actor }
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
        let Actor { network, parameters, mean, std, clip, squash, .. } = &self.actor;
        let known = &self.description;
        // Strings and numbers always have a JSON form.
        let channels = serde_json::to_string(&known.observation).unwrap_or_default();
        let remarks = [("task", &known.task), ("task_hash", &known.task_hash), ("body", &known.body), ("observation", &channels)];
        let remarks = remarks.map(|(key, value)| (key.to_owned(), value.clone()));
        onnx::file(&onnx::Source { network, parameters, mean, std, clip: *clip, squash: *squash, remarks: &remarks })
    }

    /// The sizes of its network.
    pub(crate) fn shape(&self) -> &Shape {
        &self.description.network
    }

    /// Numbers of an observation, and entries of an action.
    pub fn lengths(&self) -> (usize, usize) {
        (self.description.network.inputs, self.description.network.outputs)
    }

    /// The sizes of its network, from what it sees to what it gives, in words.
    pub fn sizes(&self) -> String {
        let Shape { inputs, hidden, outputs, activation, .. } = &self.description.network;
        let sizes: Vec<String> = [inputs].into_iter().chain(hidden).chain([outputs]).map(ToString::to_string).collect();
        format!("{}, {}", sizes.join(" - "), activation.name())
    }

    /// Whether the hyperbolic tangent of its output acts.
    pub(crate) fn squashes(&self) -> bool {
        self.actor.squash
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
        if entries != known.network.outputs {
            return Some(format!("it gives {} numbers, the action has {entries}", known.network.outputs));
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
