//! Contact between parts of the body, objects, groups of them, the whole body and the ground.

use super::Call;
use crate::check::context::{Checked, Checker, Reported};
use crate::check::dimension::Dimension;
use crate::check::types::{ElementType, Type};
use crate::check::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::{Span, codes};
use crate::emit::places;
use crate::frame::Sensor;
use crate::graph::NodeId;
use crate::graph::operation::{Reduction, Unary};
use crate::scene::Part;
use crate::syntax::tree::Expr;
use crate::vocabulary::GroupKind;

/// One side of a contact.
enum Side {
    /// One thing; a named group is one.
    One(Part),
    /// Several, each by itself.
    List(Vec<Part>),
    /// Several that count as one, but have no name.
    Union(Vec<Part>),
}

impl Side {
    fn parts(&self) -> &[Part] {
        match self {
            Self::One(part) => std::slice::from_ref(part),
            Self::List(parts) | Self::Union(parts) => parts,
        }
    }
}

/// Pairs of parts, and whether each of them is an answer of its own.
struct Pairs {
    pairs: Vec<(Part, Part)>,
    list: bool,
}

fn pairs<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Pairs> {
    let [a, b] = call.take(checker, ["a", "b"])?;
    let (first, second) = (checker.value(a), checker.value(b));
    let (first, second) = (first?, second?);
    if first == second && !matches!(first, Value::Typed(_)) {
        let message = format!("both arguments of `{}` are identical", call.name);
        return Err(checker.error(codes::types::WRONG_TYPE, call.span, message));
    }
    let with_ground = [&first, &second].contains(&&Value::Entity(EntityRef::Ground));
    let (left, right) = (side(checker, call, first, a, with_ground), side(checker, call, second, b, with_ground));
    let (left, right) = (left?, right?);
    let list = matches!(left, Side::List(_)) || matches!(right, Side::List(_));
    let union = matches!(left, Side::Union(_)) || matches!(right, Side::Union(_));
    let (some, others) = (left.parts(), right.parts());
    let pairs: Vec<(Part, Part)> = match (&left, &right) {
        (Side::List(_), Side::List(_)) if some.len() == others.len() => {
            some.iter().copied().zip(others.iter().copied()).collect()
        }
        (Side::List(_), Side::List(_)) => {
            let message = format!("one side has {} parts, the other {}", some.len(), others.len());
            return Err(checker.error(codes::types::LENGTHS_DIFFER, call.span, message));
        }
        _ => some.iter().flat_map(|&part| others.iter().map(move |&other| (part, other))).collect(),
    };
    if list && union {
        let message = "a list and a pattern cannot be paired";
        let diagnostic = checker
            .diagnostic(codes::types::WRONG_TYPE, call.span, message)
            .help("declare the set as a `group`, which acts as one entity");
        return Err(checker.report(diagnostic));
    }
    if pairs.is_empty() {
        return Err(checker.error(codes::names::NOTHING_FITS, call.span, "one argument is empty: there is nothing to touch"));
    }
    checker.spend(pairs.len(), call.span)?;
    Ok(Pairs { pairs, list })
}

/// What an argument stands for. Against the ground a group is asked part by part, as its landmarks are.
fn side<'a>(checker: &mut Checker<'a>, call: &Call<'a>, value: Value, expr: &'a Expr, with_ground: bool) -> Checked<Side> {
    match value {
        Value::Entity(thing) => Ok(Side::One(part(checker, thing, expr.span)?)),
        Value::Entities { members, group } => {
            let parts: Vec<Part> = members.iter().map(|&thing| part(checker, thing, expr.span)).collect::<Checked<_>>()?;
            let named = named_group(checker, &members).filter(|_| !with_ground);
            Ok(match (group, named) {
                (true, Some(index)) => Side::One(Part::Group(index)),
                (true, None) => Side::Union(parts),
                (false, _) => Side::List(parts),
            })
        }
        Value::Typed(data) => {
            let found = data.kind.described(checker.vocabulary);
            let message = format!("`{}` takes parts of the body, objects, `robot` or `ground`", call.name);
            let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            Err(checker.report(diagnostic))
        }
    }
}

fn part(checker: &mut Checker<'_>, thing: EntityRef, span: Span) -> Checked<Part> {
    match thing {
        EntityRef::Robot => Ok(Part::Robot),
        EntityRef::Ground if checker.has_ground() => Ok(Part::Ground),
        EntityRef::Ground => Err(checker.no_ground(span)),
        EntityRef::Landmark(index) if checker.can_touch(index) => Ok(Part::Landmark(index)),
        other => {
            let message = format!("{} has no solid shape, so it cannot touch anything", checker.thing_name(other));
            let diagnostic = checker.diagnostic(codes::names::UNKNOWN_PROPERTY, span, message);
            let own = matches!(other, EntityRef::Landmark(index) if !checker.vocabulary.landmarks[index].of_scene);
            let help = if own {
                format!("landmarks with one: {}", checker.segments_in_words())
            } else {
                "a landmark with a segment, an object, `robot` or `ground` can touch".to_owned()
            };
            Err(checker.report(diagnostic.help(help)))
        }
    }
}

