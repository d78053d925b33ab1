//! Noise on the coordinates and velocities of an initial state.

use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::codes;
use crate::spoken;
use crate::syntax::tree::{Expr, ExprKind, Noise};
use crate::task::{Init, Spread};
use crate::vocabulary::JointKind;

/// On which joints, and whether on their velocities.
struct Target {
    joints: Vec<usize>,
    velocities: bool,
}

impl<'a> Checker<'a> {
    /// `noise joints normal(0, 0.005 rad)`, `noise arms uniform(-5 deg .. 5 deg)`, `noise legs normal(0, 0.1 rad/s)`
    pub(super) fn noise(&mut self, noise: &'a Noise, init: &mut Init) -> Checked<()> {
        let members = self.noisy_joints(&noise.target)?;
        let (spread, dimension) = self.distribution(&noise.distribution)?;
        let target = self.noise_target(noise, members, dimension)?;
        self.must_keep_within(noise, &target, spread, dimension)?;
        let list = if target.velocities { &mut init.velocity_noise } else { &mut init.coordinate_noise };
        list.resize(self.vocabulary.joints.len(), Spread::None);
        for &joint in &target.joints {
            if list[joint] != Spread::None {
                let message = format!("the noise of the joint `{}` is declared twice", self.vocabulary.joints[joint].name);
                return Err(self.error(codes::tasks::REPEATED, noise.span, message));
            }
            list[joint] = spread;
        }
        Ok(())
    }

    /// Noise on coordinates that is wider than the range of every joint that it shakes was meant in another unit.
    fn must_keep_within(&mut self, noise: &'a Noise, target: &Target, spread: Spread, dimension: Dimension) -> Checked<()> {
        let size = match spread {
            Spread::None => return Ok(()),
            Spread::Normal(deviation) => deviation,
            Spread::Uniform(low, high) => (high - low) / 2.0,
        };
        let width = |&joint: &usize| self.vocabulary.joints[joint].range.map_or(f64::INFINITY, |[low, high]| high - low);
        let widest = target.joints.iter().map(width).fold(0.0, crate::extremes::maximum);
        if target.velocities || size <= widest {
            return Ok(());
        }
        let unit = spoken::written(dimension, [&noise.distribution]);
        let message = "this noise is wider than the range of every joint that it affects";
        let diagnostic = self
            .diagnostic(codes::tasks::OUT_OF_RANGE, noise.distribution.span, message)
            .expected(format!("at most {}", unit.tell(widest)))
            .found(unit.tell(size));
        Err(self.report(if unit.name == "rad" { diagnostic.help("did you mean `deg`?") } else { diagnostic }))
    }

    fn noise_target(&mut self, noise: &'a Noise, members: Vec<usize>, dimension: Dimension) -> Checked<Target> {
        let word = if let ExprKind::Name(name) = &noise.target.kind { name.text.as_str() } else { "" };
        let (coordinates, rates) = ([Dimension::ANGLE, Dimension::LENGTH], [Dimension::ANGULAR_VELOCITY, Dimension::SPEED]);
        let (turns, velocities) = match word {
            "joints" => (Dimension::ANGLE, false),
            "velocities" => (Dimension::ANGULAR_VELOCITY, true),
            _ if coordinates.contains(&dimension) => (dimension, false),
            _ if rates.contains(&dimension) => (dimension, true),
            _ => {
                let message = "noise applies to coordinates or velocities of joints";
                let diagnostic = self
                    .diagnostic(codes::types::DIMENSIONS_DIFFER, noise.distribution.span, message)
                    .expected("rad or rad/s, for slides m or m/s")
                    .found(dimension.described());
                return Err(self.report(diagnostic));
            }
        };
        if turns != dimension {
            let message = format!("noise on `{word}` is {}", turns.described());
            let diagnostic = self
                .diagnostic(codes::types::DIMENSIONS_DIFFER, noise.distribution.span, message)
                .expected(turns.described())
                .found(dimension.described());
            return Err(self.report(diagnostic));
        }
        let kind =
            if [Dimension::ANGLE, Dimension::ANGULAR_VELOCITY].contains(&turns) { JointKind::Hinge } else { JointKind::Slide };
        let free = |index: &usize| self.vocabulary.joints[*index].kind == kind && self.vocabulary.joints[*index].independent;
        let joints: Vec<usize> = members.iter().copied().filter(free).collect();
        if joints.is_empty() {
            let diagnostic = self
                .diagnostic(codes::tasks::COUPLED, noise.target.span, "none of these joints has this unit")
                .help("noise applies to independent joints of its unit: coupled joints follow, and the root keeps its place");
            return Err(self.report(diagnostic));
        }
        Ok(Target { joints, velocities })
    }

