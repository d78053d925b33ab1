//! Poses to look at: drawn at random but always the same, put on the ground or on things, moved a little by those who search.
//!
//! A pose is a row of numbers ([`Pose`]); [`Room`] puts body and objects into it. Joints stay in their ranges, coupled ones follow
//! their couplings. The body stands where its lowest point meets what is below it, or is a little above, as in a hop. A pose in which the
//! body is inside scenery does not count.

use msk_physics::model::{Model, Quaternion, rotation};
use msk_physics::scalar::Real;
use msk_physics::{State, Workspace, constrained, kinematics};
use msk_program::frame::{FrameLayout, Sensor};
use msk_program::task::RootPlacement;
use msk_runtime::body::Body;
use msk_runtime::body::sensors::{self, Control, Memory, Snapshot};
use msk_runtime::episode::Stream;
use msk_runtime::scene::ground::Ground;
use nalgebra::{Matrix3, Vector3};

/// How high a body may be above the ground, m: a hop.
const HIGHEST_HOP: f64 = 0.15;
/// Overlaps with scenery up to this are its giving way, m.
const DEEPEST: f64 = 0.01;
/// A foot stands if it is no farther from the ground than this, m.
const STANDING: f64 = 5e-3;
/// Joints without limits move so far, rad or m.
const UNLIMITED: f64 = 0.5;

/// On what a body rests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rest {
    /// On the ground, its lowest point so far above it, m.
    Ground(f64),
    /// On whatever is solid below it.
    Things,
    /// Its root at a height, m: something holds it there.
    Held(f64),
}

/// A pose as numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pose {
    /// In the order of the body's joints, rad or m.
    pub joints: Vec<f64>,
    /// Where the root is, m.
    pub place: [f64; 2],
    /// Turns of the root as of an initial state, rad.
    pub heading: f64,
    pub pitch: f64,
    pub roll: f64,
    /// A landmark that is level, at any pitch and roll.
    pub level: Option<usize>,
    pub rest: Rest,
    /// Where free objects are, those that the body carries left out.
    pub objects: Vec<Placed>,
}

/// A free object: its place in the body's list, position (m), orientation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed {
    object: usize,
    position: [f64; 3],
    orientation: Quaternion,
}

impl Placed {
    /// Moves and turns it at random by so much, m and rad.
    fn stir(&mut self, by: f64, chance: &mut Stream) {
        self.position.iter_mut().for_each(|axis| *axis += by * chance.normal());
        let way = Vector3::new(chance.normal(), chance.normal(), chance.normal());
        let angle = by * way.norm();
        if angle > 0.0 {
            self.orientation = rotation::product(rotation::about(way.normalize(), angle), self.orientation);
        }
    }
}

/// A free object that is held to a part of the body.
struct Carried {
    object: usize,
    /// The part, and the object's place and orientation in its frame.
    by: usize,
    position: Vector3<f64>,
    orientation: Quaternion,
}

/// A body in its scene, ready to be posed.
pub(super) struct Room<'a> {
    pub model: &'a Model,
    pub body: &'a Body,
    /// The state in which the task begins.
    pub begins: State<f64>,
    pub state: State<f64>,
    pub workspace: Workspace<f64>,
    /// SupportShape shapes that stay where they are: what can be stood on or bumped into.
    scenery: Vec<usize>,
    /// Feet, by their landmarks.
    pub feet: Vec<usize>,
    /// Joints that poses may choose.
    free: Vec<usize>,
    /// Free objects that poses may place.
    loose: Vec<usize>,
    carried: Vec<Carried>,
    /// Whether something in the scene can hold the body above the ground.
    holds: bool,
    layout: &'a FrameLayout,
    action: Vec<f64>,
    /// Of the task's own action space, as far as it reads them.
    entries: Vec<f64>,
    memory: Memory,
    pub frame: Vec<f64>,
}

