//! Wrapped lengths are continuous where the model lets them be: every muscle is followed over every joint that leads, and each
//! jump of its length is found to the last digit.
//!
//! `MSK_UPDATE=1 cargo test --test parity wrap_jumps` writes what is found to `docs/wrap.md`; without it the page must be as found.

use crate::support;

use core::fmt::Write;
use msk_physics::model::{JointKind, Model};
use msk_physics::{State, Workspace, kinematics, tendons, velocities};
use msk_runtime::{
    body::Body,
    library::{BodyLibrary, BoundBody, FileLoader},
};
use std::path::Path;
use support::page;

/// Samples of a joint's range.
const STEPS: usize = 600;
/// What a smooth length may differ from its own slopes over one step, m.
const SMOOTH: f64 = 1e-5;
/// What counts as a jump, m.
const JUMP: f64 = 1e-6;

struct Follower<'a> {
    model: &'a Model,
    body: &'a Body,
    state: State<f64>,
    workspace: Workspace<f64>,
}

impl Follower<'_> {
    /// Lengths of all tendons and their slopes over the joint at `coordinate`, with what follows it.
    fn at(&mut self, joint: usize, coordinate: f64) -> [Vec<f64>; 2] {
        let joint = &self.body.joints[joint];
        self.state.position[joint.position] = coordinate;
        self.body.solve_couplings(self.model, &mut self.state.position);
        self.state.velocity.fill(0.0);
        self.state.velocity[joint.dof] = 1.0;
        self.body.solve_coupled_velocities(self.model, &self.state.position, &mut self.state.velocity);
        let Workspace { kinematics, tendons, velocities, .. } = &mut self.workspace;
        kinematics::update(self.model, &self.state, kinematics);
        tendons::update(&self.state, kinematics, tendons);
        velocities::update(self.model, &self.state, kinematics, velocities);
        tendons::update_velocities(&self.state, velocities, tendons);
        [tendons.length.clone(), tendons.velocity.clone()]
    }

    fn length(&mut self, joint: usize, coordinate: f64, tendon: usize) -> f64 {
        self.at(joint, coordinate)[0][tendon]
    }

    /// Geoms that the path of a tendon touches.
    fn touched(&mut self, joint: usize, coordinate: f64, tendon: usize) -> Vec<usize> {
        self.at(joint, coordinate);
        let vertices = tendons::path(self.model, &self.workspace.kinematics, tendon);
        let touch = |vertex: &tendons::PathVertex<f64>| match vertex.kind {
            tendons::VertexKind::Touch(geom) => Some(geom),
            _ => None,
        };
        vertices.iter().filter_map(touch).collect()
    }
}

#[test]
fn every_jump_of_a_length_over_a_joint_is_known() {
    let library = BodyLibrary::default();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/bodies/human.msk");
    let compilation = msk::compiler::compile(Path::new(file), &FileLoader, &library).unwrap_or_else(|report| panic!("{report}"));
    let BoundBody { model, body, .. } = library.bind(&compilation.bodies[0]).unwrap();
    let (model, body) = (&*model, &*body);
    let mut start = State::new(model);
    body.solve_couplings(model, &mut start.position);
    let mut follower = Follower { model, body, state: start.clone(), workspace: Workspace::new(model) };
    let mut jumps: Vec<(usize, usize, f64, f64, Vec<usize>)> = Vec::new();
    let mut followed = 0;
    for joint in (0..body.joints.len()).filter(|&joint| body.joints[joint].independent) {
        let [low, high] = body.joints[joint].range.unwrap_or([-3.0, 3.0]);
        follower.state.clone_from(&start);
        let coordinate = |step: usize| low + (high - low) * step as f64 / STEPS as f64;
        let mut before = follower.at(joint, low);
        let mut moved = vec![false; before[0].len()];
        for step in 1..=STEPS {
            let after = follower.at(joint, coordinate(step));
            let width = coordinate(step) - coordinate(step - 1);
            for tendon in 0..after[0].len() {
                moved[tendon] |= after[1][tendon] != 0.0;
                let expected = 0.5 * (before[1][tendon] + after[1][tendon]) * width;
                if (after[0][tendon] - before[0][tendon] - expected).abs() > SMOOTH {
                    jumps.extend(pin_down(&mut follower, joint, tendon, [coordinate(step - 1), coordinate(step)]));
                }
            }
            before = after;
        }
        followed += moved.iter().filter(|moved| **moved).count();
    }
    let text = report(model, body, followed, &mut jumps);
    page("wrap", &text);
}

