//! What rows need that depends on the model alone: the dofs of equalities and tendons, and which elements can have rows.

use super::{impedance::Spring, shortest_time_constant};
use crate::{
    jacobian::last_dof,
    model::{Equality, JointKind, Model},
    tendons::TendonPaths,
};
use core::ops::Range;
use std::collections::BTreeSet;

/// The dofs of one element, ascending.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    /// Where they stand in [`RowPlan::columns`].
    pub range: Range<usize>,
    /// Whether they lie on more than one root path: its rows then couple chains.
    pub cross_couplings: bool,
}

/// An element of the model that can have a row, and how soft it is then.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Soft {
    pub element: usize,
    pub spring: Spring,
}

/// Fixed topology of all rows but those of contacts.
#[derive(Debug, Clone, Default)]
pub(crate) struct RowPlan {
    /// Dofs of each equality; none for couplings of joints, which the solver's pattern always holds.
    pub equalities: Vec<Columns>,
    /// Dofs of each tendon that can have a row.
    pub tendons: Vec<Columns>,
    /// Dofs of all elements.
    pub columns: Vec<usize>,
    /// For each column of an attachment, whether the dof moves its first and its second body: 1 or 0.
    pub moves: Vec<[f64; 2]>,
    /// How soft each equality is.
    pub springs: Vec<Spring>,
    /// Dofs with friction loss.
    pub friction_loss_dofs: Vec<Soft>,
    /// Tendons with friction loss.
    pub rubbing_tendons: Vec<Soft>,
    /// Joints with limits.
    pub limited_joints: Vec<Soft>,
    /// Tendons with limits.
    pub limited_tendons: Vec<Soft>,
    /// Whether the model has rows, beside those of contacts, that are not made in all lanes at once.
    pub some_unshared: bool,
}

impl RowPlan {
    pub fn new(model: &Model) -> Self {
        let (tendons, joints, dofs) = (&model.tendons, &model.joints, &model.dofs);
        let count = tendons.path.len();
        let spring = |softness| Spring::new(softness, shortest_time_constant(model));
        let soft = |element, softness| Soft { element, spring: spring(softness) };
        let rubs = |loss: f64| loss > 0.0;
        let limited = |joint: &usize| joints.range[*joint].is_some() && joints.kind[*joint] != JointKind::Free;
        let rubbing_dofs = (0..model.nv).filter(|&dof| rubs(dofs.friction_loss[dof]));
        let rubbing_tendons = (0..count).filter(|&tendon| rubs(tendons.friction_loss[tendon]));
        let limited_joints = (0..joints.kind.len()).filter(limited);
        let limited_tendons = (0..count).filter(|&tendon| tendons.range[tendon].is_some());
        let mut plan = Self {
            springs: model.equalities.softness.iter().map(spring).collect(),
            friction_loss_dofs: rubbing_dofs.map(|dof| soft(dof, &joints.friction_softness[dofs.joint[dof]])).collect(),
            rubbing_tendons: rubbing_tendons.map(|tendon| soft(tendon, &tendons.friction_softness[tendon])).collect(),
            limited_joints: limited_joints.map(|joint| soft(joint, &joints.limit_softness[joint])).collect(),
            limited_tendons: limited_tendons.map(|tendon| soft(tendon, &tendons.limit_softness[tendon])).collect(),
            ..Self::default()
        };
        plan.some_unshared = !plan.rubbing_tendons.is_empty()
            || !plan.limited_tendons.is_empty()
            || plan.limited_joints.iter().any(|soft| joints.kind[soft.element] == JointKind::Ball)
            || !model.equalities.kind.iter().all(|kind| matches!(kind, Equality::Joint(_)));
        let coupled = model.equalities.kind.iter().any(|kind| matches!(kind, Equality::Tendon(_)));
        // Most models have no rows of tendons and need no paths here.
        let needed = coupled || !plan.rubbing_tendons.is_empty() || !plan.limited_tendons.is_empty();
        let paths = needed.then(|| TendonPaths::<f64>::new(model));
        let movers = |tendon: usize| paths.as_ref().map(|paths| paths.columns(model, tendon)).unwrap_or_default();
        for tendon in 0..count {
            let has_row = rubs(tendons.friction_loss[tendon]) || tendons.range[tendon].is_some();
            let columns = if has_row { movers(tendon) } else { Vec::new() };
            let columns = plan.add(model, columns, |_| [0.0; 2]);
            plan.tendons.push(columns);
        }
        for kind in &model.equalities.kind {
            let columns = match kind {
                Equality::Joint(_) => Columns::default(),
                Equality::Tendon(coupling) => {
                    let both: BTreeSet<usize> =
                        movers(coupling.tendon).into_iter().chain(coupling.leader.into_iter().flat_map(movers)).collect();
                    plan.add(model, both.into_iter().collect(), |_| [0.0; 2])
                }
                Equality::Connect(attachment) | Equality::Weld { attachment, .. } => {
                    let [first, second] = attachment.bodies.map(|body| moving_dofs(model, body));
                    let side = |dofs: &BTreeSet<usize>, dof: usize| f64::from(u8::from(dofs.contains(&dof)));
                    // A dof that moves both bodies still has an arm where the two points are apart.
                    let all = first.union(&second).copied().collect();
                    plan.add(model, all, |dof| [side(&first, dof), side(&second, dof)])
                }
            };
            plan.equalities.push(columns);
        }
        plan
    }

    fn add(&mut self, model: &Model, columns: Vec<usize>, moves: impl Fn(usize) -> [f64; 2]) -> Columns {
        let start = self.columns.len();
        let path: BTreeSet<usize> = path_to_root(model, columns.last().copied()).collect();
        let cross_couplings = columns.iter().any(|dof| !path.contains(dof));
        self.moves.extend(columns.iter().map(|&dof| moves(dof)));
        self.columns.extend(columns);
        Columns { range: start..self.columns.len(), cross_couplings }
    }

    /// The dofs of an element.
    pub fn columns_of(&self, columns: &Columns) -> &[usize] {
        &self.columns[columns.range.clone()]
    }
}

/// All dofs that move `body`.
fn moving_dofs(model: &Model, body: usize) -> BTreeSet<usize> {
    path_to_root(model, last_dof(model, body)).collect()
}

fn path_to_root(model: &Model, last: Option<usize>) -> impl Iterator<Item = usize> {
    core::iter::successors(last, |&dof| model.dofs.parent[dof])
}
