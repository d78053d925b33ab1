//! Computed muscle control of a posture, or of a motion: a model-based controller that needs no training.
//!
//! It follows Thelen & Anderson's computed muscle control (J. Biomech. 39, 2006): feedback gives desired accelerations,
//! inverse dynamics the forces that they take, static optimisation the activations. It differs where standing at 100 Hz with
//! 416 muscles demands it. At every control step, of length T:
//!
//! 1. `feedback`: desired accelerations ẇ of the independent coordinates: towards the task's initial pose, the root
//!    upright, the centre of mass over the feet, the feet at rest. Where the task follows a reference motion, towards where that
//!    is at the end of the hold, and as fast (`goal`): joints, root, centre of mass; only those points of the feet rest that
//!    stand in the motion, too;
//!    What it wishes for (`wishes`) is plain numbers; the accelerations are a `compromise`;
//! 2. `dynamics`: the force that this takes, (P'M P + T D) ẇ + load, damping taken implicitly over the step;
//! 3. `support`: the points of the feet near the ground, each with a friction pyramid of possible forces, so that weight and
//!    centre of pressure are shared between the feet by the optimisation itself and never leave them;
//! 4. `allocation`: muscle activations and contact forces that come nearest to the required force at least effort. The
//!    activations are bounded by what each muscle can reach within the step, so the optimum is always reachable;
//! 5. `activation`: the excitation that brings each muscle there, or leads it there smoothly, from which the action follows.
//!
//! What takes time of it, from the compromise to the activations, is a [`share`](share::Share) of one episode or of eight in lanes.
//!
//! What it knows of a body is its landmarks `feet`, its joints and its muscles. What it does not know: the forces of joint
//! limits and of contacts other than the feet's, the slow terms J̇v of points, and any disturbance; feedback answers for those.
//! It plans nothing: what a reference asks of the ground that the ground cannot give is lost, and so is the balance in time.
//! It reads the full state of the simulator, so it is a yardstick for what the muscles can do, not a model of what the nervous
//! system does.

mod activation;
mod allocation;
mod compromise;
mod coordinates;
mod dynamics;
mod feedback;
mod gait;
mod goal;
mod grips;
mod group;
mod inverse;
mod motion;
mod offsets;
mod reach;
mod scratch;
mod share;
mod support;
#[cfg(test)]
mod tests;
mod tracking;
mod turning;
mod wishes;

pub(crate) use activation::Lead;
pub(crate) use gait::Walk;
pub(crate) use group::{AllocationGroup, Asking};
pub(crate) use inverse::ActivationInverse;
pub(crate) use offsets::Offsets;
pub(crate) use scratch::ControlScratch;
pub(crate) use tracking::{Moment, Tracker};

use crate::action::action_for;
use crate::body::{Body, OutOfReach};
use activation::Hold;
use allocation::{Effort, Memory};
use coordinates::Coordinates;
use feedback::{Carried, Feedback};
use gait::Gait;
use goal::{Course, Follower};
use grips::Grips;
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{State, Workspace, moving_dofs};
use nalgebra::Vector3;
use offsets::Priority;
use support::{Point, Support};

/// What the controller cannot control.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
pub enum ControlError {
    /// Nothing could move the body.
    #[error("the body has no muscles")]
    NoMuscles,
    /// A pose of another body.
    #[error("the task aligns {found} joints of {expected}")]
    Pose {
        /// Joints of the body.
        expected: usize,
        /// Joints of the pose.
        found: usize,
    },
    /// Nothing to walk on.
    #[error("a gait takes a free root and two feet: a group `feet` of two landmarks with shapes")]
    NoGait,
    /// Nothing to follow.
    #[error("no test of `{task}` plays a script up to `expect success`")]
    NoDemonstration {
        /// The task.
        task: String,
    },
    /// The demonstration brings a landmark to a place that its joints do not reach.
    #[error(transparent)]
    Reach(#[from] OutOfReach),
    /// The network of the task's action space cannot act.
    #[error("the network `{path}` {reason}")]
    Network {
        /// As the task names it.
        path: String,
        /// Why not, in words that continue its name.
        reason: String,
    },
    /// An action before the reset.
    #[error("it has not been reset")]
    NotReset,
}

/// Cost of full activation of one muscle, in units of the error's (J/s²).
const MUSCLE_COST: f64 = 0.01;
/// The unit of the contact forces, N, and the cost of one unit.
const CONTACT_UNIT: f64 = 100.0;
const CONTACT_COST: f64 = 0.1;
/// No contact force is larger than this many units.
const CONTACT_LIMIT: f64 = 1000.0;
/// A point of a foot that is nearer to the ground than this can bear weight, m. The ground is soft by less than 1 mm.
const CONTACT_HEIGHT: f64 = 0.002;
/// Share of the friction that the forces may use.
const FRICTION_SHARE: f64 = 0.8;
/// The centre of mass goes this part of its way towards the middle of the feet, because over the ankles, where a neutral pose
/// leaves it, the heels are near; with this time constant (s).
const LEAN: f64 = 0.2;
const LEAN_TIME: f64 = 0.5;

/// A body and its present state.
#[derive(Clone, Copy)]
pub(crate) struct Present<'a> {
    pub body: &'a Body,
    pub model: &'a Model,
    pub state: &'a State<f64>,
    /// Forward pass of the state.
    pub workspace: &'a Workspace<f64>,
}

