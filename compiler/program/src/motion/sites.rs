//! Places of landmarks as further columns of a motion.

use super::curve::Curve;
use super::{Column, Motion, RootPart, Target};
use crate::quantity::dimension::Dimension;
use crate::source::Span;

impl Motion {
    /// The same motion with columns for the places of landmarks: `rows` has, for each row of the table, a place (world axes, m)
    /// for each of `names`. `None` if the numbers do not fit.
    ///
    /// Where the root goes on from turn to turn, landmarks go on with it.
    pub fn with_sites(&self, names: &[&str], rows: &[Vec<[f64; 3]>]) -> Option<Self> {
        if rows.len() != self.times.len() || rows.iter().any(|row| row.len() != names.len()) {
            return None;
        }
        let mut whole = self.clone();
        for (place, name) in names.iter().enumerate() {
            for (axis, part) in [RootPart::X, RootPart::Y, RootPart::Height].into_iter().enumerate() {
                let values: Vec<f64> = rows.iter().map(|row| row[place][axis]).collect();
                let advances = self.root(part).is_some_and(|column| self.columns[column].advances);
                whole.columns.push(Column {
                    target: Target::Site((*name).to_owned(), axis),
                    unit: "m".to_owned(),
                    dimension: Dimension::LENGTH,
                    advances,
                    span: Span::default(),
                });
                whole.curves.push(Curve::through(&self.times, &values, self.cycle));
            }
        }
        Some(whole.identified())
    }

    /// The same motion over `fewest` rows or more: each stretch between two rows is cut into equal parts.
    pub fn finer(&self, fewest: usize) -> Self {
        let stretches = self.times.len().saturating_sub(1).max(1);
        let parts = fewest.div_ceil(stretches).max(1);
        let cut = |pair: &[f64]| {
            let (from, to) = (pair[0], pair[1]);
            (0..parts).map(move |part| from + (to - from) * part as f64 / parts as f64).collect::<Vec<_>>()
        };
        let mut times: Vec<f64> = self.times.windows(2).flat_map(cut).collect();
        times.push(self.duration);
        let column = |column: usize| times.iter().map(|time| self.value(column, *time)).collect::<Vec<f64>>();
        let curves = (0..self.columns.len()).map(|index| Curve::through(&times, &column(index), self.cycle)).collect();
        Self { times, curves, ..self.clone() }.identified()
    }

    /// The first of the three columns of a landmark's place.
    pub fn site(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| matches!(&column.target, Target::Site(site, 0) if site == name))
    }
}
