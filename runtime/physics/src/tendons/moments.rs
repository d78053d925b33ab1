//! The tendon Jacobian laid out once per model, for those who want many of its rows at every control step.
//!
//! [`each_moment_arm`](super::each_moment_arm) climbs the tree for each line of action; here the dofs on its way are kept, and in a
//! row every dof comes up once. All is inlined over [`Real`], so that it may be asked for in the lanes of eight episodes.

use super::{TendonPaths, each_mover};
use crate::{kinematics::Kinematics, model::Model, scalar::Real, spatial::pair};
use core::ops::Range;

/// Which dofs can change the length of each tendon, and along which of its lines of action.
#[derive(Debug, Clone)]
pub struct MomentPlan {
    /// Entries of each tendon's row.
    tendon: Vec<Range<usize>>,
    entries: Vec<Entry>,
    /// Lines of action that an entry adds up, with their weights.
    lines: Vec<(usize, f64)>,
}

/// One number of the Jacobian.
#[derive(Debug, Clone)]
struct Entry {
    dof: usize,
    lines: Range<usize>,
    /// What a fixed tendon has there, m/rad or m/m.
    coefficients: f64,
}

impl MomentPlan {
    /// That of the tendons of `model`, whose `paths` these are.
    pub fn new<T: Real>(model: &Model, paths: &TendonPaths<T>) -> Self {
        let plan = &paths.plan;
        let mut layout = Self { tendon: Vec::new(), entries: Vec::new(), lines: Vec::new() };
        for (tendon, own_lines) in plan.tendon_lines.iter().enumerate() {
            let mut movers = Vec::new();
            for line in own_lines.clone() {
                each_mover(model, &plan.lines[line], |dof, weight| movers.push((dof, line, weight)));
            }
            let terms = &plan.joint_terms[plan.tendon_joints[tendon].clone()];
            let first = layout.entries.len();
            for dof in paths.columns(model, tendon) {
                let start = layout.lines.len();
                let moved = movers.iter().filter(|(mover, ..)| *mover == dof);
                layout.lines.extend(moved.map(|&(_, line, weight)| (line, weight)));
                let coefficients = terms.iter().filter(|term| term.dof == dof).map(|term| term.coefficient).sum();
                layout.entries.push(Entry { dof, lines: start..layout.lines.len(), coefficients });
            }
            layout.tendon.push(first..layout.entries.len());
        }
        layout
    }

    /// The dofs that can change the length of `tendon`, ascending.
    pub fn dofs(&self, tendon: usize) -> impl Iterator<Item = usize> + '_ {
        self.entries[self.tendon[tendon].clone()].iter().map(|entry| entry.dof)
    }

    /// How the length of `tendon` changes with each of these [dofs](Self::dofs), m or m/rad, as
    /// [`moment_arms`](super::moment_arms) gives it.
    #[inline(always)]
    pub fn row<'a, T: Real>(
        &'a self,
        kinematics: &'a Kinematics<T>,
        paths: &'a TendonPaths<T>,
        tendon: usize,
    ) -> impl Iterator<Item = (usize, T)> + 'a {
        self.entries[self.tendon[tendon].clone()].iter().map(
            #[inline(always)]
            |entry| {
                let axis = &kinematics.dof_axis[entry.dof];
                let mut sum = T::splat(0.0);
                for &(line, weight) in &self.lines[entry.lines.clone()] {
                    T::apart();
                    sum += pair(axis, &paths.line[line]) * T::splat(weight);
                }
                (entry.dof, sum + T::splat(entry.coefficients))
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
    fn rows_are_those_of_the_tendon_jacobian() {
        let model = Model::from_mjcf(MODEL).unwrap();
        let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
        state.position[7..].copy_from_slice(&[0.3, -0.2, 0.4, 0.7]);
        smooth(&model, &state, &mut workspace);
        let plan = MomentPlan::new(&model, &workspace.tendons);
        for (tendon, moved) in [4, 2].into_iter().enumerate() {
            let mut expected = vec![0.0; model.nv];
            moment_arms(&model, &workspace.kinematics, &workspace.tendons, tendon, &mut expected);
            assert_eq!(plan.dofs(tendon).count(), moved);
            let mut found = vec![0.0; model.nv];
            plan.row(&workspace.kinematics, &workspace.tendons, tendon).for_each(|(dof, arm)| found[dof] = arm);
            assert_eq!(found, expected, "tendon {tendon}");
        }
    }
}
