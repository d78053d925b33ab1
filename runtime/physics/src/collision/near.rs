//! Pairs whose bounding spheres meet, and which the line between their centres does not part, of all lanes at once.

use super::{Contact, Memory, Plan};
use crate::{
    batch::PerLane,
    kinematics::Kinematics,
    model::{GeomKind, Model},
    scalar::Real,
    spatial::{dot, norm, rotate_back, scale},
};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Room for rounding, m.
const SLACK: f64 = 1e-6;

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

    /// Finds their contacts: see [`Plan::detect`].
    #[inline(always)]
    pub(crate) fn detect(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        contacts: &mut PerLane<&mut Vec<Contact>>,
        memory: &mut Memory<T>,
    ) {
        self.plan.detect(model, (kinematics, self), contacts, memory);
    }

    /// The candidates that are near in any lane, ascending, with these lanes.
    #[inline(always)]
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, T::Mask)> {
        self.pairs.iter().copied()
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
            let plane = candidate.kinds[0] == GeomKind::Plane;
            let normal = geom_rotation[first].column(2).into_owned();
            let far = if plane { bound.less(dot(&between, &normal)) } else { (bound * bound).less(dot(&between, &between)) };
            let mut near = T::not(far);
            if !own_shapes && T::any(near) {
                // Centres in one place give no direction: nothing is less than NaN.
                let direction = if plane { normal } else { scale(&between, T::splat(1.0) / norm(&between)) };
                let mut reach = T::splat(candidate.reach() + SLACK) + extent(model, geom_rotation, second, &direction);
                if !plane {
                    reach += extent(model, geom_rotation, first, &direction);
                }
                near = T::and(near, T::not(reach.less(dot(&between, &direction))));
            }
            if T::any(near) {
                pairs.push((index, near));
            }
        }
    }
}

/// How far a shape reaches from its centre along a unit vector, m.
#[inline(always)]
fn extent<T: Real>(model: &Model, rotation: &[Matrix3<T>], geom: usize, direction: &Vector3<T>) -> T {
    let size = &model.geoms.size[geom];
    let (a, b, c) = (T::splat(size.x), T::splat(size.y), T::splat(size.z));
    let local = rotate_back(&rotation[geom], direction);
    let [x, y, z] = [local.x.abs(), local.y.abs(), local.z.abs()];
    match model.geoms.kind[geom] {
        GeomKind::Sphere => a,
        GeomKind::Capsule => a + b * z,
        GeomKind::Ellipsoid => ((a * x).squared() + (b * y).squared() + (c * z).squared()).sqrt(),
        GeomKind::Cylinder => a * (x.squared() + y.squared()).sqrt() + b * z,
        GeomKind::Box => a * x + b * y + c * z,
        GeomKind::Plane | GeomKind::HeightField | GeomKind::Mesh => T::splat(model.geoms.bounding_radius[geom]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{State, Workspace, step};
    use proptest::prelude::*;

    const KINDS: [&str; 5] = ["sphere", "capsule", "ellipsoid", "cylinder", "box"];

    /// Two shapes that fly, over a plane, with a margin.
    fn model(kinds: [usize; 2], sizes: [[f64; 3]; 2]) -> Model {
        let body = |index: usize| {
            let [a, b, c] = sizes[index];
            let kind = KINDS[kinds[index]];
            format!(r#"<body><freejoint/><geom type="{kind}" size="{a} {b} {c}" margin="0.02"/></body>"#)
        };
        let text = format!(r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/>{}{}</worldbody></mujoco>"#, body(0), body(1));
        Model::from_mjcf(&text).unwrap()
    }

    proptest! {
        #[test]
        fn pairs_that_are_not_near_have_no_contacts(
            kinds in [0_usize..5, 0..5],
            sizes in [[0.02_f64..0.3, 0.02..0.3, 0.02..0.3], [0.02..0.3, 0.02..0.3, 0.02..0.3]],
            places in [[-0.4_f64..0.4, -0.4..0.4, -0.4..0.4], [-0.4..0.4, -0.4..0.4, -0.4..0.4]],
            turns in [[-1.0_f64..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0], [-1.0..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0]],
        ) {
            let model = model(kinds, sizes);
            let mut state = State::<f64>::new(&model);
            for body in 0..2 {
                state.position[7 * body..][..3].copy_from_slice(&places[body]);
                state.position[7 * body + 3..][..4].copy_from_slice(&turns[body]);
            }
            let mut workspace = Workspace::new(&model);
            // Where it was solved does not matter, only that positions were passed forward.
            let _ = crate::forward(&model, &state, &mut workspace);
            let near: Vec<usize> = workspace.near.in_lane(0).collect();
            let plan = Arc::clone(&workspace.lanes[0].constraints.plan);
            let pairs = (0..plan.candidates.len()).map(|index| (index, true)).collect();
            let all = NearPairs { plan: Arc::clone(&plan), chosen: Vec::new(), pairs };
            let mut found: Vec<Contact> = Vec::new();
            let mut lists = [const { None }; crate::lanes::WIDTH];
            lists[0] = Some(&mut found);
            plan.detect(&model, (&workspace.kinematics, &all), &mut lists, &mut Memory::new());
            for contact in found {
                prop_assert!(near.contains(&contact.candidate), "{:?}: {contact:?}", plan.candidates[contact.candidate].kinds);
            }
        }
    }

    #[test]
    fn shapes_side_by_side_are_parted_although_their_spheres_meet() {
        let model = model([1, 1], [[0.05, 0.3, 0.0]; 2]);
        let mut state = State::<f64>::new(&model);
        state.position[..3].copy_from_slice(&[0.0, 0.0, 1.0]);
        state.position[7..10].copy_from_slice(&[0.2, 0.0, 1.0]);
        let mut workspace = Workspace::new(&model);
        step(&model, &mut state, &mut workspace).unwrap();
        assert_eq!(workspace.near.in_lane(0).count(), 0);
        state.position[7] = 0.11;
        step(&model, &mut state, &mut workspace).unwrap();
        assert_eq!(workspace.near.in_lane(0).count(), 1);
    }
}
