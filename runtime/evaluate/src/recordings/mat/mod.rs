//! `.mat` of MATLAB, level 5: the format of `save -v7`, in which data sets of gait are published.
//!
//! The format is described by "MAT-File Format" (MathWorks). A file is a header of 128 bytes and data elements, each a type, a length and
//! bytes; a variable is an element of the type `MATRIX`, mostly deflated as one of the type `COMPRESSED`. What is read: numbers, texts,
//! cells, structures, and [tables](objects), which the description leaves out. Other values are kept as [`Value::Other`].

mod objects;

use super::{MOST_NUMBERS, RecordingError};
use RecordingError::Damaged;
use objects::Objects;
use std::io::Read;

/// Bytes before the first element.
const HEADER: usize = 128;
/// Types of elements: one that contains others, and one that is deflated.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Most levels of cells and structures within each other.
const DEEPEST: usize = 32;
/// Most bytes of all variables.
const MOST_BYTES: u64 = 8 * MOST_NUMBERS as u64;

/// The value of a variable, or a part of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// An array of numbers, column by column.
    Numbers(Vec<f64>),
    /// Letters.
    Text(String),
    /// An array of values.
    Cells(Vec<Value>),
    /// A structure: its fields in order.
    Struct(Vec<(String, Value)>),
    /// An object of a class, such as a table: its number among the objects of the file.
    Object(usize),
    /// What is not read: sparse arrays, functions, arrays of structures.
    Other,
}

/// The variables of a file.
#[derive(Debug)]
pub(super) struct MatFile {
    variables: Vec<(String, Value)>,
    objects: Objects,
}

impl MatFile {
    /// Reads all variables.
    ///
    /// # Errors
    /// Another format, or a damaged file.
    pub fn read(bytes: &[u8]) -> Result<Self, RecordingError> {
        if bytes.starts_with(b"MATLAB 7.3") {
            return Err(RecordingError::Hdf5);
        }
        let is_level_5 = bytes.get(124..HEADER).is_some_and(|mark| mark == [0, 1, b'I', b'M']);
        if !is_level_5 {
            return Err(RecordingError::Missing("mark of a MAT file of level 5, little-endian, in its header"));
        }
        let (mut variables, mut objects) = (Vec::new(), Objects::default());
        let mut left = MOST_BYTES;
        for element in Elements(bytes.get(HEADER..).unwrap_or_default()) {
            let element = element?;
            let inflated = if element.ty == COMPRESSED { Some(inflate(element.data, &mut left)?) } else { None };
            let element = match &inflated {
                Some(bytes) => Elements(bytes).next().ok_or(Damaged("a compressed variable"))??,
                None => element,
            };
            let matrix = Matrix::of(element)?;
            // The variable without a name holds the properties of objects.
            if matrix.name.is_empty() {
                objects = Objects::read(matrix.bytes()?)?;
            } else {
                variables.push((matrix.name.clone(), matrix.value(0)?));
            }
        }
        Ok(Self { variables, objects })
    }

    /// The variable of that name.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.variables.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// Names of all variables.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.variables.iter().map(|(name, _)| name.as_str())
    }

    /// The columns of a table, or of a structure with an array of numbers in each field.
    ///
    /// # Errors
    /// Another value.
    pub fn columns<'a>(&'a self, value: &'a Value) -> Result<Vec<(&'a str, &'a [f64])>, RecordingError> {
        let other = || Damaged("a table: a part of it is of an unexpected kind");
        match value {
            Value::Object(object) => self.objects.table(*object),
            Value::Struct(fields) => {
                fields.iter().map(|(name, value)| Ok((name.as_str(), value.numbers().ok_or_else(other)?))).collect()
            }
            _ => Err(other()),
        }
    }
}

impl Value {
    /// The field of a structure.
    pub fn field(&self, name: &str) -> Option<&Self> {
        self.fields().iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// The fields of a structure; none of another value.
    pub fn fields(&self) -> &[(String, Self)] {
        if let Self::Struct(fields) = self { fields } else { &[] }
    }

    /// The numbers of an array.
    pub fn numbers(&self) -> Option<&[f64]> {
        if let Self::Numbers(numbers) = self { Some(numbers) } else { None }
    }
}

/// The bytes of a deflated element; `left` are those that the file may still come to.
fn inflate(bytes: &[u8], left: &mut u64) -> Result<Vec<u8>, RecordingError> {
    let mut inflated = Vec::new();
    let read = flate2::read::ZlibDecoder::new(bytes).take(*left + 1).read_to_end(&mut inflated);
    read.map_err(|_| Damaged("a compressed variable"))?;
    *left = left.checked_sub(inflated.len() as u64).ok_or(RecordingError::Large)?;
    Ok(inflated)
}

/// A data element.
#[derive(Debug, Clone, Copy)]
struct Element<'a> {
    ty: u32,
    data: &'a [u8],
}

/// The elements of bytes, one after the other.
struct Elements<'a>(&'a [u8]);

impl<'a> Iterator for Elements<'a> {
    type Item = Result<Element<'a>, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        // Less than a tag is padding.
        let (tag, rest) = self.0.split_first_chunk::<8>()?;
        let [a, b, c, d, e, f, g, h] = *tag;
        let (ty, length) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
        // An element of at most four bytes has its length in the upper half of its type, and its bytes in the place of the length.
        let (ty, data, next) = match (ty >> 16) as usize {
            0 => {
                let length = length as usize;
                // Deflated bytes are not padded.
                let padded = if ty == COMPRESSED { length } else { length.next_multiple_of(8) };
                (ty, rest.get(..length), rest.get(padded..).unwrap_or_default())
            }
            short => (ty & 0xFFFF, self.0.get(4..8).and_then(|bytes| bytes.get(..short)), rest),
        };
        self.0 = next;
        Some(data.map(|data| Element { ty, data }).ok_or(Damaged("its length: it ends too early")))
    }
}

