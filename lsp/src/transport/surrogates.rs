//! Lone surrogates in JSON: halves of UTF-16 pairs that editors send while a character is being changed. No string of Rust can
//! hold them.

/// A JSON text in which every escape of a lone surrogate is one of U+FFFD. Each remains one unit of UTF-16, so that positions
/// within the strings stay.
pub(super) fn replace_lone(text: &str) -> String {
    let mut replaced = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find('\\') {
        let (before, escape) = rest.split_at(start);
        replaced.push_str(before);
        let (passed, instead) = match unit(escape) {
            Some(0xd800..=0xdbff) if matches!(unit(&escape[6..]), Some(0xdc00..=0xdfff)) => (12, None),
            Some(0xd800..=0xdfff) => (6, Some("\\ufffd")),
            // A backslash escapes the next character, which may be a backslash.
            _ => (1 + escape[1..].chars().next().map_or(0, char::len_utf8), None),
        };
        replaced.push_str(instead.unwrap_or(&escape[..passed]));
        rest = &escape[passed..];
    }
    replaced + rest
}

/// The unit of UTF-16 that an escape `\uXXXX` at the start of `text` stands for.
fn unit(text: &str) -> Option<u16> {
    let digits = text.strip_prefix("\\u")?.get(..4)?;
    u16::from_str_radix(digits, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn pairs_stay_and_lone_halves_do_not() {
        let cases = [
            (r#""\ud834\udd1e""#, r#""\ud834\udd1e""#),
            (r#""\ud834x""#, r#""\ufffdx""#),
            (r#""\ud834\ud834\udd1e\uDD1E""#, r#""\ufffd\ud834\udd1e\ufffd""#),
            (r#""\\ud834""#, r#""\\ud834""#),
            (r#""\\\ud834""#, r#""\\\ufffd""#),
            ("\"\\ud8", "\"\\ud8"),
            ("\\", "\\"),
            ("\\\u{1d11e}\\u12\u{e9}4", "\\\u{1d11e}\\u12\u{e9}4"),
        ];
        for (text, replaced) in cases {
            assert_eq!(replace_lone(text), replaced);
        }
    }

    proptest! {
        #[test]
        fn any_units_make_a_string_of_as_many(units in proptest::collection::vec(prop_oneof![0xd700_u16..0xe100, any::<u16>()], 0..30)) {
            let escaped: String = units.iter().map(|unit| format!("\\u{unit:04x}")).collect();
            let text: String = serde_json::from_str(&replace_lone(&format!("\"{escaped}\""))).unwrap();
            let expected = String::from_utf16_lossy(&units);
            prop_assert_eq!(text.encode_utf16().count(), units.len());
            prop_assert_eq!(text, expected);
        }
    }
}
