//! The formatter: what it makes of texts, and what it never changes.

use msk_compiler::diagnostics::{FileId, SourceMap};
use msk_compiler::format::{FormatError, format};
use proptest::prelude::*;

const FILES: [(&str, &str); 6] = [
    ("tasks.msk", include_str!("../../tasks.msk")),
    ("stand.msk", include_str!("../../tasks/stabilization/stand.msk")),
    ("posture.msk", include_str!("../../tasks/lib/posture.msk")),
    ("human.msk", include_str!("../../bodies/human.msk")),
    ("crouch.msk", include_str!("../../examples/crouch.msk")),
    ("everything.msk", include_str!("language/everything.msk")),
];

fn formatted(text: &str) -> Result<String, FormatError> {
    let mut sources = SourceMap::default();
    let file: FileId = sources.add("any.msk", text);
    format(file, text)
}

/// What a messy text becomes.
#[test]
fn layout() {
    let messy = include_str!("format/messy.txt");
    let tidy = formatted(messy).unwrap();
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/format/tidy.txt"), &tidy).unwrap();
    }
    assert_eq!(tidy, include_str!("format/tidy.txt"));
}

#[test]
fn every_file_of_the_project_has_the_layout() {
    for (name, text) in FILES {
        let tidy = formatted(text).unwrap();
        if let Some((line, (is, should))) = text.lines().zip(tidy.lines()).enumerate().find(|(_, (is, should))| is != should) {
            panic!("{name}:{}\n  is:     {is}\n  should: {should}", line + 1);
        }
        assert_eq!(text, tidy, "{name}");
    }
}

#[test]
fn texts_with_errors_are_left_alone() {
    let Err(FormatError::Unreadable(errors)) = formatted("task t { reward { 10 a = ( } }") else { panic!() };
    assert!(!errors.is_empty());
}

#[test]
fn line_ends_are_kept() {
    assert_eq!(formatted("const a=1\r\nconst bc=2\r\n").unwrap(), "const a  = 1\r\nconst bc = 2\r\n");
    assert_eq!(formatted("").unwrap(), "");
    assert_eq!(formatted("\n\n\n").unwrap(), "");
}

/// Another layout of the same text: blanks multiplied or tabs instead, indentation lost, lines set apart.
fn shaken(text: &str, choices: &[u8]) -> String {
    let mut choices = choices.iter().cycle();
    let mut shaken = String::new();
    for line in text.lines() {
        let (code, comment) = match line.find("//") {
            Some(at) if !line[..at].contains('"') => line.split_at(at),
            _ => (line, ""),
        };
        let blanks = |choice: &u8| ["", " ", "   ", "\t"][usize::from(*choice % 4)];
        shaken.push_str(blanks(choices.next().unwrap()));
        let mut quoted = false;
        for character in code.trim_start().chars() {
            quoted ^= character == '"';
            if character == ' ' && !quoted {
                shaken.push_str([" ", "  ", "\t", "   "][usize::from(choices.next().unwrap() % 4)]);
            } else {
                shaken.push(character);
            }
        }
        shaken.push_str(comment);
        shaken.push_str(blanks(choices.next().unwrap()));
        shaken.push('\n');
        if line.is_empty() && choices.next().unwrap().is_multiple_of(2) {
            shaken.push('\n');
        }
    }
    shaken
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// The layout does not depend on the layout: in particular, it is its own fixed point.
    #[test]
    fn blanks_do_not_matter(choices in prop::collection::vec(any::<u8>(), 1..200)) {
        for (name, text) in FILES {
            let tidy = formatted(text).unwrap();
            let again = formatted(&shaken(&tidy, &choices)).unwrap();
            prop_assert_eq!(&again, &tidy, "{}", name);
        }
    }
}
