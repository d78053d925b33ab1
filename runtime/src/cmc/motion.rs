//! How points move with the independent coordinates.

use super::coordinates::{Coordinates, Slopes};
use msk_physics::kinematics::Kinematics;
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::spatial::{cross, scale, zero};
use msk_physics::{Workspace, moving_dofs};
use nalgebra::Vector3;

/// Which coordinates move something, and through which dofs: laid out once per model.
#[derive(Debug, Clone)]
pub(super) struct Moved {
    /// Ascending.
    pub coordinates: Vec<usize>,
    /// A dof, and the place of its coordinate among these: coupled dofs move with one coordinate.
    dofs: Vec<(usize, usize)>,
}

impl Moved {
    /// By `dofs`, ascending.
    fn new(coordinates: &Coordinates, dofs: impl Iterator<Item = usize>) -> Self {
        let moved: Vec<(usize, usize)> = dofs.filter_map(|dof| Some((dof, coordinates.of(dof)?))).collect();
        let mut own: Vec<usize> = moved.iter().map(|(_, coordinate)| *coordinate).collect();
        own.sort_unstable();
        own.dedup();
        // Each is among them.
        let place = |coordinate: usize| own.partition_point(|other| *other < coordinate);
        Self { dofs: moved.into_iter().map(|(dof, coordinate)| (dof, place(coordinate))).collect(), coordinates: own }
    }

    /// What moves a body.
    pub fn body(model: &Model, coordinates: &Coordinates, body: usize) -> Self {
        Self::new(coordinates, moving_dofs(model, body).iter().copied())
    }

    /// What moves the common centre of mass of `body` and all that hangs on it.
    pub fn subtree(model: &Model, coordinates: &Coordinates, body: usize) -> Self {
        let above = moving_dofs(model, body);
        let moves = |dof: &usize| above.contains(dof) || is_below(model, model.dofs.body[*dof], body);
        Self::new(coordinates, (0..model.nv).filter(moves))
    }

    /// Writes the velocity per unit velocity of each coordinate, from that per unit of each dof.
    #[inline(always)]
    fn fill<T: Real>(&self, slopes: &Slopes<T>, of_dof: impl Fn(usize) -> Vector3<T>, out: &mut Vec<Vector3<T>>) {
        out.clear();
        out.resize(self.coordinates.len(), zero());
        for &(dof, place) in &self.dofs {
            T::apart();
            out[place] += scale(&of_dof(dof), slopes.of(dof));
        }
    }

    /// Writes how the point of a body that is now at `point` (world, m) moves: m/s in world axes per unit velocity of each coordinate.
    #[inline(always)]
    pub fn point<T: Real>(
        &self,
        (model, kinematics, slopes): (&Model, &Kinematics<T>, &Slopes<T>),
        (body, point): (usize, &Vector3<T>),
        out: &mut Vec<Vector3<T>>,
    ) {
        let arm = point - kinematics.reference(model, body);
        self.fill(
            slopes,
            #[inline(always)]
            |dof| carried(kinematics, dof, &arm),
            out,
        );
    }

    /// The same of the common centre of mass of `body` and all that hangs on it.
    #[inline(always)]
    pub fn centre<T: Real>(
        &self,
        (model, workspace, slopes): (&Model, &Workspace<T>, &Slopes<T>),
        body: usize,
        out: &mut Vec<Vector3<T>>,
    ) {
        let (kinematics, inertia) = (&workspace.kinematics, &workspace.inertia);
        let arm = kinematics.subtree_com[body] - kinematics.reference(model, body);
        let share = T::splat(1.0) / kinematics.subtree_mass[body].at_least(T::splat(f64::MIN_POSITIVE));
        self.fill(
            slopes,
            #[inline(always)]
            |dof| {
                let moved = model.dofs.body[dof];
                // Dofs of the body and above carry its centre of mass like a point of the body; those below move a part of its mass.
                if moved <= body {
                    carried(kinematics, dof, &arm)
                } else {
                    scale(&inertia.composite[moved].momentum(&kinematics.dof_axis[dof])[1], share)
                }
            },
            out,
        );
    }
}

