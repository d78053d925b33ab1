//! How fast a gait goes, as a policy names it: `gait FORWARD LEFT TURN`.

use super::PolicyError;
use msk_program::action::Along;

/// Speeds forward and to the left of where a body faces, m/s, and the speed with which it turns to the left, rad/s.
#[derive(Debug, Clone, PartialEq)]
pub struct Pace {
    walk: [f64; 3],
    name: String,
}

impl Pace {
    /// Reads `gait`, which stands, and steps where balance needs it, `gait FORWARD`, `gait FORWARD LEFT` or `gait FORWARD LEFT TURN`.
    ///
    /// # Errors
    /// A word that is no number, a number beyond [`MOST_PACE`](Along::MOST_PACE), or too many of them.
    pub fn read(text: &str) -> Result<Self, PolicyError> {
        let wrong = |reason: String| PolicyError::Gait { text: text.to_owned(), reason };
        let mut walk = [0.0; 3];
        let words: Vec<&str> = text.split_whitespace().collect();
        let numbers = words.get(1..).unwrap_or_default();
        if numbers.len() > walk.len() {
            return Err(wrong(format!("has {} numbers", numbers.len())));
        }
        for ((speed, word), most) in walk.iter_mut().zip(numbers).zip(Along::MOST_PACE) {
            *speed = word.parse().map_err(|_| wrong(format!("has `{word}` for a number")))?;
            // Not a number is not within any bounds.
            if !(-most..=most).contains(speed) {
                return Err(wrong(format!("has {word}, which is not within -{most} and {most}")));
            }
        }
        Ok(Self { walk, name: words.join(" ") })
    }

    /// The name of the policy that walks like that.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its shares of [`MOST_PACE`](Along::MOST_PACE), in [-1, 1].
    pub(super) fn entries(&self) -> [f64; 3] {
        let [forward, left, turn] = self.walk;
        let [most_forward, most_left, most_turn] = Along::MOST_PACE;
        [forward / most_forward, left / most_left, turn / most_turn]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_is_read_from_its_name() {
        let read = |text: &str| Pace::read(text).map(|pace| (pace.entries(), pace.name().to_owned()));
        assert_eq!(read("gait"), Ok(([0.0; 3], "gait".to_owned())));
        assert_eq!(read("gait  0.5"), Ok(([0.25, 0.0, 0.0], "gait 0.5".to_owned())));
        assert_eq!(read("gait -0.5 0.25 1"), Ok(([-0.25, 0.25, 0.5], "gait -0.5 0.25 1".to_owned())));
    }

    #[test]
    fn what_is_no_pace_is_refused_with_its_reason() {
        let reason = |text: &str| Pace::read(text).unwrap_err().to_string();
        for (text, part) in [
            ("gait fast", "has `fast` for a number"),
            ("gait 3", "has 3, which is not within -2 and 2"),
            ("gait NaN", "has NaN, which is not within"),
            ("gait 0 0 0 1", "has 4 numbers"),
        ] {
            assert!(reason(text).contains(part), "{}", reason(text));
        }
    }
}
