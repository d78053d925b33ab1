//! Mathematics as LaTeX, for math mode with `amsmath` and `amssymb`.

use super::{Fence, Formula, Letter, Sign};

/// A formula for math mode.
pub(crate) fn latex(formula: &Formula) -> String {
    match formula {
        Formula::Number(digits) => digits.clone(),
        Formula::Unit(factors) => unit(factors),
        Formula::Words(text) => format!("\\text{{{}}}", words(text)),
        Formula::Name(base, side) if side.is_empty() => format!("\\mathit{{{}}}", italic(base)),
        Formula::Name(base, side) => format!("\\mathit{{{}}}_{{\\text{{{}}}}}", italic(base), words(side)),
        Formula::Letter(letter) => symbol(letter),
        Formula::Row(parts) => row(parts),
        Formula::Sign(sign) => operator(*sign).to_owned(),
        Formula::Fraction(above, below) => format!("\\frac{{{}}}{{{}}}", latex(above), latex(below)),
        Formula::Power(base, exponent) => format!("{{{}}}^{{{}}}", latex(base), latex(exponent)),
        Formula::Fence(kind, inside) => fenced(*kind, &latex(inside)),
        Formula::Root(inside) => format!("\\sqrt{{{}}}", latex(inside)),
        Formula::Call(name, arguments) => {
            let inside: Vec<String> = arguments.iter().map(latex).collect();
            format!("{}({})", function(name), inside.join(",\\allowbreak "))
        }
        Formula::Cases(cases, otherwise) => {
            let rows: Vec<String> =
                cases.iter().map(|(value, condition)| format!("{} & \\text{{if }} {}", latex(value), latex(condition))).collect();
            let last = format!("{} & \\text{{otherwise}}", latex(otherwise));
            format!("\\begin{{cases}} {} \\\\ {last} \\end{{cases}}", rows.join(" \\\\ "))
        }
        Formula::Below(base, text) => format!("{{{}}}_{{\\text{{{}}}}}", latex(base), words(text)),
    }
}

/// Parts side by side; a unit keeps a thin space from its number.
fn row(parts: &[Formula]) -> String {
    let mut text = String::new();
    for (index, part) in parts.iter().enumerate() {
        let after_number = index > 0 && matches!(parts[index - 1], Formula::Number(_));
        if matches!(part, Formula::Unit(_)) && after_number {
            text += "\\,";
        } else if index > 0 {
            text.push(' ');
        }
        text += &latex(part);
    }
    text
}

fn fenced(kind: Fence, inside: &str) -> String {
    match kind {
        Fence::Round => format!("({inside})"),
        Fence::Square => format!("[{inside}]"),
        Fence::Absolute => format!("\\lvert {inside} \\rvert"),
        Fence::Norm => format!("\\lVert {inside} \\rVert"),
        Fence::Indicator => format!("\\mathbb{{I}}({inside})"),
    }
}

fn operator(sign: Sign) -> &'static str {
    match sign {
        Sign::Plus => "+",
        Sign::Minus => "-",
        Sign::Times => "\\cdot",
        Sign::Slash => "/",
        Sign::And => "\\land",
        Sign::Or => "\\lor",
        Sign::Not => "\\lnot",
        Sign::Less => "<",
        Sign::LessEqual => "\\le",
        Sign::Greater => ">",
        Sign::GreaterEqual => "\\ge",
        Sign::Equal => "=",
        Sign::NotEqual => "\\ne",
        Sign::Comma => ",\\allowbreak",
        Sign::To => "\\ldots",
        Sign::Sum => "\\sum",
    }
}

fn function(name: &str) -> String {
    match name {
        "exp" | "log" | "sin" | "cos" | "tan" | "max" | "min" | "tanh" => format!("\\{name}"),
        _ => format!("\\operatorname{{{}}}", operator_name(name)),
    }
}

/// `\operatorname` is in math mode: blanks must be kept.
fn operator_name(name: &str) -> String {
    words(name).replace(' ', "\\ ")
}

fn symbol(letter: &Letter) -> String {
    let greek = ["omega", "theta", "phi", "psi", "tau", "pi", "ell"];
    let plain = if greek.contains(&letter.symbol) { format!("\\{}", letter.symbol) } else { letter.symbol.to_owned() };
    let bold = match (letter.bold, greek.contains(&letter.symbol)) {
        (true, true) => format!("\\boldsymbol{{{plain}}}"),
        (true, false) => format!("\\mathbf{{{plain}}}"),
        _ => plain,
    };
    let mut text = match letter.dots {
        0 => bold,
        1 => format!("\\dot{{{bold}}}"),
        _ => format!("\\ddot{{{bold}}}"),
    };
    if !letter.below.is_empty() {
        let parts: Vec<String> = letter.below.iter().map(|part| words(part)).collect();
        text += &format!("_{{\\text{{{}}}}}", parts.join(","));
    }
    if !letter.above.is_empty() {
        text += &format!("^{{{}}}", letter.above);
    }
    text
}

fn unit(factors: &[(String, i32, i32)]) -> String {
    let power = |name: &str, numerator: i32, denominator: i32| {
        let name = if name == "%" { "\\%".to_owned() } else { name.to_owned() };
        match (numerator, denominator) {
            (1, 1) => name,
            (_, 1) => format!("{name}^{{{numerator}}}"),
            _ => format!("{name}^{{{numerator}/{denominator}}}"),
        }
    };
    let parts: Vec<String> = factors.iter().map(|(name, numerator, denominator)| power(name, *numerator, *denominator)).collect();
    format!("\\mathrm{{{}}}", parts.join("\\,"))
}

/// A declared name: its words in math italic.
fn italic(text: &str) -> String {
    words(text).replace(' ', "\\ ")
}

/// Words as LaTeX prints them, special characters escaped.
pub(crate) fn words(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', character]),
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '<' => escaped.push_str("\\textless{}"),
            '>' => escaped.push_str("\\textgreater{}"),
            '\u{201c}' => escaped.push_str("``"),
            '\u{201d}' => escaped.push_str("''"),
            '\u{d7}' => escaped.push_str("$\\times$"),
            '\u{b0}' => escaped.push_str("$^\\circ$"),
            '\u{b2}' => escaped.push_str("$^2$"),
            '\u{b1}' => escaped.push_str("$\\pm$"),
            '\u{2212}' => escaped.push_str("$-$"),
            other => escaped.push(other),
        }
    }
    escaped
}
