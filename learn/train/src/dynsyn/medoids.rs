//! Clustering around medoids: elements that are near to their cluster's own representative, by distances alone.
//!
//! `FasterPAM` (Schubert and Rousseeuw 2021, Information Systems 101): a swap of a medoid for another element is taken as soon as it
//! makes the sum of distances smaller, and the change for all medoids is found in one pass over the elements.

use msk_runtime::episode::Stream;

/// What counts as a smaller sum: less than rounding moves it.
const GAIN: f64 = 1e-12;

/// Distances between elements, row by row.
pub(super) struct Distances {
    count: usize,
    values: Vec<f64>,
}

impl Distances {
    /// Of each pair, from the function of the smaller and the larger index; 0 from an element to itself.
    pub fn of(count: usize, pair: impl Fn(usize, usize) -> f64) -> Self {
        let mut values = vec![0.0; count * count];
        for high in 0..count {
            for low in 0..high {
                let distance = pair(low, high);
                values[low * count + high] = distance;
                values[high * count + low] = distance;
            }
        }
        Self { count, values }
    }

    fn between(&self, one: usize, other: usize) -> f64 {
        self.values[one * self.count + other]
    }
}

/// An element's nearest medoid, by its place among the medoids, and the distances to it and to the second nearest.
#[derive(Clone, Copy)]
struct Near {
    place: usize,
    first: f64,
    second: f64,
}

/// The cluster of each element, numbered in the order of their first elements: the best of `tries` searches from random medoids.
pub(super) fn clusters(distances: &Distances, clusters: usize, tries: usize, chance: &mut Stream) -> Vec<usize> {
    if distances.count == 0 {
        return Vec::new();
    }
    let wanted = clusters.clamp(1, distances.count);
    let mut best: Option<(f64, Vec<Near>)> = None;
    for _ in 0..tries.max(1) {
        let near = search(distances, wanted, chance);
        let sum: f64 = near.iter().map(|near| near.first).sum();
        if best.as_ref().is_none_or(|(least, _)| sum < least - GAIN) {
            best = Some((sum, near));
        }
    }
    let (_, near) = best.unwrap_or_default();
    let mut names = Vec::new();
    let mut name = |place: usize| {
        names.iter().position(|known| *known == place).unwrap_or_else(|| {
            names.push(place);
            names.len() - 1
        })
    };
    near.iter().map(|near| name(near.place)).collect()
}

/// Swaps medoids until none makes the sum smaller.
fn search(distances: &Distances, wanted: usize, chance: &mut Stream) -> Vec<Near> {
    let count = distances.count;
    // The first places of a shuffle (Fisher and Yates).
    let mut order: Vec<usize> = (0..count).collect();
    for place in 0..wanted {
        let other = place + ((chance.uniform() * (count - place) as f64) as usize).min(count - place - 1);
        order.swap(place, other);
    }
    let mut medoids = order[..wanted].to_vec();
    let mut near = assign(distances, &medoids);
    let (mut candidate, mut without_gain) = (0, 0);
    while without_gain < count {
        if !medoids.contains(&candidate)
            && let Some(place) = swap(distances, wanted, &near, candidate)
        {
            medoids[place] = candidate;
            near = assign(distances, &medoids);
            without_gain = 0;
        } else {
            without_gain += 1;
        }
        candidate = (candidate + 1) % count;
    }
    near
}

fn assign(distances: &Distances, medoids: &[usize]) -> Vec<Near> {
    let nearest = |element: usize| {
        let mut near = Near { place: 0, first: f64::INFINITY, second: f64::INFINITY };
        for (place, medoid) in medoids.iter().enumerate() {
            let distance = distances.between(element, *medoid);
            if distance < near.first || *medoid == element {
                near = Near { place, first: distance, second: near.first };
            } else if distance < near.second {
                near.second = distance;
            }
        }
        near
    };
    (0..distances.count).map(nearest).collect()
}

/// The medoid that is best replaced by a candidate, if that makes the sum of distances smaller (algorithm 3 of the paper).
fn swap(distances: &Distances, medoids: usize, near: &[Near], candidate: usize) -> Option<usize> {
    // What elements gain that come nearer whichever medoid goes, and what is lost besides where their own goes.
    let (mut all, mut lost) = (0.0, vec![0.0; medoids]);
    for (element, near) in near.iter().enumerate() {
        let distance = distances.between(element, candidate);
        if distance < near.first {
            all += distance - near.first;
        } else {
            let without = if distance < near.second { distance } else { near.second };
            lost[near.place] += without - near.first;
        }
    }
    let mut best = 0;
    for place in 1..medoids {
        if lost[place] < lost[best] {
            best = place;
        }
    }
    (all + lost[best] < -GAIN).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_runtime::episode::EpisodeKey;
    use proptest::prelude::*;

    fn chance(seed: u64) -> Stream {
        Stream::new(EpisodeKey { seed, episode: 0 }, "medoids")
    }

    fn of(points: &[f64]) -> Distances {
        Distances::of(points.len(), |one, other| (points[one] - points[other]).abs())
    }

    fn sum(distances: &Distances, medoids: &[usize]) -> f64 {
        assign(distances, medoids).iter().map(|near| near.first).sum()
    }

    #[test]
    fn heaps_of_points_are_found() {
        let points = [0.0, 5.0, 0.1, 9.0, 5.1, 0.2, 9.2, 4.9];
        assert_eq!(clusters(&of(&points), 3, 5, &mut chance(1)), [0, 1, 0, 2, 1, 0, 2, 1]);
        assert_eq!(clusters(&of(&points), 1, 1, &mut chance(1)), [0; 8]);
        assert_eq!(clusters(&of(&points), 8, 1, &mut chance(1)), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(clusters(&of(&points), 99, 1, &mut chance(1)), [0, 1, 2, 3, 4, 5, 6, 7], "as many as there are");
        assert!(clusters(&of(&[]), 3, 2, &mut chance(1)).is_empty());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn no_swap_is_left_that_gains(points in prop::collection::vec(0.0..10.0_f64, 2..14), wanted in 1..5_usize, seed in 0..99_u64) {
            let distances = of(&points);
            let wanted = wanted.min(points.len());
            let near = search(&distances, wanted, &mut chance(seed));
            let found: f64 = near.iter().map(|near| near.first).sum();
            // The medoids: one element of each cluster is at distance 0 of its own.
            let medoids: Vec<usize> = (0..wanted)
                .map(|place| (0..points.len()).find(|element| near[*element].place == place && near[*element].first == 0.0).unwrap())
                .collect();
            for place in 0..wanted {
                for candidate in 0..points.len() {
                    let mut other = medoids.clone();
                    other[place] = candidate;
                    prop_assert!(sum(&distances, &other) >= found - 1e-9);
                }
            }
        }
    }
}