/// The group of landmarks with exactly these members.
fn named_group(checker: &Checker<'_>, members: &[EntityRef]) -> Option<usize> {
    let landmarks: Option<Vec<usize>> =
        members.iter().map(|thing| if let EntityRef::Landmark(index) = thing { Some(*index) } else { None }).collect();
    let landmarks = landmarks?;
    checker.vocabulary.groups.iter().position(|group| group.kind == GroupKind::Landmarks && group.members == landmarks)
}

impl Checker<'_> {
    /// Whether there is anything to stand on.
    pub(crate) fn has_ground(&self) -> bool {
        let Some(scene) = self.scene.map(|scene| &scene.description) else { return true };
        scene.ground.is_some() || scene.objects.iter().any(|object| object.surface.walkable)
    }

    /// Reports that there is not.
    pub(crate) fn no_ground(&mut self, span: Span) -> Reported {
        let diagnostic = self
            .diagnostic(codes::scene::NO_GROUND, span, "this scene has no ground")
            .help("declare `ground` in the scene, or mark an object `walkable`");
        self.report(diagnostic)
    }

    /// Whether a landmark's segment, or an object with all that it carries, has anything solid.
    pub(crate) fn can_touch(&self, index: usize) -> bool {
        let landmarks = &self.vocabulary.landmarks;
        let Some(landmark) = landmarks.get(index) else { return false };
        let prefix = format!("{}.", landmark.name);
        let carried =
            |other: &crate::vocabulary::Landmark| other.of_scene && other.has_segment && other.name.starts_with(&prefix);
        landmark.has_segment || landmark.of_scene && landmarks.iter().any(carried)
    }
}

/// The parts in an order that does not depend on how they are written.
fn unordered((a, b): (Part, Part)) -> (Part, Part) {
    if a <= b { (a, b) } else { (b, a) }
}

/// A landmark of the body against the ground has a sensor of its own.
fn on_ground(checker: &Checker<'_>, pair: (Part, Part)) -> Option<usize> {
    match pair {
        (Part::Landmark(index), Part::Ground) | (Part::Ground, Part::Landmark(index)) => {
            (!checker.vocabulary.landmarks[index].of_scene).then_some(index)
        }
        _ => None,
    }
}

/// One number per pair; of several that count as one, their `reduction`.
fn numbers(
    checker: &mut Checker<'_>,
    pairs: &Pairs,
    sensors: Vec<Sensor>,
    reduction: Reduction,
    element: ElementType,
) -> TypedValue {
    let node = checker.graph.sensors(sensors);
    let count = pairs.pairs.len();
    if pairs.list {
        return TypedValue::new(node, Type::List(element, count));
    }
    let node = if count == 1 { node } else { checker.graph.reduce(reduction, count, node) };
    TypedValue::new(node, element)
}

pub(super) fn touching<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let pairs = pairs(checker, call)?;
    let sensor = |&pair: &(Part, Part)| match on_ground(checker, pair) {
        Some(index) => Sensor::GroundContact(index),
        None => {
            let (a, b) = unordered(pair);
            Sensor::Touching(a, b)
        }
    };
    let sensors = pairs.pairs.iter().map(sensor).collect();
    Ok(numbers(checker, &pairs, sensors, Reduction::Maximum, ElementType::Bool))
}

pub(super) fn contact_count<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let pairs = pairs(checker, call)?;
    let sensor = |&pair: &(Part, Part)| {
        let (a, b) = unordered(pair);
        Sensor::ContactCount(a, b)
    };
    let sensors = pairs.pairs.iter().map(sensor).collect();
    Ok(numbers(checker, &pairs, sensors, Reduction::Sum, ElementType::Int))
}

pub(super) fn surface_distance<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let pairs = pairs(checker, call)?;
    let sensor = |&pair: &(Part, Part)| {
        let (a, b) = unordered(pair);
        Sensor::SurfaceDistance(a, b)
    };
    let sensors = pairs.pairs.iter().map(sensor).collect();
    Ok(numbers(checker, &pairs, sensors, Reduction::Minimum, ElementType::Number(Dimension::LENGTH)))
}

pub(super) fn slip<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let pairs = pairs(checker, call)?;
    let sensors = pairs.pairs.iter().map(|&(a, b)| Sensor::Slip(a, b)).collect();
    Ok(numbers(checker, &pairs, sensors, Reduction::Maximum, ElementType::Number(Dimension::SPEED)))
}

pub(super) fn contact_force<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let pairs = pairs(checker, call)?;
    let count = pairs.pairs.len();
    let forces: Vec<NodeId> = pairs.pairs.iter().map(|&pair| force(checker, pair)).collect();
    let node = checker.graph.join(&forces);
    let force = ElementType::world_vector(Dimension::FORCE);
    if pairs.list {
        return Ok(TypedValue::new(node, Type::List(force, count)));
    }
    if count == 1 {
        return Ok(TypedValue::new(node, force));
    }
    Ok(TypedValue::new(places::total(&mut checker.graph, node, count), force))
}

/// The force on the first part by the second.
fn force(checker: &mut Checker<'_>, pair: (Part, Part)) -> NodeId {
    match on_ground(checker, pair) {
        Some(index) => {
            let node = checker.graph.sensors(vec![Sensor::GroundForce(index)]);
            // Action and reaction: the force on the ground by the body.
            if pair.0 == Part::Ground { checker.graph.unary(Unary::Negate, node) } else { node }
        }
        None => checker.graph.sensors(vec![Sensor::ContactForce(pair.0, pair.1)]),
    }
}
