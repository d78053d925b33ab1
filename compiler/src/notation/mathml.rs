//! Mathematics as MathML Core, which browsers draw by themselves.

use super::{Fence, Formula, Letter, Sign};

/// A formula as the inside of a `math` element.
pub(crate) fn mathml(formula: &Formula) -> String {
    match formula {
        Formula::Number(digits) => format!("<mn>{}</mn>", escaped(digits)),
        Formula::Unit(factors) => unit(factors),
        Formula::Words(text) => format!("<mtext>{}</mtext>", escaped(text)),
        Formula::Name(base, side) => below(&format!("<mi>{}</mi>", escaped(base)), side),
        Formula::Letter(letter) => symbol(letter),
        Formula::Row(parts) => row(parts),
        Formula::Sign(sign) => operator(*sign),
        Formula::Fraction(above, below) => format!("<mfrac>{}{}</mfrac>", one(above), one(below)),
        Formula::Power(base, exponent) => format!("<msup>{}{}</msup>", one(base), one(exponent)),
        Formula::Fence(kind, inside) => fenced(*kind, &mathml(inside)),
        Formula::Root(inside) => format!("<msqrt>{}</msqrt>", mathml(inside)),
        Formula::Call(name, arguments) => {
            let inside: Vec<String> = arguments.iter().map(mathml).collect();
            let name = format!("<mi>{}</mi><mo>\u{2061}</mo>", escaped(name));
            format!("<mrow>{name}{}</mrow>", fenced(Fence::Round, &inside.join("<mo separator=\"true\">,</mo>")))
        }
        Formula::Cases(cases, otherwise) => {
            let row = |value: String, when: String| format!("<mtr><mtd>{value}</mtd><mtd>{when}</mtd></mtr>");
            let rows: String = cases
                .iter()
                .map(|(value, condition)| row(mathml(value), format!("<mtext>if&#160;</mtext>{}", mathml(condition))))
                .collect();
            let last = row(mathml(otherwise), "<mtext>otherwise</mtext>".to_owned());
            format!("<mrow><mo fence=\"true\">{{</mo><mtable class=\"cases\">{rows}{last}</mtable></mrow>")
        }
        Formula::Below(base, text) => below(&one(base), text),
    }
}

/// A formula that counts as one element.
fn one(formula: &Formula) -> String {
    format!("<mrow>{}</mrow>", mathml(formula))
}

fn below(base: &str, text: &str) -> String {
    if text.is_empty() { base.to_owned() } else { format!("<msub>{base}<mtext>{}</mtext></msub>", escaped(text)) }
}

fn row(parts: &[Formula]) -> String {
    let mut text = String::from("<mrow>");
    for (index, part) in parts.iter().enumerate() {
        let after_number = index > 0 && matches!(parts[index - 1], Formula::Number(_));
        if matches!(part, Formula::Unit(_)) && after_number {
            text += "<mspace width=\"0.17em\"></mspace>";
        }
        // The first sign of a row is that of what follows it.
        let leading = index == 0 || matches!(parts[index - 1], Formula::Sign(_));
        match part {
            Formula::Sign(Sign::Minus) if leading => text += "<mo form=\"prefix\">\u{2212}</mo>",
            _ => text += &mathml(part),
        }
    }
    text + "</mrow>"
}

fn fenced(kind: Fence, inside: &str) -> String {
    let (before, open, close) = match kind {
        Fence::Round => ("", "(", ")"),
        Fence::Square => ("", "[", "]"),
        Fence::Absolute => ("", "|", "|"),
        Fence::Norm => ("", "\u{2016}", "\u{2016}"),
        Fence::Indicator => ("<mi>\u{1d540}</mi>", "(", ")"),
    };
    format!(
        "<mrow>{before}<mo fence=\"true\" form=\"prefix\">{open}</mo>{inside}<mo fence=\"true\" form=\"postfix\">{close}</mo></mrow>"
    )
}

fn operator(sign: Sign) -> String {
    let character = match sign {
        Sign::Plus => "+",
        Sign::Minus => "\u{2212}",
        Sign::Times => "\u{22c5}",
        Sign::Slash => "/",
        Sign::And => "\u{2227}",
        Sign::Or => "\u{2228}",
        Sign::Not => "\u{ac}",
        Sign::Less => "&lt;",
        Sign::LessEqual => "\u{2264}",
        Sign::Greater => "&gt;",
        Sign::GreaterEqual => "\u{2265}",
        Sign::Equal => "=",
        Sign::NotEqual => "\u{2260}",
        Sign::Comma => return "<mo separator=\"true\">,</mo>".to_owned(),
        Sign::To => "\u{2026}",
        Sign::Sum => "\u{2211}",
    };
    format!("<mo>{character}</mo>")
}

fn symbol(letter: &Letter) -> String {
    let character = match letter.symbol {
        "omega" if letter.bold => "\u{1d6da}".to_owned(),
        "omega" => "\u{3c9}".to_owned(),
        "theta" => "\u{3b8}".to_owned(),
        "phi" => "\u{3c6}".to_owned(),
        "psi" => "\u{3c8}".to_owned(),
        "tau" => "\u{3c4}".to_owned(),
        "pi" => "\u{3c0}".to_owned(),
        "ell" => "\u{2113}".to_owned(),
        other => other.chars().map(|character| if letter.bold { bold(character) } else { character }).collect(),
    };
    let base = match letter.dots {
        0 => format!("<mi>{character}</mi>"),
        1 => format!("<mover accent=\"true\"><mi>{character}</mi><mo>\u{2d9}</mo></mover>"),
        _ => format!("<mover accent=\"true\"><mi>{character}</mi><mo>\u{a8}</mo></mover>"),
    };
    let words = letter.below.join(",");
    match (words.is_empty(), letter.above.is_empty()) {
        (_, true) => below(&base, &words),
        (true, false) => format!("<msup>{base}<mi>{}</mi></msup>", letter.above),
        (false, false) => {
            format!("<msubsup>{base}<mtext>{}</mtext><mi>{}</mi></msubsup>", escaped(&words), letter.above)
        }
    }
}

/// A letter of the mathematical alphabet in bold.
fn bold(letter: char) -> char {
    let from = |first: char, bold: u32| char::from_u32(bold + (letter as u32 - first as u32)).unwrap_or(letter);
    match letter {
        'a'..='z' => from('a', 0x1d41a),
        'A'..='Z' => from('A', 0x1d400),
        other => other,
    }
}

fn unit(factors: &[(String, i32, i32)]) -> String {
    let power = |(name, numerator, denominator): &(String, i32, i32)| {
        let name = format!("<mi mathvariant=\"normal\">{}</mi>", escaped(name));
        let exponent = match (numerator, denominator) {
            (1, 1) => return name,
            (_, 1) => numerator.to_string(),
            _ => format!("{numerator}/{denominator}"),
        };
        format!("<msup>{name}<mn>{}</mn></msup>", exponent.replace('-', "\u{2212}"))
    };
    let parts: Vec<String> = factors.iter().map(power).collect();
    format!("<mrow class=\"unit\">{}</mrow>", parts.join("<mspace width=\"0.1em\"></mspace>"))
}

/// Characters that HTML and XML read as marks, written out.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
    }
    escaped
}
