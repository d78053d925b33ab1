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

/// The lines of one text. They end with `\n`, `\r\n` or `\r`, as the protocol has it; the compiler counts `\n` alone.
#[derive(Debug)]
pub struct Lines<'a> {
    text: &'a str,
    /// First byte of each line, and the byte after its last character.
    lines: Vec<(usize, usize)>,
    encoding: Encoding,
}

impl<'a> Lines<'a> {
    /// Finds the lines of a text.
    pub fn new(text: &'a str, encoding: Encoding) -> Self {
        let bytes = text.as_bytes();
        let mut lines = Vec::new();
        let mut start = 0;
        for (index, byte) in bytes.iter().enumerate() {
            let end = match byte {
                // The line has ended with the `\r` before.
                b'\n' if index > 0 && bytes[index - 1] == b'\r' => {
                    start = index + 1;
                    continue;
                }
                b'\n' | b'\r' => index,
                _ => continue,
            };
            lines.push((start, end));
            start = index + 1;
        }
        lines.push((start, text.len()));
        Self { text, lines, encoding }
    }

    /// The byte at a position. A position behind the end of its line is the end of the line, one behind the last line the
    /// end of the text, one within a character its beginning.
    pub fn byte(&self, position: Position) -> usize {
        let Some(&(start, end)) = self.lines.get(position.line as usize) else { return self.text.len() };
        let line = &self.text[start..end];
        let mut left = position.character as usize;
        for (offset, character) in line.char_indices() {
            let units = self.encoding.units(character);
            if left < units {
                return start + offset;
            }
            left -= units;
        }
        end
    }

    /// The position of a byte; of one within a character, that of the character, of one within a line end, that of the line end.
    pub fn position(&self, byte: usize) -> Position {
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        let line = self.lines.partition_point(|(start, _)| *start <= byte).saturating_sub(1);
        let (start, end) = self.lines[line];
        let units = self.text[start..byte.min(end)].chars().map(|character| self.encoding.units(character)).sum();
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

    #[test]
    fn lines_end_with_each_of_the_three_line_ends() {
        let text = "a\rb\r\rc\r\nd\n\re";
        let lines = Lines::new(text, Encoding::Utf16);
        let starts = [(0, 0), (1, 2), (2, 4), (3, 5), (4, 8), (5, 10), (6, 11)];
        for (line, byte) in starts {
            assert_eq!(lines.position(byte), Position::new(line, 0), "line {line}");
            assert_eq!(lines.byte(Position::new(line, 0)), byte, "line {line}");
        }
        // Behind the last character and within `\r\n` the line goes no further.
        assert_eq!(lines.byte(Position::new(3, 9)), 6);
        assert_eq!((lines.position(6), lines.position(7)), (Position::new(3, 1), Position::new(3, 1)));
        assert_eq!(lines.byte(Position::new(7, 0)), text.len());
    }

    /// Lines as the protocol defines them, character by character; columns in units of UTF-16 or in bytes.
    fn counted(text: &str, encoding: Encoding) -> Vec<(usize, Position)> {
        let mut places = Vec::new();
        let (mut line, mut column) = (0, 0);
        let mut characters = text.char_indices().peekable();
        while let Some((byte, character)) = characters.next() {
            places.push((byte, Position::new(line, column)));
            let ends = character == '\n' || character == '\r' && characters.peek().is_none_or(|(_, next)| *next != '\n');
            let units = match encoding {
                Encoding::Utf8 => character.len_utf8(),
                Encoding::Utf16 => character.len_utf16(),
            };
            (line, column) = match (ends, character) {
                (true, _) => (line + 1, 0),
                (false, '\r') => (line, column),
                (false, _) => (line, column + units as u32),
            };
        }
        places.push((text.len(), Position::new(line, column)));
        places
    }

    proptest::proptest! {
        #[test]
        fn positions_and_bytes_lead_to_each_other(text in "[ab\u{e9}\u{2212}\u{1d11e}\r\n]{0,40}", bytes in proptest::bool::ANY) {
            let encoding = if bytes { Encoding::Utf8 } else { Encoding::Utf16 };
            let lines = Lines::new(&text, encoding);
            for (byte, position) in counted(&text, encoding) {
                proptest::prop_assert_eq!(lines.position(byte), position);
                // Between `\r` and `\n` stands nothing that a position could name.
                let within = byte > 0 && text.as_bytes()[byte - 1] == b'\r' && text.as_bytes().get(byte) == Some(&b'\n');
                proptest::prop_assert_eq!(lines.byte(position), byte - usize::from(within));
            }
        }
    }
}
