//! Tensors in files: safetensors, whose bytes are a function of what they hold.

use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Tensors of single precision by name, with remarks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TensorFile {
    /// Shape, and numbers row by row.
    pub tensors: BTreeMap<String, (Vec<usize>, Vec<f32>)>,
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
    #[error("holds `{name}` as {found}: expected F32")]
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
    /// Adds a tensor.
    pub fn add(&mut self, name: impl Into<String>, shape: &[usize], values: impl Into<Vec<f32>>) {
        self.tensors.insert(name.into(), (shape.to_vec(), values.into()));
    }

    /// The bytes of the file. The library keeps metadata in an order that changes from run to run, so the header is written here.
    pub fn bytes(&self) -> Vec<u8> {
        let mut header = Map::new();
        header.insert("__metadata__".to_owned(), json!(self.metadata));
        let mut end = 0;
        for (name, (shape, values)) in &self.tensors {
            let begin = end;
            end += 4 * values.len();
            header.insert(name.clone(), json!({ "dtype": "F32", "shape": shape, "data_offsets": [begin, end] }));
        }
        let mut header = Value::Object(header).to_string();
        // Numbers begin at a multiple of eight.
        let padding = header.len().next_multiple_of(8) - header.len();
        header.extend(std::iter::repeat_n(' ', padding));
        let mut bytes = (header.len() as u64).to_le_bytes().to_vec();
        bytes.reserve(header.len() + end);
        bytes.extend(header.as_bytes());
        let values = self.tensors.values().flat_map(|(_, values)| values);
        bytes.extend(values.flat_map(|value| value.to_le_bytes()));
        bytes
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// Another format, other types than F32, or numbers that are not finite: words that continue the name of the file.
    pub fn read(bytes: &[u8]) -> Result<Self, FileError> {
        let format = |error: safetensors::SafeTensorError| FileError::Format(error.to_string());
        let tensors = SafeTensors::deserialize(bytes).map_err(format)?;
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(format)?;
        let metadata = header.metadata().iter().flatten().map(|(key, value)| (key.clone(), value.clone())).collect();
        let mut file = Self { tensors: BTreeMap::new(), metadata };
        for (name, view) in tensors.iter() {
            if view.dtype() != Dtype::F32 {
                return Err(FileError::Type { name: name.to_owned(), found: format!("{:?}", view.dtype()) });
            }
            let values: Vec<f32> = view.data().as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
            if let Some(place) = values.iter().position(|value| !value.is_finite()) {
                return Err(FileError::Number { name: name.to_owned(), place, value: values[place].to_string() });
            }
            file.tensors.insert(name.to_owned(), (view.shape().to_vec(), values));
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
