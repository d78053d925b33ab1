//! What a worker needs to control a body: memory for one control step, and what depends on the model alone.
//!
//! Nothing in it decides anything: what a later action depends on is in the [`Controller`](super::Controller) of the episode. So
//! thousands of episodes need one of these per worker.

use super::activation::Muscles;
use super::allocation::{Allocation, Columns, Effort, Member, Memory, Problem, Slot, Unknown};
use super::coordinates::Coordinates;
use super::dynamics::{Dynamics, Motion};
use super::feedback::Compromise;
use super::support::Point;
use super::{CONTACT_COST, CONTACT_LIMIT, CONTACT_UNIT, MUSCLE_COST, Present, friction_pyramid};
use msk_physics::Workspace;

/// Memory of a worker for controllers of one model.
#[derive(Debug, Clone)]
pub(crate) struct ControlScratch {
    pub(super) coordinates: Coordinates,
    /// Velocities of the independent coordinates.
    pub(super) velocities: Vec<f64>,
    pub(super) compromise: Compromise,
    pub(super) dynamics: Dynamics,
    pub(super) muscles: Muscles,
    /// The activations that each muscle can reach within the hold.
    pub(super) reach: Vec<[f64; 2]>,
    /// What each muscle is asked for: an activation first, then the excitation that brings it there.
    pub(super) asked: Vec<f64>,
    /// Muscles first, then the edges of the friction pyramid at each point that bears weight.
    columns: Columns<f64>,
    unknowns: Vec<Unknown<f64>>,
    /// Those points.
    slots: Vec<Slot>,
    pub(super) wanted: Vec<f64>,
    allocation: Allocation<f64>,
    /// For poses of what is followed.
    pub(super) workspace: Workspace<f64>,
}

impl ControlScratch {
    /// For the model of an episode, of which a forward pass has been made.
    pub fn new(present: &Present<'_>) -> Self {
        let &Present { model, workspace, .. } = present;
        let coordinates = Coordinates::new(model);
        let (size, muscles) = (coordinates.len(), model.actuators.muscles().count());
        Self {
            velocities: vec![0.0; size],
            compromise: Compromise::new(size),
            dynamics: Dynamics::new(model, workspace, &coordinates),
            muscles: Muscles::new(model),
            reach: vec![[0.0; 2]; muscles],
            asked: vec![0.0; muscles],
            columns: Columns::default(),
            unknowns: Vec::new(),
            slots: Vec::new(),
            wanted: vec![0.0; size],
            allocation: Allocation::new(size),
            workspace: Workspace::new(model),
            coordinates,
        }
    }

    /// Writes the unknowns: activations within reach, and forces at the points that bear weight, which move as `feet`.
    pub(super) fn pose_problem(&mut self, bearing: &[Point], feet: &[Motion]) {
        self.columns.clone_from(&self.dynamics.muscles);
        self.unknowns.clear();
        self.unknowns.extend(self.reach.iter().map(|&[low, high]| Unknown { low, high, cost: MUSCLE_COST }));
        self.slots.clear();
        for (point, motion) in bearing.iter().zip(feet) {
            let first = self.columns.count();
            for force in friction_pyramid(point) {
                self.columns.push(motion.force(force * CONTACT_UNIT));
                self.unknowns.push(Unknown { low: 0.0, high: CONTACT_LIMIT, cost: CONTACT_COST });
            }
            self.slots.push(Slot { key: point.key, first, columns: self.columns.count() - first });
        }
    }

    /// Shares the required force out.
    pub(super) fn allocate(&mut self, effort: Effort, memory: &mut Memory) {
        let Self { dynamics, columns, unknowns, wanted, asked, allocation, .. } = self;
        let (x, _) = allocation.solve(&problem(dynamics, columns, unknowns, wanted), effort, memory);
        asked.iter_mut().zip(x).for_each(|(asked, wanted)| *asked = *wanted);
    }

    /// The same problem as one of several, in a lane.
    pub(super) fn member<'a>(&'a mut self, lane: usize, memory: &'a mut Memory) -> Member<'a> {
        let Self { dynamics, columns, unknowns, wanted, asked, slots, .. } = self;
        Member { lane, problem: problem(dynamics, columns, unknowns, wanted), slots, memory, out: asked }
    }
}

fn problem<'a>(
    dynamics: &'a Dynamics,
    columns: &'a Columns<f64>,
    unknowns: &'a [Unknown<f64>],
    wanted: &'a [f64],
) -> Problem<'a, f64> {
    let Dynamics { pattern, inertia, .. } = dynamics;
    Problem { pattern, inertia, columns, unknowns, wanted, count: unknowns.len() as f64 }
}
