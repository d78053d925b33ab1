//! Joints of objects: hinges, slides and balls inside the element that they let move.

use super::elements;
use super::fields::Fields;
use crate::body::Property;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::diagnostics::codes;
use crate::scene::{ObjectJoint, ObjectJointKind};
use crate::syntax::tree::{Element, Expr, ExprKind, FieldValue};

/// Dimensions of a joint's numbers.
struct Units {
    coordinate: Dimension,
    effort: Dimension,
}

/// A parameter of a joint that is drawn.
pub(super) struct DrawnParameter<'a> {
    pub property: Property,
    pub dimension: Dimension,
    pub formula: &'a Expr,
}

impl<'a> Checker<'a> {
    /// `hinge swing { axis [0, 0, -1], range 0 deg .. 90 deg, damping 0.05 N*m*s/rad }`, of the object called `owner`.
    pub(super) fn object_joint(&mut self, element: &'a Element, owner: &str) -> Checked<(ObjectJoint, Vec<DrawnParameter<'a>>)> {
        let word = element.kind.text.as_str();
        let name = self.element_name(element)?.unwrap_or_default();
        let name = format!("{owner}.{name}");
        let Some(kind) = elements::find(word) else { return Err(self.unknown_element(element)) };
        if let Some(part) = element.parts.first() {
            let message = format!("a `{word}` has no parts; declare them beside it in the element that it moves");
            return Err(self.error(codes::tasks::UNKNOWN_SETTING, part.span, message));
        }
        let fields = self.fields(element, kind)?;
        let (kind, units) = match word {
            "slide" => (ObjectJointKind::Slide, Units { coordinate: Dimension::LENGTH, effort: Dimension::FORCE }),
            "ball" => (ObjectJointKind::Ball, Units { coordinate: Dimension::ANGLE, effort: Dimension::TORQUE }),
            _ => (ObjectJointKind::Hinge, Units { coordinate: Dimension::ANGLE, effort: Dimension::TORQUE }),
        };
        let axis = match fields.get("axis") {
            Some(field) => self.direction(field)?,
            None => [0.0, 0.0, 1.0],
        };
        let anchor = match fields.get("at") {
            Some(field) => {
                let expr = self.field_value(field)?;
                self.fixed_bracket(expr, Dimension::LENGTH, "`at`")?
            }
            None => [0.0; 3],
        };
        let range = self.joint_range(&fields, &units)?;
        let per = |power: Dimension| units.effort.per(power).unwrap_or(Dimension::NONE);
        let rate = units.coordinate.per(Dimension::TIME).unwrap_or(Dimension::NONE);
        let mut drawn = Vec::new();
        let damping = self.joint_parameter(&fields, Property::Damping, per(rate), &mut drawn)?;
        let stiffness = self.joint_parameter(&fields, Property::Stiffness, per(units.coordinate), &mut drawn)?;
        let friction_loss = self.not_negative(&fields, "friction", units.effort)?;
        Ok((ObjectJoint { name, kind, axis, anchor, range, damping, stiffness, friction_loss }, drawn))
    }

    /// `damping` or `stiffness`, 0 by default; not negative in any episode.
    fn joint_parameter(
        &mut self,
        fields: &Fields<'a>,
        property: Property,
        dimension: Dimension,
        drawn: &mut Vec<DrawnParameter<'a>>,
    ) -> Checked<f64> {
        let name = if property == Property::Stiffness { "stiffness" } else { "damping" };
        let Some(field) = fields.get(name) else { return Ok(0.0) };
        let expr = self.field_value(field)?;
        let wanted_by = format!("`{name}`");
        let number = self.field_number(expr, dimension, &wanted_by)?;
        self.must_be_within(&number, |value| (value < 0.0).then_some("is negative"), &wanted_by, expr.span)?;
        drawn.extend(number.drawn.map(|formula| DrawnParameter { property, dimension, formula }));
        Ok(number.value)
    }

    fn joint_range(&mut self, fields: &Fields<'a>, units: &Units) -> Checked<Option<[f64; 2]>> {
        let Some(field) = fields.get("range") else { return Ok(None) };
        let FieldValue::Value(Expr { kind: ExprKind::Range { low, high }, .. }) = &field.value else {
            let diagnostic = self
                .diagnostic(codes::tasks::UNKNOWN_SETTING, field.span, "`range` has two ends")
                .expected("`range 0 deg .. 90 deg`");
            return Err(self.report(diagnostic));
        };
        let [low_value, high_value] = self.fixed_range(low, high, units.coordinate, "`range`")?;
        if low_value >= high_value {
            let message = "the lower end of the range must be below the upper end";
            return Err(self.error(codes::scene::SIZE, field.span, message));
        }
        Ok(Some([low_value, high_value]))
    }
}
