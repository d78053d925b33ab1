//! Binding: every name of a body file resolved in its model, or one error that lists everything that is wrong.

use super::{Body, Joint, Landmark, Muscle, NEUTRAL, Root, anatomical_axes, coupling};
use core::ops::Range;
use msk_physics::model::{GeomKind, JointKind, Model};
use msk_program::body::{BodyDescription, LandmarkDescription};
use msk_program::quantity::dimension::Dimension;
use msk_program::spoken::SpokenUnit;
use msk_program::vocabulary::{Group, GroupKind, Pose};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A body file does not fit its model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("body `{body}` does not match its model:{}", list(.problems))]
pub struct BindError {
    /// Name of the body.
    pub body: String,
    /// Everything that is wrong, in the order of the body file.
    pub problems: Vec<Problem>,
}

/// Muscles that are named where many are in no family.
const NAMED: usize = 6;

/// A line for each problem; muscles without a family share one, or a file without a single family would bury the rest.
fn list(problems: &[Problem]) -> String {
    let muscle = |problem: &Problem| if let Problem::NoFamily { muscle } = problem { Some(format!("`{muscle}`")) } else { None };
    let outside: Vec<String> = problems.iter().filter_map(muscle).collect();
    let several = outside.len() > NAMED;
    let listed = problems.iter().filter(|problem| !several || muscle(problem).is_none());
    let mut text: String = listed.map(|problem| format!("\n  - {problem}")).collect();
    if several {
        let (named, rest) = outside.split_at(NAMED);
        text += &format!(
            "\n  - {} muscles are in no recruitment family: {} and {} more",
            outside.len(),
            named.join(", "),
            rest.len()
        );
    }
    text
}

fn range_and_value(unit: &SpokenUnit, low: f64, high: f64, value: f64) -> (String, String) {
    unit.tell_beside([low, high], value)
}

/// One thing that is wrong with a body file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A name that the model does not have.
    #[error("{user} names the {kind} `{name}`, which does not exist{}", hint(.nearest))]
    Unknown {
        /// Kind of element: body, joint, muscle, shape, landmark.
        kind: &'static str,
        /// The name.
        name: String,
        /// What asks for it.
        user: String,
        /// The name most like it.
        nearest: Option<String>,
    },
    /// A name given to two things.
    #[error("the name `{name}` is used for two {kind}s")]
    Twice {
        /// Kind of thing.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Forward and up on one line.
    #[error("{user}: forward and up must be different axes")]
    ParallelAxes {
        /// The landmark or the root.
        user: String,
    },
    /// A landmark on scenery.
    #[error("landmark `{landmark}` is on `{body}`, which is not a descendant of the root")]
    NotOnBody {
        /// The landmark.
        landmark: String,
        /// The body of the model.
        body: String,
    },
    /// An actuator that tasks could not command, because they command muscles.
    #[error("actuator `{actuator}` is not a muscle on a tendon; tasks need a body with muscles only")]
    NotAMuscle {
        /// The actuator.
        actuator: String,
    },
    /// A muscle outside of all recruitment families.
    #[error("muscle `{muscle}` is in no recruitment family")]
    NoFamily {
        /// The muscle.
        muscle: String,
    },
    /// A muscle in two recruitment families.
    #[error("muscle `{muscle}` is in two recruitment families, `{first}` and `{second}`")]
    TwoFamilies {
        /// The muscle.
        muscle: String,
        /// The earlier family.
        first: String,
        /// The later family.
        second: String,
    },
    /// A pose that sets a joint which follows another.
    #[error("pose `{pose}` sets `{joint}`, which is coupled to another joint")]
    Coupled {
        /// The pose.
        pose: String,
        /// The joint.
        joint: String,
    },
    /// A pose outside of a joint's range.
    #[error("pose `{pose}` sets `{joint}` to {}, outside of its range {}", range_and_value(.unit, *.low, *.high, *.value).1, range_and_value(.unit, *.low, *.high, *.value).0)]
    OutOfRange {
        /// The pose.
        pose: String,
        /// The joint.
        joint: String,
        /// The coordinate, rad or m.
        value: f64,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
        /// The unit of the message.
        unit: SpokenUnit,
    },
    /// No standing pose.
    #[error("there is no pose `neutral`")]
    NoNeutral,
    /// Couplings that lead each other.
    #[error("the couplings of these joints are cyclic: {}", .joints.join(", "))]
    CircularCouplings {
        /// The joints.
        joints: Vec<String>,
    },
}

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

