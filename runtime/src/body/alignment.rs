//! Places that are brought to others: by joints that reach, and by objects that are moved along.
//!
//! Joints reach by damped least squares (Levenberg 1944, Marquardt 1963): from the pose on, each step solves (JᵀJ + μ) Δq = Jᵀe for the
//! joints that are free, where e are the ways that are missing and J how they shrink. A joint at a limit takes part as long as it
//! moves away from it. Small damping gives the smallest change of the pose that leads there, so that redundant joints share it. Where
//! that ends in front of a limit, the search begins again in other corners of the joints' ranges: points of the sequence of Roberts (2018),
//! which fill any number of dimensions evenly.

use super::Body;
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{self as physics, State, Workspace, kinematics::Kinematics};
use msk_program::frame::Origin;
use msk_program::init::{Alignment, Moves};
use nalgebra::{Cholesky, DMatrix, DVector, Vector3};
use serde::{Deserialize, Serialize};

/// A landmark that its joints do not bring to its place.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[error(
    "`{landmark}` is still {:.1} cm from `{target}`, as near as its joints bring it; align it with more joints, or place the root nearer",
    distance * 100.0
)]
pub struct OutOfReach {
    /// The landmark.
    pub landmark: String,
    /// Where it should be.
    pub target: String,
    /// How far it is from there, m.
    pub distance: f64,
}

/// A place counts as reached this near to it, m.
const NEAR: f64 = 1e-3;
/// Steps end this near, m: well below what a test can see.
const EXACT: f64 = 1e-9;
/// Steps of a search. Arms and legs need less than ten where the way is free.
const STEPS: usize = 200;
/// How often a search that fails begins elsewhere.
const RESTARTS: usize = 30;
/// The damping with which it begins, its factors after better and worse steps, and where it ends in vain.
const DAMPING: f64 = 1e-3;
const BETTER: f64 = 0.2;
const WORSE: f64 = 5.0;
const LEAST_DAMPING: f64 = 1e-9;
const MOST_DAMPING: f64 = 1e8;

/// Where the search for joint coordinates starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InitialGuess {
    /// At the pose that is given, which is near what is looked for.
    Pose,
    /// At the pose that is given, then anywhere within their ranges.
    Anywhere,
}

impl Body {
    /// Brings everything to its place that is aligned, from a state in which all else is in its own: first joints, together, then
    /// objects one after the other. Velocities stay.
    ///
    /// # Errors
    /// A place that joints do not reach; they have then come as near as they can.
    pub fn align(
        &self,
        model: &Model,
        alignments: &[Alignment],
        guess: InitialGuess,
        state: &mut State<f64>,
        workspace: &mut Workspace<f64>,
    ) -> Result<(), OutOfReach> {
        if alignments.is_empty() {
            return Ok(());
        }
        let kinematics = &mut workspace.kinematics;
        let reaching: Vec<&Alignment> = alignments.iter().filter(|known| matches!(known.moves, Moves::Joints(_))).collect();
        let reached = match reaching.is_empty() {
            true => Ok(()),
            false => Reaching::new(self, model, &reaching).reach(guess, state, kinematics),
        };
        for alignment in alignments {
            let Moves::Object(object) = alignment.moves else { continue };
            let Some((place, _)) = self.objects.get(object).and_then(|object| object.free) else { continue };
            physics::kinematics::update(model, state, kinematics);
            let missing = self.way(alignment, kinematics);
            state.position[place..place + 3].iter_mut().zip(missing.iter()).for_each(|(coordinate, shift)| *coordinate += shift);
        }
        reached
    }

    /// The way from where a landmark is to where it shall be, m.
    fn way(&self, alignment: &Alignment, kinematics: &Kinematics<f64>) -> Vector3<f64> {
        self.place_of(kinematics, &alignment.target) - self.landmark_position(kinematics, alignment.landmark)
    }
}

/// A search for coordinates of joints that bring landmarks to their places.
struct Reaching<'a> {
    body: &'a Body,
    model: &'a Model,
    alignments: &'a [&'a Alignment],
    /// The joints that move, each once, by their places among the body's.
    joints: Vec<usize>,
}

