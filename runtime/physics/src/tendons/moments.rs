//! The tendon Jacobian in independent coordinates, laid out once per model, for those who want many of its rows at every control step.
//!
//! [`each_moment_arm`](super::each_moment_arm) climbs the tree for each line of action. Here the dofs on its way are kept, and those that move
//! with one coordinate are taken together: the vertebrae bend with three coordinates, and a muscle that spans ten of them asks for three
//! moments, not for thirty. All is inlined over [`Real`], so that it may be asked for in the lanes of eight episodes.

use super::{TendonPaths, each_mover};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::scalar::Real;
use crate::spatial::{self, Spatial, pair};
use core::ops::Range;

/// Which coordinates can change the length of each tendon, and along which of its lines of action.
#[derive(Debug, Clone)]
pub struct MomentPlan {
    /// Entries of each tendon's row.
    tendon: Vec<Range<usize>>,
    entries: Vec<Entry>,
    pulls: Vec<Pull>,
    /// Of fixed tendons: dofs, and m/rad or m/m of each.
    coefficients: Vec<(usize, f64)>,
    /// Dofs that move with one coordinate, and lie between the same two bodies.
    screws: Vec<Vec<usize>>,
}

/// One number of the Jacobian.
#[derive(Debug, Clone)]
struct Entry {
    coordinate: usize,
    pulls: Range<usize>,
    coefficients: Range<usize>,
}

/// A line of action along which a screw changes the length of a tendon, and its weight.
#[derive(Debug, Clone, Copy)]
struct Pull {
    line: usize,
    screw: usize,
    weight: f64,
}

impl MomentPlan {
    /// That of the tendons of `model`, whose `paths` these are; `coordinate` gives what moves a dof, or nothing for one that is held still.
    pub fn new<T: Real>(model: &Model, paths: &TendonPaths<T>, coordinate: impl Fn(usize) -> Option<usize>) -> Self {
        let plan = &paths.plan;
        let empty =
            Self { tendon: Vec::new(), entries: Vec::new(), pulls: Vec::new(), coefficients: Vec::new(), screws: Vec::new() };
        let mut layout = empty;
        for (tendon, own_lines) in plan.tendon_lines.iter().enumerate() {
            let terms = &plan.joint_terms[plan.tendon_joints[tendon].clone()];
            let mut movers = Vec::new();
            for line in own_lines.clone() {
                each_mover(model, &plan.lines[line], |dof, weight| movers.push((coordinate(dof), line, weight, dof)));
            }
            let moving = paths.columns(model, tendon);
            let mut coordinates: Vec<usize> = moving.into_iter().filter_map(&coordinate).collect();
            coordinates.sort_unstable();
            coordinates.dedup();
            let first = layout.entries.len();
            for own in coordinates {
                let [pulls, coefficients] = [layout.pulls.len(), layout.coefficients.len()];
                let of_own: Vec<_> = movers.iter().filter(|(mover, ..)| *mover == Some(own)).collect();
                // Those of one line and one weight follow the way along one branch.
                for group in of_own.chunk_by(|a, b| (a.1, a.2.to_bits()) == (b.1, b.2.to_bits())) {
                    let &(_, line, weight, _) = group[0];
                    let screw = layout.screw(group.iter().map(|(.., dof)| *dof).collect());
                    layout.pulls.push(Pull { line, screw, weight });
                }
                let fixed = terms.iter().filter(|term| coordinate(term.dof) == Some(own));
                layout.coefficients.extend(fixed.map(|term| (term.dof, term.coefficient)));
                layout.entries.push(Entry {
                    coordinate: own,
                    pulls: pulls..layout.pulls.len(),
                    coefficients: coefficients..layout.coefficients.len(),
                });
            }
            layout.tendon.push(first..layout.entries.len());
        }
        layout
    }

    /// The place of what these dofs do together, which many tendons share.
    fn screw(&mut self, dofs: Vec<usize>) -> usize {
        self.screws.iter().position(|screw| *screw == dofs).unwrap_or_else(|| {
            self.screws.push(dofs);
            self.screws.len() - 1
        })
    }

