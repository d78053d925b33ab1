//! Whether a motion fits a body: its joints exist and are measured in the right unit.

use super::{Motion, Target};
use crate::check::dimension::Dimension;
use crate::diagnostics::{Diagnostic, FileId, codes, nearest};
use crate::vocabulary::{JointKind, Vocabulary};

impl Motion {
    /// What of it does not fit the body of `vocabulary`; `file` is where it was read from.
    pub fn problems(&self, file: FileId, vocabulary: &Vocabulary) -> Vec<Diagnostic> {
        let mut problems = Vec::new();
        for column in &self.columns {
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
            }
        }
        problems
    }
}
