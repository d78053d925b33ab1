//! Contacts and distances between parts: segments of landmarks, objects, groups, the ground, the whole body.

use super::Body;
use super::sensors::Snapshot;
use crate::scene::ground::Ground;
use msk_physics::collision::{Contact, Placed, Scratch, distance};
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_program::scene::Part;
use nalgebra::Vector3;

impl Body {
    /// Whether a shape belongs to a part.
    pub fn holds(&self, model: &Model, part: Part, shape: usize) -> bool {
        match part {
            Part::Ground => self.ground.contains(&shape),
            Part::Landmark(landmark) => self.landmarks[landmark].segment.contains(&shape),
            Part::Group(group) => {
                self.groups[group].members.iter().any(|&landmark| self.landmarks[landmark].segment.contains(&shape))
            }
            Part::Robot => self.owns(model.geoms.body[shape]),
        }
    }

    /// Shows all shapes of a part that can touch anything; one may come twice.
    fn each_shape(&self, part: Part, mut show: impl FnMut(usize)) {
        match part {
            Part::Ground => self.ground.iter().copied().for_each(show),
            Part::Landmark(landmark) => self.landmarks[landmark].segment.iter().copied().for_each(show),
            Part::Group(group) => {
                for &landmark in &self.groups[group].members {
                    self.landmarks[landmark].segment.iter().copied().for_each(&mut show);
                }
            }
            Part::Robot => self.shapes.iter().copied().for_each(show),
        }
    }
}

/// A contact between two parts.
#[derive(Debug, Clone, Copy)]
struct Meeting<'a> {
    contact: &'a Contact,
    /// Whether the first part holds the contact's second shape, on which its force acts by convention.
    in_order: bool,
}

impl Meeting<'_> {
    /// Force on the first part, world axes, N.
    fn force(&self) -> Vector3<f64> {
        let [normal, first_tangent, second_tangent, ..] = self.contact.force;
        let force = self.contact.frame.transpose() * Vector3::new(normal, first_tangent, second_tangent);
        if self.in_order { force } else { -force }
    }
}

impl Snapshot<'_> {
    /// The contacts of two parts, where forces act.
    fn meetings(&self, first: Part, second: Part) -> impl Iterator<Item = Meeting<'_>> {
        // One episode has one lane.
        let constraints = self.workspace.lanes.first().map(|lane| &lane.constraints);
        let holds = move |part: Part, shape: usize| self.body.holds(self.model, part, shape);
        constraints.into_iter().flat_map(move |constraints| {
            constraints.contacts.iter().filter_map(move |contact| {
                // Contacts in the gap beyond the margin are reported, but carry no force.
                if contact.distance >= constraints.plan.candidates[contact.candidate].margin {
                    return None;
                }
                let [a, b] = contact.geoms;
                if holds(first, b) && holds(second, a) {
                    Some(Meeting { contact, in_order: true })
                } else if holds(first, a) && holds(second, b) {
                    Some(Meeting { contact, in_order: false })
                } else {
                    None
                }
            })
        })
    }

    /// One where two parts touch, else zero.
    pub(super) fn touching(&self, first: Part, second: Part) -> f64 {
        f64::from(u8::from(self.meetings(first, second).next().is_some()))
    }

    /// Number of contacts of two parts.
    pub(super) fn contact_count(&self, first: Part, second: Part) -> usize {
        self.meetings(first, second).count()
    }

    /// Force on the first part by the second, world axes, N.
    pub(super) fn contact_force(&self, first: Part, second: Part) -> Vector3<f64> {
        self.meetings(first, second).map(|meeting| meeting.force()).sum()
    }

    /// Sliding speed where two parts touch, the mean over their contacts weighted by normal force, m/s; zero without any.
    pub(super) fn slip(&self, first: Part, second: Part) -> f64 {
        let (mut sliding, mut pressing) = (0.0, 0.0);
        for Meeting { contact, .. } in self.meetings(first, second) {
            let [a, b] = contact.geoms.map(|geom| self.velocity_of(self.model.geoms.body[geom], contact.position));
            let against = contact.frame * (b - a);
            let [normal, ..] = contact.force;
            sliding += normal * against.yz().norm();
            pressing += normal;
        }
        if pressing > 0.0 { sliding / pressing } else { 0.0 }
    }

    /// Shortest distance between the surfaces of two parts, negative where they overlap, m.
    pub(super) fn surface_distance(&self, first: Part, second: Part) -> f64 {
        let (model, kinematics) = (self.model, &self.workspace.kinematics);
        let mut scratch = Scratch::default();
        let mut least = f64::INFINITY;
        self.body.each_shape(first, |one| {
            if second == Part::Ground && self.body.ground.is_empty() {
                let level = Ground { model, kinematics, shapes: &[] };
                least = least.at_most(level.clearance(&[one]));
            }
            let placed = Placed::of(model, kinematics, 0, one);
            self.body.each_shape(second, |other| {
                if one == other || self.apart(one, other) >= least {
                    return;
                }
                let found = distance::between(&placed, &Placed::of(model, kinematics, 0, other), least, &mut scratch);
                least = found.map_or(least, |gap| least.at_most(gap.distance));
            });
        });
        least
    }

    /// A lower bound of the distance of two shapes, m.
    fn apart(&self, one: usize, other: usize) -> f64 {
        let overrides = &self.workspace.kinematics.overrides;
        let radii = [one, other].map(|geom| overrides.bounding_radius(self.model, 0, geom));
        if radii.contains(&0.0) {
            return f64::NEG_INFINITY;
        }
        let [a, b] = [one, other].map(|geom| self.workspace.kinematics.geom_position[geom]);
        (a - b).norm() - radii[0] - radii[1]
    }
}