/// Ways that are missing, and their squared length, m².
struct Missing {
    ways: Vec<Vector3<f64>>,
    cost: f64,
}

impl Missing {
    /// What is farthest from its place, by the place of its alignment, and how far, m.
    fn farthest(&self) -> Option<(usize, f64)> {
        let distances = self.ways.iter().map(Vector3::norm).enumerate();
        distances.max_by(|(_, one), (_, other)| one.total_cmp(other))
    }

    fn is_reached(&self) -> bool {
        self.farthest().is_none_or(|(_, distance)| distance <= NEAR)
    }
}

impl<'a> Reaching<'a> {
    fn new(body: &'a Body, model: &'a Model, alignments: &'a [&'a Alignment]) -> Self {
        let named = alignments.iter().flat_map(|alignment| match &alignment.moves {
            Moves::Joints(joints) => joints.as_slice(),
            Moves::Object(_) => &[],
        });
        let mut joints: Vec<usize> = named.copied().filter(|joint| *joint < body.joints.len()).collect();
        joints.sort_unstable();
        joints.dedup();
        Self { body, model, alignments, joints }
    }

    /// Reaches from the pose on, or from elsewhere; where nothing leads there, comes as near as it can.
    fn reach(&self, guess: InitialGuess, state: &mut State<f64>, kinematics: &mut Kinematics<f64>) -> Result<(), OutOfReach> {
        let pose = state.position.clone();
        let mut nearest = self.search(state, kinematics);
        let mut found = state.position.clone();
        let restarts = if guess == InitialGuess::Anywhere { RESTARTS } else { 0 };
        for restart in 1..=restarts {
            if nearest.is_reached() {
                break;
            }
            state.position.copy_from_slice(&pose);
            self.spread(restart, state);
            let missing = self.search(state, kinematics);
            if missing.cost < nearest.cost {
                nearest = missing;
                found.copy_from_slice(&state.position);
            }
        }
        state.position = found;
        match nearest.farthest().filter(|_| !nearest.is_reached()) {
            None => Ok(()),
            Some((place, distance)) => Err(self.out_of_reach(self.alignments[place], distance)),
        }
    }

    /// Puts the joints where the sequence has its point of this number within their ranges.
    fn spread(&self, point: usize, state: &mut State<f64>) {
        // The positive root of x^(d+1) = x + 1, by iteration, for d joints.
        let exponent = 1.0 / (self.joints.len() as f64 + 1.0);
        let root = (0..64).fold(2.0, |root: f64, _| libm::pow(1.0 + root, exponent));
        let mut share = 1.0;
        for &joint in &self.joints {
            let joint = &self.body.joints[joint];
            share /= root;
            let [low, high] = joint.range.unwrap_or([-core::f64::consts::PI, core::f64::consts::PI]);
            let along = 0.5 + share * point as f64;
            state.position[joint.position] = low + (high - low) * (along - libm::floor(along));
        }
        self.body.solve_couplings(self.model, &mut state.position);
    }

    /// Steps downhill to where no step leads nearer.
    fn search(&self, state: &mut State<f64>, kinematics: &mut Kinematics<f64>) -> Missing {
        let mut missing = self.missing(state, kinematics);
        let mut damping = DAMPING;
        for _ in 0..STEPS {
            if missing.cost <= EXACT * EXACT || damping > MOST_DAMPING {
                break;
            }
            let before = state.position.clone();
            let step = self.step(state, kinematics, &missing, damping);
            for (&joint, change) in self.joints.iter().zip(step) {
                let joint = &self.body.joints[joint];
                let [low, high] = joint.range.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                let coordinate = &mut state.position[joint.position];
                *coordinate = (*coordinate + change).clip(low, high);
            }
            self.body.solve_couplings(self.model, &mut state.position);
            let after = self.missing(state, kinematics);
            if after.cost < missing.cost {
                missing = after;
                damping = (damping * BETTER).at_least(LEAST_DAMPING);
            } else {
                state.position = before;
                damping *= WORSE;
                // What follows reads the frames of the present coordinates.
                physics::kinematics::update(self.model, state, kinematics);
            }
        }
        missing
    }

    fn missing(&self, state: &State<f64>, kinematics: &mut Kinematics<f64>) -> Missing {
        physics::kinematics::update(self.model, state, kinematics);
        let ways: Vec<Vector3<f64>> = self.alignments.iter().map(|alignment| self.body.way(alignment, kinematics)).collect();
        let cost = ways.iter().map(Vector3::norm_squared).sum();
        Missing { ways, cost }
    }

    /// The change of each joint; none where a limit is in the way.
    fn step(&self, state: &State<f64>, kinematics: &Kinematics<f64>, missing: &Missing, damping: f64) -> Vec<f64> {
        let columns = self.columns(state, kinematics);
        let inner = |a: &[Vector3<f64>], b: &[Vector3<f64>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let downhill: Vec<f64> = columns.iter().map(|column| inner(column, &missing.ways)).collect();
        let is_free = |place: &usize| {
            let joint = &self.body.joints[self.joints[*place]];
            let coordinate = state.position[joint.position];
            joint.range.is_none_or(|[low, high]| {
                !(coordinate <= low && downhill[*place] < 0.0 || coordinate >= high && downhill[*place] > 0.0)
            })
        };
        let free: Vec<usize> = (0..self.joints.len()).filter(is_free).collect();
        let normal = DMatrix::from_fn(free.len(), free.len(), |row, column| {
            inner(&columns[free[row]], &columns[free[column]]) + if row == column { damping } else { 0.0 }
        });
        let right = DVector::from_iterator(free.len(), free.iter().map(|&place| downhill[place]));
        let mut step = vec![0.0; self.joints.len()];
        if let Some(factor) = Cholesky::new(normal) {
            let solution = factor.solve(&right);
            free.iter().zip(solution.iter()).for_each(|(&place, change)| step[place] = *change);
        }
        step
    }

    /// For each joint, with those that follow it, how much each way shrinks as it moves: m per rad, or m per m.
    fn columns(&self, state: &State<f64>, kinematics: &Kinematics<f64>) -> Vec<Vec<Vector3<f64>>> {
        let (body, model) = (self.body, self.model);
        let mut rotations = vec![Vector3::zeros(); model.nv];
        let mut moved_by_dofs = |landmark: usize| {
            let (known, mut moves) = (&body.landmarks[landmark], vec![Vector3::zeros(); model.nv]);
            let point = body.landmark_position(kinematics, landmark);
            physics::jacobian::point_jacobian(model, kinematics, known.body, &point, &mut moves, &mut rotations);
            moves
        };
        let shrinking: Vec<Vec<Vector3<f64>>> = self
            .alignments
            .iter()
            .map(|alignment| {
                let mut own = moved_by_dofs(alignment.landmark);
                if let Origin::Landmark(target, _) = alignment.target {
                    own.iter_mut().zip(moved_by_dofs(target)).for_each(|(own, target)| *own -= target);
                }
                own
            })
            .collect();
        let mut rates = vec![0.0; model.nv];
        let column = |&joint: &usize| {
            rates.fill(0.0);
            rates[body.joints[joint].dof] = 1.0;
            body.solve_coupled_velocities(model, &state.position, &mut rates);
            let along = |moves: &Vec<Vector3<f64>>| {
                moves.iter().zip(&rates).filter(|(_, rate)| **rate != 0.0).map(|(moves, rate)| moves * *rate).sum()
            };
            shrinking.iter().map(along).collect()
        };
        self.joints.iter().map(column).collect()
    }

    fn out_of_reach(&self, alignment: &Alignment, distance: f64) -> OutOfReach {
        let name = |landmark: usize| self.body.landmarks[landmark].name.clone();
        let target = match alignment.target {
            Origin::Landmark(landmark, _) => name(landmark),
            Origin::World([x, y, z]) => format!("[{x:.3} m, {y:.3} m, {z:.3} m]"),
        };
        OutOfReach { landmark: name(alignment.landmark), target, distance }
    }
}
