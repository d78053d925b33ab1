//! Ground that is not level: where a foot may land on it, and how high it has to go over it.

use super::step::{Placed, Way};
use crate::cmc::{Present, turning};
use crate::scene::ground::Ground;
use msk_physics::scalar::Real;
use nalgebra::{Vector2, Vector3};

/// The way of a foot that points there from where it has left the ground to about a place on it, lifted by so much (m), or more where it has to be.
pub(super) fn way(present: &Present<'_>, from: Placed, (place, heading): (Vector3<f64>, f64), lift: f64) -> Way {
    let level = Way { from, to: place, heading, normal: Vector3::z(), lift };
    let Some(terrain) = Terrain::under(present) else { return level };
    let to = terrain.foothold(place, heading);
    let way = Way { to, normal: terrain.0.normal(to.xy()), ..level };
    Way { lift: lift + terrain.lift(&way), ..way }
}

/// Ground that is not level.
#[derive(Clone, Copy)]
struct Terrain<'a>(Ground<'a>);

/// Where a sole has its heel, what has to bear, and its toes, ahead of the middle of its points, m.
const SOLE: [f64; 4] = [-0.1, -0.04, 0.06, 0.18];
/// Ground under a sole may rise by this share of the way along it, and by so much besides, m.
const SLOPE: f64 = 0.12;
const EVEN: f64 = 0.005;
/// Shifts of a landing that are tried, m, in this order: a foot that lands short lets the body go on, one that lands far ahead stops it.
const SHIFTS: [f64; 14] = [0.0, -0.03, -0.06, 0.03, -0.09, -0.12, 0.06, -0.16, -0.2, 0.09, -0.24, 0.12, 0.16, 0.2];
/// What is this much higher or lower than the other foot is no place to land, m.
const CLIMB: f64 = 0.35;
/// How far over the ground a foot goes in the middle of its way, m, and how much higher than on level ground at most.
const CLEAR: f64 = 0.03;
const MOST_LIFT: f64 = 0.3;
/// Moments of a way at which that is looked at.
const MOMENTS: u32 = 10;

impl<'a> Terrain<'a> {
    /// That under a body; `None` where it is level.
    fn under(present: &Present<'a>) -> Option<Self> {
        let &Present { body, model, workspace, .. } = present;
        let ground = Ground { model, kinematics: &workspace.kinematics, shapes: &body.ground };
        (body.ground != body.level).then_some(Self(ground))
    }

    /// Heights under the places of a sole.
    fn heights(&self, middle: Vector2<f64>, heading: f64) -> [f64; 4] {
        SOLE.map(|along| self.0.height(middle + turning::level(Vector2::new(along, 0.0), heading)))
    }

    /// The place near another where a sole finds ground that is not much higher or lower: even where it bears, and nowhere above that; the
    /// other one itself if there is none.
    fn foothold(&self, place: Vector3<f64>, heading: f64) -> Vector3<f64> {
        let mut shifted = SHIFTS.iter().map(|&shift| place.xy() + turning::level(Vector2::new(shift, 0.0), heading));
        let found = shifted.find_map(|shifted| {
            let (under, heights) = (self.0.height(shifted), self.heights(shifted, heading));
            let rises = |part: usize| heights[part] - under;
            let even = [1, 2].into_iter().all(|part| rises(part).abs() < SLOPE * SOLE[part].abs() + EVEN);
            let free = [0, 3].into_iter().all(|part| rises(part) < SLOPE * SOLE[part].abs() + EVEN);
            (even && free && (under - place.z).abs() < CLIMB).then(|| shifted.push(under))
        });
        found.unwrap_or(place)
    }

    /// By how much more a foot has to be lifted on its way, m. Its sole is tilted as the ground is where it lands.
    fn lift(&self, way: &Way) -> f64 {
        let tilt = SOLE.map(|along| {
            let part = turning::level(Vector2::new(along, 0.0), way.heading);
            -part.dot(&way.normal.xy()) / way.normal.z.at_least(0.5)
        });
        let missing = (1..MOMENTS).map(|moment| {
            let share = f64::from(moment) / f64::from(MOMENTS);
            let (place, gain) = (way.at(share), way.gain(share));
            let heights = self.heights(place.xy(), way.heading);
            let highest = heights.iter().zip(tilt).map(|(height, tilt)| height - tilt).fold(f64::NEG_INFINITY, f64::at_least);
            (highest + CLEAR * gain - place.z) / gain.at_least(0.1)
        });
        missing.fold(0.0, f64::at_least).at_most(MOST_LIFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_physics::model::Model;
    use msk_physics::{State, Workspace, kinematics};

    /// A step of 15 cm at x = 1 m, and a slope of 10 % that ends at x = -1 m.
    const GROUND: &str = r#"<mujoco><worldbody>
        <geom type="plane" size="0 0 1"/>
        <geom type="box" size="0.5 1 0.075" pos="1.5 0 0.075"/>
        <geom type="box" size="2 1 0.5" pos="-3 0 -0.5" euler="0 -5.7106 0"/>
        </worldbody></mujoco>"#;

    fn on<T>(look: impl FnOnce(Terrain<'_>) -> T) -> T {
        let model = Model::from_mjcf(GROUND).unwrap();
        let (state, mut workspace) = (State::new(&model), Workspace::new(&model));
        kinematics::update(&model, &state, &mut workspace.kinematics);
        look(Terrain(Ground { model: &model, kinematics: &workspace.kinematics, shapes: &[0, 1, 2] }))
    }

    fn foothold(x: f64) -> Vector3<f64> {
        on(|terrain| terrain.foothold(Vector3::new(x, 0.0, 0.0), 0.0))
    }

    #[test]
    fn a_foot_lands_where_it_was_to_land_if_its_sole_bears_there() {
        assert_eq!(foothold(0.5), Vector3::new(0.5, 0.0, 0.0));
        assert!((foothold(1.3) - Vector3::new(1.3, 0.0, 0.15)).norm() < 1e-12);
        // The heel may hang over an edge.
        assert!((foothold(1.05) - Vector3::new(1.05, 0.0, 0.15)).norm() < 1e-12);
    }

    #[test]
    fn a_foot_whose_toes_would_be_in_a_step_lands_short_of_it() {
        let found = foothold(0.9);
        assert_eq!(found.z, 0.0);
        assert!(found.x + SOLE[3] <= 1.0 && found.x > 0.75, "{found:?}");
    }

    #[test]
    fn a_foot_is_lifted_over_an_edge_and_no_further_on_even_ground() {
        let lift = |from: f64, to: f64| {
            on(|terrain| {
                let from = Placed {
                    middle: Vector3::new(from, 0.0, terrain.0.height(Vector2::new(from, 0.0))),
                    heading: 0.0,
                    height: 0.0,
                };
                let to = Vector2::new(to, 0.0);
                let (normal, to) = (terrain.0.normal(to), to.push(terrain.0.height(to)));
                terrain.lift(&Way { from, to, heading: 0.0, normal, lift: 0.038 })
            })
        };
        assert_eq!(lift(0.0, 0.6), 0.0);
        assert!(lift(-2.5, -2.0) < 0.01, "{} m up a slope", lift(-2.5, -2.0));
        assert!((0.02..MOST_LIFT).contains(&lift(0.7, 1.2)), "{} m up a step", lift(0.7, 1.2));
    }
}
