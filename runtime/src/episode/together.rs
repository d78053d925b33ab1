//! One control step of up to eight episodes at once, in the lanes of the simulator.

use super::{Engine, Episode, EpisodeKey, Fault, Player, Scratch};
use crate::action::{Action, Taken};
use crate::cmc::{AllocationGroup, Asking, Present, Tracker};
use msk_physics::lanes::WIDTH;
use msk_physics::{LaneGroup, Parts, Rates, State, Workspace};
use std::sync::Arc;

/// The memory of one worker that plays up to eight episodes of a model at once, those of several tasks, too.
///
/// As with [`Scratch`], nothing in it decides anything: an episode comes to the same bits in any lane, beside any neighbours, or alone.
#[derive(Debug, Clone)]
pub struct GroupScratch {
    pub(super) group: LaneGroup,
    /// For controllers of action spaces.
    pub(super) forces: AllocationGroup,
    /// What each lane would need alone: sensors and policies read the forward pass there.
    pub(super) lanes: Vec<Scratch>,
    /// Whether the lanes come to hold the whole forward pass after a step; else what the tasks themselves read of it.
    whole: bool,
}

/// An episode that takes part in a step.
pub struct Member<'a> {
    /// What plays it.
    pub engine: &'a Engine,
    /// It has not ended.
    pub episode: &'a mut Episode,
    /// Of the forward pass of its state, if that is known.
    pub rates: &'a mut Option<Rates>,
    /// One per term.
    pub weights: &'a [f64],
    /// Its length fits.
    pub action: Action<'a>,
}

/// A member in its lane.
struct Seat<'a> {
    lane: usize,
    member: Member<'a>,
    /// Control steps before this one.
    steps: u32,
    /// Whether forces from outside follow its body.
    pushed: bool,
    /// Whether rates have to be found anew once its muscles are excited.
    alone: bool,
    /// How far its action has been taken.
    taken: Taken,
}

impl Engine {
    /// Memory for a worker that plays as many episodes at once, of eight at most.
    pub fn group_scratch(&self, episodes: usize) -> GroupScratch {
        GroupScratch {
            group: LaneGroup::of(&self.model, &self.plan),
            forces: AllocationGroup::default(),
            lanes: vec![self.scratch(); episodes.clamp(1, WIDTH)],
            whole: true,
        }
    }

    /// Whether the two play on one model and body, so that scratch of one serves the other.
    pub(super) fn shares_model(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.model, &other.model) && Arc::ptr_eq(&self.body, &other.body)
    }

    /// Whether the two can play their episodes together: on one model and body, with steps of one length.
    pub fn goes_with(&self, other: &Self) -> bool {
        self.shares_model(other) && self.substeps == other.substeps
    }
}

impl GroupScratch {
    /// Whether it can play episodes of this engine.
    pub fn serves(&self, engine: &Engine) -> bool {
        self.lanes.first().is_some_and(|scratch| engine.serves(scratch))
    }

    /// The same where nobody looks at [lanes](Self::lane), which takes less time: a step leaves only those parts of the forward pass there
    /// that the tasks themselves read.
    #[must_use]
    pub(super) fn unseen(self) -> Self {
        Self { whole: false, ..self }
    }

    /// The memory of a lane, with the forward pass of its episode.
    pub fn lane(&self, lane: usize) -> &Scratch {
        &self.lanes[lane]
    }

    /// Begins an episode in a lane with [parameters](Engine::reset_with), and gives the rates of its first state.
    pub fn begin(
        &mut self,
        lane: usize,
        engine: &Engine,
        (key, parameters): (EpisodeKey, &[f64]),
        episode: &mut Episode,
    ) -> Option<Rates> {
        let scratch = &mut self.lanes[lane];
        engine.reset_with(key, parameters, episode, scratch);
        episode.ending.is_none().then(|| Rates::of(&engine.model, &episode.state, &mut scratch.workspace))
    }

