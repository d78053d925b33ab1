//! A script: what is shown when.
//!
//! Every number goes smoothly from keyframe to keyframe: a cubic between two, with the slopes of Fritsch and Carlson (1980), so that
//! nothing overshoots, comes to rest where it turns round and at both ends. Coupled joints follow their couplings at every
//! step. Between two keyframes on the ground the body stays on it; between two that align the same places these stay aligned.
//! Where a motion is played, its table gives where joints and root are from one keyframe to the next.

use crate::body::{Body, InitialGuess, OutOfReach};
use msk_physics::model::{Model, rotation};
use msk_physics::{State, Workspace};
use msk_program::frame::Origin;
use msk_program::init::{Alignment, Following, Moves};
use msk_program::task::{CompiledTask, Init, ObjectStart, RootPlacement, TaskState};
use msk_program::testing::Keyframe;

/// How the root is placed.
#[derive(Debug, Clone, PartialEq)]
enum Hold {
    /// On the ground.
    Ground,
    /// Where the script sets it.
    Free,
    /// So that landmarks are in their places.
    Meets(Vec<(usize, Origin)>),
}

/// A keyframe as a row of numbers: joints, [`Root`], activation, objects.
#[derive(Debug, Clone)]
struct Row {
    step: f64,
    values: Vec<f64>,
    /// Change per step of each.
    slopes: Vec<f64>,
    hold: Hold,
    /// What is aligned.
    alignments: Vec<Alignment>,
    /// What is followed up to the next row.
    playing: Option<Playing>,
}

/// A motion that is played: what it moves is taken from it, all else from the beginning of the play.
#[derive(Debug, Clone)]
struct Playing {
    base: Init,
    following: Following,
    /// At which phase the motion was entered.
    phase: f64,
}

/// What is shown when.
#[derive(Debug, Clone)]
pub struct Script {
    rows: Vec<Row>,
    joints: usize,
    objects: Vec<usize>,
    /// Length of a step, s.
    period: f64,
}

/// Numbers of the root in a row: place (3), lift, heading, pitch, roll.
const ROOT: usize = 7;
/// Numbers of an object in a row: place and orientation.
const OBJECT: usize = 7;

impl Script {
    /// The script of keyframes, with what was drawn for the episode.
    ///
    /// # Errors
    /// A keyframe in which joints do not reach what they are aligned to.
    pub fn new(
        keyframes: &[Keyframe],
        task: &CompiledTask,
        drawn: &TaskState,
        model: &Model,
        body: &Body,
        workspace: &mut Workspace<f64>,
    ) -> Result<Self, OutOfReach> {
        let objects = keyframes.first().map_or(Vec::new(), |key| key.init.objects.iter().map(|start| start.object).collect());
        let period = 1.0 / task.control_frequency;
        let mut script = Self { rows: Vec::new(), joints: body.joints.len(), objects, period };
        for key in keyframes {
            let init = task.settled(&key.init, drawn);
            let hold = match (&init.root.height, init.root.meets.is_empty()) {
                (_, false) => Hold::Meets(init.root.meets.clone()),
                (None, true) => Hold::Ground,
                (Some(_), true) => Hold::Free,
            };
            let mut values = script.numbers(&init, key.activation, model, body, workspace)?;
            script.turn_alike(&mut values);
            let slopes = vec![0.0; values.len()];
            let playing = key.init.follows.clone().filter(|_| key.plays).map(|following| {
                let phase = task.entered(following.start, drawn);
                Playing { base: init.into_owned(), following, phase }
            });
            let alignments = key.init.alignments.clone();
            script.rows.push(Row { step: f64::from(key.step), values, slopes, hold, alignments, playing });
        }
        script.smooth();
        Ok(script)
    }

