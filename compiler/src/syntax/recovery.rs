//! What is wrong with a statement that fits no rule.
//!
//! The statement is parsed again under the strict rule of its block. Where that stops, and what could have stood there, is
//! the error of pest; the mistakes that people make most are recognised first.

use super::grammar::{Grammar, Rule};
use super::scanner::Masked;
use super::{units, wording};
use crate::diagnostics::{Diagnostic, FileId, Span};
use pest::Parser;
use pest::error::{Error, ErrorVariant, InputLocation};

/// Where pest stopped.
pub(super) fn position(error: &Error<Rule>) -> usize {
    match error.location {
        InputLocation::Pos(position) | InputLocation::Span((position, _)) => position,
    }
}

/// Explains a piece of junk at byte `start` of the mask, in a block whose statements are read by `context`.
pub(super) fn explain(file: FileId, masked: &Masked, start: usize, junk: &str, context: Rule) -> Diagnostic {
    let statement = junk.trim_end();
    let whole = masked.span(start, start + statement.len());
    let Err(error) = Grammar::parse(context, statement) else {
        return wording::unexpected(file, whole, &[], statement);
    };
    let stop = Stop::new(&error, statement);
    let place = |from: usize, to: usize| masked.span(start + from, start + to);
    let here = place(stop.at, stop.at + stop.found.len());
    let failure = Failure { file, statement, context, stop, here };
    failure.at_the_first_word().or_else(|| failure.common_mistake(&place)).unwrap_or_else(|| failure.plain())
}

/// Where and why the strict rule stopped.
struct Stop {
    /// Byte of the statement.
    at: usize,
    /// The token there; empty at the end.
    found: String,
    /// The token before.
    before: String,
    /// Byte of the statement where that begins.
    before_at: usize,
    /// What could have stood there, in words.
    expected: Vec<String>,
    /// The rules behind it.
    rules: Vec<Rule>,
}

impl Stop {
    fn new(error: &Error<Rule>, statement: &str) -> Self {
        let at = position(error).min(statement.len());
        let rest = &statement[at..];
        let at = at + (rest.len() - rest.trim_start().len());
        let found = statement[at..].split_at(token_length(&statement[at..])).0.to_owned();
        let before_text = statement[..at].trim_end();
        let before_at = last_token_start(before_text);
        let at = if found.is_empty() { before_text.len() } else { at };
        let rules = match &error.variant {
            ErrorVariant::ParsingError { positives, .. } => positives.clone(),
            ErrorVariant::CustomError { .. } => Vec::new(),
        };
        let mut expected = in_words(&rules);
        let touching = |word: &String| matches!(word.as_str(), "`(`" | "`[`");
        if is_word(&before_text[before_at..]) && !expected.iter().all(touching) {
            // A bracket could only have touched the word before.
            expected.retain(|word| !touching(word));
        }
        Self { at, found, before: before_text[before_at..].to_owned(), before_at, expected, rules }
    }

    fn expects(&self, rule: Rule) -> bool {
        self.rules.contains(&rule)
    }

    fn expects_name(&self) -> bool {
        self.expects(Rule::identifier) || self.expects(Rule::name)
    }

    fn expects_value(&self) -> bool {
        [Rule::expression, Rule::chain, Rule::postfixed, Rule::order].into_iter().any(|rule| self.expects(rule))
    }

    fn expects_name_or_value(&self) -> bool {
        self.expects_name() || self.expects_value()
    }

    /// Whether a whole value stands before, so that an operator could follow.
    fn after_operand(&self) -> bool {
        after_operand(&self.rules)
    }

    fn after_number(&self) -> bool {
        self.before.starts_with(|first: char| first.is_ascii_digit())
    }
}

/// What to write for a loop without its brackets.
const COMPREHENSION: &str = "a list comprehension is in square brackets, `[f(i) for i in 0..5]`; properties of a list of names map over it: `mean((knee_angle_{l,r}.q - 40 deg)^2)`";

/// A statement that fits no rule, with all that is known of it.
struct Failure<'a> {
    file: FileId,
    statement: &'a str,
    context: Rule,
    stop: Stop,
    here: Span,
}

