//! Characters of a text that would act on a terminal, reorder a line or hide in it, made visible.

use msk_text::is_invisible;
use std::borrow::Cow;

/// The text with a visible stand-in for every such character: the control pictures of Unicode for those of ASCII, `<U+202E>` for
/// all others. Tabs and line ends stay what they are.
pub(super) fn visible(text: &str) -> Cow<'_, str> {
    if !text.char_indices().any(|(at, character)| stand_in(text, at, character).is_some()) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for (at, character) in text.char_indices() {
        match stand_in(text, at, character) {
            Some(visible) => shown += &visible,
            None => shown.push(character),
        }
    }
    Cow::Owned(shown)
}

/// Where the character at `byte` of a text stands in the text that [`visible`] makes of it.
pub(super) fn visible_place(text: &str, byte: usize) -> usize {
    let before = text.char_indices().take_while(|(at, _)| *at < byte);
    before.map(|(at, character)| stand_in(text, at, character).map_or(character.len_utf8(), |shown| shown.len())).sum()
}

/// What stands for a character that is no mark on paper: control characters of ASCII and of Latin 1, which terminals obey, and the
/// formatting characters of Unicode that reorder text or have no width. Those that join letters are part of what people write.
fn stand_in(text: &str, at: usize, character: char) -> Option<String> {
    match character {
        '\t' | '\n' => None,
        '\r' if text[at..].starts_with("\r\n") => None,
        '\0'..='\u{1f}' => char::from_u32(0x2400 + u32::from(character)).map(String::from),
        '\u{7f}' => Some("\u{2421}".to_owned()),
        _ if is_invisible(character) || hides(character) => Some(format!("<U+{:04X}>", u32::from(character))),
        _ => None,
    }
}

/// Whether a character has no width, or is a mark that programs exchange: harmless on a terminal, and misleading in a source.
fn hides(character: char) -> bool {
    matches!(
        character,
        '\u{200b}' | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_hides_is_shown_and_all_else_stays() {
        assert!(matches!(visible("let é = 高 + 1 // 🦿\t\r\n"), Cow::Borrowed(_)));
        assert_eq!(visible("a\u{1b}[2J\u{7f}\r"), "a\u{241b}[2J\u{2421}\u{240d}");
        assert_eq!(visible("\u{9b}2J \u{202e}1\u{2066} \u{200b}\u{feff}"), "<U+009B>2J <U+202E>1<U+2066> <U+200B><U+FEFF>");
    }

    #[test]
    fn places_move_with_what_is_shown() {
        let text = "é\r\u{202e}x\r\n";
        let shown = visible(text);
        let place = |character: char| visible_place(text, text.find(character).unwrap_or_default());
        assert_eq!((place('é'), place('x')), (0, shown.find('x').unwrap_or_default()));
        assert_eq!(visible_place(text, text.len()), shown.len());
    }
}