/// Halves the interval around a suspicious change until nothing but a jump can be left of it.
fn pin_down(
    follower: &mut Follower<'_>,
    joint: usize,
    tendon: usize,
    mut bounds: [f64; 2],
) -> Option<(usize, usize, f64, f64, Vec<usize>)> {
    let mut lengths = bounds.map(|at| follower.length(joint, at, tendon));
    while bounds[1] - bounds[0] > 1e-10 {
        let middle = 0.5 * (bounds[0] + bounds[1]);
        let length = follower.length(joint, middle, tendon);
        let half = usize::from((length - lengths[0]).abs() > (lengths[1] - length).abs());
        (bounds[half], lengths[half]) = (middle, length);
    }
    let jump = lengths[1] - lengths[0];
    if jump.abs() < JUMP {
        return None;
    }
    let [before, after] = bounds.map(|at| follower.touched(joint, at, tendon));
    let mut changed: Vec<usize> = before.iter().filter(|geom| !after.contains(geom)).copied().collect();
    changed.extend(after.iter().filter(|geom| !before.contains(geom)));
    if changed.is_empty() {
        changed = after;
    }
    Some((tendon, joint, bounds[0], jump, changed))
}

fn report(model: &Model, body: &Body, followed: usize, jumps: &mut [(usize, usize, f64, f64, Vec<usize>)]) -> String {
    jumps.sort_by(|a, b| b.3.abs().total_cmp(&a.3.abs()).then(a.0.cmp(&b.0)).then(a.1.cmp(&b.1)));
    let tendons: std::collections::BTreeSet<usize> = jumps.iter().map(|jump| jump.0).collect();
    let wrapping = (0..model.tendons.name.len())
        .filter(|&tendon| {
            let points = &model.tendons.path_points[model.tendons.path[tendon].clone()];
            points.iter().any(|point| matches!(point, msk_physics::model::PathPoint::Wrap { .. }))
        })
        .count();
    let mut text = format!(
        "# Jumps of wrapped lengths\n\nWritten by `MSK_UPDATE=1 cargo test --test parity wrap_jumps`. Every joint that leads was moved over its range in {STEPS} steps, followers\n\
         with it, the others at their reference; {followed} pairs of a tendon and a joint that moves it were followed, {wrapping} tendons wrap.\n\
         A path is taken on the side of its side site; where it could slip off the other way, or a site comes to lie within its\n\
         obstacle, its length jumps. These jumps are the model's (MuJoCo 4.0.0 has the same lengths): {} in {} tendons.\n\n\
         | tendon | joint | at | jump, mm | obstacle |\n|---|---|---|---|---|\n",
        jumps.len(),
        tendons.len()
    );
    for (tendon, joint, at, jump, geoms) in jumps.iter() {
        let joint = &body.joints[*joint];
        let at =
            if joint.kind == JointKind::Slide { format!("{:.2} mm", at * 1e3) } else { format!("{:.2} deg", at.to_degrees()) };
        let geoms: Vec<&str> = geoms.iter().map(|&geom| model.geoms.name[geom].as_str()).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {at} | {:.3} | {} |",
            model.tendons.name[*tendon],
            joint.name,
            1e3 * jump,
            geoms.join(", ")
        );
    }
    text
}
