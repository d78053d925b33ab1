//! What is being written, from the text before the cursor alone: the text around it is seldom whole.

use super::words::{self, Table};
use msk_compiler::resolve::index::Space;
use std::ops::Range;

/// Where the cursor stands.
#[derive(Debug, PartialEq)]
pub struct Place {
    /// The word that is begun, with what of it stands behind the cursor; it is replaced.
    pub word: Range<usize>,
    /// What may stand there.
    pub wanted: Wanted,
}

/// What may stand somewhere.
#[derive(Debug, PartialEq)]
pub enum Wanted {
    /// What follows a dot.
    Member,
    /// A unit.
    Unit,
    /// One of some words.
    Words(Table),
    /// An element of a scene.
    Elements,
    /// A field of this kind of element.
    Fields(String),
    /// An action space, behind `act`.
    ActionSpaces,
    /// A setting of this action space.
    Settings(String),
    /// A joint, in a pose.
    Joints,
    /// A pose.
    Poses,
    /// The name of a lint.
    Lints,
    /// A declared name.
    Declared(Space),
    /// Axes, behind `in`.
    Frames,
    /// Whatever a formula may begin with.
    Formula,
}

/// What is being written at a byte; nothing within quotes or behind a number without a blank.
pub fn place(text: &str, byte: usize) -> Option<Place> {
    let (before, after) = (text.get(..byte)?, text.get(byte..)?);
    let in_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let start = before.rfind(|c| !in_word(c)).map_or(0, |at| at + before[at..].chars().next().map_or(1, char::len_utf8));
    let end = byte + after.find(|c| !in_word(c)).unwrap_or(after.len());
    let head = &before[..start];
    let (blocks, statement) = around(head)?;
    let wanted = wanted(head, &before[start..], &blocks, statement)?;
    Some(Place { word: start..end, wanted })
}

/// The words before the open braces, outermost first, and what stands before the word in its statement; none within quotes.
fn around(head: &str) -> Option<(Vec<String>, &str)> {
    let mut blocks: Vec<String> = Vec::new();
    let (mut statement, mut quoted, mut open) = (0, false, 0_usize);
    let mut characters = head.char_indices().peekable();
    while let Some((at, character)) = characters.next() {
        match character {
            '\n' => {
                quoted = false;
                if open == 0 {
                    statement = at + 1;
                }
            }
            '"' => quoted = !quoted,
            _ if quoted => {}
            '/' if head[at..].starts_with("//") => while characters.next_if(|(_, c)| *c != '\n').is_some() {},
            '(' | '[' => open += 1,
            ')' | ']' => open = open.saturating_sub(1),
            // Braces glued to an underscore belong to a name.
            '{' if head[..at].ends_with('_') => while characters.next_if(|(_, c)| !matches!(c, '}' | '\n')).is_some() {},
            '}' if head[..at].rfind(['{', '\n']).is_some_and(|brace| head[..=brace].ends_with("_{")) => {}
            '{' => {
                blocks.push(head[statement..at].trim().to_owned());
                (statement, open) = (at + 1, 0);
            }
            '}' => {
                blocks.pop();
                (statement, open) = (at + 1, 0);
            }
            ';' => statement = at + 1,
            ',' if open == 0 => statement = at + 1,
            _ => {}
        }
    }
    (!quoted).then(|| (blocks, &head[statement..]))
}

fn wanted(head: &str, begun: &str, blocks: &[String], statement: &str) -> Option<Wanted> {
    if head.ends_with('.') && !head.ends_with("..") {
        // A digit before the dot is a number that is being written.
        let number = head[..head.len() - 1].ends_with(|c: char| c.is_ascii_digit()) && numeric_tail(&head[..head.len() - 1]);
        return (!number).then_some(Wanted::Member);
    }
    if begun.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if behind_number(statement) {
        return Some(Wanted::Unit);
    }
    let words: Vec<&str> = statement.split_whitespace().collect();
    if let (Some(last), true) = (words.last(), statement.ends_with(char::is_whitespace)) {
        match *last {
            "pose" => return Some(Wanted::Poses),
            "extends" | "phase" => return Some(Wanted::Declared(Space::Task)),
            "allow" => return Some(Wanted::Lints),
            "act" => return Some(Wanted::ActionSpaces),
            "by" => return Some(Wanted::Declared(Space::Reason)),
            "in" if !statement.contains(" for ") && !statement.trim_start().starts_with("repeat") => return Some(Wanted::Frames),
            _ => {}
        }
    }
    if !statement.trim().is_empty() {
        return Some(Wanted::Formula);
    }
    Some(first_word(blocks))
}

