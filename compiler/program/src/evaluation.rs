//! Evaluating a compiled task: once where the episode begins, once per control step.
//!
//! 1. [`begin`](CompiledTask::begin) draws the randoms that read no signal, so that scene and initial state may use them;
//! 2. [`reset`](CompiledTask::reset) takes the first snapshot: every memory starts, the other randoms are drawn;
//! 3. [`step`](CompiledTask::step) advances every operator and fills the report; in a sequence it also goes on to the next phase,
//!    which starts from the very snapshot in which the one before it ended.

use crate::graph::operation::Chance;
use crate::init::{Disturbance, DisturbanceSetting, Start};
use crate::lower::{NoneTaken, Scalar, View, deciding_sensors};
use crate::numbers::for_people;
use crate::task::{CompiledTask, FollowedMotion, Init, NonFiniteTerm, NotDrawn, Phase, StepReport, TaskFault, TaskState};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::Range;

/// Where chance comes from: a stream per random, in the order of [`CompiledTask::randoms`].
pub trait Draws {
    /// The next number of the stream, uniform on [0, 1).
    fn uniform(&mut self, random: usize) -> f64;
    /// The next number of the stream, standard normal.
    fn normal(&mut self, random: usize) -> f64;
}

/// No chance: the middle of every distribution. For explanations, which show one initial state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Middle;

impl Draws for Middle {
    fn uniform(&mut self, _: usize) -> f64 {
        0.5
    }

    fn normal(&mut self, _: usize) -> f64 {
        0.0
    }
}

impl CompiledTask {
    /// Starts `state` anew and draws the randoms that read no signal.
    ///
    /// # Errors
    /// A random none of whose tries was taken.
    pub fn begin(&self, draws: &mut dyn Draws, state: &mut TaskState) -> Result<(), TaskFault> {
        self.begin_given(draws, state, &[])
    }

    /// The same with given values of randoms, until they are drawn anew: pairs of a random's place
    /// and its value.
    ///
    /// # Errors
    /// A random none of whose tries was taken.
    pub fn begin_given(
        &self,
        draws: &mut dyn Draws,
        state: &mut TaskState,
        given: &[(usize, Vec<f64>)],
    ) -> Result<(), TaskFault> {
        (state.step, state.phase, state.began) = (0, 0, 0);
        state.successes.clear();
        self.check_parameters(&state.parameters)?;
        self.enter(draws, state, given)
    }

    /// Makes room for the program of the present phase and draws what is drawn first, but for what is `kept`: pairs of a
    /// draw's place and its value.
    fn enter(&self, draws: &mut dyn Draws, state: &mut TaskState, kept: &[(usize, Vec<f64>)]) -> Result<(), TaskFault> {
        let phase = self.phase(state);
        let kept = self.with_parameters(phase, state, kept);
        phase.program.prepare(&state.successes, &mut state.record);
        for (draw, value) in &kept {
            phase.program.keep(*draw, value, &mut state.record);
        }
        let is_kept = |draw: usize| kept.iter().any(|(known, _)| *known == draw);
        let mut source = source(phase, draws);
        let drawn = phase.program.first(&mut state.record, &is_kept, &mut source);
        drawn.map_err(|none| self.not_drawn(phase, none, state))
    }

    fn phase(&self, state: &TaskState) -> &Phase {
        // There is always a phase, and none is entered that does not exist.
        &self.phases[(state.phase as usize).min(self.phases.len() - 1)]
    }

    /// Whether a state that came from outside has the shape of those of this task.
    pub fn accepts(&self, state: &TaskState) -> bool {
        let phase = self.phases.get(state.phase as usize);
        phase.is_some_and(|phase| state.record.len() == phase.program.record.len())
            && state.successes.len() == state.phase as usize
            && self.check_parameters(&state.parameters).is_ok()
            && state.began <= state.step
    }

