//! Pairs whose bounding spheres meet, and which neither the line between their centres nor a face of a box parts, of all lanes at once.

use super::{Contact, Memory, Plan};
use crate::{
    batch::PerLane,
    kinematics::Kinematics,
    model::{GeomKind, HeightField, Model},
    scalar::Real,
    spatial::{constant, dot, norm, rotate_back, scale},
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
            let mut bound = T::splat(candidate.bound);
            if own_shapes {
                for lane in 0..T::LANES {
                    let growth = overrides.lane(lane).map_or(0.0, |own| own.growth(model, candidate.geoms));
                    bound.set_lane(lane, candidate.bound + growth);
                }
            }
            let [first, second] = candidate.geoms;
            let between = geom_position[second] - geom_position[first];
            let plane = candidate.kinds[0] == GeomKind::Plane;
            let normal = geom_rotation[first].column(2).into_owned();
            let far = if plane { bound.less(dot(&between, &normal)) } else { (bound * bound).less(dot(&between, &between)) };
            let mut near = T::not(far);
            if !T::any(near) {
                continue;
            }
            let (first, second) =
                (Bounds::of(model, kinematics, first, own_shapes), Bounds::of(model, kinematics, second, own_shapes));
            // Centres in one place give no direction: nothing is less than NaN.
            let direction = if plane { normal } else { scale(&between, T::splat(1.0) / norm(&between)) };
            let reach = T::splat(candidate.reach() + SLACK);
            let mut least = reach + second.extent(&direction);
            if !plane {
                least += first.extent(&direction);
            }
            near = T::and(near, T::not(least.less(dot(&between, &direction))));
            // A plane is all on one side of itself, and nothing is beside it.
            let faces = [(&first, &second), (&second, &first)];
            for (one, other) in faces.into_iter().filter(|(one, _)| !plane && one.has_faces()) {
                if T::any(near) {
                    near = T::and(near, T::not(one.parted_by_a_face(other, reach)));
                }
            }
            if T::any(near) {
                pairs.push((index, near));
            }
        }
    }
}

/// A geom, as far as it is seen here.
struct Bounds<'a, T: Real> {
    kind: GeomKind,
    position: &'a Vector3<T>,
    rotation: &'a Matrix3<T>,
    /// Size as defined by its kind, of a height field half the sides of the box that holds it, m.
    size: Vector3<T>,
    /// How far the middle of that box lies above the geom's origin along its z axis, m: 0 for other kinds.
    rise: T,
    /// Radius of a sphere about its origin that holds it, m: of a height field and a mesh, whose extents it stands for.
    radius: T,
}

impl<'a, T: Real> Bounds<'a, T> {
    #[inline(always)]
    fn of(model: &Model, kinematics: &'a Kinematics<T>, geom: usize, own_shapes: bool) -> Self {
        let kind = model.geoms.kind[geom];
        let mut of = Self {
            kind,
            position: &kinematics.geom_position[geom],
            rotation: &kinematics.geom_rotation[geom],
            size: kinematics.overrides.size(model, geom),
            rise: T::splat(0.0),
            radius: T::splat(model.geoms.bounding_radius[geom]),
        };
        if let (GeomKind::HeightField, Some(asset)) = (kind, model.geoms.asset[geom]) {
            let (half, rise) = box_around(&model.height_fields[asset]);
            of.size = constant(&half);
            of.rise = T::splat(rise);
            if own_shapes {
                of.take_heights(model, kinematics, geom);
            }
        }
        of
    }

    /// Takes the heights that single lanes have of their own.
    fn take_heights(&mut self, model: &Model, kinematics: &Kinematics<T>, geom: usize) {
        let overrides = &kinematics.overrides;
        for lane in 0..T::LANES {
            let Some(heights) = overrides.shape(lane, geom).and_then(|own| own.heights.as_ref()) else { continue };
            let (half, rise) = box_around(heights);
            self.size.iter_mut().zip(half.iter()).for_each(|(all, own)| all.set_lane(lane, *own));
            self.rise.set_lane(lane, rise);
            self.radius.set_lane(lane, overrides.bounding_radius(model, lane, geom));
        }
    }

    /// How far the shape reaches from its origin along a unit vector, m.
    #[inline(always)]
    fn extent(&self, direction: &Vector3<T>) -> T {
        let [a, b, c] = [self.size.x, self.size.y, self.size.z];
        let local = rotate_back(self.rotation, direction);
        let [x, y, z] = [local.x.abs(), local.y.abs(), local.z.abs()];
        match self.kind {
            GeomKind::Sphere => a,
            GeomKind::Capsule => a + b * z,
            GeomKind::Ellipsoid => ((a * x).squared() + (b * y).squared() + (c * z).squared()).sqrt(),
            GeomKind::Cylinder => a * (x.squared() + y.squared()).sqrt() + b * z,
            GeomKind::Box => a * x + b * y + c * z,
            GeomKind::Plane | GeomKind::HeightField | GeomKind::Mesh => self.radius,
        }
    }

