//! Precedence: the flat list of operands and operators of a `chain`, folded.
//!
//! Loosest first: `or`, `and`, `not`, comparisons, `in FRAME`, `+ -`, `* /`, unary `-`, `^`. Each level is a loop that asks the
//! next tighter one for its operands, so that the depth of the call stack does not depend on the length of the list.

use super::{Builder, part};
use crate::diagnostics::{Checked, Span};
use crate::syntax::MAXIMUM_OPERATORS;
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{BinaryOperator, CompareOperator, Expr, ExprKind, Frame, UnaryOperator};
use crate::syntax::wording;
use std::iter::Peekable;
use std::vec::IntoIter;

/// A part of the flat list.
enum Piece {
    Operand(Expr),
    Not(Span),
    Logic(BinaryOperator, Span),
    Compare(CompareOperator, Span),
    Sum(BinaryOperator, Span),
    Product(BinaryOperator, Span),
    InFrame(Checked<Frame>, Span),
}

type Pieces = Peekable<IntoIter<Piece>>;

impl Builder<'_> {
    pub(super) fn chain(&mut self, pair: &Pair<'_>) -> Expr {
        let operands = |part: &Pair<'_>| matches!(part.as_rule(), Rule::postfixed | Rule::exponent);
        self.operators += pair.clone().into_inner().filter(|part| !operands(part)).count();
        if self.operators > MAXIMUM_OPERATORS {
            return self.too_many_operators(pair);
        }
        let pieces = self.pieces(pair);
        let mut pieces = pieces.into_iter().peekable();
        self.logic(&mut pieces, BinaryOperator::Or)
    }

    /// Operands take their powers and their sign; the rest stays flat.
    fn pieces(&mut self, pair: &Pair<'_>) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut sign: Option<Span> = None;
        let mut parts = pair.clone().into_inner().peekable();
        while let Some(part) = parts.next() {
            let span = self.span(&part);
            let piece = match part.as_rule() {
                Rule::postfixed => {
                    let mut operand = self.postfixed(&part);
                    let mut powers = 0;
                    while let Some(power) = parts.next_if(|next| next.as_rule() == Rule::power) {
                        let negative = parts.next_if(|next| next.as_rule() == Rule::minus);
                        let negative = negative.map(|minus| self.span(&minus));
                        let Some(exponent) = parts.next() else { break };
                        powers += 1;
                        if powers == 2 {
                            self.report(wording::chained_power(self.file, self.span(&power)));
                        }
                        let exponent = self.exponent(&exponent);
                        let right = signed(negative, exponent);
                        operand = binary(BinaryOperator::Power, self.span(&power), operand, right);
                    }
                    Piece::Operand(signed(sign.take(), operand))
                }
                Rule::minus => {
                    sign = Some(span);
                    continue;
                }
                Rule::kw_not => Piece::Not(span),
                Rule::kw_and => Piece::Logic(BinaryOperator::And, span),
                Rule::kw_or => Piece::Logic(BinaryOperator::Or, span),
                Rule::operator => match part.as_str() {
                    "+" => Piece::Sum(BinaryOperator::Add, span),
                    "-" => Piece::Sum(BinaryOperator::Subtract, span),
                    "*" => Piece::Product(BinaryOperator::Multiply, span),
                    "/" => Piece::Product(BinaryOperator::Divide, span),
                    _ => Piece::Compare(compare_operator(&part), span),
                },
                Rule::frame => Piece::InFrame(self.frame(&part), span),
                _ => continue,
            };
            pieces.push(piece);
        }
        pieces
    }

    fn exponent(&mut self, pair: &Pair<'_>) -> Expr {
        let span = self.span(pair);
        let Some(inner) = pair.clone().into_inner().next() else { return self.missing() };
        let kind = match inner.as_rule() {
            Rule::number => ExprKind::Number(self.quantity(pair)),
            Rule::name => ExprKind::Name(self.name(Some(inner))),
            _ => ExprKind::Paren(Box::new(self.expression_in(&inner))),
        };
        Expr { kind, span }
    }

    /// The right side of `in`: a name, or `heading(NAME)`.
    fn frame(&mut self, pair: &Pair<'_>) -> Checked<Frame> {
        let operand = self.expression(part(pair, Rule::postfixed));
        let span = operand.span;
        let frame = match operand.kind {
            ExprKind::Name(name) => Some(Frame { name, heading: false, span }),
            ExprKind::Call { function, arguments } => {
                let is_heading = matches!(&function.kind, ExprKind::Name(name) if name.text == "heading");
                match arguments.into_iter().next().map(|argument| argument.value.kind) {
                    Some(ExprKind::Name(name)) if is_heading => Some(Frame { name, heading: true, span }),
                    _ => None,
                }
            }
            _ => None,
        };
        let written = part(pair, Rule::postfixed).map_or("", |postfixed| postfixed.as_str()).trim_end();
        frame.ok_or_else(|| self.report(wording::not_a_frame(self.file, span, written)))
    }

    /// `or`, and inside it `and`.
    fn logic(&mut self, pieces: &mut Pieces, operator: BinaryOperator) -> Expr {
        let tighter = |builder: &mut Self, pieces: &mut Pieces| match operator {
            BinaryOperator::Or => builder.logic(pieces, BinaryOperator::And),
            _ => builder.condition(pieces),
        };
        let mut left = tighter(self, pieces);
        let is_ours = |piece: &Piece| matches!(piece, Piece::Logic(found, _) if *found == operator);
        while let Some(Piece::Logic(_, span)) = pieces.next_if(is_ours) {
            let right = tighter(self, pieces);
            left = binary(operator, span, left, right);
        }
        left
    }

    /// A comparison with `not` before it or not.
    fn condition(&mut self, pieces: &mut Pieces) -> Expr {
        let negated = match pieces.next_if(|piece| matches!(piece, Piece::Not(_))) {
            Some(Piece::Not(span)) => Some(span),
            _ => None,
        };
        let operand = self.comparison(pieces);
        match negated {
            None => operand,
            Some(not) => {
                let span = not.to(operand.span);
                Expr { kind: ExprKind::Unary { operator: UnaryOperator::Not, operand: Box::new(operand) }, span }
            }
        }
    }

    fn comparison(&mut self, pieces: &mut Pieces) -> Expr {
        let first = self.in_frame(pieces);
        let mut operands = vec![first];
        let mut operators = Vec::new();
        while let Some(Piece::Compare(operator, span)) = pieces.next_if(|piece| matches!(piece, Piece::Compare(..))) {
            operators.push((operator, span));
            operands.push(self.in_frame(pieces));
        }
        if operators.is_empty() {
            return operands.pop().unwrap_or_else(|| self.missing());
        }
        self.check_direction(&operators);
        let span = operands.iter().map(|operand| operand.span).reduce(Span::to).unwrap_or_default();
        Expr { kind: ExprKind::Compare { operands, operators }, span }
    }

    /// Chained comparisons go one way: `0 < x <= 1`.
    pub(super) fn check_direction(&mut self, operators: &[(CompareOperator, Span)]) {
        let direction = |operator: CompareOperator| match operator {
            CompareOperator::Less | CompareOperator::LessEqual => 1,
            CompareOperator::Greater | CompareOperator::GreaterEqual => -1,
            CompareOperator::Equal | CompareOperator::NotEqual => 0,
        };
        let [(first, first_span), rest @ ..] = operators else { return };
        for (operator, span) in rest {
            let both = direction(*first) * direction(*operator);
            if both != 1 {
                self.report(wording::mixed_comparison(self.file, *first_span, *span, both == 0));
                return;
            }
        }
    }

    fn in_frame(&mut self, pieces: &mut Pieces) -> Expr {
        let (mut value, mut sum) = self.sum(pieces);
        while let Some(Piece::InFrame(frame, span)) = pieces.next_if(|piece| matches!(piece, Piece::InFrame(..))) {
            if let Some(sum) = sum.take() {
                self.report(wording::mixed_frame(self.file, sum, span));
            }
            let whole = value.span.to(span);
            let kind = match frame {
                Ok(frame) => ExprKind::InFrame { value: Box::new(value), frame },
                Err(reported) => ExprKind::Error(reported),
            };
            value = Expr { kind, span: whole };
            let arithmetic = |piece: &Piece| matches!(piece, Piece::Sum(..) | Piece::Product(..));
            while let Some(Piece::Sum(operator, after) | Piece::Product(operator, after)) = pieces.next_if(arithmetic) {
                self.report(wording::mixed_frame(self.file, after, span));
                let (right, _) = self.sum(pieces);
                value = binary(operator, after, value, right);
            }
        }
        value
    }

    /// A sum of products, and its last `+` or `-` if it has one.
    fn sum(&mut self, pieces: &mut Pieces) -> (Expr, Option<Span>) {
        let mut left = self.product(pieces);
        let mut last = None;
        while let Some(Piece::Sum(operator, span)) = pieces.next_if(|piece| matches!(piece, Piece::Sum(..))) {
            let right = self.product(pieces);
            left = binary(operator, span, left, right);
            last = Some(span);
        }
        (left, last)
    }

    fn product(&mut self, pieces: &mut Pieces) -> Expr {
        let mut left = self.operand(pieces);
        while let Some(Piece::Product(operator, span)) = pieces.next_if(|piece| matches!(piece, Piece::Product(..))) {
            let right = self.operand(pieces);
            left = binary(operator, span, left, right);
        }
        left
    }

    fn operand(&mut self, pieces: &mut Pieces) -> Expr {
        match pieces.next_if(|piece| matches!(piece, Piece::Operand(_))) {
            Some(Piece::Operand(operand)) => operand,
            _ => self.missing(),
        }
    }
}

fn binary(operator: BinaryOperator, operator_span: Span, left: Expr, right: Expr) -> Expr {
    let span = left.span.to(right.span);
    Expr { kind: ExprKind::Binary { operator, operator_span, left: Box::new(left), right: Box::new(right) }, span }
}

fn signed(sign: Option<Span>, operand: Expr) -> Expr {
    match sign {
        None => operand,
        Some(sign) => {
            let span = sign.to(operand.span);
            Expr { kind: ExprKind::Unary { operator: UnaryOperator::Negate, operand: Box::new(operand) }, span }
        }
    }
}

pub(super) fn compare_operator(pair: &Pair<'_>) -> CompareOperator {
    match pair.as_str().trim_end() {
        "<" => CompareOperator::Less,
        "<=" => CompareOperator::LessEqual,
        ">" => CompareOperator::Greater,
        ">=" => CompareOperator::GreaterEqual,
        "==" => CompareOperator::Equal,
        _ => CompareOperator::NotEqual,
    }
}
