//! Where the objects of the scene start, and how fast.

use super::InitialState;
use crate::check::context::{Checked, Checker, Failures, Reported};
use crate::check::dimension::Dimension;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::{codes, nearest};
use crate::scene::Motion;
use crate::syntax::tree::{Field, Placement};
use crate::task::Setting;

/// The settings of a free object.
const FREE: [&str; 4] = ["at", "orientation", "velocity", "spin"];

impl<'a> Checker<'a> {
    /// Free objects whose place in the scene is drawn.
    pub(super) fn drawn_places(&mut self, initial: &mut InitialState) -> Checked<()> {
        let Some(scene) = self.scene else { return Ok(()) };
        let mut failures = Failures::default();
        for start in &scene.starts {
            let Some(place) = initial.init.objects.iter().position(|known| known.object == start.object) else { continue };
            let settings = [0, 1, 2].map(|axis| Setting::ObjectPosition(place, axis));
            let result = self.in_file(start.file, |checker| {
                checker.with_locals(&start.locals, |checker| {
                    checker.begin_bracket(start.place, Dimension::LENGTH, "`at`", settings, initial)
                })
            });
            failures.catch(result);
        }
        failures.or(())
    }

    /// `cube { at [1 m, 0, 1 m], velocity [-4 m/s, 0, 1 m/s] }`, `door { swing 10 deg }`
    pub(in crate::check) fn placement(&mut self, element: &'a Placement, initial: &mut InitialState) -> Checked<()> {
        let things = match self.object_named(element)? {
            Value::Entity(thing) => vec![thing],
            Value::Entities { members, .. } => members,
            Value::Typed(_) => Vec::new(),
        };
        let mut failures = Failures::default();
        for thing in things {
            for field in &element.fields {
                failures.catch(self.placement_field(thing, field, initial));
            }
        }
        failures.or(())
    }

    fn object_named(&mut self, element: &'a Placement) -> Checked<Value> {
        let objects: Vec<String> = self.objects().map(str::to_owned).collect();
        let plain = !element.object.text.contains('{');
        if plain && !objects.contains(&element.object.text) {
            let message = format!("there is no object `{}` in the scene", element.object.text);
            let mut diagnostic = self.diagnostic(codes::names::UNKNOWN_NAME, element.object.span, message);
            for name in nearest(&element.object.text, objects.iter().map(String::as_str)) {
                diagnostic = diagnostic.suggest(format!("did you mean `{name}`?"), element.object.span, name);
            }
            return Err(self.report(diagnostic));
        }
        self.name(&element.object)
    }

    fn objects(&self) -> impl Iterator<Item = &'a str> {
        self.vocabulary.landmarks.iter().filter(|landmark| landmark.of_scene).map(|landmark| landmark.name.as_str())
    }

    fn placement_field(&mut self, thing: EntityRef, field: &'a Field, initial: &mut InitialState) -> Checked<()> {
        let name = match thing {
            EntityRef::Landmark(index) if self.vocabulary.landmarks[index].of_scene => {
                self.vocabulary.landmarks[index].name.clone()
            }
            other => {
                let message =
                    format!("{} is not an object of the scene; set joints of the body in the pose", self.thing_name(other));
                return Err(self.error(codes::types::WRONG_TYPE, field.span, message));
            }
        };
        let word = field.name.text.as_str();
        let joint = format!("{name}.{word}");
        if let Some(index) = self.vocabulary.joints.iter().position(|known| known.name == joint) {
            let expr = self.field_value(field)?;
            initial.init.coordinates[index] = self.coordinate(index, expr, field.name.span)?;
            return Ok(());
        }
        let scene = self.scene.map(|scene| &scene.description);
        let free = |index: usize| {
            let object = scene.and_then(|scene| scene.objects.get(index));
            object.is_some_and(|object| object.name == name && object.motion == Motion::Free)
        };
        let Some(place) = initial.init.objects.iter().position(|start| free(start.object)) else {
            return Err(self.not_free(&name, field));
        };
        let expr = self.field_value(field)?;
        let three = |setting: fn(usize, usize) -> Setting| [0, 1, 2].map(|axis| setting(place, axis));
        match word {
            "at" => {
                initial.forget(&three(Setting::ObjectPosition));
                self.begin_bracket(expr, Dimension::LENGTH, "`at`", three(Setting::ObjectPosition), initial)
            }
            "velocity" => self.begin_bracket(expr, Dimension::SPEED, "`velocity`", three(Setting::ObjectVelocity), initial),
            "spin" => self.begin_bracket(expr, Dimension::ANGULAR_VELOCITY, "`spin`", three(Setting::ObjectSpin), initial),
            "orientation" => {
                initial.init.objects[place].orientation = self.turned(expr)?;
                Ok(())
            }
            _ => {
                let message = format!("`{name}` does not take `{word}`");
                let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, field.name.span, message);
                let diagnostic =
                    diagnostic.help(format!("a free object takes {}", FREE.map(|word| format!("`{word}`")).join(", ")));
                Err(self.report(diagnostic))
            }
        }
    }

    fn not_free(&mut self, name: &str, field: &Field) -> Reported {
        let prefix = format!("{name}.");
        let joints: Vec<&str> = self
            .vocabulary
            .joints
            .iter()
            .filter_map(|joint| joint.name.strip_prefix(&prefix))
            .filter(|word| !word.contains('.'))
            .collect();
        let help = if joints.is_empty() {
            "it is fixed; its place is declared in the scene".to_owned()
        } else {
            format!("it has the joints {}: `{name} {{ {} ... }}`", joints.join(", "), joints[0])
        };
        let message = format!("`{name}` is not free, so it does not take `{}`", field.name.text);
        let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, field.name.span, message).help(help);
        self.report(diagnostic)
    }
}
