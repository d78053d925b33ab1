//! From the syntax tree to mathematics.

use super::letters::{declared, readable, signal};
use super::{Fence, Formula, Letter, Sign};
use crate::numbers::exact;
use crate::syntax::tree::{Argument, BinaryOperator, CompareOperator, Expr, ExprKind, Quantity, UnaryOperator};

/// A formula as mathematics.
pub(super) fn formula(expr: &Expr) -> Formula {
    match &expr.kind {
        ExprKind::Number(quantity) => number(quantity),
        ExprKind::Bool(truth) => Formula::Words(truth.to_string()),
        ExprKind::Text(text) => Formula::Words(format!("\u{201c}{text}\u{201d}")),
        ExprKind::Name(name) if name.text == "pi" => Formula::Letter(Letter { symbol: "pi", ..Letter::default() }),
        ExprKind::Name(name) => declared(&name.text),
        ExprKind::Selector { kind, pattern } => Formula::Words(format!("{} {}", kind.text, pattern.value)),
        ExprKind::Field { base, name } => field(expr, base, &name.text),
        ExprKind::Call { function, arguments } => call(function, arguments),
        ExprKind::Index { base, index } => Formula::Row(vec![formula(base), fence(Fence::Square, formula(index))]),
        ExprKind::List(elements) => fence(Fence::Square, separated(elements.iter().map(formula))),
        ExprKind::Comprehension { element, variable, source } => {
            let run = Formula::Words(format!(" for {} in ", variable.text));
            fence(Fence::Square, Formula::Row(vec![formula(element), run, formula(source)]))
        }
        ExprKind::Range { low, high } => Formula::Row(vec![formula(low), Formula::Sign(Sign::To), formula(high)]),
        ExprKind::Paren(inner) => fence(Fence::Round, formula(inner)),
        ExprKind::Unary { operator, operand } => {
            let sign = if *operator == UnaryOperator::Negate { Sign::Minus } else { Sign::Not };
            Formula::Row(vec![Formula::Sign(sign), formula(operand)])
        }
        ExprKind::Binary { .. } => chain(expr),
        ExprKind::Compare { operands, operators } => {
            let mut row: Vec<Formula> = operands.first().map(formula).into_iter().collect();
            for ((operator, _), operand) in operators.iter().zip(operands.iter().skip(1)) {
                row.extend([Formula::Sign(comparison(*operator)), formula(operand)]);
            }
            Formula::Row(row)
        }
        ExprKind::InFrame { value, frame } => {
            let heading = if frame.heading { "heading of " } else { "" };
            let inside = fence(Fence::Round, formula(bare(value)));
            Formula::Below(Box::new(inside), format!("{heading}{}", readable(&frame.name.text)))
        }
        ExprKind::If { branches, otherwise } => {
            let cases = branches.iter().map(|(condition, value)| (formula(value), formula(condition)));
            Formula::Cases(cases.collect(), Box::new(formula(otherwise)))
        }
        ExprKind::When { value, condition } => {
            let value = match &value.kind {
                ExprKind::Binary { operator: BinaryOperator::Add | BinaryOperator::Subtract, .. } => {
                    fence(Fence::Round, formula(value))
                }
                _ => formula(value),
            };
            Formula::Row(vec![value, Formula::Sign(Sign::Times), self::condition(condition)])
        }
        ExprKind::EndedBy(reason) => Formula::Words(format!("ended by {}", reason.text.replace('_', " "))),
        ExprKind::At { value, pose } => Formula::Below(Box::new(formula(value)), readable(&pose.text)),
        ExprKind::Error(_) => Formula::Words("?".to_owned()),
    }
}

/// A condition that counts 0 or 1.
pub(super) fn condition(expr: &Expr) -> Formula {
    fence(Fence::Indicator, formula(bare(expr)))
}

/// An expression without brackets around it.
pub(super) fn bare(expr: &Expr) -> &Expr {
    match &expr.kind {
        ExprKind::Paren(inner) => bare(inner),
        _ => expr,
    }
}

fn fence(kind: Fence, inside: Formula) -> Formula {
    Formula::Fence(kind, Box::new(inside))
}

fn separated(parts: impl Iterator<Item = Formula>) -> Formula {
    let mut row = Vec::new();
    for part in parts {
        if !row.is_empty() {
            row.push(Formula::Sign(Sign::Comma));
        }
        row.push(part);
    }
    Formula::Row(row)
}

/// The names of `a.b.c`, if it consists of names.
fn path(expr: &Expr) -> Option<Vec<&str>> {
    match &expr.kind {
        ExprKind::Name(name) => Some(vec![&name.text]),
        ExprKind::Selector { pattern, .. } => Some(vec![&pattern.value]),
        ExprKind::Field { base, name } => {
            let mut names = path(base)?;
            names.push(&name.text);
            Some(names)
        }
        _ => None,
    }
}

/// Components of vectors and places.
const COMPONENTS: [&str; 7] = ["x", "y", "z", "xy", "forward", "left", "up"];

