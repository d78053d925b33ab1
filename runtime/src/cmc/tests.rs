//! The controller on the human body: it stands, also when pushed, and its answers are the same every time.

use super::coordinates::Slopes;
use super::dynamics::Dynamics;
use super::share::Share;
use super::{ControlScratch, Controller, Coordinates, Hold, Offsets, Present, Walk, activation};
use crate::bodies;
use crate::body::Body;
use msk_physics::lanes::Lanes;
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{self as physics, LaneGroup, Plan, State, Workspace};
use msk_program::body::{Axis, BodyDescription, ExcitationMap, LandmarkDescription};
use msk_program::task::RootPlacement;
use nalgebra::{Vector2, Vector3};
use std::path::Path;
use std::sync::Arc;

const HOLD: Hold = Hold { steps: 10, timestep: 1e-3 };

/// The human, standing on the floor in the neutral posture with silent muscles.
#[derive(Clone)]
struct Stand {
    model: Model,
    body: Body,
    state: State<f64>,
    workspace: Workspace<f64>,
    pose: Vec<f64>,
    action: Vec<f64>,
    scratch: Option<ControlScratch>,
    /// Control steps that were asked for.
    asked: u32,
}

/// As much of a body file as standing takes.
fn description() -> BodyDescription {
    let foot = |side: &str| LandmarkDescription {
        name: format!("sole_{side}"),
        body: format!("calcn_{side}"),
        forward: Axis::PlusX,
        up: Axis::PlusY,
        segment: ["foot_col1", "foot_col3", "foot_col4", "bofoot_col1", "bofoot_col2"]
            .map(|shape| format!("{side}_{shape}"))
            .to_vec(),
        ..Default::default()
    };
    let palm = LandmarkDescription {
        name: "palm_r".into(),
        body: "thirdmc_r".into(),
        forward: Axis::PlusX,
        up: Axis::PlusY,
        point: [0.0, 0.0, -0.012],
        ..Default::default()
    };
    BodyDescription {
        name: "human".into(),
        root: "Full Body".into(),
        root_forward: Axis::MinusY,
        root_up: Axis::PlusZ,
        excitation: ExcitationMap::Linear,
        landmarks: ["l", "r"].map(foot).into_iter().chain([palm]).collect(),
        landmark_groups: vec![("hands".into(), vec!["palm_r".into()])],
        poses: vec![("neutral".into(), ["l", "r"].map(|side| (format!("shoulder_elv_{side}"), 0.14)).to_vec())],
        ..Default::default()
    }
}

impl Stand {
    fn new() -> Self {
        let model = bodies::model(&Path::new(bodies::ROOT).join("bodies/models/human416.xml")).unwrap();
        let body = Body::bind(&description(), &model).unwrap();
        let (mut state, mut workspace) = (State::new(&model), Workspace::new(&model));
        let pose = body.neutral().to_vec();
        body.place(&model, &RootPlacement::default(), &pose, &mut state, &mut workspace);
        physics::forward(&model, &state, &mut workspace).unwrap();
        Self { action: vec![0.0; body.muscles.len()], scratch: None, asked: 0, model, body, state, workspace, pose }
    }

