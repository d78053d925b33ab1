//! A formula as it is read: the same with all brackets.

use msk_compiler::syntax::tree::{BinaryOperator, CompareOperator, Expr, ExprKind, Quantity, UnaryOperator};

/// The formula; operands that are not atoms are put in brackets.
pub fn reading(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number(quantity) => number(quantity),
        ExprKind::Bool(value) => value.to_string(),
        ExprKind::Text(text) => format!("\"{text}\""),
        ExprKind::Name(name) => name.text.clone(),
        ExprKind::Selector { kind, pattern } => format!("{} \"{}\"", kind.text, pattern.value),
        ExprKind::Field { base, name } => format!("{}.{}", operand(base), name.text),
        ExprKind::Call { function, arguments } => {
            let arguments: Vec<String> = arguments
                .iter()
                .map(|argument| match &argument.name {
                    Some(name) => format!("{} = {}", name.text, reading(&argument.value)),
                    None => reading(&argument.value),
                })
                .collect();
            format!("{}({})", operand(function), arguments.join(", "))
        }
        ExprKind::Index { base, index } => format!("{}[{}]", operand(base), reading(index)),
        ExprKind::List(items) => format!("[{}]", items.iter().map(reading).collect::<Vec<_>>().join(", ")),
        ExprKind::Comprehension { element, variable, source } => {
            format!("[{} for {} in {}]", reading(element), variable.text, reading(source))
        }
        ExprKind::Range { low, high } => format!("{} .. {}", operand(low), operand(high)),
        ExprKind::Paren(inner) => format!("({})", reading(inner)),
        ExprKind::Unary { operator: UnaryOperator::Negate, operand: value } => format!("-{}", operand(value)),
        ExprKind::Unary { operator: UnaryOperator::Not, operand: value } => format!("not {}", operand(value)),
        ExprKind::Binary { operator, left, right, .. } => {
            format!("{} {} {}", operand(left), binary(*operator), operand(right))
        }
        ExprKind::Compare { operands, operators } => {
            let rest = operators.iter().zip(&operands[1..]);
            let rest: String = rest.map(|((sign, _), value)| format!(" {} {}", compare(*sign), operand(value))).collect();
            format!("{}{rest}", operand(&operands[0]))
        }
        ExprKind::InFrame { value, frame } if frame.heading => {
            format!("{} in heading({})", operand(value), frame.name.text)
        }
        ExprKind::InFrame { value, frame } => format!("{} in {}", operand(value), frame.name.text),
        ExprKind::If { branches, otherwise } => {
            let branches: Vec<String> =
                branches.iter().map(|(when, then)| format!("if {} then {}", operand(when), operand(then))).collect();
            format!("{} else {}", branches.join(" else "), operand(otherwise))
        }
        ExprKind::When { value, condition } => format!("{} when {}", operand(value), operand(condition)),
        ExprKind::EndedBy(reason) => format!("ended by {}", reason.text),
        ExprKind::At { value, pose } => format!("{} at {}", operand(value), pose.text),
        ExprKind::Error(_) => "<error>".to_owned(),
    }
}

fn operand(expr: &Expr) -> String {
    let compound = matches!(
        expr.kind,
        ExprKind::Unary { .. }
            | ExprKind::Binary { .. }
            | ExprKind::Compare { .. }
            | ExprKind::InFrame { .. }
            | ExprKind::If { .. }
            | ExprKind::When { .. }
            | ExprKind::EndedBy(_)
    );
    if compound { format!("({})", reading(expr)) } else { reading(expr) }
}

fn number(quantity: &Quantity) -> String {
    match &quantity.unit {
        Some(unit) => format!("{} {}", quantity.value, unit.text),
        None => quantity.value.to_string(),
    }
}

fn binary(operator: BinaryOperator) -> &'static str {
    match operator {
        BinaryOperator::Add => "+",
        BinaryOperator::Subtract => "-",
        BinaryOperator::Multiply => "*",
        BinaryOperator::Divide => "/",
        BinaryOperator::Power => "^",
        BinaryOperator::And => "and",
        BinaryOperator::Or => "or",
    }
}

fn compare(operator: CompareOperator) -> &'static str {
    match operator {
        CompareOperator::Less => "<",
        CompareOperator::LessEqual => "<=",
        CompareOperator::Greater => ">",
        CompareOperator::GreaterEqual => ">=",
        CompareOperator::Equal => "==",
        CompareOperator::NotEqual => "!=",
    }
}
