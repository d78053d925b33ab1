//! Two lists met number by number and reduced in one go: dot products, mean squares, distances.
//!
//! Sums are those of [`Reduction`](crate::graph::operation::Reduction), bit by bit.

use super::formula::{Formula, View};
use super::lane::{Bank, Lane, Pairing, Run};
use crate::graph::operation::sum;

/// Numbers of one bank.
pub(super) struct List {
    bank: Bank,
    places: Vec<usize>,
    /// If they stand side by side.
    together: Option<Run>,
}

impl List {
    /// Lanes that stand in one bank.
    pub(super) fn of(lanes: &[Lane]) -> Self {
        let places: Vec<(Bank, usize)> = lanes.iter().filter_map(|lane| lane.place()).collect();
        let bank = places.first().map_or(Bank::Record, |(bank, _)| *bank);
        Self { bank, places: places.into_iter().map(|(_, place)| place).collect(), together: Run::of(lanes) }
    }
}

/// The dot product of two vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Dot {
    banks: [Bank; 2],
    places: [[usize; 3]; 2],
}

impl Dot {
    /// Of two lists, if they are vectors.
    pub(super) fn of(lists: [List; 2]) -> Option<Self> {
        let [left, right] = lists;
        let places = [left.places.try_into().ok()?, right.places.try_into().ok()?];
        Some(Self { banks: [left.bank, right.bank], places })
    }

    /// The product.
    #[inline]
    pub(super) fn read(&self, view: &View<'_>) -> f64 {
        let ([left, right], [a, b]) = (self.banks.map(|bank| view.bank(bank)), &self.places);
        [0, 1, 2].iter().map(|&k: &usize| left[a[k]] * right[b[k]]).sum()
    }
}

/// What the pairs of two lists come to.
pub(super) fn pairs(pairing: Pairing, left: List, right: List) -> Formula {
    match pairing {
        Pairing::SumOfProducts => fused(left, right, |a, b| a * b, |sum| sum),
        Pairing::NormOfDifferences => fused(left, right, |a, b| (a - b) * (a - b), f64::sqrt),
    }
}

fn fused(
    left: List,
    right: List,
    each: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
    end: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Formula {
    // Vectors first: their three steps are written out.
    if let (Ok(places), Ok(others)) = (<[usize; 3]>::try_from(&*left.places), <[usize; 3]>::try_from(&*right.places)) {
        return Box::new(move |view| {
            let (left, right) = (view.bank(left.bank), view.bank(right.bank));
            end([0, 1, 2].iter().map(|&k: &usize| each(left[places[k]], right[others[k]])).sum())
        });
    }
    let count = left.places.len().min(right.places.len());
    match (left.together, right.together) {
        (Some(left), Some(right)) => Box::new(move |view| {
            let (left, right) = (&view.run(left)[..count], &view.run(right)[..count]);
            end(sum(count, |index| each(left[index], right[index])))
        }),
        (Some(left), None) => Box::new(move |view| {
            let (left, from) = (view.run(left), view.bank(right.bank));
            end(sum(count, |index| each(left[index], from[right.places[index]])))
        }),
        (None, Some(right)) => Box::new(move |view| {
            let (from, right) = (view.bank(left.bank), view.run(right));
            end(sum(count, |index| each(from[left.places[index]], right[index])))
        }),
        (None, None) => Box::new(move |view| {
            let (from, other) = (view.bank(left.bank), view.bank(right.bank));
            end(sum(count, |index| each(from[left.places[index]], other[right.places[index]])))
        }),
    }
}
