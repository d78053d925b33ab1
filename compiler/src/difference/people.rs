//! Numbers of a difference as people read them: few digits, and what changed in percent.

use crate::numbers::{beside, exact, for_people};

/// A piece of a text: a number, or what stands between two.
#[derive(Debug, Clone, PartialEq)]
enum Piece<'t> {
    Text(&'t str),
    Number(f64),
}

/// Two texts as people read them, and, where one number is all that differs, by how much it does: ` (+12.5 %)`.
pub(super) fn formatted(before: &str, after: &str) -> (String, String, String) {
    let (old, new) = (pieces(before), pieces(after));
    let alike = old.len() == new.len()
        && old.iter().zip(&new).all(|pair| match pair {
            (Piece::Text(old), Piece::Text(new)) => old == new,
            (Piece::Number(_), Piece::Number(_)) => true,
            _ => false,
        });
    if !alike {
        return (written(&old, None), written(&new, None), String::new());
    }
    let pairs = old.iter().zip(&new).filter_map(|pair| match pair {
        (Piece::Number(old), Piece::Number(new)) if old != new => Some((*old, *new)),
        _ => None,
    });
    let pairs: Vec<(f64, f64)> = pairs.collect();
    let ratio = if let [(old, new)] = pairs.as_slice() { percent(*old, *new) } else { String::new() };
    (written(&old, Some(&new)), written(&new, Some(&old)), ratio)
}

/// A text as people read it.
pub(super) fn one(text: &str) -> String {
    written(&pieces(text), None)
}

/// A text in SI units with its angles in degrees: `0.5 rad`, `-0.1 rad..0.1 rad`, `[0.0, 1.0] rad/s`; powers (`rad^2`) stay.
pub(super) fn degrees(text: &str) -> String {
    let pieces = pieces(text);
    let (mut written, mut in_degrees) = (String::new(), false);
    for (place, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Number(value) => {
                in_degrees = in_radians(&pieces[place + 1..]);
                written += &exact(if in_degrees { rounded_degrees(*value) } else { *value });
            }
            Piece::Text(text) if in_degrees => written += &text.replacen("rad", "deg", 1),
            Piece::Text(text) => written += text,
        }
    }
    written
}

/// Whether the unit behind a number, or behind the list that it belongs to, is that of an angle or of its rate.
fn in_radians(behind: &[Piece<'_>]) -> bool {
    let unit = behind.iter().find_map(|piece| match piece {
        Piece::Text(", ") | Piece::Number(_) => None,
        Piece::Text(text) => Some(*text),
    });
    let rest = unit.and_then(|text| text.strip_prefix(']').unwrap_or(text).strip_prefix(" rad"));
    rest.is_some_and(|rest| !rest.starts_with(|next: char| next == '^' || next.is_alphanumeric()))
}

/// To a billionth of a degree, so that 40 deg, kept as radians, is 40 deg again.
fn rounded_degrees(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}

/// By how much a number became larger or smaller; nothing where its sign changed or it was nothing.
fn percent(old: f64, new: f64) -> String {
    let change = 100.0 * (new / old - 1.0);
    if !change.is_finite() || new / old < 0.0 {
        return String::new();
    }
    let sign = if change > 0.0 { "+" } else { "" };
    format!(" ({sign}{} %)", for_people(change))
}

/// Puts pieces together; a number beside which another stands has as many digits as tell the two apart.
fn written(pieces: &[Piece<'_>], beside_which: Option<&[Piece<'_>]>) -> String {
    let number = |place: usize, value: f64| match beside_which.and_then(|others| others.get(place)) {
        Some(Piece::Number(other)) => beside(value, &[*other]),
        _ => for_people(value),
    };
    let shown = |(place, piece): (usize, &Piece<'_>)| match piece {
        Piece::Text(text) => (*text).to_owned(),
        // A whole number, such as a count of steps, keeps its digits.
        Piece::Number(value) if value.fract() == 0.0 && value.abs() < 1e9 => exact(*value),
        Piece::Number(value) => number(place, *value),
    };
    pieces.iter().enumerate().map(shown).collect()
}

/// Takes a text apart. Digits within a word (`hinge_2`, a hash) and powers of units (`m^-2`) are no numbers.
fn pieces(text: &str) -> Vec<Piece<'_>> {
    let (mut pieces, mut from, mut at) = (Vec::new(), 0, 0);
    let bytes = text.as_bytes();
    while at < bytes.len() {
        let end = number_at(bytes, at);
        let value = text.get(at..end).filter(|digits| !digits.is_empty()).and_then(|digits| digits.parse().ok());
        let Some(value) = value.filter(|_| stands_alone(bytes, at, end)) else {
            // The rest of a word or of a number that is none.
            at = end.max(at + 1);
            while at < bytes.len() && !text.is_char_boundary(at) {
                at += 1;
            }
            continue;
        };
        if from < at {
            pieces.push(Piece::Text(&text[from..at]));
        }
        pieces.push(Piece::Number(value));
        (from, at) = (end, end);
    }
    if from < text.len() {
        pieces.push(Piece::Text(&text[from..]));
    }
    pieces
}

