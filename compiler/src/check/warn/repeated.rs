//! Elements that stand in one list twice.

use crate::check::context::{Checked, Checker};
use crate::check::value::{EntityRef, Value};
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::graph::NodeId;
use crate::syntax::tree::walk::{Visitor, walk_expression};
use crate::syntax::tree::{Expr, ExprKind, Name};
use std::collections::BTreeMap;

/// What makes two elements the same.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Same {
    Numbers(NodeId),
    Landmark(usize),
    Joint(usize),
    Muscle(usize),
}

impl<'a> Checker<'a> {
    /// Warns of an element that stands in a written list for the second time: another one was probably meant.
    pub(crate) fn warn_repeated(&mut self, elements: &'a [Expr], values: &[(Checked<Value>, Span)]) {
        if self.in_tests.is_some() || self.mode.initial {
            return;
        }
        let mut first: BTreeMap<Same, Span> = BTreeMap::new();
        for (element, (value, span)) in elements.iter().zip(values) {
            let same = match value {
                Ok(Value::Typed(data)) if self.graph.constant_lanes(data.node).is_none() => Same::Numbers(data.node),
                Ok(Value::Entity(EntityRef::Landmark(index))) => Same::Landmark(*index),
                Ok(Value::Entity(EntityRef::Joint(index))) => Same::Joint(*index),
                Ok(Value::Entity(EntityRef::Muscle(index))) => Same::Muscle(*index),
                _ => continue,
            };
            if let Some(known) = first.get(&same) {
                let diagnostic = self
                    .diagnostic(codes::incentive::DUPLICATE_ELEMENT, *span, "this element occurs for the second time in the list")
                    .label(self.place.file, *known, "first occurrence")
                    .help("a mean or sum counts it twice and omits another element");
                let diagnostic = self.with_other_side(element, diagnostic);
                self.diagnostics.push(diagnostic);
            } else {
                first.insert(same, *span);
            }
        }
    }

    /// Offers the other side of the body, where an element names exactly one part that has two.
    fn with_other_side(&self, element: &'a Expr, diagnostic: Diagnostic) -> Diagnostic {
        let mut sided = Sided(Vec::new());
        sided.expression(element);
        let [name] = sided.0.as_slice() else { return diagnostic };
        let text = name.text.as_str();
        let other = match (text.strip_suffix("_l"), text.strip_suffix("_r")) {
            (Some(stem), _) => format!("{stem}_r"),
            (_, Some(stem)) => format!("{stem}_l"),
            _ => return diagnostic,
        };
        if self.body_element(&other).is_none() {
            return diagnostic;
        }
        diagnostic.suggest(format!("did you mean `{other}`?"), name.span, other)
    }
}

/// Names that end in a side of the body.
struct Sided<'a>(Vec<&'a Name>);

impl<'a> Visitor<'a> for Sided<'a> {
    fn expression(&mut self, expression: &'a Expr) {
        if let ExprKind::Name(name) = &expression.kind
            && (name.text.ends_with("_l") || name.text.ends_with("_r"))
        {
            self.0.push(name);
        }
        walk_expression(self, expression);
    }
}