    fn present(&self) -> Present<'_> {
        Present { body: &self.body, model: &self.model, state: &self.state, workspace: &self.workspace }
    }

    fn controller(&self) -> Controller {
        Controller::new(&self.present(), &self.pose, HOLD).unwrap()
    }

    fn act(&mut self, controller: &mut Controller) {
        self.ask(controller, &Offsets::default());
    }

    fn ask(&mut self, controller: &mut Controller, offsets: &Offsets) {
        let step = self.asked;
        self.asked += 1;
        let mut scratch = self.scratch.take().unwrap_or_else(|| ControlScratch::new(&self.present()));
        let Self { model, body, state, workspace, action, .. } = self;
        let present = Present { body, model, state, workspace };
        controller.ask(&present, step, offsets, &mut scratch);
        scratch.allocate(&present, controller);
        controller.give(&present, &mut scratch, action);
        self.scratch = Some(scratch);
    }

    fn step(&mut self, controller: &mut Controller) {
        self.act(controller);
        self.simulate();
    }

    fn simulate(&mut self) {
        let Self { model, body, state, workspace, action, .. } = self;
        for (control, &action) in state.control.iter_mut().zip(&*action) {
            *control = crate::action::excitation(body.excitation, action);
        }
        for _ in 0..HOLD.steps {
            physics::step(model, state, workspace).unwrap();
        }
        physics::forward(model, state, workspace).unwrap();
    }

    fn com(&self) -> Vector3<f64> {
        self.workspace.kinematics.subtree_com[self.body.root.body]
    }

    fn push(&mut self, force: Vector3<f64>) {
        let pelvis = self.model.bodies.name.iter().position(|name| name == "pelvis").unwrap();
        self.state.body_force[pelvis][0] = force;
    }

    /// Mean squared activation.
    fn effort(&self) -> f64 {
        let activation = &self.state.activation;
        activation.iter().map(|a| a * a).sum::<f64>() / activation.len() as f64
    }
}

/// Projected on the independent coordinates, inertia times acceleration plus load less active muscle force is what M v̇ + bias
/// - passive - muscles gives over all dofs.
#[test]
fn the_required_force_is_that_of_the_equations_of_motion() {
    let Stand { model, body, mut state, mut workspace, .. } = Stand::new();
    let coordinates = Coordinates::new(&model);
    assert_eq!(coordinates.dofs.len(), model.nv - model.couplings.joint.len());
    for (index, joint) in body.joints.iter().enumerate() {
        state.position[joint.position] += 0.2 * (index as f64).sin();
        state.velocity[joint.dof] = (index as f64).cos();
    }
    for (index, activation) in state.activation.iter_mut().enumerate() {
        *activation = 0.5 + 0.5 * (index as f64).sin();
    }
    body.solve_couplings(&model, &mut state.position);
    body.solve_coupled_velocities(&model, &state.position, &mut state.velocity);
    physics::smooth(&model, &state, &mut workspace);
    let mut slopes = Slopes::new(&coordinates);
    slopes.update(&coordinates, &model, &state);
    let wanted: Vec<f64> = (0..coordinates.len()).map(|index| 3.0 * (2.0 * index as f64).sin()).collect();

    let mut dynamics = Dynamics::new(&model, &workspace.tendons, &coordinates);
    let mut columns = dynamics.columns();
    dynamics.update((&model, &state, &workspace), (&coordinates, &slopes), 0.0, &mut columns);
    let mut found = vec![0.0; coordinates.len()];
    dynamics.required_force(&wanted, &mut found);
    let relaxing: Vec<f64> = state.activation.iter().map(|activation| -activation).collect();
    columns.add_scaled(&relaxing, &mut found);

    let moved = |dof: usize| coordinates.of(dof).map_or(0.0, |column| slopes.of(dof) * wanted[column]);
    let acceleration: Vec<f64> = (0..model.nv).map(|dof| slopes.drift[dof] + moved(dof)).collect();
    let mut full = vec![0.0; model.nv];
    physics::inertia::multiply(&model, &workspace.inertia.matrix, &acceleration, &mut full);
    for (dof, force) in full.iter_mut().enumerate() {
        *force += workspace.forces.bias[dof] - workspace.forces.passive[dof] - workspace.forces.actuator[dof];
    }
    let mut expected = vec![0.0; coordinates.len()];
    slopes.project(&coordinates, &full, &mut expected);
    let scale = expected.iter().fold(0.0, |largest: f64, force| largest.at_least(force.abs()));
    for (column, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!((found - expected).abs() < 1e-9 * scale, "coordinate {column}: {found} is not {expected}");
    }
}

