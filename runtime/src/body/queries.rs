//! What tasks ask of the terrain.

use super::sensors::Snapshot;
use crate::scene::ground::Ground;
use crate::scene::radar::Radar;
use msk_physics::collision::{Placed, SupportShape, ray};
use msk_program::frame::{Origin, Query};
use nalgebra::Vector3;

impl Snapshot<'_> {
    /// Answers a query; `answer` has as many values as the query.
    pub(super) fn answer(&self, query: &Query, answer: &mut [f64]) {
        let place = |origin: &Origin| self.body.place_of(&self.workspace.kinematics, origin).xy();
        match query {
            Query::GroundHeight(origin) => answer.fill(self.ground().height(place(origin))),
            Query::GroundNormal(origin) => answer.copy_from_slice(self.ground().normal(place(origin)).as_slice()),
            Query::Radar { from, group, over, range, .. } => self.radar(*from, *group, [*over, *range], answer),
            Query::Ray { from, direction, range } => answer.fill(self.ray(*from, Vector3::from(*direction), *range)),
        }
    }

    /// The ground where it is now.
    pub fn ground(&self) -> Ground<'_> {
        Ground { model: self.model, kinematics: &self.workspace.kinematics, shapes: &self.body.ground }
    }

    /// Nearness of the members of a group, sector by sector from left to right.
    fn radar(&self, from: usize, group: usize, [over, range]: [f64; 2], sectors: &mut [f64]) {
        sectors.fill(0.0);
        let kinematics = &self.workspace.kinematics;
        let eye = self.body.landmark_position(kinematics, from).xy();
        let radar = Radar { eye, heading: self.body.heading(kinematics, from), over, range };
        for &member in &self.body.groups[group].members {
            for &shape in &self.body.landmarks[member].segment {
                let placed = Placed::of(self.model, kinematics, 0, shape);
                if let Some(solid) = SupportShape::new(&placed, Vector3::zeros()) {
                    radar.see(&solid, sectors);
                }
            }
        }
    }

    /// Distance to the first solid of the scene along a direction in a landmark's axes, at most `range`, m.
    fn ray(&self, from: usize, direction: Vector3<f64>, range: f64) -> f64 {
        let (model, kinematics) = (self.model, &self.workspace.kinematics);
        let landmark = &self.body.landmarks[from];
        let line =
            [self.body.landmark_position(kinematics, from), kinematics.body_rotation[landmark.body] * landmark.axes * direction];
        let geoms = &model.geoms;
        let solid = |geom: usize| geoms.contact_type[geom] != 0 || geoms.contact_affinity[geom] != 0;
        let others = |geom: usize| solid(geom) && !self.body.owns(geoms.body[geom]) && !landmark.segment.contains(&geom);
        ray::cast(model, kinematics, 0, line, range, others).map_or(range, |hit| hit.distance)
    }
}
