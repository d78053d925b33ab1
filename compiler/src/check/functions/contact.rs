//! Contact of parts of the body with the ground.

use super::Call;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::types::Type;
use crate::check::value::{Data, Thing, Value};
use crate::diagnostics::codes;
use crate::frame::Sensor;
use crate::graph::operation::{Reduction, Unary};

/// The landmarks of one side, whether they are a list, and whether the ground is named first.
fn parts<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<(Vec<usize>, bool, bool)> {
    let [a, b] = call.take(checker, ["a", "b"])?;
    let (first, second) = (checker.value(a), checker.value(b));
    let (first, second) = (first?, second?);
    let ground_first = first == Value::Thing(Thing::Ground);
    let (part, expr) = match (ground_first, &second) {
        (true, _) => (second, b),
        (false, Value::Thing(Thing::Ground)) => (first, a),
        _ => {
            let message = format!("`{}` between two parts is not supported yet; one side must be `ground`", call.name);
            return Err(checker.error(codes::names::NOT_YET, call.span, message));
        }
    };
    let (things, list) = match part {
        Value::Thing(thing) => (vec![thing], false),
        Value::Things { members, group } => (members, !group),
        Value::Data(data) => {
            let found = data.kind.described(checker.vocabulary);
            let message = format!("`{}` takes parts of the body", call.name);
            let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            return Err(checker.report(diagnostic));
        }
    };
    let mut landmarks = Vec::new();
    for thing in things {
        match thing {
            Thing::Landmark(index) if checker.vocabulary.landmarks[index].has_segment => landmarks.push(index),
            other => {
                let message = format!("{} has no segment, so it cannot touch anything", checker.thing_name(other));
                return Err(checker.error(codes::names::UNKNOWN_PROPERTY, expr.span, message));
            }
        }
    }
    Ok((landmarks, list, ground_first))
}

pub(super) fn touching<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (landmarks, list, _) = parts(checker, call)?;
    let count = landmarks.len();
    let each = checker.graph.sensors(landmarks.into_iter().map(Sensor::GroundContact).collect());
    if list {
        return Ok(Data::new(each, Type::List(Box::new(Type::Bool), count)));
    }
    let node = checker.graph.reduce(Reduction::Maximum, count, each);
    Ok(Data::new(node, Type::Bool))
}

pub(super) fn contact_force<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (landmarks, list, ground_first) = parts(checker, call)?;
    let count = landmarks.len();
    let mut node = checker.graph.sensors(landmarks.into_iter().map(Sensor::GroundForce).collect());
    if ground_first {
        // Action and reaction: the force on the ground by the body.
        node = checker.graph.unary(Unary::Negate, node);
    }
    let kind = Type::world_vector(Dimension::FORCE);
    if list {
        return Ok(Data::new(node, Type::List(Box::new(kind), count)));
    }
    let by_axis = checker.graph.select((0..3).flat_map(|axis| (0..count).map(move |place| 3 * place + axis)), node);
    let node = checker.graph.reduce(Reduction::Sum, count, by_axis);
    Ok(Data::new(node, kind))
}
