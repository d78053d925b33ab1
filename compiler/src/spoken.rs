//! Units in which quantities are printed for people: as they were written, else as is customary.

use crate::quantity::dimension::Dimension;
use crate::quantity::unit;
use crate::syntax::tree::walk::{Visitor, walk_expression};
use crate::syntax::tree::{Expr, ExprKind};

pub use msk_program::spoken::SpokenUnit;

/// The unit in which the first quantity of this dimension stands in one of these formulas; that of [`SpokenUnit::of`] if there
/// is none.
pub(crate) fn written<'a>(dimension: Dimension, formulas: impl IntoIterator<Item = &'a Expr>) -> SpokenUnit {
    let mut search = Search { dimension, found: None };
    formulas.into_iter().for_each(|formula| search.expression(formula));
    search.found.unwrap_or_else(|| SpokenUnit::of(dimension))
}

/// Looks for a quantity of one dimension.
struct Search {
    dimension: Dimension,
    found: Option<SpokenUnit>,
}

impl<'a> Visitor<'a> for Search {
    fn expression(&mut self, expression: &'a Expr) {
        if self.found.is_some() {
            return;
        }
        if let ExprKind::Number(number) = &expression.kind
            && let Some(written) = &number.unit
            && let Ok(one) = unit::evaluate(written)
            && one.dimension == self.dimension
        {
            self.found = Some(SpokenUnit { si: self.dimension.to_string(), name: written.text.clone(), factor: one.value });
        }
        walk_expression(self, expression);
    }
}
