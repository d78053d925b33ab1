//! The pose of an initial state: a pose of the body, adjusted by name.

use super::InitialState;
use crate::check::context::{Checked, Checker, Failures};
use crate::check::dimension::Dimension;
use crate::check::scene::drawn::FieldNumber;
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::{Span, codes};
use crate::init::{Following, Moves, Parts, Start};
use crate::motion::RootPart;
use crate::numbers::distinguished;
use crate::resolve::scope::{Declared, Definition};
use crate::syntax::tree::{Assignment, Expr, Ident, PoseUse};
use crate::task::{Init, Setting};
use crate::vocabulary::JointKind;

impl<'a> Checker<'a> {
    pub(super) fn pose(&mut self, pose: &'a PoseUse, initial: &mut InitialState) -> Checked<()> {
        let declared = self.names.find(self.place, &pose.name.text);
        if matches!(declared, Some((Declared { definition: Definition::Reference(_), .. }, _))) {
            return self.pose_of_motion(pose, initial);
        }
        self.named_pose(&pose.name, &mut initial.init)?;
        let mut set = vec![false; initial.init.coordinates.len()];
        let mut failures = Failures::default();
        for adjustment in &pose.adjustments {
            failures.catch(self.adjust(adjustment, initial, &mut set));
        }
        failures.or(())
    }

    /// `pose gait`: the body where the motion is when the episode starts, and as fast. Joints that the motion does not move stand
    /// as in the standing pose; those that are adjusted begin at rest.
    fn pose_of_motion(&mut self, pose: &'a PoseUse, initial: &mut InitialState) -> Checked<()> {
        self.used.insert(pose.name.text.clone());
        let known = self.known_reference(&pose.name.text, pose.name.span)?;
        let known = self.references[known].clone();
        let (joints, init) = (&self.vocabulary.joints, &mut initial.init);
        for (coordinate, joint) in init.coordinates.iter_mut().zip(joints) {
            *coordinate = joint.neutral;
        }
        init.velocities = vec![0.0; joints.len()];
        let mut set = vec![false; joints.len()];
        let mut failures = Failures::default();
        for adjustment in &pose.adjustments {
            failures.catch(self.adjust(adjustment, initial, &mut set));
        }
        failures.or(())?;
        let init = &mut initial.init;
        let moved = joints.iter().enumerate().filter(|(index, joint)| joint.independent && !set[*index]);
        let motion = known.motion;
        let parts = Parts {
            joints: moved.filter_map(|(index, joint)| Some((index, motion.joint(&joint.name)?))).collect(),
            root: RootPart::ALL.into_iter().filter(|part| motion.root(*part).is_some()).collect(),
            velocity: true,
        };
        let constant = self.graph.constant_value(known.start);
        parts.write(&motion, motion.time_of(constant.unwrap_or(0.0)), init);
        initial.motion = Some(pose.name.text.clone());
        if constant.is_none() {
            init.follows = Some(Following { motion, start: Start::Drawn(initial.drawn.len()), after: 0.0, parts, path: None });
            initial.drawn.push(known.start);
        }
        Ok(())
    }

    /// Takes a pose of the body; what followed a motion no longer does.
    pub(in crate::check) fn named_pose(&mut self, name: &Ident, init: &mut Init) -> Checked<()> {
        let Some(known) = self.vocabulary.poses.iter().find(|known| known.name == name.text) else {
            let names = self.vocabulary.poses.iter().map(|known| known.name.clone());
            let names = names.chain(self.references.iter().map(|known| known.name.clone())).collect();
            return Err(self.unknown_name(&name.text, name.span, names));
        };
        // Poses know the joints of the body; those of objects come behind and keep their place.
        for (coordinate, value) in init.coordinates.iter_mut().zip(&known.coordinates) {
            *coordinate = *value;
        }
        let own = |joint: usize| joint < known.coordinates.len();
        init.drawn.retain(|(setting, _)| !matches!(setting, Setting::Coordinate(joint) if own(*joint)));
        init.alignments.retain(|alignment| matches!(alignment.moves, Moves::Object(_)));
        init.velocities.clear();
        // Who has walked to where he is stays there, whatever pose he takes.
        init.follows.take_if(|following| following.path.is_none());
        init.follows.iter_mut().for_each(|following| following.parts.joints.clear());
        Ok(())
    }

    fn adjust(&mut self, adjustment: &'a Assignment, initial: &mut InitialState, set: &mut [bool]) -> Checked<()> {
        for index in self.adjusted(adjustment, set)? {
            self.begin_coordinate(index, &adjustment.value, adjustment.target.span, initial)?;
        }
        Ok(())
    }

