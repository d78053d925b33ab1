//! Mathematics in plain characters.

use crate::numbers::exact;
use crate::syntax::tree::{Argument, BinaryOperator, CompareOperator, Expr, ExprKind, Frame, Quantity, UnaryOperator};

/// A formula as mathematics.
pub(crate) fn mathematics(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number(quantity) => number(quantity),
        ExprKind::Bool(truth) => truth.to_string(),
        ExprKind::Text(text) => format!("\"{text}\""),
        ExprKind::Name(name) => greek(&name.text),
        ExprKind::Selector { kind, pattern } => format!("{} \"{}\"", kind.text, pattern.value),
        ExprKind::Field { base, name } => format!("{}.{}", mathematics(base), name.text),
        ExprKind::Call { function, arguments } => call(function, arguments),
        ExprKind::Index { base, index } => format!("{}[{}]", mathematics(base), mathematics(index)),
        ExprKind::List(elements) => format!("[{}]", list(elements.iter())),
        ExprKind::Comprehension { element, variable, source } => {
            format!("[{} for {} in {}]", mathematics(element), variable.text, mathematics(source))
        }
        ExprKind::Range { low, high } => format!("{} .. {}", mathematics(low), mathematics(high)),
        ExprKind::Paren(inner) => format!("({})", mathematics(inner)),
        ExprKind::Unary { operator: UnaryOperator::Negate, operand } => format!("\u{2212}{}", mathematics(operand)),
        ExprKind::Unary { operator: UnaryOperator::Not, operand } => format!("not {}", mathematics(operand)),
        ExprKind::Binary { .. } => chain(expr),
        ExprKind::Compare { operands, operators } => {
            let mut text = operands.first().map_or_else(String::new, mathematics);
            for ((operator, _), operand) in operators.iter().zip(operands.iter().skip(1)) {
                text += &format!(" {} {}", comparison(*operator), mathematics(operand));
            }
            text
        }
        ExprKind::InFrame { value, frame } => format!("{} in {}", mathematics(value), frame_name(frame)),
        ExprKind::If { branches, otherwise } => {
            let cases = branches.iter().map(|(condition, value)| format!("{} if {}", mathematics(value), mathematics(condition)));
            format!("{{ {}; {} otherwise }}", cases.collect::<Vec<_>>().join("; "), mathematics(otherwise))
        }
        ExprKind::When { value, condition } => format!("{} \u{00b7} [{}]", mathematics(value), mathematics(condition)),
        ExprKind::EndedBy(reason) => format!("ended by {}", reason.text),
        ExprKind::At { value, pose } => format!("{} at {}", mathematics(value), pose.text),
        ExprKind::Error(_) => "?".to_owned(),
    }
}

/// The left spine of infix operators, without recursion along it.
fn chain(expr: &Expr) -> String {
    let mut parts = Vec::new();
    let mut first = expr;
    while let ExprKind::Binary { operator, left, right, .. } = &first.kind {
        parts.push((*operator, &**right));
        first = left;
    }
    let mut text = mathematics(first);
    for (operator, right) in parts.into_iter().rev() {
        text += &match operator {
            BinaryOperator::Add => format!(" + {}", mathematics(right)),
            BinaryOperator::Subtract => format!(" \u{2212} {}", mathematics(right)),
            BinaryOperator::Multiply => format!(" \u{00b7} {}", mathematics(right)),
            BinaryOperator::Divide => format!(" / {}", mathematics(right)),
            BinaryOperator::Power => exponent(right),
            BinaryOperator::And => format!(" and {}", mathematics(right)),
            BinaryOperator::Or => format!(" or {}", mathematics(right)),
        };
    }
    text
}

fn exponent(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number(Quantity { value, unit: None, .. }) if *value == 2.0 => "\u{00b2}".to_owned(),
        ExprKind::Number(Quantity { value, unit: None, .. }) if *value == 3.0 => "\u{00b3}".to_owned(),
        _ => format!("^{}", mathematics(expr)),
    }
}

fn call(function: &Expr, arguments: &[Argument]) -> String {
    let inside = list(arguments.iter().map(|argument| &argument.value));
    let name = mathematics(function);
    match name.as_str() {
        "norm" => format!("\u{2016}{inside}\u{2016}"),
        "abs" => format!("|{inside}|"),
        "sum" => format!("\u{03a3}({inside})"),
        "sqrt" => format!("\u{221a}({inside})"),
        _ => format!("{name}({inside})"),
    }
}

fn list<'a>(elements: impl Iterator<Item = &'a Expr>) -> String {
    elements.map(mathematics).collect::<Vec<_>>().join(", ")
}

fn number(quantity: &Quantity) -> String {
    match &quantity.unit {
        Some(unit) => format!("{} {}", exact(quantity.value), unit.text),
        None => exact(quantity.value),
    }
}

fn greek(name: &str) -> String {
    match name {
        "pi" => "\u{03c0}".to_owned(),
        other => other.to_owned(),
    }
}

fn comparison(operator: CompareOperator) -> &'static str {
    match operator {
        CompareOperator::Less => "<",
        CompareOperator::LessEqual => "\u{2264}",
        CompareOperator::Greater => ">",
        CompareOperator::GreaterEqual => "\u{2265}",
        CompareOperator::Equal => "=",
        CompareOperator::NotEqual => "\u{2260}",
    }
}

fn frame_name(frame: &Frame) -> String {
    if frame.heading { format!("heading({})", frame.name.text) } else { frame.name.text.clone() }
}
