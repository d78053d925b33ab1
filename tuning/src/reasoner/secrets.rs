//! Secrets: they are sent, and never shown.

use msk_text::printable;
use serde_json::Value;
use std::fmt;

/// Longest text of an answer that a log or a message repeats, characters.
const LONGEST: usize = 2000;
/// A value of the environment with fewer characters is a number or a switch rather than a secret.
const SHORTEST_VALUE: usize = 8;

/// A secret, with what is shown in its place.
#[derive(Clone)]
pub struct Secret {
    value: String,
    shown: String,
}

impl fmt::Debug for Secret {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.shown)
    }
}

impl Secret {
    /// A key, shown as `(key)`. Space around it is no part of it: no header would carry it.
    pub fn new(key: impl Into<String>) -> Self {
        Self { value: key.into().trim().to_owned(), shown: "(key)".into() }
    }

    /// The value of an environment variable, shown as the variable's name.
    fn variable(name: &str, value: &str) -> Self {
        Self { value: value.trim().to_owned(), shown: format!("({name})") }
    }

    /// The secret itself, for sending it.
    pub(super) fn reveal(&self) -> &str {
        &self.value
    }
}

/// The secrets of one reasoner. Every text that its answer brings in passes `shown` before it goes to a message, a log
/// or the terminal.
#[derive(Debug, Clone, Default)]
pub struct Secrets(Vec<Secret>);

impl Secrets {
    /// These secrets.
    pub fn new(secrets: impl IntoIterator<Item = Secret>) -> Self {
        let mut secrets: Vec<Secret> = secrets.into_iter().filter(|secret| !secret.value.is_empty()).collect();
        // A secret may contain another one.
        secrets.sort_by_key(|secret| std::cmp::Reverse(secret.value.len()));
        Self(secrets)
    }

    /// The values of environment variables, as far as they are long enough to be secrets.
    pub(super) fn of_variables(variables: &[(String, String)]) -> Self {
        let long = variables.iter().filter(|(_, value)| value.trim().chars().count() >= SHORTEST_VALUE);
        Self::new(long.map(|(name, value)| Secret::variable(name, value)))
    }

    /// A text that may be shown: first without secrets, then without control characters, then shortened. In another order the
    /// beginning of a secret could remain at the cut.
    pub(super) fn shown(&self, text: &str) -> String {
        shortened(&printable(&self.redacted(text)))
    }

    /// [`Secrets::shown`] of a body that may be JSON, where escapes could hide a secret.
    pub(super) fn shown_body(&self, body: &str) -> String {
        match serde_json::from_str::<Value>(body) {
            Ok(value) => self.shown(&self.redacted_value(value).to_string()),
            Err(_) => self.shown(body),
        }
    }

    fn redacted(&self, text: &str) -> String {
        let mut text = text.to_owned();
        for secret in &self.0 {
            for spelling in spellings(&secret.value) {
                text = text.replace(&spelling, &secret.shown);
            }
        }
        text
    }

    fn redacted_value(&self, value: Value) -> Value {
        match value {
            Value::String(text) => Value::String(self.redacted(&text)),
            Value::Array(items) => items.into_iter().map(|item| self.redacted_value(item)).collect(),
            Value::Object(fields) => {
                fields.into_iter().map(|(name, field)| (self.redacted(&name), self.redacted_value(field))).collect()
            }
            other => other,
        }
    }
}

/// A secret as it stands in text and in JSON, where some writers escape `/`, too.
fn spellings(secret: &str) -> Vec<String> {
    let quoted = Value::from(secret).to_string();
    let escaped = quoted[1..quoted.len() - 1].to_owned();
    let mut spellings = vec![escaped.replace('/', "\\/"), escaped, secret.to_owned()];
    spellings.dedup();
    spellings
}

/// The first characters of a text.
fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((cut, _)) => format!("{} ...", &text[..cut]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_secret_at_the_cut_is_redacted_whole() {
        let secrets = Secrets::new([Secret::new("sk-very-secret")]);
        for before in LONGEST - 16..LONGEST + 2 {
            let shown = secrets.shown(&format!("{}sk-very-secret", "x".repeat(before)));
            assert!(!shown.contains("sk-"), "{shown}");
        }
    }

    #[test]
    fn escapes_of_json_hide_no_secret() {
        let secrets = Secrets::new([Secret::new("sk/a\"b")]);
        assert_eq!(secrets.shown("sk/a\"b"), "(key)");
        assert_eq!(secrets.shown(r#"half of {"key": "sk\/a\"b"#), "half of {\"key\": \"(key)");
        assert_eq!(secrets.shown_body(r#"{"\u0073k\/a\"b": ["s\u006b/a\"b"]}"#), r#"{"(key)":["(key)"]}"#);
    }

    #[test]
    fn terminals_are_not_steered() {
        assert_eq!(Secrets::default().shown("a\u{1b}[2Jb\u{9b}\r\n"), "a\\u001b[2Jb\\u009b\\r\n");
    }

    #[test]
    fn switches_of_the_environment_are_no_secrets() {
        let variables = [("DEVICE".to_owned(), "0".to_owned()), ("TOKEN".to_owned(), "abcdefgh\n".to_owned())];
        assert_eq!(Secrets::of_variables(&variables).shown("0 abcdefgh"), "0 (TOKEN)");
        assert_eq!(format!("{:?}", Secrets::of_variables(&variables)), "Secrets([(TOKEN)])");
    }

    proptest! {
        #[test]
        fn no_text_shows_a_secret(before in ".{0,30}", after in ".{0,2100}", secret in "[!-~]{8,40}") {
            let secrets = Secrets::new([Secret::new(secret.clone())]);
            // What is shown instead may itself spell a secret such as `(key)(ke`; no key looks like that.
            prop_assume!(!secret.contains("(key)"));
            let shown = secrets.shown(&format!("{before}{secret}{after}"));
            prop_assert!(!shown.contains(&secret));
            let body = serde_json::json!({ (format!("{before}{secret}")): [format!("{secret}{after}")] });
            prop_assert!(!secrets.shown_body(&body.to_string()).contains(&secret));
        }
    }
}
