//! Pairs whose bounding spheres meet, of all lanes at once.

use super::Plan;
use crate::{
    kinematics::Kinematics,
    model::{GeomKind, Model},
    scalar::Real,
    spatial::dot,
};
use std::sync::Arc;

/// The pairs that are worth a collider.
#[derive(Debug, Clone)]
pub struct NearPairs<T: Real> {
    plan: Arc<Plan>,
    /// Candidates that may be near in any lane, ascending.
    chosen: Vec<usize>,
    /// Candidates, ascending, with the lanes in which they are near.
    pairs: Vec<(usize, T::Mask)>,
}

impl<T: Real> NearPairs<T> {
    pub(crate) fn of(plan: &Arc<Plan>) -> Self {
        Self { plan: Arc::clone(plan), chosen: Vec::new(), pairs: Vec::new() }
    }

    /// The candidates that are near in a lane, ascending.
    pub fn in_lane(&self, lane: usize) -> impl Iterator<Item = usize> {
        self.pairs.iter().filter(move |(_, lanes)| T::holds(*lanes, lane)).map(|(candidate, _)| *candidate)
    }

    /// Finds them where the kinematics put the geoms.
    #[inline(always)]
    pub(crate) fn update(&mut self, model: &Model, kinematics: &Kinematics<T>) {
        let Self { plan, chosen, pairs } = self;
        pairs.clear();
        if !model.options.switches.contact {
            return;
        }
        let Kinematics { geom_position, geom_rotation, overrides, .. } = kinematics;
        plan.broad.choose(T::LANES, |geom, axis, lane| geom_position[geom][axis].lane(lane), chosen);
        let own_shapes = !overrides.is_empty();
        for &index in chosen.iter() {
            T::apart();
            let candidate = &plan.candidates[index];
            let [first, second] = candidate.geoms;
            let mut bound = T::splat(candidate.bound);
            if own_shapes {
                for lane in 0..T::LANES {
                    let growth = overrides.lane(lane).map_or(0.0, |own| own.growth(model, candidate.geoms));
                    bound.set_lane(lane, candidate.bound + growth);
                }
            }
            let between = geom_position[second] - geom_position[first];
            let far = if candidate.kinds[0] == GeomKind::Plane {
                bound.less(dot(&between, &geom_rotation[first].column(2).into_owned()))
            } else {
                (bound * bound).less(dot(&between, &between))
            };
            let near = T::not(far);
            if T::any(near) {
                pairs.push((index, near));
            }
        }
    }
}