/// Eight bodies that stand, fall and fly, in lanes of their own; some are left out. Twice, the second time from where they have ended.
#[test]
fn forces_in_lanes_have_the_bits_of_forces_alone() {
    let mut stand = Stand::new();
    let mut group = LaneGroup::of(&Arc::new(stand.model.clone()), &Plan::new(&stand.model));
    let mut stands = Vec::new();
    for lane in (0..8).filter(|lane| ![1, 6].contains(lane)) {
        for step in 0..4 * lane {
            stand.action.iter_mut().enumerate().for_each(|(muscle, action)| *action = ((muscle + step) as f64).sin());
            stand.simulate();
        }
        if lane == 4 {
            stand.state.position[2] += 0.2;
            physics::forward(&stand.model, &stand.state, &mut stand.workspace).unwrap();
        }
        let mut controller = stand.controller();
        if [0, 2].contains(&lane) {
            // It walks, and has a foot on its way.
            let mut walks = stand.clone();
            walks.state.velocity[0] = 1.0;
            walks.state.position[walks.body.joints.iter().find(|joint| joint.name == "hip_flexion_l").unwrap().position] += 0.5;
            physics::forward(&walks.model, &walks.state, &mut walks.workspace).unwrap();
            controller.walk(&walks.present()).unwrap();
            group.hold(lane, &walks.state, &walks.workspace);
            stands.push((lane, walks, controller, ControlScratch::new(&stand.present())));
            continue;
        }
        group.hold(lane, &stand.state, &stand.workspace);
        stands.push((lane, stand.clone(), controller, ControlScratch::new(&stand.present())));
    }
    let mut share: Share<Lanes> = Share::new(&stand.model, &stand.body, group.passes().1);
    for (_, _, controller, _) in stands.iter_mut().skip(1).step_by(2) {
        controller.make_rough();
    }
    for step in 0..2 {
        let mut alone = Vec::new();
        for (_, stand, controller, scratch) in &mut stands {
            controller.ask(&stand.present(), step, &Offsets::default(), scratch);
            let mut own = controller.clone();
            scratch.allocate(&stand.present(), &mut own);
            alone.push((scratch.asked.clone(), own.memory));
        }
        let feet: Vec<usize> = stands.iter().map(|(.., scratch)| scratch.wishes.points.len()).collect();
        assert!(feet.contains(&0) && feet.iter().any(|count| *count > 3), "{feet:?} points bear weight");
        let mut members: Vec<_> =
            stands.iter_mut().map(|(lane, _, controller, scratch)| scratch.member(*lane, controller)).collect();
        let (state, workspace) = group.passes();
        share.solve((&stand.model, state, workspace), HOLD.duration(), &mut members);
        for ((lane, _, controller, scratch), (asked, memory)) in stands.iter().zip(&alone) {
            assert_eq!(&scratch.asked, asked, "lane {lane}");
            assert_eq!(&controller.memory, memory, "lane {lane}");
        }
    }
}

#[test]
fn a_gait_walks_turns_and_stands_again() {
    let mut stand = Stand::new();
    let mut controller = stand.controller();
    controller.walk(&stand.present()).unwrap();
    let start = stand.com();
    let mut walk = |seconds: u32, forward: f64, turn: f64| {
        for _ in 0..100 * seconds {
            let offsets = Offsets { walk: Walk { velocity: Vector2::new(forward, 0.0), turn }, ..Offsets::default() };
            stand.ask(&mut controller, &offsets);
            stand.simulate();
        }
        let [heading, ..] = stand.body.turns(core::array::from_fn(|part| stand.state.position[3 + part]));
        (stand.com() - start, heading)
    };
    let (stood, _) = walk(1, 0.0, 0.0);
    assert!(stood.norm() < 0.05, "{stood:?} m away without a pace");
    let (ahead, heading) = walk(5, 0.4, 0.0);
    assert!((1.0..2.2).contains(&ahead.x) && ahead.y.abs() < 0.2 && heading.abs() < 0.2, "{ahead:?} m, {heading} rad");
    let (_, heading) = walk(3, 0.2, 0.5);
    assert!((1.0..1.8).contains(&heading), "turned by {heading} rad");
    let (still, _) = walk(3, 0.0, 0.0);
    let (end, heading_then) = walk(1, 0.0, 0.0);
    assert!((end - still).norm() < 0.05 && (heading_then - heading).abs() < 0.3, "{still:?} m, then {end:?} m");
    assert!(end.z > -0.08, "{} m lower", -end.z);
}

