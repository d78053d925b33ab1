//! Numbers on the command line.

/// A number from 0 on: neither infinite nor NaN, which compare with nothing.
///
/// # Errors
/// Any other text.
pub fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| format!("`{text}` is not a number from 0 on"))
}
