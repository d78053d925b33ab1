//! Which numbers are written down, and which are computed where they are read.

use super::lane::{Act, Computation, Lane};
use super::spread::Sheet;

/// How deep computations may stand within each other before what they come to is written down: it bounds the stack.
const DEEPEST: usize = 24;

/// What becomes of every computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// Nothing reads it.
    Unread,
    /// Computed by its only reader.
    Within,
    /// Written to this place of the record.
    At(usize),
}

/// Decides over all computations of a sheet, and makes room; `roots` are read from outside.
pub(super) fn fates(sheet: &mut Sheet, roots: &[Lane]) -> Vec<Fate> {
    let readers = readers(sheet, roots);
    let mut depths = vec![0; readers.len()];
    let mut fates = vec![Fate::Unread; readers.len()];
    for number in (0..readers.len()).filter(|number| readers[*number] > 0) {
        let mut depth = 1;
        sheet.computations[number].each_input(&mut |lane| {
            if let Lane::Computed(input) = lane
                && fates[input] == Fate::Within
            {
                depth = depth.max(depths[input] + 1);
            }
        });
        depths[number] = depth;
        let within = readers[number] == 1 && depth < DEEPEST;
        fates[number] = if within { Fate::Within } else { Fate::At(sheet.reserve(1)) };
    }
    fates
}

/// How often each computation is read.
fn readers(sheet: &Sheet, roots: &[Lane]) -> Vec<u32> {
    let mut readers = vec![0_u32; sheet.computations.len()];
    let read = |readers: &mut Vec<u32>, lane: Lane, times: u32| {
        if let Lane::Computed(number) = lane {
            readers[number] += times;
        }
    };
    roots.iter().for_each(|lane| read(&mut readers, *lane, 1));
    for (act, _) in sheet.acts.iter().rev() {
        match act {
            Act::Compute(number) if readers[*number] == 0 => {}
            Act::Compute(number) => {
                let computation = &sheet.computations[*number];
                // Pairs are taken from lists that stand somewhere.
                let times = if matches!(computation, Computation::Pairs(..)) { 2 } else { 1 };
                computation.each_input(&mut |lane| read(&mut readers, lane, times));
            }
            Act::Do(effect) => effect.each_input(&mut |lane| read(&mut readers, lane, 1)),
        }
    }
    readers
}