    /// How this episode begins: what was drawn stands in `state`.
    pub fn initial_state(&self, state: &TaskState) -> Cow<'_, Init> {
        self.settled(&self.init, state)
    }

    /// An initial state with what was drawn for this episode, which stands in `state`.
    pub fn settled<'a>(&self, init: &'a Init, state: &TaskState) -> Cow<'a, Init> {
        if init.drawn.is_empty() && init.follows.is_none() {
            return Cow::Borrowed(init);
        }
        let mut settled = init.clone();
        if let Some(following) = &init.follows {
            following.write(self.entered(following.start, state), 0.0, &mut settled);
        }
        for &(setting, index) in &init.drawn {
            settled.set(setting, self.drawn(index, state));
        }
        Cow::Owned(settled)
    }

    /// The disturbances of an episode whose randoms have just been drawn.
    pub fn begin_disturbances(&self, state: &TaskState, disturbances: &mut Vec<Disturbance>) {
        disturbances.clone_from(&self.disturbances);
        for &(disturbance, setting, index) in &self.drawn_disturbances {
            setting.set(self.drawn(index, state), &mut disturbances[disturbance]);
        }
    }

    /// Gives disturbances that begin in the next control step the force and torque that their randoms have now. In later phases of a
    /// sequence they keep those that they had.
    pub fn renew_disturbances(&self, state: &TaskState, disturbances: &mut [Disturbance]) {
        for &(disturbance, setting, index) in self.drawn_disturbances.iter().filter(|_| state.phase == 0) {
            let disturbance = &mut disturbances[disturbance];
            if setting != DisturbanceSetting::Start && disturbance.begins(state.step) {
                setting.set(self.drawn(index, state), disturbance);
            }
        }
    }

    /// The phase at which a motion was entered in this episode, 0 to 1.
    pub fn entered(&self, start: Start, state: &TaskState) -> f64 {
        match start {
            Start::Phase(phase) => phase,
            Start::Drawn(index) => self.drawn(index, state),
        }
    }

    /// The motion that the first reference of the present phase follows, and where in it the episode is, s.
    pub fn followed(&self, state: &TaskState) -> Option<(&FollowedMotion, f64)> {
        let followed = self.motions.iter().find(|followed| followed.phase == state.phase as usize)?;
        let begun = followed.motion.time_of(self.entered(followed.start, state));
        Some((followed, begun + f64::from(state.step - state.began) / self.control_frequency))
    }

    /// A value that the initial state takes from what was drawn for this episode.
    pub fn drawn(&self, index: usize, state: &TaskState) -> f64 {
        let number = self.phase(state).program.initial_values.get(index);
        number.map_or(0.0, |number| number.read(&View { frame: &[], record: &state.record }))
    }

    /// The same task measured only as far as reward, terminations and success depend on it: its observation, metrics and markers
    /// are without meaning. One whose action space reads its observation stays whole.
    #[must_use]
    pub fn deciding(&self) -> Self {
        if self.action.reads_observation() {
            return self.clone();
        }
        let read: BTreeSet<_> = self.phases.iter().flat_map(|phase| deciding_sensors(&phase.graph, &phase.outputs)).collect();
        Self { frame: self.frame.only(|sensor| read.contains(&sensor)), ..self.clone() }
    }

    /// Where a marker is, in the snapshot of `frame`.
    pub fn marker(&self, index: usize, frame: &[f64], state: &TaskState) -> Option<[f64; 3]> {
        let mut place = [0.0; 3];
        let plan = self.phase(state).program.markers.get(index).filter(|plan| plan.width() == place.len())?;
        plan.write(&View { frame, record: &state.record }, &mut place);
        Some(place)
    }

    /// What the driven object of this place does in the step to be taken, from the snapshot of `frame`: how far it moves along the axes of
    /// the world, m, and turns about the vertical, rad.
    pub fn drive(&self, index: usize, frame: &[f64], state: &TaskState) -> Option<[f64; 4]> {
        let mut drive = [0.0; 4];
        let plan = self.phase(state).program.drives.get(index).filter(|plan| plan.width() == drive.len())?;
        plan.write(&View { frame, record: &state.record }, &mut drive);
        Some(drive)
    }

    /// Starts the task's state from the reset snapshot. `frame` has `self.frame.size()` values. A state that was not begun
    /// is begun first.
    ///
    /// # Errors
    /// A random none of whose tries was taken.
    pub fn reset(&self, frame: &[f64], draws: &mut dyn Draws, state: &mut TaskState) -> Result<(), TaskFault> {
        self.reset_given(frame, draws, state, &[])
    }

    /// The same with given values of randoms; those that [`begin_given`](Self::begin_given) took.
    ///
    /// # Errors
    /// A random none of whose tries was taken.
    pub fn reset_given(
        &self,
        frame: &[f64],
        draws: &mut dyn Draws,
        state: &mut TaskState,
        given: &[(usize, Vec<f64>)],
    ) -> Result<(), TaskFault> {
        let program = &self.phases[0].program;
        if state.phase != 0 || state.record.len() != program.record.len() {
            self.begin_given(draws, state, given)?;
        }
        state.step = 0;
        self.start(frame, draws, state, given)
    }

    /// Takes the first snapshot of the present phase.
    fn start(
        &self,
        frame: &[f64],
        draws: &mut dyn Draws,
        state: &mut TaskState,
        kept: &[(usize, Vec<f64>)],
    ) -> Result<(), TaskFault> {
        let phase = self.phase(state);
        let is_parameter = |draw: usize| phase.streams.get(draw).is_some_and(|&stream| self.randoms[stream].parameter.is_some());
        let is_kept = |draw: usize| is_parameter(draw) || kept.iter().any(|(known, _)| *known == draw);
        let mut source = source(phase, draws);
        let drawn = phase.program.reset(frame, &mut state.record, &is_kept, &mut source);
        drawn.map_err(|none| self.not_drawn(phase, none, state))
    }

    /// Advances every operator by one control step and evaluates terms, metrics, ends and success. `weights` has one entry per
    /// term.
    ///
    /// # Errors
    /// A term that is not finite, or a random none of whose tries was taken; the report is filled all the same.
    pub fn step(
        &self,
        frame: &[f64],
        weights: &[f64],
        draws: &mut dyn Draws,
        state: &mut TaskState,
        report: &mut StepReport,
    ) -> Result<(), TaskFault> {
        state.step += 1;
        let phase = self.phase(state);
        let step = state.step - state.began;
        let drawn = phase.program.step(step, frame, &mut state.record, &mut source(phase, draws));
        self.report(frame, weights, state, report);
        drawn.map_err(|none| self.not_drawn(phase, none, state))?;
        // One value that is not finite, and the sum is not.
        if !report.reward.is_finite()
            && let Some(index) = report.terms.iter().position(|value| !value.is_finite())
        {
            return Err(TaskFault::Term(NonFiniteTerm {
                term: self.terms[index].name.clone(),
                value: report.terms[index],
                step: state.step,
                formula: self.terms[index].source.clone(),
            }));
        }
        if report.entered { self.go_on(frame, draws, state) } else { Ok(()) }
    }

    /// Terms, metrics, ends and success at the present snapshot, which may be that of the reset; nothing advances.
    pub fn report(&self, frame: &[f64], weights: &[f64], state: &TaskState, report: &mut StepReport) {
        let phase = self.phase(state);
        let program = &phase.program;
        let view = View { frame, record: &state.record };
        report.phase = state.phase;
        // Rewards and ends of another phase do not count in this one, and what it measures is no number.
        let terms = part(&mut report.terms, self.terms.len(), &phase.terms, 0.0);
        terms.iter_mut().zip(&program.terms).for_each(|(value, term)| *value = term.read(&view));
        let holds = |conditions: &[Scalar], report: &mut [bool]| {
            report.iter_mut().zip(conditions).for_each(|(value, condition)| *value = condition.holds(&view));
        };
        let terminations = part(&mut report.terminations, self.terminations.len(), &phase.terminations, false);
        holds(&program.terminations, terminations);
        holds(&program.finishes, part(&mut report.finishes, self.finishes.len(), &phase.finishes, false));
        holds(&program.releases, part(&mut report.released, program.releases.len(), &(0..program.releases.len()), false));
        let (count, own) = &phase.measured;
        program.metrics.write(&view, part(&mut report.metrics, *count, own, f64::NAN));
        report.reward = report.terms.iter().zip(weights).map(|(value, weight)| value * weight).sum();

        let terminated = report.terminations.contains(&true);
        let finished = report.finishes.contains(&true);
        let complete = state.step - state.began >= phase.horizon;
        let last = state.phase as usize + 1 >= self.phases.len();
        let moves_on = program.until.as_ref().map_or(complete || finished, |until| until.holds(&view));
        report.entered = !last && !terminated && moves_on;
        if report.entered {
            // The reason for which a phase was to finish is why the next begins, and no end of the episode.
            report.finishes.fill(false);
        }
        report.truncated = complete && !terminated && !report.entered && !report.finishes.contains(&true);
        report.success = last && program.success.as_ref().is_some_and(|success| success.holds(&view));
    }

    /// Enters the next phase from the present snapshot.
    fn go_on(&self, frame: &[f64], draws: &mut dyn Draws, state: &mut TaskState) -> Result<(), TaskFault> {
        let before = self.phase(state);
        let view = View { frame, record: &state.record };
        let success = before.program.succeeded.as_ref().is_some_and(|succeeded| succeeded.holds(&view));
        let next = &self.phases[state.phase as usize + 1];
        // What the sequence itself draws stays what it is.
        let shared = next.streams.iter().enumerate().filter_map(|(draw, stream)| {
            let old = before.streams.iter().position(|known| known == stream)?;
            Some((draw, before.program.value_of_draw(old, &state.record).to_vec()))
        });
        let kept: Vec<(usize, Vec<f64>)> = shared.collect();
        state.successes.push(success);
        state.phase += 1;
        state.began = state.step;
        self.enter(draws, state, &kept)?;
        self.start(frame, draws, state, &kept)
    }

    /// Writes the observation; `out` has `self.observation_size()` values, `frame` is that of the last `reset` or `step`.
    pub fn observe(&self, frame: &[f64], state: &TaskState, out: &mut [f64]) {
        self.phase(state).observation.write(&View { frame, record: &state.record }, out);
        if self.phases.len() > 1
            && let Some(one_hot) = self.channels.last()
            && let Some(present) = out.get_mut(one_hot.offset + state.phase as usize)
        {
            *present = 1.0;
        }
    }

    /// Writes what only a critic sees; `out` has `self.critic_size()` values, `frame` is that of the last `reset` or `step`.
    pub fn observe_critic(&self, frame: &[f64], state: &TaskState, out: &mut [f64]) {
        self.phase(state).critic.write(&View { frame, record: &state.record }, out);
    }

    /// Number of values that only a critic sees.
    pub fn critic_size(&self) -> usize {
        self.critic.iter().map(|channel| channel.size).sum()
    }

    /// Number of values of the observation.
    pub fn observation_size(&self) -> usize {
        self.channels.iter().map(|channel| channel.size).sum()
    }

    /// Names of the phases of a sequence; a task by itself is one.
    pub fn phases(&self) -> Vec<&str> {
        self.phases.iter().map(|phase| phase.name.as_str()).collect()
    }

    /// The weights in force, one for each term: those of the end of a training.
    pub fn weights(&self) -> Vec<f64> {
        self.terms.iter().map(|term| term.weight).collect()
    }

    /// Number of operations that one control step takes in the longest phase; what formulas share is counted once.
    pub fn operations(&self) -> usize {
        self.phases.iter().map(|phase| phase.program.operations).max().unwrap_or(0)
    }

    fn not_drawn(&self, phase: &Phase, none: NoneTaken, state: &TaskState) -> TaskFault {
        let random = &self.randoms[phase.streams[none.draw]];
        let last = none.last.iter().map(|value| for_people(*value)).collect::<Vec<_>>().join(", ");
        TaskFault::Draw(NotDrawn {
            random: random.name.clone(),
            tries: none.tries,
            last,
            step: state.step,
            wanted: random.accept.clone(),
        })
    }
}

/// Chance for the draws of a phase.
fn source<'a>(phase: &'a Phase, draws: &'a mut dyn Draws) -> impl FnMut(usize, Chance) -> f64 + 'a {
    move |draw, chance| match chance {
        Chance::Uniform => draws.uniform(phase.streams[draw]),
        Chance::Normal => draws.normal(phase.streams[draw]),
    }
}

/// The part of a list that a phase writes; the rest takes `elsewhere`, and the list keeps its memory.
#[inline(always)]
fn part<'a, T: Copy>(list: &'a mut Vec<T>, length: usize, own: &Range<usize>, elsewhere: T) -> &'a mut [T] {
    if list.len() != length {
        list.resize(length, elsewhere);
    }
    if own.len() != length {
        list[..own.start].fill(elsewhere);
        list[own.end..].fill(elsewhere);
    }
    &mut list[own.clone()]
}
