//! Messages about syntax: one function per mistake, so that the tone is one.

use super::units;
use crate::diagnostics::codes::{lints, syntax as codes};
use crate::diagnostics::{Diagnostic, Edit, FileId, Fix, Span, nearest};

/// Signs of other languages and of typography, longer ones first, and how they are written here.
pub(super) const FOREIGN_SIGNS: [(&str, &str); 23] = [
    ("&&", "and"),
    ("||", "or"),
    ("**", "^"),
    ("&", "and"),
    ("|", "or"),
    ("!", "not"),
    ("−", "-"),
    ("–", "-"),
    ("—", "-"),
    ("×", "*"),
    ("·", "*"),
    ("⋅", "*"),
    ("÷", "/"),
    ("≤", "<="),
    ("≥", ">="),
    ("≠", "!="),
    ("²", "^2"),
    ("³", "^3"),
    ("π", "pi"),
    ("…", ".."),
    ("\u{a0}", " "),
    ("\u{2009}", " "),
    ("\u{200b}", ""),
];

pub(super) fn foreign_comment(file: FileId, span: Span, mark: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(codes::FOREIGN_SIGN, file, span, format!("comments begin with `//`, not `{mark}`"));
    if mark.len() == 1 { diagnostic.fix("write `//`", span, "//") } else { diagnostic }
}

pub(super) fn foreign_sign(file: FileId, span: Span, foreign: &str, ours: &str) -> Diagnostic {
    let word = ours.trim();
    match (foreign, word) {
        (_, "") => Diagnostic::new(codes::FOREIGN_SIGN, file, span, "this is a typographic or invisible space").fix(
            "use an ordinary space",
            span,
            ours,
        ),
        _ => Diagnostic::new(codes::FOREIGN_SIGN, file, span, format!("`{foreign}` is written `{word}` here")).fix(
            format!("write `{word}`"),
            span,
            ours,
        ),
    }
}

pub(super) fn foreign_quotes(file: FileId, span: Span, ours: &str) -> Diagnostic {
    Diagnostic::new(codes::FOREIGN_SIGN, file, span, "strings are quoted with `\"`").fix(format!("write `{ours}`"), span, ours)
}

/// `|x|`
pub(super) fn absolute_bars(file: FileId, span: Span, inside: &str) -> Diagnostic {
    let written = format!("abs({})", inside.trim());
    Diagnostic::new(codes::FOREIGN_SIGN, file, span, "an absolute value is written `abs(x)`").suggest(
        format!("write `{written}`"),
        span,
        written,
    )
}

pub(super) fn meaningless_character(file: FileId, span: Span, character: char) -> Diagnostic {
    if character == '?' {
        return Diagnostic::new(codes::FOREIGN_SIGN, file, span, "`?` is not an operator")
            .help("a conditional is written `if condition then a else b`");
    }
    let shown = if character.is_control() || character.is_whitespace() {
        format!("the character U+{:04X}", u32::from(character))
    } else {
        format!("`{character}`")
    };
    Diagnostic::new(codes::FOREIGN_SIGN, file, span, format!("{shown} has no meaning outside comments and quotes")).fix(
        "remove it",
        span,
        "",
    )
}

pub(super) fn unclosed_text(file: FileId, span: Span) -> Diagnostic {
    let end = Span { start: span.end, end: span.end };
    Diagnostic::new(codes::UNCLOSED_TEXT, file, span, "this string is never closed").suggest("close it here", end, "\"")
}

pub(super) fn unclosed_bracket(file: FileId, span: Span, closer: char) -> Diagnostic {
    Diagnostic::new(codes::UNCLOSED_BRACKET, file, span, "this bracket is never closed")
        .help(format!("add the missing `{closer}`"))
}

pub(super) fn unclosed_block(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::UNCLOSED_BRACKET, file, span, "this block is never closed").help("add the missing `}`")
}

pub(super) fn unopened_block(file: FileId, after: Span) -> Diagnostic {
    let end = Span { start: after.end, end: after.end };
    Diagnostic::new(codes::MISSING_BLOCK, file, end, "a `{` is missing at the end of this line").fix("add it", end, " {")
}

