//! Numbers as text: as few digits as a reader needs, or as many as bring every bit back.

/// Significant digits that a reader is shown.
const DIGITS: i32 = 4;

/// Powers of ten within which a number is a plain decimal for a reader.
const PLAIN: std::ops::Range<i32> = -4..5;

/// From this size on a number with decimals is longer than columns are.
const LONGEST: f64 = 1e9;

/// A number for people, of at most four significant digits: `0.0313`, `-12.5`, `4.5e-6`, `1.2e5`; the whole part of a number
/// below a hundred thousand is never cut.
pub fn for_people(value: f64) -> String {
    if value == 0.0 {
        // Minus nothing is nothing to a reader.
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}");
    }
    let text = format!("{value:.0$e}", DIGITS as usize - 1);
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    // Of the number once rounded: 99999.7 is 1e5.
    let power: i32 = exponent.parse().unwrap_or(0);
    if !PLAIN.contains(&power) {
        return format!("{}e{exponent}", trimmed(mantissa));
    }
    let decimals = (DIGITS - 1 - power).clamp(0, 9) as usize;
    trimmed(&format!("{value:.decimals$}")).to_owned()
}

/// A number with so many decimals, as in the column of a table; a number [for people](for_people) where that would be a row of digits.
pub fn fixed(value: f64, decimals: usize) -> String {
    // Minus nothing is nothing to a reader.
    if value.abs() < LONGEST { format!("{:.decimals$}", value + 0.0) } else { for_people(value) }
}

/// Numbers for people that differ to the eye where they differ: with as many digits as that takes.
pub fn distinguished<const COUNT: usize>(values: &[f64; COUNT]) -> [String; COUNT] {
    std::array::from_fn(|index| beside(values[index], values))
}

/// A number for people, with as many digits as tell it apart from those beside which it stands.
pub fn beside(value: f64, others: &[f64]) -> String {
    let shown = for_people(value);
    let confused = others.iter().any(|other| *other != value && for_people(*other) == shown);
    if confused { exact(value) } else { shown }
}

/// The shortest text that reads back as the same number, for machines and for sources: `12`, `-0.01`, `1e-7`.
pub fn exact(value: f64) -> String {
    let size = value.abs();
    // Beyond these sizes a plain decimal is a row of zeros.
    if size != 0.0 && !(1e-6..1e15).contains(&size) {
        return format!("{value:e}");
    }
    // Minus nothing is nothing.
    format!("{}", if value == 0.0 { 0.0 } else { value })
}

/// The same as [`exact`] without the tail of binary roundings, nine places behind the point: `0.3` for the sum of 0.1 and 0.2.
pub fn tidy(value: f64) -> String {
    // Beyond a million the tail is no longer one of roundings, and 1e300 times 1e9 would be infinite.
    exact(if value.abs() < 1e6 { (value * 1e9).round() / 1e9 } else { value })
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn people_are_shown_four_digits() {
        let values = [0.031_25, 4.5e-6, 1.2e5, 12_345.678, -12.5, 0.1 + 0.2, 1e308, -0.0, 100.0, 0.999_96, 99_999.7, 2e-4];
        let shown = values.map(for_people);
        let expected = ["0.03125", "4.5e-6", "1.2e5", "12346", "-12.5", "0.3", "1e308", "0", "100", "1", "1e5", "0.0002"];
        assert_eq!(shown, expected);
        assert_eq!([f64::INFINITY, f64::NEG_INFINITY, f64::NAN].map(for_people), ["inf", "-inf", "NaN"]);
    }

    #[test]
    fn columns_have_decimals_and_no_rows_of_digits() {
        let shown = [(38.0, 1), (-0.0, 0), (0.125, 2), (999_999_999.4, 0), (1e9, 0), (-3.5e300, 2), (f64::INFINITY, 1)];
        let expected = ["38.0", "0", "0.12", "999999999", "1e9", "-3.5e300", "inf"];
        assert_eq!(shown.map(|(value, decimals)| fixed(value, decimals)), expected);
    }

    #[test]
    fn different_values_are_distinguished() {
        assert_eq!(distinguished(&[0.5, 0.5, 1.0]), ["0.5", "0.5", "1"]);
        assert_eq!(distinguished(&[0.5, 0.500_001]), ["0.5", "0.500001"]);
    }

    #[test]
    fn exact_numbers_are_as_short_as_they_can_be() {
        let texts = [12.0, -0.01, 0.1 + 0.2, 1e-7, 2.5e20, -0.0].map(exact);
        assert_eq!(texts, ["12", "-0.01", "0.30000000000000004", "1e-7", "2.5e20", "0"]);
    }

    #[test]
    fn a_tidy_number_has_no_tail_and_is_never_long() {
        let texts = [0.1 + 0.2, 1e-7, -4.000_000_000_1, 1e308, f64::MAX, 0.0].map(tidy);
        assert_eq!(texts, ["0.3", "1e-7", "-4", "1e308", "1.7976931348623157e308", "0"]);
    }

    proptest! {
        #[test]
        fn no_number_is_long_for_people_and_none_is_lost_for_machines(value in any::<f64>()) {
            let shown = for_people(value);
            prop_assert!(shown.len() <= 11, "{}", shown);
            if value.is_finite() {
                let read: f64 = shown.parse().unwrap();
                prop_assert!((read - value).abs() <= 5.1e-4 * value.abs(), "{} for {}", shown, value);
                prop_assert_eq!(exact(value).parse::<f64>().unwrap(), value);
            }
        }
    }
}
