//! Lints on what is looked at: by the policy, by ends, by success, and on both sides of the body.

use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::frame::{Sensor, Subject};
use crate::graph::interval::Bounds;
use crate::graph::operation::{Binary, Memory, Operation, Unary};
use crate::graph::{Graph, NodeId};
use crate::init::{Init, ObjectStart, Setting};
use crate::quantity::dimension::Dimension;
use crate::resolve::scope::Definition;
use crate::scene::{Motion, Object, Parent, Part};
use crate::spoken::SpokenUnit;
use crate::syntax::tree::TaskStatement;
use crate::vocabulary::JointKind;
use std::collections::BTreeSet;

/// Channels whose numbers never change.
pub(super) fn constant_channels(
    checker: &Checker<'_>,
    task: &CheckedTask<'_>,
    bounds: &[Vec<Bounds>],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let parameter = |name: &str| {
        checker.names.of_task().any(|(known, declared)| known == name && matches!(declared.definition, Definition::Parameter(_)))
    };
    for channel in &task.channels {
        let words = channel.source.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        // What is set from outside is constant within a task only.
        if bounds[channel.node.index()].iter().all(|lane| lane.single().is_some()) && !words.into_iter().any(parameter) {
            let message = format!("the channel `{}` never changes", channel.name);
            let diagnostic = Diagnostic::new(codes::intent::CONSTANT_CHANNEL, channel.file, channel.span, message)
                .help("it contains no information: is a fixed quantity observed by mistake?");
            diagnostics.push(diagnostic);
        }
    }
}

/// Failures that time alone decides.
pub(super) fn timed_failures(task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    for end in &task.terminations {
        let decided = bounds[end.node.index()].iter().all(|lane| lane.single().is_some());
        let by_time = |id: &NodeId| {
            let operation = &task.graph.node(*id).operation;
            !operation.is_held() && !matches!(operation, Operation::Sensors(_) | Operation::PhaseSuccess(_))
        };
        if !decided && task.graph.reachable([end.node]).iter().all(by_time) {
            let message = format!("the failure `{}` depends on time alone", end.name);
            let diagnostic = Diagnostic::new(codes::intent::TIMED_FAILURE, end.file, end.span, message)
                .help("reaching the time limit is not a failure: use `horizon`, or move the reason to `finish`");
            diagnostics.push(diagnostic);
        }
    }
}

/// A success that one step of a speed or of a contact settles for good.
pub(super) fn fleeting(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let graph = &task.graph;
    let things = Things::of(checker, task);
    let settled = graph.reachable([task.success]).into_iter().find(|&id| {
        let node = graph.node(id);
        node.operation == Operation::Memory(Memory::Highest)
            && node.inputs.iter().any(|&input| is_condition(graph, input) && momentary(graph, input, &things))
    });
    if settled.is_some() {
        let (file, span) = task.success_at;
        let message = "a single step of a speed or of a contact decides the success of the whole episode";
        let diagnostic = Diagnostic::new(codes::intent::TRANSIENT_SUCCESS, file, span, message)
            .help("require a duration: `ever(held(c, 0.5 s))`");
        diagnostics.push(diagnostic);
    }
}

pub(super) fn is_condition(graph: &Graph, node: NodeId) -> bool {
    match &graph.node(node).operation {
        Operation::Binary(function) => {
            matches!(function, Binary::Less | Binary::LessEqual | Binary::Equal | Binary::And | Binary::Or)
        }
        Operation::Unary(function) => *function == Unary::Not,
        Operation::Sensors(sensors) => {
            sensors.iter().all(|sensor| matches!(sensor, Sensor::Touching(..) | Sensor::GroundContact(_)))
        }
        _ => false,
    }
}