impl<'a> Room<'a> {
    pub fn new(model: &'a Model, body: &'a Body, begins: &State<f64>, layout: &'a FrameLayout) -> Self {
        let mut workspace = Workspace::new(model);
        kinematics::update(model, begins, &mut workspace.kinematics);
        let geoms = &model.geoms;
        let solid = |geom: &usize| geoms.contact_type[*geom] != 0 || geoms.contact_affinity[*geom] != 0;
        let free_bodies: Vec<usize> = body.objects.iter().filter(|object| object.free.is_some()).map(|o| o.body).collect();
        let fixed = |geom: &usize| !body.members.contains(&geoms.body[*geom]) && !free_bodies.contains(&geoms.body[*geom]);
        let feet = body.groups.iter().find(|group| group.name == "feet").map_or(Vec::new(), |group| group.members.clone());
        let carried = carried(model, body, &workspace);
        let all = body.objects.iter().enumerate().filter(|(_, object)| object.free.is_some()).map(|(index, _)| index);
        let loose: Vec<usize> = all.filter(|index| carried.iter().all(|carried| carried.object != *index)).collect();
        let independent = |joint: &usize| body.joints[*joint].independent;
        let entry = |(sensor, _): &(Sensor, usize)| if let Sensor::ActionEntry(entry) = sensor { Some(entry + 1) } else { None };
        let entries = layout.entries().iter().filter_map(entry).max().unwrap_or(0);
        Self {
            model,
            body,
            begins: begins.clone(),
            state: begins.clone(),
            workspace,
            scenery: (0..geoms.kind.len()).filter(solid).filter(fixed).collect(),
            feet: feet.into_iter().filter(|foot| !body.landmarks[*foot].segment.is_empty()).collect(),
            free: (0..body.joints.len()).filter(independent).collect(),
            loose,
            carried,
            holds: !body.connections.is_empty(),
            layout,
            action: vec![0.0; body.muscles.len()],
            entries: vec![0.0; entries],
            memory: Memory::default(),
            frame: vec![0.0; layout.size()],
        }
    }

    /// Range of a joint, or what it moves without one.
    fn range(&self, joint: usize) -> [f64; 2] {
        let neutral = self.body.neutral().get(joint).copied().unwrap_or(0.0);
        self.body.joints[joint].range.unwrap_or([neutral - UNLIMITED, neutral + UNLIMITED])
    }

    /// The pose in which the task begins, as far as a pose describes it.
    fn initial_pose(&self) -> Pose {
        let at = |place: usize| self.begins.position[place];
        let joints = self.body.joints.iter().map(|joint| at(joint.position)).collect();
        let place = self.body.root.free.map_or([0.0; 2], |(root, _)| [at(root), at(root + 1)]);
        let object = |&index: &usize| {
            let (first, _) = self.body.objects[index].free?;
            let orientation = [at(first + 3), at(first + 4), at(first + 5), at(first + 6)];
            Some(Placed { object: index, position: [at(first), at(first + 1), at(first + 2)], orientation })
        };
        let objects = self.loose.iter().filter_map(object).collect();
        Pose { joints, place, heading: 0.0, pitch: 0.0, roll: 0.0, level: None, rest: Rest::Ground(0.0), objects }
    }

