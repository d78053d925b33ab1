//! Files that are not quite XML but that MuJoCo's parser reads.
//!
//! Three mistakes are common in published models: attributes that follow each other without a space, two hyphens inside a
//! comment, and `<` or `&` inside an attribute's value. They are mended on the same line, so that places stay right.

/// The text with those mistakes mended; other mistakes stay.
pub(super) fn mend(text: &str) -> String {
    let mut mended = String::with_capacity(text.len() + 64);
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        mended.push_str(&rest[..start]);
        rest = &rest[start..];
        let length = if rest.starts_with("<!--") {
            comment(rest, &mut mended)
        } else if rest.starts_with("<![CDATA[") {
            verbatim(rest, "]]>", &mut mended)
        } else if rest.starts_with("<?") || rest.starts_with("<!") {
            verbatim(rest, ">", &mut mended)
        } else {
            tag(rest, &mut mended)
        };
        rest = &rest[length..];
    }
    mended.push_str(rest);
    mended
}

/// Leaves nothing of a comment but its line breaks. Gives its length.
fn comment(rest: &str, mended: &mut String) -> usize {
    let Some(end) = rest[4..].find("-->") else { return verbatim(rest, "-->", mended) };
    mended.extend(rest[4..4 + end].matches('\n'));
    end + 7
}

/// Copies what ends with `end`, or everything if nothing does. Gives its length.
fn verbatim(rest: &str, end: &str, mended: &mut String) -> usize {
    let length = rest.find(end).map_or(rest.len(), |start| start + end.len());
    mended.push_str(&rest[..length]);
    length
}

/// Copies a tag, its values escaped and its attributes apart. Gives its length.
fn tag(rest: &str, mended: &mut String) -> usize {
    let mut from = 0;
    while let Some(next) = rest[from..].find(['"', '\'', '>']) {
        let at = from + next;
        mended.push_str(&rest[from..=at]);
        let mark = rest.as_bytes()[at];
        if mark == b'>' {
            return at + 1;
        }
        from = at + 1;
        // A value that never ends is left to the parser, which reports it.
        let Some(length) = rest[from..].find(char::from(mark)) else { break };
        escape(&rest[from..from + length], mended);
        mended.push(char::from(mark));
        from += length + 1;
        if rest[from..].starts_with(|next: char| next.is_alphabetic() || next == '_') {
            mended.push(' ');
        }
    }
    mended.push_str(&rest[from..]);
    rest.len()
}

fn escape(value: &str, mended: &mut String) {
    for (at, character) in value.char_indices() {
        match character {
            '<' => mended.push_str("&lt;"),
            '&' if !is_reference(&value[at..]) => mended.push_str("&amp;"),
            other => mended.push(other),
        }
    }
}

/// Whether this begins with `&name;` or `&#number;`.
fn is_reference(text: &str) -> bool {
    let Some(end) = text.find(';') else { return false };
    end > 1 && text[1..end].chars().all(|character| character.is_alphanumeric() || character == '#')
}

#[cfg(test)]
mod tests {
    use super::mend;

    #[test]
    fn common_mistakes_are_mended_in_place() {
        let text = "<a x=\"1\"y='2'\nz=\"p<q & r &amp; &#65;\"><!-- a -- b\n -->t</a>";
        let mended = "<a x=\"1\" y='2'\nz=\"p&lt;q &amp; r &amp; &#65;\">\nt</a>";
        assert_eq!(mend(text), mended);
        assert_eq!(mend(mended), mended);
        assert_eq!(mend("<!-- a -- é --><é/>"), "<é/>");
    }

    #[test]
    fn what_cannot_be_mended_stays() {
        for text in
            ["", "<", "<a b=\"", "<!-- ", "<![CDATA[ < ", "no tag > at all", "<?xml version=\"1.0\"?><a/>", "é<é é=\"é\"é>"]
        {
            assert_eq!(mend(text), text.replace("\"é>", "\" é>"));
        }
    }
}