/// Whether a node reads a speed or a contact, and nothing in it lasts.
///
/// What a blow leaves behind is no matter of one step: the speed of a thing that rests until something hits it. Neither is the blow
/// itself, a single contact with a thing that flies off; several at once hold it.
fn momentary(graph: &Graph, node: NodeId, things: &Things<'_>) -> bool {
    let read = graph.reachable([node]);
    let lasts = |id: &NodeId| matches!(graph.node(*id).operation, Operation::Memory(Memory::Streak | Memory::Accumulate));
    let sensors = read.iter().filter_map(|id| match &graph.node(*id).operation {
        Operation::Sensors(sensors) => Some(sensors),
        _ => None,
    });
    let (mut speeds, mut contacts) = (BTreeSet::new(), BTreeSet::new());
    for &sensor in sensors.flatten() {
        use Sensor as S;
        match sensor {
            S::LandmarkVelocity(index) if !things.rests_freely(index) => _ = speeds.insert(sensor),
            S::ComVelocity | S::JointVelocity(_) | S::RootVelocity | S::Slip(..) => _ = speeds.insert(sensor),
            S::Touching(..) | S::GroundContact(_) | S::ContactForce(..) | S::ContactCount(..) => _ = contacts.insert(sensor),
            _ => {}
        }
    }
    let blow = |sensor: &Sensor| match sensor.subject() {
        Subject::Parts(a, b) => [a, b].iter().any(|part| matches!(part, Part::Landmark(index) if things.rests_freely(*index))),
        _ => false,
    };
    let only_blow = contacts.len() == 1 && contacts.iter().all(blow);
    !read.iter().any(lasts) && (!speeds.is_empty() || !contacts.is_empty() && !only_blow)
}

/// The sensors that nodes read, as far as they are of a kind.
fn sensors(graph: &Graph, roots: impl Iterator<Item = NodeId>, kind: fn(Sensor) -> bool) -> BTreeSet<Sensor> {
    let mut found = BTreeSet::new();
    for id in graph.reachable(roots) {
        if let Operation::Sensors(sensors) = &graph.node(id).operation {
            found.extend(sensors.iter().copied().filter(|sensor| kind(*sensor)));
        }
    }
    found
}

/// The landmark that a sensor measures.
fn landmark_of(sensor: Sensor) -> Option<usize> {
    if let Subject::Landmark(index) = sensor.subject() { Some(index) } else { None }
}

/// Objects that move and decide reward or ends, and that no channel observes.
pub(super) fn unseen(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let things = Things::of(checker, task);
    let channels = || task.observed().map(|channel| channel.node);
    let seen: BTreeSet<usize> = sensors(&task.graph, channels(), |sensor| landmark_of(sensor).is_some())
        .into_iter()
        .filter_map(|sensor| things.mover(landmark_of(sensor)?))
        .collect();
    let measured = sensors(&task.graph, channels(), |sensor| matches!(sensor, Sensor::JointPosition(_)));
    let measured: BTreeSet<&str> = measured
        .into_iter()
        .filter_map(|sensor| checker.vocabulary.joints.get(joint_of(sensor)?))
        .map(|j| j.name.as_str())
        .collect();
    let mut reported = BTreeSet::new();
    let terms = task.terms.iter().map(|term| ("the reward".to_owned(), term.node, term.file, term.formula.span));
    let ends = task.terminations.iter().chain(&task.finishes);
    let ends = ends.map(|end| (format!("the termination `{}`", end.name), end.node, end.file, end.span));
    for (what, node, file, span) in terms.chain(ends) {
        let read = sensors(&task.graph, std::iter::once(node), |sensor| landmark_of(sensor).is_some());
        for index in read.into_iter().filter_map(landmark_of) {
            let Some(mover) = things.mover(index) else { continue };
            if !seen.contains(&mover) && !things.follows_from(mover, &seen, &measured) && reported.insert(index) {
                let name = &checker.vocabulary.landmarks[index].name;
                let message = format!("{what} depends on the place of `{name}`, which is not observed");
                let diagnostic = Diagnostic::new(codes::intent::UNOBSERVED_OBJECT, file, span, message)
                    .help(format!("add it to `observe`: `{name}.position - pelvis.position`"));
                diagnostics.push(diagnostic);
            }
        }
    }
}

/// Whether an object moves, by itself or with what carries it.
pub(super) fn moves(objects: &[Object], index: usize) -> bool {
    let Some(object) = objects.get(index) else { return false };
    object.motion != Motion::Fixed
        || match &object.parent {
            Parent::World => false,
            // Parents stand before what they carry.
            Parent::Object(parent) => *parent < index && moves(objects, *parent),
            Parent::Landmark(_) => true,
        }
}

