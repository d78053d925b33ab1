//! Questions to the ground and to what stands on it. A sensor answers them before formulas are evaluated, so what they ask
//! for must be a landmark, a landmark with a constant offset, or a constant place.

use super::Call;
use crate::check::context::{Checked, Checker, Reported};
use crate::check::dimension::Dimension;
use crate::check::types::{ElementType, Frame, Type};
use crate::check::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::codes;
use crate::frame::{Origin, Query, Sensor};
use crate::graph::NodeId;
use crate::graph::operation::Operation;
use crate::syntax::tree::{Argument, Expr, ExprKind};
use crate::vocabulary::GroupKind;

/// Sectors of a radar, points of a scan.
const MOST: f64 = 1000.0;

impl<'a> Checker<'a> {
    /// The node of a query's answer.
    fn query(&mut self, query: Query) -> NodeId {
        let size = query.size();
        let index = self.queries.iter().position(|known| *known == query).unwrap_or_else(|| {
            self.queries.push(query);
            self.queries.len() - 1
        });
        self.graph.sensors(vec![Sensor::Query(index, size)])
    }

    /// Where the ground is asked for: places, and whether they are a list.
    fn origins(&mut self, expr: &'a Expr, offset: [f64; 3]) -> Checked<(Vec<Origin>, bool)> {
        let value = self.value(expr)?;
        let things = match &value {
            Value::Entity(thing) => Some((vec![*thing], false)),
            Value::Entities { members, .. } => Some((members.clone(), true)),
            Value::Typed(_) => None,
        };
        if let Some((things, list)) = things {
            let origin = |thing: &EntityRef| {
                if let EntityRef::Landmark(index) = thing { Some(Origin::Landmark(*index, offset)) } else { None }
            };
            return match things.iter().map(origin).collect::<Option<Vec<_>>>() {
                Some(origins) => Ok((origins, list)),
                None => Err(self.not_a_query(expr)),
            };
        }
        let origin = if let Value::Typed(data) = value { self.place_asked_for(&data, offset) } else { None };
        match origin {
            Some(origin) => Ok((vec![origin], false)),
            None => Err(self.not_a_query(expr)),
        }
    }

