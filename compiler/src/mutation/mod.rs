//! Mutants of a task: changes of a single token, as a typing mistake makes them. A mutant that no check, lint or test kills shows
//! what could be wrong already.
//!
//! Mutated are the formulas that decide what a task means (values, terms with their weights, terminations, success, the horizon)
//! and, counted apart from them, its scene, its initial state and its observation. Never mutated are names, tests, and what cannot
//! matter: measured numbers are never exactly equal, so `<` does not become `<=`.

mod regions;
mod swaps;

use crate::diagnostics::{FileId, Span};
use crate::extremes::maximum;
use crate::numbers::tidy;
use crate::syntax::scanner::{self, Token, TokenKind};
use crate::syntax::tree::Item;
use crate::syntax::{self};
use regions::regions;
use swaps::{AXES, DERIVATIVES, FUNCTIONS, LOGIC, UNITS};

/// The kind of mistake that a mutant makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// `a + b` for `a - b`, a minus lost
    Sign,
    /// `<` for `>`
    Comparison,
    /// `cm` for `m`
    Unit,
    /// Left for right.
    Side,
    /// `.x` for `.y`
    Axis,
    /// A rate for the value.
    Derivative,
    /// A number doubled, halved, or a tenth more.
    Number,
    /// The weight of a term: its sign, or its size.
    Weight,
    /// `or` for `and`, a `not` lost
    Logic,
    /// `max` for `min`
    Function,
}

impl Class {
    /// All, in the order of tables.
    pub const ALL: [Self; 10] = [
        Self::Sign,
        Self::Comparison,
        Self::Unit,
        Self::Side,
        Self::Axis,
        Self::Derivative,
        Self::Number,
        Self::Weight,
        Self::Logic,
        Self::Function,
    ];

    /// As printed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sign => "sign",
            Self::Comparison => "comparison",
            Self::Unit => "unit",
            Self::Side => "side",
            Self::Axis => "axis",
            Self::Derivative => "derivative",
            Self::Number => "number",
            Self::Weight => "weight",
            Self::Logic => "logic",
            Self::Function => "function",
        }
    }
}

/// The part of a task that is mutated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// What it means: values, terms, terminations, success, horizon.
    Meaning,
    /// The scene.
    Scene,
    /// The initial state, with what is drawn at random.
    InitialState,
    /// What the policy observes.
    Observation,
    /// What the policy's action stands for.
    Action,
}

impl Part {
    /// All, in the order of tables.
    pub const ALL: [Self; 5] = [Self::Meaning, Self::Scene, Self::InitialState, Self::Observation, Self::Action];

    /// As printed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Meaning => "meaning",
            Self::Scene => "scene",
            Self::InitialState => "initial state",
            Self::Observation => "observation",
            Self::Action => "action space",
        }
    }
}

/// A text with one token changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mutant {
    /// The part of the task that it changes.
    pub part: Part,
    /// The kind of mistake.
    pub class: Class,
    /// The text that is replaced.
    pub span: Span,
    /// The text that replaces it.
    pub replacement: String,
}

impl Mutant {
    /// The mutated text.
    pub fn apply(&self, text: &str) -> String {
        format!("{}{}{}", &text[..self.span.start as usize], self.replacement, &text[self.span.end as usize..])
    }
}

/// The tasks of a text, in its order.
pub fn tasks(text: &str) -> Vec<String> {
    let names = syntax::parse(FileId::default(), text).tree.items.into_iter();
    names.filter_map(|item| if let Item::Task(task) = item { Some(task.name.text) } else { None }).collect()
}

/// All mutants of a task of a text, in the order of the text; none where there is no such task.
pub fn mutants(text: &str, task: &str) -> Vec<Mutant> {
    let file = FileId::default();
    let parsed = syntax::parse(file, text);
    let regions = regions(&parsed.tree, task);
    let (tokens, _) = scanner::tokens(file, text);
    let tokens: Vec<Token> = tokens.into_iter().filter(|token| token.kind != TokenKind::Newline).collect();
    let mut mutants = Vec::new();
    for (place, token) in tokens.iter().enumerate() {
        let within = |span: Span| span.start as usize <= token.start && token.end <= span.end as usize;
        let Some(region) = regions.iter().find(|region| within(region.span)) else { continue };
        let mut push = |class, span, replacement| mutants.push(Mutant { part: region.part, class, span, replacement });
        if !region.weight {
            formula(text, &tokens, place, &mut push);
        } else if token.kind == TokenKind::Number {
            weight(text, &tokens, place, &mut push);
        }
    }
    mutants
}

/// Takes a mutant: its class, the text that it replaces, and the replacement.
type Push<'p> = &'p mut dyn FnMut(Class, Span, String);

