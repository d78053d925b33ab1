//! How an episode begins: a pose with adjustments, the root, noise.

use super::constant::{self, NotConstant};
use super::context::{Checked, Checker, Reported};
use super::dimension::Dimension;
use super::value::{Thing, Value};
use crate::diagnostics::{Span, codes};
use crate::syntax::tree::{Assignment, Expr, ExprKind, Field, FieldValue, InitStatement, Noise, Placement, PoseUse};
use crate::task::{Init, RootPlacement, Spread};
use crate::vocabulary::JointKind;

impl<'a> Checker<'a> {
    /// Checks the statements of `init`.
    pub(crate) fn init(&mut self, statements: &'a [InitStatement], span: Span) -> Checked<Init> {
        let mut init = Init { coordinates: vec![0.0; self.vocabulary.joints.len()], ..Init::default() };
        let mut posed: Option<Span> = None;
        let mut broken = false;
        for statement in statements {
            let result = match statement {
                InitStatement::Pose(pose) => match posed.replace(pose.span) {
                    None => self.pose(pose, &mut init),
                    Some(_) => Err(self.error(codes::tasks::REPEATED, pose.span, "a second pose would replace the first")),
                },
                InitStatement::Object(element) if element.object.text == "root" => self.root(element, &mut init.root),
                InitStatement::Object(element) => {
                    let message = format!("there is no object `{}` in the scene", element.object.text);
                    Err(self.error(codes::names::UNKNOWN_NAME, element.object.span, message))
                }
                InitStatement::Noise(noise) => self.noise(noise, &mut init),
                InitStatement::Settle(settle) => Err(self.not_yet(settle.span, "settle")),
                InitStatement::Allow(allow) => {
                    self.allow(allow);
                    Ok(())
                }
            };
            broken |= result.is_err();
        }
        if posed.is_none() {
            let diagnostic = self
                .diagnostic(codes::tasks::MISSING, span, "`init` does not say in which pose the body begins")
                .help("write `pose neutral`, or another pose of the body");
            return Err(self.report(diagnostic));
        }
        if broken { Err(Reported) } else { Ok(init) }
    }

    /// Reports a statement of the language that this version does not support.
    pub(crate) fn not_yet(&mut self, span: Span, statement: &str) -> Reported {
        let message = format!("`{statement}` belongs to the language, but is not supported yet");
        self.error(codes::tasks::NOT_YET, span, message)
    }

    fn constant(&mut self, found: Result<f64, NotConstant>) -> Checked<f64> {
        found.map_err(|wrong| self.error(wrong.code, wrong.span, wrong.message))
    }

    fn pose(&mut self, pose: &'a PoseUse, init: &mut Init) -> Checked<()> {
        let Some(known) = self.vocabulary.poses.iter().find(|known| known.name == pose.name.text) else {
            let names = self.vocabulary.poses.iter().map(|known| known.name.clone()).collect();
            return Err(self.unknown_name(&pose.name.text, pose.name.span, names));
        };
        init.coordinates = known.coordinates.clone();
        let mut broken = false;
        for adjustment in &pose.adjustments {
            broken |= self.adjust(adjustment, &mut init.coordinates).is_err();
        }
        if broken { Err(Reported) } else { Ok(()) }
    }

    fn adjust(&mut self, adjustment: &'a Assignment, coordinates: &mut [f64]) -> Checked<()> {
        let things = match self.value(&adjustment.target)? {
            Value::Thing(thing) => vec![thing],
            Value::Things { members, .. } => members,
            Value::Data(_) => Vec::new(),
        };
        if things.is_empty() {
            return Err(self.error(codes::types::WRONG_TYPE, adjustment.target.span, "a pose sets joints"));
        }
        for thing in things {
            let Thing::Joint(index) = thing else {
                let message = format!("a pose sets joints; this is {}", self.thing_name(thing));
                return Err(self.error(codes::types::WRONG_TYPE, adjustment.target.span, message));
            };
            coordinates[index] = self.coordinate(index, adjustment)?;
        }
        Ok(())
    }

    /// A coordinate of a joint, which must be independent and within its range.
    fn coordinate(&mut self, index: usize, adjustment: &Assignment) -> Checked<f64> {
        let joint = &self.vocabulary.joints[index];
        let (dimension, unit, factor) = match joint.kind {
            JointKind::Hinge => (Dimension::ANGLE, "deg", 180.0 / std::f64::consts::PI),
            JointKind::Slide => (Dimension::LENGTH, "m", 1.0),
        };
        let value = constant::of_dimension(&adjustment.value, dimension);
        let value = self.constant(value)?;
        if !joint.independent {
            let message = format!("the joint `{}` follows another by a coupling; its coordinate cannot be chosen", joint.name);
            return Err(self.error(codes::tasks::SLAVED, adjustment.target.span, message));
        }
        if let Some([low, high]) = joint.range
            && !(low..=high).contains(&value)
        {
            let tidy = |value: f64| (value * factor * 10.0).round() / 10.0;
            let diagnostic = self
                .diagnostic(codes::tasks::OUT_OF_RANGE, adjustment.value.span, format!("`{}` cannot be placed there", joint.name))
                .expected(format!("{} .. {} {unit}", tidy(low), tidy(high)))
                .found(format!("{} {unit}", tidy(value)));
            return Err(self.report(diagnostic));
        }
        Ok(value)
    }