impl Failure<'_> {
    /// Statements that begin with no word of their block.
    fn at_the_first_word(&self) -> Option<Diagnostic> {
        let word = &self.stop.found;
        if self.stop.at == 0 && word == "-" {
            return Some(wording::leading_minus(self.file, self.here));
        }
        if self.stop.at != 0 || !is_word(word) {
            return None;
        }
        let known = statements(self.context);
        if known.is_empty() {
            return None;
        }
        let assigned = self.statement[word.len()..].trim_start().starts_with('=');
        Some(match elsewhere(self.context, word) {
            Some(place) => wording::elsewhere(self.file, self.here, word, place),
            None if assigned && known.contains(&"let") => wording::assignment(self.file, self.here, word),
            None => wording::unknown_statement(self.file, self.here, word, known),
        })
    }

    fn common_mistake(&self, place: &dyn Fn(usize, usize) -> Span) -> Option<Diagnostic> {
        let (file, here, stop) = (self.file, self.here, &self.stop);
        let (found, before) = (stop.found.as_str(), stop.before.as_str());
        if found.is_empty() {
            let block = stop.rules.iter().any(|rule| is_block(*rule)) && !stop.expects_name_or_value();
            return block.then(|| wording::missing_block(file, here));
        }
        match found {
            "=" if stop.after_operand() => return Some(wording::single_equals(file, here)),
            "=" if stop.expects_value() => return Some(wording::needless_equals(file, here)),
            "when" if stop.after_operand() => return Some(wording::bare_when(file, here)),
            "if" if stop.after_operand() => {
                return Some(self.plain().help("a conditional is written `if condition then a else b`"));
            }
            "for" if stop.after_operand() => return Some(self.plain().help(COMPREHENSION)),
            "is" if stop.after_operand() => return Some(wording::is_compares(file, here)),
            "not" => return Some(wording::misplaced_not(file, here)),
            "." if stop.after_number() => return Some(wording::lonely_point(file, here, &format!("{before}.0"))),
            "." if stop.expects_value() => {
                let rest = &self.statement[stop.at + 1..];
                let digits = rest.find(|character: char| !character.is_ascii_digit()).unwrap_or(rest.len());
                return Some(wording::lonely_point(file, here, &format!("0.{}", &rest[..digits])));
            }
            "(" | "[" => return self.bracket(place),
            _ => {}
        }
        if found.starts_with(|first: char| first.is_ascii_digit()) {
            if self.context == Rule::one_term && stop.before_at == 0 && stop.expects(Rule::equals) {
                return Some(self.plain().help(format!("the weight comes before the name: `{found} {before} = ...`")));
            }
            let glued = found.bytes().any(|byte| !byte.is_ascii_digit());
            return glued.then(|| wording::glued_number(file, here, found));
        }
        if is_word(found) { self.word() } else { None }
    }

    /// A bracket that does not touch what stands before it.
    fn bracket(&self, place: &dyn Fn(usize, usize) -> Span) -> Option<Diagnostic> {
        let (stop, file) = (&self.stop, self.file);
        let before = &stop.before;
        if !is_word(before) || is_reserved(before) || !stop.after_operand() {
            return None;
        }
        let end = stop.before_at + before.len();
        let first = self.statement.split_whitespace().next() == Some(before);
        let forgotten_comma = self.in_fields() && !first && stop.found == "[";
        Some(if forgotten_comma {
            wording::missing_comma(file, place(stop.before_at, end), before)
        } else {
            wording::spaced_call(file, place(end, stop.at), before)
        })
    }

    /// A word where none can stand.
    fn word(&self) -> Option<Diagnostic> {
        let (file, here, stop) = (self.file, self.here, &self.stop);
        let (found, before) = (stop.found.as_str(), stop.before.as_str());
        if stop.after_number() {
            if self.context == Rule::one_term && units::UNITS.contains(&found) && stop.before_at < 2 {
                return Some(wording::weight_with_unit(file, here, found));
            }
            if stop.after_operand() && !is_reserved(found) && !starts_clause(found) {
                return Some(wording::unknown_unit(file, here, found));
            }
        }
        if is_reserved(found) {
            return stop.expects_name().then(|| wording::reserved_word(file, here, found));
        }
        if before == "at" && self.context == Rule::one_test_statement {
            return Some(self.plain().help("write the value on both sides: `reward.pose at a < reward.pose at b`"));
        }
        if self.context == Rule::one_field && self.statement.split_whitespace().nth(1) == Some("to") {
            return Some(wording::repeat_align(file, here, self.statement));
        }
        if self.in_fields() && (stop.after_operand() || stop.expects(Rule::comma) || stop.expects(Rule::EOI)) {
            return Some(wording::missing_comma(file, here, found));
        }
        stop.after_operand().then(|| wording::missing_semicolon(file, here, found))
    }

    fn in_fields(&self) -> bool {
        matches!(self.context, Rule::one_field | Rule::one_assignment | Rule::one_change | Rule::one_task_name)
    }

    fn plain(&self) -> Diagnostic {
        let begins = match self.context {
            Rule::one_term => Some("a weight such as `10`"),
            Rule::one_channel => Some("a value"),
            Rule::one_reason | Rule::one_parameter | Rule::one_task_name => Some("a name"),
            Rule::one_field => Some("a field"),
            _ => None,
        };
        let expected = match begins.filter(|_| self.stop.at == 0) {
            Some(begins) => vec![begins.to_owned()],
            None => self.stop.expected.clone(),
        };
        wording::unexpected(self.file, self.here, &expected, &self.stop.found)
    }
}

