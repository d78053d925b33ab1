//! Parts and joints of objects behind a dot: `door.leaf`, `door.swing`.

use crate::check::context::Checker;
use crate::check::value::{Thing, Value};
use crate::hir::parts_of;

impl Checker<'_> {
    /// A part or joint of an object, or of each of several: `door.leaf`, `door.swing`.
    pub(crate) fn part_of_object(&self, base: &Value, name: &str) -> Option<Value> {
        let part = |thing: &Thing| {
            let Thing::Landmark(index) = thing else { return None };
            let object = self.vocabulary.landmarks.get(*index).filter(|landmark| landmark.of_scene)?;
            let full = format!("{}.{name}", object.name);
            let landmarks = self.vocabulary.landmarks.iter().position(|landmark| landmark.name == full).map(Thing::Landmark);
            landmarks.or_else(|| self.vocabulary.joints.iter().position(|joint| joint.name == full).map(Thing::Joint))
        };
        match base {
            Value::Thing(thing) => part(thing).map(Value::Thing),
            Value::Things { members, .. } => {
                let parts: Option<Vec<Thing>> = members.iter().map(part).collect();
                parts.filter(|parts| !parts.is_empty()).map(|members| Value::Things { members, group: false })
            }
            Value::Data(_) => None,
        }
    }

    /// What an object has beside the signals of every landmark: sizes, parts, joints.
    pub(crate) fn parts_of(&self, thing: Thing) -> Vec<String> {
        parts_of(self.vocabulary, self.known.keys().map(String::as_str), thing)
    }
}