pub(super) fn wrong_closer(file: FileId, here: Span, opener: Span, right: &str) -> Diagnostic {
    Diagnostic::new(codes::UNOPENED_BRACKET, file, here, format!("this should be `{right}`"))
        .label(file, opener, "it closes this one")
        .fix(format!("write `{right}`"), here, right)
}

pub(super) fn unopened_closer(file: FileId, span: Span, closer: &str) -> Diagnostic {
    Diagnostic::new(codes::UNOPENED_BRACKET, file, span, format!("this `{closer}` closes nothing")).suggest("remove it", span, "")
}

pub(super) fn line_begins_with(file: FileId, before: Span, here: Span, text: &str) -> Diagnostic {
    let message = format!("a line cannot begin with `{text}`");
    let mut diagnostic =
        Diagnostic::new(codes::BEGINS_WITH_OPERATOR, file, here, message).help(format!("end the line before with `{text}`"));
    let end = Span { start: before.end, end: before.end };
    let there = if text == "," { text.to_owned() } else { format!(" {text}") };
    let edits = vec![Edit { file, span: end, replacement: there }, Edit { file, span: here, replacement: String::new() }];
    diagnostic.fixes.push(Fix { title: format!("move `{text}` to the line before"), edits, automatic: true });
    diagnostic
}

pub(super) fn too_deep(file: FileId, span: Span, most: usize) -> Diagnostic {
    Diagnostic::new(codes::TOO_DEEP, file, span, format!("more than {most} brackets are open here"))
        .help("give an inner part a name with `let`")
}

pub(super) fn too_many_operators(file: FileId, span: Span, most: usize) -> Diagnostic {
    Diagnostic::new(
        codes::TOO_MANY_OPERATORS,
        file,
        span,
        format!("this statement has more than {most} operators, calls and fields"),
    )
    .help("split it with `let`, or apply `sum(...)` to a list")
}

pub(super) fn file_too_big(file: FileId, size: usize, most: usize) -> Diagnostic {
    let message = format!("the file has {size} bytes; the limit is {most}");
    Diagnostic::new(codes::FILE_TOO_BIG, file, Span::default(), message)
}

pub(super) fn unreadable(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::UNREADABLE, file, span, "this text is nested too deeply")
}

pub(super) fn missing_expression(file: FileId) -> Diagnostic {
    Diagnostic::new(codes::UNREADABLE, file, Span::default(), "an expression is missing somewhere in this file")
}

pub(super) fn stray_docs(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(lints::STRAY_DOCS, file, span, "documentation without a declaration")
        .help("put it directly above a declaration, or write an ordinary comment with `//`")
}

pub(super) fn upper_case_name(file: FileId, span: Span, text: &str) -> Diagnostic {
    let lower = text.to_ascii_lowercase();
    Diagnostic::new(codes::NAME_SPELLING, file, span, format!("`{text}` is not written in lower case"))
        .help(format!("an element of the model is quoted: \"{text}\""))
        .suggest(format!("write `{lower}`"), span, lower)
}

pub(super) fn trailing_underscore(file: FileId, span: Span, text: &str) -> Diagnostic {
    Diagnostic::new(codes::NAME_SPELLING, file, span, format!("the name `{text}` ends in an underscore"))
        .help("only a brace pattern such as `{l,r}` follows an underscore")
}

pub(super) fn empty_brace_range(file: FileId, span: Span, text: &str) -> Diagnostic {
    Diagnostic::new(codes::BRACE_PATTERN, file, span, format!("`{text}` contains no number"))
        .help("the lower end comes first and the upper end is excluded: `{0..3}` is 0, 1, 2")
}

pub(super) fn brace_digit(file: FileId, span: Span, word: &str) -> Diagnostic {
    Diagnostic::new(codes::BRACE_PATTERN, file, span, format!("`{{{word}}}` is neither a list nor a loop variable"))
        .help("write the number without braces")
}

/// `ankle_{l,r.height`
pub(super) fn unclosed_pattern(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::BRACE_PATTERN, file, span, "this brace pattern is never closed").help("add the missing `}`")
}

