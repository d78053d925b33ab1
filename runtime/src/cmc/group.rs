//! Controllers of several episodes that share their forces out together, in lanes.

use super::share::{Member, Share};
use super::{ControlScratch, Present, Tracker};
use msk_physics::LaneGroup;
use msk_physics::lanes::Lanes;

/// A controller that has asked for forces.
pub(crate) struct Asking<'a> {
    /// Where in the lanes it takes part.
    pub lane: usize,
    pub tracker: &'a mut Tracker,
    /// With what it has asked for; all of one model and body.
    pub scratch: &'a mut ControlScratch,
    pub present: Present<'a>,
    /// Whether its lane of the group holds the forward pass of its state.
    pub held: &'a mut bool,
}

/// The memory of a worker for controllers of one body.
#[derive(Debug, Clone, Default)]
pub(crate) struct AllocationGroup {
    share: Option<Box<Share<Lanes>>>,
}

/// Fewer than these take less time one by one.
const LEAST: usize = 3;

impl AllocationGroup {
    /// Shares out the forces of all that ask, each to the bits that it comes to alone. Those of one hold do so in the lanes of a group.
    pub fn allocate(&mut self, group: &mut LaneGroup, asking: &mut [Asking<'_>]) {
        let hold = asking.first().and_then(|asking| asking.tracker.hold());
        let together = asking.iter().all(|asking| asking.tracker.hold() == hold);
        match hold {
            Some(hold) if together && asking.len() >= LEAST => {
                for Asking { lane, present, held, .. } in asking.iter_mut().filter(|asking| !*asking.held) {
                    group.hold(*lane, present.state, present.workspace);
                    **held = true;
                }
                let (state, workspace) = group.passes();
                let Present { model, body, .. } = asking[0].present;
                let share = self.share.get_or_insert_with(|| Box::new(Share::new(model, body, workspace)));
                let mut members: Vec<Member<'_>> = asking.iter_mut().filter_map(Asking::member).collect();
                share.solve((model, state, workspace), hold.duration(), &mut members);
            }
            _ => asking.iter_mut().for_each(|asking| asking.tracker.allocate(&asking.present, asking.scratch)),
        }
    }
}

impl Asking<'_> {
    fn member(&mut self) -> Option<Member<'_>> {
        Some(self.scratch.member(self.lane, self.tracker.controller_mut()?))
    }
}