/// The velocity that a dof gives to what it carries, at `arm` from the reference of its tree.
#[inline(always)]
fn carried<T: Real>(kinematics: &Kinematics<T>, dof: usize, arm: &Vector3<T>) -> Vector3<T> {
    let [angular, linear] = &kinematics.dof_axis[dof];
    linear + cross(angular, arm)
}

/// Whether a body is another one, or hangs on it.
pub(super) fn is_below(model: &Model, mut body: usize, ancestor: usize) -> bool {
    // Parents come before their children.
    while body > ancestor {
        body = model.bodies.parent[body];
    }
    body == ancestor
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_physics::{State, center_of_mass_jacobian, point_jacobian, smooth};

    /// A trunk with two arms, one of two links whose second follows the first.
    const TREE: &str = r#"<mujoco><worldbody>
        <body pos="0 0 1"><freejoint/><geom size="0.1"/>
          <body pos="0.2 0 0"><joint name="a" axis="0 1 0"/><geom size="0.1" pos="0.1 0 0"/>
            <body pos="0.3 0 0"><joint name="b" axis="0 1 0"/><geom size="0.1" pos="0 0.1 0"/></body></body>
          <body pos="-0.2 0 0"><joint name="c" axis="1 0 0"/><geom size="0.1" pos="0 0 0.1"/></body>
        </body></worldbody>
        <equality><joint joint1="b" joint2="a" polycoef="0 0.5 0.25 0 0"/></equality></mujoco>"#;

    #[test]
    fn motions_are_the_projected_jacobians() {
        let model = Model::from_mjcf(TREE).unwrap();
        let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
        for (index, value) in state.position[7..].iter_mut().enumerate() {
            *value = 0.3 + 0.2 * index as f64;
        }
        smooth(&model, &state, &mut workspace);
        let coordinates = Coordinates::new(&model);
        let mut slopes = Slopes::new(&coordinates);
        slopes.update(&coordinates, &model, &state);
        let zeros = || vec![Vector3::zeros(); model.nv];
        let (mut jacobian, mut rotation, mut found) = (zeros(), zeros(), Vec::new());
        let expected = |jacobian: &[Vector3<f64>], moved: &Moved| -> Vec<Vector3<f64>> {
            let of = |coordinate: &usize| {
                let dofs = (0..model.nv).filter(|&dof| coordinates.of(dof) == Some(*coordinate));
                dofs.map(|dof| slopes.of(dof) * jacobian[dof]).sum()
            };
            moved.coordinates.iter().map(of).collect()
        };
        let near = |found: &[Vector3<f64>], expected: &[Vector3<f64>]| {
            assert_eq!(found.len(), expected.len());
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).norm() < 1e-12), "{found:?} is not {expected:?}");
        };

        let (body, point) = (3, Vector3::new(0.4, 0.1, 0.9));
        let moved = Moved::body(&model, &coordinates, body);
        assert_eq!(moved.coordinates, [0, 1, 2, 3, 4, 5, 6]);
        moved.point((&model, &workspace.kinematics, &slopes), (body, &point), &mut found);
        point_jacobian(&model, &workspace.kinematics, body, &point, &mut jacobian, &mut rotation);
        near(&found, &expected(&jacobian, &moved));

        let moved = Moved::subtree(&model, &coordinates, 1);
        assert_eq!(moved.coordinates, [0, 1, 2, 3, 4, 5, 6, 7]);
        moved.centre((&model, &workspace, &slopes), 1, &mut found);
        center_of_mass_jacobian(&model, &workspace.kinematics, &workspace.inertia, 1, &mut jacobian);
        near(&found, &expected(&jacobian, &moved));
    }
}
