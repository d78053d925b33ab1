//! What sensors read of surfaces: pushes on a zone, the range of a ray, distances.

use super::View;
use crate::{
    collision::{
        Scratch, distance,
        place::{Asset, Placed},
        ray,
    },
    model::{Framed, GapQuantity, Measure, Surface},
};
use core::ops::Range;
use nalgebra::Vector3;

impl View<'_> {
    pub(super) fn touch(&self, site: usize, measure: &Measure) -> f64 {
        let Measure::Touch { shape, size, .. } = *measure else { return 0.0 };
        let (position, rotation) = self.place(Framed::Site(site));
        let zone = Placed { kind: shape, position, rotation, size, asset: Asset::None };
        let body = self.model.sites.body[site];
        let mut sum = 0.0;
        for contact in self.workspace.lanes.iter().take(1).flat_map(|lane| &lane.constraints.contacts) {
            let bodies = contact.geoms.map(|geom| self.model.geoms.body[geom]);
            let normal: Vector3<f64> = contact.frame.row(0).transpose();
            // From the contact into the other body: where the skin of the sensor's own body should be.
            let ray = if bodies[1] == body { -normal } else { normal };
            if contact.force[0] > 0.0 && bodies.contains(&body) && ray::meet(&zone, contact.position, ray).is_some() {
                sum += contact.force[0];
            }
        }
        sum
    }

    /// How far the first visible shape of another body is along a site's z axis, -1 where there is none.
    pub(super) fn range(&self, site: usize) -> f64 {
        let (model, kinematics) = (self.model, &self.workspace.kinematics);
        let (origin, axes) = self.place(Framed::Site(site));
        let direction = axes.column(2).into_owned();
        let admits = |geom: usize| model.geoms.visible[geom] && model.geoms.body[geom] != model.sites.body[site];
        ray::cast(model, kinematics, 0, [origin, direction], f64::INFINITY, admits).map_or(-1.0, |hit| hit.distance)
    }

    /// Of the nearest pair of shapes within `range`: the range itself and zeros where there is none.
    pub(super) fn gap(&self, surfaces: [Surface; 2], quantity: GapQuantity, range: f64, out: &mut Vec<f64>) {
        let (model, kinematics) = (self.model, &self.workspace.kinematics);
        let mut scratch = Scratch::default();
        let (mut least, mut points) = (range, [Vector3::zeros(); 2]);
        let [first, second] = surfaces.map(|surface| self.geoms_of(surface));
        for geom in first {
            for other in second.clone() {
                let [a, b] = [geom, other].map(|geom| Placed::of(model, kinematics, 0, geom));
                if let Some(gap) = distance::between(&a, &b, range, &mut scratch)
                    && gap.distance < least
                {
                    (least, points) = (gap.distance, gap.points);
                }
            }
        }
        match quantity {
            GapQuantity::Distance => out.push(least),
            GapQuantity::Normal => out.extend(&(points[1] - points[0]).try_normalize(0.0).unwrap_or_default()),
            GapQuantity::Segment => points.iter().for_each(|point| out.extend(point)),
        }
    }

    fn geoms_of(&self, surface: Surface) -> Range<usize> {
        match surface {
            Surface::Geom(geom) => geom..geom + 1,
            Surface::Body(body) => self.model.bodies.geoms[body].clone(),
        }
    }
}