    /// Takes one control step with each of the members, in the lanes of their places. Members are of engines that
    /// [go with](Engine::goes_with) the one that made this; those beyond the lanes are not stepped.
    pub fn step<'a>(&mut self, members: impl IntoIterator<Item = Option<Member<'a>>>) {
        let seat = |(lane, member): (usize, Option<Member<'a>>)| {
            let member = member?;
            let steps = member.episode.steps();
            Some(Seat { lane, steps, pushed: false, alone: false, taken: Taken::Wholly, member })
        };
        let mut seats: [Option<Seat<'a>>; WIDTH] = Default::default();
        let taken = members.into_iter().take(self.lanes.len()).enumerate().filter_map(seat);
        seats.iter_mut().zip(taken).for_each(|(place, seat)| *place = Some(seat));
        let count = seats.iter().flatten().count();
        if count < self.group.least() {
            seats.iter_mut().flatten().for_each(|seat| seat.step_alone(&mut self.lanes[seat.lane]));
            return;
        }
        let own = seats.iter().flatten().map(|seat| seat.member.engine.parts).reduce(Parts::or);
        let parts = own.filter(|_| !self.whole).unwrap_or(Parts::ALL);
        let Self { group, forces, lanes, .. } = self;
        Together { group, forces, lanes, parts }.step(&mut seats);
    }
}

impl Seat<'_> {
    fn player<'a>(&'a mut self, scratch: &'a mut Scratch) -> Player<'a> {
        let Member { engine, episode, weights, .. } = &mut self.member;
        Player { engine, episode, weights, scratch }
    }

    fn step_alone(&mut self, scratch: &mut Scratch) {
        let action = self.member.action;
        // The episode goes on and the action has its length, so there is no error.
        let _ = self.player(scratch).step(action);
        *self.member.rates = None;
    }

    fn end_with(&mut self, fault: Fault, scratch: &mut Scratch) {
        *self.member.rates = None;
        let steps = self.steps;
        self.player(scratch).end_with(fault, steps);
    }

    /// Takes the action of the episode.
    fn take(&mut self, scratch: &mut Scratch) -> Result<(), Fault> {
        let action = self.member.action;
        let known = self.member.rates.is_some();
        let mut player = self.player(scratch);
        player.renew_pushes();
        let looks = player.episode.action.looks_at_state();
        let alone = !known || player.forces_change() || !player.engine.model.actuators.act_by_activation();
        if alone || looks {
            player.pass()?;
        }
        let taken = player.take(action)?;
        (self.alone, self.taken) = (alone, taken);
        Ok(())
    }

    /// Brings the episode to where only physics is missing, with the rates that this goes on from.
    fn prepare(&mut self, scratch: &mut Scratch) -> Result<(), Fault> {
        let (alone, taken) = (self.alone, self.taken);
        let mut player = self.player(scratch);
        player.excite(taken);
        player.drive();
        let pushed = player.is_pushed();
        if alone {
            player.react()?;
            let (model, state) = (&player.engine.model, &player.episode.state);
            let rates = Rates::of(model, state, &mut player.scratch.workspace);
            player.scratch.forget();
            *self.member.rates = Some(rates);
        }
        self.pushed = pushed;
        Ok(())
    }

    /// Evaluates the task in the state to which physics has come, whose forward pass the scratch holds, the `whole` or what the task reads.
    fn finish(&mut self, whole: bool, scratch: &mut Scratch) -> Result<(), Fault> {
        match whole {
            true => scratch.note(&self.member.episode.state),
            false => scratch.forget(),
        }
        scratch.in_lane = whole;
        let released = self.player(scratch).conclude()?;
        if released {
            *self.member.rates = None;
        }
        Ok(())
    }
}

/// A group of lanes, with the scratch of each.
struct Together<'a> {
    group: &'a mut LaneGroup,
    forces: &'a mut AllocationGroup,
    lanes: &'a mut [Scratch],
    /// What is wanted of the forward pass.
    parts: Parts,
}

