//! Which constraints act on each other: islands of trees that constraints connect.

use crate::{constraint::jacobian::Jacobian, model::Model};

/// The island of every block.
#[derive(Debug, Clone, Default)]
pub(super) struct Islands {
    /// Of each dof: a dof nearer to the one that stands for its island, which is its own.
    leader: Vec<usize>,
    /// Of each block, in the order of the first block of each.
    island: Vec<usize>,
    leaders: Vec<usize>,
}

impl Islands {
    pub fn find(&mut self, model: &Model, jacobian: &Jacobian) {
        self.leader.clear();
        for (dof, parent) in model.dofs.parent.iter().enumerate() {
            // A parent comes before its children.
            self.leader.push(parent.map_or(dof, |parent| self.leader[parent]));
        }
        for block in &jacobian.blocks {
            if let [first, rest @ ..] = jacobian.columns_of(block) {
                for dof in rest {
                    let [a, b] = [*first, *dof].map(|dof| self.leader_of(dof));
                    self.leader[a.max(b)] = a.min(b);
                }
            }
        }
        self.island.clear();
        self.leaders.clear();
        for block in &jacobian.blocks {
            // What moves no dof has no one to share an island with.
            let leader = jacobian.columns_of(block).first().map_or(model.nv, |dof| self.leader_of(*dof));
            let known = self.leaders.iter().position(|known| *known == leader);
            self.island.push(known.unwrap_or(self.leaders.len()));
            if known.is_none() {
                self.leaders.push(leader);
            }
        }
    }

    pub fn count(&self) -> usize {
        self.leaders.len()
    }

    pub fn of(&self, block: usize) -> usize {
        self.island[block]
    }

    fn leader_of(&self, mut dof: usize) -> usize {
        while self.leader[dof] != dof {
            dof = self.leader[dof];
        }
        dof
    }
}
