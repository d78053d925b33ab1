//! What a formula reads.

use super::mathematics;
use crate::syntax::tree::{Expr, ExprKind};

/// Names and properties that a formula reads, in the order of the text, each once; functions are not among them.
pub(crate) fn names_in(expr: &Expr) -> Vec<String> {
    let mut names = Vec::new();
    collect(expr, &mut names);
    names
}

fn collect(expr: &Expr, names: &mut Vec<String>) {
    match &expr.kind {
        ExprKind::Name(_) | ExprKind::Selector { .. } => add(mathematics(expr), names),
        ExprKind::Field { base, .. } => match &base.kind {
            ExprKind::Name(_) | ExprKind::Selector { .. } | ExprKind::Field { .. } => add(mathematics(expr), names),
            _ => collect(base, names),
        },
        ExprKind::Call { arguments, .. } => arguments.iter().for_each(|argument| collect(&argument.value, names)),
        ExprKind::Index { base, index } => [base, index].into_iter().for_each(|part| collect(part, names)),
        ExprKind::List(elements) => elements.iter().for_each(|element| collect(element, names)),
        ExprKind::Compare { operands, .. } => operands.iter().for_each(|operand| collect(operand, names)),
        ExprKind::Comprehension { element, source, .. } => [element, source].into_iter().for_each(|part| collect(part, names)),
        ExprKind::Range { low, high } => [low, high].into_iter().for_each(|part| collect(part, names)),
        ExprKind::Paren(inner) | ExprKind::Unary { operand: inner, .. } => collect(inner, names),
        ExprKind::InFrame { value, .. } | ExprKind::At { value, .. } => collect(value, names),
        ExprKind::Binary { .. } => collect_chain(expr, names),
        ExprKind::If { branches, otherwise } => {
            for (condition, value) in branches {
                collect(condition, names);
                collect(value, names);
            }
            collect(otherwise, names);
        }
        ExprKind::When { value, condition } => [value, condition].into_iter().for_each(|part| collect(part, names)),
        ExprKind::Number(_) | ExprKind::Bool(_) | ExprKind::Text(_) | ExprKind::EndedBy(_) | ExprKind::Error(_) => {}
    }
}

fn collect_chain(expr: &Expr, names: &mut Vec<String>) {
    let mut operands = Vec::new();
    let mut first = expr;
    while let ExprKind::Binary { left, right, .. } = &first.kind {
        operands.push(&**right);
        first = left;
    }
    collect(first, names);
    operands.into_iter().rev().for_each(|operand| collect(operand, names));
}

fn add(name: String, names: &mut Vec<String>) {
    if !names.contains(&name) {
        names.push(name);
    }
}
