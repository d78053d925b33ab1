//! Sensors, queries, parts and settings under the names that tasks give them, so that nothing in a snapshot is a place in a
//! list that moves when something else is added.

use crate::body::Property;
use crate::frame::{Origin, Query, Sensor, Subject};
use crate::graph::text::Labels;
use crate::init::{JointValue, Scaling};
use crate::scene::{Motion, Part};
use crate::task::{CompiledTask, DisturbanceSetting, Phase, Setting};
use crate::vocabulary::Vocabulary;
use std::fmt::Write;
use std::mem::discriminant;

/// The names of one phase of a task.
pub(super) struct Names<'a> {
    pub task: &'a CompiledTask,
    pub phase: &'a Phase,
}

impl Labels for Names<'_> {
    fn sensors(&self, sensors: &[Sensor]) -> String {
        let mut text = String::new();
        for alike in sensors.chunk_by(|a, b| discriminant(a) == discriminant(b)) {
            let kind = alike[0].word();
            // Writing to a string cannot fail.
            let _ = write!(text, "{}{kind}", if text.is_empty() { "" } else { " " });
            let subjects: Vec<Subject> = alike.iter().map(|sensor| sensor.subject()).collect();
            let joined: Vec<String> = subjects.chunk_by(follows).filter_map(|run| self.run(run)).collect();
            if !joined.is_empty() {
                let _ = write!(text, "({})", joined.join(", "));
            }
        }
        text
    }

    fn random(&self, index: usize) -> String {
        let stream = self.phase.streams.get(index).and_then(|&stream| self.task.randoms.get(stream));
        stream.map_or_else(|| index.to_string(), |random| random.name.clone())
    }

    fn phase(&self, index: usize) -> String {
        self.task.phases.get(index).map_or_else(|| index.to_string(), |phase| phase.name.clone())
    }
}

/// Whether the second stands right behind the first in its list.
fn follows(a: &Subject, b: &Subject) -> bool {
    match (a, b) {
        (Subject::Landmark(a), Subject::Landmark(b)) | (Subject::Joint(a), Subject::Joint(b)) => *b == a + 1,
        (Subject::Muscle(a), Subject::Muscle(b)) => *b == a + 1,
        _ => false,
    }
}

impl Names<'_> {
    /// Consecutive subjects of one kind: `all`, `a`, `a, b` or `a to e (5)`.
    fn run(&self, run: &[Subject]) -> Option<String> {
        let vocabulary = &*self.task.vocabulary;
        let name = |subject: &Subject| match *subject {
            Subject::Whole => None,
            Subject::Landmark(index) => Some(landmark(vocabulary, index)),
            Subject::Joint(index) => Some(joint(vocabulary, index)),
            Subject::Muscle(index) => Some(muscle(vocabulary, index)),
            Subject::MuscleAbout(first, second) => {
                Some(format!("{} about {}", muscle(vocabulary, first), joint(vocabulary, second)))
            }
            Subject::Parts(a, b) => Some(format!("{} and {}", part(vocabulary, a), part(vocabulary, b))),
            Subject::Query(index) => {
                let asked = self.task.frame.queries().get(index);
                Some(asked.map_or_else(|| index.to_string(), |asked| query(vocabulary, asked)))
            }
        };
        let own_joints = vocabulary.joints.iter().filter(|joint| !joint.of_scene).count();
        let whole = match run.first()? {
            Subject::Joint(0) => own_joints,
            Subject::Muscle(0) => vocabulary.muscles.len(),
            _ => 0,
        };
        if run.len() > 2 && run.len() == whole {
            return Some("all".to_owned());
        }
        let names: Vec<String> = run.iter().filter_map(name).collect();
        match names.as_slice() {
            [] => None,
            [first, .., last] if names.len() > 3 => Some(format!("{first} to {last} ({})", names.len())),
            _ => Some(names.join(", ")),
        }
    }
}