    /// The coordinates that can change the length of `tendon`, ascending.
    pub fn coordinates(&self, tendon: usize) -> impl Iterator<Item = usize> + '_ {
        self.entries[self.tendon[tendon].clone()].iter().map(|entry| entry.coordinate)
    }

    /// Fills the `screws` of a state, in which each dof moves so much (`slopes`) per unit of its coordinate.
    #[inline(always)]
    pub fn update<T: Real>(&self, kinematics: &Kinematics<T>, slopes: &[T], screws: &mut Vec<Spatial<T>>) {
        screws.clear();
        screws.extend(self.screws.iter().map(
            #[inline(always)]
            |dofs| {
                let mut sum = spatial::spatial_zero();
                for &dof in dofs {
                    T::apart();
                    spatial::add_scaled(&mut sum, &kinematics.dof_axis[dof], slopes[dof]);
                }
                sum
            },
        ));
    }

    /// How the length of `tendon` changes with each of its [coordinates](Self::coordinates), m or m/rad, at the state of `paths` and `screws`.
    #[inline(always)]
    pub fn row<'a, T: Real>(
        &'a self,
        paths: &'a TendonPaths<T>,
        (screws, slopes): (&'a [Spatial<T>], &'a [T]),
        tendon: usize,
    ) -> impl Iterator<Item = T> + 'a {
        self.entries[self.tendon[tendon].clone()].iter().map(
            #[inline(always)]
            move |entry| {
                let mut sum = T::splat(0.0);
                for &Pull { line, screw, weight } in &self.pulls[entry.pulls.clone()] {
                    T::apart();
                    sum += pair(&screws[screw], &paths.line[line]) * T::splat(weight);
                }
                for &(dof, coefficient) in &self.coefficients[entry.coefficients.clone()] {
                    sum += slopes[dof] * T::splat(coefficient);
                }
                sum
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{State, Workspace, smooth, tendons::moment_arms};

    /// A path with a wrap and a pulley between two limbs, and a fixed tendon.
    const MODEL: &str = r#"<mujoco><worldbody>
        <body pos="0 0 1"><freejoint/><geom size="0.1"/><site name="a" pos="0 0 0.1"/>
          <body pos="0.3 0 0"><joint name="x" axis="0 1 0"/><geom name="g" size="0.05"/><site name="b" pos="0.2 0 0.02"/>
            <body pos="0.3 0 0"><joint name="y" axis="0 1 0"/><joint name="z" axis="0 0 1"/><geom size="0.05"/>
              <site name="c" pos="0.1 0.1 0"/></body></body>
          <body pos="-0.3 0 0"><joint name="w" axis="1 0 0"/><geom size="0.05"/><site name="d" pos="0 0.1 0"/></body>
        </body></worldbody>
        <tendon>
          <spatial><site site="a"/><geom geom="g"/><site site="b"/><pulley divisor="2"/><site site="c"/><site site="d"/></spatial>
          <fixed><joint joint="x" coef="0.5"/><joint joint="w" coef="-2"/></fixed>
        </tendon></mujoco>"#;

    #[test]
    fn rows_are_those_of_the_tendon_jacobian_along_each_coordinate() {
        let model = Model::from_mjcf(MODEL).unwrap();
        let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
        state.position[7..].copy_from_slice(&[0.3, -0.2, 0.4, 0.7]);
        smooth(&model, &state, &mut workspace);
        // Both angles of the last body move with the one before; the other limb is held still.
        let (y, z, w) = (7, 8, 9);
        let coordinate = |dof: usize| if dof == w { None } else { Some(if dof == z { y } else { dof }) };
        let mut slopes = vec![1.0; model.nv];
        slopes[z] = -0.5;
        let plan = MomentPlan::new(&model, &workspace.tendons, coordinate);
        let mut screws = Vec::new();
        plan.update(&workspace.kinematics, &slopes, &mut screws);
        for (tendon, moved) in [2, 1].into_iter().enumerate() {
            let mut jacobian = vec![0.0; model.nv];
            moment_arms(&model, &workspace.kinematics, &workspace.tendons, tendon, &mut jacobian);
            let mut expected = vec![0.0; model.nv];
            for dof in 0..model.nv {
                if let Some(coordinate) = coordinate(dof) {
                    expected[coordinate] += slopes[dof] * jacobian[dof];
                }
            }
            assert_eq!(plan.coordinates(tendon).count(), moved);
            let row = plan.row(&workspace.tendons, (&screws, &slopes), tendon);
            let found: Vec<(usize, f64)> = plan.coordinates(tendon).zip(row).collect();
            for (dof, expected) in expected.into_iter().enumerate() {
                let found = found.iter().find(|(coordinate, _)| *coordinate == dof).map_or(0.0, |(_, moment)| *moment);
                assert!((found - expected).abs() < 1e-12, "tendon {tendon}, dof {dof}: {found} and not {expected}");
            }
        }
    }
}