    /// A pose drawn at random: a named one or a mixture of two, with noise, upright on a foot or lying, near something or anywhere.
    pub fn draw(&self, chance: &mut Stream) -> Pose {
        let mut pose = self.initial_pose();
        let named = |chance: &mut Stream| match pick(chance, self.body.poses.len() + 1) {
            0 => pose.joints.clone(),
            index => self.body.poses[index - 1].coordinates.clone(),
        };
        let (first, second, blend) = (named(chance), named(chance), chance.uniform());
        let share = if chance.uniform() < 0.5 { blend } else { 0.0 };
        let width = [0.0, 0.1, 0.3][pick(chance, 3)];
        let wild = chance.uniform() < 0.3;
        for &joint in &self.free {
            let [low, high] = self.range(joint);
            let at = |pose: &[f64]| pose.get(joint).copied().unwrap_or(0.5 * (low + high));
            let middle = at(&first) * (1.0 - share) + at(&second) * share;
            let value = match (wild, self.body.joints[joint].of_scene) {
                (true, _) | (_, true) if chance.uniform() < 0.5 => low + (high - low) * chance.uniform(),
                _ => middle + width * (high - low) * chance.normal(),
            };
            pose.joints[joint] = value.clip(low.at_most(middle), high.at_least(middle));
        }
        let things = self.body.objects.len();
        let around = if things > 0 && chance.uniform() < 0.5 {
            let place = self.workspace_place(pick(chance, things));
            [place[0] + 0.4 * chance.normal(), place[1] + 0.4 * chance.normal()]
        } else {
            let width = [0.0, 0.5, 3.0][pick(chance, 3)];
            [pose.place[0] + width * chance.normal(), pose.place[1] + width * chance.normal()]
        };
        pose.place = around;
        pose.heading = if chance.uniform() < 0.5 { 0.0 } else { core::f64::consts::TAU * chance.uniform() };
        match pick(chance, 6) {
            // Lying, or on all fours.
            0 => (pose.pitch, pose.roll) = (1.6 * chance.normal(), 1.6 * chance.normal()),
            1 => (pose.pitch, pose.roll) = (0.5 * chance.normal(), 0.3 * chance.normal()),
            // The pelvis upright, as in sitting and hanging.
            2 | 3 => {}
            _ if self.feet.is_empty() => {}
            _ => pose.level = Some(self.feet[pick(chance, self.feet.len())]),
        }
        pose.rest = match pick(chance, 4) {
            0 => Rest::Things,
            1 => Rest::Ground(HIGHEST_HOP * chance.uniform()),
            2 if self.holds => Rest::Held(0.5 + 1.7 * chance.uniform()),
            _ => Rest::Ground(0.0),
        };
        for placed in &mut pose.objects {
            placed.stir([0.0, 0.1, 0.7][pick(chance, 3)], chance);
        }
        pose
    }

    fn workspace_place(&self, object: usize) -> [f64; 2] {
        let place = self.workspace.kinematics.body_position[self.body.objects[object].body];
        [place.x, place.y]
    }

    /// A pose beside another one: a few of its numbers are moved, by much or by little. Who stands goes on standing if `standing`.
    pub fn near(&self, pose: &Pose, standing: bool, chance: &mut Stream) -> Pose {
        let mut new = pose.clone();
        let size = libm::pow(10.0, -2.0 * chance.uniform());
        if chance.uniform() < 0.7 {
            for _ in 0..[1, 3, 10][pick(chance, 3)] {
                let joint = self.free[pick(chance, self.free.len())];
                let [low, high] = self.range(joint);
                let value = new.joints[joint] + size * (high - low) * chance.normal();
                new.joints[joint] = value.clip(low, high);
            }
        }
        match pick(chance, 6) {
            0 => new.place.iter_mut().for_each(|axis| *axis += 10.0 * size * chance.normal()),
            1 => new.place.iter_mut().for_each(|axis| *axis += size * chance.normal()),
            2 => new.heading += 3.0 * size * chance.normal(),
            3 if !standing => {
                (new.pitch, new.roll) = (new.pitch + 1.5 * size * chance.normal(), new.roll + 1.5 * size * chance.normal());
                new.level = new.level.filter(|_| chance.uniform() < 0.5);
            }
            4 => new.objects.iter_mut().for_each(|placed| placed.stir(size, chance)),
            _ => {}
        }
        new.rest = match new.rest {
            Rest::Ground(_) if standing => Rest::Ground(0.0),
            Rest::Ground(lift) => Rest::Ground((lift + 0.1 * size * chance.normal()).clip(0.0, HIGHEST_HOP)),
            Rest::Held(height) => Rest::Held((height + size * chance.normal()).clip(0.2, 2.5)),
            Rest::Things => Rest::Things,
        };
        new
    }

