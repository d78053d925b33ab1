//! Motions: tables of joint angles and of the root's path over time.
//!
//! [`Motion::value`] and [`Motion::rate`] give any column at any time, in SI units: between the rows runs a cubic spline.
//!
//! A motion is data. Reference motions of tasks, scripted motions of tests and the drawings of motions all read it here.

mod curve;
mod sites;

use crate::digest::hexadecimal;
use crate::extremes::{between, maximum, minimum};
use crate::quantity::dimension::Dimension;
use crate::source::Span;
use curve::Curve;
use sha2::{Digest, Sha256};
use std::borrow::Cow;

/// A table of columns over time.
///
/// A motion that is a cycle goes on for ever in both directions; its last row is the first of the next turn. One that is none
/// stands still before its first and after its last row.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// What it is called.
    pub name: String,
    /// Where its figures come from; several lines where there are several sources.
    pub source: String,
    /// Whether it repeats.
    pub cycle: bool,
    /// Its length, s: that of one turn for a cycle.
    pub duration: f64,
    /// Its columns, without that of time, in the order of the text.
    pub columns: Vec<Column>,
    /// Times of the rows, s: the first is 0, the last the duration.
    pub times: Vec<f64>,
    curves: Vec<Curve>,
    digest: String,
}

/// A column of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// What it moves.
    pub target: Target,
    /// Its unit as written.
    pub unit: String,
    /// What it measures: an angle or a length.
    pub dimension: Dimension,
    /// Whether it goes on from turn to turn of a cycle, as the place of one who walks.
    pub advances: bool,
    /// Where its heading stands in the text.
    pub span: Span,
}

/// What a column of a motion moves.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Target {
    /// The joint of that name: rad or m.
    Joint(String),
    /// A coordinate of the root.
    Root(RootPart),
    /// Where the landmark of that name is along x, y or z (0, 1, 2) of the world, m: computed from the others, never read.
    Site(String, usize),
}

/// A coordinate of the root in world axes: x forward, y left, z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RootPart {
    /// Position along x, m.
    X,
    /// Position along y, m.
    Y,
    /// Height above the ground's level, m.
    Height,
    /// Turn about the vertical, rad; left positive.
    Heading,
    /// Turn about the leftward axis after the heading, rad; nose down positive.
    Pitch,
    /// Turn about the forward axis after heading and pitch, rad; right side down positive.
    Roll,
}

impl RootPart {
    /// Every part, in the order of placing a root.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Height, Self::Heading, Self::Pitch, Self::Roll];

    /// As a column is headed: `root.x`.
    pub fn heading(self) -> &'static str {
        match self {
            Self::X => "root.x",
            Self::Y => "root.y",
            Self::Height => "root.height",
            Self::Heading => "root.heading",
            Self::Pitch => "root.pitch",
            Self::Roll => "root.roll",
        }
    }

    /// What it measures.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::X | Self::Y | Self::Height => Dimension::LENGTH,
            Self::Heading | Self::Pitch | Self::Roll => Dimension::ANGLE,
        }
    }
}

impl Target {
    /// As a column is headed, without its unit.
    pub fn name(&self) -> Cow<'_, str> {
        match self {
            Self::Joint(name) => Cow::Borrowed(name),
            Self::Root(part) => Cow::Borrowed(part.heading()),
            Self::Site(name, axis) => Cow::Owned(format!("{name}.{}", ["x", "y", "z"].get(*axis).unwrap_or(&"?"))),
        }
    }
}

/// A table as it is read: a [`Motion`] but for the curves through its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What the motion is called.
    pub name: String,
    /// Where its figures come from; several lines where there are several sources.
    pub source: String,
    /// Whether it repeats.
    pub cycle: bool,
    /// Its length, s.
    pub duration: f64,
    /// Its columns, without that of time.
    pub columns: Vec<Column>,
    /// Times of the rows, s: the first is 0, the last the duration.
    pub times: Vec<f64>,
    /// For each column its values in SI units, one for each row.
    pub values: Vec<Vec<f64>>,
}

impl From<Table> for Motion {
    fn from(table: Table) -> Self {
        let Table { name, source, cycle, duration, columns, times, values } = table;
        let curves = values.iter().map(|values| Curve::through(&times, values, cycle)).collect();
        Self { name, source, cycle, duration, columns, times, curves, digest: String::new() }.identified()
    }
}

