//! What holds the body up: where the ground's force acts, and how far the centre of mass is from the edge of support.

use super::sensors::Snapshot;
use msk_physics::scalar::Real;
use msk_program::scene::Part;
use nalgebra::{Vector2, Vector3};

impl Snapshot<'_> {
    /// Where the body touches the ground, and the vertical force there, N.
    fn footing(&self) -> impl Iterator<Item = (Vector3<f64>, f64)> + Clone + '_ {
        let contacts = self.external_contacts();
        let grounded = contacts.filter(|contact| self.body.holds(self.model, Part::Ground, contact.other));
        grounded.map(|contact| (contact.position, contact.force.z))
    }

    /// Contact points with the ground weighted by their vertical forces, m; without contact the point of the level z = 0 under
    /// the centre of mass.
    pub(super) fn centre_of_pressure(&self) -> Vector3<f64> {
        let mut total = 0.0;
        let mut moment = Vector3::zeros();
        for (position, force) in self.footing() {
            let force = force.at_least(0.0);
            total += force;
            moment += position * force;
        }
        if total > 0.0 {
            return moment / total;
        }
        let centre = self.body.centre_of_mass(self.model, &self.workspace.kinematics);
        Vector3::new(centre.x, centre.y, 0.0)
    }

    /// Distance of the centre of mass, seen from above, to the edge of the hull of all ground contacts, positive within, m;
    /// without contact minus its height.
    pub(super) fn support_margin(&self) -> f64 {
        let centre = self.body.centre_of_mass(self.model, &self.workspace.kinematics);
        let points = self.footing().map(|(position, _)| position.xy());
        margin(points, centre.xy()).unwrap_or(-centre.z)
    }
}

impl Snapshot<'_> {
    /// The same over everything that the body touches and that is no part of it, and the middles of its shapes that are at most `near`
    /// above the ground: a script puts the lowest point of a body on the ground, to the last bit and no other. `None` if there is nothing.
    pub fn resting_margin(&self, near: f64) -> Option<f64> {
        let centre = self.body.centre_of_mass(self.model, &self.workspace.kinematics);
        self.margin_of(centre.xy(), near)
    }

    /// The same for the point at which an inverted pendulum of the body's height and speed would come to rest: its centre of mass,
    /// moved on by velocity · √(height / gravity) (the extrapolated centre of mass of Hof, Gazendam & Sinke, J. Biomech. 38, 2005, and the capture
    /// point of Pratt et al., Humanoids 2006). While it is outside, only a step or a hold can prevent a fall.
    pub fn capture_margin(&self, near: f64) -> Option<f64> {
        let centre = self.body.centre_of_mass(self.model, &self.workspace.kinematics);
        let height = (centre.z - self.ground().height(centre.xy())).at_least(0.0);
        let gravity = -self.model.options.gravity.z;
        let time = if gravity > 0.0 { (height / gravity).sqrt() } else { 0.0 };
        self.margin_of(centre.xy() + self.com_velocity().xy() * time, near)
    }

    fn margin_of(&self, point: Vector2<f64>, near: f64) -> Option<f64> {
        let ground = self.ground();
        let shapes = self.body.shapes.iter().filter(|&&shape| ground.clearance(&[shape]) <= near);
        let middles = shapes.map(|&shape| self.workspace.kinematics.geom_position[shape].xy());
        let touched = self.external_contacts().map(|contact| contact.position.xy());
        let points: Vec<Vector2<f64>> = middles.chain(touched).collect();
        margin(points.iter().copied(), point)
    }
}

/// Signed distance of `point` to the edge of the convex hull of `points`, positive within; `None` without points.
///
/// Every pair of points is looked at, so that no memory is needed: contacts are few.
fn margin(points: impl Iterator<Item = Vector2<f64>> + Clone, point: Vector2<f64>) -> Option<f64> {
    let cross = |a: Vector2<f64>, b: Vector2<f64>| a.x * b.y - a.y * b.x;
    let mut inside = f64::INFINITY;
    let mut nearest: Option<f64> = None;
    for first in points.clone() {
        for second in points.clone() {
            let along = second - first;
            let length = along.norm();
            let share = if length > 0.0 { ((point - first).dot(&along) / (length * length)).clip(0.0, 1.0) } else { 0.0 };
            let distance = (point - first - along * share).norm();
            nearest = Some(nearest.map_or(distance, |nearest| nearest.at_most(distance)));
            // An edge of the hull has all other points on its left, some of them not on it.
            let mut sides = points.clone().map(|other| cross(along, other - first));
            let beyond = 1e-12 * length;
            if length > 0.0 && sides.clone().all(|side| side >= -beyond) && sides.any(|side| side > beyond) {
                inside = inside.at_most(cross(along, point - first) / length);
            }
        }
    }
    let nearest = nearest?;
    Some(if inside.is_finite() && inside >= 0.0 { inside } else { -nearest })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(points: &[[f64; 2]], point: [f64; 2]) -> Option<f64> {
        margin(points.iter().map(|&point| Vector2::from(point)), Vector2::from(point))
    }

    #[test]
    fn within_a_square_the_nearest_edge_counts_and_points_within_do_not() {
        let square = [[0.0, 0.0], [0.4, 0.1], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 1.0]];
        for (point, expected) in
            [([0.5, 0.5], 0.5), ([0.5, 0.2], 0.2), ([0.5, -0.3], -0.3), ([4.0, 5.0], -5.0), ([1.0, 0.5], 0.0)]
        {
            let found = of(&square, point).unwrap();
            assert!((found - expected).abs() < 1e-12, "{point:?}: {found}");
        }
    }

    #[test]
    fn a_line_or_a_point_holds_nothing_up_but_itself() {
        assert_eq!(of(&[[0.0, 0.0], [1.0, 0.0]], [0.5, 0.25]), Some(-0.25));
        assert_eq!(of(&[[0.0, 0.0], [1.0, 0.0]], [0.5, 0.0]), Some(-0.0));
        assert_eq!(of(&[[0.0, 0.0]], [3.0, 4.0]), Some(-5.0));
        assert_eq!(of(&[], [0.0, 0.0]), None);
    }
}
