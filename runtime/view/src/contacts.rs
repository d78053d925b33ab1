//! What the body touches: the resultant of each pair of bodies, at its centre of pressure.

use crate::track::{Track, quantise};
use msk_runtime::body::sensors::Snapshot;
use nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;

/// Numbers per pair: a place and a force.
const WIDTH: usize = 6;
/// Quantum of places, m, and of forces, N.
const PLACE: f64 = 1e-3;
const FORCE: f64 = 1.0;

/// Two bodies of the model: one of the body's own, and what it touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(crate) struct Pair {
    pub own: usize,
    pub other: usize,
}

/// Contacts of all frames so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Contacts {
    frames: Vec<BTreeMap<Pair, [i32; WIDTH]>>,
}

impl Contacts {
    /// Appends a frame.
    pub fn look(&mut self, snapshot: &Snapshot<'_>) {
        // Force, and the sum of places weighted by the size of their forces.
        let mut pairs: BTreeMap<Pair, (Vector3<f64>, Vector3<f64>, f64)> = BTreeMap::new();
        for contact in snapshot.external_contacts() {
            let [own, other] = [contact.shape, contact.other].map(|geom| snapshot.model.geoms.body[geom]);
            let entry = pairs.entry(Pair { own, other }).or_default();
            let size = contact.force.norm();
            entry.0 += contact.force;
            entry.1 += contact.position * size;
            entry.2 += size;
        }
        let strong = pairs.into_iter().filter(|(_, (force, _, _))| force.norm() >= FORCE);
        let row = |(force, moment, size): (Vector3<f64>, Vector3<f64>, f64)| {
            let place = moment / size;
            [place.x / PLACE, place.y / PLACE, place.z / PLACE, force.x / FORCE, force.y / FORCE, force.z / FORCE]
                .map(|value| quantise(value, 1.0))
        };
        self.frames.push(strong.map(|(pair, sums)| (pair, row(sums))).collect());
    }

    /// All pairs, and a track of their rows. A pair without force keeps its last place.
    pub fn finish(&self) -> (Vec<Pair>, Track) {
        let all: BTreeMap<Pair, usize> = self.frames.iter().flatten().map(|(pair, _)| (*pair, 0)).collect();
        let mut present = vec![[0; WIDTH]; all.len()];
        let mut track = Track::new(WIDTH * all.len());
        for frame in &self.frames {
            for (row, pair) in present.iter_mut().zip(all.keys()) {
                match frame.get(pair) {
                    Some(found) => *row = *found,
                    None => row[3..].fill(0),
                }
            }
            track.push(present.iter().flatten().copied());
        }
        (all.into_keys().collect(), track)
    }
}
