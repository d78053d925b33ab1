//! Numbers written side by side: what stands together is copied as a whole.

use super::formula::{Scalar, View};
use super::lane::{Bank, Run};
use super::pairs::Dot;
use std::mem::take;

/// The shortest run that is copied as a whole.
const SHORTEST: usize = 4;

/// What to write, from the first number to the last.
#[derive(Default)]
pub(crate) struct Plan {
    pieces: Vec<Piece>,
    width: usize,
}

enum Piece {
    Copy(Run),
    Each(Vec<Scalar>),
    /// Vectors counted in other axes are three of these.
    Dots(Vec<Dot>),
    Zeros(usize),
}

impl Plan {
    /// How many numbers it writes.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Adds a number.
    pub(super) fn push(&mut self, scalar: Scalar) {
        self.width += 1;
        match self.pieces.last_mut() {
            Some(Piece::Each(scalars)) => scalars.push(scalar),
            _ => self.pieces.push(Piece::Each(vec![scalar])),
        }
    }

    /// Adds a dot product.
    pub(super) fn dot(&mut self, dot: Dot) {
        self.width += 1;
        match self.pieces.last_mut() {
            Some(Piece::Dots(dots)) => dots.push(dot),
            _ => self.pieces.push(Piece::Dots(vec![dot])),
        }
    }

    /// Adds numbers that stand side by side.
    pub(super) fn copy(&mut self, run: Run) {
        if let Some(Piece::Copy(last)) = self.pieces.last_mut()
            && (last.bank, last.from + last.length) == (run.bank, run.from)
        {
            last.length += run.length;
            self.width += run.length;
        } else if run.length < SHORTEST {
            let scalar = |place| match run.bank {
                Bank::Frame => Scalar::Frame(place),
                Bank::Record => Scalar::Record(place),
            };
            (run.from..run.from + run.length).for_each(|place| self.push(scalar(place)));
        } else {
            self.pieces.push(Piece::Copy(run));
            self.width += run.length;
        }
    }

    /// Adds zeros.
    pub(crate) fn zeros(&mut self, count: usize) {
        self.pieces.push(Piece::Zeros(count));
        self.width += count;
    }

    /// Adds what another plan writes.
    pub(crate) fn append(&mut self, other: Self) {
        for piece in other.pieces {
            match piece {
                Piece::Copy(run) => self.copy(run),
                Piece::Each(scalars) => scalars.into_iter().for_each(|scalar| self.push(scalar)),
                Piece::Dots(dots) => dots.into_iter().for_each(|dot| self.dot(dot)),
                Piece::Zeros(count) => self.zeros(count),
            }
        }
    }

    /// Writes to the front of `out`.
    pub(crate) fn write(&self, view: &View<'_>, mut out: &mut [f64]) {
        for piece in &self.pieces {
            let (own, rest) = take(&mut out).split_at_mut(piece.width());
            match piece {
                Piece::Copy(run) => own.copy_from_slice(view.run(*run)),
                Piece::Each(scalars) => own.iter_mut().zip(scalars).for_each(|(value, scalar)| *value = scalar.read(view)),
                Piece::Dots(dots) => own.iter_mut().zip(dots).for_each(|(value, dot)| *value = dot.read(view)),
                Piece::Zeros(_) => own.fill(0.0),
            }
            out = rest;
        }
    }

    /// Writes into the record itself, from `at` on.
    pub(super) fn write_within(&self, frame: &[f64], record: &mut [f64], mut at: usize) {
        for piece in &self.pieces {
            let own = at..at + piece.width();
            at = own.end;
            match piece {
                Piece::Copy(run) => run.copy_within(frame, record, own.start),
                Piece::Each(scalars) => {
                    for (place, scalar) in own.zip(scalars) {
                        record[place] = scalar.read(&View { frame, record });
                    }
                }
                Piece::Dots(dots) => {
                    for (place, dot) in own.zip(dots) {
                        record[place] = dot.read(&View { frame, record });
                    }
                }
                Piece::Zeros(_) => record[own].fill(0.0),
            }
        }
    }
}

impl Run {
    /// Copies its numbers within the record or into it.
    pub(super) fn copy_within(self, frame: &[f64], record: &mut [f64], at: usize) {
        let range = self.from..self.from + self.length;
        match self.bank {
            Bank::Frame => record[at..at + self.length].copy_from_slice(&frame[range]),
            Bank::Record => record.copy_within(range, at),
        }
    }
}

impl Piece {
    fn width(&self) -> usize {
        match self {
            Self::Copy(run) => run.length,
            Self::Each(scalars) => scalars.len(),
            Self::Dots(dots) => dots.len(),
            Self::Zeros(count) => *count,
        }
    }
}
