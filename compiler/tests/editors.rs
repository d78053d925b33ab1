//! The editors' grammar knows the words of the language's grammar.

use std::collections::BTreeSet;

const GRAMMAR: &str = include_str!("../../grammar/msk.pest");
const TEXTMATE: &str = include_str!("../../grammar/editors/vscode/syntaxes/msk.tmLanguage.json");

/// Words in alternatives, `(a|b)`, of all patterns.
fn highlighted() -> BTreeSet<String> {
    let grammar: serde_json::Value = serde_json::from_str(TEXTMATE).unwrap();
    let words = grammar.to_string().replace("\\\\b", " ").replace("\\b", " ");
    words.split(|character: char| !character.is_ascii_alphanumeric() && character != '_').map(str::to_owned).collect()
}

/// Words of the rules `kw_...` and of the units.
fn words() -> BTreeSet<String> {
    let mut words = BTreeSet::new();
    for line in GRAMMAR.lines().filter(|line| line.starts_with("kw_")) {
        words.insert(line.split('"').nth(1).unwrap().to_owned());
    }
    let (_, units) = GRAMMAR.split_once("unit_word = @{").unwrap();
    let (units, _) = units.split_once("~ !word_character").unwrap();
    words.extend(units.split('"').skip(1).step_by(2).map(str::to_owned));
    words
}

#[test]
fn every_word_of_the_language_is_highlighted() {
    let (words, highlighted) = (words(), highlighted());
    assert!(words.len() > 90, "{words:?}");
    // Words that are names of values more often than words of a statement, and read best as such.
    let plain = ["activation", "rest", "start", "motion"];
    let missing: Vec<&String> =
        words.iter().filter(|word| !highlighted.contains(*word) && !plain.contains(&word.as_str())).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
