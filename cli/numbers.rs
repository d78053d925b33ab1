//! Numbers on the command line.

use msk::compiler::numbers::exact;
use std::num::NonZeroUsize;

/// Reads a number from `low` to `high`, both of which it may be: neither infinite nor NaN, which compare with nothing, nor of a size
/// that what is computed from it cannot have.
pub fn within(low: f64, high: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync {
    move |text| {
        let number = text.trim().parse().ok().filter(|number: &f64| *number >= low && *number <= high);
        number.ok_or_else(|| format!("`{text}` is not a number from {} to {}", exact(low), exact(high)))
    }
}

/// The threads that `--threads` asks for; without it one for each core.
pub fn threads(asked: Option<u16>) -> NonZeroUsize {
    let asked = asked.and_then(|threads| NonZeroUsize::new(threads.into()));
    asked.or_else(|| std::thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_of_the_range_are_read() {
        let part = within(0.0, 1.0);
        assert_eq!(["0", " 0.5 ", "1"].map(|text| part(text).ok()), [Some(0.0), Some(0.5), Some(1.0)]);
        for wrong in ["NaN", "inf", "-inf", "1e308", "-1e-308", "1.1", "", "half"] {
            assert_eq!(part(wrong), Err(format!("`{wrong}` is not a number from 0 to 1")));
        }
    }
}
