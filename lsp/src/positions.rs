//! Places in texts as editors count them: lines from 0, and units of an encoding within the line.

use lsp_types::{ClientCapabilities, Position, PositionEncodingKind, Range};
use msk_compiler::diagnostics::Span;

/// How characters within a line are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Bytes.
    Utf8,
    /// Units of UTF-16: what every client understands.
    Utf16,
}

impl Encoding {
    /// The first of the client's wishes that is known here.
    pub fn negotiated(client: &ClientCapabilities) -> Self {
        let wishes = client.general.as_ref().and_then(|general| general.position_encodings.as_deref()).unwrap_or(&[]);
        let known = wishes.iter().find_map(|wish| match wish.as_str() {
            "utf-8" => Some(Self::Utf8),
            "utf-16" => Some(Self::Utf16),
            _ => None,
        });
        known.unwrap_or(Self::Utf16)
    }

    /// As the protocol calls it.
    pub fn kind(self) -> PositionEncodingKind {
        match self {
            Self::Utf8 => PositionEncodingKind::UTF8,
            Self::Utf16 => PositionEncodingKind::UTF16,
        }
    }

    fn units(self, character: char) -> usize {
        match self {
            Self::Utf8 => character.len_utf8(),
            Self::Utf16 => character.len_utf16(),
        }
    }
}

/// The lines of one text.
#[derive(Debug)]
pub struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
    encoding: Encoding,
}

impl<'a> Lines<'a> {
    /// Finds the lines of a text.
    pub fn new(text: &'a str, encoding: Encoding) -> Self {
        let newlines = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let starts = std::iter::once(0).chain(newlines.map(|(index, _)| index + 1)).collect();
        Self { text, starts, encoding }
    }

    /// The byte at a position. A position behind the end of its line is the end of the line, one behind the last line the
    /// end of the text, one within a character its beginning.
    pub fn byte(&self, position: Position) -> usize {
        let line = position.line as usize;
        let Some(&start) = self.starts.get(line) else { return self.text.len() };
        let end = self.starts.get(line + 1).map_or(self.text.len(), |next| next - 1);
        let line = self.text[start..end].strip_suffix('\r').unwrap_or(&self.text[start..end]);
        let mut left = position.character as usize;
        for (offset, character) in line.char_indices() {
            let units = self.encoding.units(character);
            if left < units {
                return start + offset;
            }
            left -= units;
        }
        start + line.len()
    }

    /// The position of a byte; of one within a character, that of the character.
    pub fn position(&self, byte: usize) -> Position {
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        let line = self.starts.partition_point(|start| *start <= byte).saturating_sub(1);
        let units = self.text[self.starts[line]..byte].chars().map(|character| self.encoding.units(character)).sum();
        let number = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
        Position::new(number(line), number(units))
    }

    /// The range of a span.
    pub fn range(&self, span: Span) -> Range {
        Range::new(self.position(span.start as usize), self.position(span.end as usize))
    }

    /// The span of a range; one whose ends are swapped is put right.
    pub fn span(&self, range: Range) -> Span {
        let (start, end) = (self.byte(range.start), self.byte(range.end));
        Span::new(start.min(end), start.max(end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_are_counted_in_the_units_agreed_on() {
        let text = "a\u{e9}\u{1d11e}b\r\n// \u{2212}x\n";
        for (encoding, units) in [(Encoding::Utf16, [0, 1, 2, 4, 5]), (Encoding::Utf8, [0, 1, 3, 7, 8])] {
            let lines = Lines::new(text, encoding);
            for (byte, unit) in [0, 1, 3, 7, 8].into_iter().zip(units) {
                assert_eq!(lines.position(byte), Position::new(0, unit));
                assert_eq!(lines.byte(Position::new(0, unit)), byte);
            }
        }
    }

    #[test]
    fn positions_that_do_not_exist_are_brought_into_the_text() {
        let text = "ab\r\nc\u{1d11e}";
        let lines = Lines::new(text, Encoding::Utf16);
        assert_eq!(lines.byte(Position::new(0, 99)), 2);
        assert_eq!(lines.byte(Position::new(1, 2)), 5);
        assert_eq!(lines.byte(Position::new(7, 0)), text.len());
        assert_eq!(lines.byte(Position::new(u32::MAX, u32::MAX)), text.len());
        assert_eq!(lines.position(6), Position::new(1, 1));
        assert_eq!(lines.position(1000), Position::new(1, 3));
    }
}
