//! Agents: what was learned, as a folder, and as a policy.
//!
//! A folder holds `agent.toml` (what it was trained on and how well it does), `policy.safetensors` (its network with the normaliser of
//! observations, as the policy `network` reads it) and `curve.jsonl` (how it became what it is).

use crate::curve;
use crate::evaluate::Evaluation;
use crate::onnx;
use crate::play::Play;
use msk_network::file::TensorFile;
use msk_network::{Kernel, Mlp, Moments, Parameters, Processor, Shape, Tape};
use msk_program::digest::hexadecimal;
use msk_program::task::CompiledTask;
use msk_runtime::episode::{Engine, single_precision};
use msk_runtime::policy::{Policy, PolicyContext, PolicyError, PolicyMaker, PolicySource};
use msk_storage::{Folder, StorageError};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

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
            file.add(name, &tensor.shape, &self.parameters.values()[tensor.range.clone()]);
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
            Some((found, values)) if found == shape => Ok(values),
            Some((found, _)) => Err(format!("holds `{name}` of shape {found:?}: expected {shape:?}")),
            None => Err(format!("lacks the tensor `{name}`")),
        };
        for known in parameters.tensors().to_vec() {
            let name = known.name.strip_prefix("policy.").unwrap_or(&known.name);
            parameters.values_mut()[known.range].copy_from_slice(tensor(name, &known.shape)?);
        }
        let width = [description.network.inputs];
        let (mean, std) = (tensor("observation.mean", &width)?.clone(), tensor("observation.std", &width)?.clone());
        if let Some(index) = std.iter().position(|std| *std <= 0.0) {
            return Err(format!("holds {} in `observation.std`, number {index}: expected more than 0", std[index]));
        }
        Ok(Self { network, parameters, mean, std, clip: description.clip, squash: description.squash })
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
        own.replace(Path::new(NETWORK), &self.actor.file(&self.description.observation).bytes())?;
        own.replace(Path::new(curve::FILE), lines)?;
        // Last: what has a description is whole. Plain data of names and numbers always has a TOML form.
        own.replace(Path::new(DESCRIPTION), toml::to_string(&self.description).unwrap_or_default().as_bytes())
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
        let invalid = |file: &'static str, reason: String| AgentError::Invalid { folder: shown(), file, reason };
        let text = folder.read_text(Path::new(DESCRIPTION), LARGEST_DESCRIPTION)?.ok_or_else(missing(DESCRIPTION))?;
        let description: Description =
            toml::from_str(&text).map_err(|error| invalid(DESCRIPTION, format!("describes no agent: {error}")))?;
        let observed: usize = description.observation.iter().map(|channel| channel.size).sum();
        let sizes = description.network.hidden.iter().chain([&description.network.outputs]);
        if observed != description.network.inputs || sizes.copied().any(|size| !(1..=1 << 20).contains(&size)) {
            let reason = format!("describes a network of {} inputs for {observed} observed numbers", description.network.inputs);
            return Err(invalid(DESCRIPTION, reason));
        }
        let bytes = folder.read(Path::new(NETWORK), LARGEST_NETWORK)?.ok_or_else(missing(NETWORK))?;
        let file = TensorFile::read(&bytes).map_err(|error| invalid(NETWORK, error.to_string()))?;
        let actor = Actor::read(&file, &description).map_err(|reason| invalid(NETWORK, reason))?;
        Ok(Self { description, actor })
    }

    /// It as an ONNX file, the normaliser included: `observation` [batch, numbers] to `action` [batch, entries].
    pub fn onnx(&self) -> Vec<u8> {
        let Actor { network, parameters, mean, std, clip, squash } = &self.actor;
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

    /// Why it cannot act on a task; `any_task` allows one that only means something else.
    fn unfit(&self, context: &PolicyContext<'_>, any_task: bool) -> Option<String> {
        let known = &self.description;
        if let Some(reason) = self.unlike(context.task, context.action_size()) {
            return Some(reason);
        }
        if any_task {
            return None;
        }
        if context.task.body.name != known.body || body_hash(context.engine) != known.body_hash {
            let remedy = "`agent --any-task FOLDER` uses it nevertheless";
            return Some(format!("it was trained on another body than this `{}`; {remedy}", context.task.body.name));
        }
        if context.task.hash != known.task_hash {
            let mut reason = String::new();
            if context.task.name == known.task {
                let _ = write!(reason, "the task `{}` has changed since it was trained", known.task);
            } else {
                let _ = write!(reason, "it was trained on the task `{}`", known.task);
            }
            return Some(format!("{reason}; `agent --any-task FOLDER` uses it nevertheless"));
        }
        None
    }
}

/// An agent that acts in episodes.
struct AgentPolicy {
    name: String,
    agent: Arc<Agent>,
    any_task: bool,
    tape: Tape,
    /// The task that it was last found to fit.
    fits: Option<Arc<CompiledTask>>,
}

impl Policy for AgentPolicy {
    fn name(&self) -> &str {
        &self.name
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        if self.fits.as_ref().is_some_and(|task| Arc::ptr_eq(task, context.engine.task())) {
            return Ok(());
        }
        if let Some(reason) = self.agent.unfit(context, self.any_task) {
            return Err(PolicyError::Unable { policy: self.name.clone(), reason });
        }
        self.fits = Some(context.engine.task().clone());
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        self.agent.actor.act(&mut self.tape, context.observation, action);
        Ok(())
    }
}

/// An agent, to be opened by workers.
#[derive(Debug)]
struct Maker {
    name: String,
    agent: Arc<Agent>,
    any_task: bool,
    kernel: Arc<dyn Kernel>,
}

impl PolicyMaker for Maker {
    fn open<'a>(&self, _: &'a AtomicBool) -> Result<Box<dyn Policy + 'a>, PolicyError> {
        let tape = Tape::new(self.kernel.clone());
        Ok(Box::new(AgentPolicy {
            name: self.name.clone(),
            agent: self.agent.clone(),
            any_task: self.any_task,
            tape,
            fits: None,
        }))
    }
}

/// The agent that `text` names: `agent FOLDER` or `agent --any-task FOLDER`; `None` if it names none. Files are read here, so that all
/// episodes see the same; results tell two agents of one name apart.
///
/// # Errors
/// A folder that holds no agent.
pub fn source(text: &str) -> Option<Result<PolicySource, PolicyError>> {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word == "agent").then(|| named(rest.trim()))
}

fn named(rest: &str) -> Result<PolicySource, PolicyError> {
    let (any_task, path) = match rest.strip_prefix("--any-task") {
        Some(path) => (true, path.trim()),
        None => (false, rest),
    };
    if path.is_empty() {
        return Err(PolicyError::Incomplete { policy: "agent", example: "agent results/walk" });
    }
    let unreadable = |reason: String| PolicyError::Unreadable { path: path.to_owned(), reason };
    let agent = Agent::read(Path::new(path)).map_err(|error| unreadable(error.to_string()))?;
    let name = format!("agent {path} ({})", agent.digest());
    let kernel = Processor::new(std::num::NonZeroUsize::MIN).map_err(|error| unreadable(error.to_string()))?;
    let maker = Maker { name: name.clone(), agent: Arc::new(agent), any_task, kernel: Arc::new(kernel) };
    Ok(PolicySource::made(name, Arc::new(maker)))
}