/// `sole{l,r}`
pub(super) fn misplaced_pattern(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::BRACE_PATTERN, file, span, "these braces do not belong to a name")
        .help("braces directly follow an underscore: `sole_{l,r}`")
}

pub(super) fn more_errors(file: FileId, span: Span, shown: usize) -> Diagnostic {
    Diagnostic::new(codes::MORE_ERRORS, file, span, format!("only the first {shown} errors of this file are shown"))
}

pub(super) fn number_too_big(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::NUMBER_TOO_BIG, file, span, "this number is beyond 1.8e308")
}

pub(super) fn unit_exponent(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::UNIT_EXPONENT, file, span, "this exponent is too large for a unit")
}

/// `0.25m`, `30%`, `10x`
pub(super) fn glued_number(file: FileId, span: Span, text: &str) -> Diagnostic {
    let digits = text.find(|character: char| character.is_ascii_alphabetic() || matches!(character, '_' | '%'));
    let (number, word) = text.split_at(digits.unwrap_or(text.len()));
    let diagnostic = Diagnostic::new(codes::GLUED_NUMBER, file, span, format!("missing space between `{number}` and `{word}`"));
    if begins_with_unit(word) {
        diagnostic.fix(format!("write `{number} {word}`"), span, format!("{number} {word}"))
    } else {
        diagnostic.help("a name does not begin with a digit, and a factor is written with `*`").suggest(
            format!("write `{number} * {word}`"),
            span,
            format!("{number} * {word}"),
        )
    }
}

fn begins_with_unit(word: &str) -> bool {
    let end = word.find(|character: char| !character.is_ascii_alphabetic() && character != '%').unwrap_or(word.len());
    units::UNITS.contains(&&word[..end])
}

/// A unit where a value is wanted; `meant` is the quantity it belongs to, if one stands before it.
pub(super) fn bare_unit(file: FileId, span: Span, unit: &str, meant: Option<(Span, String)>) -> Diagnostic {
    match meant {
        Some((place, quantity)) => {
            Diagnostic::new(codes::BARE_UNIT, file, span, format!("the unit `{unit}` is separated from its number"))
                .help("a unit expression follows its number and contains no spaces")
                .fix(format!("write `{quantity}`"), place, quantity)
        }
        None => Diagnostic::new(codes::BARE_UNIT, file, span, format!("`{unit}` is a unit and needs a number before it"))
            .suggest(format!("write `1 {unit}`"), span, format!("1 {unit}")),
    }
}

pub(super) fn unknown_unit(file: FileId, span: Span, word: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(codes::UNKNOWN_UNIT, file, span, format!("`{word}` is not a unit"));
    let near = || nearest(word, units::UNITS.into_iter().filter(|unit| unit.len() > 2)).first().map(|near| (*near).to_owned());
    if let Some(instead) = units::instead(word) {
        return diagnostic.help(instead);
    }
    match units::meant(word).map(str::to_owned).or_else(|| units::product(word)).or_else(near) {
        Some(unit) => diagnostic.suggest(format!("write `{unit}`"), span, unit),
        None => diagnostic
            .help(format!("units are {}", units::UNITS.join(" ")))
            .help(format!("a factor is written with `*`: `* {word}`")),
    }
}

pub(super) fn chained_power(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::CHAINED_POWER, file, span, "a power of a power needs brackets")
}

pub(super) fn not_a_frame(file: FileId, span: Span, written: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(codes::NOT_A_FRAME, file, span, format!("`{written}` is not a frame"))
        .expected("a name or `heading(NAME)`");
    match written.rsplit_once('.') {
        Some((frame, part)) if !part.is_empty() => diagnostic
            .help(format!("to read a component of the result, put the expression in brackets: `(... in {frame}).{part}`")),
        _ => diagnostic,
    }
}

pub(super) fn mixed_frame(file: FileId, operator: Span, frame: Span) -> Diagnostic {
    Diagnostic::new(codes::MIXED_FRAME, file, operator, "brackets are needed: does `in` include this operator?")
        .label(file, frame, "`in` is here")
        .help("write `(a + b) in pelvis` or `a + (b in pelvis)`")
}

