//! The verifier: parts lie within their wholes, and a value is as wide as its type, after the whole task is checked.
//!
//! What it finds is a mistake of the compiler, never of a text.

use super::value::Value;
use super::{Expr, ExprId, Hir};
use crate::graph::Graph;

impl Hir {
    /// What is wrong first, if anything is. `graph` is the one whose nodes the expressions name; expressions of tests may name
    /// nodes of a longer one.
    pub(crate) fn verify(&self, graph: &Graph) -> Option<String> {
        if let Some(open) = self.open.last() {
            return Some(format!("the expression at {:?} was never closed", self.expr(*open).span));
        }
        // Where the wholes around an expression end, the innermost last.
        let mut ends: Vec<u32> = Vec::new();
        for (place, expr) in self.exprs.iter().enumerate() {
            while ends.last().is_some_and(|end| *end as usize <= place) {
                ends.pop();
            }
            let whole = ends.last().copied().unwrap_or(self.next().0);
            if (expr.end as usize) <= place || expr.end > whole {
                return Some(format!("the expression at {:?} is not within the one around it", expr.span));
            }
            ends.push(expr.end);
            if let Some(finding) = self.formula_of(expr).or_else(|| width_of(expr, graph)) {
                return Some(finding);
            }
        }
        None
    }

    fn formula_of(&self, expr: &Expr) -> Option<String> {
        let ExprId(formula) = expr.formula?;
        let known = self.exprs.get(formula as usize).is_some_and(|formula| formula.value.is_some());
        (!known).then(|| format!("the name at {:?} refers to a formula without a value", expr.span))
    }
}

fn width_of(expr: &Expr, graph: &Graph) -> Option<String> {
    let Some(Value::Typed(data)) = &expr.value else { return None };
    let width = graph.nodes().get(data.node.index())?.width;
    let lanes = data.kind.lanes();
    (width != lanes).then(|| format!("the value of {lanes} lanes at {:?} is at a node of width {width}", expr.span))
}

#[cfg(test)]
mod tests {
    use super::super::ExprKind;
    use super::super::types::ElementType;
    use super::super::value::{TypedValue, Value};
    use super::*;
    use crate::diagnostics::{FileId, Span};

    fn hir(lanes: usize, graph: &mut Graph) -> Hir {
        let node = graph.constants(&vec![0.5; lanes]);
        let value = Value::Typed(TypedValue::new(node, ElementType::PLAIN));
        let mut hir = Hir::default();
        let whole = hir.open(FileId::default(), Span::new(0, 5), ExprKind::Paren);
        let part = hir.open(FileId::default(), Span::new(1, 4), ExprKind::Literal);
        hir.close(part, Some(&value));
        hir.close(whole, Some(&value));
        hir
    }

    #[test]
    fn what_does_not_fit_is_found() {
        let mut graph = Graph::default();
        let right = hir(1, &mut graph);
        assert_eq!(right.verify(&graph), None);
        let finding = |hir: &Hir| hir.verify(&graph).unwrap_or_default();
        let mut beyond = right.clone();
        beyond.exprs[1].end = 3;
        assert!(finding(&beyond).contains("not within"), "{}", finding(&beyond));
        let mut lost = right.clone();
        lost.exprs[1].formula = Some(ExprId(7));
        assert!(finding(&lost).contains("without a value"), "{}", finding(&lost));
        let mut open = right;
        open.open(FileId::default(), Span::new(5, 6), ExprKind::Other);
        assert!(finding(&open).contains("never closed"), "{}", finding(&open));
        let mut graph = Graph::default();
        let wide = hir(3, &mut graph);
        assert!(wide.verify(&graph).is_some_and(|finding| finding.contains("at a node of width 3")));
    }
}