/// One moment of an episode, as the parts of the controller see it.
#[derive(Clone, Copy)]
struct View<'a> {
    state: &'a State<f64>,
    /// Forward pass of the state.
    workspace: &'a Workspace<f64>,
    coordinates: &'a Coordinates,
    /// T, how long the forces will be held, s.
    hold: f64,
}

impl View<'_> {
    /// The common centre of mass of a body and all that hangs on it, m.
    fn com(&self, body: usize) -> Vector3<f64> {
        self.workspace.kinematics.subtree_com[body]
    }
}

/// The controller of one episode: what a later action depends on.
#[derive(Debug, Clone)]
struct Controller {
    hold: Hold,
    lead: Lead,
    support: Support,
    grips: Grips,
    /// Level offset of the centre of mass from the middle of the feet, m: present goal and where it tends to.
    offset: Vector3<f64>,
    final_offset: Vector3<f64>,
    feedback: Feedback,
    /// Where hands are when the episode begins, from the root in its heading, m.
    hands: Vec<Vector3<f64>>,
    effort: Effort,
    memory: Memory,
    guide: Guide,
}

/// What says where the body shall be.
#[derive(Debug, Clone)]
enum Guide {
    /// The pose with which the episode begins.
    Pose,
    /// Something that moves, since that control step.
    Course {
        follower: Box<Follower>,
        since: u32,
    },
    Gait(Box<Gait>),
}

impl Controller {
    /// For holding `pose` (rad and m, in the order of the body's joints), with the root as it is now.
    fn new(present: &Present<'_>, pose: &[f64], hold: Hold) -> Result<Self, ControlError> {
        let &Present { body, model, state, workspace } = present;
        if body.muscles.is_empty() {
            return Err(ControlError::NoMuscles);
        }
        if pose.len() != body.joints.len() {
            return Err(ControlError::Pose { expected: body.joints.len(), found: pose.len() });
        }
        let mut support = Support::new(body);
        let moves = support.carriers(model).into_iter().flat_map(|foot| moving_dofs(model, foot).iter().copied());
        let legs: Vec<usize> = moves.filter(|&dof| model.dofs.body[dof] != body.root.body).collect();
        support.choose_stance(model, &workspace.kinematics);
        support.update(model, &workspace.kinematics);
        let com = workspace.kinematics.subtree_com[body.root.body];
        let offset = support.centre().map_or(Vector3::zeros(), |centre| com - centre);
        Ok(Self {
            hold,
            lead: Lead::default(),
            support,
            grips: Grips::new(model),
            offset,
            final_offset: offset * (1.0 - LEAN),
            feedback: Feedback::new(body, pose, &legs, state, &workspace.kinematics),
            hands: reach::at_rest(present),
            effort: Effort::EXACT,
            memory: Memory::new(Coordinates::new(model).len()),
            guide: Guide::Pose,
        })
    }

    /// Follows a course from control step `since` on, or holds the pose again.
    fn follow(&mut self, course: Option<Course>, since: u32, present: &Present<'_>) {
        self.guide = match course {
            Some(course) => {
                // Whatever foot the motion stands on.
                self.support = Support::new(present.body);
                let follower = Box::new(Follower::new(course, self.hold.duration(), present));
                Guide::Course { follower, since }
            }
            None => Guide::Pose,
        };
    }

