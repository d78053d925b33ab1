//! Whether a motion fits a body: its joints exist and are measured in the right unit.

use super::{Motion, Target};
use crate::diagnostics::{Diagnostic, FileId, codes, nearest};
use crate::numbers::distinguished;
use crate::quantity::dimension::Dimension;
use crate::quantity::unit;
use crate::vocabulary::{Joint, JointKind, Vocabulary};

/// How far a spline may leave the range of a joint between rows that keep it, rad or m.
const OVERSHOOT: f64 = 2e-3;

/// What of it does not fit the body of `vocabulary`; `file` is where it was read from.
pub fn problems(motion: &Motion, file: FileId, vocabulary: &Vocabulary) -> Vec<Diagnostic> {
    let mut problems = Vec::new();
    for (index, column) in motion.columns.iter().enumerate() {
        let Target::Joint(name) = &column.target else { continue };
        let Some(joint) = vocabulary.joints.iter().find(|joint| joint.name == *name) else {
            let message = format!("the body `{}` has no joint `{name}`", vocabulary.body);
            let mut problem = Diagnostic::new(codes::composition::MOTION_COLUMN, file, column.span, message);
            for near in nearest(name, vocabulary.joints.iter().map(|joint| joint.name.as_str())) {
                problem = problem.suggest(format!("did you mean `{near}`?"), column.span, near);
            }
            problems.push(problem);
            continue;
        };
        let (expected, turns) = match joint.kind {
            JointKind::Hinge => (Dimension::ANGLE, "turns: an angle, `[deg]`"),
            JointKind::Slide => (Dimension::LENGTH, "slides: a length, `[m]`"),
        };
        if column.dimension != expected {
            let message = format!("`{name}` is written in the wrong unit");
            let problem = Diagnostic::new(codes::composition::MOTION_COLUMN, file, column.span, message)
                .expected(format!("it {turns}"))
                .found(format!("`[{}]`", column.unit));
            problems.push(problem);
        } else if let Some(problem) = beyond(motion, index, joint, file) {
            problems.push(problem);
        }
    }
    problems
}

/// A column that leaves its joint's range.
fn beyond(motion: &Motion, column: usize, joint: &Joint, file: FileId) -> Option<Diagnostic> {
    let ([low, high], [least, most]) = (joint.range?, motion.range(column));
    if least >= low - OVERSHOOT && most <= high + OVERSHOOT {
        return None;
    }
    let column = &motion.columns[column];
    let factor = unit::find(&column.unit).map_or(1.0, |unit| unit.factor);
    let shown = distinguished(&[low, high, least, most].map(|value| value / factor));
    let between = |low: usize| format!("{} .. {} {}", shown[low], shown[low + 1], column.unit);
    let message = format!("`{}` leaves the range of the joint", joint.name);
    let problem = Diagnostic::new(codes::composition::MOTION_COLUMN, file, column.span, message);
    Some(problem.expected(between(0)).found(between(2)))
}