    /// The joints that are named; `joints` and `velocities` stand for all of the body.
    fn noisy_joints(&mut self, target: &'a Expr) -> Checked<Vec<usize>> {
        if matches!(&target.kind, ExprKind::Name(name) if ["joints", "velocities"].contains(&name.text.as_str())) {
            let of_body = self.vocabulary.joints.iter().enumerate().filter(|(_, joint)| !joint.of_scene);
            return Ok(of_body.map(|(index, _)| index).collect());
        }
        let root = matches!(&target.kind, ExprKind::Name(name) if name.text == "root");
        let value = if root { Value::Entities { members: Vec::new(), group: false } } else { self.value(target)? };
        let things = match value {
            Value::Entity(thing) => vec![thing],
            Value::Entities { members, .. } => members,
            Value::Typed(_) => Vec::new(),
        };
        let joints: Option<Vec<usize>> =
            things.iter().map(|thing| if let EntityRef::Joint(index) = thing { Some(*index) } else { None }).collect();
        match joints {
            Some(joints) if !joints.is_empty() => Ok(joints),
            _ => {
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, target.span, "noise cannot be applied to this")
                    .expected("`noise joints ...`, `noise velocities ...`, or `noise` on joints by name or group")
                    .help("noise applies to independent joints: coupled joints follow, and the root keeps its place");
                Err(self.report(diagnostic))
            }
        }
    }

    /// `normal(0, deviation)` or `uniform(low .. high)`, and its unit.
    pub(crate) fn distribution(&mut self, distribution: &'a Expr) -> Checked<(Spread, Dimension)> {
        if let ExprKind::Call { function, arguments } = &distribution.kind
            && let ExprKind::Name(name) = &function.kind
        {
            let range =
                |expr: &'a Expr| if let ExprKind::Range { low, high } = &expr.kind { Some((&**low, &**high)) } else { None };
            match (name.text.as_str(), arguments.as_slice()) {
                ("normal", [mean, deviation]) => return self.normal(&mean.value, &deviation.value),
                ("uniform", [only]) => {
                    if let Some((low, high)) = range(&only.value) {
                        return self.uniform(low, high, distribution);
                    }
                }
                ("uniform", [low, high]) => return self.uniform(&low.value, &high.value, distribution),
                _ => {}
            }
        }
        let message = "noise is `normal(0, deviation)` or `uniform(low .. high)`";
        Err(self.error(codes::tasks::UNKNOWN_SETTING, distribution.span, message))
    }

    fn normal(&mut self, mean: &'a Expr, deviation: &'a Expr) -> Checked<(Spread, Dimension)> {
        let dimension = self.dimension_of(deviation)?;
        let mean_value = self.fixed_number(mean, dimension, "the mean");
        let value = self.fixed_number(deviation, dimension, "the deviation");
        let (mean_value, value) = (mean_value?, value?);
        if mean_value != 0.0 {
            return Err(self.error(
                codes::tasks::OUT_OF_RANGE,
                mean.span,
                "noise has mean 0: an offset belongs to the value itself",
            ));
        }
        if value < 0.0 {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, deviation.span, "a standard deviation cannot be negative"));
        }
        Ok((Spread::Normal(value), dimension))
    }

    fn uniform(&mut self, low: &'a Expr, high: &'a Expr, span: &'a Expr) -> Checked<(Spread, Dimension)> {
        let dimension = self.dimension_of(high)?;
        let [low_value, high_value] = self.fixed_range(low, high, dimension, "the noise")?;
        if low_value >= high_value {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, span.span, "the lower end must be below the upper end"));
        }
        Ok((Spread::Uniform(low_value, high_value), dimension))
    }

    pub(crate) fn dimension_of(&mut self, expr: &'a Expr) -> Checked<Dimension> {
        let data = self.data(expr)?;
        match data.kind.dimension() {
            Some(dimension) => Ok(dimension),
            None => {
                let found = data.kind.described(self.vocabulary);
                let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, "expected a number").found(found);
                Err(self.report(diagnostic))
            }
        }
    }
}
