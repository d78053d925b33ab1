//! Texts of other people's files, where a person reads them.

/// Makes all characters visible that would act instead of being read, but for line ends and tabs: `\u001b` for an escape. So JSON writes
/// them too: a text in JSON is the same text afterwards.
pub fn printable(text: &str) -> String {
    escaped(text, |character| is_invisible(character) && !matches!(character, '\n' | '\t'))
}

/// The same where a text must stay within its line, as in the cell of a table: `\n` for a line end.
pub fn in_one_line(text: &str) -> String {
    escaped(text, is_invisible)
}

/// Whether a character acts instead of being read: controls (C0, DEL, C1), the separators of lines and paragraphs, and the marks that
/// change the direction of text (Unicode Standard Annex 9), with which a text shows other words than it has.
pub fn is_invisible(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn escaped(text: &str, is_hidden: impl Fn(char) -> bool) -> String {
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            _ if !is_hidden(character) => shown.push(character),
            '\n' => shown.push_str("\\n"),
            '\r' => shown.push_str("\\r"),
            '\t' => shown.push_str("\\t"),
            // All of them are in the basic plane, so that four digits are enough.
            _ => shown.push_str(&format!("\\u{:04x}", u32::from(character))),
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_acts_is_shown_and_what_is_read_stays() {
        let hostile = "pose\u{1b}[2J\r\u{9b}31m\u{202e}txt\u{2028}\u{7f} \u{e9}\u{4eba}\n\tend";
        assert_eq!(printable(hostile), "pose\\u001b[2J\\r\\u009b31m\\u202etxt\\u2028\\u007f \u{e9}\u{4eba}\n\tend");
        assert_eq!(in_one_line("a\r\n\tb | c"), r"a\r\n\tb | c");
    }

    #[test]
    fn json_stays_the_same_json() {
        // JSON has its own escapes for C0 only.
        let json = "[\"\u{9b}31m\u{202e}\u{7f}\",\n\t1]";
        assert_eq!(printable(json), "[\"\\u009b31m\\u202e\\u007f\",\n\t1]");
    }

    proptest! {
        #[test]
        fn nothing_that_acts_is_left(text in any::<String>()) {
            prop_assert!(!in_one_line(&text).contains(is_invisible));
            prop_assert!(!printable(&text).contains(|found| is_invisible(found) && !matches!(found, '\n' | '\t')));
        }
    }
}
