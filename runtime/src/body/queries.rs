//! What tasks ask of the terrain.

use super::sensors::Snapshot;
use crate::physics::collision::{Placed, Solid, ray};
use crate::scene::ground::Ground;
use crate::scene::radar::Radar;
use msk_compiler::frame::{Origin, Query};
use nalgebra::{Vector2, Vector3};

impl Snapshot<'_> {
    /// Answers a query; `answer` has as many values as it says.
    pub(super) fn answer(&self, query: &Query, answer: &mut [f64]) {
        match query {
            Query::GroundHeight(origin) => answer.fill(self.ground().height(self.place(origin).xy())),
            Query::GroundNormal(origin) => {
                answer.copy_from_slice(self.ground().normal(self.place(origin).xy()).as_slice());
            }
            Query::Radar { from, group, over, range, .. } => self.radar(*from, *group, [*over, *range], answer),
            Query::Ray { from, direction, range } => answer.fill(self.ray(*from, Vector3::from(*direction), *range)),
        }
    }

    /// The ground where it is now.
    pub fn ground(&self) -> Ground<'_> {
        Ground { model: self.model, kinematics: &self.workspace.kinematics, shapes: &self.body.ground }
    }

    /// The place that a query begins at, m.
    pub fn place(&self, origin: &Origin) -> Vector3<f64> {
        match origin {
            Origin::World(place) => Vector3::from(*place),
            Origin::Landmark(landmark, [forward, left, up]) => {
                let ahead = self.heading(*landmark);
                let level = ahead * *forward + Vector2::new(-ahead.y, ahead.x) * *left;
                self.landmark_position(&self.body.landmarks[*landmark]) + Vector3::new(level.x, level.y, *up)
            }
        }
    }

    /// Where a landmark's forward axis points, seen from above: unit vector; world x where it is vertical.
    fn heading(&self, landmark: usize) -> Vector2<f64> {
        let landmark = &self.body.landmarks[landmark];
        let forward = self.workspace.kinematics.body_rotation[landmark.body] * landmark.axes.column(0);
        forward.xy().try_normalize(1e-12).unwrap_or_else(Vector2::x)
    }

    /// Nearness of the members of a group, sector by sector from left to right.
    fn radar(&self, from: usize, group: usize, [over, range]: [f64; 2], sectors: &mut [f64]) {
        sectors.fill(0.0);
        let eye = self.landmark_position(&self.body.landmarks[from]).xy();
        let radar = Radar { eye, heading: self.heading(from), over, range };
        for &member in &self.body.groups[group].members {
            for &shape in &self.body.landmarks[member].segment {
                let placed = Placed::of(self.model, &self.workspace.kinematics, 0, shape);
                if let Some(solid) = Solid::new(&placed, Vector3::zeros()) {
                    radar.see(&solid, sectors);
                }
            }
        }
    }

    /// Distance to the first solid of the scene along a direction in a landmark's axes, at most `range`, m.
    fn ray(&self, from: usize, direction: Vector3<f64>, range: f64) -> f64 {
        let (model, kinematics) = (self.model, &self.workspace.kinematics);
        let landmark = &self.body.landmarks[from];
        let line = [self.landmark_position(landmark), kinematics.body_rotation[landmark.body] * landmark.axes * direction];
        let geoms = &model.geoms;
        let solid = |geom: usize| geoms.contact_type[geom] != 0 || geoms.contact_affinity[geom] != 0;
        let others = |geom: usize| solid(geom) && !self.body.owns(geoms.body[geom]) && !landmark.segment.contains(&geom);
        ray::cast(model, kinematics, 0, line, range, others).map_or(range, |hit| hit.distance)
    }
}