/// An element of the type `MATRIX` whose value has not been read yet.
struct Matrix<'a> {
    class: u32,
    /// Product of its dimensions; 0 of an object.
    count: usize,
    name: String,
    rest: Elements<'a>,
}

impl<'a> Matrix<'a> {
    fn of(element: Element<'a>) -> Result<Self, RecordingError> {
        if element.ty != MATRIX {
            return Err(Damaged("an element that is no variable"));
        }
        let mut rest = Elements(element.data);
        // An empty element is an empty array.
        let Some(flags) = rest.next() else { return Ok(Self { class: 6, count: 0, name: String::new(), rest }) };
        let class = numbers(flags?)?.first().map_or(0, |flags| *flags as u32 & 0xFF);
        let is_object = class == 17;
        let mut next = || rest.next().ok_or(Damaged("the header of a variable"))?;
        let count = if is_object { 0.0 } else { numbers(next()?)?.iter().product() };
        let name = String::from_utf8_lossy(next()?.data).into_owned();
        if !(0.0..=MOST_NUMBERS as f64).contains(&count) {
            return Err(RecordingError::Large);
        }
        Ok(Self { class, count: count as usize, name, rest })
    }

    /// The bytes of an array of them.
    fn bytes(mut self) -> Result<&'a [u8], RecordingError> {
        self.rest.next().map_or(Ok(&[][..]), |element| Ok(element?.data))
    }

    fn value(mut self, depth: usize) -> Result<Value, RecordingError> {
        if depth > DEEPEST {
            return Err(Damaged("its depth: values are nested too deeply"));
        }
        match self.class {
            1 => Ok(Value::Cells(
                self.rest.take(self.count).map(|cell| Matrix::of(cell?)?.value(depth + 1)).collect::<Result<_, _>>()?,
            )),
            2 if self.count == 1 => self.fields(depth),
            4 => Ok(Value::Text(self.rest.next().map_or(Ok(String::new()), |element| text(element?))?)),
            6..=15 => Ok(Value::Numbers(self.rest.next().map_or(Ok(Vec::new()), |element| numbers(element?))?)),
            17 => self.object(depth),
            _ => Ok(Value::Other),
        }
    }

    /// The fields of a single structure: the length of a name, all names, and a variable for each.
    fn fields(mut self, depth: usize) -> Result<Value, RecordingError> {
        let damaged = || Damaged("the fields of a structure");
        let width = numbers(self.rest.next().ok_or_else(damaged)??)?.first().map_or(0, |width| *width as usize);
        let names = self.rest.next().ok_or_else(damaged)??.data;
        let mut fields = Vec::new();
        for name in names.chunks_exact(width.max(1)) {
            let end = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
            let value = Matrix::of(self.rest.next().ok_or_else(damaged)??)?.value(depth + 1)?;
            fields.push((String::from_utf8_lossy(&name[..end]).into_owned(), value));
        }
        Ok(Value::Struct(fields))
    }

    /// An object has, after the name of its system, that of its class, and numbers, the fifth of which is its own.
    fn object(mut self, depth: usize) -> Result<Value, RecordingError> {
        let damaged = || Damaged("an object");
        // Its system is `MCOS`, its class `table` or another.
        Ok(match Matrix::of(self.rest.nth(2).ok_or_else(damaged)??)?.value(depth + 1)? {
            Value::Numbers(numbers) => numbers.get(4).map_or(Value::Other, |number| Value::Object(*number as usize)),
            // The list of all values is itself an object, of the class `FileWrapper__`.
            Value::Cells(cells) => Value::Cells(cells),
            _ => Value::Other,
        })
    }
}

/// The numbers of an element of any of the types that have them.
fn numbers(element: Element<'_>) -> Result<Vec<f64>, RecordingError> {
    fn all<const N: usize>(bytes: &[u8], of: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        bytes.chunks_exact(N).filter_map(|part| part.try_into().ok()).map(of).collect()
    }
    let bytes = element.data;
    Ok(match element.ty {
        1 => all(bytes, |part| f64::from(i8::from_le_bytes(part))),
        2 => all(bytes, |part| f64::from(u8::from_le_bytes(part))),
        3 => all(bytes, |part| f64::from(i16::from_le_bytes(part))),
        4 => all(bytes, |part| f64::from(u16::from_le_bytes(part))),
        5 => all(bytes, |part| f64::from(i32::from_le_bytes(part))),
        6 => all(bytes, |part| f64::from(u32::from_le_bytes(part))),
        7 => all(bytes, |part| f64::from(f32::from_le_bytes(part))),
        9 => all(bytes, f64::from_le_bytes),
        12 => all(bytes, |part| i64::from_le_bytes(part) as f64),
        13 => all(bytes, |part| u64::from_le_bytes(part) as f64),
        _ => return Err(Damaged("the type of an array of numbers")),
    })
}

/// The letters of an element: of UTF-8, or numbers of two bytes.
fn text(element: Element<'_>) -> Result<String, RecordingError> {
    match element.ty {
        1 | 2 | 16 => Ok(String::from_utf8_lossy(element.data).into_owned()),
        4 | 17 => {
            let letters = element.data.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
            Ok(char::decode_utf16(letters).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect())
        }
        _ => Err(Damaged("the type of a text")),
    }
}

#[cfg(test)]
mod tests;