/// The name of a landmark, by its place in the vocabulary.
pub fn landmark(vocabulary: &Vocabulary, index: usize) -> String {
    vocabulary.landmarks.get(index).map_or_else(|| index.to_string(), |landmark| landmark.name.clone())
}

/// The name of a joint, by its place in the vocabulary.
pub fn joint(vocabulary: &Vocabulary, index: usize) -> String {
    vocabulary.joints.get(index).map_or_else(|| index.to_string(), |joint| joint.name.clone())
}

fn muscle(vocabulary: &Vocabulary, index: usize) -> String {
    vocabulary.muscles.get(index).map_or_else(|| index.to_string(), |muscle| muscle.name.clone())
}

fn part(vocabulary: &Vocabulary, part: Part) -> String {
    match part {
        Part::Ground => "ground".to_owned(),
        Part::Robot => "robot".to_owned(),
        Part::Landmark(index) => landmark(vocabulary, index),
        Part::Group(index) => vocabulary.groups.get(index).map_or_else(|| index.to_string(), |group| group.name.clone()),
    }
}

/// A place as people name it.
pub fn origin(vocabulary: &Vocabulary, origin: &Origin) -> String {
    match origin {
        Origin::World(place) => format!("{place:?} m"),
        Origin::Landmark(index, offset) if *offset == [0.0; 3] => landmark(vocabulary, *index),
        Origin::Landmark(index, offset) => format!("{} moved by {offset:?} m", landmark(vocabulary, *index)),
    }
}

fn query(vocabulary: &Vocabulary, query: &Query) -> String {
    match query {
        Query::GroundHeight(place) => format!("height of the ground under {}", origin(vocabulary, place)),
        Query::GroundNormal(place) => format!("normal of the ground under {}", origin(vocabulary, place)),
        Query::Radar { from, group, sectors, over, range } => format!(
            "radar from {} for {} in {sectors} sectors over {over:?} rad within {range:?} m",
            landmark(vocabulary, *from),
            part(vocabulary, Part::Group(*group))
        ),
        Query::Ray { from, direction, range } => {
            format!("ray from {} along {direction:?} within {range:?} m", landmark(vocabulary, *from))
        }
    }
}

/// A number of a disturbance: `force.x`, `at`.
pub fn disturbance_setting(setting: DisturbanceSetting) -> String {
    let axis = |axis: usize| ["x", "y", "z"].get(axis).copied().unwrap_or("?");
    match setting {
        DisturbanceSetting::Force(index) => format!("force.{}", axis(index)),
        DisturbanceSetting::Torque(index) => format!("torque.{}", axis(index)),
        DisturbanceSetting::Start => "at".to_owned(),
    }
}