impl Body {
    /// Binds a body file to its model, or to a scene that holds that model.
    ///
    /// # Errors
    /// All names that do not resolve, and everything else that does not fit.
    pub fn bind(description: &BodyDescription, model: &Model) -> Result<Self, BindError> {
        let mut binder = Binder { description, model, members: 0..0, problems: Vec::new() };
        let body = binder.body();
        match body {
            Some(body) if binder.problems.is_empty() => Ok(body),
            _ => Err(BindError { body: description.name.clone(), problems: binder.problems }),
        }
    }
}

struct Binder<'a> {
    description: &'a BodyDescription,
    model: &'a Model,
    members: Range<usize>,
    problems: Vec<Problem>,
}

impl Binder<'_> {
    fn body(&mut self) -> Option<Body> {
        // Without the root the rest is read all the same: all problems are reported at once.
        let root = self.root();
        self.members = root.as_ref().map_or(0..self.model.bodies.name.len(), |root| subtree(self.model, root.body));
        let landmarks = self.landmarks();
        let joints = self.joints();
        let muscles = self.muscles();
        let groups = self.groups(&joints, &muscles);
        let couplings = self.couplings();
        let poses = self.poses(&joints, &couplings);
        let geoms = &self.model.geoms;
        let touches = |&geom: &usize| geoms.contact_type[geom] != 0 || geoms.contact_affinity[geom] != 0;
        let shapes = (0..geoms.body.len()).filter(|&geom| self.members.contains(&geoms.body[geom])).filter(touches).collect();
        let ground: Vec<usize> = (0..geoms.body.len())
            .filter(|&geom| geoms.kind[geom] == GeomKind::Plane && self.model.bodies.weld[geoms.body[geom]] == 0)
            .filter(touches)
            .collect();
        let root = root?;
        let root_body = root.body;
        Some(Body {
            name: self.description.name.clone(),
            excitation: self.description.excitation,
            root,
            members: self.members.clone(),
            carried: Vec::new(),
            mass: self.model.bodies.subtree_mass[root_body],
            landmarks,
            joints,
            muscles,
            groups,
            poses,
            couplings,
            shapes,
            level: ground.clone(),
            ground,
            objects: Vec::new(),
            connections: Vec::new(),
        })
    }

    /// The index of `name` among `names`; a problem of `user` where it is missing.
    fn find(&mut self, kind: &'static str, names: &[String], name: &str, user: impl FnOnce() -> String) -> Option<usize> {
        let found = names.iter().position(|known| known == name && !name.is_empty());
        if found.is_none() {
            let nearest = nearest(name, names.iter().map(String::as_str)).map(str::to_owned);
            self.problems.push(Problem::Unknown { kind, name: name.to_owned(), user: user(), nearest });
        }
        found
    }

    fn unique<'n>(&mut self, kind: &'static str, names: impl Iterator<Item = &'n str>) {
        let mut seen = std::collections::BTreeSet::new();
        for name in names {
            if !seen.insert(name) {
                self.problems.push(Problem::Twice { kind, name: name.to_owned() });
            }
        }
    }

    fn root(&mut self) -> Option<Root> {
        let (description, model) = (self.description, self.model);
        let body = self.find("body", &model.bodies.name, &description.root, || "the root".into());
        let axes = anatomical_axes(description.root_forward, description.root_up);
        if axes.is_none() {
            self.problems.push(Problem::ParallelAxes { user: "the root".into() });
        }
        let (body, axes) = (body?, axes?);
        let free = model.bodies.joints[body].clone().find(|&joint| model.joints.kind[joint] == JointKind::Free);
        let free = free.map(|joint| (model.joints.position_address[joint], model.joints.dof_address[joint]));
        Some(Root { body, axes, free })
    }

    fn landmarks(&mut self) -> Vec<Landmark> {
        let descriptions = &self.description.landmarks;
        self.unique("landmark", descriptions.iter().map(|landmark| landmark.name.as_str()));
        descriptions.iter().filter_map(|landmark| self.landmark(landmark)).collect()
    }

    fn landmark(&mut self, description: &LandmarkDescription) -> Option<Landmark> {
        let model = self.model;
        let user = || format!("landmark `{}`", description.name);
        let body = self.find("body", &model.bodies.name, &description.body, user);
        let axes = anatomical_axes(description.forward, description.up);
        if axes.is_none() {
            self.problems.push(Problem::ParallelAxes { user: user() });
        }
        if body.is_some_and(|body| !self.members.contains(&body)) {
            let (landmark, body) = (description.name.clone(), description.body.clone());
            self.problems.push(Problem::NotOnBody { landmark, body });
        }
        let segment: Vec<Option<usize>> =
            description.segment.iter().map(|geom| self.find("shape", &model.geoms.name, geom, user)).collect();
        Some(Landmark {
            name: description.name.clone(),
            description: description.description.clone(),
            body: body?,
            point: Vector3::from(description.point),
            axes: axes?,
            segment: segment.into_iter().collect::<Option<_>>()?,
            of_scene: false,
        })
    }

    fn joints(&mut self) -> Vec<Joint> {
        let joints = &self.model.joints;
        let mut alias = BTreeMap::new();
        for (name, joint) in &self.description.joint_aliases {
            if let Some(index) = self.find("joint", &joints.name, joint, || format!("the alias `{name}`"))
                && alias.insert(index, name.clone()).is_some()
            {
                self.problems.push(Problem::Twice { kind: "joint", name: joint.clone() });
            }
        }
        let bound: Vec<Joint> = (0..joints.name.len())
            .filter(|&joint| matches!(joints.kind[joint], JointKind::Hinge | JointKind::Slide))
            .filter(|&joint| self.members.contains(&joints.body[joint]))
            .map(|index| Joint {
                name: alias.get(&index).unwrap_or(&joints.name[index]).clone(),
                index,
                kind: joints.kind[index],
                position: joints.position_address[index],
                dof: joints.dof_address[index],
                range: joints.range[index],
                independent: !self.model.couplings.joint.contains(&index),
                of_scene: false,
            })
            .collect();
        self.unique("joint", bound.iter().map(|joint| joint.name.as_str()));
        bound
    }

    fn muscles(&mut self) -> Vec<Muscle> {
        let actuators = &self.model.actuators;
        let mut families: Vec<Option<&String>> = vec![None; actuators.name.len()];
        for (family, members) in &self.description.families {
            for name in members {
                let user = || format!("family \"{family}\"");
                let Some(muscle) = self.find("muscle", &actuators.name, name, user) else { continue };
                if let Some(first) = families[muscle].replace(family) {
                    let (muscle, first, second) = (name.clone(), first.clone(), family.clone());
                    self.problems.push(Problem::TwoFamilies { muscle, first, second });
                }
            }
        }
        let complete = self.description.families.is_empty();
        let bound: Vec<Muscle> = (0..actuators.name.len())
            .map(|index| {
                let name = actuators.name[index].clone();
                if self.model.actuators.muscle(index).is_none() {
                    self.problems.push(Problem::NotAMuscle { actuator: name.clone() });
                }
                if families[index].is_none() && !complete {
                    self.problems.push(Problem::NoFamily { muscle: name.clone() });
                }
                let family = families[index].cloned().unwrap_or_default();
                Muscle { name, peak_force: peak_force(self.model, index), family }
            })
            .collect();
        self.unique("muscle", bound.iter().map(|muscle| muscle.name.as_str()));
        bound
    }

    fn groups(&mut self, joints: &[Joint], muscles: &[Muscle]) -> Vec<Group> {
        let description = self.description;
        let joint_names: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
        let joint_originals: Vec<String> = joints.iter().map(|joint| self.model.joints.name[joint.index].clone()).collect();
        let muscle_names: Vec<String> = muscles.iter().map(|muscle| muscle.name.clone()).collect();
        // As described: a landmark that does not resolve is reported once, where it stands.
        let landmark_names: Vec<String> = description.landmarks.iter().map(|landmark| landmark.name.clone()).collect();

        let mut groups = Vec::new();
        let kinds = [
            (GroupKind::Joints, "joint", &description.joint_groups, &joint_names),
            (GroupKind::Muscles, "muscle", &description.muscle_groups, &muscle_names),
            (GroupKind::Landmarks, "landmark", &description.landmark_groups, &landmark_names),
        ];
        for (kind, word, described, names) in kinds {
            for (group, elements) in described {
                let mut members = Vec::with_capacity(elements.len());
                for element in elements {
                    // A joint may be called by its name in tasks or by the model's.
                    let original = joint_originals.iter().position(|name| kind == GroupKind::Joints && name == element);
                    let user = || format!("group `{group}`");
                    let found = original.or_else(|| self.find(word, names, element, user));
                    members.extend(found);
                }
                groups.push(Group { name: group.clone(), kind, members });
            }
        }
        self.unique("group", groups.iter().map(|group| group.name.as_str()));
        groups
    }

    /// The model's couplings, leaders before followers.
    fn couplings(&mut self) -> Vec<usize> {
        coupling::order(self.model).unwrap_or_else(|joints| {
            self.problems.push(Problem::CircularCouplings { joints });
            Vec::new()
        })
    }

    fn poses(&mut self, joints: &[Joint], couplings: &[usize]) -> Vec<Pose> {
        let (description, model) = (self.description, self.model);
        self.unique("pose", description.poses.iter().map(|(name, _)| name.as_str()));
        if !description.poses.iter().any(|(name, _)| name == NEUTRAL) {
            self.problems.push(Problem::NoNeutral);
        }
        let names: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
        let mut poses = Vec::with_capacity(description.poses.len());
        for (pose, settings) in &description.poses {
            let mut position = vec![0.0; model.nq];
            for (name, value) in settings {
                let original = joints.iter().position(|joint| model.joints.name[joint.index] == *name);
                let found = original.or_else(|| self.find("joint", &names, name, || format!("pose `{pose}`")));
                if let Some(joint) = found.map(|index| &joints[index]) {
                    self.pose_joint(pose, joint, *value);
                    position[joint.position] = *value;
                }
            }
            coupling::solve(model, couplings, &mut position);
            let coordinates = joints.iter().map(|joint| position[joint.position]).collect();
            poses.push(Pose { name: pose.clone(), coordinates });
        }
        poses
    }

    /// Reports a joint that a pose may not set, or not so.
    fn pose_joint(&mut self, pose: &str, joint: &Joint, value: f64) {
        let (pose, name) = (pose.to_owned(), joint.name.clone());
        let [low, high] = joint.range.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        if !joint.independent {
            self.problems.push(Problem::Coupled { pose, joint: name });
        } else if !(value.is_finite() && low <= value && value <= high) {
            let dimension = if joint.kind == JointKind::Hinge { Dimension::ANGLE } else { Dimension::LENGTH };
            let unit = SpokenUnit::of(dimension);
            self.problems.push(Problem::OutOfRange { pose, joint: name, value, low, high, unit });
        }
    }
}

/// The bodies that hang on `root`, itself first: a contiguous range, since bodies are in depth-first order.
pub fn subtree(model: &Model, root: usize) -> core::ops::Range<usize> {
    let parent = &model.bodies.parent;
    let below = parent[root + 1..].iter().take_while(|&&parent| parent >= root).count();
    root..root + 1 + below
}

/// Peak isometric force of a muscle, N: given, or its scale over its acceleration scale where the given one is negative.
fn peak_force(model: &Model, muscle: usize) -> f64 {
    let figures = model.actuators.muscle(muscle).map(|muscle| muscle.active);
    let [_, _, force, scale, ..] = figures.unwrap_or([0.0; 9]);
    if force >= 0.0 { force } else { scale / model.actuators.acceleration_scale[muscle] }
}

/// The name most like `name`, if any is alike at all.
fn nearest<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    const ALIKE: f64 = 0.75;
    known
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}
