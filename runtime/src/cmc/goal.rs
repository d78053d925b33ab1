//! A goal that moves: where the body shall be at the end of a hold and how fast, from a motion or a script.
//!
//! A [`Course`] knows positions only. The body is placed where it shall be one hold ahead, two, and now; differences of the three
//! give velocities and accelerations, kinematics the centre of mass and how high each point of the feet is to be.

use super::{Present, support::Support};
use crate::body::Body;
use crate::script::Script;
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{State, Workspace, kinematics, rotation::difference};
use msk_program::init::Parts;
use msk_program::motion::{Motion, RootPart};
use msk_program::task::Init;
use nalgebra::Vector3;
use std::sync::Arc;

/// What a body follows over the time since the course began.
#[derive(Debug, Clone)]
pub(super) enum Course {
    /// A motion from a time of its own on; its path begins where the root stood.
    Motion {
        motion: Arc<Motion>,
        /// s.
        start: f64,
        parts: Parts,
        /// Joints that the motion does not move, and the turns that it does not contain.
        base: Box<Init>,
        /// From the table's root to where it was, m.
        shift: [f64; 3],
    },
    /// A script from a time of its own on, s, whose steps have the length `period`, s; its last keyframe is held.
    Script { script: Arc<Script>, start: f64, period: f64 },
}

impl Course {
    /// A motion that begins at `start` (s) of its table, for a body that stands as in `state`.
    pub fn of_motion(motion: &Arc<Motion>, start: f64, init: &Init, body: &Body, state: &State<f64>) -> Self {
        let joints = body.joints.iter().enumerate().filter(|(_, joint)| joint.independent);
        let parts = Parts {
            joints: joints.filter_map(|(index, joint)| Some((index, motion.joint(&joint.name)?))).collect(),
            root: RootPart::ALL.into_iter().filter(|part| motion.root(*part).is_some()).collect(),
            velocity: false,
        };
        let value = |part: RootPart| motion.root(part).map(|column| motion.value(column, start));
        let stood = body.root.free.map_or([0.0; 3], |(place, _)| [0, 1, 2].map(|axis| state.position[place + axis]));
        let begun = [RootPart::X, RootPart::Y, RootPart::Height].map(value);
        let shift = core::array::from_fn(|axis| stood[axis] - begun[axis].unwrap_or(0.0));
        let mut base = Box::new(init.clone());
        base.root.meets.clear();
        Self::Motion { motion: motion.clone(), start, parts, base, shift }
    }

    /// Puts everything where it shall be at `time` (s) since the course began.
    fn place(&self, time: f64, model: &Model, body: &Body, state: &mut State<f64>, workspace: &mut Workspace<f64>) {
        match self {
            Self::Motion { motion, start, parts, base, shift } => {
                let now = start + time;
                let mut init = Init::clone(base);
                parts.write(motion, now, &mut init);
                let value = |part: RootPart| motion.root(part).map_or(0.0, |column| motion.value(column, now));
                let at = [RootPart::X, RootPart::Y, RootPart::Height].map(value);
                init.root.position = [at[0] + shift[0], at[1] + shift[1]];
                init.root.height = Some(at[2] + shift[2]);
                body.place(model, &init.root, &init.coordinates, state, workspace);
            }
            Self::Script { script, start, period } => {
                let step = ((start + time) / period).at_least(0.0).at_most(f64::from(script.last()));
                // Where joints do not reach on the way, they are as near as they come: the body is to be there.
                let _as_near = script.place_between(step, model, body, state, workspace);
            }
        }
    }
}

/// Where the body shall be at a moment.
#[derive(Debug, Clone, Default)]
struct Frame {
    position: Vec<f64>,
    com: Vector3<f64>,
    /// Height of each point of the feet over the ground, m.
    heights: Vec<f64>,
}

