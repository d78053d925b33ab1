//! A network that acts: a file of weights, evaluated at every control step.

mod file;
mod mlp;
mod onnx;

use super::source_file;
use crate::policy::{Policy, PolicyContext, PolicyError};
use file::{Channel, NetworkFile};
use msk_program::task::Channel as TaskChannel;
use onnx::Graph;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A network from a file, for one episode at a time.
pub(crate) struct Network {
    name: String,
    path: String,
    evaluation: Evaluation,
}

/// A file that has been read, for all workers.
#[derive(Debug, Clone)]
pub(crate) struct Weights {
    path: String,
    content: NetworkContent,
}

/// What is in a file.
#[derive(Debug, Clone)]
pub(crate) enum NetworkContent {
    Perceptron(Arc<NetworkFile>),
    Graph(Graph),
}

impl NetworkContent {
    /// From the bytes of the file at `path`, whose ending tells the format.
    ///
    /// # Errors
    /// What is wrong with it, in words that continue the name of the file.
    pub fn read(path: &str, bytes: &[u8]) -> Result<Self, String> {
        let is_onnx = Path::new(path).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("onnx"));
        match is_onnx {
            true => Graph::read(bytes.to_vec()).map(Self::Graph),
            false => NetworkFile::read(bytes).map(|file| Self::Perceptron(Arc::new(file))),
        }
    }
}

impl Weights {
    /// Reads a file, and tells what tells it from others of its name.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no network.
    pub fn read(path: &str) -> Result<(Self, String), PolicyError> {
        let (bytes, digest) = source_file(path)?;
        let unreadable = |reason: String| PolicyError::Unreadable { path: path.to_owned(), reason: format!("it {reason}") };
        let content = NetworkContent::read(path, &bytes).map_err(unreadable)?;
        Ok((Self { path: path.to_owned(), content }, digest))
    }
}

/// One worker's evaluation of a network.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    kind: Kind,
    /// What of the observation it sees; all of it where nothing is chosen.
    seen: Option<Vec<Range<usize>>>,
    values: Vec<f32>,
    spare: Vec<f32>,
}

#[derive(Debug, Clone)]
enum Kind {
    Perceptron(Arc<NetworkFile>),
    Graph(onnx::Evaluation),
}

impl Evaluation {
    /// Of a network that sees the whole observation.
    pub fn new(content: &NetworkContent) -> Self {
        let kind = match content {
            NetworkContent::Perceptron(file) => Kind::Perceptron(file.clone()),
            NetworkContent::Graph(graph) => Kind::Graph(onnx::Evaluation::new(graph)),
        };
        Self { kind, seen: None, values: Vec::new(), spare: Vec::new() }
    }

    /// Of a network that sees the channels which it was trained to see, by their names, where its file has them.
    ///
    /// # Errors
    /// A channel that the task does not have, in words that continue the name of the file.
    pub fn of_channels(content: &NetworkContent, channels: &[TaskChannel]) -> Result<Self, String> {
        let mut evaluation = Self::new(content);
        if let Some(known) = evaluation.channels() {
            let place = |known: &Channel| match channels.iter().find(|channel| channel.name == known.name) {
                Some(channel) if channel.size == known.size => Ok(channel.offset..channel.offset + channel.size),
                Some(channel) => Err(format!("sees `{}` of size {}, the task has {}", known.name, known.size, channel.size)),
                None => Err(format!("sees a channel `{}`, which the task does not observe", known.name)),
            };
            evaluation.seen = Some(known.iter().map(place).collect::<Result<_, _>>()?);
        }
        Ok(evaluation)
    }

    /// The channels that the file names.
    fn channels(&self) -> Option<&[Channel]> {
        match &self.kind {
            Kind::Perceptron(file) => file.channels.as_deref(),
            Kind::Graph(_) => None,
        }
    }

    /// Whether it takes and gives as many numbers as there are.
    ///
    /// # Errors
    /// It does not, in words that continue the name of the file; `entries` are those `of` something.
    pub fn must_fit(&self, observation: usize, entries: usize, of: &str) -> Result<(), String> {
        let seen = self.seen.as_ref().map_or(observation, |seen| seen.iter().map(Range::len).sum());
        let [inputs, outputs] = match &self.kind {
            Kind::Perceptron(file) => [Some(file.network.inputs()), Some(file.network.outputs())],
            Kind::Graph(evaluation) => evaluation.sizes(),
        };
        if let Some(inputs) = inputs.filter(|inputs| *inputs != seen) {
            return Err(format!("takes {inputs} numbers, the observation has {seen}"));
        }
        match outputs.filter(|outputs| *outputs != entries) {
            Some(outputs) => Err(format!("gives {outputs} numbers, expected {entries}, one for each {of}")),
            None => Ok(()),
        }
    }

    /// Writes what answers to an observation.
    ///
    /// # Errors
    /// An evaluation that fails or gives another number of entries, in words that continue the name of the file.
    pub fn act(&mut self, observation: &[f64], action: &mut [f64]) -> Result<(), String> {
        let Self { kind, seen, values, spare } = self;
        values.clear();
        match seen {
            Some(seen) => {
                let parts = seen.iter().filter_map(|range| observation.get(range.clone()));
                values.extend(parts.flatten().map(|value| *value as f32));
            }
            None => values.extend(observation.iter().map(|value| *value as f32)),
        }
        match kind {
            Kind::Perceptron(file) => {
                file.normaliser.iter().for_each(|normaliser| normaliser.apply(values));
                file.network.forward(values, spare);
            }
            Kind::Graph(evaluation) => evaluation.forward(values)?,
        }
        if values.len() != action.len() {
            return Err(format!("gives {} numbers, {} are expected", values.len(), action.len()));
        }
        action.iter_mut().zip(values).for_each(|(entry, value)| *entry = f64::from(*value));
        Ok(())
    }
}

impl Network {
    pub fn new(name: &str, weights: &Weights) -> Self {
        Self { name: name.to_owned(), path: weights.path.clone(), evaluation: Evaluation::new(&weights.content) }
    }

    fn unable(&self, reason: &str) -> PolicyError {
        PolicyError::Unable { policy: self.name.clone(), reason: format!("`{}` {reason}", self.path) }
    }
}

impl Policy for Network {
    fn name(&self) -> &str {
        &self.name
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        if let Some(difference) = self.evaluation.channels().and_then(|known| unlike(known, context)) {
            return Err(self.unable(&format!("was trained to see something else: {difference}")));
        }
        let fits = self.evaluation.must_fit(context.observation.len(), context.action_size(), "entry of the action");
        fits.map_err(|reason| self.unable(&reason))
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let acted = self.evaluation.act(context.observation, action);
        acted.map_err(|reason| self.unable(&reason))
    }
}

/// The first channel in which a task's observation is not what a network was trained to see.
fn unlike(known: &[Channel], context: &PolicyContext<'_>) -> Option<String> {
    let channels = &context.task.channels;
    let described =
        |channel: Option<(&str, usize)>| channel.map_or("nothing".to_owned(), |(name, size)| format!("`{name}` ({size})"));
    (0..usize::max(known.len(), channels.len())).find_map(|place| {
        let expected = known.get(place).map(|channel| (channel.name.as_str(), channel.size));
        let found = channels.get(place).map(|channel| (channel.name.as_str(), channel.size));
        (expected != found).then(|| format!("channel {} is {}, expected {}", place + 1, described(found), described(expected)))
    })
}