/// Mutants of a weight: another sign, another size.
fn weight(text: &str, tokens: &[Token], place: usize, push: Push<'_>) {
    let token = &tokens[place];
    let sign = place.checked_sub(1).map(|before| &tokens[before]).filter(|before| before.text(text) == "-");
    match sign {
        Some(sign) => push(Class::Weight, sign.span(), String::new()),
        None => push(Class::Weight, token.span(), format!("-{}", token.text(text))),
    }
    sizes(text, token, Class::Weight, push);
}

/// Mutants of a number: other sizes.
fn sizes(text: &str, token: &Token, class: Class, push: Push<'_>) {
    let written = token.text(text);
    let Ok(value) = written.parse::<f64>() else { return };
    if value == 0.0 {
        return;
    }
    let whole = !written.contains(['.', 'e', 'E']);
    // A whole number stays one; a tenth of a small one is one more.
    let slight = if whole { value + maximum((value / 10.0).round(), 1.0) } else { 1.1 * value };
    let half = if whole { (value / 2.0).floor() } else { value / 2.0 };
    let mut known: Vec<String> = Vec::new();
    for changed in [half, slight, 2.0 * value] {
        let replacement = tidy(changed);
        if changed != value && changed.is_finite() && !known.contains(&replacement) {
            known.push(replacement.clone());
            push(class, token.span(), replacement);
        }
    }
}

/// Mutants of a token in a formula.
fn formula(text: &str, tokens: &[Token], place: usize, push: Push<'_>) {
    let token = &tokens[place];
    let written = token.text(text);
    let before = place.checked_sub(1).map(|before| &tokens[before]);
    if token.kind == TokenKind::Number {
        return sizes(text, token, Class::Number, push);
    }
    let mut push = |class, replacement: &str| push(class, token.span(), replacement.to_owned());
    match token.kind {
        TokenKind::Mark => {
            let value_before = before.is_some_and(|before| {
                matches!(before.kind, TokenKind::Number | TokenKind::Close(_))
                    || before.kind == TokenKind::Word && !swaps::OPENS.contains(&before.text(text))
            });
            match written {
                "+" => push(Class::Sign, "-"),
                "-" if value_before => push(Class::Sign, "+"),
                "-" => push(Class::Sign, ""),
                "*" if value_before && !in_unit(text, tokens, place) => push(Class::Sign, "/"),
                "<" => push(Class::Comparison, ">"),
                ">" => push(Class::Comparison, "<"),
                "<=" => push(Class::Comparison, ">="),
                ">=" => push(Class::Comparison, "<="),
                "==" => push(Class::Comparison, "!="),
                "!=" => push(Class::Comparison, "=="),
                _ => {}
            }
        }
        TokenKind::Word => {
            let member = before.is_some_and(|before| before.text(text) == "." && before.end == token.start);
            let calls = tokens.get(place + 1).is_some_and(|next| next.kind == TokenKind::Open(b'(') && next.start == token.end);
            let other = |table: &[(&'static str, &'static str)]| {
                table.iter().find(|(known, _)| *known == written).map(|(_, other)| *other)
            };
            if member {
                other(AXES).into_iter().for_each(|axis| push(Class::Axis, axis));
                other(DERIVATIVES).into_iter().for_each(|rate| push(Class::Derivative, rate));
            } else if in_unit(text, tokens, place) {
                other(UNITS).into_iter().for_each(|unit| push(Class::Unit, unit));
            } else if calls {
                other(FUNCTIONS).into_iter().for_each(|function| push(Class::Function, function));
            }
            other(LOGIC).into_iter().for_each(|word| push(Class::Logic, word));
            other_side(written).into_iter().for_each(|side| push(Class::Side, &side));
        }
        _ => {}
    }
}

/// Whether a token belongs to the unit of a number: words and marks without blanks between, behind the number and a blank.
fn in_unit(text: &str, tokens: &[Token], place: usize) -> bool {
    let mut first = place;
    while first > 0 && tokens[first - 1].end == tokens[first].start && tokens[first - 1].kind != TokenKind::Number {
        first -= 1;
    }
    // `30 m^-2/s`: the exponent is a number, too, but no blank stands before or behind it, as in `-0.5 m`.
    let touches = |place: usize| tokens[place].end == tokens[place + 1].start;
    while first > 1 && tokens[first - 1].kind == TokenKind::Number && touches(first - 2) && touches(first - 1) {
        first -= 1;
        while first > 0 && tokens[first - 1].end == tokens[first].start && tokens[first - 1].kind != TokenKind::Number {
            first -= 1;
        }
    }
    let number = first.checked_sub(1).is_some_and(|before| tokens[before].kind == TokenKind::Number);
    number && tokens[first].kind == TokenKind::Word && syntax::UNITS.contains(&tokens[first].text(text))
}

/// The name of the other side; of both sides, the left one twice.
fn other_side(name: &str) -> Option<String> {
    if let Some(stem) = name.strip_suffix("_l") {
        return Some(format!("{stem}_r"));
    }
    if let Some(stem) = name.strip_suffix("_r") {
        return Some(format!("{stem}_l"));
    }
    name.contains("{l,r}").then(|| name.replace("{l,r}", "{l,l}"))
}