/// Where the body shall be at the end of a hold, and how fast.
#[derive(Debug, Clone, Default)]
pub(super) struct Goal {
    /// In the order of the state's positions.
    pub position: Vec<f64>,
    /// Rates and their rates, in the same order; those of quaternions are without meaning.
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
    /// Angular velocity and acceleration of the root in its own axes, rad/s and rad/s².
    pub spin: Vector3<f64>,
    pub spin_rate: Vector3<f64>,
    pub com: Vector3<f64>,
    pub com_velocity: Vector3<f64>,
    pub com_acceleration: Vector3<f64>,
    /// Whether each point of the feet shall be on the ground, in the order of the support's points.
    pub rests: Vec<bool>,
}

/// A point of a foot that is to be nearer to the ground than this shall rest, m. Reference motions keep standing feet within 1 cm.
const RESTING: f64 = 0.012;

/// Follows a course, hold by hold.
#[derive(Debug, Clone)]
pub(super) struct Follower {
    course: Course,
    hold: f64,
    /// The next hold whose goal is wanted, and the frames before, at and after its end.
    next: Option<u32>,
    frames: [Frame; 3],
    support: Support,
    state: State<f64>,
    pub goal: Goal,
}

impl Follower {
    /// Follows `course` in holds of that length, s.
    pub fn new(course: Course, hold: f64, present: &Present<'_>) -> Self {
        Self {
            course,
            hold,
            next: None,
            frames: Default::default(),
            support: Support::new(present.body),
            state: present.state.clone(),
            goal: Goal::default(),
        }
    }

    /// Follows a script from now on at that time of it (s) and later.
    pub fn go_on_from(&mut self, time: f64) {
        if let Course::Script { start, .. } = &mut self.course {
            (*start, self.next) = (time, None);
        }
    }

    /// Fills the goal for the hold that begins now, `index` holds after the course began.
    pub fn advance(&mut self, index: u32, present: &Present<'_>, workspace: &mut Workspace<f64>) {
        if self.next == Some(index) {
            self.frames.rotate_left(1);
            self.frames[2] = self.frame(index + 2, present, workspace);
        } else {
            self.frames = [0, 1, 2].map(|ahead| self.frame(index + ahead, present, workspace));
        }
        self.next = Some(index + 1);
        self.fill(present);
    }

    fn frame(&mut self, holds: u32, present: &Present<'_>, workspace: &mut Workspace<f64>) -> Frame {
        let Present { body, model, .. } = *present;
        self.course.place(f64::from(holds) * self.hold, model, body, &mut self.state, workspace);
        kinematics::update(model, &self.state, &mut workspace.kinematics);
        self.support.update(model, &workspace.kinematics);
        Frame {
            position: self.state.position.clone(),
            com: workspace.kinematics.subtree_com[body.root.body],
            heights: self.support.points.iter().map(|point| point.height).collect(),
        }
    }

    fn fill(&mut self, present: &Present<'_>) {
        let ([before, at, after], hold, goal) = (&self.frames, self.hold, &mut self.goal);
        let triples = || before.position.iter().zip(&at.position).zip(&after.position).map(|((a, b), c)| [*a, *b, *c]);
        goal.position.clone_from(&at.position);
        goal.velocity = triples().map(|[before, _, after]| (after - before) / (2.0 * hold)).collect();
        goal.acceleration = triples().map(|[before, at, after]| (before - 2.0 * at + after) / (hold * hold)).collect();
        goal.com = at.com;
        goal.com_velocity = (after.com - before.com) / (2.0 * hold);
        goal.com_acceleration = (before.com - 2.0 * at.com + after.com) / (hold * hold);
        if let Some((place, _)) = present.body.root.free {
            let turned = |frame: &Frame| core::array::from_fn(|part| frame.position[place + 3 + part]);
            let (first, second) = (difference(&turned(at), &turned(before)), difference(&turned(after), &turned(at)));
            goal.spin = (first + second) / (2.0 * hold);
            goal.spin_rate = (second - first) / (hold * hold);
        }
        goal.rests.clear();
        goal.rests.extend(at.heights.iter().map(|height| *height < RESTING));
    }
}
