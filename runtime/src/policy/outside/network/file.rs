//! Networks in files: the tensors of a multilayer perceptron and its normaliser, as safetensors. `docs/policies.md` is for those
//! who write them.

use super::mlp::{Activation, Layer, Mlp};
use half::f16;
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::Deserialize;
use std::collections::HashMap;

/// A network with what it was trained to see.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NetworkFile {
    pub network: Mlp,
    pub normaliser: Option<Normaliser>,
    /// The channels of the observation, if the file names them.
    pub channels: Option<Vec<Channel>>,
}

/// `clip((observation - mean) / std, -clip, clip)`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Normaliser {
    pub mean: Vec<f32>,
    pub std: Vec<f32>,
    pub clip: Option<f32>,
}

impl Normaliser {
    /// Normalises an observation.
    pub fn apply(&self, values: &mut [f32]) {
        for ((value, mean), std) in values.iter_mut().zip(&self.mean).zip(&self.std) {
            let scaled = (*value - mean) / std;
            *value = match self.clip {
                Some(clip) if scaled > clip => clip,
                Some(clip) if scaled < -clip => -clip,
                _ => scaled,
            };
        }
    }
}

/// A channel of an observation.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(crate) struct Channel {
    pub name: String,
    pub size: usize,
}

impl NetworkFile {
    /// From the bytes of a file.
    ///
    /// # Errors
    /// What is missing or wrong, in words that continue the name of the file.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let no_file = |error: safetensors::SafeTensorError| format!("is no safetensors file: {error}");
        let tensors = SafeTensors::deserialize(bytes).map_err(no_file)?;
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(no_file)?;
        let metadata = header.metadata().clone().unwrap_or_default();
        let network = network(&tensors, &metadata)?;
        let normaliser = normaliser(&tensors, &metadata, network.inputs())?;
        let channels = metadata.get("observation").map(|text| {
            serde_json::from_str(text).map_err(|error| format!("has metadata `observation` that list no channels: {error}"))
        });
        Ok(Self { network, normaliser, channels: channels.transpose()? })
    }
}

fn network(tensors: &SafeTensors<'_>, metadata: &HashMap<String, String>) -> Result<Mlp, String> {
    let mut names: Vec<String> =
        tensors.names().into_iter().filter_map(|name| name.strip_suffix(".weight").map(str::to_owned)).collect();
    names.sort_by_cached_key(|name| in_order(name));
    let hidden = match metadata.get("activation") {
        Some(named) => Activation::NAMED.into_iter().find(|(name, _)| name == named).map(|(_, activation)| activation),
        None if names.len() <= 1 => Some(Activation::Identity),
        None => None,
    };
    let hidden = hidden.ok_or_else(|| {
        let all = Activation::NAMED.map(|(name, _)| name).join(", ");
        let found = metadata.get("activation").map_or("nothing".to_owned(), |named| format!("`{named}`"));
        format!("names the activation of its hidden layers in the metadata `activation`: expected one of {all}, found {found}")
    })?;
    let last = match metadata.get("output_activation").map(String::as_str) {
        None | Some("identity") => Activation::Identity,
        Some("tanh") => Activation::Tanh,
        Some(other) => return Err(format!("has the output activation `{other}`: expected identity or tanh")),
    };
    let mut layers: Vec<Layer> = Vec::new();
    for (place, name) in names.iter().enumerate() {
        let activation = if place + 1 == names.len() { last } else { hidden };
        let (weight, shape) = numbers(tensors, &format!("{name}.weight"))?;
        let &[outputs, inputs] = shape.as_slice() else {
            return Err(format!("holds `{name}.weight` of shape {shape:?}: expected [outputs, inputs]"));
        };
        let (bias, shape) = numbers(tensors, &format!("{name}.bias"))?;
        if shape != [outputs] || outputs == 0 || inputs == 0 {
            return Err(format!(
                "holds `{name}.bias` of shape {shape:?}: expected [{outputs}], as its weight of {inputs} inputs"
            ));
        }
        if let Some(before) = layers.last().map(|layer| layer.bias.len()).filter(|before| *before != inputs) {
            return Err(format!("holds `{name}.weight` with {inputs} inputs, but the layer before has {before} outputs"));
        }
        layers.push(Layer { weight, bias, inputs, activation });
    }
    if layers.is_empty() {
        return Err("holds no layer: tensors `0.weight` and `0.bias`, `2.weight` and `2.bias`, and so on".into());
    }
    Ok(Mlp { layers })
}

fn normaliser(
    tensors: &SafeTensors<'_>,
    metadata: &HashMap<String, String>,
    inputs: usize,
) -> Result<Option<Normaliser>, String> {
    const MEAN: &str = "observation.mean";
    const STD: &str = "observation.std";
    let there = |name: &str| tensors.names().into_iter().any(|known| known == name);
    if !there(MEAN) && !there(STD) {
        return Ok(None);
    }
    let (mean, mean_shape) = numbers(tensors, MEAN)?;
    let (std, std_shape) = numbers(tensors, STD)?;
    for (name, shape) in [(MEAN, mean_shape), (STD, std_shape)] {
        if shape != [inputs] {
            return Err(format!("holds `{name}` of shape {shape:?}: expected [{inputs}], as the first layer has inputs"));
        }
    }
    if let Some(index) = std.iter().position(|std| *std <= 0.0) {
        return Err(format!("holds {} in `{STD}`, number {index}: expected more than 0", std[index]));
    }
    let clip = metadata.get("observation_clip").map(|text| match text.parse::<f32>() {
        Ok(clip) if clip > 0.0 && clip.is_finite() => Ok(clip),
        _ => Err(format!("has the metadata `observation_clip` {text}: expected a number above 0")),
    });
    Ok(Some(Normaliser { mean, std, clip: clip.transpose()? }))
}

