//! Which candidates are worth a closer look.
//!
//! Shapes that never move are sorted once along the axis of the world that spreads them most; a shape that moves looks up
//! those near it on that axis. Pairs of moving shapes, planes and very large shapes are always looked at.

use super::CollisionPair;
use crate::model::{GeomKind, Model, rotation};
use crate::scalar::Real;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// With fewer resting partners looking at all of them costs less.
const FEWEST: usize = 12;
/// A partner whose reach exceeds the median of its group this many times would blur the group's: it is always looked at.
const LARGE: f64 = 4.0;
/// Room for rounding, m.
const SLACK: f64 = 1e-6;

/// The order of looking at candidates.
#[derive(Debug, Clone, Default)]
pub(super) struct Broad {
    /// Candidates always looked at, ascending.
    always: Vec<usize>,
    /// One row for each shape with many resting partners.
    rows: Vec<Row>,
}

/// The resting partners of one moving shape.
#[derive(Debug, Clone)]
struct Row {
    geom: usize,
    axis: usize,
    /// Largest distance of centres at which any pair can touch, m.
    reach: f64,
    /// Centres of the partners on the axis, ascending, and their candidates.
    places: Vec<(f64, usize)>,
}

impl Broad {
    /// Sorts the resting shapes of a model.
    pub fn new(model: &Model, candidates: &[CollisionPair]) -> Self {
        let rests = |geom: usize| model.bodies.weld[model.geoms.body[geom]] == 0;
        let mut groups: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
        let mut always = Vec::new();
        for (index, candidate) in candidates.iter().enumerate() {
            let [first, second] = candidate.geoms;
            match (rests(first), rests(second)) {
                (true, false) if candidate.kinds[0] != GeomKind::Plane => groups.entry(second).or_default().push((first, index)),
                (false, true) => groups.entry(first).or_default().push((second, index)),
                _ => always.push(index),
            }
        }
        let mut rows = Vec::new();
        for (geom, partners) in groups {
            let mut reaches: Vec<f64> = partners.iter().map(|&(_, index)| candidates[index].bound).collect();
            reaches.sort_by(f64::total_cmp);
            let largest = LARGE * reaches[reaches.len() / 2];
            let (near, far): (Vec<_>, Vec<_>) = partners.into_iter().partition(|&(_, index)| candidates[index].bound <= largest);
            always.extend(far.into_iter().map(|(_, index)| index));
            if near.len() < FEWEST {
                always.extend(near.into_iter().map(|(_, index)| index));
                continue;
            }
            let centres: Vec<Vector3<f64>> = near.iter().map(|&(partner, _)| resting_place(model, partner)).collect();
            let (low, high) = centres.iter().fold((centres[0], centres[0]), |(low, high), c| (low.inf(c), high.sup(c)));
            let (axis, _) = (high - low).argmax();
            let mut places: Vec<(f64, usize)> =
                centres.iter().zip(&near).map(|(centre, &(_, index))| (centre[axis], index)).collect();
            places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let reach = near.iter().map(|&(_, index)| candidates[index].bound).fold(0.0, Real::at_least) + SLACK;
            rows.push(Row { geom, axis, reach, places });
        }
        always.sort_unstable();
        Self { always, rows }
    }

    /// Writes the candidates worth a closer look in any lane to `chosen`, ascending. `position` gives the coordinate of a geom along an
    /// axis in a lane.
    pub fn choose(&self, lanes: usize, position: impl Fn(usize, usize, usize) -> f64, chosen: &mut Vec<usize>) {
        chosen.clear();
        chosen.extend_from_slice(&self.always);
        for row in &self.rows {
            for lane in 0..lanes {
                let centre = position(row.geom, row.axis, lane);
                let start = row.places.partition_point(|place| place.0 < centre - row.reach);
                let near = row.places[start..].iter().take_while(|place| place.0 <= centre + row.reach);
                chosen.extend(near.map(|place| place.1));
            }
        }
        if !self.rows.is_empty() {
            chosen.sort_unstable();
            chosen.dedup();
        }
    }
}

/// Where the centre of a shape that never moves is in the world.
fn resting_place(model: &Model, geom: usize) -> Vector3<f64> {
    let mut place = model.geoms.position[geom];
    let mut body = model.geoms.body[geom];
    while body != 0 {
        place = model.bodies.position[body] + rotation::rotate(model.bodies.orientation[body], place);
        body = model.bodies.parent[body];
    }
    place
}

#[cfg(test)]
mod tests {
    use super::super::Plan;
    use super::*;

    #[test]
    fn a_ball_over_a_row_of_boxes_looks_at_those_near_it() {
        let boxes: String =
            (0..40).map(|k| format!(r#"<body pos="{k} 0 0"><geom type="box" size=".5 .5 .1"/></body>"#)).collect();
        let text = format!(
            r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/>{boxes}
            <body pos="20.2 0 .2"><freejoint/><geom size=".15"/></body></worldbody></mujoco>"#
        );
        let model = Model::from_mjcf(&text).unwrap();
        let plan = Plan::new(&model);
        assert_eq!(plan.candidates.len(), 41, "resting boxes never meet each other");
        let broad = Broad::new(&model, &plan.candidates);
        let mut chosen = Vec::new();
        let ball = plan.candidates[0].geoms[1];
        let position = |geom: usize| if geom == ball { Vector3::new(20.2, 0.0, 0.2) } else { resting_place(&model, geom) };
        broad.choose(1, |geom, axis, _| position(geom)[axis], &mut chosen);
        assert!(chosen.len() <= 4 && chosen.is_sorted(), "{chosen:?}");
        let touches = |index: &usize| {
            let [a, b] = plan.candidates[*index].geoms;
            (position(a) - position(b)).norm() < plan.candidates[*index].bound
        };
        assert!((0..plan.candidates.len()).filter(touches).all(|index| chosen.contains(&index)));
    }
}