fn is_word(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
}

fn is_word_end(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}

fn is_reserved(word: &str) -> bool {
    Grammar::parse(Rule::reserved, word).is_ok_and(|mut pairs| pairs.next().is_some_and(|pair| pair.as_str() == word))
}

/// Words that follow a whole expression in some statement.
fn starts_clause(word: &str) -> bool {
    matches!(word, "at" | "to" | "with" | "start" | "here" | "release" | "on" | "pose")
}

/// Bytes of the first token of `text`: a number or word with what is glued to it, a quoted text, or a mark.
fn token_length(text: &str) -> usize {
    let Some(first) = text.chars().next() else { return 0 };
    if is_word_end(first) {
        let end = text.find(|character| !is_word_end(character)).unwrap_or(text.len());
        let braces = text[..end].ends_with('_') && text[end..].starts_with('{');
        return if braces { text.find('}').map_or(end, |close| close + 1) } else { end };
    }
    if first == '"' {
        return text[1..].find('"').map_or(text.len(), |end| end + 2);
    }
    let long = ["..", "<=", ">=", "==", "!=", "*="].iter().any(|mark| text.starts_with(mark));
    if long { 2 } else { first.len_utf8() }
}

fn last_token_start(text: &str) -> usize {
    let Some(last) = text.chars().next_back() else { return 0 };
    if is_word_end(last) {
        text.rfind(|character| !is_word_end(character) && character != '.').map_or(0, |byte| byte + 1)
    } else {
        text.len() - last.len_utf8()
    }
}

/// If `unit` follows `NUMBER [UNIT] (*|/)` at the end of `text`, the byte where that number begins and the quantity that was
/// meant.
pub(super) fn unit_of_number_before(text: &str, unit: &str) -> Option<(usize, String)> {
    let text = text.trim_end_matches([' ', '\t']);
    let operator = text.chars().next_back().filter(|operator| matches!(operator, '*' | '/'))?;
    let operand = text.strip_suffix(operator)?.trim_end_matches([' ', '\t']);
    let start = operand.rfind([' ', '\t', '(', '[', ',', '\n', '=', '+', '-', '*', '/', '<', '>']).map_or(0, |byte| byte + 1);
    let quantity = &operand[start..];
    let is_number = |text: &str| text.parse::<f64>().is_ok() && text.starts_with(|first: char| first.is_ascii_digit());
    if is_number(quantity) {
        let meant = if operator == '*' { unit.to_owned() } else { inverse(unit)? };
        return Some((start, format!("{quantity} {meant}")));
    }
    // `10 m * s`: the last word is a unit and a number stands before it.
    let number = operand[..start].trim_end_matches([' ', '\t']);
    let number_start = number.rfind([' ', '\t', '(', '[', ',', '\n']).map_or(0, |byte| byte + 1);
    let starts_unit = quantity.split(['*', '/', '^']).next().is_some_and(|word| units::UNITS.contains(&word));
    let whole = format!("{} {quantity}{operator}{unit}", &number[number_start..]);
    (starts_unit && is_number(&number[number_start..])).then_some((number_start, whole))
}

/// `m^2` to `m^-2`; only for a single power, since `1/m*s` may mean either.
fn inverse(unit: &str) -> Option<String> {
    if unit.contains(['*', '/', '(']) {
        return None;
    }
    Some(match unit.split_once('^') {
        None => format!("{unit}^-1"),
        Some((word, exponent)) => match exponent.strip_prefix('-') {
            Some("1") => word.to_owned(),
            Some(positive) => format!("{word}^{positive}"),
            None => format!("{word}^-{exponent}"),
        },
    })
}

fn is_operator(rule: Rule) -> bool {
    matches!(rule, Rule::operator | Rule::minus | Rule::comparison | Rule::kw_and | Rule::kw_or | Rule::frame)
}

fn is_block(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::open_brace
            | Rule::task_block
            | Rule::sequence_block
            | Rule::params_block
            | Rule::channels
            | Rule::terms
            | Rule::reasons
            | Rule::scene_block
            | Rule::field_block
            | Rule::init_block
            | Rule::test_block
            | Rule::changes
            | Rule::body_block
            | Rule::suite_block
            | Rule::task_names
    )
}