/// The numbers of a tensor, and its shape.
fn numbers(tensors: &SafeTensors<'_>, name: &str) -> Result<(Vec<f32>, Vec<usize>), String> {
    let tensor: TensorView<'_> = tensors.tensor(name).map_err(|_| format!("lacks the tensor `{name}`"))?;
    let values: Vec<f32> = match tensor.dtype() {
        Dtype::F16 => tensor.data().as_chunks::<2>().0.iter().map(|bytes| f16::from_le_bytes(*bytes).to_f32()).collect(),
        Dtype::F32 => tensor.data().as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect(),
        Dtype::F64 => tensor.data().as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes) as f32).collect(),
        other => return Err(format!("holds `{name}` as {other:?}: expected F16, F32 or F64")),
    };
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(format!("holds {} in `{name}`, number {index}", values[index])),
        None => Ok((values, tensor.shape().to_vec())),
    }
}

/// Names in the order in which people count: `layers.2` before `layers.10`.
fn in_order(name: &str) -> Vec<(u64, String)> {
    name.split(['.', '_'])
        .map(|part| part.parse().map_or((u64::MAX, part.to_owned()), |number| (number, String::new())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use safetensors::serialize;

    type Tensor = (&'static str, Vec<usize>, Vec<f32>);
    type Tensors = Vec<Tensor>;
    /// What is changed, the metadata, and the message.
    type Case<'a> = (fn(&mut Tensors), &'a [(&'a str, &'a str)], &'a str);

    fn file(tensors: &Tensors, metadata: &[(&str, &str)]) -> Vec<u8> {
        let bytes: Vec<Vec<u8>> =
            tensors.iter().map(|(.., values)| values.iter().flat_map(|value| value.to_le_bytes()).collect()).collect();
        let view = |((name, shape, _), bytes): (&Tensor, &'static [u8])| {
            (*name, TensorView::new(Dtype::F32, shape.clone(), bytes).unwrap())
        };
        let leaked = bytes.into_iter().map(|bytes| -> &'static [u8] { bytes.leak() });
        let metadata = metadata.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        serialize(tensors.iter().zip(leaked).map(view), Some(metadata)).unwrap()
    }

    fn whole() -> Tensors {
        vec![
            ("10.weight", vec![1, 2], vec![1.0, -1.0]),
            ("10.bias", vec![1], vec![0.25]),
            ("2.weight", vec![2, 3], vec![1.0; 6]),
            ("2.bias", vec![2], vec![0.0; 2]),
            ("observation.mean", vec![3], vec![0.0; 3]),
            ("observation.std", vec![3], vec![2.0; 3]),
        ]
    }

    #[test]
    fn layers_come_in_the_order_of_their_numbers() {
        let metadata = [
            ("activation", "relu"),
            ("output_activation", "tanh"),
            ("observation_clip", "5"),
            ("observation", r#"[{"name": "com.height", "size": 3}]"#),
        ];
        let read = NetworkFile::read(&file(&whole(), &metadata)).unwrap();
        let sizes: Vec<(usize, usize)> = read.network.layers.iter().map(|layer| (layer.inputs, layer.bias.len())).collect();
        assert_eq!(sizes, [(3, 2), (2, 1)]);
        assert_eq!(read.network.layers[0].activation, Activation::Relu);
        assert_eq!(read.network.layers[1].activation, Activation::Tanh);
        assert_eq!(read.normaliser.unwrap().clip, Some(5.0));
        assert_eq!(read.channels.unwrap()[0], Channel { name: "com.height".into(), size: 3 });
    }

    #[test]
    fn what_is_no_network_is_reported() {
        let relu = [("activation", "relu")];
        let wrong = |change: fn(&mut Tensors), metadata: &[(&str, &str)]| {
            let mut tensors = whole();
            change(&mut tensors);
            NetworkFile::read(&file(&tensors, metadata)).unwrap_err()
        };
        let same: fn(&mut Tensors) = |_| {};
        let cases: [Case<'_>; 11] = [
            (same, &[], "expected one of tanh, relu, elu, silu, gelu, found nothing"),
            (same, &[("activation", "swish")], "found `swish`"),
            (
                same,
                &[("activation", "relu"), ("output_activation", "relu")],
                "the output activation `relu`: expected identity or tanh",
            ),
            (same, &[("activation", "relu"), ("observation_clip", "-1")], "expected a number above 0"),
            (same, &[("activation", "relu"), ("observation", "3")], "that list no channels"),
            (|tensors| tensors.truncate(0), &relu, "holds no layer"),
            (|tensors| drop(tensors.remove(1)), &relu, "lacks the tensor `10.bias`"),
            (|tensors| tensors[0].1 = vec![2, 1], &relu, "`10.bias` of shape [1]: expected [2]"),
            (
                |tensors| {
                    tensors[0].1 = vec![1, 1];
                    tensors[0].2.pop();
                },
                &relu,
                "with 1 inputs, but the layer before has 2 outputs",
            ),
            (|tensors| tensors[2].2[4] = f32::NAN, &relu, "holds NaN in `2.weight`, number 4"),
            (|tensors| tensors[5].2[1] = 0.0, &relu, "holds 0 in `observation.std`, number 1: expected more than 0"),
        ];
        for (change, metadata, message) in cases {
            let found = wrong(change, metadata);
            assert!(found.contains(message), "expected `{message}`, found `{found}`");
        }
        for bytes in [&b"text"[..], &[0xff; 64], &[]] {
            assert!(NetworkFile::read(bytes).unwrap_err().starts_with("is no safetensors file"));
        }
    }
}
