//! The networks to whose actions those of tasks are added, read once each.

use super::{SourceFile, plain};
use crate::action::BaseNetwork;
use crate::check::action::Networks;
use crate::diagnostics::{Checked, Diagnostic, Span, codes};
use crate::digest::sha256;
use crate::files::{LARGEST_NETWORK, Loader};
use crate::syntax::tree::{Expr, ExprKind, Field, FieldValue, Item, Sequence, Task, TaskStatement};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads every network that a text names; its path is relative to that text.
pub(super) fn read(files: &[SourceFile], loader: &dyn Loader, diagnostics: &mut Vec<Diagnostic>) -> Networks {
    let mut networks = Networks::new();
    // A network that several texts name is read once.
    let mut known: BTreeMap<PathBuf, Checked<Arc<BaseNetwork>>> = BTreeMap::new();
    for file in files {
        let base = file.path.parent().map(Path::to_path_buf).unwrap_or_default();
        for (name, span) in file.tree.items.iter().flat_map(named) {
            let path = plain(&base.join(name));
            let network = known.entry(path.clone()).or_insert_with(|| match loader.load_bytes(&path, LARGEST_NETWORK) {
                Ok(bytes) => Ok(Arc::new(BaseNetwork { path: name.to_owned(), digest: sha256(&bytes), bytes: bytes.into() })),
                Err(problem) => {
                    let message = format!("cannot read the network \"{name}\": {problem}");
                    let diagnostic = Diagnostic::new(codes::names::FILE, file.tree.file, span, message)
                        .help("the path is relative to the file that names it");
                    Err(diagnostic.report(diagnostics))
                }
            });
            networks.insert((file.tree.file, name.to_owned()), network.clone());
        }
    }
    networks
}

/// The networks that an item of a file names.
fn named(item: &Item) -> Vec<(&str, Span)> {
    let (Item::Task(Task { statements, .. }) | Item::Sequence(Sequence { statements, .. })) = item else { return Vec::new() };
    let fields = statements.iter().filter_map(|statement| match statement {
        TaskStatement::Act(act) => Some(&act.fields),
        _ => None,
    });
    fields.flatten().filter_map(base).collect()
}

/// The file behind `residual "agent.onnx"`.
fn base(field: &Field) -> Option<(&str, Span)> {
    match &field.value {
        FieldValue::Value(Expr { kind: ExprKind::Text(path), span }) if field.name.text == "residual" => Some((path, *span)),
        _ => None,
    }
}
