//! Columns of numbers over time as few bytes.
//!
//! A number is stored as a whole multiple of a quantum. Each column is replaced by what remains after the cheapest of three
//! predictions: none, the value before, the line through the two values before. Remainders are mostly small, so their low, second,
//! third and fourth bytes go into planes of their own, which a general compressor then packs well.

use serde::Serialize;

/// Rows of whole numbers, one per frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    width: usize,
    values: Vec<i32>,
}

/// Where a track stands in the bytes of a recording.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Block {
    /// First byte: the prediction of each column, then the planes.
    pub offset: usize,
    pub columns: usize,
    /// Bytes of the largest remainder, 0 to 4.
    pub planes: usize,
}

/// The nearest multiple of `quantum`; beyond the range of 32 bits the last one, and 0 for what is not a number.
pub(crate) fn quantise(value: f64, quantum: f64) -> i32 {
    (value / quantum).round() as i32
}

impl Track {
    pub fn new(width: usize) -> Self {
        Self { width, values: Vec::new() }
    }

    /// Numbers of a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows so far; 0 for a track without columns.
    pub fn frames(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    /// Appends a row, which has as many values as the track is wide.
    pub fn push(&mut self, row: impl IntoIterator<Item = i32>) {
        let before = self.values.len();
        self.values.extend(row);
        self.values.resize(before + self.width, 0);
    }

    /// One column over time.
    pub fn column(&self, column: usize) -> impl Iterator<Item = i32> + Clone + '_ {
        self.values.iter().skip(column).step_by(self.width.max(1)).copied()
    }

    /// The columns for which `wanted` holds, in their order.
    pub fn only(&self, wanted: &[bool]) -> Self {
        let kept = wanted.iter().filter(|wanted| **wanted).count();
        let rows = self.values.chunks(self.width.max(1));
        let keep =
            |row: &[i32]| row.iter().zip(wanted).filter(|(_, wanted)| **wanted).map(|(value, _)| *value).collect::<Vec<_>>();
        Self { width: kept, values: rows.flat_map(keep).collect() }
    }

    /// Appends the track to `bytes`.
    pub fn write(&self, bytes: &mut Vec<u8>) -> Block {
        let columns: Vec<(u8, Vec<u32>)> = (0..self.width).map(|column| cheapest(self.column(column))).collect();
        let largest = columns.iter().flat_map(|(_, rest)| rest).fold(0, |all, rest| all | rest);
        let planes = (u32::BITS - largest.leading_zeros()).div_ceil(8) as usize;
        let offset = bytes.len();
        bytes.extend(columns.iter().map(|(order, _)| order));
        for plane in 0..planes {
            bytes.extend(columns.iter().flat_map(|(_, rest)| rest).map(|rest| rest.to_le_bytes()[plane]));
        }
        Block { offset, columns: self.width, planes }
    }
}

/// The prediction that leaves the least of a column, and what it leaves.
fn cheapest(column: impl Iterator<Item = i32> + Clone) -> (u8, Vec<u32>) {
    let tried = (0..3).map(|order| {
        let rest = remainders(column.clone(), order);
        let cost: u64 = rest.iter().map(|rest| u64::from(u32::BITS - rest.leading_zeros())).sum();
        (cost, order, rest)
    });
    tried.min_by_key(|(cost, order, _)| (*cost, *order)).map_or((0, Vec::new()), |(_, order, rest)| (order, rest))
}

/// What a prediction of that order leaves; even numbers stand for positive remainders, odd ones for negative.
fn remainders(column: impl Iterator<Item = i32>, order: u8) -> Vec<u32> {
    let (mut before, mut last) = (0_i32, 0_i32);
    let rest = |(index, value): (usize, i32)| {
        let predicted = match order {
            0 => 0,
            2 if index > 1 => last.wrapping_mul(2).wrapping_sub(before),
            _ => last,
        };
        (before, last) = (last, value);
        let rest = value.wrapping_sub(predicted);
        (rest.wrapping_shl(1) ^ (rest >> 31)) as u32
    };
    column.enumerate().map(rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the page does: the reverse.
    fn read(bytes: &[u8], block: &Block, frames: usize) -> Vec<Vec<i32>> {
        let orders = &bytes[block.offset..block.offset + block.columns];
        let planes = &bytes[block.offset + block.columns..];
        let one = |column: usize| {
            let (mut before, mut last) = (0_i32, 0_i32);
            let value = |frame: usize| {
                let byte = |plane: usize| u32::from(planes[(plane * block.columns + column) * frames + frame]) << (8 * plane);
                let rest: u32 = (0..block.planes).map(byte).sum();
                let rest = (rest >> 1) as i32 ^ -((rest & 1) as i32);
                let predicted = match orders[column] {
                    0 => 0,
                    2 if frame > 1 => last.wrapping_mul(2).wrapping_sub(before),
                    _ => last,
                };
                (before, last) = (last, predicted.wrapping_add(rest));
                last
            };
            (0..frames).map(value).collect()
        };
        (0..block.columns).map(one).collect()
    }

    #[test]
    fn what_is_written_can_be_read_back() {
        let columns = [
            vec![0, 0, 0, 0, 0, 0],
            vec![5, 5, 5, 6, 5, 5],
            vec![100, 200, 300, 400, 500, 601],
            vec![i32::MIN, i32::MAX, 0, -1, i32::MAX, i32::MIN],
            vec![7, -90_000, 3, 65_536, -2, 1],
        ];
        let mut track = Track::new(columns.len());
        (0..6).for_each(|frame| track.push(columns.iter().map(|column| column[frame])));
        let mut bytes = vec![9; 3];
        let block = track.write(&mut bytes);
        assert_eq!((block.offset, block.columns, block.planes, track.frames()), (3, 5, 4, 6));
        assert_eq!(read(&bytes, &block, 6), columns);
    }

    #[test]
    fn steady_motion_leaves_nothing() {
        let mut track = Track::new(2);
        (0..50).for_each(|frame| track.push([3 * frame - 70, 12]));
        let mut bytes = Vec::new();
        let block = track.write(&mut bytes);
        assert_eq!((&bytes[..2], block.planes), (&[2, 1][..], 1));
        // Two frames are needed until the line is known.
        assert_eq!(bytes[2..].iter().filter(|byte| **byte != 0).count(), 3);
    }

    #[test]
    fn numbers_without_a_place_do_not_wrap_around() {
        assert_eq!([f64::NAN, 1e300, -1e300, 0.26].map(|value| quantise(value, 0.1)), [0, i32::MAX, i32::MIN, 3]);
    }

    #[test]
    fn columns_can_be_left_out() {
        let mut track = Track::new(3);
        track.push([1, 2, 3]);
        track.push([4, 5, 6]);
        let kept = track.only(&[true, false, true]);
        assert_eq!(kept.column(1).collect::<Vec<_>>(), [3, 6]);
    }
}
