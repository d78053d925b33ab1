//! One muscle over the sweep of one joint: its path, where it wraps, how long it is and how it turns the joint.

use crate::body::coupling;
use core::f64::consts::PI;
use msk_physics::model::{ElasticTendons, JointKind, Model, Muscle};
use msk_physics::scalar::Real;
use msk_physics::tendons::{PathVertex, VertexKind, path};
use msk_physics::{State, Workspace, kinematics, moment_arms, tendons};
use serde::Serialize;

/// What was asked for cannot be swept.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SweepError {
    /// No muscle of that name.
    #[error("the model has no muscle `{name}`{}", hint(.nearest))]
    Muscle {
        /// The name.
        name: String,
        /// The name most like it.
        nearest: Option<String>,
    },
    /// No hinge or slide of that name.
    #[error("the model has no hinge or slide `{name}`{}", hint(.nearest))]
    Joint {
        /// The name.
        name: String,
        /// The name most like it.
        nearest: Option<String>,
    },
    /// A joint that follows another.
    #[error("joint `{joint}` is coupled to another joint; sweep the independent one, `{leader}`")]
    Follower {
        /// The joint.
        joint: String,
        /// The joint it follows.
        leader: String,
    },
    /// The couplings of the model cannot be solved.
    #[error("the couplings of these joints are cyclic: {}", .joints.join(", "))]
    CircularCouplings {
        /// The joints.
        joints: Vec<String>,
    },
}

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

/// A muscle over a joint's sweep. Lengths in m, angles in rad.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MuscleSweep {
    /// Name of the muscle.
    pub muscle: String,
    /// Name of its tendon.
    pub tendon: String,
    /// Name of the joint.
    pub joint: String,
    /// Unit of the joint's coordinate: `rad` or `m`.
    pub unit: &'static str,
    /// Joints that follow it by couplings and move with it.
    pub followers: Vec<String>,
    /// Peak isometric force, N.
    pub peak_force: f64,
    /// Optimal fibre length.
    pub optimal_fibre_length: f64,
    /// Tendon slack length; negative where the operating range puts it there.
    pub tendon_slack_length: f64,
    /// Length that stretches where tendons are elastic: the slack length, or what takes its place where there is none.
    pub stretching_length: f64,
    /// Smallest and largest fibre length of the sweep, in optimal lengths, tendons taken rigid.
    pub fibre_range: [f64; 2],
    /// The path at the configuration the sweep starts from, point by point.
    pub path: Vec<PathPoint>,
    /// The sweep, from the lower end of the joint's range to the upper.
    pub samples: Vec<Sample>,
}

/// A point of a path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathPoint {
    /// What the path does there: `start`, `site`, `touch` or `leave`.
    pub kind: &'static str,
    /// The site or the geom.
    pub at: String,
    /// The body that carries it.
    pub body: String,
    /// World position.
    pub position: [f64; 3],
    /// Length from the previous point along the path, on the surface between `touch` and `leave`.
    pub length: f64,
}

/// One configuration of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sample {
    /// The joint's coordinate.
    pub coordinate: f64,
    /// Length of the path.
    pub length: f64,
    /// Moment arm -dL/dq of the joint with all that follows it: m per rad, or a pure number for a slide. Positive where the
    /// muscle's pull drives the joint towards larger coordinates.
    pub moment_arm: f64,
    /// The part of it by the joint alone, followers held.
    pub own_moment_arm: f64,
    /// Fibre length in optimal lengths, the tendon taken rigid.
    pub fibre: f64,
    /// Every obstacle of the path, in its order: its geom, and the length on it, 0 where the path passes it by.
    pub wraps: Vec<Wrap>,
}

/// An obstacle of a path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Wrap {
    /// The geom.
    pub geom: String,
    /// Whether the path touches it.
    pub touches: bool,
    /// Length on its surface.
    pub arc: f64,
}