    /// Goes on with the script that it follows, where it does, from that time of it, s.
    fn go_on_from(&mut self, start: f64) {
        if let Guide::Course { follower, .. } = &mut self.guide {
            follower.go_on_from(start);
        }
    }

    /// Walks from now on.
    fn walk(&mut self, present: &Present<'_>) -> Result<(), ControlError> {
        self.support = Support::new(present.body);
        self.support.update(present.model, &present.workspace.kinematics);
        self.guide = Guide::Gait(Box::new(Gait::new(present, &self.support)?));
        Ok(())
    }

    /// Shares forces out roughly from now on, in less time.
    fn make_rough(&mut self) {
        self.effort = Effort::ROUGH;
    }

    /// What of it a later action depends on: the offset of the centre of mass, where the search of the last allocation ended, and the step of a gait.
    fn memory(&self) -> (Vector3<f64>, &Memory, Option<&Gait>) {
        let gait = match &self.guide {
            Guide::Gait(gait) => Some(gait.as_ref()),
            Guide::Pose | Guide::Course { .. } => None,
        };
        (self.offset, &self.memory, gait)
    }

    /// Asks for the forces of control step `step`, for targets that are moved by `offsets`: they are then to be shared out.
    fn ask(&mut self, present: &Present<'_>, step: u32, offsets: &Offsets, scratch: &mut ControlScratch) {
        let &Present { body, model, state, workspace } = present;
        let ControlScratch { coordinates, wishes, muscles, reach, reaching, workspace: posed, .. } = scratch;
        let view = View { state, workspace, coordinates, hold: self.hold.duration() };
        self.support.update(model, &workspace.kinematics);
        self.offset += (view.hold / LEAN_TIME).at_most(1.0) * (self.final_offset - self.offset);
        let centre = self.support.centre();
        let near = |point: &Point| point.height < CONTACT_HEIGHT;
        let points = &self.support.points;
        let bearing = points.iter().copied().filter(near);
        match &mut self.guide {
            Guide::Course { follower, since } => {
                follower.advance(step.saturating_sub(*since), present, posed);
                let goal = &follower.goal;
                let feet = points.iter().copied().zip(goal.rests.iter().copied()).filter(|(point, _)| near(point));
                self.feedback.follow(&view, body, (feet, goal), offsets, wishes);
            }
            Guide::Pose => {
                let target = centre.map(|centre| centre + self.offset);
                self.feedback.hold(&view, body, (bearing, target), Carried::default(), offsets, wishes);
            }
            Guide::Gait(gait) => match gait.advance(present, points, &offsets.walk, (step, view.hold)) {
                Some(step) => self.feedback.walk(&view, body, (points, &step), offsets, wishes),
                None => {
                    let carried = gait.carried();
                    let target = centre.map(|centre| centre + turning::vector(&self.offset, carried.turned));
                    self.feedback.hold(&view, body, (bearing, target), carried, offsets, wishes);
                }
            },
        }
        self.grips.wish(present, wishes);
        reaching.wish((present, &view), &self.hands, &self.feedback, offsets, wishes);
        muscles.reach(self.hold, &state.activation, activation::excitation_range(body.excitation), reach);
    }

    /// Writes the action that gives the muscles' share.
    fn give(&self, present: &Present<'_>, scratch: &mut ControlScratch, action: &mut [f64]) {
        let &Present { body, state, .. } = present;
        let ControlScratch { muscles, reach, asked, .. } = scratch;
        let range = activation::excitation_range(body.excitation);
        muscles.excitations(self.lead, self.hold, &state.activation, (range, reach), asked);
        for (action, &excitation) in action.iter_mut().zip(&*asked) {
            *action = action_for(body.excitation, excitation);
        }
    }
}

/// Four forces of which every other one is a sum: of a grip.
fn tetrahedron() -> [Vector3<f64>; 4] {
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(Vector3::from)
}

/// The four edges of a linearised friction cone, each with a unit normal part.
fn friction_pyramid(point: &Point) -> [Vector3<f64>; 4] {
    let across = if point.normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = (across - point.normal * across.dot(&point.normal)).normalize();
    let second = point.normal.cross(&first);
    [first, -first, second, -second].map(|tangent| point.normal + FRICTION_SHARE * point.friction * tangent)
}