/// A gait that began with bent knees once kept them bent, and went half as fast as asked.
#[test]
fn a_gait_rises_to_its_height_whatever_it_begins_with() {
    let mut stand = Stand::new();
    let tall = stand.com().z;
    let bend = |stand: &mut Stand, name: &str, angle: f64| {
        let joint = stand.body.joints.iter().position(|joint| joint.name == name).unwrap();
        stand.pose[joint] = angle;
    };
    for side in ["l", "r"] {
        for (joint, angle) in [("hip_flexion", 0.4), ("knee_angle", 0.8), ("ankle_angle", 0.4)] {
            bend(&mut stand, &format!("{joint}_{side}"), angle);
        }
    }
    let Stand { model, body, state, workspace, pose, .. } = &mut stand;
    body.place(model, &RootPlacement::default(), pose, state, workspace);
    physics::forward(model, state, workspace).unwrap();
    let low = stand.com().z;
    assert!(low < tall - 0.05, "{low} m is as high as {tall} m");
    let mut controller = stand.controller();
    controller.walk(&stand.present()).unwrap();
    for _ in 0..300 {
        let walk = Walk { velocity: Vector2::new(0.6, 0.0), turn: 0.0 };
        stand.ask(&mut controller, &Offsets { walk, ..Offsets::default() });
        stand.simulate();
    }
    assert!(stand.com().z > tall - 0.07, "{} m high, of {tall} m", stand.com().z);
}

#[test]
fn a_hand_comes_where_it_is_to_be_and_the_body_stands() {
    let mut stand = Stand::new();
    let mut controller = stand.controller();
    let hand = stand.body.hands()[0];
    let palm = |stand: &Stand| stand.body.landmark_position(&stand.workspace.kinematics, hand);
    let (start, centre) = (palm(&stand), stand.com());
    let offset = Vector3::new(0.35, 0.1, 0.4);
    for _ in 0..150 {
        stand.ask(&mut controller, &Offsets { hands: vec![(hand, offset)], ..Offsets::default() });
        stand.simulate();
    }
    let missing = start + offset - palm(&stand);
    assert!(missing.norm() < 0.08, "{missing:?} m are missing");
    assert!((stand.com() - centre).norm() < 0.06, "{:?} m away", stand.com() - centre);
}

#[test]
fn it_stands_from_silent_muscles() {
    let mut stand = Stand::new();
    let mut controller = stand.controller();
    let start = stand.com();
    for _ in 0..200 {
        stand.step(&mut controller);
        let shift = stand.com() - start;
        assert!(shift.z.abs() < 0.01 && shift.xy().norm() < 0.05, "shifted by {shift:?} m at {} s", stand.state.time);
    }
    assert!(stand.effort() < 0.06, "effort {}", stand.effort());
}

#[test]
fn a_push_of_fifty_newtons_does_not_topple_it() {
    for direction in [Vector3::x(), -Vector3::x(), Vector3::y()] {
        let mut stand = Stand::new();
        let mut controller = stand.controller();
        let mut heights = Vec::new();
        for step in 0..250 {
            stand.push(if (60..70).contains(&step) { 50.0 * direction } else { Vector3::zeros() });
            stand.step(&mut controller);
            heights.push(stand.com().z);
        }
        let lowest = heights.iter().copied().fold(f64::INFINITY, Real::at_most);
        assert!(lowest > 0.92, "sank to {lowest} m after a push along {direction:?}");
    }
}

#[test]
fn the_same_state_gives_the_same_action() {
    let mut stand = Stand::new();
    let mut act = || {
        let mut controller = stand.controller();
        stand.act(&mut controller);
        stand.action.clone()
    };
    assert_eq!(act(), act());
}

#[test]
fn actions_stay_within_their_range() {
    let mut stand = Stand::new();
    let mut controller = stand.controller();
    for _ in 0..20 {
        stand.step(&mut controller);
        assert!(stand.action.iter().all(|action| (-1.0..=1.0).contains(action)));
    }
    let [low, high] = activation::excitation_range(stand.body.excitation);
    assert!(stand.state.control.iter().all(|control| (low..=high).contains(control)));
}