/// Sweeps `joint` over its range in `steps` equal steps from the configuration of `state`, couplings solved, and looks at
/// `muscle`.
///
/// # Errors
/// Names that do not exist, a joint that follows another, couplings that cannot be solved.
pub fn sweep_muscle(
    model: &Model,
    state: &State<f64>,
    muscle: &str,
    joint: &str,
    steps: usize,
) -> Result<MuscleSweep, SweepError> {
    let (index, figures) = find(&model.actuators.name, muscle)
        .and_then(|index| Some((index, model.actuators.muscle(index)?)))
        .ok_or_else(|| SweepError::Muscle { name: muscle.into(), nearest: nearest(muscle, &model.actuators.name) })?;
    let moving = find(&model.joints.name, joint)
        .filter(|&joint| matches!(model.joints.kind[joint], JointKind::Hinge | JointKind::Slide))
        .ok_or_else(|| SweepError::Joint { name: joint.into(), nearest: nearest(joint, &model.joints.name) })?;
    let couplings = &model.couplings;
    if let Some(coupling) = couplings.joint.iter().position(|&follower| follower == moving)
        && let Some(leader) = couplings.leader[coupling]
    {
        return Err(SweepError::Follower { joint: joint.into(), leader: model.joints.name[leader].clone() });
    }
    let order = coupling::order(model).map_err(|joints| SweepError::CircularCouplings { joints })?;
    let mut sweep =
        Sweep { model, order, muscle: index, figures, joint: moving, state: state.clone(), workspace: Workspace::new(model) };
    Ok(sweep.run(steps.max(1)))
}

fn find(names: &[String], name: &str) -> Option<usize> {
    names.iter().position(|known| known == name)
}

fn nearest(name: &str, known: &[String]) -> Option<String> {
    let likeness = |candidate: &&String| strsim::jaro_winkler(name, candidate);
    known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).filter(|best| likeness(best) > 0.75).cloned()
}

struct Sweep<'a> {
    model: &'a Model,
    order: Vec<usize>,
    muscle: usize,
    figures: Muscle,
    joint: usize,
    state: State<f64>,
    workspace: Workspace<f64>,
}