    /// The pose as far again beyond the second as that is from the first.
    pub fn beyond(&self, first: &Pose, second: &Pose) -> Pose {
        let mut new = second.clone();
        let further = |a: f64, b: f64| 2.0 * b - a;
        for &joint in &self.free {
            let [low, high] = self.range(joint);
            new.joints[joint] = further(first.joints[joint], second.joints[joint]).clip(low, high);
        }
        new.place = core::array::from_fn(|axis| further(first.place[axis], second.place[axis]));
        new.heading = further(first.heading, second.heading);
        (new.pitch, new.roll) = (further(first.pitch, second.pitch), further(first.roll, second.roll));
        for ((new, first), second) in new.objects.iter_mut().zip(&first.objects).zip(&second.objects) {
            new.position = core::array::from_fn(|axis| further(first.position[axis], second.position[axis]));
        }
        new
    }

    /// Poses body and objects and fills the frame; whether the pose counts.
    pub fn show(&mut self, pose: &Pose) -> bool {
        let Self { model, body, state, .. } = self;
        state.position.copy_from_slice(&self.begins.position);
        for (joint, &coordinate) in body.joints.iter().zip(&pose.joints) {
            state.position[joint.position] = coordinate;
        }
        body.solve_couplings(model, &mut state.position);
        for placed in &pose.objects {
            if let Some((first, _)) = body.objects[placed.object].free {
                state.position[first..first + 3].copy_from_slice(&placed.position);
                state.position[first + 3..first + 7].copy_from_slice(&placed.orientation);
            }
        }
        self.stand(pose);
        self.carry();
        constrained::contacts(self.model, &mut self.workspace);
        let snapshot = Snapshot { body: self.body, model: self.model, state: &self.state, workspace: &self.workspace };
        let control = Control { action: &self.action, entries: &self.entries, time: 0.0, elapsed: 0.0 };
        sensors::fill(self.layout, &snapshot, &control, &mut self.memory, &mut self.frame);
        !self.is_inside()
    }

    /// Turns and places the root.
    fn stand(&mut self, pose: &Pose) {
        let Self { model, body, state, workspace, .. } = self;
        let Some((root, _)) = body.root.free else {
            kinematics::update(model, state, &mut workspace.kinematics);
            return;
        };
        let (heading, pitch, roll) = (pose.heading, pose.pitch, pose.roll);
        let mut facing = body.facing(&RootPlacement { heading, pitch, roll, ..RootPlacement::default() });
        let turn = |state: &mut State<f64>, facing: &Matrix3<f64>| {
            state.position[root + 3..root + 7].copy_from_slice(&rotation::from_matrix(facing));
        };
        state.position[root..root + 3].copy_from_slice(&[pose.place[0], pose.place[1], 0.0]);
        turn(state, &facing);
        kinematics::update(model, state, &mut workspace.kinematics);
        if let Some(level) = pose.level {
            let landmark = &body.landmarks[level];
            let up = workspace.kinematics.body_rotation[landmark.body] * landmark.axes.column(2);
            // The shortest way round that brings the foot's upward axis up; one that is upside down stays so.
            let axis = up.cross(&Vector3::z());
            let sine = axis.norm();
            if sine > 1e-9 {
                facing = rotation::matrix(rotation::about(axis / sine, libm::atan2(sine, up.z))) * facing;
                turn(state, &facing);
                kinematics::update(model, state, &mut workspace.kinematics);
            }
        }
        let shapes = match pose.rest {
            Rest::Things => &self.scenery,
            _ => &body.ground,
        };
        let clearance = Ground { model, kinematics: &workspace.kinematics, shapes }.clearance(&body.shapes);
        let clearance = if clearance.is_finite() { clearance } else { 0.0 };
        state.position[root + 2] = match pose.rest {
            Rest::Held(height) => height,
            Rest::Things => -clearance,
            Rest::Ground(lift) => lift - clearance,
        };
        kinematics::update(model, state, &mut workspace.kinematics);
    }