    /// A keyframe as numbers: the root, joints and objects are where alignments and the ground have brought them.
    fn numbers(
        &self,
        init: &Init,
        activation: f64,
        model: &Model,
        body: &Body,
        workspace: &mut Workspace<f64>,
    ) -> Result<Vec<f64>, OutOfReach> {
        let mut state = State::new(model);
        put(&init.coordinates, &init.root, init.objects.iter().copied(), model, body, &mut state, workspace);
        body.align(model, &init.alignments, InitialGuess::Anywhere, &mut state, workspace)?;
        let (mut values, root) = (init.coordinates.clone(), &init.root);
        values.resize(self.joints, 0.0);
        for alignment in &init.alignments {
            let Moves::Joints(joints) = &alignment.moves else { continue };
            joints.iter().for_each(|&joint| values[joint] = state.position[body.joints[joint].position]);
        }
        let place = |first: usize| [0, 1, 2].map(|axis| state.position[first + axis]);
        values.extend(body.root.free.map_or([0.0; 3], |(first, _)| place(first)));
        values.extend([root.lift, root.heading, root.pitch, root.roll, activation]);
        for start in &init.objects {
            let aligned = init.alignments.iter().any(|alignment| alignment.moves == Moves::Object(start.object));
            let free = body.objects.get(start.object).and_then(|object| object.free).filter(|_| aligned);
            values.extend(free.map_or(start.position, |(first, _)| place(first)));
            values.extend(start.orientation);
        }
        Ok(values)
    }

    /// Turns quaternions the same way round as in the row before.
    fn turn_alike(&self, values: &mut [f64]) {
        let Some(before) = self.rows.last() else { return };
        for object in 0..self.objects.len() {
            let first = self.joints + ROOT + 1 + object * OBJECT + 3;
            let along: f64 = (first..first + 4).map(|place| values[place] * before.values[place]).sum();
            if along < 0.0 {
                values[first..first + 4].iter_mut().for_each(|value| *value = -*value);
            }
        }
    }

    /// Slopes at inner keyframes: none where a number turns round, else the harmonic mean of those beside, by their lengths.
    fn smooth(&mut self) {
        for place in 1..self.rows.len().saturating_sub(1) {
            let [before, here, after] = [&self.rows[place - 1], &self.rows[place], &self.rows[place + 1]];
            let (left, right) = (here.step - before.step, after.step - here.step);
            let slope = |number: usize| {
                let first = (here.values[number] - before.values[number]) / left;
                let second = (after.values[number] - here.values[number]) / right;
                if first * second <= 0.0 {
                    return 0.0;
                }
                let (w1, w2) = (2.0 * right + left, right + 2.0 * left);
                (w1 + w2) / (w1 / first + w2 / second)
            };
            let slopes = (0..here.values.len()).map(slope).collect();
            self.rows[place].slopes = slopes;
        }
    }

    /// The keyframes as rows of numbers, with their steps: joints, the root's place (m), lift, heading, pitch and roll, activation, then
    /// place and orientation of every free object. SI units.
    pub fn rows(&self) -> impl Iterator<Item = (u32, &[f64])> {
        self.rows.iter().map(|row| (row.step as u32, row.values.as_slice()))
    }

    /// The step of the last keyframe.
    pub fn last(&self) -> u32 {
        self.rows.last().map_or(0, |row| row.step as u32)
    }

    /// Puts everything where it is at a step; velocities become zero. Gives the activation.
    ///
    /// # Errors
    /// Joints that do not reach, on the way from keyframe to keyframe, what they are aligned to; they are as near as they come.
    pub fn place(
        &self,
        step: u32,
        model: &Model,
        body: &Body,
        state: &mut State<f64>,
        workspace: &mut Workspace<f64>,
    ) -> Result<f64, OutOfReach> {
        self.place_between(f64::from(step), model, body, state, workspace)
    }

