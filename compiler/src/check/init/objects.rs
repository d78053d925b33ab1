//! Where the objects of the scene start, and how fast.

use super::InitialState;
use crate::check::context::{Checked, Checker, Failures, Reported};
use crate::check::dimension::Dimension;
use crate::check::scene::drawn::{DrawnField, SceneField};
use crate::check::scene::heights::places;
use crate::check::scene::rotation;
use crate::check::scene::varied::ShapeField;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::{codes, nearest};
use crate::graph::operation::{Binary, Unary};
use crate::init::{Friction, JointValue, ObjectMass, ObjectShape};
use crate::scene::{Motion, SceneDescription};
use crate::syntax::tree::{Align, Expr, Field, FieldValue, Placement};
use crate::task::Setting;

/// The settings of a free object.
const FREE: [&str; 5] = ["at", "align", "orientation", "velocity", "spin"];

impl<'a> Checker<'a> {
    /// Fields of the scene that are drawn.
    pub(super) fn drawn_fields(&mut self, initial: &mut InitialState) -> Checked<()> {
        let Some(scene) = self.scene else { return Ok(()) };
        let mut failures = Failures::default();
        for drawn in &scene.drawn {
            let result = self.in_file(drawn.file, |checker| {
                checker.with_locals(&drawn.locals, |checker| checker.draw_field(drawn, &scene.description, initial))
            });
            failures.catch(result);
        }
        failures.or(())
    }

    fn draw_field(&mut self, drawn: &DrawnField<'a>, scene: &SceneDescription, initial: &mut InitialState) -> Checked<()> {
        let DrawnField { object, field, expr, .. } = *drawn;
        let variation = &mut initial.init.variation;
        let place = initial.init.objects.iter().position(|known| Some(known.object) == object);
        match (field, object, place) {
            (SceneField::Mass, Some(object), _) => {
                let row = variation.masses.len();
                variation.masses.push(ObjectMass { object, mass: scene.objects[object].mass });
                self.begin_number(expr, Dimension::MASS, "`mass`", Setting::ObjectMass(row), initial)
            }
            (SceneField::Friction, ..) => {
                let row = variation.frictions.len();
                let surface = object.map_or(scene.ground, |object| Some(scene.objects[object].surface));
                variation.frictions.push(Friction { object, sliding: surface.unwrap_or_default().friction[0] });
                self.begin_number(expr, Dimension::NONE, "`friction`", Setting::Friction(row), initial)
            }
            (SceneField::Place, _, Some(place)) => {
                let settings = [0, 1, 2].map(|axis| Setting::ObjectPosition(place, axis));
                self.begin_bracket(expr, Dimension::LENGTH, "`at`", settings, initial)
            }
            (SceneField::Turn, _, Some(place)) => self.begin_turn(expr, rotation::NONE, [0.0, 0.0, 1.0], place, initial),
            // Positive inclination rises along x, which is a turn about -y.
            (SceneField::Angle(base), _, Some(place)) => self.begin_turn(expr, base, [0.0, -1.0, 0.0], place, initial),
            (SceneField::Joint { place, property, dimension }, Some(object), _) => {
                let row = variation.joints.len();
                variation.joints.push(JointValue { object, joint: place, property, value: 0.0 });
                self.begin_number(expr, dimension, "a joint", Setting::ObjectJoint(row), initial)
            }
            (SceneField::Shape(field), Some(object), _) => {
                let Some(shape) = &scene.objects[object].shape else { return Ok(()) };
                let row = variation.shapes.iter().position(|known| known.object == object).unwrap_or_else(|| {
                    variation.shapes.push(ObjectShape { object, shape: shape.clone() });
                    variation.shapes.len() - 1
                });
                self.begin_shape(expr, field, row, initial)
            }
            _ => Ok(()),
        }
    }

