//! Words and literals of Python.

use msk_program::numbers::exact;

/// Longest line of a list.
const LINE: usize = 110;

/// A number.
pub(crate) fn number(value: f64) -> String {
    if value.is_nan() {
        return "np.nan".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "np.inf" } else { "-np.inf" }.to_owned();
    }
    let text = exact(value);
    // Whole numbers in Python have another division and no negative zero.
    if text.contains(['.', 'e']) { text } else { text + ".0" }
}

/// A string literal.
pub(crate) fn quoted(text: &str) -> String {
    let escaped: String = text.chars().flat_map(|c| if matches!(c, '"' | '\\') { vec!['\\', c] } else { vec![c] }).collect();
    format!("\"{escaped}\"")
}

/// Text of a docstring: what would end it is left out.
pub(crate) fn documented(text: &str) -> String {
    text.replace('\\', "").replace('"', "'").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A name that is made of letters, digits and underscores.
pub(crate) fn identifier(name: &str) -> String {
    let spelled: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let joined = spelled.split('_').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("_");
    if joined.is_empty() { "value".to_owned() } else { joined }
}

/// A tuple on one line.
pub(crate) fn flat(elements: &[String]) -> String {
    match elements {
        [] => "()".to_owned(),
        [only] => format!("({only},)"),
        several => format!("({})", several.join(", ")),
    }
}

/// A tuple that begins behind `column` columns: on one line if it fits, else on filled lines, `indent` columns and four more in.
pub(crate) fn tuple(elements: &[String], column: usize, indent: usize) -> String {
    let one = flat(elements);
    if one.len() + column <= LINE {
        return one;
    }
    let (mut lines, mut line) = (vec!["(".to_owned()], String::new());
    for element in elements {
        if !line.is_empty() && indent + 5 + line.len() + element.len() > LINE {
            lines.push(format!("{:1$}{line}", "", indent + 4));
            line.clear();
        }
        line += &format!("{}{element},", if line.is_empty() { "" } else { " " });
    }
    lines.push(format!("{:1$}{line}", "", indent + 4));
    lines.push(format!("{:indent$})", ""));
    lines.join("\n")
}

/// An expression that begins behind `column` columns, on lines of limited length that are indented by `indent` columns: broken after the
/// outermost brackets, or before summands, as formatters do; a product without brackets before its factors.
pub(crate) fn laid_out(expression: &str, column: usize, indent: usize) -> String {
    if expression.len() + column <= LINE {
        return expression.to_owned();
    }
    let brackets = widest_brackets(expression);
    let mut parts = summands(expression);
    if parts.len() == 1 && brackets.is_none() {
        parts = factors(expression);
    }
    if parts.len() > 1 {
        let lines: Vec<String> = parts.iter().map(|part| line(part, indent + 4)).collect();
        return format!("(\n{}\n{:indent$})", lines.join("\n"), "");
    }
    let Some((open, close)) = brackets else { return expression.to_owned() };
    let (head, inner, tail) = (&expression[..=open], &expression[open + 1..close], &expression[close..]);
    let parts = split(inner, |bytes, at| (bytes[at] == b',').then_some(1));
    let parts: Vec<&str> = parts.into_iter().map(str::trim).filter(|part| !part.is_empty()).collect();
    let lines: Vec<String> = parts.iter().map(|part| line(part, indent + 4) + ",").collect();
    // Brackets that only group take no comma.
    let groups = parts.len() == 1 && !head[..head.len() - 1].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
    let body = if groups { lines.join("\n").trim_end_matches(',').to_owned() } else { lines.join("\n") };
    format!("{head}\n{body}\n{:indent$}{tail}", "")
}

fn line(part: &str, indent: usize) -> String {
    format!("{:indent$}{}", "", laid_out(part, indent, indent))
}

/// The parts of a sum, each but the first with its sign before it.
fn summands(expression: &str) -> Vec<&str> {
    operands(expression, [b" + ", b" - "])
}

/// The parts of a product, each but the first with its operator before it.
fn factors(expression: &str) -> Vec<&str> {
    operands(expression, [b" * ", b" / "])
}

fn operands<'a>(expression: &'a str, operators: [&[u8; 3]; 2]) -> Vec<&'a str> {
    let parts = split(expression, |bytes, at| {
        let operator = bytes.get(at..at + 3).is_some_and(|word| operators.iter().any(|known| word == *known));
        operator.then_some(0)
    });
    parts.into_iter().map(str::trim).collect()
}

/// Splits outside of brackets and strings where `separates` gives the length of a separator.
fn split(text: &str, separates: impl Fn(&[u8], usize) -> Option<usize>) -> Vec<&str> {
    let (bytes, mut parts, mut from) = (text.as_bytes(), Vec::new(), 0);
    for at in outside(text) {
        if let Some(length) = separates(bytes, at)
            && at > from
        {
            parts.push(&text[from..at]);
            from = at + length;
        }
    }
    parts.push(&text[from..]);
    parts
}

/// The places of a text outside of brackets and strings.
fn outside(text: &str) -> Vec<usize> {
    let (mut depth, mut quoted, mut places) = (0_usize, false, Vec::new());
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b'(' | b'[' | b'{' if !quoted => depth += 1,
            b')' | b']' | b'}' if !quoted => depth = depth.saturating_sub(1),
            _ if depth == 0 && !quoted => places.push(at),
            _ => {}
        }
    }
    places
}

/// The longest of the outermost pairs of brackets.
fn widest_brackets(text: &str) -> Option<(usize, usize)> {
    let (mut depth, mut quoted, mut open, mut widest) = (0_usize, false, 0, None::<(usize, usize)>);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b'(' | b'[' | b'{' if !quoted => {
                if depth == 0 {
                    open = at;
                }
                depth += 1;
            }
            b')' | b']' | b'}' if !quoted => {
                depth = depth.saturating_sub(1);
                if depth == 0 && widest.is_none_or(|(from, to)| to - from < at - open) {
                    widest = Some((open, at));
                }
            }
            _ => {}
        }
    }
    widest.filter(|(from, to)| to - from > 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_expressions_are_broken_where_formatters_break_them() {
        let long = format!("np.exp(-5.0 * ({} + self.b()))", "self.a() * ".repeat(10) + "1.0");
        let text = laid_out(&long, 8, 8);
        assert!(text.lines().all(|line| line.len() <= LINE), "{text}");
        // But for brackets around what is broken, and commas behind arguments, nothing has changed.
        let bare = |text: &str| text.replace(|c: char| c.is_whitespace() || "(),".contains(c), "");
        assert_eq!(bare(&text), bare(&long));
    }

    #[test]
    fn numbers_are_never_whole() {
        assert_eq!([number(2.0), number(-0.5), number(f64::INFINITY)], ["2.0", "-0.5", "np.inf"]);
    }
}
