//! What acts: a network, the normaliser of what it sees, and how its output acts.

use super::{AgentError, Channel, Description};
use crate::dynsyn::Synergies;
use crate::play::Play;
use msk_network::file::{Precision, Stored, TensorFile};
use msk_network::{Mlp, Moments, Parameters, Shape, Tape};
use msk_runtime::episode::single_precision;

/// A network that acts.
#[derive(Debug, Clone, PartialEq)]
pub struct Actor {
    pub(super) network: Mlp,
    pub(super) parameters: Parameters,
    pub(super) mean: Vec<f32>,
    pub(super) std: Vec<f32>,
    pub(super) clip: f32,
    pub(super) output: Output,
    /// To which the numbers of its layers are rounded, and in which they are stored; those of the normaliser are single.
    precision: Precision,
}

/// How the output of a network acts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Output {
    /// As it is: the episode clips.
    Clipped,
    /// Its hyperbolic tangent.
    Squashed,
    /// Through groups of entries that act together.
    Synergies(Synergies),
}

impl Output {
    /// Its name in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Clipped => "identity",
            Self::Squashed => "tanh",
            Self::Synergies(_) => "synergies",
        }
    }

    /// Whether actions are squashed.
    pub fn squashes(&self) -> bool {
        !matches!(self, Self::Clipped)
    }

    /// The groups, if there are any.
    pub fn synergies(&self) -> Option<&Synergies> {
        match self {
            Self::Synergies(synergies) => Some(synergies),
            Self::Clipped | Self::Squashed => None,
        }
    }

    /// Outputs of a network for so many entries of an action.
    fn count(&self, entries: usize) -> usize {
        self.synergies().map_or(entries, Synergies::outputs)
    }
}

impl Actor {
    /// The first outputs of a network among the parameters of a learner, as many as act, with the present normaliser of observations.
    pub(crate) fn new(network: &Mlp, all: &Parameters, play: &Play, output: Output) -> Self {
        let shape = Shape { outputs: output.count(play.entries()), ..network.shape().clone() };
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
            output,
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

    /// The same for a network whose last layer has further rows, for the deviations of actions: these become `spread`, in the units of the
    /// learner, whatever is seen.
    pub(crate) fn begin_in(&self, network: &Mlp, all: &mut Parameters, spread: f32) {
        self.copy_to(network, all);
        network.fill_outputs(self.network.shape().outputs..network.shape().outputs, spread, all);
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
        let output = self.network.forward(tape, &self.parameters, seen);
        let acts = match &self.output {
            Output::Clipped => output,
            Output::Squashed => tape.tanh(output),
            Output::Synergies(synergies) => synergies.act(tape, output),
        };
        for (action, value) in actions.iter_mut().zip(tape.values(acts)) {
            *action = f64::from(*value);
        }
    }

    pub(super) fn file(&self, channels: &[Channel]) -> TensorFile {
        let mut file = TensorFile::default();
        for tensor in self.parameters.tensors() {
            let name = tensor.name.strip_prefix("policy.").unwrap_or(&tensor.name);
            file.add_as(self.precision, name, &tensor.shape, &self.parameters.values()[tensor.range.clone()]);
        }
        file.add("observation.mean", &[self.mean.len()], self.mean.as_slice());
        file.add("observation.std", &[self.std.len()], self.std.as_slice());
        let shape = self.network.shape();
        // The policy `network` knows plain layers alone and refuses the name.
        let kind = match (shape.residual, shape.layer_norm) {
            (true, _) => "residual ",
            (false, true) => "layer_norm ",
            (false, false) => "",
        };
        let entries = [
            ("activation", format!("{kind}{}", shape.activation.name())),
            ("output_activation", self.output.name().to_owned()),
            ("observation_clip", self.clip.to_string()),
            // Strings and numbers always have a JSON form.
            ("observation", serde_json::to_string(channels).unwrap_or_default()),
        ];
        file.metadata.extend(entries.map(|(key, value)| (key.to_owned(), value)));
        if let Some(synergies) = self.output.synergies() {
            file.metadata.insert("synergies".to_owned(), serde_json::to_string(synergies).unwrap_or_default());
        }
        file
    }

    /// # Errors
    /// Tensors of other sizes, in words that continue the name of the file.
    pub(super) fn read(file: &TensorFile, description: &Description) -> Result<Self, String> {
        // Before room for them is made: a description may name any sizes.
        let held = file.tensors.values().map(|tensor| tensor.values.len()).sum::<usize>();
        if description.network.numbers() > held {
            let described = description.network.numbers();
            return Err(format!("holds {held} numbers, and `agent.toml` describes a network of {described}"));
        }
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
        Ok(Self { network, parameters, mean, std, clip: description.clip, output: description.output(), precision })
    }

    /// It with the numbers of its layers rounded.
    ///
    /// # Errors
    /// A tensor with a number that is too large for that precision.
    pub(super) fn rounded_to(&self, precision: Precision) -> Result<Self, AgentError> {
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
