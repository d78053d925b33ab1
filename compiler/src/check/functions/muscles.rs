//! Muscles and the joints that they cross.

use super::Call;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::types::{ElementType, Type};
use crate::check::value::{Data, Thing, Value};
use crate::diagnostics::codes;
use crate::frame::Sensor;
use crate::vocabulary::JointKind;

/// The arm of a muscle, or of each of several, about one joint.
pub(super) fn moment_arm<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [muscle, joint] = call.take(checker, ["muscle", "joint"])?;
    let (pulling, turned) = (checker.value(muscle), checker.value(joint));
    let (things, list) = match pulling? {
        Value::Thing(thing) => (vec![thing], false),
        Value::Things { members, .. } => (members, true),
        Value::Data(_) => (Vec::new(), false),
    };
    let muscles: Vec<usize> =
        things.iter().filter_map(|thing| if let Thing::Muscle(index) = thing { Some(*index) } else { None }).collect();
    if muscles.is_empty() || muscles.len() != things.len() {
        let message = "`moment_arm` takes a muscle, or several, and a joint";
        return Err(checker.error(codes::types::WRONG_TYPE, muscle.span, message));
    }
    let Value::Thing(Thing::Joint(about)) = turned? else {
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
    Ok(Data::new(node, Type::one_or_list(ElementType::Number(dimension), list, count)))
}