pub(super) fn mixed_comparison(file: FileId, first: Span, second: Span, equality: bool) -> Diagnostic {
    let message = if equality { "`==` and `!=` cannot be chained" } else { "chained comparisons must have the same direction" };
    Diagnostic::new(codes::MIXED_COMPARISON, file, second, message)
        .label(file, first, "the chain begins here")
        .help("write two comparisons with `and` between them")
}

pub(super) fn element_in_placement(file: FileId, span: Span, object: &str) -> Diagnostic {
    Diagnostic::new(codes::MISPLACED, file, span, format!("`{object}` cannot get new parts in `init`"))
        .help("parts are declared in `scene`")
}

pub(super) fn element_in_action_space(file: FileId, span: Span, word: &str) -> Diagnostic {
    Diagnostic::new(codes::MISPLACED, file, span, format!("`{word}` cannot have a block in `act`"))
        .help("settings of an action space are words with values: `act cmc { joints legs, range 0.5 rad }`")
}

pub(super) fn nameless_protocol(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::MISPLACED, file, span, "each of several protocols in a suite needs a name")
        .help("`protocol quick { episodes 5 }` and `protocol paper { episodes 50 }`; the first is the default")
}

// ------------------------------------------------------------------------------------- statements that fit no rule

pub(super) fn unknown_statement(file: FileId, span: Span, word: &str, known: &[&'static str]) -> Diagnostic {
    let diagnostic = Diagnostic::new(codes::UNKNOWN_STATEMENT, file, span, format!("no statement begins with `{word}` here"));
    match nearest(word, known.iter().copied()).first() {
        Some(near) => diagnostic.suggest(format!("write `{near}`"), span, *near),
        None => diagnostic.expected(choices(known.iter().map(|word| format!("`{word}`")))).found(format!("`{word}`")),
    }
}

/// A statement that belongs to another block.
pub(super) fn elsewhere(file: FileId, span: Span, word: &str, place: &str) -> Diagnostic {
    Diagnostic::new(codes::UNKNOWN_STATEMENT, file, span, format!("`{word}` is not allowed here")).help(place)
}

pub(super) fn reserved_word(file: FileId, span: Span, word: &str) -> Diagnostic {
    let unit = units::UNITS.contains(&word);
    let (kind, help) = match unit {
        true => ("is a unit and cannot be a name", "choose a longer name, or a letter that is not a unit, such as `i`"),
        false => ("is reserved and cannot be a name", "choose a longer name"),
    };
    Diagnostic::new(codes::RESERVED_WORD, file, span, format!("`{word}` {kind}")).help(help)
}

/// `reached = reached + 1` where a statement of a task is wanted.
pub(super) fn assignment(file: FileId, span: Span, word: &str) -> Diagnostic {
    Diagnostic::new(codes::UNKNOWN_STATEMENT, file, span, format!("a value cannot be assigned to `{word}`"))
        .help(format!("a name for a formula is made by `let {word} = ...`"))
        .help(format!("declare a value that changes over time as a state: `state {word} = 0 becomes {word} + 1 when ...`"))
}

/// `x is not y`
pub(super) fn is_compares(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::UNEXPECTED, file, span, "`is` is not a comparison").help(
        "whole numbers and conditions are compared with `==` and `!=`, measured numbers with `<` and `>`: `abs(a - b) < 1 cm`",
    )
}

pub(super) fn spaced_call(file: FileId, blank: Span, name: &str) -> Diagnostic {
    Diagnostic::new(codes::SPACED_CALL, file, blank, format!("space between `{name}` and its bracket"))
        .help("no space separates a name from the bracket of its call or index")
        .suggest("remove the space", blank, "")
}

pub(super) fn missing_comma(file: FileId, before: Span, word: &str) -> Diagnostic {
    let at = Span { start: before.start, end: before.start };
    Diagnostic::new(codes::MISSING_SEPARATOR, file, before, format!("a comma is missing before `{word}`"))
        .help("fields that share a line are separated by commas")
        .fix("add it", at, ", ")
}

pub(super) fn missing_semicolon(file: FileId, span: Span, word: &str) -> Diagnostic {
    let at = Span { start: span.start, end: span.start };
    Diagnostic::new(codes::MISSING_SEPARATOR, file, span, format!("a new statement seems to begin with `{word}`"))
        .help("a statement ends at the end of its line; separate several on one line by `;`")
        .suggest("add a semicolon", at, "; ")
}