impl Motion {
    /// The column of the joint called `name`.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| matches!(&column.target, Target::Joint(joint) if joint == name))
    }

    /// The column of a coordinate of the root.
    pub fn root(&self, part: RootPart) -> Option<usize> {
        self.columns.iter().position(|column| column.target == Target::Root(part))
    }

    /// Names of the joints that it moves, in the order of its columns.
    pub fn joints(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().filter_map(|column| match &column.target {
            Target::Joint(name) => Some(name.as_str()),
            Target::Root(_) | Target::Site(..) => None,
        })
    }

    /// The value of a column at `time` (s), in rad or m.
    pub fn value(&self, column: usize, time: f64) -> f64 {
        let moment = self.moment(time);
        self.curves[column].value(moment.row, moment.after) + moment.turns * self.advance(column)
    }

    /// The rate of a column at `time` (s), in rad/s or m/s; zero where a motion that is no cycle stands still.
    pub fn rate(&self, column: usize, time: f64) -> f64 {
        let moment = self.moment(time);
        if moment.still { 0.0 } else { self.curves[column].rate(moment.row, moment.after) }
    }

    /// All columns at `time` (s), in rad and m.
    pub fn at(&self, time: f64) -> Vec<f64> {
        (0..self.columns.len()).map(|column| self.value(column, time)).collect()
    }

    /// Rates of all columns at `time` (s), in rad/s and m/s.
    pub fn rates(&self, time: f64) -> Vec<f64> {
        (0..self.columns.len()).map(|column| self.rate(column, time)).collect()
    }

    /// The lowest and the highest value that a column takes within the table, in rad or m.
    pub fn range(&self, column: usize) -> [f64; 2] {
        self.curves[column].range()
    }

    /// The lowest and the highest rate that a column takes within the table, in rad/s or m/s; zero included where the motion
    /// stands still at its ends.
    pub fn rate_range(&self, column: usize) -> [f64; 2] {
        let [low, high] = self.curves[column].rate_range();
        if self.cycle { [low, high] } else { [minimum(low, 0.0), maximum(high, 0.0)] }
    }

    /// How far a column goes on in one turn of a cycle, in rad or m; zero for those that do not.
    pub fn advance(&self, column: usize) -> f64 {
        if self.cycle && self.columns[column].advances { self.curves[column].advance() } else { 0.0 }
    }

    /// The time at which the fraction `phase` of the motion has passed, s.
    pub fn time_of(&self, phase: f64) -> f64 {
        phase * self.duration
    }

    /// The fraction of the motion that has passed at `time` (s): in [0, 1) for a cycle, in [0, 1] for another motion.
    pub fn phase_of(&self, time: f64) -> f64 {
        let turns = time / self.duration;
        if self.cycle { turns - turns.floor() } else { between(turns, 0.0, 1.0) }
    }

    /// Identifies what the motion shows: two tables with the same one show the same to the bit, whatever they are called.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// The same with its digest.
    fn identified(mut self) -> Self {
        let mut hasher = Sha256::new();
        hasher.update([u8::from(self.cycle)]);
        self.times.iter().for_each(|time| hasher.update(time.to_bits().to_le_bytes()));
        for (column, curve) in self.columns.iter().zip(&self.curves) {
            hasher.update(format!("{} {} ", column.target.name(), column.advances));
            curve.numbers().for_each(|number| hasher.update(number.to_bits().to_le_bytes()));
        }
        self.digest = hexadecimal(&hasher.finalize()[..16]);
        self
    }

    /// Where in the table a time lies.
    fn moment(&self, time: f64) -> Moment {
        let (turns, within, still) = if self.cycle {
            let turns = (time / self.duration).floor();
            (turns, time - turns * self.duration, false)
        } else {
            (0.0, time, !(0.0..=self.duration).contains(&time))
        };
        // Rounding may leave the table by a hair; a time that is no number stands at the first row.
        let within = minimum(maximum(within, 0.0), self.duration);
        let last = self.times.len().saturating_sub(2);
        let row = self.times.partition_point(|known| *known <= within).saturating_sub(1).min(last);
        Moment { row, after: within - self.times[row], turns, still }
    }
}

/// A time of a motion: so long after a row, so many whole turns after the first.
struct Moment {
    row: usize,
    /// s.
    after: f64,
    turns: f64,
    /// Whether the motion stands still.
    still: bool,
}