impl Together<'_> {
    fn step(&mut self, seats: &mut [Option<Seat<'_>>]) {
        self.each(seats, Seat::take);
        self.allocate(seats);
        self.each(seats, Seat::prepare);
        let mut substeps = 0;
        let mut episodes: [Option<_>; WIDTH] = Default::default();
        for seat in seats.iter().flatten() {
            substeps = seat.member.engine.substeps;
            episodes[seat.lane] = seat.member.rates.as_ref().map(|rates| (&seat.member.episode.state, rates));
        }
        self.group.load(&episodes);
        // From here on the lanes hold the forward passes of states that come to be.
        self.lanes.iter_mut().for_each(|scratch| scratch.in_lane = false);
        self.group.excite();
        for _ in 0..substeps {
            self.group.integrate();
            self.push(seats);
            self.group.forward();
        }
        self.store(seats);
        let whole = self.parts == Parts::ALL;
        self.each(seats, |seat, scratch| seat.finish(whole, scratch));
    }

    /// Does something with each seat; a fault ends its episode.
    fn each<'b>(
        &mut self,
        seats: &mut [Option<Seat<'b>>],
        mut work: impl FnMut(&mut Seat<'b>, &mut Scratch) -> Result<(), Fault>,
    ) {
        for place in seats {
            let Some(seat) = place else { continue };
            let scratch = &mut self.lanes[seat.lane];
            if let Err(fault) = work(seat, scratch) {
                seat.end_with(fault, scratch);
                *place = None;
            }
        }
    }

    /// Shares out the forces that actions have asked for.
    fn allocate(&mut self, seats: &mut [Option<Seat<'_>>]) {
        let asking = seats.iter_mut().flatten().filter(|seat| seat.taken == Taken::AskingForces);
        let asking = asking.filter_map(|seat| {
            let Episode { action, state, .. } = &mut *seat.member.episode;
            Some(Request { lane: seat.lane, engine: seat.member.engine, state, tracker: action.tracker_mut()? })
        });
        allocate(self.forces, self.group, self.lanes, asking);
    }

    /// Moves forces from outside along with the bodies on which they act.
    fn push(&mut self, seats: &mut [Option<Seat<'_>>]) {
        let mut pushed = seats.iter_mut().flatten().filter(|seat| seat.pushed).peekable();
        if pushed.peek().is_some() {
            self.group.place();
        }
        for seat in pushed {
            let (lane, scratch) = (seat.lane, &mut self.lanes[seat.lane]);
            self.group.store_frames(lane, &mut scratch.workspace.kinematics);
            seat.player(scratch).push();
            self.group.set_body_force(lane, &seat.member.episode.state.body_force);
        }
    }

    /// Takes all episodes out of their lanes; one with a fault ends.
    fn store(&mut self, seats: &mut [Option<Seat<'_>>]) {
        let mut states: [Option<&mut State<f64>>; WIDTH] = Default::default();
        seats.iter_mut().flatten().for_each(|seat| states[seat.lane] = Some(&mut seat.member.episode.state));
        self.group.store_states(states);
        for place in seats.iter_mut() {
            let Some(seat) = place else { continue };
            if let Some(fault) = self.group.take_fault(seat.lane) {
                seat.end_with(fault.into(), &mut self.lanes[seat.lane]);
                *place = None;
            }
        }
        let mut passes: [Option<_>; WIDTH] = Default::default();
        let mut workspaces: [Option<&mut Workspace<f64>>; WIDTH] = Default::default();
        workspaces.iter_mut().zip(&mut *self.lanes).for_each(|(place, scratch)| *place = Some(&mut scratch.workspace));
        for seat in seats.iter_mut().flatten() {
            passes[seat.lane] = workspaces[seat.lane].take().zip(seat.member.rates.as_mut());
        }
        self.group.store_passes(passes, self.parts);
    }
}

/// A tracker that has asked for forces, of an episode whose forward pass is in a lane's scratch.
pub(super) struct Request<'a> {
    pub lane: usize,
    pub engine: &'a Engine,
    pub state: &'a State<f64>,
    pub tracker: &'a mut Tracker,
}

/// Shares out the forces that trackers have asked for, each with the memory of another lane.
pub(super) fn allocate<'a>(
    forces: &mut AllocationGroup,
    group: &mut LaneGroup,
    lanes: &mut [Scratch],
    requests: impl Iterator<Item = Request<'a>>,
) {
    let mut places: Vec<Option<&mut Scratch>> = lanes.iter_mut().map(Some).collect();
    let asking = |Request { lane, engine, state, tracker }: Request<'a>| {
        let Scratch { workspace, control, in_lane, .. } = places[lane].take()?;
        let present = Present { body: &engine.body, model: &engine.model, state, workspace };
        Some(Asking { lane, tracker, scratch: control.get_mut()?, present, held: in_lane })
    };
    forces.allocate(group, &mut requests.filter_map(asking).collect::<Vec<_>>());
}