/// What a statement may begin with, in these blocks.
fn first_word(blocks: &[String]) -> Wanted {
    let first = |block: &String| block.split_whitespace().next().unwrap_or_default().to_owned();
    let words: Vec<String> = blocks.iter().map(first).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.as_slice() {
        [] => Wanted::Words(words::FILE),
        ["body"] => Wanted::Words(words::BODY),
        ["suite"] => Wanted::Words(words::SUITE),
        ["suite", "family"] => Wanted::Declared(Space::Task),
        ["suite", "protocol"] => Wanted::Words(words::PROTOCOL),
        ["suite", "protocol", "sweep"] => Wanted::Words(words::SWEEP),
        ["body", "pose"] => Wanted::Joints,
        ["task" | "sequence"] => Wanted::Words(words::TASK),
        [_, "scene"] | [_, "scene", "repeat"] => Wanted::Elements,
        [_, "scene", .., kind] => Wanted::Fields((*kind).to_owned()),
        [_, "init"] => Wanted::Words(words::INIT),
        [_, "init", "root"] => Wanted::Words(words::ROOT),
        [_, .., "pose"] | [_, "test" | "cheat", "at"] => Wanted::Joints,
        [_, "init", _] => Wanted::Words(words::START),
        [_, "disturb"] => Wanted::Words(words::DISTURB),
        [_, "act"] => {
            Wanted::Settings(blocks.last().and_then(|head| head.split_whitespace().nth(1)).unwrap_or_default().to_owned())
        }
        [_, "test" | "cheat"] => Wanted::Words(words::TEST),
        _ => Wanted::Formula,
    }
}

/// Whether digits at the end are a number and no part of a name.
fn numeric_tail(text: &str) -> bool {
    let word = text.rsplit(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.')).next().unwrap_or_default();
    word.starts_with(|c: char| c.is_ascii_digit())
}

/// Whether what follows is the unit of a number, or goes on with one: `10 `, `10 s/`, `5 N*m*`.
fn behind_number(statement: &str) -> bool {
    let unit = |c: char| c.is_ascii_alphanumeric() || matches!(c, '*' | '/' | '^' | '(' | '%' | '-');
    let begun = statement.rsplit(|c| !unit(c)).next().unwrap_or_default();
    let before = &statement[..statement.len() - begun.len()];
    let goes_on = begun.is_empty() || begun.ends_with(['*', '/']) && begun.starts_with(|c: char| c.is_ascii_alphabetic());
    // A weight, at the beginning of its line, has no unit.
    goes_on
        && before.ends_with(' ')
        && before.trim_end() == &before[..before.len() - 1]
        && before.trim_end().ends_with(|c: char| c.is_ascii_digit())
        && numeric_tail(before.trim_end())
        && !before.trim().trim_start_matches('-').chars().all(|c| c.is_ascii_digit() || c == '.')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Option<Wanted> {
        let byte = text.find('|').unwrap();
        place(&text.replacen('|', "", 1), byte).map(|place| place.wanted)
    }

    #[test]
    fn what_is_wanted_follows_from_the_text_before() {
        assert_eq!(at("|"), Some(Wanted::Words(words::FILE)));
        assert_eq!(at("task t {\n    ho|"), Some(Wanted::Words(words::TASK)));
        assert_eq!(at("task t {\n reward {\n 10 a = |"), Some(Wanted::Formula));
        assert_eq!(at("task t {\n reward {\n 10 a = pelvis.|"), Some(Wanted::Member));
        assert_eq!(at("task t {\n let a = exp(-10 |"), Some(Wanted::Unit));
        assert_eq!(at("task t {\n let a = 10 s/|"), Some(Wanted::Unit));
        assert_eq!(at("task t {\n reward {\n 10 |"), Some(Wanted::Formula));
        assert_eq!(at("task t { scene { box seat { |"), Some(Wanted::Fields("box".into())));
        assert_eq!(at("task t { scene { |"), Some(Wanted::Elements));
        assert_eq!(at("task t { init { pose |"), Some(Wanted::Poses));
        assert_eq!(at("task t { init { pose neutral { sole_{l,r}; kn|"), Some(Wanted::Joints));
        assert_eq!(at("task t { let v = com.velocity in |"), Some(Wanted::Frames));
        assert_eq!(at("task t { success ended by |"), Some(Wanted::Declared(Space::Reason)));
        assert_eq!(at("task a extends |"), Some(Wanted::Declared(Space::Task)));
        assert_eq!(at("task t { allow |"), Some(Wanted::Lints));
        assert_eq!(at("task t { act |"), Some(Wanted::ActionSpaces));
        assert_eq!(at("task t { act cmc { joints legs, |"), Some(Wanted::Settings("cmc".into())));
    }

    #[test]
    fn nothing_is_offered_within_quotes_and_numbers() {
        assert_eq!(at("use \"lib/|"), None);
        assert_eq!(at("task t { let a = 1.|"), None);
        assert_eq!(at("task t { let a = 12|"), None);
    }
}
