//! Typed access to an element's attributes.

use super::document::{Element, invalid};
use super::error::ModelError;
use nalgebra::Vector3;

/// The largest magnitude that a number may have: products of a few such numbers stay finite.
const LARGEST: f64 = 1e30;

impl Element {
    /// The text of an attribute.
    pub fn text(&self, attribute: &str) -> Option<&str> {
        self.attributes.iter().find(|(name, _)| name == attribute).map(|(_, value)| value.as_str())
    }

    /// A mistake in this element.
    pub fn invalid(&self, message: impl Into<String>) -> ModelError {
        invalid(&self.place, message.into())
    }

    /// The text of an attribute that must be there.
    pub fn required(&self, attribute: &str) -> Result<&str, ModelError> {
        self.text(attribute).ok_or_else(|| self.invalid(format!("`{}` needs the attribute `{attribute}`", self.tag)))
    }

    /// The name, empty if there is none.
    pub fn name(&self) -> String {
        self.text("name").unwrap_or_default().to_owned()
    }

    /// One to `most` numbers.
    pub fn list(&self, attribute: &str, most: usize) -> Result<Option<Vec<f64>>, ModelError> {
        let Some(text) = self.text(attribute) else { return Ok(None) };
        let mut numbers = Vec::new();
        for word in text.split_whitespace() {
            if numbers.len() == most {
                return Err(self.invalid(format!("`{attribute}` takes at most {most} numbers")));
            }
            let number = word.parse::<f64>().ok().filter(|number| number.abs() <= LARGEST);
            numbers.push(number.ok_or_else(|| {
                self.invalid(format!("`{attribute}` expects numbers of at most 1e30, found `{}`", shortened(word, WORD)))
            })?);
        }
        if numbers.is_empty() {
            return Err(self.invalid(format!("`{attribute}` is empty; it expects numbers")));
        }
        Ok(Some(numbers))
    }

    /// Exactly `N` finite numbers.
    pub fn numbers<const N: usize>(&self, attribute: &str) -> Result<Option<[f64; N]>, ModelError> {
        let Some(list) = self.list(attribute, N)? else { return Ok(None) };
        let found = list.len();
        let numbers = <[f64; N]>::try_from(list);
        numbers.map(Some).map_err(|_| self.invalid(format!("`{attribute}` expects {N} numbers, found {found}")))
    }

    /// Up to `N` finite numbers over the given ones.
    pub fn numbers_over<const N: usize>(&self, attribute: &str, mut over: [f64; N]) -> Result<[f64; N], ModelError> {
        if let Some(list) = self.list(attribute, N)? {
            over.iter_mut().zip(list).for_each(|(slot, number)| *slot = number);
        }
        Ok(over)
    }

    /// One finite number, or the given one.
    pub fn number_or(&self, attribute: &str, otherwise: f64) -> Result<f64, ModelError> {
        Ok(self.numbers::<1>(attribute)?.map_or(otherwise, |[number]| number))
    }

    /// One finite number that is not negative, or the given one.
    pub fn size_or(&self, attribute: &str, otherwise: f64) -> Result<f64, ModelError> {
        let number = self.number_or(attribute, otherwise)?;
        if number < 0.0 {
            return Err(self.invalid(format!("`{attribute}` must not be negative, found {number}")));
        }
        Ok(number)
    }

    /// Three finite numbers, or the given vector.
    pub fn vector_or(&self, attribute: &str, otherwise: Vector3<f64>) -> Result<Vector3<f64>, ModelError> {
        Ok(self.numbers::<3>(attribute)?.map_or(otherwise, Vector3::from))
    }

    /// A whole number in a range, or the given one.
    pub fn integer_or(&self, attribute: &str, otherwise: i64, least: i64, most: i64) -> Result<i64, ModelError> {
        let Some(text) = self.text(attribute) else { return Ok(otherwise) };
        let number = text.trim().parse::<i64>().ok().filter(|number| (least..=most).contains(number));
        number.ok_or_else(|| {
            let found = shortened(text, WORD);
            self.invalid(format!("`{attribute}` expects a whole number from {least} to {most}, found `{found}`"))
        })
    }

    /// One of several words, by its position in `words`.
    pub fn keyword(&self, attribute: &str, words: &[&str]) -> Result<Option<usize>, ModelError> {
        let Some(text) = self.text(attribute) else { return Ok(None) };
        let position = words.iter().position(|word| *word == text.trim());
        position.map(Some).ok_or_else(|| {
            let found = shortened(text, WORD);
            self.invalid(format!("`{attribute}` expects one of {}, found `{found}`", words.join(", ")))
        })
    }

    /// `true` or `false`, if given.
    pub fn flag(&self, attribute: &str) -> Result<Option<bool>, ModelError> {
        Ok(self.keyword(attribute, &["false", "true"])?.map(|position| position == 1))
    }
}

/// How much of a value a message repeats.
pub(super) const WORD: usize = 40;

/// The start of a text, so that hostile values do not flood a message.
pub(super) fn shortened(word: &str, most: usize) -> String {
    let mut short: String = word.chars().take(most).collect();
    if word.chars().nth(most).is_some() {
        short.push('…');
    }
    short
}
