//! Cubic splines through the rows of a table: twice continuously differentiable, periodic for cycles, natural for other motions.
//!
//! Reference: de Boor, A Practical Guide to Splines, chapter IV. The second derivatives at the rows solve a system with three
//! diagonals; for a cycle its corners are taken in by one rank-one change (Sherman and Morrison).

use crate::extremes::{maximum, minimum};
use crate::work::visit;

/// A cubic between every two rows: a + b s + c s² + d s³, where s is the time since the earlier row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    pieces: Vec<Piece>,
    /// The last row less the first.
    advance: f64,
    /// The lowest and the highest value. Intervals of formulas are computed for each of many poses: they must not cost a pass over
    /// the table.
    range: [f64; 2],
    /// The lowest and the highest rate.
    rate_range: [f64; 2],
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    length: f64,
    coefficients: [f64; 4],
}

impl Piece {
    fn value(&self, s: f64) -> f64 {
        let [a, b, c, d] = self.coefficients;
        a + s * (b + s * (c + s * d))
    }

    fn rate(&self, s: f64) -> f64 {
        let [_, b, c, d] = self.coefficients;
        b + s * (2.0 * c + s * 3.0 * d)
    }

    /// Where the rate vanishes within the piece.
    fn turning_points(&self) -> impl Iterator<Item = f64> + use<> {
        let ([_, b, c, d], length) = (self.coefficients, self.length);
        let root = maximum(c * c - 3.0 * b * d, 0.0).sqrt();
        // Citardauq's form: it stays exact where the cubic is nearly a parabola.
        let sum = -(c + if c < 0.0 { -root } else { root });
        [sum / (3.0 * d), b / sum].into_iter().filter(move |s| (0.0..=length).contains(s))
    }
}

impl Curve {
    /// Through `values` at `times`, which increase. A cycle has four rows or more, another curve two.
    pub(super) fn through(times: &[f64], values: &[f64], cycle: bool) -> Self {
        let lengths: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let slopes: Vec<f64> = values.windows(2).zip(&lengths).map(|(pair, length)| (pair[1] - pair[0]) / length).collect();
        let bends = if cycle { periodic(&lengths, &slopes) } else { natural(&lengths, &slopes) };
        let pieces = lengths.iter().enumerate().map(|(row, &length)| {
            let (bend, next) = (bends[row], bends[row + 1]);
            let slope = slopes[row] - length * (2.0 * bend + next) / 6.0;
            Piece { length, coefficients: [values[row], slope, bend / 2.0, (next - bend) / (6.0 * length)] }
        });
        let pieces: Vec<Piece> = pieces.collect();
        let advance = values.last().zip(values.first()).map_or(0.0, |(last, first)| last - first);
        let (range, rate_range) = (range(&pieces), rate_range(&pieces));
        Self { pieces, advance, range, rate_range }
    }

    /// All that it is made of.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.pieces.iter().flat_map(|piece| std::iter::once(piece.length).chain(piece.coefficients))
    }

    pub(super) fn advance(&self) -> f64 {
        self.advance
    }

    pub(super) fn value(&self, row: usize, after: f64) -> f64 {
        self.pieces[row].value(after)
    }

    pub(super) fn rate(&self, row: usize, after: f64) -> f64 {
        self.pieces[row].rate(after)
    }

    pub(super) fn range(&self) -> [f64; 2] {
        self.range
    }

    pub(super) fn rate_range(&self) -> [f64; 2] {
        self.rate_range
    }
}

fn range(pieces: &[Piece]) -> [f64; 2] {
    visit(pieces.len());
    let ends =
        pieces.iter().flat_map(|piece| [0.0, piece.length].into_iter().chain(piece.turning_points()).map(|s| piece.value(s)));
    bounds(ends)
}

fn rate_range(pieces: &[Piece]) -> [f64; 2] {
    visit(pieces.len());
    let ends = pieces.iter().flat_map(|piece| {
        let [_, _, c, d] = piece.coefficients;
        let vertex = Some(-c / (3.0 * d)).filter(|s| (0.0..=piece.length).contains(s));
        [0.0, piece.length].into_iter().chain(vertex).map(|s| piece.rate(s))
    });
    bounds(ends)
}

fn bounds(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [minimum(low, value), maximum(high, value)])
}

/// Second derivatives at the rows where those at both ends vanish.
fn natural(lengths: &[f64], slopes: &[f64]) -> Vec<f64> {
    let inner = lengths.len() - 1;
    let diagonal: Vec<f64> = (0..inner).map(|row| 2.0 * (lengths[row] + lengths[row + 1])).collect();
    let mut right: Vec<f64> = (0..inner).map(|row| 6.0 * (slopes[row + 1] - slopes[row])).collect();
    solve(&diagonal, lengths.get(1..inner.max(1)).unwrap_or_default(), &mut right);
    [vec![0.0], right, vec![0.0]].concat()
}

/// Second derivatives at the rows of a cycle, that of the first repeated at the end.
fn periodic(lengths: &[f64], slopes: &[f64]) -> Vec<f64> {
    let rows = lengths.len();
    let before = |row: usize| (row + rows - 1) % rows;
    let mut diagonal: Vec<f64> = (0..rows).map(|row| 2.0 * (lengths[before(row)] + lengths[row])).collect();
    let mut right: Vec<f64> = (0..rows).map(|row| 6.0 * (slopes[row] - slopes[before(row)])).collect();
    // The corner couples the last row with the first: A = T + u uᵀ corner, with u = e₁ + eₙ.
    let corner = lengths[rows - 1];
    diagonal[0] -= corner;
    diagonal[rows - 1] -= corner;
    let mut change = vec![0.0; rows];
    (change[0], change[rows - 1]) = (corner, corner);
    let sides = &lengths[..rows - 1];
    solve(&diagonal, sides, &mut right);
    solve(&diagonal, sides, &mut change);
    let factor = (right[0] + right[rows - 1]) / (1.0 + change[0] + change[rows - 1]);
    let mut bends: Vec<f64> = right.iter().zip(&change).map(|(bend, change)| bend - factor * change).collect();
    bends.push(bends[0]);
    bends
}

/// Solves a symmetric system with three diagonals, in place. It is dominated by its diagonal, so no row need be exchanged.
fn solve(diagonal: &[f64], sides: &[f64], right: &mut [f64]) {
    let mut pivots = diagonal.to_vec();
    for row in 1..right.len() {
        let factor = sides[row - 1] / pivots[row - 1];
        pivots[row] -= factor * sides[row - 1];
        right[row] -= factor * right[row - 1];
    }
    for row in (0..right.len()).rev() {
        let next = if row + 1 < right.len() { sides[row] * right[row + 1] } else { 0.0 };
        right[row] = (right[row] - next) / pivots[row];
    }
}

#[cfg(test)]
mod tests {
    use super::Curve;
    use crate::work::{assert_linear, visited};

    #[test]
    fn ranges_are_found_once_however_often_they_are_asked_for() {
        let curve = |rows: usize| {
            let times: Vec<f64> = (0..rows).map(|row| row as f64).collect();
            let values: Vec<f64> = times.iter().map(|time| libm::sin(*time)).collect();
            Curve::through(&times, &values, false)
        };
        assert_linear(1000, curve);
        let curve = curve(1000);
        let [low, high] = curve.range();
        assert!((-1.01..-0.99).contains(&low) && (0.99..1.01).contains(&high));
        assert_eq!(visited(|| (curve.range(), curve.rate_range())), 0);
    }
}