    /// Puts what is held to the body where its part is.
    fn carry(&mut self) {
        if self.carried.is_empty() {
            return;
        }
        let kinematics = &self.workspace.kinematics;
        for carried in &self.carried {
            let Some((first, _)) = self.body.objects[carried.object].free else { continue };
            let place = kinematics.point(carried.by, &carried.position);
            let orientation = rotation::product(kinematics.body_orientation[carried.by], carried.orientation);
            self.state.position[first..first + 3].copy_from_slice(place.as_slice());
            self.state.position[first + 3..first + 7].copy_from_slice(&orientation);
        }
        kinematics::update(self.model, &self.state, &mut self.workspace.kinematics);
    }

    /// Whether a part of the body is inside scenery.
    fn is_inside(&self) -> bool {
        let Some(episode) = self.workspace.lanes.first() else { return false };
        let owns = |geom: usize| self.body.members.contains(&self.model.geoms.body[geom]);
        episode.constraints.contacts.iter().any(|contact| {
            let [first, second] = contact.geoms;
            let meets = (owns(first) && self.scenery.contains(&second)) || (owns(second) && self.scenery.contains(&first));
            meets && contact.distance < -DEEPEST
        })
    }

    /// Whether the body stands: a foot is flat on the ground and carries it.
    pub fn stands(&self, pose: &Pose) -> bool {
        let Some(foot) = pose.level.filter(|_| pose.rest == Rest::Ground(0.0)) else { return false };
        let landmark = &self.body.landmarks[foot];
        let kinematics = &self.workspace.kinematics;
        let up = kinematics.body_rotation[landmark.body] * landmark.axes.column(2);
        let ground = Ground { model: self.model, kinematics, shapes: &self.body.ground };
        up.z > 0.99 && ground.clearance(&landmark.segment).abs() < STANDING
    }

    /// How far the body is above everything where the task begins, m.
    pub fn initial_height(&mut self) -> f64 {
        kinematics::update(self.model, &self.begins, &mut self.workspace.kinematics);
        let below =
            |shapes| Ground { model: self.model, kinematics: &self.workspace.kinematics, shapes }.clearance(&self.body.shapes);
        below(&self.body.ground).at_most(below(&self.scenery))
    }

    /// Whether the task begins on the feet: nothing of the body is lower than they are.
    pub fn begins_standing(&mut self) -> bool {
        kinematics::update(self.model, &self.begins, &mut self.workspace.kinematics);
        let ground = Ground { model: self.model, kinematics: &self.workspace.kinematics, shapes: &self.body.ground };
        let all = ground.clearance(&self.body.shapes);
        let foot = |&foot: &usize| ground.clearance(&self.body.landmarks[foot].segment);
        let lowest = self.feet.iter().map(foot).fold(f64::INFINITY, Real::at_most);
        lowest.is_finite() && lowest - all < 0.02
    }
}

/// Free objects that connections hold to parts of the body, as they are where the task begins.
fn carried(model: &Model, body: &Body, workspace: &Workspace<f64>) -> Vec<Carried> {
    use msk_physics::model::Equality;
    let kinematics = &workspace.kinematics;
    let mut found: Vec<Carried> = Vec::new();
    for connection in &body.connections {
        let (Equality::Connect(attachment) | Equality::Weld { attachment, .. }) = &model.equalities.kind[connection.equality]
        else {
            continue;
        };
        let [a, b] = attachment.bodies;
        for (by, thing) in [(a, b), (b, a)] {
            let object = body.objects.iter().position(|object| object.body == thing && object.free.is_some());
            let Some(object) = object.filter(|_| body.owns(by)) else { continue };
            if found.iter().any(|known| known.object == object) {
                continue;
            }
            let way = kinematics.body_position[thing] - kinematics.body_position[by];
            let [w, x, y, z] = kinematics.body_orientation[by];
            found.push(Carried {
                object,
                by,
                position: kinematics.body_rotation[by].tr_mul(&way),
                orientation: rotation::product([w, -x, -y, -z], kinematics.body_orientation[thing]),
            });
        }
    }
    found
}

/// One of so many, all alike; 0 where there is none.
pub(super) fn pick(chance: &mut Stream, count: usize) -> usize {
    ((chance.uniform() * count as f64) as usize).min(count.saturating_sub(1))
}