fn field(expr: &Expr, base: &Expr, name: &str) -> Formula {
    match path(expr).as_deref() {
        // Of something declared: its name with the component below.
        Some([owner, component]) if COMPONENTS.contains(component) => {
            Formula::Below(Box::new(declared(owner)), (*component).to_owned())
        }
        Some(names) => signal(names).unwrap_or_else(|| {
            let words: Vec<String> = names.iter().map(|name| readable(name)).collect();
            Formula::Words(words.join("."))
        }),
        // A component or a part of something computed.
        None => Formula::Below(Box::new(formula(base)), readable(name)),
    }
}

/// The left spine of infix operators, without recursion along it.
fn chain(expr: &Expr) -> Formula {
    let mut parts = Vec::new();
    let mut first = expr;
    while let ExprKind::Binary { operator, left, right, .. } = &first.kind {
        parts.push((*operator, &**right));
        first = left;
    }
    let mut row = vec![formula(first)];
    // The last factor, over which a division stands.
    let mut factor = bare(first);
    for (operator, right) in parts.into_iter().rev() {
        let sign = match operator {
            BinaryOperator::Power => {
                let base = row.pop().map(Box::new);
                row.extend(base.map(|base| Formula::Power(base, Box::new(formula(bare(right))))));
                continue;
            }
            BinaryOperator::Divide => {
                divide(&mut row, factor, right);
                factor = right;
                continue;
            }
            BinaryOperator::Add => Sign::Plus,
            BinaryOperator::Subtract => Sign::Minus,
            BinaryOperator::Multiply => Sign::Times,
            BinaryOperator::And => Sign::And,
            BinaryOperator::Or => Sign::Or,
        };
        row.extend([Formula::Sign(sign), formula(right)]);
        factor = bare(right);
    }
    if row.len() == 1 { row.remove(0) } else { Formula::Row(row) }
}

/// Divides the last factor of a row: by a number or a name with a slash, by anything else as a fraction.
fn divide(row: &mut Vec<Formula>, factor: &Expr, right: &Expr) {
    let single = matches!(&bare(right).kind, ExprKind::Number(_) | ExprKind::Name(_) | ExprKind::Field { .. });
    if single {
        let right = match &right.kind {
            // By one of a unit is by the unit.
            ExprKind::Number(Quantity { value: 1.0, unit: Some(unit), .. }) => unit_of(&unit.factors),
            _ => formula(right),
        };
        row.extend([Formula::Sign(Sign::Slash), right]);
        return;
    }
    let Some(last) = row.pop() else { return };
    // Brackets that only hold a numerator together are not needed above a line.
    let above = match last {
        Formula::Fence(Fence::Round, inside) if matches!(factor.kind, ExprKind::Binary { .. }) => *inside,
        other => other,
    };
    row.push(Formula::Fraction(Box::new(above), Box::new(formula(bare(right)))));
}

fn call(function: &Expr, arguments: &[Argument]) -> Formula {
    let plain = if let ExprKind::Name(name) = &function.kind { name.text.as_str() } else { "" };
    let inside = || separated(arguments.iter().map(|argument| formula(&argument.value)));
    match (plain, arguments) {
        ("norm", _) => fence(Fence::Norm, inside()),
        ("abs", _) => fence(Fence::Absolute, inside()),
        ("sqrt", _) => Formula::Root(Box::new(inside())),
        ("sum", _) => Formula::Row(vec![Formula::Sign(Sign::Sum), fence(Fence::Round, inside())]),
        ("initial", [only]) => Formula::Below(Box::new(formula(&only.value)), "initial".to_owned()),
        ("heading", [only]) => Formula::Words(format!("heading of {}", path(&only.value).unwrap_or_default().join(" "))),
        _ => {
            let named = |argument: &Argument| match &argument.name {
                Some(name) => {
                    let word = Formula::Words(name.text.replace('_', " "));
                    Formula::Row(vec![word, Formula::Sign(Sign::Equal), formula(&argument.value)])
                }
                None => formula(&argument.value),
            };
            let name = match path(function) {
                Some(names) => names.iter().map(|name| readable(name)).collect::<Vec<_>>().join("."),
                None => "f".to_owned(),
            };
            Formula::Call(name, arguments.iter().map(named).collect())
        }
    }
}

fn number(quantity: &Quantity) -> Formula {
    let digits = Formula::Number(exact(quantity.value));
    match &quantity.unit {
        Some(unit) => Formula::Row(vec![digits, unit_of(&unit.factors)]),
        None => digits,
    }
}

fn unit_of(factors: &[crate::syntax::tree::UnitFactor]) -> Formula {
    Formula::Unit(factors.iter().map(|factor| (factor.name.clone(), factor.numerator, factor.denominator)).collect())
}

fn comparison(operator: CompareOperator) -> Sign {
    match operator {
        CompareOperator::Less => Sign::Less,
        CompareOperator::LessEqual => Sign::LessEqual,
        CompareOperator::Greater => Sign::Greater,
        CompareOperator::GreaterEqual => Sign::GreaterEqual,
        CompareOperator::Equal => Sign::Equal,
        CompareOperator::NotEqual => Sign::NotEqual,
    }
}