pub(super) fn single_equals(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::SINGLE_EQUALS, file, span, "a comparison is written `==`").suggest("write `==`", span, "==")
}

pub(super) fn needless_equals(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::UNEXPECTED, file, span, "no `=` is allowed here")
        .help("`=` names a formula; settings and fields are followed directly by their value")
        .fix("remove it", span, "")
}

pub(super) fn lonely_point(file: FileId, span: Span, number: &str) -> Diagnostic {
    Diagnostic::new(codes::UNEXPECTED, file, span, "a decimal point needs digits on both sides").help(format!("write `{number}`"))
}

/// `align a to x, b to y`
pub(super) fn repeat_align(file: FileId, span: Span, statement: &str) -> Diagnostic {
    Diagnostic::new(codes::UNEXPECTED, file, span, "`align` is missing before this pair of places")
        .help(format!("write `align {statement}`"))
}

/// `so a at x`, as it was once written
pub(super) fn former_align(file: FileId, span: Span, place: &str, target: &str) -> Diagnostic {
    let present = format!("align {place} to {target}");
    Diagnostic::new(codes::UNEXPECTED, file, span, "`so ... at ...` is now written `align ... to ...`").fix(
        format!("write `{present}`"),
        span,
        present,
    )
}

pub(super) fn bare_when(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::BARE_WHEN, file, span, "what comes before this `when` needs brackets")
        .help("write `(if a then b else c) when d`, or `(x when a) when b`")
}

pub(super) fn misplaced_not(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::MISPLACED_NOT, file, span, "`not` is not allowed here")
        .help("it begins a condition or follows `and` or `or`; elsewhere write `(not ...)`")
}

pub(super) fn weight_with_unit(file: FileId, span: Span, unit: &str) -> Diagnostic {
    Diagnostic::new(codes::UNEXPECTED, file, span, "a weight is a number without unit")
        .expected("the name of the term")
        .found(format!("the unit `{unit}`"))
}

pub(super) fn missing_block(file: FileId, end: Span) -> Diagnostic {
    Diagnostic::new(codes::MISSING_BLOCK, file, end, "missing block in braces").expected("`{`")
}

/// Anything else. `found` is what is there, empty at the end of the statement.
pub(super) fn unexpected(file: FileId, span: Span, expected: &[String], found: &str) -> Diagnostic {
    let (message, found) = match found {
        "" => ("the statement is not complete".to_owned(), "the end of the statement".to_owned()),
        found => (format!("`{found}` is not allowed here"), format!("`{found}`")),
    };
    let mut diagnostic = Diagnostic::new(codes::UNEXPECTED, file, span, message);
    // What is written elsewhere for what is wanted here.
    let meant =
        [("`=`", ["==", ":", ":="], "="), ("`when`", ["if", ":", "="], "when"), ("`becomes`", ["=", "->", "then"], "becomes")];
    for (wanted, slips, word) in meant {
        if expected.iter().any(|choice| choice == wanted) && slips.contains(&found.trim_matches('`')) {
            diagnostic = diagnostic.suggest(format!("write `{word}`"), span, word);
        }
    }
    if found == "`,`" {
        diagnostic = diagnostic.help("numbers have a decimal point; lines of a list have no separator at the end");
    }
    if expected.is_empty() { diagnostic } else { diagnostic.expected(choices(expected.iter().cloned())).found(found) }
}

pub(super) fn leading_minus(file: FileId, span: Span) -> Diagnostic {
    Diagnostic::new(codes::BEGINS_WITH_OPERATOR, file, span, "a line cannot begin with `-` here")
        .help("if it continues the previous line, end that line with `-`")
}

/// `a`, `a or b`, `a, b or c`
fn choices(words: impl IntoIterator<Item = String>) -> String {
    let mut words: Vec<String> = words.into_iter().collect();
    let Some(last) = words.pop() else { return String::new() };
    if words.is_empty() { last } else { format!("{} or {last}", words.join(", ")) }
}
