//! Many episodes at once, eight in one number.

mod group;
mod one_lane;

pub use group::{LaneGroup, Parts, Rates};
pub(crate) use one_lane::{OneLane, PerLane, one_lane};

use crate::{
    Fault, Instructions, Plan, State, Workspace,
    lanes::{Lanes, WIDTH},
    model::Model,
    stepping,
};
use rayon::prelude::*;
use std::sync::Arc;

/// Episodes of one model that are stepped together.
///
/// Every episode comes to the bits that [`step`](crate::step) gives it alone, whatever its neighbours do, however many there are, on
/// any number of workers and with any instructions of the processor. An episode that meets a [`Fault`] stays as it was and is left
/// out until it is [`set`](Self::set) again; the others go on.
///
/// ```
/// use msk_physics::{Batch, State, model::Model};
/// use std::sync::Arc;
///
/// let model = Arc::new(Model::from_mjcf(r#"<mujoco><worldbody><body>
///     <joint type="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -1" size="0.05"/>
/// </body></worldbody></mujoco>"#)?);
/// let mut batch = Batch::new(&model, 20);
/// let mut state = State::new(&model);
/// for episode in 0..batch.len() {
///     state.position[0] = 0.1 * episode as f64;
///     batch.set(episode, &state)?;
/// }
/// (0..100).for_each(|_| batch.step());
/// batch.get(7, &mut state)?;
/// assert!(state.position[0].abs() <= 0.7 && batch.fault(7).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Batch {
    model: Arc<Model>,
    plan: Plan,
    count: usize,
    instructions: Instructions,
    groups: Vec<Group>,
    /// The memory of each worker.
    workers: Vec<Workspace<Lanes>>,
}

/// A wrong use of a batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BatchError {
    /// There is no such episode.
    #[error("episode {index} of a batch of {count}")]
    Index {
        /// What was asked for.
        index: usize,
        /// Number of episodes.
        count: usize,
    },
    /// A state or list of controls is not as long as the model asks for.
    #[error("the {what} does not fit the model of the batch")]
    Shape {
        /// What was given.
        what: &'static str,
    },
}

/// The episodes of one set of lanes.
#[derive(Debug, Clone)]
struct Group {
    state: State<Lanes>,
    faults: Vec<Option<Fault>>,
    /// Lanes beyond the last episode.
    empty: [bool; WIDTH],
}

impl Batch {
    /// `count` episodes in the reference configuration, stepped by one worker.
    pub fn new(model: &Arc<Model>, count: usize) -> Self {
        let group = |group: usize| Group {
            state: State::new(model),
            faults: vec![None; WIDTH],
            empty: core::array::from_fn(|lane| group * WIDTH + lane >= count),
        };
        let batch = Self {
            model: Arc::clone(model),
            plan: Plan::new(model),
            count,
            instructions: Instructions::default(),
            groups: (0..count.div_ceil(WIDTH)).map(group).collect(),
            workers: Vec::new(),
        };
        batch.with_workers(1)
    }

    /// The same with as many workers, each with a share of the episodes; they run on rayon's threads.
    pub fn with_workers(mut self, workers: usize) -> Self {
        let workers = workers.clamp(1, self.groups.len().max(1));
        self.workers = vec![Workspace::of(&self.model, &self.plan).with_instructions(self.instructions); workers];
        self
    }

    /// The same with these instructions of the processor instead of the widest.
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.instructions = instructions;
        let workers = self.workers.len();
        self.with_workers(workers)
    }

    /// Number of episodes.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Puts a state into an episode, which forgets its fault: a reset, or a snapshot that goes on.
    ///
    /// # Errors
    /// No such episode, or a state of another model.
    pub fn set(&mut self, index: usize, state: &State<f64>) -> Result<(), BatchError> {
        if !state.fits(&self.model) {
            return Err(BatchError::Shape { what: "state" });
        }
        let (group, lane) = self.place(index)?;
        state.write_lane(&mut self.groups[group].state, lane);
        self.groups[group].faults[lane] = None;
        Ok(())
    }

    /// Writes the state of an episode over `state`: for sensors and policies, which want [`forward`](crate::forward) of it.
    ///
    /// # Errors
    /// No such episode, or a state of another model.
    pub fn get(&self, index: usize, state: &mut State<f64>) -> Result<(), BatchError> {
        if !state.fits(&self.model) {
            return Err(BatchError::Shape { what: "state" });
        }
        let (group, lane) = self.place(index)?;
        state.read_lane(&self.groups[group].state, lane);
        Ok(())
    }

    /// Sets the controls of an episode, one per actuator.
    ///
    /// # Errors
    /// No such episode, or another number of controls.
    pub fn set_control(&mut self, index: usize, control: &[f64]) -> Result<(), BatchError> {
        if control.len() != self.model.actuators.name.len() {
            return Err(BatchError::Shape { what: "list of controls" });
        }
        let (group, lane) = self.place(index)?;
        control.write_lane(&mut self.groups[group].state.control, lane);
        Ok(())
    }

    /// Simulated time of an episode, s; `None` where there is none.
    pub fn time(&self, index: usize) -> Option<f64> {
        let (group, lane) = self.place(index).ok()?;
        Some(crate::scalar::Real::lane(&self.groups[group].state.time, lane))
    }

    /// Why an episode is not stepped any more.
    pub fn fault(&self, index: usize) -> Option<&Fault> {
        let (group, lane) = self.place(index).ok()?;
        self.groups[group].faults[lane].as_ref()
    }

    /// Takes one step in every episode without a fault.
    pub fn step(&mut self) {
        let Self { model, groups, workers, .. } = self;
        let share = groups.len().div_ceil(workers.len().max(1)).max(1);
        if let [worker] = &mut workers[..] {
            groups.iter_mut().for_each(|group| group.step(model, worker, &mut || {}));
            return;
        }
        groups.par_chunks_mut(share).zip(workers).for_each(|(groups, worker)| {
            groups.iter_mut().for_each(|group| group.step(model, worker, &mut || {}));
        });
    }

    /// [`step`](Self::step) by the first worker alone, with a call of `lap` after each of the [`STAGES`](crate::STAGES) of every
    /// eight episodes: for clocks.
    pub fn step_by_stage(&mut self, mut lap: &mut dyn FnMut()) {
        let Self { model, groups, workers, .. } = self;
        let Some(worker) = workers.first_mut() else { return };
        groups.iter_mut().for_each(|group| group.step(model, worker, &mut lap));
    }

    fn place(&self, index: usize) -> Result<(usize, usize), BatchError> {
        let count = self.count;
        if index < count { Ok((index / WIDTH, index % WIDTH)) } else { Err(BatchError::Index { index, count }) }
    }
}

impl Group {
    fn step(&mut self, model: &Model, workspace: &mut Workspace<Lanes>, lap: &mut impl FnMut()) {
        for (lane, masked) in workspace.masked.iter_mut().enumerate() {
            *masked = self.empty[lane] || self.faults[lane].is_some();
        }
        // Faults are noted by lane, and the other lanes go on.
        let forward = stepping::forward_by_stage(model, &self.state, workspace, lap);
        if forward.is_ok() || (0..WIDTH).any(|lane| workspace.lives(lane)) {
            let _ = stepping::integrate(model, &mut self.state, workspace);
        }
        lap();
        for (fault, found) in self.faults.iter_mut().zip(&mut workspace.faults) {
            *fault = fault.take().or(found.take());
        }
    }
}
