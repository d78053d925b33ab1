//! Controls of several episodes act together, in the lanes of a group.

use super::together::{Request, allocate};
use super::{Engine, Episode, GroupScratch};
use crate::action::{Controls, Taken};
use crate::cmc::ControlError;

/// An episode for which controls act.
pub struct Controlled<'a> {
    /// The lane whose scratch holds the forward pass of its state.
    pub lane: usize,
    /// What plays it.
    pub engine: &'a Engine,
    /// It has not ended.
    pub episode: &'a Episode,
    /// One per term.
    pub weights: &'a [f64],
    /// They have been reset.
    pub controls: &'a mut Controls,
    /// Of the controls' action space.
    pub entries: &'a [f64],
    /// To be filled: one entry per muscle.
    pub action: &'a mut [f64],
}

impl GroupScratch {
    /// Writes the actions of all members, each in a lane of its own. Gives for each why it has none, if so.
    pub fn control(&mut self, members: &mut [Controlled<'_>]) -> Vec<Result<(), ControlError>> {
        let Self { group, forces, lanes, .. } = self;
        let taken: Vec<Result<Taken, ControlError>> = members
            .iter_mut()
            .map(|member| {
                let scratch = &mut lanes[member.lane];
                let mut control = std::mem::take(&mut scratch.control);
                let context = member.engine.context(member.episode, member.weights, scratch);
                let taken = member.controls.begin(&context, member.entries, &mut control);
                scratch.control = control;
                taken
            })
            .collect();
        let asking = members.iter_mut().zip(&taken).filter(|(_, taken)| **taken == Ok(Taken::AskingForces));
        let asking = asking.filter_map(|(member, _)| {
            let Controlled { lane, engine, episode, controls, .. } = member;
            Some(Request { lane: *lane, engine, state: &episode.state, tracker: controls.tracker_mut()? })
        });
        allocate(forces, group, lanes, asking);
        let finish = |(member, taken): (&mut Controlled<'_>, Result<Taken, ControlError>)| {
            let taken = taken?;
            let scratch = &mut lanes[member.lane];
            let mut control = std::mem::take(&mut scratch.control);
            let context = member.engine.context(member.episode, member.weights, scratch);
            member.controls.finish(taken, &context, &mut control, member.action);
            scratch.control = control;
            Ok(())
        };
        members.iter_mut().zip(taken).map(finish).collect()
    }
}
