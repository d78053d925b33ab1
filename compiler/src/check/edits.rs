//! `body human with core.peak_force *= 3`: parameters of a body that a task changes.

use super::context::{Checked, Checker, Failures};
use super::dimension::Dimension;
use super::value::{EntityRef, Value};
use crate::body::{Change, Property};
use crate::diagnostics::{Diagnostic, FileId, codes, nearest};
use crate::resolve::inherit::WholeTask;
use crate::resolve::scope::{Names, Place};
use crate::syntax::tree::{BodyEdit, BodyUse, ExprKind};
use crate::vocabulary::{JointKind, Vocabulary};

/// What `used` changes, resolved on the body as it is.
pub(crate) fn edits<'a>(
    used: &'a BodyUse,
    file: FileId,
    task: &'a WholeTask,
    names: &'a Names<'a>,
    vocabulary: &'a Vocabulary,
) -> (Checked<Vec<Change>>, Vec<Diagnostic>) {
    // Only names of the body and constants are in sight: what a task declares may read the body that is being changed.
    let mut checker = Checker::new(vocabulary, names, Place { file, in_task: false }, &task.statements);
    let mut changes: Vec<Change> = Vec::new();
    let mut failures = Failures::default();
    for edit in &used.edits {
        failures.catch(checker.edit(edit, &mut changes));
    }
    (failures.or(changes), checker.diagnostics)
}

impl<'a> Checker<'a> {
    fn edit(&mut self, edit: &'a BodyEdit, changes: &mut Vec<Change>) -> Checked<()> {
        let ExprKind::Field { base, name } = &edit.target.kind else {
            let message = "only properties of muscles or joints can be changed";
            let diagnostic = self.diagnostic(codes::composition::BODY_EDIT, edit.target.span, message);
            return Err(self.report(diagnostic.expected("`core.peak_force *= 3`, `knee_angle_r.damping = 2 N*m*s/rad`")));
        };
        let things = match self.value(base)? {
            Value::Entity(thing) => vec![thing],
            Value::Entities { members, .. } => members,
            Value::Typed(_) => Vec::new(),
        };
        let muscles = things.iter().all(|thing| matches!(thing, EntityRef::Muscle(_)));
        let joints = things.iter().all(|thing| matches!(thing, EntityRef::Joint(_)));
        let known: &[(&str, Property)] = match (things.is_empty(), muscles, joints) {
            (false, true, _) => &[("peak_force", Property::PeakForce)],
            (false, _, true) => &[("damping", Property::Damping), ("stiffness", Property::Stiffness)],
            _ => return Err(self.error(codes::composition::BODY_EDIT, base.span, "only muscles and joints can be changed")),
        };
        let Some((_, property)) = known.iter().find(|(word, _)| *word == name.text) else {
            let words = known.iter().map(|(word, _)| *word);
            let mut diagnostic =
                self.diagnostic(codes::composition::BODY_EDIT, name.span, format!("a task cannot change `{}`", name.text));
            let near = nearest(&name.text, words.clone());
            diagnostic = match near.first() {
                Some(near) => diagnostic.suggest(format!("did you mean `{near}`?"), name.span, *near),
                None => diagnostic.help(format!("a task can change {}", words.collect::<Vec<_>>().join(", "))),
            };
            return Err(self.report(diagnostic));
        };
        self.spend(things.len(), edit.target.span)?;
        let before = changes.len();
        let mut effect = false;
        for &thing in &things {
            let dimension = self.dimension_of_property(*property, thing);
            let value = self.new_value(edit, dimension)?;
            let part = match thing {
                EntityRef::Muscle(index) => {
                    effect |= edit.scales || self.vocabulary.muscles[index].peak_force != value;
                    self.vocabulary.muscles[index].name.clone()
                }
                EntityRef::Joint(index) => {
                    effect = true;
                    self.vocabulary.joints[index].name.clone()
                }
                _ => continue,
            };
            effect &= !(edit.scales && value == 1.0);
            if changes[..before].iter().any(|known| known.part == part && known.property == *property) {
                let message = format!("`{part}.{}` is changed twice", name.text);
                return Err(self.error(codes::tasks::REPEATED, edit.target.span, message));
            }
            changes.push(Change { part, property: *property, value, scales: edit.scales });
        }
        if effect {
            return Ok(());
        }
        let diagnostic = self
            .diagnostic(codes::composition::BODY_EDIT, edit.value.span, "this change has no effect")
            .help("probably a different change was meant");
        Err(self.report(diagnostic))
    }

    fn dimension_of_property(&self, property: Property, thing: EntityRef) -> Dimension {
        let slide = matches!(thing, EntityRef::Joint(index) if self.vocabulary.joints[index].kind == JointKind::Slide);
        match property {
            Property::PeakForce => Dimension::FORCE,
            // Of hinges N m s/rad and N m/rad, of slides N s/m and N/m.
            Property::Damping if slide => Dimension::of(0, 1, -1, 0),
            Property::Damping => Dimension::of(2, 1, -1, -1),
            Property::Stiffness if slide => Dimension::of(0, 1, -2, 0),
            Property::Stiffness => Dimension::of(2, 1, -2, -1),
        }
    }

    fn new_value(&mut self, edit: &'a BodyEdit, dimension: Dimension) -> Checked<f64> {
        let wanted = if edit.scales { Dimension::NONE } else { dimension };
        let data = self.data(&edit.value)?;
        let fits = data.kind.is_one_number() && (data.kind.dimension() == Some(wanted) || data.is_zero());
        if !fits {
            let diagnostic = self
                .diagnostic(codes::types::DIMENSIONS_DIFFER, edit.value.span, "the units do not match")
                .expected(wanted.described())
                .found(data.kind.described(self.vocabulary));
            return Err(self.report(diagnostic));
        }
        match self.graph.constant_value(data.node) {
            Some(value) if value.is_finite() && value >= 0.0 => Ok(value),
            Some(_) => {
                Err(self.error(codes::tasks::OUT_OF_RANGE, edit.value.span, "forces, damping and stiffness cannot be negative"))
            }
            None => {
                Err(self.error(codes::types::NOT_CONSTANT, edit.value.span, "a change of the body needs a compile-time constant"))
            }
        }
    }
}