/// Where the digits end that begin at `at`: `12`, `0.5`, `1.5e-7`; the two dots of a range are no point.
fn number_at(bytes: &[u8], at: usize) -> usize {
    let digits = |from: usize| from + bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut end = digits(at);
    if end == at {
        return at;
    }
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1).is_some_and(u8::is_ascii_digit) {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = (end + 1 + sign).min(bytes.len());
        if digits(exponent) > exponent {
            end = digits(exponent);
        }
    }
    end
}

/// Whether the bytes from `at` to `end` are a number by themselves, and no part of a word or of a power.
fn stands_alone(bytes: &[u8], at: usize, end: usize) -> bool {
    let word = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    let before = at.checked_sub(1).map(|place| bytes[place]);
    let power = before == Some(b'^') || before == Some(b'-') && at >= 2 && bytes[at - 2] == b'^';
    !power && !before.as_ref().is_some_and(word) && !bytes.get(end).is_some_and(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_words(before: &str, after: &str) -> String {
        let (before, after, ratio) = formatted(before, after);
        format!("{before} -> {after}{ratio}")
    }

    #[test]
    fn one_number_that_differs_is_reported_in_percent() {
        assert_eq!(in_words("10", "12"), "10 -> 12 (+20 %)");
        assert_eq!(in_words("com.height < 0.8 m", "com.height < 0.75 m"), "com.height < 0.8 m -> com.height < 0.75 m (-6.25 %)");
        assert_eq!(in_words("exp(−10 s/m · v)", "exp(−12 s/m · v)"), "exp(−10 s/m · v) -> exp(−12 s/m · v) (+20 %)");
        assert_eq!(in_words("5..20", "5..30"), "5..20 -> 5..30 (+50 %)");
    }

    #[test]
    fn there_is_no_percentage_of_nothing_of_another_sign_or_of_several() {
        assert_eq!(in_words("0 m", "1 m"), "0 m -> 1 m");
        assert_eq!(in_words("-3.0", "2.0"), "-3 -> 2");
        assert_eq!(in_words("1..2", "2..3"), "1..2 -> 2..3");
        assert_eq!(in_words("1 m", "1 m + 2 m"), "1 m -> 1 m + 2 m");
    }

    #[test]
    fn no_number_has_more_digits_than_tell_it_apart() {
        assert_eq!(in_words("0.6981317007977318", "0.7853981633974483"), "0.6981 -> 0.7854 (+12.5 %)");
        assert_eq!(in_words("0.3000001", "0.3000002"), "0.3000001 -> 0.3000002 (+3.333e-5 %)");
        assert_eq!(one("[-3.0, 0.1250000001, 0.5] m, 100000 steps"), "[-3, 0.125, 0.5] m, 100000 steps");
    }

    #[test]
    fn angles_are_shown_in_degrees() {
        assert_eq!(degrees("heading 0.6981317007977318 rad, pitch 0.0 rad"), "heading 40 deg, pitch 0 deg");
        assert_eq!(degrees("[0.0, 3.141592653589793] rad/s"), "[0, 180] deg/s");
        assert_eq!(degrees("uniform -0.1 rad..0.1 rad"), "uniform -5.729577951 deg..5.729577951 deg");
        assert_eq!(degrees("[1.5, 2.0] m, 3.0 m/s, 2.0 rad^2, 4.0 radius"), "[1.5, 2] m, 3 m/s, 2 rad^2, 4 radius");
    }

    #[test]
    fn digits_of_words_and_powers_are_no_numbers() {
        for text in ["hinge_2", "9dda45ef", "m^-2", "x^2", "é1é", "1..", "3e", "", "ball2.q"] {
            let numbers = pieces(text).into_iter().filter(|piece| matches!(piece, Piece::Number(_))).count();
            assert_eq!(numbers, usize::from(matches!(text, "1.." | "é1é")), "{text}: {:?}", pieces(text));
            assert_eq!(one(text), text);
        }
    }
}