    /// A constant place, or the position of a landmark as it is.
    fn place_asked_for(&self, data: &TypedValue, offset: [f64; 3]) -> Option<Origin> {
        let horizontal = data.kind.dimension() == Some(Dimension::LENGTH) || data.is_zero();
        let lanes = self.graph.constant_lanes(data.node);
        match (&data.kind, lanes.as_deref()) {
            (Type::One(ElementType::Place(Frame::World)), Some([x, y, z])) => Some(Origin::World([*x, *y, *z])),
            (Type::List(..) | Type::One(ElementType::Vector { frame: Frame::World, .. }), Some([x, y])) if horizontal => {
                Some(Origin::World([*x, *y, 0.0]))
            }
            (Type::List(..) | Type::One(ElementType::Vector { frame: Frame::World, .. }), Some([x, y, z])) if horizontal => {
                Some(Origin::World([*x, *y, *z]))
            }
            (Type::One(ElementType::Place(Frame::World) | ElementType::Vector { frame: Frame::World, .. }), None) => {
                let node = self.graph.node(data.node);
                let source = match &node.operation {
                    // `.xy` of a position.
                    Operation::Select(lanes) if lanes.as_slice() == [0, 1] => self.graph.node(*node.inputs.first()?),
                    _ => node,
                };
                match &source.operation {
                    Operation::Sensors(sensors) => match sensors.as_slice() {
                        [Sensor::LandmarkPosition(index)] => Some(Origin::Landmark(*index, offset)),
                        _ => None,
                    },
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn not_a_query(&mut self, expr: &Expr) -> Reported {
        let diagnostic = self
            .diagnostic(codes::scene::QUERY, expr.span, "a sensor cannot measure here")
            .expected("a landmark, the position of one, or a constant place")
            .help("pass an offset along the heading as a separate argument: `ground_height(pelvis, [0.3 m, 0, 0])`");
        self.report(diagnostic)
    }

    fn must_have_ground(&mut self, call: &Call<'a>) -> Checked<()> {
        if self.has_ground() { Ok(()) } else { Err(self.no_ground(call.span)) }
    }

    /// The landmark of `heading(pelvis)`, or of `pelvis`.
    fn looker(&mut self, expr: &'a Expr, heading: bool) -> Checked<usize> {
        let inner = match &expr.kind {
            ExprKind::Call { function, arguments } if heading => match (&function.kind, arguments.as_slice()) {
                (ExprKind::Name(name), [Argument { name: None, value }]) if name.text == "heading" => value,
                _ => expr,
            },
            _ => expr,
        };
        match self.value(inner)? {
            Value::Entity(EntityRef::Landmark(index)) => Ok(index),
            _ => {
                let message = "expected a landmark as the origin";
                let example = if heading { "write `scan(heading(pelvis), ...)`" } else { "name one: `torso`" };
                let diagnostic = self.diagnostic(codes::scene::QUERY, expr.span, message).help(example);
                Err(self.report(diagnostic))
            }
        }
    }

    fn positive_constant(&mut self, expr: &'a Expr, dimension: Dimension, name: &str) -> Checked<f64> {
        let value = self.fixed_number(expr, dimension, name)?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(self.error(codes::scene::SIZE, expr.span, format!("{name} must be positive")))
    }
}

/// Place and, if given, offset: both queries of the ground take them.
fn ground<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<(Vec<Origin>, bool)> {
    checker.must_have_ground(call)?;
    if call.arguments.len() == 1 {
        let [place] = call.take(checker, ["place"])?;
        return checker.origins(place, [0.0; 3]);
    }
    let [place, offset] = call.take(checker, ["place", "offset"])?;
    let offset = checker.fixed_bracket(offset, Dimension::LENGTH, "the offset")?;
    let (origins, list) = checker.origins(place, offset)?;
    if origins.iter().any(|origin| matches!(origin, Origin::World(_))) {
        let message = "an offset is along the heading of a landmark; a place has no heading";
        return Err(checker.error(codes::scene::QUERY, call.span, message));
    }
    Ok((origins, list))
}

fn answers(checker: &mut Checker<'_>, queries: Vec<Query>, list: bool, element: ElementType) -> TypedValue {
    let count = queries.len();
    let nodes: Vec<NodeId> = queries.into_iter().map(|query| checker.query(query)).collect();
    let node = checker.graph.join(&nodes);
    TypedValue::new(node, Type::one_or_list(element, list, count))
}

pub(super) fn ground_height<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let (origins, list) = ground(checker, call)?;
    let queries = origins.into_iter().map(Query::GroundHeight).collect();
    Ok(answers(checker, queries, list, ElementType::Number(Dimension::LENGTH)))
}

pub(super) fn ground_normal<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let (origins, list) = ground(checker, call)?;
    let queries = origins.into_iter().map(Query::GroundNormal).collect();
    Ok(answers(checker, queries, list, ElementType::world_vector(Dimension::NONE)))
}

pub(super) fn scan<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    checker.must_have_ground(call)?;
    let [heading, offsets] = call.take(checker, ["heading", "offsets"])?;
    let landmark = checker.looker(heading, true)?;
    let data = checker.data(offsets)?;
    let lengths = data.kind.all(|element| element.is_number() || matches!(element, ElementType::Vector { size: 2, .. }))
        && (data.kind.dimension() == Some(Dimension::LENGTH) || data.is_zero());
    let lanes = checker.graph.constant_lanes(data.node).filter(|lanes| lengths && lanes.len() % 2 == 0);
    let Some(lanes) = lanes.filter(|lanes| !lanes.is_empty() && lanes.len() as f64 <= 2.0 * MOST) else {
        let diagnostic = checker
            .diagnostic(codes::scene::QUERY, offsets.span, "`scan` takes constant offsets from a landmark")
            .expected("pairs of lengths, forward and left: `[[0.3 m, 0.3 m], [0.3 m, 0 m], [0.3 m, -0.3 m]]`")
            .found(data.kind.described(checker.vocabulary));
        return Err(checker.report(diagnostic));
    };
    let offset = |pair: &[f64]| Query::GroundHeight(Origin::Landmark(landmark, [pair[0], pair[1], 0.0]));
    let queries = lanes.chunks_exact(2).map(offset).collect();
    Ok(answers(checker, queries, true, ElementType::Number(Dimension::LENGTH)))
}

pub(super) fn radar<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let [from, group, sectors, over, range] = call.take(checker, ["from", "group", "sectors", "over", "range"])?;
    let from = checker.looker(from, true)?;
    let members = match checker.value(group)? {
        Value::Entities { members, group: true } => members,
        _ => Vec::new(),
    };
    let landmarks: Vec<usize> =
        members.iter().filter_map(|thing| if let EntityRef::Landmark(index) = thing { Some(*index) } else { None }).collect();
    let known =
        checker.vocabulary.groups.iter().position(|known| known.kind == GroupKind::Landmarks && known.members == landmarks);
    let Some(known) = known else {
        let diagnostic = checker
            .diagnostic(codes::scene::QUERY, group.span, "a radar detects the members of a group of objects")
            .help("declare the set in the scene: `group poles = pole_{*}`");
        return Err(checker.report(diagnostic));
    };
    let count = checker.whole(sectors)?;
    if !(1.0..=MOST).contains(&count) {
        return Err(checker.error(codes::scene::SIZE, sectors.span, "a radar has 1 to 1000 sectors"));
    }
    let over_value = checker.positive_constant(over, Dimension::ANGLE, "the angle of a radar")?;
    if over_value > 2.0 * std::f64::consts::PI + 1e-12 {
        return Err(checker.error(codes::scene::SIZE, over.span, "a radar spans at most 360 deg"));
    }
    let range = checker.positive_constant(range, Dimension::LENGTH, "the range of a radar")?;
    let sectors = count as usize;
    let node = checker.query(Query::Radar { from, group: known, sectors, over: over_value, range });
    Ok(TypedValue::new(node, Type::List(ElementType::PLAIN, sectors)))
}

pub(super) fn ray<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let [from, direction, range] = call.take(checker, ["from", "direction", "range"])?;
    let landmark = checker.looker(from, false)?;
    let along: [f64; 3] = checker.fixed_bracket(direction, Dimension::NONE, "the direction of a ray")?;
    let length = libm::sqrt(along.iter().map(|part| part * part).sum());
    if length == 0.0 {
        return Err(checker.error(codes::scene::SIZE, direction.span, "a ray has a direction"));
    }
    let range = checker.positive_constant(range, Dimension::LENGTH, "the range of a ray")?;
    let node = checker.query(Query::Ray { from: landmark, direction: along.map(|part| part / length), range });
    Ok(TypedValue::new(node, ElementType::Number(Dimension::LENGTH)))
}