fn joint_of(sensor: Sensor) -> Option<usize> {
    if let Subject::Joint(index) = sensor.subject() { Some(index) } else { None }
}

/// The objects of a scene, by the landmarks that they are in formulas.
struct Things<'t> {
    objects: &'t [Object],
    init: &'t Init,
    /// The landmark of the first object.
    first: usize,
}

impl<'t> Things<'t> {
    fn of(checker: &Checker<'_>, task: &'t CheckedTask<'_>) -> Self {
        let landmarks = &checker.vocabulary.landmarks;
        let first = landmarks.iter().position(|landmark| landmark.of_scene).unwrap_or(landmarks.len());
        Self { objects: &task.scene.objects, init: &task.init, first }
    }

    /// The object that a landmark is, if it is one.
    fn object(&self, landmark: usize) -> Option<usize> {
        landmark.checked_sub(self.first).filter(|object| *object < self.objects.len())
    }

    /// The object that moves by itself and takes a landmark along: what it is rigidly part of. None of what stands still, and of
    /// what the body wears, which goes where the body does.
    fn mover(&self, landmark: usize) -> Option<usize> {
        carrier(self.objects, self.object(landmark)?)
    }

    /// Whether the place of a moving object follows from those that are `seen` and from joints that are measured: all between it
    /// and what is known.
    fn follows_from(&self, mover: usize, seen: &BTreeSet<usize>, measured: &BTreeSet<&str>) -> bool {
        let mut index = mover;
        loop {
            let object = &self.objects[index];
            let Motion::Joints(joints) = &object.motion else { return false };
            if !joints.iter().all(|joint| measured.contains(joint.name.as_str())) {
                return false;
            }
            let above = match &object.parent {
                Parent::Object(parent) if *parent < index => carrier(self.objects, *parent),
                _ => None,
            };
            match above {
                // Carried by the world, by what stands still, or by the body.
                None => return true,
                Some(above) if seen.contains(&above) => return true,
                Some(above) => index = above,
            }
        }
    }

    /// Whether a landmark is part of a free object that begins at rest.
    fn rests_freely(&self, landmark: usize) -> bool {
        let Some(mover) = self.mover(landmark) else { return false };
        let at_rest = |start: &ObjectStart| start.velocity == [0.0; 3] && start.spin == [0.0; 3];
        let place = self.init.objects.iter().position(|start| start.object == mover);
        let drawn = |(setting, _): &(Setting, usize)| match setting {
            Setting::ObjectVelocity(object, _) | Setting::ObjectSpin(object, _) => Some(*object) == place,
            _ => false,
        };
        let rests = place.is_none_or(|place| at_rest(&self.init.objects[place]) && !self.init.drawn.iter().any(drawn));
        self.objects[mover].motion == Motion::Free && rests
    }
}

/// The object that moves and carries an object rigidly, or the object itself; nothing where it stands still or the body carries it.
pub(super) fn carrier(objects: &[Object], index: usize) -> Option<usize> {
    let object = objects.get(index)?;
    match &object.parent {
        _ if object.motion != Motion::Fixed => Some(index),
        Parent::Object(parent) if *parent < index => carrier(objects, *parent),
        _ => None,
    }
}

