//! Muscles and the joints that they cross.

use super::Call;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::types::{ElementType, Type};
use crate::check::value::{EntityRef, TypedValue, Value};
use crate::diagnostics::codes;
use crate::frame::Sensor;
use crate::vocabulary::JointKind;

/// The arm of a muscle, or of each of several, about one joint.
pub(super) fn moment_arm<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<TypedValue> {
    let [muscle, joint] = call.take(checker, ["muscle", "joint"])?;
    let (pulling, turned) = (checker.value(muscle), checker.value(joint));
    let (things, list) = match pulling? {
        Value::Entity(thing) => (vec![thing], false),
        Value::Entities { members, .. } => (members, true),
        Value::Typed(_) => (Vec::new(), false),
    };
    let muscles: Vec<usize> =
        things.iter().filter_map(|thing| if let EntityRef::Muscle(index) = thing { Some(*index) } else { None }).collect();
    if muscles.is_empty() || muscles.len() != things.len() {
        let message = "`moment_arm` takes a muscle, or several, and a joint";
        return Err(checker.error(codes::types::WRONG_TYPE, muscle.span, message));
    }
    let Value::Entity(EntityRef::Joint(about)) = turned? else {
        let message = "the moment arm is taken about one joint";
        return Err(checker.error(codes::types::WRONG_TYPE, joint.span, message));
    };
    checker.spend(muscles.len(), call.span)?;
    let dimension = match checker.vocabulary.joints[about].kind {
        JointKind::Hinge => Dimension::LENGTH,
        JointKind::Slide => Dimension::NONE,
    };
    let count = muscles.len();
    let node = checker.graph.sensors(muscles.into_iter().map(|muscle| Sensor::MomentArm(muscle, about)).collect());
    Ok(TypedValue::new(node, Type::one_or_list(ElementType::Number(dimension), list, count)))
}
