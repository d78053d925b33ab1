//! Parts and joints of objects behind a dot: `door.leaf`, `door.swing`.

use crate::check::context::Checker;
use crate::check::value::{EntityRef, Value};
use crate::hir::parts_of;

impl Checker<'_> {
    /// A part or joint of an object, or of each of several: `door.leaf`, `door.swing`.
    pub(crate) fn part_of_object(&self, base: &Value, name: &str) -> Option<Value> {
        let part = |thing: &EntityRef| {
            let EntityRef::Landmark(index) = thing else { return None };
            let object = self.vocabulary.landmarks.get(*index).filter(|landmark| landmark.of_scene)?;
            let full = format!("{}.{name}", object.name);
            let landmarks = self.vocabulary.landmarks.iter().position(|landmark| landmark.name == full).map(EntityRef::Landmark);
            landmarks.or_else(|| self.vocabulary.joints.iter().position(|joint| joint.name == full).map(EntityRef::Joint))
        };
        match base {
            Value::Entity(thing) => part(thing).map(Value::Entity),
            Value::Entities { members, .. } => {
                let parts: Option<Vec<EntityRef>> = members.iter().map(part).collect();
                parts.filter(|parts| !parts.is_empty()).map(|members| Value::Entities { members, group: false })
            }
            Value::Typed(_) => None,
        }
    }

    /// What an object has beside the signals of every landmark: sizes, parts, joints.
    pub(crate) fn parts_of(&self, thing: EntityRef) -> Vec<String> {
        parts_of(self.vocabulary, self.known.keys().map(String::as_str), thing)
    }
}
