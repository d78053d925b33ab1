//! Controllers of several episodes that share their forces out together, in lanes.

use super::allocation::{Effort, Member, Together};
use super::{ControlScratch, Tracker};

/// A controller that has asked for forces.
pub(crate) struct Asking<'a> {
    /// Where in the lanes it takes part.
    pub lane: usize,
    pub tracker: &'a mut Tracker,
    /// With what it has asked for; all of one model and body.
    pub scratch: &'a mut ControlScratch,
}

/// The memory of a worker for controllers of one model.
#[derive(Debug, Clone, Default)]
pub(crate) struct AllocationGroup {
    together: Option<Box<Together>>,
}

/// Fewer than these take less time one by one.
const LEAST: usize = 3;

impl AllocationGroup {
    /// Shares out the forces of all that ask, each to the bits that it comes to alone.
    pub fn allocate<'a>(&mut self, asking: impl Iterator<Item = Asking<'a>>) {
        let mut asking: Vec<Asking<'a>> = asking.collect();
        for effort in [Effort::EXACT, Effort::ROUGH] {
            let mut members: Vec<Member<'_>> = asking.iter_mut().filter_map(|asking| asking.member(effort)).collect();
            if members.len() >= LEAST {
                let rows = members[0].problem.wanted.len();
                self.together.get_or_insert_with(|| Box::new(Together::new(rows))).solve(effort, &mut members);
            } else {
                drop(members);
                let with = asking.iter_mut().filter(|asking| asking.tracker.effort() == Some(effort));
                with.for_each(|asking| asking.tracker.allocate(asking.scratch));
            }
        }
    }
}

impl Asking<'_> {
    fn member(&mut self, effort: Effort) -> Option<Member<'_>> {
        let controller = self.tracker.controller_mut().filter(|controller| controller.effort == effort)?;
        Some(self.scratch.member(self.lane, &mut controller.memory))
    }
}