/// A number of the beginning, under its name: `knee_angle_r`, `root.height`, `ball.position.y`.
pub fn setting(task: &CompiledTask, setting: Setting) -> String {
    const AXES: [&str; 3] = ["x", "y", "z"];
    const PARTS: [&str; 4] = ["w", "x", "y", "z"];
    let axis = |axis: usize| AXES.get(axis).copied().unwrap_or("?");
    let variation = &task.init.variation;
    let object = |index: usize| {
        let known = task.init.objects.get(index).and_then(|start| task.scene.objects.get(start.object));
        known.map_or_else(|| index.to_string(), |object| object.name.clone())
    };
    match setting {
        Setting::Coordinate(index) => joint(&task.vocabulary, index),
        Setting::RootHeight => "root.height".to_owned(),
        Setting::RootPosition(index) => format!("root.position.{}", axis(index)),
        Setting::RootHeading => "root.heading".to_owned(),
        Setting::RootPitch => "root.pitch".to_owned(),
        Setting::RootRoll => "root.roll".to_owned(),
        Setting::RootVelocity(index) => format!("root.velocity.{}", axis(index)),
        Setting::ObjectPosition(of, index) => format!("{}.position.{}", object(of), axis(index)),
        Setting::ObjectOrientation(of, index) => {
            format!("{}.orientation.{}", object(of), PARTS.get(index).copied().unwrap_or("?"))
        }
        Setting::ObjectVelocity(of, index) => format!("{}.velocity.{}", object(of), axis(index)),
        Setting::ObjectSpin(of, index) => format!("{}.spin.{}", object(of), axis(index)),
        Setting::Strength(row) => {
            let muscles = &task.vocabulary.muscles;
            let name = |muscle: usize| muscles.get(muscle).map(|muscle| muscle.name.as_str());
            scaled("strength", variation.strengths.get(row), muscles.len(), name)
        }
        Setting::SegmentMass(row) => {
            let landmarks = &task.vocabulary.landmarks;
            let own = landmarks.iter().filter(|landmark| !landmark.of_scene).count();
            let name = |landmark: usize| landmarks.get(landmark).map(|landmark| landmark.name.as_str());
            scaled("mass", variation.segments.get(row), own, name)
        }
        Setting::Damping(row) => scaled_joints(task, "damping", variation.dampings.get(row)),
        Setting::Stiffness(row) => scaled_joints(task, "stiffness", variation.stiffnesses.get(row)),
        Setting::ObjectMass(row) => {
            let known = variation.masses.get(row).and_then(|known| task.scene.objects.get(known.object));
            known.map_or_else(|| row.to_string(), |object| format!("{}.mass", object.name))
        }
        Setting::Friction(row) => {
            let object = variation.frictions.get(row).and_then(|known| task.scene.objects.get(known.object?));
            format!("{}.friction", object.map_or("ground", |object| &object.name))
        }
        Setting::ObjectJoint(row) => variation.joints.get(row).map_or_else(|| row.to_string(), |known| joint_value(task, known)),
        Setting::ObjectShape(row, number) => {
            let known = variation.shapes.get(row);
            let object = known.and_then(|known| task.scene.objects.get(known.object));
            let (Some(known), Some(object)) = (known, object) else { return row.to_string() };
            format!("{}.{}", object.name, known.shape.number_name(number))
        }
    }
}

/// `damping of knee_angle_r`
fn scaled_joints(task: &CompiledTask, what: &str, scaling: Option<&Scaling>) -> String {
    let joints = &task.vocabulary.joints;
    let own = joints.iter().filter(|joint| !joint.of_scene).count();
    scaled(what, scaling, own, |joint| joints.get(joint).map(|joint| joint.name.as_str()))
}

/// `door.swing.damping`
fn joint_value(task: &CompiledTask, known: &JointValue) -> String {
    let object = task.scene.objects.get(known.object).map(|object| &object.motion);
    let joint = match object {
        Some(Motion::Joints(joints)) => joints.get(known.joint).map_or("?", |joint| &joint.name),
        _ => "?",
    };
    format!("{joint}.{}", if known.property == Property::Stiffness { "stiffness" } else { "damping" })
}

/// What a row of factors scales: `strength of soleus_l, soleus_r`; all that could be is said to be.
fn scaled<'a>(what: &str, scaling: Option<&Scaling>, all: usize, name: impl Fn(usize) -> Option<&'a str>) -> String {
    let members = scaling.map_or(&[][..], |scaling| &scaling.members);
    match members.len() == all {
        true => format!("{what} of all"),
        false => format!("{what} of {}", runs(members, |member| name(member).unwrap_or("?").to_owned())),
    }
}

/// Names of members of a list, neighbours in it joined.
pub(super) fn runs(members: &[usize], name: impl Fn(usize) -> String) -> String {
    let runs = members.chunk_by(|a, b| *b == a + 1).map(|run| match run {
        [first, .., last] if run.len() > 3 => format!("{} to {} ({})", name(*first), name(*last), run.len()),
        _ => run.iter().map(|member| name(*member)).collect::<Vec<_>>().join(", "),
    });
    runs.collect::<Vec<_>>().join(", ")
}