/// In a task declared symmetric: parts of one side that are read, while those of the other are not.
pub(super) fn one_side(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    if !task.symmetric {
        return;
    }
    lopsided(checker, task, diagnostics);
    let names = |roots: &[NodeId]| -> BTreeSet<&str> {
        sensors(&task.graph, roots.iter().copied(), |_| true).into_iter().flat_map(|sensor| names_of(checker, sensor)).collect()
    };
    let rewarded: Vec<NodeId> = task.terms.iter().map(|term| term.node).collect();
    let ends: Vec<NodeId> = task.terminations.iter().chain(&task.finishes).map(|end| end.node).collect();
    for (roots, what) in [(rewarded, "the reward"), (ends, "a termination")] {
        let read = names(&roots);
        let other = |name: &str| match (name.strip_suffix("_l"), name.strip_suffix("_r")) {
            (Some(stem), _) => Some(format!("{stem}_r")),
            (_, Some(stem)) => Some(format!("{stem}_l")),
            _ => None,
        };
        let missing = |other: &String| !read.contains(other.as_str()) && checker.body_element(other).is_some();
        let alone = read.iter().find_map(|name| Some((*name, other(name).filter(missing)?)));
        let Some((name, missing)) = alone else { continue };
        let place = task.terms.iter().map(|term| (term.node, term.file, term.formula.span));
        let place = place.chain(task.terminations.iter().chain(&task.finishes).map(|end| (end.node, end.file, end.span)));
        let mut place = place.filter(|(node, ..)| roots.contains(node) && names(&[*node]).contains(name));
        let Some((_, file, span)) = place.next() else { continue };
        let message = format!("the task is `symmetric`, but {what} reads `{name}` and never `{missing}`");
        let diagnostic = Diagnostic::new(codes::intent::ONE_SIDE, file, span, message)
            .help(format!("read both, `{}`, or remove `symmetric`", pair(name)));
        diagnostics.push(diagnostic);
    }
}

/// An initial state in which one side is posed otherwise than the other.
fn lopsided(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let joints = &checker.vocabulary.joints;
    let posed = |index: usize| task.init.coordinates.get(index).copied();
    for (index, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.independent && !joint.of_scene) {
        let Some(stem) = joint.name.strip_suffix("_l") else { continue };
        let Some(other) = joints.iter().position(|known| known.name.strip_suffix("_r") == Some(stem)) else { continue };
        // Joints that stand alike have axes that mirror each other.
        let (Some(left), Some(right)) = (posed(index), posed(other)) else { continue };
        if joint.neutral == joints[other].neutral && (left - right).abs() > 1e-9 {
            let (name, unlike) = (&joint.name, &joints[other].name);
            let unit = SpokenUnit::of(if joint.kind == JointKind::Hinge { Dimension::ANGLE } else { Dimension::LENGTH });
            let message = format!(
                "the task is `symmetric`, but starts with `{name}` at {} and `{unlike}` at {}",
                unit.tell(left),
                unit.tell(right)
            );
            let place = task.success_at;
            let span = checker.statements.iter().rev().find_map(|placed| match &placed.statement {
                TaskStatement::Init(block) => Some((placed.file, block.keyword)),
                _ => None,
            });
            let (file, span) = span.unwrap_or(place);
            let diagnostic = Diagnostic::new(codes::intent::ONE_SIDE, file, span, message)
                .help(format!("set both to the same value, `{} = ...`, or remove `symmetric`", pair(name)));
            diagnostics.push(diagnostic);
            return;
        }
    }
}

fn pair(name: &str) -> String {
    format!("{}{{l,r}}", &name[..name.len() - 1])
}

/// The names of what a sensor measures, as tasks call them.
fn names_of<'a>(checker: &Checker<'a>, sensor: Sensor) -> Vec<&'a str> {
    let body = checker.vocabulary;
    let landmark = |index: usize| body.landmarks.get(index).map(|landmark| landmark.name.as_str());
    let joint = |index: usize| body.joints.get(index).map(|joint| joint.name.as_str());
    let muscle = |index: usize| body.muscles.get(index).map(|muscle| muscle.name.as_str());
    let part = |part: Part| match part {
        Part::Landmark(index) => landmark(index),
        Part::Group(index) => body.groups.get(index).map(|group| group.name.as_str()),
        Part::Ground | Part::Robot => None,
    };
    let names = match sensor.subject() {
        Subject::Landmark(index) => [landmark(index), None],
        Subject::Joint(index) => [joint(index), None],
        Subject::Muscle(index) => [muscle(index), None],
        Subject::MuscleAbout(first, second) => [muscle(first), joint(second)],
        Subject::Parts(a, b) => [part(a), part(b)],
        Subject::Whole | Subject::Query(_) => [None, None],
    };
    names.into_iter().flatten().collect()
}
