//! The initial states of tasks that extend each other, merged: a setting of an extending task replaces what has the same
//! name there, in its place; the rest is added; `remove` takes out.

use super::Layer;
use crate::check::context::{Checked, Checker, Failures};
use crate::check::lookup::fits;
use crate::check::scene::object::dotted;
use crate::diagnostics::FileId;
use crate::resolve::inherit::overrides_nothing;
use crate::resolve::layers::Layers;
use crate::syntax::tree::{InitStatement, Remove};

/// A statement of `init`.
#[derive(Debug, Clone)]
pub(super) struct Row<'a> {
    pub statement: &'a InitStatement,
    /// Where it was written.
    pub file: FileId,
}

/// Statements by which an extending task overrides them; some have no name.
type Rows<'a> = Layers<Option<String>, Row<'a>>;

impl<'a> Checker<'a> {
    /// The statements of all layers, those that are overridden left out.
    pub(super) fn layered(&mut self, layers: &[Layer<'a>]) -> Checked<Vec<Row<'a>>> {
        let mut rows = Rows::default();
        let mut failures = Failures::default();
        for (layer, (block, file)) in layers.iter().enumerate() {
            for statement in &block.entries {
                if let InitStatement::Remove(remove) = statement {
                    failures.catch(self.in_file(*file, |checker| checker.leave_out(remove, layer, &mut rows)));
                    continue;
                }
                let row = Row { statement, file: *file };
                match name_of(statement) {
                    None => rows.add(None, layer, row),
                    name => rows.lay(name, layer, row),
                }
            }
        }
        failures.or(rows.into_items().collect())
    }

    /// `remove settle`: of the settings of extended tasks.
    fn leave_out(&mut self, remove: &'a Remove, layer: usize, rows: &mut Rows<'a>) -> Checked<()> {
        let mut failures = Failures::default();
        for pattern in self.names_of(&remove.name)? {
            let inherited =
                |name: &Option<String>, of: usize| of < layer && name.as_deref().is_some_and(|name| fits(&pattern, name));
            if !rows.take_out_where(inherited) {
                let names = rows.keys().filter(|(_, of)| *of < layer).filter_map(|(name, _)| name.as_deref());
                let message = match layer {
                    0 => "only a task that extends another can remove a part of `init`".to_owned(),
                    _ => format!("the `init` of the base task has no `{pattern}`"),
                };
                let diagnostic = overrides_nothing(message, &pattern, self.place.file, remove.name.span, names);
                failures.add(self.report(diagnostic));
            }
        }
        failures.or(())
    }
}

/// What a statement is overridden by: the word itself, an object, what noise shakes.
fn name_of(statement: &InitStatement) -> Option<String> {
    match statement {
        InitStatement::Pose(_) => Some("pose".to_owned()),
        InitStatement::Object(placement) => Some(placement.object.text.clone()),
        InitStatement::Noise(noise) => dotted(&noise.target),
        InitStatement::Scaling(scaling) => Some(format!("{}.{}", scaling.quantity.word(), dotted(&scaling.target)?)),
        InitStatement::Settle(_) => Some("settle".to_owned()),
        InitStatement::Remove(_) | InitStatement::Allow(_) => None,
    }
}
