//! Where the root starts.

use super::InitialState;
use crate::check::context::{Checked, Checker, Failures};
use crate::check::dimension::Dimension;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::codes;
use crate::frame::Origin;
use crate::motion::RootPart;
use crate::syntax::tree::{Expr, ExprKind, Field, FieldValue, Placement};
use crate::task::Setting;

/// How the fields of the root are written.
const HELP: &str = "`root` takes `height on ground` or `height 1 m`, `lift 5 cm` above the ground, `at [0 m, 0 m]`, `heading 0 deg`, `pitch 0 deg`, `roll 0 deg`, `velocity [0.3 m/s, 0, 0]` and `align palm_l to bar.grip_l`";

impl InitialState {
    /// What `root` sets itself is not taken from the motion of a pose.
    fn unfollow(&mut self, word: &str) {
        let Some(following) = &mut self.init.follows else { return };
        let part = match word {
            "height" => Some(RootPart::Height),
            "pitch" => Some(RootPart::Pitch),
            "roll" => Some(RootPart::Roll),
            _ => None,
        };
        following.parts.root.retain(|known| Some(*known) != part);
        following.parts.velocity &= word != "velocity";
    }
}

impl<'a> Checker<'a> {
    pub(in crate::check) fn root(&mut self, element: &'a Placement, initial: &mut InitialState) -> Checked<()> {
        let mut failures = Failures::default();
        let mut seen: Vec<&str> = Vec::new();
        for field in &element.fields {
            let word = field.name.text.as_str();
            if seen.contains(&word) && word != "align" {
                failures.add(self.error(codes::tasks::REPEATED, field.span, format!("`{word}` is given twice")));
                continue;
            }
            seen.push(word);
            failures.catch(self.root_field(field, initial));
        }
        if !failures.any() && seen.contains(&"align") && (seen.contains(&"height") || seen.contains(&"at")) {
            let message = "`align` already places the root; `height` and `at` are redundant";
            return Err(self.error(codes::tasks::REPEATED, element.span, message));
        }
        failures.or(())
    }

    fn root_field(&mut self, field: &'a Field, initial: &mut InitialState) -> Checked<()> {
        let word = field.name.text.as_str();
        if let (Some(motion), "heading") = (&initial.motion, word) {
            let message = format!("the motion `{motion}` already sets the heading of the root");
            let diagnostic = self
                .diagnostic(codes::composition::MOTION, field.span, message)
                .help("a motion follows the x axis of the world, as in its table");
            return Err(self.report(diagnostic));
        }
        initial.unfollow(word);
        match (field.name.text.as_str(), &field.value) {
            ("height", FieldValue::On(Expr { kind: ExprKind::Name(name), .. })) if name.text == "ground" => {
                initial.init.root.height = None;
                Ok(())
            }
            ("height", FieldValue::Value(value)) => {
                self.begin_number(value, Dimension::LENGTH, "`height`", Setting::RootHeight, initial)
            }
            ("at", FieldValue::Value(value)) => {
                self.begin_bracket(value, Dimension::LENGTH, "`at`", [0, 1].map(Setting::RootPosition), initial)
            }
            ("heading", FieldValue::Value(value)) => {
                self.begin_number(value, Dimension::ANGLE, "`heading`", Setting::RootHeading, initial)
            }
            ("pitch", FieldValue::Value(value)) => {
                self.begin_number(value, Dimension::ANGLE, "`pitch`", Setting::RootPitch, initial)
            }
            ("roll", FieldValue::Value(value)) => {
                self.begin_number(value, Dimension::ANGLE, "`roll`", Setting::RootRoll, initial)
            }
            ("velocity", FieldValue::Value(value)) => {
                self.begin_bracket(value, Dimension::SPEED, "`velocity`", [0, 1, 2].map(Setting::RootVelocity), initial)
            }
            ("lift", FieldValue::Value(value)) => {
                initial.init.root.lift = self.fixed_number(value, Dimension::LENGTH, "`lift`")?;
                Ok(())
            }
            ("align", FieldValue::Meets { place, target }) => self.meeting(place, target, &mut initial.init.root.meets),
            (name, _) => {
                let message = format!("`root` does not take `{name}` like this");
                let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, message).help(HELP);
                Err(self.report(diagnostic))
            }
        }
    }

    /// `align palm_l to bar.grip_l`
    pub(in crate::check) fn meeting(
        &mut self,
        place: &'a Expr,
        target: &'a Expr,
        meets: &mut Vec<(usize, Origin)>,
    ) -> Checked<()> {
        let (value, target_value) = (self.value(place)?, self.value(target)?);
        let landmark = match value {
            Value::Entity(EntityRef::Landmark(index)) if !self.vocabulary.landmarks[index].of_scene => index,
            _ => {
                let message = "`align` places a landmark of the body";
                let diagnostic =
                    self.diagnostic(codes::types::WRONG_TYPE, place.span, message).help("write `align palm_l to bar.grip_l`");
                return Err(self.report(diagnostic));
            }
        };
        let origin = match target_value {
            Value::Entity(EntityRef::Landmark(index)) if self.stands_still(index) => {
                Origin::World(self.vocabulary.landmarks[index].neutral_position)
            }
            Value::Entity(EntityRef::Landmark(index)) if self.vocabulary.landmarks[index].of_scene => {
                Origin::Landmark(index, [0.0; 3])
            }
            Value::Entity(_) | Value::Entities { .. } => {
                let message = "`align` moves the body to a place of the scene, not to a part of the body";
                return Err(self.error(codes::types::WRONG_TYPE, target.span, message));
            }
            Value::Typed(_) => Origin::World(self.fixed_bracket(target, Dimension::LENGTH, "`align`")?),
        };
        meets.push((landmark, origin));
        Ok(())
    }
}
