//! Where the root starts.

use super::InitialState;
use crate::check::context::{Checked, Checker, Failures};
use crate::check::dimension::Dimension;
use crate::diagnostics::codes;
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
            ("align", FieldValue::Align(align)) => self.align_root(align, &mut initial.init),
            (name, _) => {
                let message = format!("`root` does not take `{name}` like this");
                let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, message).help(HELP);
                Err(self.report(diagnostic))
            }
        }
    }
}
