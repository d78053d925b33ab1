//! The problems of up to eight episodes side by side, in the lanes of one number.
//!
//! Their muscles cross the same coordinates. The points of the feet that bear weight differ, so every point that bears in any lane gets
//! columns; where it does not bear they are zero, without room between their bounds, and not counted. Such columns change no sum, so a lane
//! comes to the bits that it comes to alone.

use super::{Allocation, Columns, Effort, Memory, Problem, Unknown};
use msk_physics::lanes::Lanes;
use msk_physics::scalar::Real;

/// Several columns that come and go as one: the forces at a point that may or may not bear weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cmc) struct Slot {
    /// Which of all that there could be; they stand in this order.
    pub key: usize,
    /// Its first column.
    pub first: usize,
    /// Number of its columns.
    pub columns: usize,
}

/// One lane's problem.
pub(in crate::cmc) struct Member<'a> {
    pub lane: usize,
    pub problem: Problem<'a, f64>,
    /// The columns after those that all lanes have, keys ascending.
    pub slots: &'a [Slot],
    pub memory: &'a mut Memory,
    /// The unknowns that all lanes have, to be filled.
    pub out: &'a mut [f64],
}

/// Memory for the problems of all lanes.
#[derive(Debug, Clone)]
pub(in crate::cmc) struct Together {
    inertia: Vec<Lanes>,
    columns: Columns<Lanes>,
    unknowns: Vec<Unknown<Lanes>>,
    wanted: Vec<Lanes>,
    /// The slots of all lanes.
    slots: Vec<Slot>,
    allocation: Allocation<Lanes>,
}

impl Together {
    /// Memory for systems of `rows` rows.
    pub fn new(rows: usize) -> Self {
        Self {
            inertia: Vec::new(),
            columns: Columns::default(),
            unknowns: Vec::new(),
            wanted: vec![Lanes::splat(0.0); rows],
            slots: Vec::new(),
            allocation: Allocation::new(rows),
        }
    }

    /// Shares out the problems of up to eight members in different lanes, all on one pattern and with the same muscles.
    pub fn solve(&mut self, effort: Effort, members: &mut [Member<'_>]) {
        let Some(first) = members.first() else { return };
        let pattern = first.problem.pattern;
        self.lay_out(first.out.len(), members);
        let mut count = Lanes::splat(0.0);
        for member in members.iter() {
            self.take_in(member);
            count.set_lane(member.lane, member.problem.count);
            self.allocation.recall(member.lane, member.memory);
        }
        let Self { inertia, columns, unknowns, wanted, allocation, .. } = self;
        allocation.search(&Problem { pattern, inertia, columns, unknowns, wanted, count }, effort);
        for member in members {
            allocation.remember(member.lane, member.memory);
            for (out, x) in member.out.iter_mut().zip(&allocation.x) {
                *out = x.lane(member.lane);
            }
        }
    }

    /// Makes room for the `common` columns of all lanes and for the slots of each, all zero: lanes without a member have nothing to
    /// share out.
    fn lay_out(&mut self, common: usize, members: &[Member<'_>]) {
        self.slots.clear();
        self.slots.extend(members.iter().flat_map(|member| member.slots));
        self.slots.sort_unstable_by_key(|slot| slot.key);
        self.slots.dedup_by_key(|slot| slot.key);
        let zero = Lanes::splat(0.0);
        let Some(first) = members.first() else { return };
        if self.columns.count() < common {
            self.columns.truncate(0);
            (0..common).for_each(|column| self.columns.push_zeros(first.problem.columns, column));
        }
        self.columns.truncate(common);
        for slot in &mut self.slots {
            let has = |member: &&Member<'_>| member.slots.iter().any(|own| own.key == slot.key);
            let Some(member) = members.iter().find(has) else { continue };
            let Some(own) = member.slots.iter().find(|own| own.key == slot.key) else { continue };
            slot.first = self.columns.count();
            (own.first..own.first + own.columns).for_each(|column| self.columns.push_zeros(member.problem.columns, column));
        }
        self.unknowns.clear();
        self.unknowns.resize(self.columns.count(), Unknown { low: zero, high: zero, cost: Lanes::splat(1.0) });
        self.inertia.resize(first.problem.inertia.len(), zero);
        self.wanted.fill(zero);
        self.allocation.forget();
    }

    /// Copies a member's problem into its lane.
    fn take_in(&mut self, member: &Member<'_>) {
        let Member { lane, problem, slots, out, .. } = member;
        let copy = |to: &mut Lanes, from: &f64| to.set_lane(*lane, *from);
        self.inertia.iter_mut().zip(problem.inertia).for_each(|(to, from)| copy(to, from));
        self.wanted.iter_mut().zip(problem.wanted).for_each(|(to, from)| copy(to, from));
        let own = |slot: &Slot| slots.iter().find(|own| own.key == slot.key).map(|own| (slot.first, own.first, own.columns));
        for (first, from, count) in core::iter::once((0, 0, out.len())).chain(self.slots.iter().filter_map(own)) {
            self.columns.copy_lane(*lane, first, (problem.columns, from), count);
            for (to, from) in self.unknowns[first..first + count].iter_mut().zip(&problem.unknowns[from..from + count]) {
                copy(&mut to.low, &from.low);
                copy(&mut to.high, &from.high);
                copy(&mut to.cost, &from.cost);
            }
        }
    }
}
