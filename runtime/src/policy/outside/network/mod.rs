//! A network that acts: a file of weights, evaluated at every control step.

mod file;
mod mlp;

use super::source_file;
use crate::policy::{Policy, PolicyContext, PolicyError};
use file::{Channel, NetworkFile};
use std::sync::Arc;

/// A multilayer perceptron from a file.
pub(crate) struct Network {
    name: String,
    path: String,
    file: Arc<NetworkFile>,
    values: Vec<f32>,
    spare: Vec<f32>,
}

/// A file that has been read, for all workers.
#[derive(Debug, Clone)]
pub(crate) struct Weights {
    path: String,
    file: Arc<NetworkFile>,
}

impl Weights {
    /// Reads a file, and tells what tells it from others of its name.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no network.
    pub fn read(path: &str) -> Result<(Self, String), PolicyError> {
        let (bytes, digest) = source_file(path)?;
        let unreadable = |reason: String| PolicyError::Unreadable { path: path.to_owned(), reason: format!("it {reason}") };
        let file = NetworkFile::read(&bytes).map_err(unreadable)?;
        Ok((Self { path: path.to_owned(), file: Arc::new(file) }, digest))
    }
}

impl Network {
    pub fn new(name: &str, weights: &Weights) -> Self {
        let (path, file) = (weights.path.clone(), weights.file.clone());
        Self { name: name.to_owned(), path, file, values: Vec::new(), spare: Vec::new() }
    }

    fn unable(&self, reason: String) -> PolicyError {
        PolicyError::Unable { policy: self.name.clone(), reason: format!("`{}` {reason}", self.path) }
    }
}

impl Policy for Network {
    fn name(&self) -> &str {
        &self.name
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        if let Some(known) = &self.file.channels
            && let Some(difference) = unlike(known, context)
        {
            return Err(self.unable(format!("was trained to see something else: {difference}")));
        }
        let (network, seen, entries) = (&self.file.network, context.observation.len(), context.action_size());
        if network.inputs() != seen {
            return Err(self.unable(format!("takes {} numbers, the observation has {seen}", network.inputs())));
        }
        if network.outputs() != entries {
            return Err(self.unable(format!("gives {} numbers, the action has {entries}", network.outputs())));
        }
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let Self { file, values, spare, .. } = self;
        values.clear();
        values.extend(context.observation.iter().map(|value| *value as f32));
        if let Some(normaliser) = &file.normaliser {
            for ((value, mean), std) in values.iter_mut().zip(&normaliser.mean).zip(&normaliser.std) {
                let scaled = (*value - mean) / std;
                *value = match normaliser.clip {
                    Some(clip) if scaled > clip => clip,
                    Some(clip) if scaled < -clip => -clip,
                    _ => scaled,
                };
            }
        }
        file.network.forward(values, spare);
        for (entry, value) in action.iter_mut().zip(values.iter()) {
            *entry = f64::from(*value);
        }
        Ok(())
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