    fn root(&mut self, element: &'a Placement, root: &mut RootPlacement) -> Checked<()> {
        let mut broken = false;
        for field in &element.fields {
            broken |= self.root_field(field, root).is_err();
        }
        if broken { Err(Reported) } else { Ok(()) }
    }

    fn root_field(&mut self, field: &'a Field, root: &mut RootPlacement) -> Checked<()> {
        let wrong = |checker: &mut Self, wrong: NotConstant| checker.error(wrong.code, wrong.span, wrong.message);
        match (field.name.text.as_str(), &field.value) {
            ("height", FieldValue::On(Expr { kind: ExprKind::Name(name), .. })) if name.text == "ground" => root.height = None,
            ("height", FieldValue::Value(value)) => {
                root.height = Some(constant::of_dimension(value, Dimension::LENGTH).map_err(|w| wrong(self, w))?);
            }
            ("at", FieldValue::Value(value)) => {
                root.position = constant::bracket(value, Dimension::LENGTH).map_err(|w| wrong(self, w))?;
            }
            ("heading", FieldValue::Value(value)) => {
                root.heading = constant::of_dimension(value, Dimension::ANGLE).map_err(|w| wrong(self, w))?;
            }
            ("velocity", FieldValue::Value(value)) => {
                root.velocity = constant::bracket(value, Dimension::SPEED).map_err(|w| wrong(self, w))?;
            }
            (name, _) => {
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, format!("the root cannot be given `{name}` like this"))
                    .help("it takes `height on ground` or `height 1 m`, `at [0 m, 0 m]`, `heading 0 deg`, `velocity [0.3 m/s, 0, 0]`");
                return Err(self.report(diagnostic));
            }
        }
        Ok(())
    }

    fn noise(&mut self, noise: &'a Noise, init: &mut Init) -> Checked<()> {
        let target = if let ExprKind::Name(name) = &noise.target.kind { name.text.as_str() } else { "" };
        let dimension = match target {
            "joints" => Dimension::ANGLE,
            "velocities" => Dimension::ANGULAR_VELOCITY,
            _ => {
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, noise.target.span, "noise cannot be put on this")
                    .expected("`noise joints ...` or `noise velocities ...`")
                    .help("noise goes on independent hinges only: slaved joints follow, and the root keeps its place");
                return Err(self.report(diagnostic));
            }
        };
        let deviation = self.normal_deviation(&noise.distribution, dimension)?;
        let free = |joint: &crate::vocabulary::Joint| joint.kind == JointKind::Hinge && joint.independent && !joint.of_scene;
        let spread = |joint| if free(joint) { Spread::Normal(deviation) } else { Spread::None };
        let spreads = self.vocabulary.joints.iter().map(spread).collect();
        if target == "joints" {
            init.coordinate_noise = spreads
        } else {
            init.velocity_noise = spreads
        }
        Ok(())
    }

    /// The standard deviation of `normal(0, deviation)`.
    fn normal_deviation(&mut self, distribution: &'a Expr, dimension: Dimension) -> Checked<f64> {
        let arguments = match &distribution.kind {
            ExprKind::Call { function, arguments } => match &function.kind {
                ExprKind::Name(name) if name.text == "normal" => arguments.as_slice(),
                _ => &[],
            },
            _ => &[],
        };
        let [mean, deviation] = arguments else {
            let message = "the noise of a beginning is `normal(0, deviation)`";
            return Err(self.error(codes::tasks::UNKNOWN_SETTING, distribution.span, message));
        };
        let mean_value = self.constant(constant::of_dimension(&mean.value, dimension));
        let deviation_value = self.constant(constant::of_dimension(&deviation.value, dimension));
        let (mean_value, deviation_value) = (mean_value?, deviation_value?);
        if mean_value != 0.0 {
            let message = "noise has mean 0; put the offset into the pose";
            return Err(self.error(codes::tasks::OUT_OF_RANGE, mean.value.span, message));
        }
        if deviation_value < 0.0 {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, deviation.value.span, "a standard deviation is not negative"));
        }
        Ok(deviation_value)
    }
}