fn after_operand(rules: &[Rule]) -> bool {
    rules.iter().any(|rule| matches!(rule, Rule::operator | Rule::kw_and))
}

/// What could have stood somewhere, in words, each once; the end of the statement last.
fn in_words(rules: &[Rule]) -> Vec<String> {
    const END: &str = "the end of the statement";
    let operand_before = after_operand(rules);
    let names_the_rest = |rule: Rule| {
        if operand_before {
            // What could touch the operand, or be its unit, is not worth a word beside the operators.
            !matches!(rule, Rule::open_round | Rule::open_square | Rule::text | Rule::unit)
        } else {
            // Before a value a minus is its sign.
            rule != Rule::minus
        }
    };
    let mut words: Vec<String> = Vec::new();
    for rule in rules.iter().copied().filter(|rule| names_the_rest(*rule)) {
        let operator = matches!(rule, Rule::power | Rule::kw_when | Rule::kw_in) && operand_before;
        let word = if operator { Some("an operator".to_owned()) } else { in_word(rule) };
        words.extend(word.filter(|word| !words.contains(word)));
    }
    words.sort_by_key(|word| word == END);
    words
}

fn in_word(rule: Rule) -> Option<String> {
    let word = match rule {
        _ if is_operator(rule) => "an operator",
        _ if is_block(rule) => "`{`",
        Rule::newline | Rule::semicolon | Rule::close_brace | Rule::EOI => "the end of the statement",
        Rule::identifier | Rule::name => "a name",
        Rule::word => "a field",
        Rule::text => "a string in quotes",
        Rule::number | Rule::signed_number | Rule::weight | Rule::digits => "a number",
        Rule::share => "a share of a training such as `30 %`",
        Rule::expression | Rule::chain | Rule::postfixed | Rule::if_then_else | Rule::argument | Rule::side => "a value",
        Rule::exponent => "an exponent",
        Rule::unit | Rule::unit_power | Rule::unit_word => "a unit",
        Rule::equals => "`=`",
        Rule::times_equals => "`*=`",
        Rule::colon | Rule::annotation => "`:`",
        Rule::comma => "`,`",
        Rule::dots => "`..`",
        Rule::open_round | Rule::parameters | Rule::parameter_range | Rule::weight_range | Rule::fixed => "`(`",
        Rule::close_round => "`)`",
        Rule::open_square | Rule::square_list => "`[`",
        Rule::close_square => "`]`",
        _ => {
            let name = format!("{rule:?}");
            return name.strip_prefix("kw_").map(|word| format!("`{word}`"));
        }
    };
    Some(word.to_owned())
}

/// The words with which the statements of a block begin; empty where they begin with names.
fn statements(context: Rule) -> &'static [&'static str] {
    match context {
        Rule::one_declaration => &["use", "task", "sequence", "suite", "body", "observation", "const", "fn"],
        Rule::one_task_statement | Rule::one_sequence_statement => &[
            "family",
            "body",
            "control",
            "horizon",
            "symmetric",
            "params",
            "scene",
            "init",
            "observe",
            "critic",
            "reward",
            "metrics",
            "terminate",
            "finish",
            "success",
            "let",
            "state",
            "clock",
            "random",
            "reference",
            "act",
            "disturb",
            "test",
            "cheat",
            "allow",
            "phase",
        ],
        Rule::one_body_statement => &[
            "model",
            "root",
            "excitation",
            "tendons",
            "landmark",
            "joint",
            "joints",
            "muscle",
            "muscles",
            "landmarks",
            "family",
            "pose",
        ],
        Rule::one_suite_statement => &["family", "protocol"],
        _ => &[],
    }
}

/// Where a statement belongs that is one of the language but not of this block.
fn elsewhere(context: Rule, word: &str) -> Option<&'static str> {
    match (context, word) {
        (Rule::one_declaration, "let") => Some("write `const` outside tasks; `let` belongs to a task"),
        (Rule::one_task_statement | Rule::one_sequence_statement, "const") => Some("write `let` inside a task"),
        (Rule::one_task_statement | Rule::one_sequence_statement, "fn" | "use" | "observation") => {
            Some("it belongs at the top level of a file, outside of tasks")
        }
        (Rule::one_task_statement, "phase") => Some("phases belong to a `sequence`"),
        (Rule::one_declaration, _) if statements(Rule::one_task_statement).contains(&word) => Some("it belongs inside a task"),
        _ => None,
    }
}