    /// The joints that an assignment sets, each once.
    pub(in crate::check) fn adjusted(&mut self, adjustment: &'a Assignment, set: &mut [bool]) -> Checked<Vec<usize>> {
        let things = match self.value(&adjustment.target)? {
            Value::Entity(thing) => vec![thing],
            Value::Entities { members, .. } => members,
            Value::Typed(_) => Vec::new(),
        };
        if things.is_empty() {
            return Err(self.error(codes::types::WRONG_TYPE, adjustment.target.span, "a pose sets joints"));
        }
        let mut joints = Vec::with_capacity(things.len());
        for thing in things {
            let EntityRef::Joint(index) = thing else {
                let message = format!("a pose sets joints, found {}", self.thing_name(thing));
                return Err(self.error(codes::types::WRONG_TYPE, adjustment.target.span, message));
            };
            if std::mem::replace(&mut set[index], true) {
                let message = format!("the joint `{}` is set twice", self.vocabulary.joints[index].name);
                return Err(self.error(codes::tasks::REPEATED, adjustment.target.span, message));
            }
            joints.push(index);
        }
        Ok(joints)
    }

    /// The initial coordinate of a joint, known or drawn.
    pub(super) fn begin_coordinate(
        &mut self,
        index: usize,
        value: &'a Expr,
        named: Span,
        initial: &mut InitialState,
    ) -> Checked<()> {
        let number = self.coordinate_number(index, value, named)?;
        initial.init.coordinates[index] = number.value;
        let Some(expr) = number.drawn else { return Ok(()) };
        let node = self.data(expr)?.node;
        self.begin(node, &[Setting::Coordinate(index)], expr.span, "a coordinate", initial)
    }

    /// A coordinate of a joint, which must be independent and within its range.
    pub(in crate::check) fn coordinate(&mut self, index: usize, value: &'a Expr, named: Span) -> Checked<f64> {
        let number = self.coordinate_number(index, value, named)?;
        match number.drawn {
            None => Ok(number.value),
            Some(expr) => Err(self.must_be_known(expr.span, "a coordinate in a test")),
        }
    }

    fn coordinate_number(&mut self, index: usize, value: &'a Expr, named: Span) -> Checked<FieldNumber<'a>> {
        let joint = &self.vocabulary.joints[index];
        let (dimension, unit, factor) = match joint.kind {
            JointKind::Hinge => (Dimension::ANGLE, "deg", 180.0 / std::f64::consts::PI),
            JointKind::Slide => (Dimension::LENGTH, "m", 1.0),
        };
        let chosen = self.field_number(value, dimension, &format!("the joint `{}`", joint.name))?;
        if !joint.independent {
            let message = format!("the joint `{}` is coupled to another joint; its coordinate cannot be set", joint.name);
            let diagnostic = self
                .diagnostic(codes::tasks::COUPLED, named, message)
                .help("set the independent joint of its coupling; `msk vocabulary` lists the independent joints");
            return Err(self.report(diagnostic));
        }
        let outside =
            |[low, high]: [f64; 2]| [chosen.bounds.low, chosen.bounds.high].into_iter().find(|end| !(low..=high).contains(end));
        if let Some([low, high]) = joint.range
            && let Some(end) = outside([low, high])
        {
            let shown = distinguished(&[low * factor, high * factor, end * factor]);
            let diagnostic = self
                .diagnostic(codes::tasks::OUT_OF_RANGE, value.span, format!("`{}` cannot have this value", joint.name))
                .expected(format!("{} .. {} {unit}", shown[0], shown[1]))
                .found(format!("{} {unit}", shown[2]));
            return Err(self.report(diagnostic));
        }
        Ok(chosen)
    }

    /// Joints of objects begin at zero unless `init` sets them: then zero must be in their range.
    pub(super) fn must_begin_within_ranges(&mut self, init: &Init, span: Span) -> Checked<()> {
        let mut failures = Failures::default();
        for (joint, coordinate) in self.vocabulary.joints.iter().zip(&init.coordinates).filter(|(joint, _)| joint.of_scene) {
            let Some([low, high]) = joint.range else { continue };
            if !(low..=high).contains(coordinate) {
                let (unit, factor) = match joint.kind {
                    JointKind::Hinge => ("deg", 180.0 / std::f64::consts::PI),
                    JointKind::Slide => ("m", 1.0),
                };
                let shown = distinguished(&[low * factor, high * factor, *coordinate * factor]);
                let (object, word) = joint.name.rsplit_once('.').unwrap_or((&joint.name, "q"));
                let diagnostic = self
                    .diagnostic(
                        codes::tasks::OUT_OF_RANGE,
                        span,
                        format!("`{}` starts at {} {unit}, outside its range", joint.name, shown[2]),
                    )
                    .expected(format!("{} .. {} {unit}", shown[0], shown[1]))
                    .help(format!("set its initial coordinate in `init`: `{object} {{ {word} ... }}`"));
                failures.add(self.report(diagnostic));
            }
        }
        failures.or(())
    }
}
