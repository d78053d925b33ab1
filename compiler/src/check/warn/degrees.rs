//! Conversions between degrees and radians by hand, where angles carry their unit, whatever names their constants have.

use crate::check::context::Checker;
use crate::diagnostics::codes;
use crate::graph::Graph;
use crate::hir::value::Value;
use crate::hir::{ExprId, ExprKind as Kind, Hir, Resolution};
use crate::numbers::exact;
use crate::signals::Read;
use crate::syntax::tree::{BinaryOperator, Expr, ExprKind, Quantity};
use std::f64::consts::PI;

/// How far a written number may be from the constant that it stands for, as a part of it: `3.14` is pi.
const ROUNDED: f64 = 1e-3;

/// Factors of a product that are looked at.
const FACTORS: usize = 8;

impl Checker<'_> {
    /// Warns of a factor pi / 180 or its reciprocal.
    pub(crate) fn warn_degrees(&mut self, divide: bool, left: &Expr, right: &Expr) {
        let file = self.place.file;
        let (Some(left_id), Some(right_id)) = (self.hir.latest(file, left.span), self.hir.latest(file, right.span)) else {
            return;
        };
        let sides = Sides { hir: &self.hir, graph: &self.graph };
        let Some(into_radians) = sides.conversion(divide, left_id, right_id).filter(|_| self.in_tests.is_none()) else { return };
        let span = left.span.to(right.span);
        let written = factors(left).into_iter().chain([right]).filter_map(angle).next();
        if !into_radians {
            let diagnostic = self
                .diagnostic(codes::incentive::MANUAL_CONVERSION, span, "manual conversion from radians to degrees")
                .help("the number of degrees of an angle is `knee_angle_r.q / 1 deg`");
            self.diagnostics.push(diagnostic);
            return;
        }
        let in_degrees = |quantity: &Quantity| quantity.unit.as_ref().is_some_and(|unit| unit.text == "deg");
        let message = match written {
            Some(quantity) if in_degrees(quantity) => "manual conversion of an angle that already is in radians",
            _ => "manual conversion from degrees to radians",
        };
        let diagnostic = self
            .diagnostic(codes::incentive::MANUAL_CONVERSION, span, message)
            .help("angles have units: `40 deg` can be combined with `knee_angle_r.q` directly");
        let diagnostic = match written {
            Some(quantity) => {
                let angle = format!("{} deg", exact(quantity.value));
                let title = format!("write `{angle}`");
                // What is an angle stays one; a plain number becomes an angle.
                if in_degrees(quantity) { diagnostic.fix(title, span, angle) } else { diagnostic.suggest(title, span, angle) }
            }
            None => diagnostic,
        };
        self.diagnostics.push(diagnostic);
    }
}

/// Both sides of a product or quotient, as they are in the typed HIR.
struct Sides<'c> {
    hir: &'c Hir,
    graph: &'c Graph,
}

impl Sides<'_> {
    /// Whether a product or quotient turns degrees into radians (`true`), radians into degrees (`false`), or neither.
    fn conversion(&self, divide: bool, left: ExprId, right: ExprId) -> Option<bool> {
        let is = |id: ExprId, wanted: f64| self.plain(id).is_some_and(|value| (value / wanted - 1.0).abs() < ROUNDED);
        let holds = |id: ExprId, wanted: f64| self.factors(id).into_iter().any(|factor| is(factor, wanted));
        if divide && is(right, 180.0) && holds(left, PI) || !divide && (is(right, PI / 180.0) || is(left, PI / 180.0)) {
            return Some(true);
        }
        if divide && is(right, PI) && holds(left, 180.0) || !divide && (is(right, 180.0 / PI) || is(left, 180.0 / PI)) {
            return Some(false);
        }
        match divide {
            true if is(right, 180.0 / PI) => Some(true),
            true if is(right, PI / 180.0) => Some(false),
            _ => None,
        }
    }

    /// The value of a number that is written without unit, or of `pi`, by whatever name.
    fn plain(&self, id: ExprId) -> Option<f64> {
        let expr = self.hir.expr(self.hir.behind_names(id));
        let pi = matches!(expr.name, Some((_, Resolution::Signal(signal))) if signal.read == Read::Pi);
        match &expr.value {
            Some(Value::Typed(data)) if expr.kind == Kind::Literal || pi => {
                let value = self.graph.constant_value(data.node)?;
                data.kind.dimension().filter(|dimension| dimension.is_none()).map(|_| value)
            }
            _ => None,
        }
    }

    /// The factors of a product, as far as they are few.
    fn factors(&self, mut id: ExprId) -> Vec<ExprId> {
        let mut found = Vec::new();
        while found.len() < FACTORS {
            id = self.hir.behind_names(id);
            let mut sides = self.hir.children(id);
            match (self.hir.expr(id).kind, sides.next(), sides.next()) {
                (Kind::Binary(BinaryOperator::Multiply), Some(left), Some(right)) => {
                    found.push(right);
                    id = left;
                }
                _ => break,
            }
        }
        found.push(id);
        found
    }
}

/// The factors of a product, as far as they are few.
fn factors(mut expr: &Expr) -> Vec<&Expr> {
    let mut found = Vec::new();
    while found.len() < FACTORS {
        match &expr.kind {
            ExprKind::Paren(inner) => expr = inner,
            ExprKind::Binary { operator: BinaryOperator::Multiply, left, right, .. } => {
                found.push(&**right);
                expr = left;
            }
            _ => break,
        }
    }
    found.push(expr);
    found
}

/// The written number that a conversion turns, in degrees or without unit; the constants of the conversion are none.
fn angle(expr: &Expr) -> Option<&Quantity> {
    match &expr.kind {
        ExprKind::Paren(inner) => angle(inner),
        ExprKind::Number(number) => {
            let constant = |wanted: f64| number.unit.is_none() && (number.value / wanted - 1.0).abs() < ROUNDED;
            let converts = constant(180.0) || constant(PI) || constant(PI / 180.0) || constant(180.0 / PI);
            let turned = number.unit.as_ref().is_none_or(|unit| unit.text == "deg");
            (turned && !converts).then_some(number)
        }
        _ => None,
    }
}
