//! Layout: values that meet, brought to one number of elements and of lanes.

use crate::graph::operation::Unary;
use crate::graph::{Graph, NodeId};
use crate::hir::types::{ElementType, Type};
use crate::hir::value::TypedValue;

/// The lanes of a value laid out for `length` elements of `lanes` lanes, where one lane may stand for all.
pub(crate) fn spread(graph: &mut Graph, value: &TypedValue, length: usize, lanes: usize) -> NodeId {
    let own = value.kind.element_lanes();
    let elements = value.kind.shape().count();
    let width = graph.width(value.node);
    if width == 1 || width == length * lanes {
        return value.node;
    }
    let lane = |element: usize, lane: usize| {
        let element = if elements == 1 { 0 } else { element };
        element * own + if own == 1 { 0 } else { lane }
    };
    let wanted: Vec<usize> = (0..length).flat_map(|e| (0..lanes).map(move |l| lane(e, l))).collect();
    graph.select(wanted, value.node)
}

/// Every element of one lane repeated for so many: a written zero among vectors stands for all their components.
pub(crate) fn spread_each(graph: &mut Graph, value: &TypedValue, lanes: usize) -> NodeId {
    if value.kind.element_lanes() == lanes {
        return value.node;
    }
    let count = value.kind.shape().count();
    graph.select((0..count).flat_map(|place| std::iter::repeat_n(place, lanes)), value.node)
}

/// The element at `place`.
pub(crate) fn element(graph: &mut Graph, value: &TypedValue, place: usize) -> NodeId {
    let lanes = value.kind.element_lanes();
    graph.select(place * lanes..(place + 1) * lanes, value.node)
}

/// What `compute` makes of the lanes of a node of this type, which is given whether they wrap; each way where only some do.
pub(crate) fn by_wrapping(
    graph: &mut Graph,
    node: NodeId,
    ty: &Type,
    compute: impl Fn(&mut Graph, NodeId, bool) -> NodeId,
) -> NodeId {
    let wraps = |element: ElementType| element == ElementType::WrappingAngle;
    if ty.all(wraps) {
        return compute(graph, node, true);
    }
    let straight = compute(graph, node, false);
    if ty.all(|element| !wraps(element)) {
        return straight;
    }
    let round = compute(graph, node, true);
    let count = ty.shape().count();
    let both = graph.join(&[straight, round]);
    graph.select((0..count).map(|place| if wraps(ty.element_at(place)) { count + place } else { place }), both)
}

/// A node of this type, its angles that wrap brought into (-pi, pi].
pub(crate) fn wrapped(graph: &mut Graph, node: NodeId, ty: &Type) -> NodeId {
    by_wrapping(graph, node, ty, |graph, node, wraps| if wraps { graph.unary(Unary::Wrap, node) } else { node })
}
