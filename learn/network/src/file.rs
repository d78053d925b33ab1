//! Tensors in files: safetensors, whose bytes are a function of what they hold.

use half::f16;
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// How a file stores the numbers of a tensor.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Precision {
    /// Four bytes each.
    #[default]
    Single,
    /// Two bytes each: eleven significant bits, up to 65504.
    Half,
}

impl Precision {
    /// Its name in the header of a file.
    fn name(self) -> &'static str {
        match self {
            Self::Single => "F32",
            Self::Half => "F16",
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Half => 2,
        }
    }

    /// The number that is read where `value` was written; infinite if it is too large.
    pub fn round(self, value: f32) -> f32 {
        match self {
            Self::Single => value,
            Self::Half => f16::from_f32(value).to_f32(),
        }
    }
}

/// A tensor in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// Its lengths.
    pub shape: Vec<usize>,
    /// Its numbers, row by row.
    pub values: Vec<f32>,
    /// How they are stored.
    pub precision: Precision,
}

/// Tensors by name, with remarks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TensorFile {
    /// The tensors.
    pub tensors: BTreeMap<String, Stored>,
    /// What the file says beside them.
    pub metadata: BTreeMap<String, String>,
}

/// Why bytes hold no tensors.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FileError {
    /// Another format, or a damaged file.
    #[error("is no safetensors file: {0}")]
    Format(String),
    /// A tensor of another type.
    #[error("holds `{name}` as {found}: expected F32 or F16")]
    Type {
        /// Of the tensor.
        name: String,
        /// Its type.
        found: String,
    },
    /// Something that is no number.
    #[error("holds {value} in `{name}`, number {place}: expected finite numbers")]
    Number {
        /// Of the tensor.
        name: String,
        /// Which of its numbers.
        place: usize,
        /// Infinity or NaN.
        value: String,
    },
}

impl TensorFile {
    /// Adds a tensor in single precision.
    pub fn add(&mut self, name: impl Into<String>, shape: &[usize], values: impl Into<Vec<f32>>) {
        self.add_as(Precision::Single, name, shape, values);
    }

    /// Adds a tensor that is stored in some precision; what is added should have been [rounded](Precision::round) to it.
    pub fn add_as(&mut self, precision: Precision, name: impl Into<String>, shape: &[usize], values: impl Into<Vec<f32>>) {
        self.tensors.insert(name.into(), Stored { shape: shape.to_vec(), values: values.into(), precision });
    }

    /// The bytes of the file. The library keeps metadata in an order that changes from run to run, so the header is written here.
    pub fn bytes(&self) -> Vec<u8> {
        let mut header = Map::new();
        header.insert("__metadata__".to_owned(), json!(self.metadata));
        let mut end = 0;
        for (name, Stored { shape, values, precision }) in &self.tensors {
            let begin = end;
            end += precision.bytes() * values.len();
            header.insert(name.clone(), json!({ "dtype": precision.name(), "shape": shape, "data_offsets": [begin, end] }));
        }
        let mut header = Value::Object(header).to_string();
        // Numbers begin at a multiple of eight.
        let padding = header.len().next_multiple_of(8) - header.len();
        header.extend(std::iter::repeat_n(' ', padding));
        let mut bytes = (header.len() as u64).to_le_bytes().to_vec();
        bytes.reserve(header.len() + end);
        bytes.extend(header.as_bytes());
        for Stored { values, precision, .. } in self.tensors.values() {
            match precision {
                Precision::Single => bytes.extend(values.iter().flat_map(|value| value.to_le_bytes())),
                Precision::Half => bytes.extend(values.iter().flat_map(|value| f16::from_f32(*value).to_le_bytes())),
            }
        }
        bytes
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// Another format, other types than F32 and F16, or numbers that are not finite: words that continue the name of the file.
    pub fn read(bytes: &[u8]) -> Result<Self, FileError> {
        let format = |error: safetensors::SafeTensorError| FileError::Format(error.to_string());
        let tensors = SafeTensors::deserialize(bytes).map_err(format)?;
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(format)?;
        let metadata = header.metadata().iter().flatten().map(|(key, value)| (key.clone(), value.clone())).collect();
        let mut file = Self { tensors: BTreeMap::new(), metadata };
        for (name, view) in tensors.iter() {
            let (precision, values): (_, Vec<f32>) = match view.dtype() {
                Dtype::F32 => {
                    let numbers = view.data().as_chunks::<4>().0;
                    (Precision::Single, numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
                }
                Dtype::F16 => {
                    let numbers = view.data().as_chunks::<2>().0;
                    (Precision::Half, numbers.iter().map(|bytes| f16::from_le_bytes(*bytes).to_f32()).collect())
                }
                other => return Err(FileError::Type { name: name.to_owned(), found: format!("{other:?}") }),
            };
            if let Some(place) = values.iter().position(|value| !value.is_finite()) {
                return Err(FileError::Number { name: name.to_owned(), place, value: values[place].to_string() });
            }
            file.add_as(precision, name, view.shape(), values);
        }
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> TensorFile {
        let mut file = TensorFile::default();
        file.add("0.weight", &[2, 3], [1.0, 2.0, 3.0, 4.0, 5.0, f32::MIN_POSITIVE]);
        file.add("0.bias", &[2], [0.5, -0.0]);
        file.metadata.extend([("activation".to_owned(), "tanh".to_owned()), ("b".to_owned(), "\"c\"".to_owned())]);
        file
    }

    #[test]
    fn what_is_written_is_read() {
        let bytes = example().bytes();
        assert_eq!(TensorFile::read(&bytes), Ok(example()));
        assert_eq!(bytes, TensorFile::read(&bytes).map(|file| file.bytes()).unwrap_or_default());
    }

    #[test]
    fn half_precision_takes_half_the_room_and_keeps_what_was_rounded() {
        let mut file = example();
        let single = file.bytes().len();
        let weight: Vec<f32> = (0..6).map(|place| Precision::Half.round(0.1 * place as f32 - 0.3)).collect();
        file.add_as(Precision::Half, "0.weight", &[2, 3], weight);
        let bytes = file.bytes();
        assert_eq!((TensorFile::read(&bytes), bytes.len()), (Ok(file), single - 12));
        assert_eq!((Precision::Half.round(1.0 / 3.0), Precision::Half.round(1e5)), (0.333_251_95, f32::INFINITY));
        assert_eq!(Precision::Single.round(0.1), 0.1);
    }

    #[test]
    fn what_is_no_file_of_finite_numbers_is_refused() {
        let bytes = example().bytes();
        assert!(matches!(TensorFile::read(b"text"), Err(FileError::Format(_))));
        assert!(matches!(TensorFile::read(&bytes[..bytes.len() - 1]), Err(FileError::Format(_))));
        let mut file = example();
        file.add("1.bias", &[2], [0.0, f32::NAN]);
        let message = TensorFile::read(&file.bytes()).err().map(|error| error.to_string()).unwrap_or_default();
        assert_eq!(message, "holds NaN in `1.bias`, number 1: expected finite numbers");
    }
}
