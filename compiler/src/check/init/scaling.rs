//! Strength of muscles, mass of segments, damping and stiffness of joints: factors of what the body has, drawn or known.

use super::InitialState;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::{Span, codes};
use crate::init;
use crate::syntax::tree::{Argument, Expr, ExprKind, ScaledQuantity, Scaling};
use crate::task::Setting;

impl<'a> Checker<'a> {
    /// `strength calves weak`, `mass robot uniform(0.9 .. 1.1)`
    pub(super) fn scaling(&mut self, scaling: &'a Scaling, initial: &mut InitialState) -> Checked<()> {
        let members = match scaling.quantity {
            ScaledQuantity::Strength => self.scaled_muscles(&scaling.target)?,
            ScaledQuantity::Mass => self.scaled_segments(&scaling.target)?,
            quantity => self.scaled_joints(&scaling.target, quantity)?,
        };
        let variation = &initial.init.variation;
        let setting = match scaling.quantity {
            ScaledQuantity::Strength => Setting::Strength(variation.strengths.len()),
            ScaledQuantity::Mass => Setting::SegmentMass(variation.segments.len()),
            ScaledQuantity::Damping => Setting::Damping(variation.dampings.len()),
            ScaledQuantity::Stiffness => Setting::Stiffness(variation.stiffnesses.len()),
        };
        let wanted_by = format!("`{}`", scaling.quantity.word());
        let wrong = |value: f64| match scaling.quantity {
            ScaledQuantity::Mass => (value <= 0.0).then_some("is not positive"),
            _ => (value < 0.0).then_some("is negative"),
        };
        let span = scaling.factor.span;
        let (factor, each) = match distribution(&scaling.factor) {
            Some((name, arguments)) => (1.0, Some(self.factor_of_each(name, arguments, span, wrong, &wanted_by)?)),
            None => {
                let number = self.field_number(&scaling.factor, Dimension::NONE, &wanted_by)?;
                self.must_be_within(&number, wrong, &wanted_by, span)?;
                if number.drawn.is_some() {
                    self.begin_number(&scaling.factor, Dimension::NONE, &wanted_by, setting, initial)?;
                }
                (number.value, None)
            }
        };
        let variation = &mut initial.init.variation;
        let rows = match scaling.quantity {
            ScaledQuantity::Strength => &mut variation.strengths,
            ScaledQuantity::Mass => &mut variation.segments,
            ScaledQuantity::Damping => &mut variation.dampings,
            ScaledQuantity::Stiffness => &mut variation.stiffnesses,
        };
        rows.push(init::Scaling { members, factor, each });
        Ok(())
    }

    /// `uniform(0.8 .. 1.2)`: a factor of each member.
    fn factor_of_each(
        &mut self,
        name: &str,
        arguments: &'a [Argument],
        span: Span,
        wrong: impl Fn(f64) -> Option<&'static str>,
        wanted_by: &str,
    ) -> Checked<[f64; 2]> {
        let range = match arguments {
            [Argument { value: Expr { kind: ExprKind::Range { low, high }, .. }, .. }] if name == "uniform" => Some((low, high)),
            _ => None,
        };
        let Some((low, high)) = range else {
            let diagnostic = self
                .diagnostic(codes::tasks::UNKNOWN_SETTING, span, format!("{wanted_by} takes a factor, or `uniform(low .. high)`"))
                .help("one factor of another distribution for all: declare a `random`, and write its name here");
            return Err(self.report(diagnostic));
        };
        let [low, high] = self.fixed_range(low, high, Dimension::NONE, wanted_by)?;
        if low >= high {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, span, "the lower end must be below the upper end"));
        }
        match wrong(low) {
            Some(reason) => Err(self.error(codes::tasks::OUT_OF_RANGE, span, format!("{wanted_by} {reason} in some episodes"))),
            None => Ok([low, high]),
        }
    }

    /// The muscles that are named; `muscles` stands for all.
    fn scaled_muscles(&mut self, target: &'a Expr) -> Checked<Vec<usize>> {
        if is_named(target, "muscles") {
            return Ok((0..self.vocabulary.muscles.len()).collect());
        }
        let muscle = |thing: &EntityRef| if let EntityRef::Muscle(index) = thing { Some(*index) } else { None };
        match members(self.value(target)?, muscle) {
            Some(members) => Ok(members),
            None => {
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, target.span, "only muscles have a strength")
                    .expected("`strength muscles 0.8`, or `strength` of muscles by name or group");
                Err(self.report(diagnostic))
            }
        }
    }

    /// The landmarks whose segments are named; `robot` stands for all.
    fn scaled_segments(&mut self, target: &'a Expr) -> Checked<Vec<usize>> {
        let landmarks = &self.vocabulary.landmarks;
        if is_named(target, "robot") {
            return Ok((0..landmarks.len()).filter(|&index| !landmarks[index].of_scene).collect());
        }
        let segment = |thing: &EntityRef| match thing {
            EntityRef::Landmark(index) if !landmarks[*index].of_scene => Some(*index),
            _ => None,
        };
        match members(self.value(target)?, segment) {
            Some(members) => Ok(members),
            None => {
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, target.span, "only segments of the body have their mass scaled")
                    .expected("`mass robot 1.1`, or `mass` of segments by name or group")
                    .help("the mass of an object stands in the scene: `box pack { mass load }`");
                Err(self.report(diagnostic))
            }
        }
    }
}

impl<'a> Checker<'a> {
    /// The joints of the body that are named; `joints` stands for all.
    fn scaled_joints(&mut self, target: &'a Expr, quantity: ScaledQuantity) -> Checked<Vec<usize>> {
        let joints = &self.vocabulary.joints;
        if is_named(target, "joints") {
            return Ok((0..joints.len()).filter(|&index| !joints[index].of_scene).collect());
        }
        let joint = |thing: &EntityRef| match thing {
            EntityRef::Joint(index) if !joints[*index].of_scene => Some(*index),
            _ => None,
        };
        match members(self.value(target)?, joint) {
            Some(members) => Ok(members),
            None => {
                let word = quantity.word();
                let message = format!("only joints of the body have their {word} scaled");
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, target.span, message)
                    .expected(format!("`{word} joints 1.1`, or `{word}` of joints by name or group"))
                    .help(format!("that of a joint of an object stands in the scene: `hinge swing {{ {word} FORMULA }}`"));
                Err(self.report(diagnostic))
            }
        }
    }
}

/// A call of a distribution.
fn distribution(expr: &Expr) -> Option<(&str, &[Argument])> {
    let ExprKind::Call { function, arguments } = &expr.kind else { return None };
    let ExprKind::Name(name) = &function.kind else { return None };
    ["uniform", "normal", "choice"].contains(&name.text.as_str()).then_some((name.text.as_str(), arguments))
}

fn is_named(target: &Expr, name: &str) -> bool {
    matches!(&target.kind, ExprKind::Name(found) if found.text == name)
}

/// What a value names, each once, in order; `None` if something else is among it, or nothing.
fn members(value: Value, member: impl Fn(&EntityRef) -> Option<usize>) -> Option<Vec<usize>> {
    let things = match value {
        Value::Entity(thing) => vec![thing],
        Value::Entities { members, .. } => members,
        Value::Typed(_) => Vec::new(),
    };
    let mut members = things.iter().map(member).collect::<Option<Vec<usize>>>()?;
    members.sort_unstable();
    members.dedup();
    (!members.is_empty()).then_some(members)
}