impl Sweep<'_> {
    fn run(&mut self, steps: usize) -> MuscleSweep {
        let model = self.model;
        let [low, high] = model.joints.range[self.joint].unwrap_or(match model.joints.kind[self.joint] {
            JointKind::Slide => [-0.1, 0.1],
            _ => [-PI, PI],
        });
        self.place(self.state.position[model.joints.position_address[self.joint]]);
        let points = self.path().iter().map(|vertex| self.point(vertex)).collect();
        let share = |step: usize| step as f64 / steps as f64;
        let samples: Vec<Sample> = (0..=steps).map(|step| self.sample(low + (high - low) * share(step))).collect();
        let (optimal, slack) = self.workspace.actuation.lengths(self.muscle);
        let fibres = || samples.iter().map(|sample| sample.fibre);
        MuscleSweep {
            muscle: model.actuators.name[self.muscle].clone(),
            tendon: model.tendons.name[self.tendon()].clone(),
            joint: model.joints.name[self.joint].clone(),
            unit: if model.joints.kind[self.joint] == JointKind::Slide { "m" } else { "rad" },
            followers: self.followers(),
            peak_force: self.workspace.actuation.peak_force(self.muscle),
            optimal_fibre_length: optimal,
            tendon_slack_length: slack,
            stretching_length: model
                .elastic_tendons
                .as_ref()
                .unwrap_or(&ElasticTendons::default())
                .stretching_length(slack, model.actuators.length_range[self.muscle]),
            fibre_range: [fibres().fold(f64::INFINITY, Real::at_most), fibres().fold(f64::NEG_INFINITY, Real::at_least)],
            path: points,
            samples,
        }
    }

    fn tendon(&self) -> usize {
        self.figures.tendon
    }

    /// Joints that move with the swept one.
    fn followers(&self) -> Vec<String> {
        let couplings = &self.model.couplings;
        let mut moving = vec![self.joint];
        for &coupling in &self.order {
            if couplings.leader[coupling].is_some_and(|leader| moving.contains(&leader)) {
                moving.push(couplings.joint[coupling]);
            }
        }
        moving[1..].iter().map(|&joint| self.model.joints.name[joint].clone()).collect()
    }

    /// Puts the joint at a coordinate, and its followers where their couplings want them.
    fn place(&mut self, coordinate: f64) {
        let model = self.model;
        self.state.position[model.joints.position_address[self.joint]] = coordinate;
        coupling::solve(model, &self.order, &mut self.state.position);
        kinematics::update(model, &self.state, &mut self.workspace.kinematics);
        tendons::update(&self.state, &self.workspace.kinematics, &mut self.workspace.tendons);
    }

    fn path(&self) -> Vec<PathVertex<f64>> {
        path(self.model, &self.workspace.kinematics, self.tendon())
    }

    fn point(&self, vertex: &PathVertex<f64>) -> PathPoint {
        let (sites, geoms) = (&self.model.sites, &self.model.geoms);
        let (kind, at, body) = match vertex.kind {
            VertexKind::Start(site) => ("start", &sites.name[site], sites.body[site]),
            VertexKind::Site(site) => ("site", &sites.name[site], sites.body[site]),
            VertexKind::Touch(geom) => ("touch", &geoms.name[geom], geoms.body[geom]),
            VertexKind::Leave(geom) => ("leave", &geoms.name[geom], geoms.body[geom]),
        };
        let body = self.model.bodies.name[body].clone();
        PathPoint { kind, at: at.clone(), body, position: vertex.position.into(), length: vertex.length }
    }

    fn sample(&mut self, coordinate: f64) -> Sample {
        self.place(coordinate);
        let (model, tendon) = (self.model, self.tendon());
        let mut row = vec![0.0; model.nv];
        moment_arms(model, &self.workspace.kinematics, &self.workspace.tendons, tendon, &mut row);
        // Velocities at which the followers keep up with a unit velocity of the joint.
        let mut velocity = vec![0.0; model.nv];
        let dof = model.joints.dof_address[self.joint];
        velocity[dof] = 1.0;
        coupling::solve_velocities(model, &self.order, &self.state.position, &mut velocity);
        let gear = self.figures.gear;
        let rate: f64 = row.iter().zip(&velocity).map(|(arm, velocity)| arm * velocity).sum();
        let length = self.workspace.tendons.length[tendon] * gear;
        let (optimal, slack) = self.workspace.actuation.lengths(self.muscle);
        Sample {
            coordinate,
            length,
            moment_arm: -gear * rate,
            own_moment_arm: -gear * row[dof],
            fibre: (length - slack) / optimal,
            wraps: self.wraps(),
        }
    }

    /// The obstacles of the path, touched or not.
    fn wraps(&self) -> Vec<Wrap> {
        use msk_physics::model::PathPoint::Wrap as WrappingSurface;
        let (model, vertices) = (self.model, self.path());
        let points = &model.tendons.path_points[model.tendons.path[self.tendon()].clone()];
        let mut touched = vertices.iter().filter_map(|vertex| match vertex.kind {
            VertexKind::Leave(geom) => Some((geom, vertex.length)),
            _ => None,
        });
        let mut next = touched.next();
        let mut wraps = Vec::new();
        for point in points {
            let WrappingSurface { geom, .. } = *point else { continue };
            // Obstacles are touched in their order, some not at all.
            let arc = next.filter(|(touched, _)| *touched == geom).map(|(_, arc)| arc);
            if arc.is_some() {
                next = touched.next();
            }
            wraps.push(Wrap { geom: model.geoms.name[geom].clone(), touches: arc.is_some(), arc: arc.unwrap_or(0.0) });
        }
        wraps
    }
}
