//! The one layout of texts.

use crate::positions::{Encoding, Lines};
use lsp_types::TextEdit;
use msk_compiler::diagnostics::{FileId, Span};
use msk_compiler::format::format;

/// The changes that lay a text out; none if it has errors. Lines that stay at its beginning and end are left alone, so that
/// the editor keeps its place.
pub fn layout(text: &str, encoding: Encoding) -> Option<Vec<TextEdit>> {
    let laid_out = format(FileId::default(), text).ok()?;
    if laid_out == text {
        return Some(Vec::new());
    }
    let same = |(a, b): &(&str, &str)| a == b;
    let (old, new): (Vec<&str>, Vec<&str>) = (text.split_inclusive('\n').collect(), laid_out.split_inclusive('\n').collect());
    let before = old.iter().copied().zip(new.iter().copied()).take_while(same).count();
    let most = old.len().min(new.len()) - before;
    let after = old.iter().rev().copied().zip(new.iter().rev().copied()).take(most).take_while(same).count();
    let bytes = |lines: &[&str]| lines.iter().map(|line| line.len()).sum::<usize>();
    let (start, end) = (bytes(&old[..before]), bytes(&old[..old.len() - after]));
    let range = Lines::new(text, encoding).range(Span::new(start, end));
    Some(vec![TextEdit { range, new_text: new[before..new.len() - after].concat() }])
}

#[cfg(test)]
mod tests {
    use super::*;
    use lsp_types::{Position, Range};

    #[test]
    fn only_lines_that_change_are_replaced() {
        let text = "const a = 1\n\nconst  b=2\n\nfn f(x) = x\n";
        let edits = layout(text, Encoding::Utf16).unwrap();
        let range = Range::new(Position::new(2, 0), Position::new(3, 0));
        assert_eq!(edits, [TextEdit { range, new_text: "const b = 2\n".into() }]);
        assert_eq!(layout("const a = 1\n", Encoding::Utf16), Some(Vec::new()));
        assert_eq!(layout("const a = (", Encoding::Utf16), None);
    }
}