    /// Numbers of a shape.
    fn begin_shape(&mut self, expr: &'a Expr, field: ShapeField, row: usize, initial: &mut InitialState) -> Checked<()> {
        let setting = |number: usize| Setting::ObjectShape(row, number);
        match field {
            ShapeField::Length(number) => self.begin_number(expr, Dimension::LENGTH, "a size", setting(number), initial),
            ShapeField::Extents(times) => {
                let node = self.data(expr)?.node;
                let times = self.graph.constant(times);
                for lane in 0..3 {
                    let extent = self.graph.select([lane], node);
                    let extent = self.graph.binary(Binary::Multiply, times, extent);
                    self.begin(extent, &[setting(lane)], expr.span, "`size`", initial)?;
                }
                Ok(())
            }
            ShapeField::Heights(size, samples) => {
                for (sample, [x, y]) in places(size, samples).enumerate() {
                    let height = self.with_coordinates(x, y, |checker| checker.number_of(expr, Dimension::LENGTH, "`height`"))?;
                    self.begin(height.node, &[setting(sample)], expr.span, "`height`", initial)?;
                }
                Ok(())
            }
        }
    }

    /// The orientation `base`, turned about its own `axis` by an angle that is drawn.
    fn begin_turn(
        &mut self,
        expr: &'a Expr,
        base: [f64; 4],
        axis: [f64; 3],
        place: usize,
        initial: &mut InitialState,
    ) -> Checked<()> {
        let angle = self.number_of(expr, Dimension::ANGLE, "the angle")?.node;
        let half = self.graph.constant(0.5);
        let half = self.graph.binary(Binary::Multiply, half, angle);
        let [sine, cosine] = [Unary::Sine, Unary::Cosine].map(|function| self.graph.unary(function, half));
        let [x, y, z] = axis;
        let across = rotation::product(base, [0.0, x, y, z]);
        for part in 0..4 {
            // The product of quaternions is linear in the second: base (cos + axis sin).
            let terms = [(cosine, base[part]), (sine, across[part])].map(|(node, factor)| {
                let factor = self.graph.constant(factor);
                self.graph.binary(Binary::Multiply, factor, node)
            });
            let component = self.graph.binary(Binary::Add, terms[0], terms[1]);
            self.begin(component, &[Setting::ObjectOrientation(place, part)], expr.span, "`orientation`", initial)?;
        }
        Ok(())
    }

    /// `cube { at [1 m, 0, 1 m], velocity [-4 m/s, 0, 1 m/s] }`, `door { swing 10 deg }`
    pub(in crate::check) fn placement(&mut self, element: &'a Placement, initial: &mut InitialState) -> Checked<()> {
        let things = match self.object_named(element)? {
            Value::Entity(thing) => vec![thing],
            Value::Entities { members, .. } => members,
            Value::Typed(_) => Vec::new(),
        };
        let mut failures = Failures::default();
        let placed = |word: &str| element.fields.iter().find(|field| field.name.text == word);
        if let (Some(_), Some(at)) = (placed("align"), placed("at")) {
            return Err(self.error(codes::tasks::REPEATED, at.span, "`align` already places the object; `at` is redundant"));
        }
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
            return self.begin_coordinate(index, expr, field.name.span, initial);
        }
        let scene = self.scene.map(|scene| &scene.description);
        let free = |index: usize| {
            let object = scene.and_then(|scene| scene.objects.get(index));
            object.is_some_and(|object| object.name == name && object.motion == Motion::Free)
        };
        let Some(place) = initial.init.objects.iter().position(|start| free(start.object)) else {
            return Err(self.not_free(&name, field));
        };
        if let FieldValue::Align(align) = &field.value {
            return self.align_own(align, &name, place, initial);
        }
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

    /// `cube { align cube.grip to palm_r }`
    fn align_own(&mut self, align: &'a Align, name: &str, place: usize, initial: &mut InitialState) -> Checked<()> {
        if let Some(joints) = &align.joints {
            let message = "an object is moved as a whole, without joints";
            return Err(self.error(codes::tasks::UNKNOWN_SETTING, joints.span, message));
        }
        let object = self.align_object(align, &mut initial.init)?;
        if object != initial.init.objects[place].object {
            let message = format!("this place does not belong to `{name}`");
            let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, align.place.span, message);
            return Err(self.report(diagnostic.help(format!("write `align {name} to ...`, or a point of `{name}`"))));
        }
        initial.forget(&[0, 1, 2].map(|axis| Setting::ObjectPosition(place, axis)));
        Ok(())
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
