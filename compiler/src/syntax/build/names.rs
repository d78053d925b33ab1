//! Names, texts, numbers and units.

use super::{Builder, part, parts};
use crate::diagnostics::Span;
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{Ident, Name, NamePart, Quantity, Text, UnitExpr, UnitFactor};
use crate::syntax::wording;

impl Builder<'_> {
    pub(super) fn identifier(&mut self, pair: &Pair<'_>) -> Ident {
        let ident = Ident { text: pair.as_str().to_owned(), span: self.span(pair) };
        self.check_spelling(&ident.text, ident.span);
        ident
    }

    pub(super) fn identifier_in(&mut self, pair: &Pair<'_>) -> Ident {
        match part(pair, Rule::identifier) {
            Some(pair) => self.identifier(&pair),
            None => Ident { text: String::new(), span: self.span(pair) },
        }
    }

    /// A word of the language where a statement keeps which one it was.
    pub(super) fn keyword(&self, pair: &Pair<'_>) -> Ident {
        Ident { text: pair.as_str().trim_end().to_owned(), span: self.span(pair) }
    }

    pub(super) fn annotation(&mut self, pair: &Pair<'_>) -> Option<Ident> {
        part(pair, Rule::annotation).map(|annotation| self.identifier_in(&annotation))
    }

    pub(super) fn text(&self, pair: Option<Pair<'_>>) -> Text {
        let Some(pair) = pair else { return Text { value: String::new(), span: Span::default() } };
        Text { value: pair.as_str().trim_matches('"').to_owned(), span: self.span(&pair) }
    }

    /// Names of the language are lower case and do not end in an underscore; whatever else a model has is quoted.
    fn check_spelling(&mut self, text: &str, span: Span) {
        if text.bytes().any(|byte| byte.is_ascii_uppercase()) {
            self.report(wording::upper_case_name(self.file, span, text));
        } else if text.ends_with('_') && text.len() > 1 {
            self.report(wording::trailing_underscore(self.file, span, text));
        }
    }

    pub(super) fn name_in(&mut self, pair: &Pair<'_>) -> Name {
        let name = part(pair, Rule::name);
        self.name(name)
    }

    /// `door.leaf`: the name of a part, its dots among its literal parts.
    pub(super) fn path_in(&mut self, pair: &Pair<'_>) -> Name {
        let Some(path) = part(pair, Rule::path) else { return self.name_in(pair) };
        let names: Vec<Name> = path.clone().into_inner().map(|name| self.name(Some(name))).collect();
        let (text, span) = (path.as_str().trim_end().to_owned(), self.span(&path));
        let mut parts = Vec::new();
        for name in names {
            if !parts.is_empty() {
                parts.push(NamePart::Literal(".".to_owned()));
            }
            parts.extend(name.parts);
        }
        Name { text, parts, span }
    }

    pub(super) fn name(&mut self, pair: Option<Pair<'_>>) -> Name {
        let Some(pair) = pair else {
            return Name { text: String::new(), parts: Vec::new(), span: Span::default() };
        };
        let span = self.span(&pair);
        let text = pair.as_str().trim_end().to_owned();
        let parts: Vec<NamePart> = pair.clone().into_inner().map(|part| self.name_part(&part)).collect();
        self.check_spelling(&text, span);
        Name { text, parts, span }
    }

    fn name_part(&mut self, pair: &Pair<'_>) -> NamePart {
        let Some(inside) =
            part(pair, Rule::brace_any).or_else(|| part(pair, Rule::brace_range)).or_else(|| part(pair, Rule::brace_words))
        else {
            return NamePart::Literal(pair.as_str().to_owned());
        };
        match inside.as_rule() {
            Rule::brace_any => NamePart::Any,
            Rule::brace_range => {
                let bounds: Vec<Option<u32>> = parts(&inside, Rule::digits).map(|digits| digits.as_str().parse().ok()).collect();
                match bounds[..] {
                    [Some(low), Some(high)] if low < high => NamePart::Range(low, high),
                    _ => {
                        let span = self.span(pair);
                        self.report(wording::empty_brace_range(self.file, span, pair.as_str()));
                        NamePart::Range(0, 0)
                    }
                }
            }
            _ => {
                let mut words: Vec<String> = parts(&inside, Rule::brace_word).map(|word| word.as_str().to_owned()).collect();
                match words.pop() {
                    Some(word) if words.is_empty() => self.loop_variable(pair, word),
                    Some(word) => {
                        words.push(word);
                        NamePart::Words(words)
                    }
                    None => NamePart::Words(words),
                }
            }
        }
    }

    fn loop_variable(&mut self, pair: &Pair<'_>, word: String) -> NamePart {
        if word.starts_with(|first: char| first.is_ascii_digit()) {
            let span = self.span(pair);
            self.report(wording::brace_digit(self.file, span, &word));
        }
        NamePart::Variable(word)
    }

    pub(super) fn quantity(&mut self, pair: &Pair<'_>) -> Quantity {
        let number = part(pair, Rule::number);
        let (value, digits, whole) = match &number {
            Some(number) => self.number(number),
            None => (0.0, Span::default(), false),
        };
        let unit = part(pair, Rule::unit).map(|unit| self.unit(&unit));
        Quantity { value, whole, digits, unit }
    }

    /// The value, the place, and whether it is written as a whole number.
    pub(super) fn number(&mut self, pair: &Pair<'_>) -> (f64, Span, bool) {
        let span = self.span(pair);
        let text = pair.as_str().trim_end();
        let value: f64 = text.parse().unwrap_or(f64::INFINITY);
        if value.is_finite() {
            return (value, span, text.bytes().all(|byte| byte.is_ascii_digit()));
        }
        self.report(wording::number_too_big(self.file, span));
        (0.0, span, false)
    }

    /// A product of powers: `J/(kg*m)` is J, kg^-1, m^-1.
    pub(super) fn unit(&mut self, pair: &Pair<'_>) -> UnitExpr {
        let mut factors = Vec::new();
        let mut sign = 1;
        for part in pair.clone().into_inner() {
            match part.as_rule() {
                Rule::unit_times => sign = 1,
                Rule::unit_divide => sign = -1,
                Rule::unit_power => factors.extend(self.unit_power(&part, sign)),
                Rule::unit_group => {
                    let mut inner = sign;
                    for part in part.into_inner() {
                        match part.as_rule() {
                            Rule::unit_times => inner = sign,
                            Rule::unit_divide => inner = -sign,
                            _ => factors.extend(self.unit_power(&part, inner)),
                        }
                    }
                }
                _ => {}
            }
        }
        UnitExpr { text: pair.as_str().trim_end().to_owned(), factors, span: self.span(pair) }
    }

    fn unit_power(&mut self, pair: &Pair<'_>, sign: i32) -> Option<UnitFactor> {
        let word = part(pair, Rule::unit_word)?;
        let (mut numerator, mut denominator) = (1, 1);
        if let Some(exponent) = part(pair, Rule::unit_exponent) {
            let text = exponent.as_str().trim().trim_matches(['(', ')']);
            let (above, below) = text.split_once('/').unwrap_or((text, "1"));
            match (above.parse(), below.parse()) {
                (Ok(above), Ok(below)) if below > 0 && (-9..=9).contains(&above) && below <= 9 => {
                    (numerator, denominator) = (above, below);
                }
                _ => {
                    let span = self.span(&exponent);
                    self.report(wording::unit_exponent(self.file, span));
                }
            }
        }
        let name = word.as_str().trim_end().to_owned();
        Some(UnitFactor { name, numerator: sign * numerator, denominator, span: self.span(&word) })
    }
}
