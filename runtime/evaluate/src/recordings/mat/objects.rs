//! Objects in `.mat` files, of which tables are read.
//!
//! Variables name an object by its number; what it has stands in a variable without a name, whose bytes are a file of their own: a
//! structure with one object, whose last part is a list of cells. The first cell is a directory, the second is empty, and the others are
//! the values of the properties of all objects. MathWorks does not describe the directory; its form was found by users, and is checked
//! here against files of the package `mat-io`. Of its numbers of four bytes, the third to the seventh are the places of regions:
//!
//! * before the first: names, each ended by a zero byte, from byte 40;
//! * classes: of each four numbers, the second of which is its name;
//! * properties of objects that are kept by a function of their class;
//! * objects: of each six numbers, its class first, the block of its properties in the region before fourth, or in the one after fifth;
//! * properties of other objects.
//!
//! A block of properties is a count and three numbers for each: its name, 1 if its value is a cell, and which. Blocks are padded to eight
//! bytes. Everything is counted from 1 but cells, and the first entry of every region is empty.

use super::{Elements, Matrix, RecordingError, Value};
use RecordingError::Damaged;

/// Bytes of a directory before its names.
const NAMES: usize = 40;
/// Cells before the values.
const BEFORE_VALUES: usize = 2;

/// The objects of a file.
#[derive(Debug, Default)]
pub(super) struct Objects {
    names: Vec<String>,
    /// Numbers of the regions: classes, kept properties, objects, properties.
    regions: [Vec<u32>; 4],
    values: Vec<Value>,
}

impl Objects {
    /// Reads the bytes of the variable without a name.
    pub fn read(bytes: &[u8]) -> Result<Self, RecordingError> {
        let damaged = || Damaged("its directory of objects");
        // Eight bytes of header are before the first element.
        let element = Elements(bytes.get(8..).unwrap_or_default()).next().ok_or_else(damaged)??;
        let Value::Struct(fields) = Matrix::of(element)?.value(0)? else { return Ok(Self::default()) };
        let Some((_, Value::Cells(mut cells))) = fields.into_iter().next() else { return Ok(Self::default()) };
        let Some(Value::Numbers(directory)) = cells.first() else { return Err(damaged()) };
        let bytes: Vec<u8> = directory.iter().map(|byte| *byte as u8).collect();
        let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let places: Vec<usize> = bytes.chunks_exact(4).skip(2).take(5).map(|bytes| word(bytes) as usize).collect();
        let [names, classes, kept, objects, plain] = *places.as_slice() else { return Err(damaged()) };
        let region = |from: usize, to: usize| {
            let bytes = bytes.get(from..to).ok_or_else(damaged)?;
            Ok::<_, RecordingError>(bytes.chunks_exact(4).map(word).collect::<Vec<u32>>())
        };
        let regions = [region(names, classes)?, region(classes, kept)?, region(kept, objects)?, region(objects, plain)?];
        let letters = bytes.get(NAMES..names).ok_or_else(damaged)?;
        let names = letters.split(|byte| *byte == 0).map(|name| String::from_utf8_lossy(name).into_owned()).collect();
        Ok(Self { names, regions, values: cells.split_off(cells.len().min(BEFORE_VALUES)) })
    }

    /// The columns of an object that is a table.
    pub fn table<'a>(&'a self, object: usize) -> Result<Vec<(&'a str, &'a [f64])>, RecordingError> {
        let damaged = || Damaged("a table: its properties are not where they are expected");
        let [classes, kept, objects, plain] = &self.regions;
        let entry = |region: &[u32], number: usize, width: usize| {
            let start = number.checked_mul(width)?;
            region.get(start..start.checked_add(width)?).map(<[u32]>::to_vec)
        };
        let described = entry(objects, object, 6).ok_or_else(damaged)?;
        let class = entry(classes, described[0] as usize, 4).ok_or_else(damaged)?;
        if self.name(class[1]) != Some("table") {
            return Err(Damaged("an object: it is no table"));
        }
        let (region, block) = if described[3] > 0 { (kept, described[3]) } else { (plain, described[4]) };
        let properties = block_of(region, block as usize).ok_or_else(damaged)?;
        let property = |name: &str| {
            let found = properties.chunks_exact(3).find(|property| self.name(property[0]) == Some(name) && property[1] == 1)?;
            self.values.get(found[2] as usize)
        };
        let (Some(Value::Cells(names)), Some(Value::Cells(data))) = (property("varnames"), property("data")) else {
            return Err(damaged());
        };
        let column = |(name, value): (&'a Value, &'a Value)| match (name, value) {
            (Value::Text(name), Value::Numbers(numbers)) => Ok((name.as_str(), numbers.as_slice())),
            _ => Err(Damaged("a table: a column is no array of numbers")),
        };
        if names.len() == data.len() { names.iter().zip(data).map(column).collect() } else { Err(damaged()) }
    }

    /// A name by its number from 1.
    fn name(&self, number: u32) -> Option<&str> {
        self.names.get((number as usize).checked_sub(1)?).map(String::as_str)
    }
}

/// The numbers of a block of properties, without its count.
fn block_of(region: &[u32], number: usize) -> Option<&[u32]> {
    let mut rest = region;
    for _ in 0..number {
        let count = *rest.first()? as usize;
        rest = rest.get((1 + count.checked_mul(3)?).next_multiple_of(2)..)?;
    }
    let count = *rest.first()? as usize;
    rest.get(1..1 + count.checked_mul(3)?)
}
