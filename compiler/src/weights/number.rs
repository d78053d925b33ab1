//! Numbers as the language writes them.

/// The shortest text that reads back as the same number: `12`, `-0.01`, `1e-7`.
pub fn written(value: f64) -> String {
    let size = value.abs();
    // Beyond these sizes a plain decimal is a row of zeros.
    if size != 0.0 && !(1e-6..1e15).contains(&size) {
        return format!("{value:e}");
    }
    // Minus nothing is nothing.
    format!("{}", if value == 0.0 { 0.0 } else { value })
}

#[cfg(test)]
mod tests {
    use super::written;

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        let texts = [12.0, -0.01, 0.1 + 0.2, 1e-7, 2.5e20, -0.0].map(written);
        assert_eq!(texts, ["12", "-0.01", "0.30000000000000004", "1e-7", "2.5e20", "0"]);
    }
}