    /// Whether it fills a box well.
    fn has_faces(&self) -> bool {
        matches!(self.kind, GeomKind::Box | GeomKind::HeightField)
    }

    /// The lanes in which another shape lies more than `reach` beyond a face of the box that holds this one.
    #[inline(always)]
    fn parted_by_a_face(&self, other: &Self, reach: T) -> T::Mask {
        let mut place = rotate_back(self.rotation, &(other.position - self.position));
        place.z -= self.rise;
        let mut parted = T::mask(|_| false);
        for axis in 0..3 {
            let face = self.rotation.column(axis).into_owned();
            let least = self.size[axis] + other.extent(&face) + reach;
            parted = T::or(parted, least.less(place[axis].abs()));
        }
        parted
    }
}

/// Half the sides of the box that holds a height field, and how far its middle lies above the field's origin, m.
fn box_around(field: &HeightField) -> (Vector3<f64>, f64) {
    let [x, y] = field.radius;
    (Vector3::new(x, y, 0.5 * (field.elevation + field.base)), 0.5 * (field.elevation - field.base))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overrides::{Overrides, ShapeOverride, ShapeOverrides};
    use crate::{State, Workspace, step};
    use proptest::prelude::*;

    const KINDS: [&str; 5] = ["sphere", "capsule", "ellipsoid", "cylinder", "box"];

    /// Two shapes that fly, over a plane and waves that lean, with a margin.
    fn model(kinds: [usize; 2], sizes: [[f64; 3]; 2]) -> Model {
        let body = |index: usize| {
            let [a, b, c] = sizes[index];
            let kind = KINDS[kinds[index]];
            format!(r#"<body><freejoint/><geom type="{kind}" size="{a} {b} {c}" margin="0.02"/></body>"#)
        };
        let text = format!(
            r#"<mujoco>
            <asset><hfield name="waves" nrow="2" ncol="3" elevation="0 1 .2 .4 0 .7" size=".4 .3 .2 .05"/></asset>
            <worldbody>
                <geom type="plane" size="1 1 1"/>
                <geom type="hfield" hfield="waves" pos=".1 0 -.1" euler="10 20 30"/>
                {}{}
            </worldbody></mujoco>"#,
            body(0),
            body(1)
        );
        Model::from_mjcf(&text).unwrap()
    }

    proptest! {
        #[test]
        fn pairs_that_are_not_near_have_no_contacts(
            kinds in [0_usize..5, 0..5],
            sizes in [[0.02_f64..0.3, 0.02..0.3, 0.02..0.3], [0.02..0.3, 0.02..0.3, 0.02..0.3]],
            places in [[-0.4_f64..0.4, -0.4..0.4, -0.4..0.4], [-0.4..0.4, -0.4..0.4, -0.4..0.4]],
            turns in [[-1.0_f64..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0], [-1.0..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0]],
            own in proptest::option::of([0.02_f64..0.5, 0.02..0.5, 0.02..0.5]),
        ) {
            let model = model(kinds, sizes);
            let mut state = State::<f64>::new(&model);
            for body in 0..2 {
                state.position[7 * body..][..3].copy_from_slice(&places[body]);
                state.position[7 * body + 3..][..4].copy_from_slice(&turns[body]);
            }
            if let Some(size) = own {
                let (geom, size) = (model.geoms.kind.len() - 1, Vector3::from(size));
                let shape = ShapeOverride { geom, size, position: Vector3::zeros(), heights: None };
                state.overrides = Overrides::of(ShapeOverrides { shapes: vec![shape], moments: Vec::new() });
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

    #[test]
    fn a_shape_over_a_wide_box_is_parted_by_its_face() {
        let model = model([4, 1], [[1.0, 1.0, 0.02], [0.05, 0.2, 0.0]]);
        let mut state = State::<f64>::new(&model);
        let mut over = |height: f64| {
            state.position[..3].copy_from_slice(&[0.0, 0.0, 1.0]);
            state.position[7..10].copy_from_slice(&[0.8, 0.0, 1.0 + height]);
            let mut workspace = Workspace::new(&model);
            step(&model, &mut state, &mut workspace).unwrap();
            workspace.near.in_lane(0).count()
        };
        assert_eq!([over(0.35), over(0.25)], [0, 1]);
    }
}