    /// The same between two steps.
    ///
    /// # Errors
    /// As above.
    pub fn place_between(
        &self,
        step: f64,
        model: &Model,
        body: &Body,
        state: &mut State<f64>,
        workspace: &mut Workspace<f64>,
    ) -> Result<f64, OutOfReach> {
        if let Some((row, playing)) = self.played(step) {
            let mut init = playing.base.clone();
            playing.following.write(playing.phase, (step - row.step) * self.period, &mut init);
            (init.root.velocity, init.root.spin) = ([0.0; 3], [0.0; 3]);
            put(&init.coordinates, &init.root, init.objects.iter().copied(), model, body, state, workspace);
            body.align(model, &init.alignments, InitialGuess::Pose, state, workspace)?;
            return Ok(row.values[self.joints + ROOT]);
        }
        let Shown { values, hold, alignments } = self.at(step);
        let (joints, rest) = values.split_at(self.joints);
        let (root, rest) = rest.split_at(ROOT);
        let (activation, objects) = rest.split_first().map_or((0.0, rest), |(activation, objects)| (*activation, objects));
        let starts = self.objects.iter().zip(objects.chunks_exact(OBJECT)).map(|(&object, numbers)| ObjectStart {
            object,
            position: [numbers[0], numbers[1], numbers[2]],
            orientation: rotation::normalized([numbers[3], numbers[4], numbers[5], numbers[6]]).unwrap_or(rotation::IDENTITY),
            velocity: [0.0; 3],
            spin: [0.0; 3],
        });
        let placement = RootPlacement {
            height: (hold == Hold::Free).then_some(root[2]),
            lift: root[3],
            position: [root[0], root[1]],
            heading: root[4],
            pitch: root[5],
            roll: root[6],
            velocity: [0.0; 3],
            spin: [0.0; 3],
            meets: if let Hold::Meets(meets) = hold { meets } else { Vec::new() },
        };
        put(joints, &placement, starts, model, body, state, workspace);
        body.align(model, &alignments, InitialGuess::Pose, state, workspace)?;
        Ok(activation)
    }

    /// The motion that is followed at a step, with the row at which it began to play.
    fn played(&self, step: f64) -> Option<(&Row, &Playing)> {
        let after = self.rows.partition_point(|row| row.step <= step);
        let row = self.rows.get(after.checked_sub(1)?)?;
        Some((row, row.playing.as_ref()?))
    }

    /// What is shown at a step that follows no motion.
    fn at(&self, step: f64) -> Shown {
        let after = self.rows.partition_point(|row| row.step <= step);
        let (Some(before), after) = (after.checked_sub(1).map(|place| &self.rows[place]), self.rows.get(after)) else {
            return Shown { values: Vec::new(), hold: Hold::Free, alignments: Vec::new() };
        };
        let Some(after) = after.filter(|_| step > before.step) else {
            // The numbers of a keyframe are those of what is aligned.
            return Shown { values: before.values.clone(), hold: before.hold.clone(), alignments: Vec::new() };
        };
        let length = after.step - before.step;
        let u = (step - before.step) / length;
        let (u2, u3) = (u * u, u * u * u);
        let blend = |number: usize| {
            let (start, end) = (before.values[number], after.values[number]);
            let (leaving, arriving) = (before.slopes[number] * length, after.slopes[number] * length);
            start + (3.0 * u2 - 2.0 * u3) * (end - start) + (u3 - 2.0 * u2 + u) * leaving + (u3 - u2) * arriving
        };
        let hold = if before.hold == after.hold { before.hold.clone() } else { Hold::Free };
        let stays = |alignment: &&Alignment| after.alignments.contains(alignment);
        let alignments = before.alignments.iter().filter(stays).cloned().collect();
        Shown { values: (0..before.values.len()).map(blend).collect(), hold, alignments }
    }
}

/// What is shown at a moment.
struct Shown {
    /// As those of a [`Row`].
    values: Vec<f64>,
    hold: Hold,
    /// What is aligned still, because it is at the keyframes before and after.
    alignments: Vec<Alignment>,
}

fn put(
    coordinates: &[f64],
    root: &RootPlacement,
    objects: impl Iterator<Item = ObjectStart>,
    model: &Model,
    body: &Body,
    state: &mut State<f64>,
    workspace: &mut Workspace<f64>,
) {
    for start in objects {
        let Some((place, _)) = body.objects.get(start.object).and_then(|object| object.free) else { continue };
        state.position[place..place + 3].copy_from_slice(&start.position);
        state.position[place + 3..place + 7].copy_from_slice(&start.orientation);
    }
    body.place(model, root, coordinates, state, workspace);
}
